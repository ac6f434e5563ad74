//! The one scalar bound of the workspace.

use crate::Vector;
use num_dual::DualNumCopy;

/// A real number or a dual number over `f64`.
///
/// Every geometric and mechanical formula is generic over this trait. Branches are taken on [`Scalar::real`] only.
pub trait Scalar: DualNumCopy<Primitive = f64> {
    /// The constant `value`, with zero derivatives.
    fn constant(value: f64) -> Self {
        Self::from(value)
    }

    /// The real part.
    fn real(&self) -> f64 {
        self.re()
    }
}

impl<T: DualNumCopy<Primitive = f64>> Scalar for T {}

/// Positions as constants of another scalar: the values are kept, the derivatives are zero.
pub fn lift<S: Scalar>(positions: &[Vector<f64>]) -> Vec<Vector<S>> {
    positions.iter().map(|r| Vector::new(S::constant(r.x), S::constant(r.y))).collect()
}
