//! One snapshot: where the cells are and how fast they move.

mod cut;
mod measured;
mod scaled;

use crate::Error;
use crate::background::Background;
use crate::flow::{Flow, Sampling};
use crate::unknown::Unknown;
use nalgebra::DMatrix;
use std::sync::Arc;
use voronudge_geometry::{
    Domain, Error as GeometryError, FieldOfView, MovingTessellation, Region, Tessellation, Vector, Visibility,
};
use voronudge_linalg::Dissections;
use voronudge_model::{BlockMatrix, Environment};

/// Cells of one frame with their tessellation as measured. Cells are those present in the frame, in any order.
#[derive(Debug, Clone)]
pub struct Observation {
    /// Cell centres (N).
    pub positions: Vec<Vector<f64>>,
    /// Measured velocities.
    pub velocities: Velocities,
    /// Tessellation of the measured positions.
    pub tessellation: Tessellation,
    /// Whether a cell can be trusted (open fields of view).
    pub visibility: Vec<Visibility>,
    /// Where every cell would have been seen; `None` if that is everywhere.
    pub region: Option<Region>,
    /// What the cells were judged by.
    pub field_of_view: FieldOfView,
    /// Whether the model can say what a velocity should be.
    used: Vec<bool>,
    /// Cells without a nudge; empty if all have one.
    held: Vec<bool>,
    /// `(σ_r / σ_i)²` of each cell, zero for cells that were not seen; empty if all are measured alike.
    stiffness: Vec<f64>,
    /// Share c of the way from a cell's site to its centroid at which its position is measured.
    share: f64,
    /// Where cells were measured, relative to `positions`; empty if there.
    aims: Vec<Vector<f64>>,
    /// Whether a cell's polygon is known well enough to have a centroid; empty if all are that have a polygon.
    polygons: Vec<bool>,
    /// Unknowns of the measurement that were fitted.
    unknowns: Vec<Unknown>,
    /// Grid points that are used at most; empty if all may be.
    reach: Vec<bool>,
    /// Weight of each velocity; empty if all are one.
    weights: Vec<f64>,
    /// Degree of the polynomials that are no concern of the model, and what they are here.
    background: Option<(u32, Background)>,
    environment: Arc<Environment>,
    /// Which cell of the tissue each is; empty if that is not known.
    identities: Vec<Option<usize>>,
    /// Orders of elimination that are known.
    dissections: Dissections,
}

/// How velocities were measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Velocities {
    /// One for each cell (N); `None` where there is none.
    OfCells(Vec<Option<Vector<f64>>>),
    /// On a grid, by optical flow or particle image velocimetry.
    OnGrid(Flow),
}

/// How far centroids are from sites, in units of σ_r: what the position of a cell is uncertain by if its polygon is not known.
const OFF_CENTRE: f64 = 4.0;

impl From<Vec<Option<Vector<f64>>>> for Velocities {
    fn from(velocities: Vec<Option<Vector<f64>>>) -> Self {
        Self::OfCells(velocities)
    }
}

impl Velocities {
    /// The measured values: one for each cell or each grid point, row by row.
    pub fn values(&self) -> &[Option<Vector<f64>>] {
        match self {
            Self::OfCells(values) => values,
            Self::OnGrid(flow) => &flow.velocities,
        }
    }

    /// The same, to change them.
    pub fn values_mut(&mut self) -> &mut [Option<Vector<f64>>] {
        match self {
            Self::OfCells(values) => values,
            Self::OnGrid(flow) => &mut flow.velocities,
        }
    }
}

impl Observation {
    /// Tessellates a snapshot and judges its cells. `frame` is used in messages.
    ///
    /// # Errors
    /// [`Error::Lengths`], [`Error::Geometry`].
    pub fn new(
        frame: usize,
        positions: Vec<Vector<f64>>,
        velocities: impl Into<Velocities>,
        domain: Domain,
        field_of_view: FieldOfView,
    ) -> Result<Self, Error> {
        let velocities = velocities.into();
        let expected = match &velocities {
            Velocities::OfCells(_) => positions.len(),
            Velocities::OnGrid(flow) => flow.grid.len(),
        };
        if velocities.values().len() != expected {
            let found = velocities.values().len();
            return Err(Error::Lengths { frame, positions: expected, velocities: found });
        }
        let tessellation =
            Tessellation::new(&positions, domain).map_err(|source| Error::Geometry { frame, source })?;
        let (visibility, region) = field_of_view.judge(&tessellation, &positions).into_parts();
        let used = match &velocities {
            Velocities::OfCells(_) => visibility.iter().map(|v| *v == Visibility::Counted).collect(),
            Velocities::OnGrid(flow) => {
                Sampling::new(flow, &tessellation, &positions, &visibility).filled().to_vec()
            }
        };
        Ok(Self {
            positions,
            velocities,
            tessellation,
            visibility,
            region,
            field_of_view,
            used,
            held: Vec::new(),
            stiffness: Vec::new(),
            share: 0.0,
            aims: Vec::new(),
            polygons: Vec::new(),
            unknowns: Vec::new(),
            reach: Vec::new(),
            weights: Vec::new(),
            background: None,
            environment: Arc::default(),
            identities: Vec::new(),
            dissections: Dissections::default(),
        })
    }

