//! The residuals of one frame, and those of all frames as one list.

use crate::Error;
use crate::median::median;
use voronudge_geometry::{Domain, Tessellation, Vector};

/// Edges longer than this many times the median edge do not make neighbours: they bridge holes and bays of the data.
const LONGEST_EDGE: f64 = 2.5;

/// The residuals of one frame.
#[derive(Debug, Clone)]
pub struct ResidualField<'a> {
    pub(super) places: &'a [Vector<f64>],
    pub(super) residuals: &'a [Vector<f64>],
    pub(super) domain: Domain,
    pub(super) neighbours: Vec<Vec<u32>>,
    pub(super) standard: f64,
    pub(super) cells: Option<CellData<'a>>,
}

/// What is known of the cells besides their residual, in the order of the residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellData<'a> {
    /// Areas; NaN where unknown.
    pub areas: &'a [f64],
    /// Measured velocities.
    pub velocities: &'a [Vector<f64>],
}

impl<'a> ResidualField<'a> {
    /// Residuals at `places` (cell centres or grid points, N) with their neighbours among themselves: Delaunay without
    /// edges that bridge holes. `standard` is the standard deviation of one component if only the expected noise is
    /// left (one for whitened residuals); `frame` is used in messages.
    ///
    /// # Errors
    /// [`Error::Lengths`]; [`Error::Geometry`] if places cannot be tessellated; [`Error::Noise`] if `standard` is not
    /// positive, or a residual not finite.
    pub fn new(
        frame: usize,
        places: &'a [Vector<f64>],
        residuals: &'a [Vector<f64>],
        domain: Domain,
        standard: f64,
    ) -> Result<Self, Error> {
        if places.len() != residuals.len() {
            return Err(Error::Lengths { frame, positions: places.len(), velocities: residuals.len() });
        }
        if !(standard.is_finite() && standard > 0.0) {
            return Err(Error::Noise { name: "expected", value: standard });
        }
        if let Some(value) = residuals.iter().map(Vector::norm).find(|norm| !norm.is_finite()) {
            return Err(Error::Noise { name: "residual", value });
        }
        let tessellation =
            Tessellation::new(places, domain).map_err(|source| Error::Geometry { frame, source })?;
        let neighbours = neighbours(&tessellation, places);
        Ok(Self { places, residuals, domain, neighbours, standard, cells: None })
    }

    /// The same with areas and velocities, from which the cause of an outlier is guessed.
    ///
    /// # Errors
    /// [`Error::Lengths`].
    pub fn with_cells(mut self, frame: usize, cells: CellData<'a>) -> Result<Self, Error> {
        for found in [cells.areas.len(), cells.velocities.len()] {
            if found != self.places.len() {
                return Err(Error::Lengths { frame, positions: self.places.len(), velocities: found });
            }
        }
        self.cells = Some(cells);
        Ok(self)
    }

    /// The neighbours of each residual.
    pub fn neighbours(&self) -> &[Vec<u32>] {
        &self.neighbours
    }

    /// Shortest displacement between two places.
    pub(super) fn displacement(&self, from: usize, to: usize) -> Vector<f64> {
        self.domain.shortest(self.places[to] - self.places[from])
    }
}

/// Delaunay neighbours that are not too far away, each once.
fn neighbours(tessellation: &Tessellation, places: &[Vector<f64>]) -> Vec<Vec<u32>> {
    let length = |cell: usize, h: usize| tessellation.displacement(places, cell, h).norm();
    let rings = || (0..tessellation.len()).map(|cell| (cell, tessellation.ring(cell)));
    let mut lengths: Vec<f64> = rings().flat_map(|(cell, ring)| ring.map(move |h| length(cell, h))).collect();
    let longest = LONGEST_EDGE * median(&mut lengths).unwrap_or(f64::INFINITY);
    rings()
        .map(|(cell, ring)| {
            let near = ring.filter(|&h| length(cell, h) <= longest);
            let mut near: Vec<u32> = near.map(|h| tessellation.neighbour(h) as u32).collect();
            near.retain(|&other| other as usize != cell);
            near.sort_unstable();
            near.dedup();
            near
        })
        .collect()
}

/// All frames as one list; each residual in units of its frame's standard.
pub(super) struct Pool {
    pub residuals: Vec<Vector<f64>>,
    /// Pairs of neighbours, each once.
    pub edges: Vec<[usize; 2]>,
    /// First residual of each frame.
    pub starts: Vec<usize>,
}

impl Pool {
    pub fn new(frames: &[ResidualField<'_>]) -> Self {
        let mut pool = Self { residuals: Vec::new(), edges: Vec::new(), starts: Vec::new() };
        for frame in frames {
            let start = pool.residuals.len();
            pool.starts.push(start);
            pool.residuals.extend(frame.residuals.iter().map(|u| u / frame.standard));
            for (i, near) in frame.neighbours.iter().enumerate() {
                let later = near.iter().map(|&j| j as usize).filter(|&j| i < j);
                pool.edges.extend(later.map(|j| [start + i, start + j]));
            }
        }
        pool
    }

    /// `⟨|u|²⟩`; zero if there is none.
    pub fn mean_square(&self) -> f64 {
        let sum: f64 = self.residuals.iter().map(Vector::norm_squared).sum();
        sum / self.residuals.len().max(1) as f64
    }
}
