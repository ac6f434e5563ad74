//! Exponentials of 2 × 2 matrices.

use std::ops::{Add, Mul};

/// A real 2 × 2 matrix, rows first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Matrix(pub [[f64; 2]; 2]);

impl Matrix {
    pub const ZERO: Self = Self([[0.0; 2]; 2]);
    pub const IDENTITY: Self = Self([[1.0, 0.0], [0.0, 1.0]]);

    pub fn apply(&self, v: [f64; 2]) -> [f64; 2] {
        self.0.map(|row| row[0] * v[0] + row[1] * v[1])
    }

    /// `exp(−D t)`. With the mean m of the diagonal, N = D − m and N² = δ: `exp(−mt) [cosh(√δ t) − N sinh(√δ t)/√δ]`.
    pub fn propagator(&self, t: f64) -> Self {
        let [[a, b], [c, d]] = self.0;
        let mean = 0.5 * (a + d);
        let traceless = Self([[a - mean, b], [c, d - mean]]);
        let delta = (0.5 * (a - d)).powi(2) + b * c;
        let root = delta.abs().sqrt();
        // Growth and decay are kept together, so that neither overflows alone.
        let (even, odd) = if root * t < 1e-4 {
            let square = delta * t * t;
            ((-mean * t).exp() * (1.0 + 0.5 * square), (-mean * t).exp() * t * (1.0 + square / 6.0))
        } else if delta > 0.0 {
            let (slow, fast) = (((root - mean) * t).exp(), ((-root - mean) * t).exp());
            (0.5 * (slow + fast), 0.5 * (slow - fast) / root)
        } else {
            let scale = (-mean * t).exp();
            (scale * (root * t).cos(), scale * (root * t).sin() / root)
        };
        Self::IDENTITY * even + traceless * -odd
    }
}

impl Add for Matrix {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[i][j] + other.0[i][j])))
    }
}

impl Mul<f64> for Matrix {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|row| row.map(|x| x * factor)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivative is −D exp(−Dt), for real, complex and nearly equal eigenvalues.
    #[test]
    fn it_solves_the_equation() {
        for matrix in [
            Matrix([[2.0, 0.3], [0.7, 0.5]]),
            Matrix([[1.0, -0.8], [0.9, 1.1]]),
            Matrix([[1.0, 1e-9], [1e-9, 1.0]]),
            Matrix([[1.0, 0.5], [0.0, 1.0]]),
        ] {
            let (t, h) = (0.8, 1e-5);
            let v = [0.4, -1.2];
            let at = |t: f64| matrix.propagator(t).apply(v);
            let (later, earlier, now) = (at(t + h), at(t - h), at(t));
            let expected = matrix.apply(now);
            for axis in 0..2 {
                assert!(((later[axis] - earlier[axis]) / (2.0 * h) + expected[axis]).abs() < 1e-8);
            }
        }
        assert_eq!(Matrix::ZERO.propagator(3.0), Matrix::IDENTITY);
    }
}