    /// Says which cell of the tissue each is, so that it can be told in other frames.
    #[must_use]
    pub fn with_identities(self, identities: Vec<Option<usize>>) -> Self {
        Self { identities, ..self }
    }

    /// Which cell of the tissue a cell is, if that is known.
    pub fn identity(&self, cell: usize) -> Option<usize> {
        self.identities.get(cell).copied().flatten()
    }

    /// Lets a smooth flow, polynomials of the position up to a degree, be no concern of the model, or nothing. Velocities
    /// must not change afterwards.
    #[must_use]
    pub fn with_background(mut self, degree: Option<u32>) -> Self {
        self.background = degree.map(|degree| {
            let places: Vec<Vector<f64>> =
                self.targets().map(|(datum, _)| self.position_of_datum(datum)).collect();
            (degree, Background::new(&places, degree))
        });
        self
    }

    /// The same observation of cells in an environment.
    #[must_use]
    pub fn within(self, environment: Arc<Environment>) -> Self {
        Self { environment, ..self }
    }

    /// The same cells with other velocities.
    pub(crate) fn with_velocities(self, velocities: Vec<Option<Vector<f64>>>) -> Self {
        Self { velocities: velocities.into(), ..self }
    }

    /// Gives the cells labels (N), in place of any that they had.
    ///
    /// # Errors
    /// [`Error::Surroundings`] if they are for other cells.
    pub fn with_labels(self, labels: Vec<Option<i64>>) -> Result<Self, Error> {
        let labelled = Environment::clone(&self.environment).with_labels(labels)?;
        Ok(self.within(Arc::new(labelled)))
    }

    /// What surrounds and preceded the cells.
    pub fn environment(&self) -> &Arc<Environment> {
        &self.environment
    }

    /// Degree of the background, if there is one.
    pub(crate) fn background_degree(&self) -> Option<u32> {
        self.background.as_ref().map(|(degree, _)| *degree)
    }

    /// Number of coefficients of the background.
    pub fn background_dimension(&self) -> usize {
        self.background.as_ref().map_or(0, |(_, background)| background.dimension())
    }

    /// Removes the background, if there is one, from a field over the targets in their order.
    pub fn remove_background(&self, field: &mut [Vector<f64>]) {
        if let Some((_, background)) = &self.background {
            background.remove(field);
        }
    }

    /// Number of measured components that neither the background nor cells that were not seen take up.
    pub(crate) fn components(&self) -> usize {
        (2 * self.targets().count()).saturating_sub(self.background_dimension() + 2 * self.unseen())
    }

    /// The same frame of other cells: detections that are kept, at these positions, then cells without a measured position.
    ///
    /// # Errors
    /// [`Error::Lengths`], [`Error::Geometry`].
    pub(crate) fn with_cells(
        &self,
        kept: &[usize],
        positions: Vec<Vector<f64>>,
        velocities: Velocities,
    ) -> Result<Self, Error> {
        let stiffness = match kept.len() == positions.len() && self.stiffness.is_empty() {
            true => Vec::new(),
            false => {
                let own = kept.iter().map(|cell| self.stiffness(*cell));
                own.chain(std::iter::repeat(0.0)).take(positions.len()).collect()
            }
        };
        let domain = self.tessellation.domain();
        let own = Self::new(0, positions, velocities, domain, self.field_of_view.clone())?;
        let aims = match self.aims.is_empty() {
            true => Vec::new(),
            false => (0..own.positions.len())
                .map(|cell| kept.get(cell).map_or_else(Vector::zeros, |kept| self.aim(*kept)))
                .collect(),
        };
        let (share, unknowns) = (self.share, self.unknowns.clone());
        let identities = match self.identities.is_empty() {
            true => Vec::new(),
            false => kept.iter().map(|cell| self.identity(*cell)).collect(),
        };
        let environment = self.environment.clone();
        let own = Self { stiffness, aims, share, unknowns, environment, identities, ..own };
        Ok(own.with_background(self.background_degree()))
    }

    /// Lets positions have errors of their own: standard deviations (N) in units of that of the noise levels; infinite for
    /// cells that were not seen, whose positions are where they are looked for.
    #[must_use]
    pub fn with_position_errors(self, relative: &[f64]) -> Self {
        Self { stiffness: relative.iter().map(|error| error.powi(-2)).collect(), ..self }
    }

