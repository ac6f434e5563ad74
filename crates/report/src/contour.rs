//! Lines of equal value on a grid, by marching squares.

use std::collections::{BTreeMap, BTreeSet};

/// A side between two neighbouring nodes of the grid, by the indices of the nodes.
type Side = [usize; 2];

/// The lines along which `values` (row by row, `columns` to a row) equal `level`, in units of
/// columns and rows, with linear interpolation between neighbours. A closed line ends where it
/// begins. Lines end where a value is not finite.
#[must_use]
pub fn contour_lines(values: &[f64], columns: usize, level: f64) -> Vec<Vec<[f64; 2]>> {
    let rows = values.len().checked_div(columns).unwrap_or(0);
    let mut links: BTreeMap<Side, Vec<Side>> = BTreeMap::new();
    for row in 1..rows {
        for column in 1..columns {
            let corner = row * columns + column;
            let square = [corner - columns - 1, corner - columns, corner, corner - 1];
            for [from, to] in crossings(values, square, level) {
                links.entry(from).or_default().push(to);
                links.entry(to).or_default().push(from);
            }
        }
    }
    let place = |&[low, high]: &Side| {
        let share = (level - values[low]) / (values[high] - values[low]);
        let at = |node: usize| [(node % columns) as f64, (node / columns) as f64];
        let [from, to] = [at(low), at(high)];
        [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
    };
    chains(&links).iter().map(|chain| chain.iter().map(place).collect()).collect()
}

/// The pieces of the line in one square, whose nodes are given counter-clockwise.
fn crossings(values: &[f64], square: [usize; 4], level: f64) -> Vec<[Side; 2]> {
    let corners = square.map(|node| values[node]);
    if corners.iter().any(|value| !value.is_finite()) {
        return Vec::new();
    }
    let is_above = corners.map(|value| value >= level);
    let side = |corner: usize| {
        let [a, b] = [square[corner], square[(corner + 1) % 4]];
        [a.min(b), a.max(b)]
    };
    let crossed: Vec<Side> =
        (0..4).filter(|&corner| is_above[corner] != is_above[(corner + 1) % 4]).map(side).collect();
    match crossed[..] {
        [from, to] => vec![[from, to]],
        // A saddle: the mean of the corners says which of them hang together.
        [first, second, third, fourth] => {
            let is_middle_above = corners.iter().sum::<f64>() / 4.0 >= level;
            if is_above[0] == is_middle_above {
                vec![[first, second], [third, fourth]]
            } else {
                vec![[fourth, first], [second, third]]
            }
        }
        _ => Vec::new(),
    }
}

/// Links strung together, open lines from an end, then closed ones.
fn chains(links: &BTreeMap<Side, Vec<Side>>) -> Vec<Vec<Side>> {
    let ends = links.iter().filter(|(_, next)| next.len() == 1).map(|(side, _)| *side);
    let mut seen = BTreeSet::new();
    let mut chains = Vec::new();
    for start in ends.chain(links.keys().copied()) {
        if !seen.insert(start) {
            continue;
        }
        let mut chain = vec![start];
        let mut last = start;
        let neighbours = |side: &Side| links.get(side).map_or(&[][..], Vec::as_slice);
        while let Some(&next) = neighbours(&last).iter().find(|next| !seen.contains(*next)) {
            seen.insert(next);
            chain.push(next);
            last = next;
        }
        if chain.len() > 2 && neighbours(&last).contains(&start) {
            chain.push(start);
        }
        chains.push(chain);
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(side: usize, value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        (0..side * side).map(|node| value((node % side) as f64, (node / side) as f64)).collect()
    }

    #[test]
    fn a_circle_is_one_closed_line() {
        let values = grid(21, |x, y| (x - 10.0).hypot(y - 10.0));
        let lines = contour_lines(&values, 21, 6.0);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        for [x, y] in &lines[0] {
            assert!(((x - 10.0).hypot(y - 10.0) - 6.0).abs() < 0.05);
        }
    }

    #[test]
    fn a_straight_line_is_exact_and_open() {
        let values = grid(5, |x, y| x + 0.5 * y);
        let lines = contour_lines(&values, 5, 2.2);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|[x, y]| (x + 0.5 * y - 2.2).abs() < 1e-12));
        assert_ne!(lines[0].first(), lines[0].last());
    }

    #[test]
    fn saddles_and_gaps_leave_no_loose_ends_inside() {
        assert_eq!(contour_lines(&[1.0, 0.0, 0.0, 1.0], 2, 0.6).len(), 2);
        let mut values = grid(9, |x, y| (x - 4.0).hypot(y - 4.0));
        values[4 * 9 + 7] = f64::NAN;
        let lines = contour_lines(&values, 9, 3.0);
        assert_eq!(lines.len(), 1);
        assert!(contour_lines(&[], 0, 1.0).is_empty());
        assert!(contour_lines(&[1.0, 2.0], 0, 1.0).is_empty());
    }
}
