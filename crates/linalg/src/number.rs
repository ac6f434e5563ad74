//! What the sparse solvers take for numbers.

use faer::traits::ComplexField;
use num_complex::Complex64;
use std::ops::{AddAssign, Mul, SubAssign};

/// Real or complex numbers of double precision.
pub(crate) trait Number:
    ComplexField<Real = f64> + Copy + Send + Sync + AddAssign + SubAssign + Mul<Output = Self>
{
    /// The imaginary part only where there is room for one.
    fn from_complex(value: Complex64) -> Self;
    fn to_complex(self) -> Complex64;
    fn is_regular(self) -> bool;
    /// Vectors that span what an eigenvector of a matrix of such numbers does, with that of the conjugate value if there is one.
    fn span(vector: &[Complex64]) -> Vec<Vec<Complex64>>;
}

impl Number for f64 {
    fn from_complex(value: Complex64) -> Self {
        value.re
    }
    fn to_complex(self) -> Complex64 {
        self.into()
    }
    fn is_regular(self) -> bool {
        self.is_finite() && self != 0.0
    }
    fn span(vector: &[Complex64]) -> Vec<Vec<Complex64>> {
        let part = |part: fn(&Complex64) -> f64| vector.iter().map(|x| part(x).into()).collect();
        vec![part(|x| x.re), part(|x| x.im)]
    }
}

impl Number for Complex64 {
    fn from_complex(value: Complex64) -> Self {
        value
    }
    fn to_complex(self) -> Complex64 {
        self
    }
    fn is_regular(self) -> bool {
        self.re.is_finite() && self.im.is_finite() && self != Complex64::ZERO
    }
    fn span(vector: &[Complex64]) -> Vec<Vec<Complex64>> {
        vec![vector.to_vec()]
    }
}
