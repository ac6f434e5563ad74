//! Crofton's formula on pixels.

use super::Mask;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Steps along lines through pixel centres, by ascending angle from 0 to π.
const STEPS: [[isize; 2]; 8] = [[1, 0], [2, 1], [1, 1], [1, 2], [0, 1], [-1, 2], [-1, 1], [-2, 1]];

impl Mask<'_> {
    /// The perimeter of each label.
    pub(super) fn perimeters(&self) -> BTreeMap<i64, f64> {
        let mut perimeters = BTreeMap::new();
        for (step, weight) in STEPS.into_iter().zip(weights()) {
            self.cross(step, weight, &mut perimeters);
        }
        perimeters
    }

    /// Adds a weight for each change of label along the lines of one direction.
    fn cross(&self, [dx, dy]: [isize; 2], weight: f64, perimeters: &mut BTreeMap<i64, f64>) {
        let mut meet = |from: i64, to: i64| {
            if from != to {
                for label in [from, to].into_iter().filter(|&label| label != 0) {
                    *perimeters.entry(label).or_insert(0.0) += weight;
                }
            }
        };
        let (columns, rows) = (self.columns as isize, self.rows as isize);
        // Lines begin up to a step outside, where everything is background.
        for row in -dy..rows {
            let (begin, end) = (-dx.max(0), columns - dx.min(0));
            // Where both ends of the step are inside.
            let within = match (-dx).max(0)..columns - dx.max(0) {
                within if row >= 0 && row + dy < rows && !within.is_empty() => within,
                _ => begin..begin,
            };
            let at = |column: isize| (self.at(column, row), self.at(column + dx, row + dy));
            (begin..within.start).map(at).for_each(|(from, to)| meet(from, to));
            if !within.is_empty() {
                let part = |row: isize, shift: isize| {
                    let first = (row * columns + within.start + shift) as usize;
                    &self.labels[first..first + within.len()]
                };
                let pairs = part(row, 0).iter().zip(part(row + dy, dx));
                pairs.for_each(|(&from, &to)| meet(from, to));
            }
            (within.end..end).map(at).for_each(|(from, to)| meet(from, to));
        }
    }
}

/// `½ Δθ Δp` of each direction: the angles nearest to it times the distance of its lines, which is 1/|step|.
fn weights() -> [f64; 8] {
    let (half, diagonal) = (0.5f64.atan(), FRAC_PI_4);
    let along = half;
    let across = 0.5 * diagonal;
    let oblique = FRAC_PI_2 - diagonal - half;
    let weight = |angles: f64, step: [isize; 2]| 0.5 * angles / (step[0] as f64).hypot(step[1] as f64);
    STEPS.map(|step| match step {
        [0, _] | [_, 0] => weight(along, step),
        [x, y] if x.abs() == y.abs() => weight(oblique, step),
        _ => weight(across, step),
    })
}
