//! What is known of a model after its fit: error on data it has not seen, budget, whitened residual.

use super::result::{Budget, Fitted, HeldOut};
use super::steps::Model;
use crate::cross_validation::Folds;
use crate::diagnostics::{CellData, ResidualField, diagnose};
use crate::doubts::examine_residuals;
use crate::whitening::whitened_residuals;
use crate::{Error, Inference, Observation, Velocities};
use voronudge_geometry::{Vector, areas};

/// Areas and velocities of cells.
type Moving = (Vec<f64>, Vec<Vector<f64>>);

/// A fit with what it leaves.
#[derive(Clone, Copy)]
pub(super) struct Evidence<'a> {
    pub frames: &'a [Observation],
    pub identities: Option<&'a [Vec<i64>]>,
    /// Error of the base model at the measured positions.
    pub base_error: f64,
}

impl Evidence<'_> {
    pub fn of(&self, model: &Model, folds: Option<&Folds>) -> Result<Fitted, Error> {
        let frames = self.frames;
        let mut inference = model.inference.clone();
        let residuals = whitened_residuals(frames, &model.request, &inference)?;
        inference.doubts.extend(examine_residuals(frames, &model.request, &inference, &residuals)?);
        let places: Vec<Vec<Vector<f64>>> = frames
            .iter()
            .map(|frame| frame.targets().map(|(datum, _)| frame.place(datum)).collect())
            .collect();
        let cells: Vec<Option<Moving>> = frames.iter().map(cell_data).collect();
        let fields = (0..frames.len())
            .map(|k| {
                let domain = frames[k].tessellation.domain();
                let field = ResidualField::new(k, &places[k], &residuals[k], domain, 1.0)?;
                match &cells[k] {
                    Some((areas, velocities)) => field.with_cells(k, CellData { areas, velocities }),
                    None => Ok(field),
                }
            })
            .collect::<Result<Vec<_>, _>>()?;
        let identities: Option<Vec<Vec<i64>>> = self.identities.map(|all| {
            let own = |(frame, ids): (&Observation, &Vec<i64>)| {
                frame.targets().map(|(datum, _)| ids.get(datum).copied().unwrap_or(-1)).collect()
            };
            frames.iter().zip(all).map(own).collect()
        });
        let diagnostics = diagnose(&fields, identities.as_deref(), model.request.seed);
        let held_out = folds.map(HeldOut::of);
        Ok(Fitted { budget: self.budget(&inference), held_out, residuals, diagnostics, inference })
    }

    fn budget(&self, inference: &Inference) -> Budget {
        let components: usize = self.frames.iter().map(Observation::components).sum();
        let velocity_noise = components as f64 * inference.noise.velocity.powi(2) / inference.total;
        Budget {
            position_noise: inference.nmse.noise_floor - velocity_noise,
            velocity_noise,
            base: 1.0 - self.base_error,
            effects: self.base_error - inference.nmse.un_nudged,
            unexplained: inference.nmse.un_nudged - inference.nmse.noise_floor,
        }
    }
}

/// Areas and velocities of the cells with a target; nothing for velocities on a grid.
fn cell_data(frame: &Observation) -> Option<Moving> {
    match &frame.velocities {
        Velocities::OnGrid(_) => None,
        Velocities::OfCells(_) => {
            let all = areas(&frame.tessellation, &frame.positions);
            Some(frame.targets().map(|(cell, v)| (all[cell], v)).unzip())
        }
    }
}
