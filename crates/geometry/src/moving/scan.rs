//! One pass over all cells: is the tessellation still that of the positions?

use super::diagonal::Site;
use super::split::CHUNK;
use crate::builder::MOST_BOXES;
use crate::{Domain, Tessellation, Vector, cross};
use rayon::prelude::*;

/// Bounds of the rounding errors of a cross product and of the in-circle determinant, in units of
/// ε · (largest coordinate) · (length of the ring)^n. Four displacements, each rounded thrice at the size of the
/// coordinates, enter the determinant with slopes of at most 9 (length)³.
const CROSS_MARGIN: f64 = 24.0 * f64::EPSILON;
const DETERMINANT_MARGIN: f64 = 256.0 * f64::EPSILON;

/// A Delaunay edge as seen from one of its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge {
    pub from: u32,
    pub to: Site,
}

/// What a scan found.
pub(super) enum Finding {
    /// Every triangle is counter-clockwise. These edges are not, or to rounding not surely, Delaunay edges; all others
    /// are. If there are none, the tessellation is that of the positions.
    Suspects(Vec<Edge>),
    /// A triangle is turned over, or to rounding flat; or cells are too far from the box.
    Inverted,
}

/// Looks at every triangle and every edge of a periodic tessellation.
///
/// Triangles that are all counter-clockwise cover the torus once, because their images are those of a tessellation of it;
/// edges that are all locally Delaunay then make the Delaunay triangulation. The pass is thus a proof.
pub(super) fn scan(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Finding {
    let Domain::Periodic(cell_box) = tessellation.domain() else {
        return Finding::Inverted;
    };
    let extent = positions
        .par_chunks(CHUNK)
        .map(|chunk| chunk.iter().map(|r| r.x.abs().max(r.y.abs())).fold(0.0, f64::max))
        .reduce(|| 0.0, f64::max);
    let [width, height] = cell_box.lengths();
    // Images are counted in 16 bits.
    if extent > MOST_BOXES * width.min(height) {
        return Finding::Inverted;
    }
    let size = 2.0 * extent + width + height + cell_box.offset().abs();
    let chunks = positions.len().div_ceil(CHUNK);
    let findings: Option<Vec<Vec<Edge>>> = (0..chunks)
        .into_par_iter()
        .map(|chunk| {
            let last = ((chunk + 1) * CHUNK).min(positions.len());
            scan_cells(tessellation, positions, size, chunk * CHUNK..last)
        })
        .collect();
    findings.map_or(Finding::Inverted, |lists| Finding::Suspects(lists.concat()))
}

/// A neighbour relative to the cell, and the square of its distance.
type Lifted = (Vector<f64>, f64);

fn scan_cells(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    size: f64,
    cells: std::ops::Range<usize>,
) -> Option<Vec<Edge>> {
    let mut suspects = Vec::new();
    let mut ring: Vec<Lifted> = Vec::with_capacity(16);
    for cell in cells {
        ring.clear();
        ring.extend(tessellation.displacements(positions, cell).map(|d| (d, d.x * d.x + d.y * d.y)));
        let sides = ring.len();
        if sides < 3 {
            return None;
        }
        let (farthest, total) =
            ring.iter().fold((0.0f64, 0.0), |(most, sum), (_, square)| (most.max(*square), sum + square));
        ring.extend_from_within(..2);
        let (mut least_cross, mut least) = (f64::INFINITY, f64::INFINITY);
        let mut first = cross(ring[0].0, ring[1].0);
        for corner in ring.windows(3) {
            let second = cross(corner[1].0, corner[2].0);
            least_cross = least_cross.min(second);
            least = least.min(determinant(corner[0], corner[1], corner[2], first, second));
            first = second;
        }
        let length = farthest.sqrt();
        // Extrema pass over NaN, sums do not.
        if !(least_cross > CROSS_MARGIN * size * length && total < f64::INFINITY) {
            return None;
        }
        let margin = DETERMINANT_MARGIN * size * length * farthest;
        if least > margin {
            continue;
        }
        for (m, corner) in ring.windows(3).enumerate() {
            let (first, second) = (cross(corner[0].0, corner[1].0), cross(corner[1].0, corner[2].0));
            if determinant(corner[0], corner[1], corner[2], first, second) <= margin {
                let h = tessellation.half_edge_start(cell) + (m + 1) % sides;
                let (other, image) = (tessellation.neighbour[h], tessellation.image[h]);
                // Each edge from one end only.
                if (other, image) > (cell as u32, [0, 0]) {
                    suspects.push(Edge { from: cell as u32, to: (other, image) });
                }
            }
        }
    }
    Some(suspects)
}

/// `a² (b × c) − b² (a × c) + c² (a × b)`, given the cross products of the two triangles (0, a, b) and (0, b, c): positive if
/// the edge between them, from the cell at 0 to b, is a Delaunay edge. c then lies outside the circle through 0, a and b.
#[inline]
fn determinant((a, a2): Lifted, (_, b2): Lifted, (c, c2): Lifted, a_cross_b: f64, b_cross_c: f64) -> f64 {
    a2 * b_cross_c - b2 * cross(a, c) + c2 * a_cross_b
}
