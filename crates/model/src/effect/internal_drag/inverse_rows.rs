//! Rows of the inverse of `I + ξ L`: what friction between neighbours makes of a force on one cell.
//!
//! Entries fall by a factor with each step from neighbour to neighbour, so a row is found among the cells within some steps, as if all others
//! were at rest, and each step of the iteration reaches one neighbour further.

use super::{Chebyshev, Graph, MOST_ITERATIONS, TRUNCATION};
use rayon::prelude::*;

/// Entries at which the cells around end, relative to the largest of the row.
const NEGLIGIBLE: f64 = 1e-9;
/// The reduction of the error at which iteration ends, in the same unit.
const REDUCTION: f64 = 1e-13;

/// Of each cell, the entries of its row that are not left out.
pub(super) fn inverse_rows(graph: &Graph, drag: f64) -> Vec<Vec<(u32, f64)>> {
    let cells = graph.neighbours.len();
    let Some(chebyshev) = Chebyshev::new(drag, graph.most) else {
        // As the velocities.
        return (0..cells).map(|cell| vec![(cell as u32, f64::NAN)]).collect();
    };
    let begin = || Around { place: vec![u32::MAX; cells], ..Around::default() };
    // Most cells are like one of the first: of these, what all begin with.
    let usual = (0..cells.min(8)).map(|cell| begin().row(graph, (drag, &chebyshev), (cell, 1)).1).max();
    let usual = usual.unwrap_or(1);
    let row = |around: &mut Around, cell| around.row(graph, (drag, &chebyshev), (cell, usual)).0;
    (0..cells).into_par_iter().map_init(begin, row).collect()
}

/// The cells around one, by distance, and the iteration among them.
#[derive(Default)]
struct Around {
    /// Place of each cell of the tissue among these, in memory that is used again.
    place: Vec<u32>,
    cells: Vec<u32>,
    /// Number of cells up to each distance.
    ends: Vec<usize>,
    /// Neighbours by their place among these, those of each from `start` on, and how many there are with those at rest.
    start: Vec<usize>,
    neighbours: Vec<u32>,
    count: Vec<f64>,
    x: Vec<f64>,
    step: Vec<f64>,
}

impl Around {
    /// The row of a cell, from cells within a radius, larger than the given one where entries at its end are not negligible; and the radius.
    fn row(
        &mut self,
        graph: &Graph,
        (drag, chebyshev): (f64, &Chebyshev),
        (cell, mut radius): (usize, usize),
    ) -> (Vec<(u32, f64)>, usize) {
        loop {
            self.gather(graph, cell, radius);
            self.solve(drag, chebyshev);
            let largest = self.x.iter().fold(0.0, |largest: f64, one| largest.max(one.abs()));
            let rim = &self.x[self.ends[radius - 1]..];
            if rim.iter().all(|entry| entry.abs() <= NEGLIGIBLE * largest) {
                let entries = self.cells.iter().copied().zip(self.x.iter().copied());
                return (entries.filter(|(_, entry)| entry.abs() > TRUNCATION * largest).collect(), radius);
            }
            radius += 1;
        }
    }

    fn gather(&mut self, graph: &Graph, centre: usize, radius: usize) {
        let Self { place, cells, ends, start, neighbours, count, .. } = self;
        cells.iter().for_each(|&cell| place[cell as usize] = u32::MAX);
        cells.clear();
        ends.clear();
        cells.push(centre as u32);
        place[centre] = 0;
        ends.push(1);
        let mut first = 0;
        for _ in 0..radius {
            let end = cells.len();
            for k in first..end {
                for &next in &graph.neighbours[cells[k] as usize] {
                    if place[next as usize] == u32::MAX {
                        place[next as usize] = cells.len() as u32;
                        cells.push(next);
                    }
                }
            }
            first = end;
            ends.push(cells.len());
        }
        start.clear();
        neighbours.clear();
        count.clear();
        for &cell in cells.iter() {
            let all = &graph.neighbours[cell as usize];
            start.push(neighbours.len());
            neighbours.extend(all.iter().map(|&next| place[next as usize]).filter(|&next| next != u32::MAX));
            count.push(all.len() as f64);
        }
        start.push(neighbours.len());
    }

    /// The response of the cells around to a unit force on the first.
    fn solve(&mut self, drag: f64, &Chebyshev { middle, half, convergence }: &Chebyshev) {
        let Self { cells, ends, start, neighbours, count, x, step, .. } = self;
        let ratio = middle / half;
        let steps = ((REDUCTION.ln() / convergence.ln()).ceil() as usize + 1).min(MOST_ITERATIONS);
        let residual = |x: &[f64], cell: usize| {
            let sum: f64 =
                neighbours[start[cell]..start[cell + 1]].iter().map(|&next| x[next as usize]).sum();
            f64::from(u8::from(cell == 0)) - x[cell] - drag * (count[cell] * x[cell] - sum)
        };
        x.clear();
        x.resize(cells.len(), 0.0);
        step.clear();
        step.resize(cells.len(), 0.0);
        step[0] = 1.0 / middle;
        let mut rho = 1.0 / ratio;
        let reached = |distance: usize| ends[distance.min(ends.len() - 1)];
        for k in 0..steps {
            for (x, step) in x.iter_mut().zip(&step[..reached(k)]) {
                *x += step;
            }
            let next = 1.0 / (2.0 * ratio - rho);
            for (cell, step) in step[..reached(k + 1)].iter_mut().enumerate() {
                *step = *step * (next * rho) + residual(x, cell) * (2.0 * next / half);
            }
            rho = next;
        }
    }
}
