//! The penalised objective of nudged inference as a problem for argmin.

use crate::least_squares::{Columns, free_columns, predict};
use crate::linearisation::{Linearisation, Local};
use crate::{CoefficientSpace, Error, Observation};
use argmin::core::{CostFunction, Error as ArgminError, Jacobian};
use nalgebra::DMatrix;
use rayon::prelude::*;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::{Model, Term, columns, jacobian};

/// `Φ(β, ε) = Σ ‖v − F_β(r + ε)‖² + k Σ ‖ε‖²` over all frames. The parameter vector is β, then ε frame by frame as
/// x₀, y₀, x₁, …
///
/// Φ / σ_v² is twice the negative log likelihood, up to a constant.
pub(crate) struct Objective<'a> {
    pub frames: &'a [Observation],
    pub terms: &'a [Term],
    pub space: &'a CoefficientSpace,
    /// k = σ_v² / σ_r².
    pub spring: f64,
}

/// One frame at nudged positions.
pub(crate) struct Nudged {
    pub positions: Vec<Vector<f64>>,
    pub nudges: Vec<Vector<f64>>,
    pub tessellation: Tessellation,
    pub columns: Columns,
}

impl Objective<'_> {
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

    /// Number of nudges of all frames, times two.
    pub fn nudge_count(&self) -> usize {
        self.frames.iter().map(|frame| 2 * frame.positions.len()).sum()
    }

    /// A frame displaced by its nudges, with a new tessellation.
    pub fn nudge(&self, frame: &Observation, nudges: &[f64]) -> Result<Nudged, voronudge_geometry::Error> {
        let nudges: Vec<Vector<f64>> = nudges.chunks_exact(2).map(|e| Vector::new(e[0], e[1])).collect();
        let positions: Vec<Vector<f64>> = frame.positions.iter().zip(&nudges).map(|(r, e)| r + e).collect();
        let tessellation = Tessellation::new(&positions, frame.tessellation.domain())?;
        let columns = columns(&tessellation, &positions, self.terms);
        Ok(Nudged { positions, nudges, tessellation, columns })
    }

    /// Φ and its parts: the sum of squared residuals and the sum of squared nudges.
    pub fn parts(&self, parameters: &[f64]) -> (f64, f64) {
        let (free, nudges) = self.split(parameters);
        let coefficients = self.space.coefficients(free);
        let parts: Vec<(f64, f64)> = self
            .frames
            .par_iter()
            .zip(&nudges)
            .map(|(frame, nudges)| {
                // A trial that moves cells onto each other, or opens the polygon of a cell that counts, is no solution.
                let Ok(nudged) = self.nudge(frame, nudges) else {
                    return (f64::INFINITY, 0.0);
                };
                let residual: f64 = frame
                    .targets()
                    .map(|(cell, v)| {
                        (v - predict(&nudged.columns, coefficients.as_slice(), cell)).norm_squared()
                    })
                    .sum();
                (residual, nudges.iter().map(|e| e * e).sum())
            })
            .collect();
        parts.into_iter().fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1))
    }

    /// The linearised problem of each frame.
    pub fn linearise(&self, parameters: &[f64]) -> Result<Vec<Linearisation>, Error> {
        let (free, nudges) = self.split(parameters);
        let coefficients = self.space.coefficients(free);
        self.frames
            .par_iter()
            .zip(&nudges)
            .enumerate()
            .map(|(index, (frame, nudges))| {
                let nudged =
                    self.nudge(frame, nudges).map_err(|source| Error::Geometry { frame: index, source })?;
                let model = Model::with_coefficients(self.terms, coefficients.as_slice());
                let rows: Vec<(usize, Vector<f64>, DMatrix<f64>)> = frame
                    .targets()
                    .map(|(cell, v)| {
                        let residual = v - predict(&nudged.columns, coefficients.as_slice(), cell);
                        (cell, residual, free_columns(&nudged.columns, self.space, cell))
                    })
                    .collect();
                Linearisation::new(&Local {
                    jacobian: &jacobian(&nudged.tessellation, &nudged.positions, &model),
                    rows: &rows,
                    nudges: &nudged.nudges,
                    spring: self.spring,
                    free: self.space.dimension(),
                })
            })
            .collect()
    }
}

// argmin takes its problem by value: it is given a reference.
impl CostFunction for &Objective<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, parameters: &Vec<f64>) -> Result<f64, ArgminError> {
        let (residual, nudges) = self.parts(parameters);
        let cost = residual + self.spring * nudges;
        Ok(if cost.is_nan() { f64::INFINITY } else { cost })
    }
}

impl Jacobian for &Objective<'_> {
    type Param = Vec<f64>;
    type Jacobian = Vec<Linearisation>;

    fn jacobian(&self, parameters: &Vec<f64>) -> Result<Vec<Linearisation>, ArgminError> {
        Ok(self.linearise(parameters)?)
    }
}
