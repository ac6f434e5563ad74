//! Dual numbers over any arithmetic.

use crate::{Arithmetic, Elementary, Vector};
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number with its slopes along `D` directions.
///
/// What num-dual's numbers are over `f64`, over whatever else has [`Arithmetic`]: [`Lanes`](crate::Lanes) of several cells above all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent<S, const D: usize> {
    /// The number.
    pub value: S,
    /// Its derivatives along the directions.
    pub slopes: [S; D],
}

impl<S: Arithmetic, const D: usize> Tangent<S, D> {
    /// A number that does not change.
    #[inline(always)]
    pub fn held(value: S) -> Self {
        Self { value, slopes: [S::constant(0.0); D] }
    }

    /// The coordinate of a direction.
    #[inline(always)]
    pub fn along(value: S, direction: usize) -> Self {
        let mut seeded = Self::held(value);
        seeded.slopes[direction] = S::constant(1.0);
        seeded
    }

    #[inline(always)]
    fn slopes(self, value: S, f: impl Fn(S) -> S) -> Self {
        Self { value, slopes: self.slopes.map(f) }
    }

    #[inline(always)]
    fn with(self, other: Self, value: S, f: impl Fn(S, S) -> S) -> Self {
        let mut slopes = self.slopes;
        for (slope, other) in slopes.iter_mut().zip(other.slopes) {
            *slope = f(*slope, other);
        }
        Self { value, slopes }
    }
}

impl<S: Arithmetic> Tangent<S, 2> {
    /// A vector that does not change.
    #[inline(always)]
    pub fn held_vector(v: Vector<S>) -> Vector<Self> {
        Vector::new(Self::held(v.x), Self::held(v.y))
    }

    /// A vector along whose two components others are differentiated.
    #[inline(always)]
    pub fn seeded_vector(v: Vector<S>) -> Vector<Self> {
        Vector::new(Self::along(v.x, 0), Self::along(v.y, 1))
    }

    /// The derivative of a vector by the one that was seeded, `[xx, xy, yx, yy]`, row = component of the vector.
    #[inline(always)]
    pub fn block(v: &Vector<Self>) -> [S; 4] {
        let ([xx, xy], [yx, yy]) = (v.x.slopes, v.y.slopes);
        [xx, xy, yx, yy]
    }
}

impl<S: Arithmetic, const D: usize> Arithmetic for Tangent<S, D> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::held(S::constant(value))
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        let inverse = self.value.inverse();
        let change = -(inverse * inverse);
        self.slopes(inverse, |slope| slope * change)
    }

    #[inline(always)]
    fn root(self) -> Self {
        let root = self.value.root();
        let change = root.inverse() * 0.5;
        self.slopes(root, |slope| slope * change)
    }
}

impl<S: Elementary, const D: usize> Elementary for Tangent<S, D> {
    #[inline(always)]
    fn real(&self) -> f64 {
        self.value.real()
    }

    #[inline(always)]
    fn sine(self) -> Self {
        let change = self.value.cosine();
        self.slopes(self.value.sine(), |slope| slope * change)
    }

    #[inline(always)]
    fn cosine(self) -> Self {
        let change = -self.value.sine();
        self.slopes(self.value.cosine(), |slope| slope * change)
    }

    #[inline(always)]
    fn exponential(self) -> Self {
        let exponential = self.value.exponential();
        self.slopes(exponential, |slope| slope * exponential)
    }
}

impl<S: Arithmetic, const D: usize> Neg for Tangent<S, D> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.slopes(-self.value, |slope| -slope)
    }
}

impl<S: Arithmetic, const D: usize> Add for Tangent<S, D> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, self.value + other.value, |a, b| a + b)
    }
}

impl<S: Arithmetic, const D: usize> Sub for Tangent<S, D> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, self.value - other.value, |a, b| a - b)
    }
}

impl<S: Arithmetic, const D: usize> Mul for Tangent<S, D> {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the rule of the product")]
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        self.with(other, a * b, |of_a, of_b| of_a * b + of_b * a)
    }
}

macro_rules! with_constants_and_assigning {
    ($operator:ident, $method:ident, $assign:ident, $assign_method:ident, $slopes:expr) => {
        impl<S: Arithmetic, const D: usize> $operator<f64> for Tangent<S, D> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.slopes(self.value.$method(other), |slope| $slopes(slope, other))
            }
        }

        impl<S: Arithmetic, const D: usize> $assign for Tangent<S, D> {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
    };
}

with_constants_and_assigning!(Add, add, AddAssign, add_assign, |slope, _| slope);
with_constants_and_assigning!(Sub, sub, SubAssign, sub_assign, |slope, _| slope);
with_constants_and_assigning!(Mul, mul, MulAssign, mul_assign, |slope, by| slope * by);
