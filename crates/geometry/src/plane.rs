//! Vectors of the plane and the circumcentre.

use crate::Arithmetic;

/// A vector or a point of the plane, y axis up.
pub type Vector<S> = nalgebra::Vector2<S>;

/// `a × b = a_x b_y − a_y b_x`, positive if `b` is counter-clockwise of `a`.
#[inline(always)]
pub fn cross<S: Arithmetic>(a: Vector<S>, b: Vector<S>) -> S {
    a.x * b.y - a.y * b.x
}

/// `a · b`.
#[inline(always)]
pub fn dot<S: Arithmetic>(a: Vector<S>, b: Vector<S>) -> S {
    a.x * b.x + a.y * b.y
}

/// `ẑ × (a_x, a_y) = (−a_y, a_x)`: the counter-clockwise quarter turn.
#[inline(always)]
pub fn quarter_turn<S: Arithmetic>(a: Vector<S>) -> Vector<S> {
    Vector::new(-a.y, a.x)
}

/// Circumcentre `c` of the triangle (0, a, b) from `a·c = a²/2`, `b·c = b²/2`:
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
#[inline(always)]
pub fn circumcentre<S: Arithmetic>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    Corner::new(a, b).centre
}

/// The triangle (0, a, b) of a cell and two consecutive neighbours, counter-clockwise, with its circumcentre.
#[derive(Debug, Clone, Copy)]
pub struct Corner<S> {
    /// First neighbour, relative to the cell.
    pub a: Vector<S>,
    /// Second neighbour, relative to the cell.
    pub b: Vector<S>,
    /// Circumcentre, relative to the cell: the Voronoi vertex.
    pub centre: Vector<S>,
    /// `1 / (a × b)`
    inverse_cross: S,
}

impl<S: Arithmetic> Corner<S> {
    /// A place to write a corner to.
    pub(crate) fn nowhere() -> Self {
        let zero = S::constant(0.0);
        let at = Vector::new(zero, zero);
        Self { a: at, b: at, centre: at, inverse_cross: zero }
    }

    /// See [`circumcentre`].
    #[inline(always)]
    pub fn new(a: Vector<S>, b: Vector<S>) -> Self {
        let (a2, b2) = (dot(a, a), dot(b, b));
        let inverse_cross = cross(a, b).inverse();
        let half = inverse_cross * 0.5;
        let centre = Vector::new((b.y * a2 - a.y * b2) * half, (a.x * b2 - b.x * a2) * half);
        Self { a, b, centre, inverse_cross }
    }

    /// Forces on the two neighbours that a force `f` on the vertex transmits: `fᵀ ∂c/∂a` and `fᵀ ∂c/∂b`.
    ///
    /// Differentiating `a·c = a²/2`, `b·c = b²/2` gives `∂c/∂a = −(ẑ×b)/(a×b) ⊗ (a − c)` and
    /// `∂c/∂b = (ẑ×a)/(a×b) ⊗ (b − c)`. The rest of `f` acts on the cell itself.
    #[inline(always)]
    pub fn transmit(&self, f: Vector<S>) -> [Vector<S>; 2] {
        let (on_a, on_b) = (cross(f, self.b) * self.inverse_cross, cross(self.a, f) * self.inverse_cross);
        [(self.a - self.centre) * on_a, (self.b - self.centre) * on_b]
    }
}

/// Unit vector along the side that faces a neighbour at `d`, counter-clockwise about the cell: `ẑ × d / |d|`.
///
/// A Voronoi side is perpendicular to the line between the centres. Its direction taken from the centres stays smooth
/// where the side shrinks to nothing.
#[inline(always)]
pub fn side_direction<S: Arithmetic>(d: Vector<S>) -> Vector<S> {
    quarter_turn(d) * dot(d, d).root().inverse()
}
