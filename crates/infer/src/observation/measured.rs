//! How the positions and velocities of a snapshot were measured.

use super::{Observation, Velocities};
use crate::Error;
use crate::flow::{Sampling, Window};
use crate::unknown::Unknown;
use voronudge_geometry::{CellPolygon, Tessellation, Vector};

/// Steps `r ← y − c (centroid(r) − r)` from measured positions towards sites: more would follow the noise.
const APPROACHES: usize = 4;

impl Observation {
    /// Takes positions for points at a share c of the way from the sites to the centroids of cells. `positions` become what sites
    /// that would have been measured there are about; where they were measured is remembered.
    ///
    /// # Errors
    /// [`Error::Geometry`].
    pub fn with_positions_at(self, share: f64) -> Result<Self, Error> {
        let measured: Vec<Vector<f64>> =
            (0..self.positions.len()).map(|cell| self.positions[cell] + self.aim(cell)).collect();
        let domain = self.tessellation.domain();
        let failure = |source| Error::Geometry { frame: 0, source };
        let mut tessellation = Tessellation::new(&measured, domain).map_err(failure)?;
        let polygons: Vec<bool> = (0..measured.len())
            .map(|cell| tessellation.is_closed(cell) && self.visibility[cell].has_certain_polygon())
            .collect();
        let mut positions = measured.clone();
        let mut polygon = CellPolygon::default();
        for _ in 0..if share > 0.0 { APPROACHES } else { 0 } {
            let offset =
                |cell: usize| match polygons[cell] && filled(&mut polygon, &tessellation, &positions, cell) {
                    true => polygon.centroid() * share,
                    false => Vector::zeros(),
                };
            let offsets: Vec<Vector<f64>> = (0..positions.len()).map(offset).collect();
            positions = measured.iter().zip(offsets).map(|(y, offset)| y - offset).collect();
            tessellation = Tessellation::new(&positions, domain).map_err(failure)?;
        }
        let aims = measured.iter().zip(&positions).map(|(y, r)| y - r).collect();
        Ok(Self { share, aims, polygons, positions, tessellation, ..self })
    }

    /// Lets the velocities be averages over other windows, where they are on a grid.
    #[must_use]
    pub fn with_window(mut self, window: Window) -> Self {
        let Velocities::OnGrid(flow) = &mut self.velocities else {
            return self;
        };
        flow.window = window;
        let (flow, visibility) = (&*flow, &self.visibility);
        self.used = Sampling::new(flow, &self.tessellation, &self.positions, visibility).filled().to_vec();
        for (used, reach) in self.used.iter_mut().zip(&self.reach) {
            *used &= reach;
        }
        let degree = self.background_degree();
        self.with_background(degree)
    }

    /// Leaves out grid points that are not used now, whatever the window.
    pub(crate) fn within_present_reach(mut self) -> Self {
        self.reach = self.used.clone();
        self
    }

    /// Lets an unknown of the measurement, at its best value here, count among the unknowns of a fit.
    pub(crate) fn with_unknown(mut self, unknown: Unknown) -> Self {
        self.unknowns.push(unknown);
        self
    }

    /// Unknowns of the measurement that were fitted.
    pub(crate) fn unknowns(&self) -> &[Unknown] {
        &self.unknowns
    }

    /// Where cells would be measured if they were at `positions`, without errors.
    pub(crate) fn seen_from(
        &self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
    ) -> Vec<Vector<f64>> {
        let mut polygon = CellPolygon::default();
        let place = |(cell, r): (usize, &Vector<f64>)| {
            if self.share == 0.0 || !self.fill_polygon(&mut polygon, tessellation, positions, cell) {
                return *r;
            }
            r + polygon.centroid() * self.share
        };
        positions.iter().enumerate().map(place).collect()
    }

    /// Takes positions for measured as those of another observation of the same cells are.
    ///
    /// # Errors
    /// [`Error::Geometry`].
    pub(crate) fn measured_like(self, other: &Self) -> Result<Self, Error> {
        let (stiffness, unknowns) = (other.stiffness.clone(), other.unknowns.clone());
        let own = Self { stiffness, unknowns, aims: Vec::new(), share: 0.0, ..self };
        if other.share == 0.0 { Ok(own) } else { own.with_positions_at(other.share) }
    }

    /// The share c of the way from a cell's site to its centroid at which its position is measured.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// The same observation with another share, its positions kept.
    pub(crate) fn at_share(self, share: f64) -> Self {
        Self { share, ..self }
    }

    /// Where a cell was measured, relative to its entry of `positions`.
    pub(crate) fn aim(&self, cell: usize) -> Vector<f64> {
        self.aims.get(cell).copied().unwrap_or_else(Vector::zeros)
    }

    /// Fills the polygon of a cell at some positions, if it is known well enough to have a centroid.
    pub(crate) fn fill_polygon(
        &self,
        polygon: &mut CellPolygon<f64>,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cell: usize,
    ) -> bool {
        self.may_have_polygon(cell) && filled(polygon, tessellation, positions, cell)
    }

    /// Whether the surroundings of a cell are known well enough for a polygon, if it is closed.
    pub(crate) fn may_have_polygon(&self, cell: usize) -> bool {
        self.polygons.get(cell).copied().unwrap_or(true)
    }
}

/// Distance of a corner from its cell, in units of ℓ₀, beyond which a polygon is open but for chance.
const FARTHEST: f64 = 3.0;

/// Fills the polygon of a cell; tells whether it is closed and no corner is far away, which happens at the rim of a field.
fn filled(
    polygon: &mut CellPolygon<f64>,
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    cell: usize,
) -> bool {
    if !tessellation.is_closed(cell) {
        return false;
    }
    polygon.fill(tessellation, positions, cell);
    polygon.vertices().all(|corner| corner.norm_squared() < FARTHEST * FARTHEST)
}
