//! A likelihood to second order about a point.

use nalgebra::{SMatrix, SVector};

/// How many it is a function of.
const UNKNOWNS: usize = 4;
pub(super) type Point = SVector<f64, UNKNOWNS>;
pub(super) type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Steps of each unknown at most, in spacings.
const FURTHEST: f64 = 2.0;

/// The points at which the likelihood is looked at, in spacings. The first few are enough where it is known how it bends.
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
pub(super) const ENOUGH: usize = 1 + UNKNOWNS;

/// Pairs of unknowns whose mixed derivatives the last of the points are for.
const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)];

/// How far the few are, in spacings.
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

    /// From values at the first few, drawn close together, if it bends so.
    pub fn again(v: &[f64], bend: Matrix) -> Self {
        let slope = Point::from_fn(|k, _| (v[k + 1] - v[0]) / CLOSE - 0.5 * CLOSE * bend[(k, k)]);
        Self { slope, bend }
    }

    /// With what the slope has changed by since, after a step (the formula of Broyden, Fletcher, Goldfarb and Shanno).
    pub fn updated(self, before: &Self, step: Point) -> Self {
        let change = self.slope - before.slope;
        let bent = self.bend * step;
        let (by_slope, by_bend) = (step.dot(&change), step.dot(&bent));
        if by_slope <= FLAT * by_bend || by_bend <= 0.0 {
            return self;
        }
        let bend = self.bend + change * change.transpose() / by_slope - bent * bent.transpose() / by_bend;
        Self { bend, ..self }
    }

    /// Whether it rises by more than a standard deviation within three quarters of a spacing along all axes of what is not held, if it is −2 log
    /// of a likelihood.
    pub fn is_sharp(&self, held: [bool; UNKNOWNS]) -> bool {
        let mut bend = without(self.bend, held);
        (0..UNKNOWNS).filter(|k| held[*k]).for_each(|k| bend[(k, k)] = 2.0 * SHARP);
        bend.symmetric_eigenvalues().min() > SHARP
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

/// The second derivative of −2 log L where a standard deviation is three quarters of a spacing.
const SHARP: f64 = 3.5;

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

    /// A wrong bend is mended along the steps, and slopes do not depend on it.
    #[test]
    fn the_bend_is_learned_from_slopes() {
        let (bend, _) = bowl();
        let about = |centre: Point, bend: Matrix| {
            let close = |k: usize| value(centre + Point::from(POINTS[k]) * CLOSE);
            Surface::again(&[0, 1, 2, 3, 4].map(close), bend)
        };
        let guess = bend * 1.7 + Matrix::identity() * 0.5;
        let step = Point::new(0.5, 0.2, -0.4, 0.1);
        let first = about(Point::zeros(), bend);
        let second = about(step, guess).updated(&Surface { bend: guess, ..first }, step);
        let error = CLOSE * (guess - bend).amax();
        assert!((second.bend * step - bend * step).amax() < error, "{second:?}");
        assert!(second.bend.symmetric_eigenvalues().min() > 0.0);
    }
}