    /// Gives velocities weights, one for each datum.
    #[must_use]
    pub fn with_weights(self, weights: Vec<f64>) -> Self {
        Self { weights, ..self }
    }

    /// `(σ_r / σ_i)²` of a cell; zero if it was not seen.
    pub(crate) fn stiffness(&self, cell: usize) -> f64 {
        let own = self.stiffness.get(cell).copied().unwrap_or(1.0);
        match self.share != 0.0 && !self.may_have_polygon(cell) {
            true => own / (1.0 + (self.share * OFF_CENTRE).powi(2)),
            false => own,
        }
    }

    /// `σ_i / σ_r` of a cell; zero if it was not seen, so that it stays where it is put.
    pub(crate) fn position_error(&self, cell: usize) -> f64 {
        if self.is_seen(cell) { self.stiffness(cell).powf(-0.5) } else { 0.0 }
    }

    /// Whether a cell has a measured position.
    pub fn is_seen(&self, cell: usize) -> bool {
        self.stiffness(cell) > 0.0
    }

    /// Number of cells without a measured position.
    pub fn unseen(&self) -> usize {
        self.stiffness.iter().filter(|m| **m == 0.0).count()
    }

    /// Weight of a velocity.
    pub fn weight(&self, datum: usize) -> f64 {
        self.weights.get(datum).copied().unwrap_or(1.0)
    }

    /// Whether velocities have weights of their own.
    pub fn is_weighted(&self) -> bool {
        !self.weights.is_empty()
    }

    /// Multiplies rows of the velocities by the roots of their weights.
    pub(crate) fn weigh(&self, rows: &mut [(usize, Vector<f64>, DMatrix<f64>)], jacobian: &mut BlockMatrix) {
        if self.weights.is_empty() {
            return;
        }
        for (datum, rest, x) in rows {
            let root = self.weight(*datum).sqrt();
            *rest *= root;
            *x *= root;
            jacobian.scale_row(*datum, root);
        }
    }

    /// The targets without their background.
    pub fn explainable(&self) -> Vec<Vector<f64>> {
        let mut targets: Vec<Vector<f64>> = self.targets().map(|(_, v)| v).collect();
        self.remove_background(&mut targets);
        targets
    }

    /// The tessellation of these cells at other positions (N).
    pub(crate) fn moved_to(&self, positions: &[Vector<f64>]) -> Result<Tessellation, GeometryError> {
        Ok(self.moving_to(positions)?.into_tessellation())
    }

    /// The same of cells that will move on.
    pub(crate) fn moving_to(&self, positions: &[Vector<f64>]) -> Result<MovingTessellation, GeometryError> {
        let mut moving = MovingTessellation::of(self.tessellation.clone(), &self.positions);
        moving.renew(positions)?;
        Ok(moving)
    }

    /// Orders of elimination of matrices about these cells.
    pub(crate) fn dissections(&self) -> &Dissections {
        &self.dissections
    }

    /// Whether a cell has no nudge.
    pub(crate) fn is_held(&self, cell: usize) -> bool {
        self.held.get(cell).copied().unwrap_or(false)
    }

    /// Whether all cells have a nudge.
    pub(crate) fn is_free(&self) -> bool {
        self.held.is_empty()
    }

    /// The velocity to be explained, of a cell or at a grid point: measured, and within reach of the model.
    pub fn target(&self, datum: usize) -> Option<Vector<f64>> {
        self.velocities.values()[datum].filter(|_| self.used[datum])
    }

    /// Whether the model can say what a velocity should be, measured or not.
    pub fn is_in_reach(&self, datum: usize) -> bool {
        self.used[datum]
    }

    /// The data with a target, and their targets.
    pub fn targets(&self) -> impl Iterator<Item = (usize, Vector<f64>)> {
        (0..self.used.len()).filter_map(|datum| Some((datum, self.target(datum)?)))
    }

    /// Where a velocity was measured: the cell's centre or the grid point.
    pub fn position_of_datum(&self, datum: usize) -> Vector<f64> {
        match &self.velocities {
            Velocities::OfCells(_) => self.positions[datum],
            Velocities::OnGrid(flow) => flow.grid.centre(datum),
        }
    }

    /// What would be measured of cells that are at `positions`: nothing but the cells' velocities, or their averages
    /// around the grid points.
    pub(crate) fn sampling(
        &self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
    ) -> Option<Sampling> {
        match &self.velocities {
            Velocities::OfCells(_) => None,
            Velocities::OnGrid(flow) => Some(Sampling::new(flow, tessellation, positions, &self.visibility)),
        }
    }
}
