//! Vectors of the plane and the circumcentre.

use crate::Scalar;

/// A vector or a point of the plane, y axis up.
pub type Vector<S> = nalgebra::Vector2<S>;

/// `a × b = a_x b_y − a_y b_x`, positive if `b` is counter-clockwise of `a`.
#[inline]
pub fn cross<S: Scalar>(a: Vector<S>, b: Vector<S>) -> S {
    a.x * b.y - a.y * b.x
}

/// `a · b`.
#[inline]
pub fn dot<S: Scalar>(a: Vector<S>, b: Vector<S>) -> S {
    a.x * b.x + a.y * b.y
}

/// `ẑ × (a_x, a_y) = (−a_y, a_x)`: the counter-clockwise quarter turn.
#[inline]
pub fn quarter_turn<S: Scalar>(a: Vector<S>) -> Vector<S> {
    Vector::new(-a.y, a.x)
}

/// Circumcentre `c` of the triangle (0, a, b), from `a·c = a²/2`, `b·c = b²/2`:
///
/// `c = ẑ × (a b² − b a²) / (2 a × b)`
///
/// The triangle must not be degenerate (`a × b ≠ 0`).
///
/// ```
/// use voronudge_geometry::{Vector, circumcentre};
/// let c = circumcentre(Vector::new(2.0, 0.0), Vector::new(0.0, 4.0));
/// assert_eq!(c, Vector::new(1.0, 2.0));
/// ```
#[inline]
pub fn circumcentre<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    let (a2, b2) = (dot(a, a), dot(b, b));
    let scale = (cross(a, b) * 2.0).recip();
    Vector::new(
        (b.y * a2 - a.y * b2) * scale,
        (a.x * b2 - b.x * a2) * scale,
    )
}
