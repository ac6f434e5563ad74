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

/// A matrix `column ⊗ row`: what a change does, along one direction alone, in proportion to one component of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outer<S> {
    /// The direction of what changes.
    pub column: Vector<S>,
    /// The component of the change that counts.
    pub row: Vector<S>,
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

    /// Forces on the two neighbours to which a force `f` on the vertex is pulled back: `fᵀ ∂c/∂a` and `fᵀ ∂c/∂b`.
    ///
    /// Differentiating `a·c = a²/2`, `b·c = b²/2` gives `∂c/∂a = −(ẑ×b)/(a×b) ⊗ (a − c)` and
    /// `∂c/∂b = (ẑ×a)/(a×b) ⊗ (b − c)`. The rest of `f` acts on the cell itself.
    #[inline(always)]
    pub fn pull_back(&self, f: Vector<S>) -> [Vector<S>; 2] {
        let (on_a, on_b) = (cross(f, self.b) * self.inverse_cross, cross(self.a, f) * self.inverse_cross);
        [(self.a - self.centre) * on_a, (self.b - self.centre) * on_b]
    }

    /// How the circumcentre moves with each of the two neighbours: `∂c/∂a` and `∂c/∂b`, see [`Corner::pull_back`].
    #[inline(always)]
    pub fn centre_slopes(&self) -> [Outer<S>; 2] {
        [
            Outer { column: -quarter_turn(self.b) * self.inverse_cross, row: self.a - self.centre },
            Outer { column: quarter_turn(self.a) * self.inverse_cross, row: self.b - self.centre },
        ]
    }

    /// How the forces that [`Corner::pull_back`] gives change with the two neighbours, if the force `f` on the vertex changes with each of them by
    /// `slopes`: blocks `[xx, xy, yx, yy]` of the force on a by a, on a by b, on b by a, on b by b.
    ///
    /// With `k = 1/(a × b)` the forces are `g_a = s_a (a − c)` with `s_a = k f × b`, and `g_b = s_b (b − c)` with `s_b = k a × f`. From
    /// `∂k/∂a = k² ẑ×b` and `∂k/∂b = −k² ẑ×a`, and for `∂f/∂a = u_a ⊗ w_a`, `∂f/∂b = u_b ⊗ w_b`,
    ///
    /// ```text
    /// ∂s_a/∂a = k (u_a × b) w_a + s_a k ẑ×b             ∂s_a/∂b = k (u_b × b) w_b + k ẑ×f − s_a k ẑ×a
    /// ∂s_b/∂a = k (a × u_a) w_a − k ẑ×f + s_b k ẑ×b     ∂s_b/∂b = k (a × u_b) w_b − s_b k ẑ×a
    /// ```
    #[inline(always)]
    pub fn pull_back_slopes(&self, f: Vector<S>, slopes: [Outer<S>; 2]) -> [[[S; 4]; 2]; 2] {
        let (a, b, k) = (self.a, self.b, self.inverse_cross);
        let [by_a, by_b] = slopes;
        let (s_a, s_b) = (cross(f, b) * k, cross(a, f) * k);
        let (turned_a, turned_b, turned_f) = (quarter_turn(a) * k, quarter_turn(b) * k, quarter_turn(f) * k);
        let s_a_by = [
            by_a.row * (cross(by_a.column, b) * k) + turned_b * s_a,
            by_b.row * (cross(by_b.column, b) * k) + turned_f - turned_a * s_a,
        ];
        let s_b_by = [
            by_a.row * (cross(a, by_a.column) * k) - turned_f + turned_b * s_b,
            by_b.row * (cross(a, by_b.column) * k) - turned_a * s_b,
        ];
        let (from_a, from_b) = (a - self.centre, b - self.centre);
        let [c_by_a, c_by_b] = self.centre_slopes();
        let block = |from: Vector<S>, s_by: Vector<S>, c_by: Outer<S>, s: S| {
            let back = c_by.column * s;
            [
                from.x * s_by.x - back.x * c_by.row.x,
                from.x * s_by.y - back.x * c_by.row.y,
                from.y * s_by.x - back.y * c_by.row.x,
                from.y * s_by.y - back.y * c_by.row.y,
            ]
        };
        let mut on_a = [block(from_a, s_a_by[0], c_by_a, s_a), block(from_a, s_a_by[1], c_by_b, s_a)];
        let mut on_b = [block(from_b, s_b_by[0], c_by_a, s_b), block(from_b, s_b_by[1], c_by_b, s_b)];
        for diagonal in [0, 3] {
            on_a[0][diagonal] += s_a;
            on_b[1][diagonal] += s_b;
        }
        [on_a, on_b]
    }

    /// The blocks of [`Corner::pull_back_slopes`], transposed, applied to `u`: by a and by b, how `g_a·u_a + g_b·u_b` changes at fixed `u`.
    ///
    /// With `α = (a − c)·u_a`, `β = (b − c)·u_b`, `v = s_a u_a + s_b u_b` and `w = α b − β a`,
    ///
    /// ```text
    /// by a:   k (u_a × w) w_a + (s_a α + s_b β) k ẑ×b − β k ẑ×f − (∂c/∂a)ᵀ v + s_a u_a
    /// by b:   k (u_b × w) w_b − (s_a α + s_b β) k ẑ×a + α k ẑ×f − (∂c/∂b)ᵀ v + s_b u_b
    /// ```
    ///
    /// where the first terms have the `u_a ⊗ w_a` and `u_b ⊗ w_b` of the slopes.
    #[inline(always)]
    pub fn pull_back_slopes_transposed(
        &self,
        f: Vector<S>,
        slopes: [Outer<S>; 2],
        u: [Vector<S>; 2],
    ) -> [Vector<S>; 2] {
        let (a, b, k) = (self.a, self.b, self.inverse_cross);
        let ([by_a, by_b], [c_by_a, c_by_b], [u_a, u_b]) = (slopes, self.centre_slopes(), u);
        let (s_a, s_b) = (cross(f, b) * k, cross(a, f) * k);
        let (alpha, beta) = (dot(a - self.centre, u_a), dot(b - self.centre, u_b));
        let (pulled_a, pulled_b) = (u_a * s_a, u_b * s_b);
        let (between, pulled) = (b * alpha - a * beta, pulled_a + pulled_b);
        let sum = s_a * alpha + s_b * beta;
        let on_a = by_a.row * (cross(by_a.column, between) * k)
            + (quarter_turn(b) * sum - quarter_turn(f) * beta) * k
            - c_by_a.row * dot(c_by_a.column, pulled)
            + pulled_a;
        let on_b = by_b.row * (cross(by_b.column, between) * k)
            + (quarter_turn(f) * alpha - quarter_turn(a) * sum) * k
            - c_by_b.row * dot(c_by_b.column, pulled)
            + pulled_b;
        [on_a, on_b]
    }
}

/// How [`side_direction`] changes with the neighbour: `∂t/∂d = −(d/d²) ⊗ t`.
#[inline(always)]
pub fn side_direction_slope<S: Arithmetic>(d: Vector<S>, direction: Vector<S>) -> Outer<S> {
    Outer { column: -d * dot(d, d).inverse(), row: direction }
}

/// Unit vector along the side that faces a neighbour at `d`, counter-clockwise about the cell: `ẑ × d / |d|`.
///
/// A Voronoi side is perpendicular to the line between the centres. Its direction taken from the centres stays smooth
/// where the side shrinks to nothing.
#[inline(always)]
pub fn side_direction<S: Arithmetic>(d: Vector<S>) -> Vector<S> {
    quarter_turn(d) * dot(d, d).root().inverse()
}
