//! The one scalar bound of the workspace, and the arithmetic alone.

use crate::Vector;
use num_dual::DualNumCopy;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// What a formula without branches needs of a number: every [`Scalar`] has it, and so have [`Lanes`](crate::Lanes) of several numbers.
pub trait Arithmetic:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// The constant `value`, with zero derivatives.
    fn constant(value: f64) -> Self;

    /// `1 / x`
    fn inverse(self) -> Self;

    /// `√x`
    fn root(self) -> Self;
}

impl<T: DualNumCopy<Primitive = f64>> Arithmetic for T {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::from(value)
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        self.recip()
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }
}

/// A real number or a dual number over `f64`.
///
/// Every geometric and mechanical formula is generic over this trait, or over its [`Arithmetic`]. Branches are taken on [`Scalar::real`] only.
pub trait Scalar: DualNumCopy<Primitive = f64> + Arithmetic {
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
