//! Which diagonal of a quadrilateral is a Delaunay edge.

use crate::{Domain, Vector, cross};
use robust::{Coord, incircle};

/// A cell and the lattice vectors to the image that is meant.
pub(super) type Site = (u32, [i16; 2]);

/// Share of the sum of magnitudes below which a sum is taken for zero, in ties only.
const CANCELLED: f64 = 1e-9;

/// Whether the diagonal from the first to the third of four sites is an edge of the Delaunay triangulation. The sites are
/// counter-clockwise, and so are the two triangles that the diagonal makes of them.
///
/// The sign of the in-circle determinant is exact. The answer depends on the four sites only, not on the one that is
/// named first: coordinates are taken relative to the lowest cell. Four sites on one circle get the diagonal that they
/// would have if each cell were lifted off the paraboloid by an infinitesimal amount, the lowest cell downwards most:
/// a fan from the lowest cell. If the images of one cell balance, the box is sheared, then stretched, by an infinitesimal
/// amount. In an open field either diagonal would do: `None`.
pub(super) fn is_delaunay(positions: &[Vector<f64>], domain: &Domain, sites: [Site; 4]) -> Option<bool> {
    let first = (0..4).min_by_key(|&k| sites[k]).unwrap_or(0);
    let ordered: [Site; 4] = std::array::from_fn(|k| sites[(first + k) % 4]);
    let (origin, [x, y]) = ordered[0];
    let at = ordered.map(|(cell, image)| {
        let image = [image[0] - x, image[1] - y];
        domain.displacement(positions[origin as usize], positions[cell as usize], image)
    });
    let inside = match of_mirror_images(at).unwrap_or_else(|| {
        let [a, b, c, d] = at.map(|r| Coord { x: r.x, y: r.y });
        incircle(a, b, c, d)
    }) {
        0.0 if matches!(domain, Domain::Open) => return None,
        0.0 => tie(ordered.map(|(cell, _)| cell), at),
        sign => sign,
    };
    // Going on by one site is an odd permutation of the rows of the determinant.
    Some(if first % 2 == 0 { inside <= 0.0 } else { inside >= 0.0 })
}

/// The sign of the in-circle determinant of four points, the first of which is the origin, if two of them are exactly as far along an axis as the
/// other two are each: so it is with two cells and their images in a wall, in every step.
///
/// A circle through (0, 0), (w, 0) and (a, b) has the power `(c − a)(c + a − w)` at (c, b), of which the sign needs no more than one rounding error.
fn of_mirror_images(at: [Vector<f64>; 4]) -> Option<f64> {
    [1, 0].into_iter().find_map(|axis| {
        let beside = (1..4).find(|&k| at[k][axis] == 0.0)?;
        let [one, other] = [[2, 3], [1, 3], [1, 2]][beside - 1];
        let height = at[one][axis];
        if height == 0.0 || height != at[other][axis] {
            return None;
        }
        let [w, a, c] = [beside, one, other].map(|k| at[k][1 - axis]);
        let power = sign(c - a) * sign_of_sum(c, a, w);
        // By the order of the points and by that of the axes.
        let turned = if (beside == 2) == (axis == 0) { -1.0 } else { 1.0 };
        Some(turned * sign(w) * sign(height) * power)
    })
}

/// −1, 0 or 1.
fn sign(x: f64) -> f64 {
    f64::from(i8::from(x > 0.0) - i8::from(x < 0.0))
}

/// The sign of `a + b − c`.
fn sign_of_sum(a: f64, b: f64, c: f64) -> f64 {
    let sum = a + b;
    if sum != c {
        return sign(sum - c);
    }
    let of_b = sum - a;
    sign((a - (sum - of_b)) + (b - of_b))
}

/// The sign of the determinant of four sites on one circle after the infinitesimal displacements.
fn tie(cells: [u32; 4], at: [Vector<f64>; 4]) -> f64 {
    let orientation = |a: usize, b: usize, c: usize| cross(at[b] - at[a], at[c] - at[a]);
    let cofactors =
        [orientation(1, 2, 3), -orientation(0, 2, 3), orientation(0, 1, 3), -orientation(0, 1, 2)];
    let sum = |height: &dyn Fn(usize) -> f64| {
        let (mut sum, mut magnitude) = (0.0, 0.0);
        for (k, cofactor) in cofactors.iter().enumerate() {
            sum += cofactor * height(k);
            magnitude += (cofactor * height(k)).abs();
        }
        (sum.abs() > CANCELLED * magnitude).then_some(sum)
    };
    let mut lowest_first = cells;
    lowest_first.sort_unstable();
    lowest_first
        .iter()
        .find_map(|&lowered| sum(&|k| if cells[k] == lowered { -1.0 } else { 0.0 }))
        .or_else(|| sum(&|k| at[k].x * at[k].y))
        .or_else(|| sum(&|k| at[k].y * at[k].y))
        .unwrap_or(0.0)
}
