//! The penalised objective of nudged inference as a problem for argmin.

mod linearised;
mod obstacles;
mod patches;

use crate::flow::Sampling;
use crate::normal_equations::NormalEquations;
use crate::own_parts::OwnParts;
use crate::placing::Placing;
use crate::position_rows;
use crate::residuals::{Columns, residuals};
use crate::rows::Row;
use crate::{CoefficientSpace, Error, NoiseLevels, Observation};
pub(crate) use linearised::Linear;
use nalgebra::DVector;
pub(crate) use patches::Patches;
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::{BlockMatrix, Environment, Model, Structure, jacobian, velocities};

/// `Φ(β, ε) = Σ w ‖v − F_β(r + ε)‖² + k Σ m ‖y − H(r + ε)‖² + σ_v² Σ (q(β) − m)² / s²` over all frames and priors, with weights w of
/// velocities and the stiffness m of a cell. Cells that were not seen are held with the spread of [`WHEREABOUTS`]. The
/// parameter vector is β, then ε frame by frame as x₀, y₀, x₁, …
///
/// Φ / σ_v² is twice the negative log likelihood, up to a constant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Objective<'a> {
    pub frames: &'a [Observation],
    pub structure: &'a Structure,
    pub space: &'a CoefficientSpace,
    pub levels: NoiseLevels,
    /// What single cells do beyond what all of them do alike.
    pub own: Option<&'a OwnParts<'a>>,
}

/// Standard deviation of a coordinate of a cell that was not seen about where it is put, in units of ℓ₀: enough to find its
/// place, too little to wander off.
pub(crate) const WHEREABOUTS: f64 = 0.5;

/// One frame at some positions.
pub(crate) struct Nudged<'a> {
    pub positions: Vec<Vector<f64>>,
    pub tessellation: Tessellation,
    structure: &'a Structure,
    environment: Arc<Environment>,
    /// The columns of the terms for each cell, once they are asked for.
    columns: OnceLock<Columns>,
    sampling: Option<Sampling>,
}

/// What the model says of a frame with some coefficients.
pub(crate) struct Predicted {
    /// Velocities of the cells.
    pub of_cells: Vec<Vector<f64>>,
    /// Velocities as they are measured, where these are at the points of a grid.
    on_grid: Option<Vec<Vector<f64>>>,
}

/// The same with derivatives.
pub(crate) struct Evaluated {
    /// Velocities of the cells.
    pub of_cells: Vec<Vector<f64>>,
    /// Velocities as they are measured: of the cells, or at the grid points.
    pub predicted: Vec<Vector<f64>>,
    /// Their derivatives by the coefficients.
    pub by_coefficient: Columns,
}

impl Predicted {
    /// Velocities as they are measured: of the cells, or at the grid points.
    pub fn as_measured(&self) -> &[Vector<f64>] {
        self.on_grid.as_ref().unwrap_or(&self.of_cells)
    }
}

/// Cells at some time, with the velocities that the model gives them.
pub(crate) type Moving<'a> = (Nudged<'a>, Predicted);

/// One frame at some positions with its residuals and their derivatives.
pub(crate) struct Measurable<'a> {
    pub nudged: Nudged<'a>,
    pub rows: Vec<Row>,
    /// Derivative of what is measured by the positions.
    pub jacobian: BlockMatrix,
}

impl<'a> Nudged<'a> {
    /// A frame at its measured positions.
    pub fn as_measured(frame: &Observation, structure: &'a Structure) -> Self {
        Self::new(frame, structure, frame.positions.clone(), frame.tessellation.clone())
    }

    pub fn new(
        frame: &Observation,
        structure: &'a Structure,
        positions: Vec<Vector<f64>>,
        tessellation: Tessellation,
    ) -> Self {
        let sampling = frame.sampling(&tessellation, &positions);
        Self::placed(structure, frame.environment().clone(), positions, tessellation, sampling)
    }

    /// Any cells, with what is measured of them.
    pub fn placed(
        structure: &'a Structure,
        environment: Arc<Environment>,
        positions: Vec<Vector<f64>>,
        tessellation: Tessellation,
        sampling: Option<Sampling>,
    ) -> Self {
        Self { positions, tessellation, structure, environment, columns: OnceLock::new(), sampling }
    }

    /// Velocities and their derivatives for given coefficients.
    pub fn evaluate(&self, coefficients: &[f64]) -> Evaluated {
        let Self { structure, tessellation, positions, environment, .. } = self;
        let columns = self.columns.get_or_init(|| structure.columns(tessellation, positions, environment));
        let of_cells = structure.evaluate(tessellation, positions, columns, coefficients, environment);
        let by_coefficient = of_cells.by_coefficient;
        let of_cells = of_cells.velocities;
        match &self.sampling {
            None => Evaluated { predicted: of_cells.clone(), of_cells, by_coefficient },
            Some(sampling) => Evaluated {
                predicted: sampling.average(&of_cells),
                by_coefficient: by_coefficient.iter().map(|x| sampling.average(x)).collect(),
                of_cells,
            },
        }
    }

