//! From positions to the flat arrays of a [`Tessellation`]: ghost images, spade, rings, twins.
//!
//! The Delaunay triangulation of a neighbourhood depends on that neighbourhood only. A large periodic box is therefore
//! cut into tiles, each triangulated with a strip of surrounding cells; this fits the caches and uses all threads, and a
//! small box is the case of one tile whose surroundings are its own images.

mod rings;
mod tile;

use crate::moving::Repair;
use crate::{Domain, Error, PeriodicBox, Tessellation, Vector};
use rayon::prelude::*;
pub(crate) use rings::find_twins;
use rings::{Rings, assemble};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};
use tile::Tiling;

/// A point of a triangulation: a cell or a periodic image of one.
#[derive(Clone, Copy)]
struct Site {
    position: Point2<f64>,
    cell: u32,
    image: [i16; 2],
    role: Role,
}

/// Whether a site's ring is wanted, or only its presence.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Own,
    Ghost,
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// Sizes, relative to √(area per cell), of the displacements that break ties between cells on one circle. They move the
/// question of who is a neighbour, not the cells. The box is sheared by as much, for ties among images of one cell.
const TIE_BREAKS: [f64; 4] = [0.0, 1e-11, 1e-9, 1e-7];

/// Largest distance of a position from the origin, in boxes: images are counted in 16 bits.
pub(crate) const MOST_BOXES: f64 = 8192.0;

/// Replaces the topology of `tessellation` by that of `positions`.
pub(crate) fn rebuild(tessellation: &mut Tessellation, positions: &[Vector<f64>]) -> Result<(), Error> {
    let cells = positions.len();
    if cells > Tessellation::CELL_LIMIT {
        return Err(Error::TooManyCells { cells, limit: Tessellation::CELL_LIMIT });
    }
    for (cell, r) in positions.iter().enumerate() {
        if !(r.x.abs() < 1e100 && r.y.abs() < 1e100) {
            return Err(Error::Position { cell, x: r.x, y: r.y });
        }
    }
    match tessellation.domain() {
        Domain::Periodic(cell_box) => periodic(tessellation, positions, &cell_box),
        Domain::Open => open(tessellation, positions),
    }
}

fn open(tessellation: &mut Tessellation, positions: &[Vector<f64>]) -> Result<(), Error> {
    let cells = positions.len();
    if cells < 3 {
        return Err(Error::TooFewCells { found: cells, required: 3 });
    }
    let sites = positions
        .iter()
        .enumerate()
        .map(|(cell, r)| Site { position: point(*r), cell: cell as u32, image: [0, 0], role: Role::Own })
        .collect();
    let delaunay = triangulate(sites).ok_or_else(|| duplicate(positions))?;
    if delaunay.num_inner_faces() == 0 {
        return Err(Error::Collinear { cells });
    }
    assemble(tessellation, cells, &[Rings::of_all(&delaunay)])
}

fn periodic(
    tessellation: &mut Tessellation,
    positions: &[Vector<f64>],
    cell_box: &PeriodicBox,
) -> Result<(), Error> {
    let cells = positions.len();
    if cells == 0 {
        return Err(Error::TooFewCells { found: 0, required: 1 });
    }
    let images: Vec<[i32; 2]> = positions.iter().map(|r| cell_box.image(*r)).collect();
    if let Some(cell) = images.iter().position(|n| n.iter().any(|n| f64::from(*n).abs() > MOST_BOXES)) {
        return Err(Error::Position { cell, x: positions[cell].x, y: positions[cell].y });
    }
    let spacing = (cell_box.area() / cells as f64).sqrt();
    let mut outcome = Ok(());
    for tie_break in TIE_BREAKS {
        let wrapped: Vec<Vector<f64>> = positions
            .iter()
            .zip(&images)
            .enumerate()
            .map(|(cell, (r, n))| match tie_break {
                0.0 => r - cell_box.translation(*n),
                size => r - cell_box.translation(*n) + jitter(cell) * (size * spacing),
            })
            .collect();
        let nudged = PeriodicBox::sheared(cell_box.lengths(), cell_box.offset() + tie_break * spacing)?;
        let tiling = Tiling::new(&wrapped, &nudged);
        let rings: Option<Vec<Rings>> =
            (0..tiling.len()).into_par_iter().map(|tile| tiling.rings(tile)).collect();
        outcome = assemble(tessellation, cells, &rings.ok_or_else(|| duplicate(&wrapped))?);
        // Where images of one circle of cells were triangulated differently, all may miss its diagonal.
        if outcome.is_ok() && tessellation.half_edges() != 6 * cells {
            outcome = Err(Error::Inconsistent { cells, cell: 0 });
        }
        if outcome.is_ok() {
            rings::refer_to_given_positions(tessellation, &images);
            // Ties were broken by whatever came first; the flips break them by a rule. Nearly flat triangles stay.
            let _ = Repair::default().attempt(tessellation, positions);
            break;
        }
    }
    outcome
}

fn point(r: Vector<f64>) -> Point2<f64> {
    // spade refuses magnitudes below 1e-142, which are zero for any unit of length.
    let flush = |x: f64| if x.abs() < 1e-140 { 0.0 } else { x };
    Point2::new(flush(r.x), flush(r.y))
}

/// A fixed pseudo-random displacement in [−1, 1]², the same for all images of a cell.
fn jitter(cell: usize) -> Vector<f64> {
    let unit = |salt: u64| {
        let mut z = (cell as u64).wrapping_add(salt).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    Vector::new(unit(1), unit(0x5851_F42D_4C95_7F2D))
}

/// The Delaunay triangulation, or nothing if two sites coincide.
fn triangulate(sites: Vec<Site>) -> Option<DelaunayTriangulation<Site>> {
    let expected = sites.len();
    DelaunayTriangulation::bulk_load(sites)
        .ok()
        .filter(|delaunay: &DelaunayTriangulation<Site>| delaunay.num_vertices() == expected)
}

/// Names two cells at one point.
fn duplicate(positions: &[Vector<f64>]) -> Error {
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by(|&i, &j| {
        let (a, b) = (positions[i], positions[j]);
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(i.cmp(&j))
    });
    order.windows(2).find(|w| point(positions[w[0]]) == point(positions[w[1]])).map_or(
        Error::Inconsistent { cells: positions.len(), cell: 0 },
        |w| Error::DuplicateCells {
            first: w[0].min(w[1]),
            second: w[0].max(w[1]),
            x: positions[w[0]].x,
            y: positions[w[0]].y,
        },
    )
}
