//! From positions to the flat arrays of a [`Tessellation`]: ghost images, a triangulation, rings, twins.
//!
//! The Delaunay triangulation of a neighbourhood depends on that neighbourhood only. A large periodic box is therefore
//! cut into tiles, each triangulated with a strip of surrounding cells; this fits the caches and uses all threads, and a
//! small box is the case of one tile whose surroundings are its own images.
//!
//! A fast triangulation comes first. If the flips cannot prove that it is the Delaunay triangulation, or make it so, an exact one follows.

mod mesh;
mod rectangle;
mod rings;
mod site;
mod tile;

use crate::domain::MOST_BOXES;
use crate::moving::repair::Repair;
use crate::{Domain, Error, PeriodicBox, Tessellation, Vector};
use mesh::{Exact, Fast, Mesh, flushed};
use rayon::prelude::*;
pub(crate) use rings::find_twins;
use rings::{Rings, assemble};
use site::{Role, Site};
use tile::Tiling;

/// Sizes, relative to √(area per cell), of the displacements that break ties between cells on one circle. They move the
/// question of who is a neighbour, not the cells. The box is sheared by as much, for ties among images of one cell.
const TIE_BREAKS: [f64; 4] = [0.0, 1e-11, 1e-9, 1e-7];

impl Tessellation {
    /// Tessellates cell centres at `positions` (N, in any unit).
    ///
    /// Periodic positions need not be inside the box. Cells on a common circle (a square lattice, say) get one of the
    /// equivalent triangulations, in a periodic box a fan from the lowest of them; the Voronoi edge between the others then
    /// has length zero.
    ///
    /// # Errors
    /// [`Error`] if a position is not finite, two cells coincide, or there are too few cells (three, not on a line, for
    /// an open field; one for a periodic box).
    pub fn new(positions: &[Vector<f64>], domain: Domain) -> Result<Self, Error> {
        let mut tessellation = Self {
            domain,
            start: Vec::new(),
            neighbour: Vec::new(),
            image: Vec::new(),
            twin_place: Vec::new(),
            on_hull: Vec::new(),
        };
        tessellation.renew(positions)?;
        Ok(tessellation)
    }

    /// Replaces the topology by that of new positions in the same domain, reusing the arrays.
    ///
    /// # Errors
    /// As [`Tessellation::new`]; the old topology is then lost.
    pub fn renew(&mut self, positions: &[Vector<f64>]) -> Result<(), Error> {
        let cells = positions.len();
        if cells > Self::CELL_LIMIT {
            return Err(Error::TooManyCells { cells, limit: Self::CELL_LIMIT });
        }
        for (cell, r) in positions.iter().enumerate() {
            if !(r.x.abs() < 1e100 && r.y.abs() < 1e100) {
                return Err(Error::Position { cell, x: r.x, y: r.y });
            }
        }
        match self.domain() {
            Domain::Periodic(cell_box) => periodic(self, positions, &cell_box),
            Domain::Open => open(self, positions),
        }
    }
}

fn open(tessellation: &mut Tessellation, positions: &[Vector<f64>]) -> Result<(), Error> {
    let cells = positions.len();
    if cells < 3 {
        return Err(Error::TooFewCells { found: cells, required: 3 });
    }
    let sites: Vec<Site> =
        (0..cells).map(|cell| Site { cell: cell as u32, image: [0, 0], role: Role::Own }).collect();
    if let Some(fast) = Fast::of(positions)
        && assemble(tessellation, cells, &[Rings::of_all(&fast, &sites)]).is_ok()
        && Repair::default().attempt(tessellation, positions).is_some()
    {
        return Ok(());
    }
    let exact = Exact::of(positions).ok_or_else(|| duplicate(positions))?;
    if exact.is_flat() {
        return Err(Error::Collinear { cells });
    }
    assemble(tessellation, cells, &[Rings::of_all(&exact, &sites)])
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
    // What is proven to be the Delaunay triangulation, or made it by flips, is it, whatever it began with.
    if of_tiles::<Fast>(tessellation, positions, &images, cell_box, 0.0).is_ok()
        && Repair::default().attempt(tessellation, positions).is_some()
    {
        return Ok(());
    }
    let mut outcome = Ok(());
    for tie_break in TIE_BREAKS {
        outcome = of_tiles::<Exact>(tessellation, positions, &images, cell_box, tie_break);
        if !matches!(outcome, Err(Error::Inconsistent { .. })) {
            break;
        }
    }
    outcome?;
    // Ties were broken by whatever came first; the flips break them by a rule. Nearly flat triangles stay.
    let _ = Repair::default().attempt(tessellation, positions);
    Ok(())
}

/// Triangulates a box tile by tile, with ties broken by displacements of some size.
fn of_tiles<M: Mesh>(
    tessellation: &mut Tessellation,
    positions: &[Vector<f64>],
    images: &[[i32; 2]],
    cell_box: &PeriodicBox,
    tie_break: f64,
) -> Result<(), Error> {
    let cells = positions.len();
    let spacing = (cell_box.area() / cells as f64).sqrt();
    let wrapped: Vec<Vector<f64>> = positions
        .iter()
        .zip(images)
        .enumerate()
        .map(|(cell, (r, n))| match tie_break {
            0.0 => r - cell_box.translation(*n),
            size => r - cell_box.translation(*n) + jitter(cell) * (size * spacing),
        })
        .collect();
    let nudged = PeriodicBox::sheared(cell_box.lengths(), cell_box.offset() + tie_break * spacing)?;
    let tiling = Tiling::new(&wrapped, &nudged);
    let rings: Option<Vec<Rings>> =
        (0..tiling.len()).into_par_iter().map(|tile| tiling.rings::<M>(tile)).collect();
    let rings = rings.ok_or_else(|| duplicate(&wrapped))?;
    assemble(tessellation, cells, &rings)?;
    // Where images of one circle of cells were triangulated differently, all may miss its diagonal. Triangles must cover the box once.
    let area: f64 = rings.iter().map(|rings| rings.area).sum();
    if tessellation.half_edges() != 6 * cells || (area / cell_box.area() - 1.0).abs() > 1e-6 {
        return Err(Error::Inconsistent { cells, cell: 0 });
    }
    rings::refer_to_given_positions(tessellation, images);
    Ok(())
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

/// Names two cells at one point.
fn duplicate(positions: &[Vector<f64>]) -> Error {
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by(|&i, &j| {
        let (a, b) = (positions[i], positions[j]);
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(i.cmp(&j))
    });
    order.windows(2).find(|w| flushed(positions[w[0]]) == flushed(positions[w[1]])).map_or(
        Error::Inconsistent { cells: positions.len(), cell: 0 },
        |w| Error::DuplicateCells {
            first: w[0].min(w[1]),
            second: w[0].max(w[1]),
            x: positions[w[0]].x,
            y: positions[w[0]].y,
        },
    )
}
