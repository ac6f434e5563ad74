//! A likelihood to second order about a point.

use nalgebra::{SMatrix, SVector};

/// How many it is a function of.
const UNKNOWNS: usize = 4;
pub(super) type Point = SVector<f64, UNKNOWNS>;
pub(super) type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Steps of each unknown at most, in spacings.
pub(super) const FURTHEST: f64 = 2.0;

/// The points at which the likelihood is looked at, in spacings.
pub(super) const POINTS: [[f64; UNKNOWNS]; 15] = [
    [0.0, 0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
    [-1.0, 0.0, 0.0, 0.0],
    [0.0, -1.0, 0.0, 0.0],
    [0.0, 0.0, -1.0, 0.0],
    [0.0, 0.0, 0.0, -1.0],
    [1.0, 1.0, 0.0, 0.0],
    [1.0, 0.0, 1.0, 0.0],
    [0.0, 1.0, 1.0, 0.0],
    [1.0, 0.0, 0.0, 1.0],
    [0.0, 1.0, 0.0, 1.0],
    [0.0, 0.0, 1.0, 1.0],
];
const ENOUGH: usize = 1 + UNKNOWNS;

/// The points to either side along each unknown: above, below.
pub(super) const PAIRS_OF_SIDES: [[usize; 2]; UNKNOWNS] = [[1, 5], [2, 6], [3, 7], [4, 8]];

/// Pairs of unknowns whose mixed derivatives the last of the points are for.
const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)];

/// How far they are for derivatives, in spacings.
pub(super) const CLOSE: f64 = 0.02;

/// A function of some unknowns to second order about a point, in units of the spacings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    pub slope: Point,
    pub bend: Matrix,
}

impl Surface {
    /// From values at [`POINTS`].
    pub fn new(v: &[f64]) -> Self {
        let slope = Point::from_fn(|k, _| 0.5 * (v[k + 1] - v[k + ENOUGH]));
        let mut bend = Matrix::from_diagonal(&Point::from_fn(|k, _| v[k + 1] + v[k + ENOUGH] - 2.0 * v[0]));
        for ((i, j), corner) in PAIRS.into_iter().zip(&v[ENOUGH + UNKNOWNS..]) {
            let mixed = corner - v[i + 1] - v[j + 1] + v[0];
            (bend[(i, j)], bend[(j, i)]) = (mixed, mixed);
        }
        Self { slope, bend }
    }

    /// The same if values were taken at points that are nearer by a factor.
    pub fn seen_from(self, nearer: f64) -> Self {
        Self { slope: self.slope / nearer, bend: self.bend / nearer.powi(2) }
    }

    /// The sum of two functions.
    pub fn plus(&self, other: &Self) -> Self {
        Self { slope: self.slope + other.slope, bend: self.bend + other.bend }
    }

    /// The inverse of the bend without what is held, at least a little upwards along its own axes.
    fn inverse(&self, held: [bool; UNKNOWNS]) -> Matrix {
        let axes = without(self.bend, held).symmetric_eigen();
        let largest = axes.eigenvalues.amax().max(f64::MIN_POSITIVE);
        let inverse = axes.eigenvalues.map(|bend| 1.0 / bend.abs().max(FLAT * largest));
        without(axes.eigenvectors * Matrix::from_diagonal(&inverse) * axes.eigenvectors.transpose(), held)
    }

    /// The step towards the least value.
    pub fn newton(&self, held: [bool; UNKNOWNS]) -> Point {
        let step = -(self.inverse(held) * self.slope);
        step * (FURTHEST / step.amax().max(FURTHEST))
    }

    /// Of the unknowns, if the function is −2 log of a likelihood.
    pub fn covariance(&self, held: [bool; UNKNOWNS]) -> Matrix {
        self.inverse(held) * 2.0
    }
}

/// Zero in all of what is held.
fn without(mut matrix: Matrix, held: [bool; UNKNOWNS]) -> Matrix {
    for k in (0..UNKNOWNS).filter(|k| held[*k]) {
        matrix.fill_row(k, 0.0);
        matrix.fill_column(k, 0.0);
    }
    matrix
}

/// Bends less than this share of the largest count as that.
const FLAT: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;

    fn bowl() -> (Matrix, Point) {
        let bend =
            Matrix::new(3.0, 0.4, -1.1, 0.1, 0.4, 1.5, 0.2, 0.0, -1.1, 0.2, 2.2, 0.3, 0.1, 0.0, 0.3, 1.1);
        (bend, Point::new(0.3, -0.6, 0.2, 0.5))
    }

    fn value(at: Point) -> f64 {
        let (bend, least) = bowl();
        7.0 + 0.5 * (at - least).dot(&(bend * (at - least)))
    }

    #[test]
    fn a_quadratic_function_is_found_from_its_values() {
        let (bend, least) = bowl();
        let all = POINTS.map(|point| value(point.into()));
        let found = Surface::new(&all);
        assert!((found.bend - bend).amax() < 1e-12);
        assert!((found.newton([false; UNKNOWNS]) - least).amax() < 1e-12);
        assert!((found.covariance([false; UNKNOWNS]) * bend - Matrix::identity() * 2.0).amax() < 1e-10);
        let held = found.newton([true, false, false, false]);
        assert!(held[0] == 0.0 && held[1] != 0.0);
    }
}
