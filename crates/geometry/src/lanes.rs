//! Several numbers at once.
//!
//! Processors work on two, four or eight numbers with one instruction. A formula that has no branches does so for as many cells if it is
//! given [`Lanes`] for numbers. Each lane is computed as a number of its own would be, operation by operation and without fusing any two, so the results are the
//! same to the last bit on every processor.

use crate::Arithmetic;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// Numbers of several cells, one to a lane.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct Lanes(pub [f64; Lanes::WIDTH]);

impl Lanes {
    /// How many there are.
    pub const WIDTH: usize = 4;

    /// Writes one of them.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, value: f64) {
        self.0[lane] = value;
    }

    #[inline(always)]
    fn map(mut self, f: impl Fn(f64) -> f64) -> Self {
        for lane in &mut self.0 {
            *lane = f(*lane);
        }
        self
    }

    #[inline(always)]
    pub(crate) fn with(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for (lane, other) in self.0.iter_mut().zip(other.0) {
            *lane = f(*lane, other);
        }
        self
    }
}

impl Arithmetic for Lanes {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([value; Self::WIDTH])
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        self.map(f64::recip)
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.map(f64::sqrt)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $assign:ident, $assign_method:ident) => {
        impl $operator for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(other, f64::$method)
            }
        }

        impl $operator<f64> for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.map(|x| x.$method(other))
            }
        }

        impl $assign for Lanes {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
    };
}

operator!(Add, add, AddAssign, add_assign);
operator!(Sub, sub, SubAssign, sub_assign);
operator!(Mul, mul, MulAssign, mul_assign);