    /// The model of a structure with some coefficients, surrounded by what surrounds the cells.
    pub fn model(&self, coefficients: &[f64]) -> Model<f64> {
        self.structure.model(coefficients, &self.environment)
    }

    /// The same without candidates that are not part of the model yet.
    fn acting(&self, coefficients: &[f64]) -> Model<f64> {
        let mut model = self.model(coefficients);
        model.terms.retain(|weighted| weighted.coefficient != 0.0);
        model.responses.retain(|weighted| weighted.coefficient != 0.0);
        model
    }

    /// Velocities of the cells, and as they are measured.
    pub fn predict(&self, coefficients: &[f64]) -> Predicted {
        let of_cells = self.velocities(coefficients);
        Predicted { on_grid: self.sampling.as_ref().map(|sampling| sampling.average(&of_cells)), of_cells }
    }

    /// The cells that a datum mostly speaks of.
    fn measured_in(&self, datum: usize) -> Vec<usize> {
        self.sampling.as_ref().map_or_else(|| vec![datum], |sampling| sampling.main_cells(datum).collect())
    }

    /// Velocities of the cells alone.
    pub fn velocities(&self, coefficients: &[f64]) -> Vec<Vector<f64>> {
        velocities(&self.tessellation, &self.positions, &self.acting(coefficients))
    }

    /// Their derivative with respect to the positions.
    pub fn jacobian_of_cells(&self, coefficients: &[f64]) -> BlockMatrix {
        jacobian(&self.tessellation, &self.positions, &self.acting(coefficients))
    }

    /// The derivative of what is measured with respect to the positions.
    pub fn jacobian(&self, coefficients: &[f64], velocities: &[Vector<f64>]) -> BlockMatrix {
        let of_cells = self.jacobian_of_cells(coefficients);
        match &self.sampling {
            None => of_cells,
            Some(sampling) => sampling.jacobian(&self.tessellation, &self.positions, velocities, &of_cells),
        }
    }
}

impl<'a> Objective<'a> {
    /// Φ of cells that are alike.
    pub fn new(
        frames: &'a [Observation],
        structure: &'a Structure,
        space: &'a CoefficientSpace,
        levels: NoiseLevels,
    ) -> Self {
        Self { frames, structure, space, levels, own: None }
    }

    /// k = σ_v² / σ_r².
    pub fn spring(&self) -> f64 {
        self.levels.spring()
    }

