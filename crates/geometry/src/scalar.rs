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

/// What a formula needs that has branches, which are taken on the real part, or other functions. Every [`Scalar`] has it, and so have its
/// [`Tangent`](crate::Tangent)s.
pub trait Elementary: Arithmetic {
    /// The real part.
    fn real(&self) -> f64;

    /// `sin x`
    fn sine(self) -> Self;

    /// `cos x`
    fn cosine(self) -> Self;

    /// `eˣ`
    fn exponential(self) -> Self;

    /// `xⁿ`
    #[inline(always)]
    fn power(self, n: u32) -> Self {
        let (mut power, mut square, mut left) = (Self::constant(1.0), self, n);
        while left > 0 {
            if left % 2 == 1 {
                power *= square;
            }
            square *= square;
            left /= 2;
        }
        power
    }
}

impl<T: DualNumCopy<Primitive = f64>> Elementary for T {
    #[inline(always)]
    fn real(&self) -> f64 {
        self.re()
    }

    #[inline(always)]
    fn sine(self) -> Self {
        self.sin()
    }

    #[inline(always)]
    fn cosine(self) -> Self {
        self.cos()
    }

    #[inline(always)]
    fn exponential(self) -> Self {
        self.exp()
    }
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
/// Every geometric and mechanical formula is generic over this trait, or over what it needs of it: [`Elementary`] functions, or [`Arithmetic`] alone.
/// Branches are taken on [`Elementary::real`] only.
pub trait Scalar: DualNumCopy<Primitive = f64> + Elementary {}

impl<T: DualNumCopy<Primitive = f64>> Scalar for T {}

/// Positions as constants of another scalar: the values are kept, the derivatives are zero.
pub fn lift<S: Scalar>(positions: &[Vector<f64>]) -> Vec<Vector<S>> {
    positions.iter().map(|r| Vector::new(S::constant(r.x), S::constant(r.y))).collect()
}
