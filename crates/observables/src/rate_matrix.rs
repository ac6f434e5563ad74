//! Rates of a wave: exponentials and logarithms of 2 × 2 matrices.

use std::ops::{Add, Mul, Sub};

/// A real 2 × 2 matrix, rows first; D of `∂_t u = −D u` for a plane wave, in components along q and a quarter turn ahead.
///
/// ```
/// use voronudge_observables::RateMatrix;
/// let d = RateMatrix([[1.0, -0.8], [0.9, 1.1]]);
/// let again = RateMatrix::of_propagator(d.propagator(0.7), 0.7).unwrap();
/// assert!((again - d).0.iter().flatten().all(|entry| entry.abs() < 1e-14));
/// assert!(d.frequency() > 0.8);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateMatrix(pub [[f64; 2]; 2]);

impl RateMatrix {
    /// Nought.
    pub const ZERO: Self = Self([[0.0; 2]; 2]);
    /// One.
    pub const IDENTITY: Self = Self([[1.0, 0.0], [0.0, 1.0]]);

    /// `D v`.
    pub fn apply(&self, v: [f64; 2]) -> [f64; 2] {
        self.0.map(|row| row[0] * v[0] + row[1] * v[1])
    }

    /// `exp(−D t)`. With the mean m of the diagonal, N = D − m and N² = δ: `exp(−mt) [cosh(√δ t) − N sinh(√δ t)/√δ]`.
    pub fn propagator(&self, t: f64) -> Self {
        let (mean, traceless, delta) = self.split();
        let root = delta.abs().sqrt();
        // Growth and decay are kept together, so that neither overflows alone.
        let (even, odd) = if (root * t).abs() < 1e-4 {
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

    /// The D whose [`propagator`](Self::propagator) over the time `t` is that: `−log(M)/t`, with the frequency below π/t. With m and δ of M,
    /// `log M = ½ log det M + (M − m) artanh(√δ/m)/√δ`. `None` where M has an eigenvalue that is not positive.
    pub fn of_propagator(propagator: Self, t: f64) -> Option<Self> {
        let (mean, traceless, delta) = propagator.split();
        let determinant = propagator.determinant();
        let root = delta.abs().sqrt();
        let oscillates = delta < 0.0;
        if !(determinant > 0.0 && determinant.is_finite() && (oscillates || mean > 0.0)) {
            return None;
        }
        let slope = if root < 1e-6 * mean {
            (1.0 + delta / (3.0 * mean * mean)) / mean
        } else if oscillates {
            root.atan2(mean) / root
        } else {
            (root / mean).atanh() / root
        };
        Some((Self::IDENTITY * (0.5 * determinant.ln()) + traceless * slope) * (-1.0 / t))
    }

    /// The inverse, if there is one.
    pub fn inverse(&self) -> Option<Self> {
        let [[a, b], [c, d]] = self.0;
        let determinant = self.determinant();
        let inverse = Self([[d, -b], [-c, a]]) * (1.0 / determinant);
        (determinant != 0.0 && determinant.is_finite()).then_some(inverse)
    }

    /// The determinant.
    pub fn determinant(&self) -> f64 {
        let [[a, b], [c, d]] = self.0;
        a * d - b * c
    }

    /// `δ = ¼ (D_11 − D_22)² + D_12 D_21`: the wave oscillates where it is negative.
    pub fn discriminant(&self) -> f64 {
        self.split().2
    }

    /// Real parts of the eigenvalues, the slower decay first.
    pub fn decay_rates(&self) -> [f64; 2] {
        let (mean, _, delta) = self.split();
        let root = delta.max(0.0).sqrt();
        [mean - root, mean + root]
    }

    /// Magnitude of the imaginary parts of the eigenvalues: the angular frequency.
    pub fn frequency(&self) -> f64 {
        (-self.discriminant()).max(0.0).sqrt()
    }

    /// Mean m of the diagonal, what is left without it, and the number δ that the square of the rest is.
    fn split(&self) -> (f64, Self, f64) {
        let [[a, b], [c, d]] = self.0;
        let mean = 0.5 * (a + d);
        (mean, Self([[a - mean, b], [c, d - mean]]), (0.5 * (a - d)).powi(2) + b * c)
    }
}

impl Add for RateMatrix {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[i][j] + other.0[i][j])))
    }
}

impl Sub for RateMatrix {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul<f64> for RateMatrix {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|row| row.map(|x| x * factor)))
    }
}

impl Mul for RateMatrix {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let entry = |i: usize, j: usize| self.0[i][0] * other.0[0][j] + self.0[i][1] * other.0[1][j];
        Self([[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]])
    }
}