    /// β and the nudges of each frame.
    pub fn split<'p>(&self, parameters: &'p [f64]) -> (&'p [f64], Vec<&'p [f64]>) {
        let (free, mut rest) = parameters.split_at(self.space.dimension());
        let nudges = self
            .frames
            .iter()
            .map(|frame| {
                let (own, after) = rest.split_at(2 * frame.positions.len());
                rest = after;
                own
            })
            .collect();
        (free, nudges)
    }

    /// β and the nudges of some of the frames, in one vector.
    pub fn part(&self, parameters: &[f64], frames: &[usize]) -> Vec<f64> {
        let (free, nudges) = self.split(parameters);
        let own = frames.iter().flat_map(|frame| nudges[*frame]);
        free.iter().chain(own).copied().collect()
    }

    /// Number of nudges of all frames, times two.
    pub fn nudge_count(&self) -> usize {
        self.frames.iter().map(|frame| 2 * frame.positions.len()).sum()
    }

    /// Number of measured components that neither backgrounds nor cells that were not seen take up.
    pub fn components(&self) -> usize {
        self.frames.iter().map(Observation::components).sum()
    }

    /// What Φ is expected to be if model and noise levels are right: σ_v² for each component that no coefficient takes up.
    pub fn expected(&self) -> f64 {
        let left = self.components() + self.space.priors().len();
        self.levels.velocity.powi(2) * left.saturating_sub(self.space.dimension()).max(1) as f64
    }

    /// The frame of an index displaced by its nudges, with a new tessellation; a fault is that frame's.
    pub fn displaced(&self, index: usize, nudges: &[f64]) -> Result<Nudged<'a>, Error> {
        self.displaced_within(index, nudges, self.frames[index].environment().clone())
    }

    /// The same where single cells have parts of their own, which depend on the coefficients.
    fn displaced_with_own(
        &self,
        index: usize,
        nudges: &[f64],
        coefficients: &[f64],
    ) -> Result<Nudged<'a>, Error> {
        let around = self.frames[index].environment();
        let environment = match self.own {
            Some(own) => own.environment(index, around, coefficients)?,
            None => around.clone(),
        };
        self.displaced_within(index, nudges, environment)
    }

    fn displaced_within(
        &self,
        index: usize,
        nudges: &[f64],
        environment: Arc<Environment>,
    ) -> Result<Nudged<'a>, Error> {
        let frame = &self.frames[index];
        let nudges = nudges.chunks_exact(2).map(|e| Vector::new(e[0], e[1]));
        let positions: Vec<Vector<f64>> = frame.positions.iter().zip(nudges).map(|(r, e)| r + e).collect();
        let tessellation =
            frame.moved_to(&positions).map_err(|source| Error::Geometry { frame: index, source })?;
        let sampling = frame.sampling(&tessellation, &positions);
        Ok(Nudged::placed(self.structure, environment, positions, tessellation, sampling))
    }

    /// The parts of Φ at a point; the residual is infinite where there is no tessellation.
    pub fn parts(&self, parameters: &[f64]) -> Parts {
        match self.placed_at(parameters) {
            Ok(placed) => self.parts_of(&placed, parameters),
            Err(_) => Parts { residual: f64::INFINITY, nudges: 0.0, priors: 0.0 },
        }
    }

    /// The parts of Φ: the sum of squared residuals, the sum of squared nudges, the penalty of the priors.
    fn parts_of(&self, placed: &[Moving<'_>], parameters: &[f64]) -> Parts {
        let (free, nudges) = self.split(parameters);
        let floor = self.floor() / self.spring();
        let of_frame = |((frame, nudges), (nudged, predicted)): ((&Observation, &&[f64]), &Moving<'_>)| {
            let squares = residuals(frame, predicted.as_measured())
                .into_iter()
                .map(|(datum, rest)| frame.weight(datum) * rest.norm_squared());
            let unseen = nudges.chunks_exact(2).enumerate().filter(|(cell, _)| !frame.is_seen(*cell));
            let stray = unseen.map(|(_, e)| floor * (e[0] * e[0] + e[1] * e[1])).sum::<f64>();
            let seen =
                position_rows::squares(frame, &nudged.tessellation, &nudged.positions, nudges).sum::<f64>();
            (squares.sum(), seen + stray)
        };
        let parts: Vec<(f64, f64)> = self.frames.par_iter().zip(&nudges).zip(placed).map(of_frame).collect();
        let (residual, nudges) =
            parts.into_iter().fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        Parts { residual, nudges, priors: self.prior_penalty(&self.space.coefficients(free)) }
    }

    /// Stiffness that keeps cells that were not seen where they were put.
    pub fn floor(&self) -> f64 {
        (self.levels.velocity / WHEREABOUTS).powi(2)
    }

    /// The penalty of the priors for given coefficients.
    pub fn prior_penalty(&self, coefficients: &DVector<f64>) -> f64 {
        self.space.penalty(coefficients, self.levels.velocity)
    }

    /// Φ; infinite where there is no tessellation.
    pub fn value(&self, parameters: &[f64]) -> f64 {
        self.placed_at(parameters).map_or(f64::INFINITY, |placed| self.value_of(&placed, parameters))
    }
}

/// The parts of Φ, without their factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Parts {
    /// Σ w ‖v − F‖²
    pub residual: f64,
    /// Σ m ‖y − H(r + ε)‖²
    pub nudges: f64,
    /// σ_v² Σ (q − m)² / s²
    pub priors: f64,
}

impl<'a> Placing for Objective<'a> {
    type Placed = Vec<Moving<'a>>;

    fn placed_at(&self, parameters: &[f64]) -> Result<Self::Placed, Error> {
        let (free, nudges) = self.split(parameters);
        let coefficients = self.space.coefficients(free);
        let of_frame = |(index, nudges): (usize, &&[f64])| {
            let nudged = self.displaced_with_own(index, nudges, coefficients.as_slice())?;
            let predicted = nudged.predict(coefficients.as_slice());
            Ok((nudged, predicted))
        };
        // Of several faults the first is told, whatever thread comes upon it.
        let all: Vec<Result<Moving<'_>, Error>> = nudges.par_iter().enumerate().map(of_frame).collect();
        all.into_iter().collect()
    }

    fn value_of(&self, placed: &Self::Placed, parameters: &[f64]) -> f64 {
        let parts = self.parts_of(placed, parameters);
        let value = parts.residual + self.spring() * parts.nudges + parts.priors;
        if value.is_nan() { f64::INFINITY } else { value }
    }

    fn linearise_of(&self, placed: &Self::Placed, parameters: &[f64]) -> Result<NormalEquations, Error> {
        self.linearise_among(placed, parameters, &[], None)
    }

    fn obstacles_between(
        &self,
        before: (&Self::Placed, &[f64]),
        after: (&Self::Placed, &[f64]),
        promised: f64,
    ) -> Option<Vec<usize>> {
        self.obstacles(before, after, promised)
    }
}
