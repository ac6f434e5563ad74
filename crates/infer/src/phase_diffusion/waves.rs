//! Displacements resolved into waves.

use super::Pattern;
use crate::Error;
use nalgebra::DMatrix;
use std::f64::consts::TAU;
use voronudge_geometry::{Vector, dot, quarter_turn};

/// A plane wave of the displacement and its course.
#[derive(Debug, Clone, PartialEq)]
pub struct PatternWave {
    /// The wave vector.
    pub q: Vector<f64>,
    /// For the part with cos q·r, then for that with sin q·r: the amplitude at each frame, in components along q and a quarter turn
    /// ahead.
    pub courses: [Vec<[f64; 2]>; 2],
}

impl PatternWave {
    /// q².
    pub fn square(&self) -> f64 {
        self.q.norm_squared()
    }

    /// Root mean square of the displacement in this wave over cells and frames.
    pub fn amplitude(&self) -> f64 {
        let all = || self.courses.iter().flatten().flatten();
        (all().map(|x| x * x).sum::<f64>() / (4 * self.courses[0].len()) as f64 * 2.0).sqrt()
    }
}

/// The longest waves of a pattern, found together with the mean by least squares over the cells.
pub(super) fn resolve(pattern: &Pattern, count: usize) -> Result<Vec<PatternWave>, Error> {
    let cells = pattern.reference.len();
    let q = longest(pattern.domain.lengths(), count.max(1));
    let columns = 2 * q.len() + 1;
    if cells < columns {
        return Err(Error::TooFewPatternCells { found: cells, waves: q.len(), required: columns });
    }
    let design = DMatrix::from_fn(cells, columns, |cell, column| {
        if column == 0 {
            return 1.0;
        }
        let phase = dot(q[(column - 1) / 2], pattern.reference[cell]);
        if column % 2 == 1 { phase.cos() } else { phase.sin() }
    });
    let factor = (design.transpose() * &design).cholesky().ok_or(Error::Degenerate)?;
    let frames = pattern.displacements.len();
    let measured = DMatrix::from_fn(cells, 2 * frames, |cell, column| {
        pattern.displacements[column / 2][cell][column % 2]
    });
    let amplitudes = factor.solve(&(design.transpose() * measured));
    let course = |row: usize, q: Vector<f64>| -> Vec<[f64; 2]> {
        let along = q / q.norm();
        let ahead = quarter_turn(along);
        (0..frames)
            .map(|frame| {
                let a = Vector::new(amplitudes[(row, 2 * frame)], amplitudes[(row, 2 * frame + 1)]);
                [dot(along, a), dot(ahead, a)]
            })
            .collect()
    };
    Ok(q.iter()
        .enumerate()
        .map(|(k, &q)| PatternWave { q, courses: [course(2 * k + 1, q), course(2 * k + 2, q)] })
        .collect())
}

/// At least `count` wave vectors of a box, one of q and −q, by length, and all others of the last length.
fn longest(lengths: [f64; 2], count: usize) -> Vec<Vector<f64>> {
    let reach = (2 * count) as i64;
    // As far along each axis as the length of the count-th along the longer side of the box, at most.
    let unit = lengths.map(|length| TAU / length);
    let farthest = unit[0].min(unit[1]) * (count as f64 + 0.5);
    let mut all: Vec<(f64, Vector<f64>)> = Vec::new();
    for m in 0..=reach.min((farthest / unit[1]).ceil() as i64) {
        let side = reach.min((farthest / unit[0]).ceil() as i64);
        for n in -side..=side {
            if m > 0 || n > 0 {
                let q = Vector::new(n as f64 * unit[0], m as f64 * unit[1]);
                all.push((q.norm_squared(), q));
            }
        }
    }
    let by_length = |a: &(f64, Vector<f64>), b: &(f64, Vector<f64>)| {
        a.0.total_cmp(&b.0).then(a.1.y.total_cmp(&b.1.y)).then(a.1.x.total_cmp(&b.1.x))
    };
    all.sort_by(by_length);
    let Some(last) = all.get(count - 1).or(all.last()).map(|(square, _)| *square) else {
        return Vec::new();
    };
    all.into_iter().take_while(|(square, _)| *square <= last * (1.0 + 1e-9)).map(|(_, q)| q).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_waves_come_first_and_all_of_a_length() {
        let q = longest([10.0, 10.0], 3);
        assert_eq!(q.len(), 4);
        assert!(
            (q[0].norm() - TAU / 10.0).abs() < 1e-12
                && (q[3].norm() - 2f64.sqrt() * TAU / 10.0).abs() < 1e-12
        );
        // A long box has its longest waves along its length.
        let q = longest([40.0, 10.0], 3);
        assert!(q[..3].iter().all(|q| q.y == 0.0) && (q[2].x - 3.0 * TAU / 40.0).abs() < 1e-12);
        for pair in q.windows(2) {
            assert!(pair[0].norm() <= pair[1].norm() + 1e-12);
        }
    }
}
