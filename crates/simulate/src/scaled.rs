//! Vectors of any scalar: times plain numbers, and without derivatives.

use std::any::Any;
use voronudge_geometry::{Scalar, Vector};

pub(crate) fn zero<S: Scalar>() -> Vector<S> {
    Vector::new(S::constant(0.0), S::constant(0.0))
}

pub(crate) fn times<S: Scalar>(v: Vector<S>, factor: f64) -> Vector<S> {
    Vector::new(v.x * factor, v.y * factor)
}

/// A vector without derivatives.
pub(crate) fn real<S: Scalar>(v: &Vector<S>) -> Vector<f64> {
    Vector::new(v.x.real(), v.y.real())
}

/// The same of many, put in a place that is kept for them; plain numbers stay where they are.
#[expect(clippy::ptr_arg, reason = "the type of a vector can be asked for")]
pub(crate) fn without_derivatives<'a, S: Scalar>(
    positions: &'a Vec<Vector<S>>,
    places: &'a mut Vec<Vector<f64>>,
) -> &'a [Vector<f64>] {
    if let Some(plain) = (positions as &dyn Any).downcast_ref::<Vec<Vector<f64>>>() {
        return plain;
    }
    places.clear();
    places.extend(positions.iter().map(real));
    places
}
