//! What is known of a model after its fit: error on data it has not seen, budget, whitened residual.

use super::result::{Budget, Fitted, HeldOut};
use super::steps::Model;
use crate::cross_validation::Folds;
use crate::diagnostics::{CellData, ResidualField, Structure, diagnose};
use crate::doubts::examine_residuals;
use crate::whitening::whitened_residuals;
use crate::{Error, FrameResult, Inference, Observation, Velocities};
use voronudge_geometry::{Vector, areas};

/// Areas and velocities of cells.
type Moving = (Vec<f64>, Vec<Vector<f64>>);

/// A fit with what it leaves.
#[derive(Clone, Copy)]
pub(super) struct Evidence<'a> {
    pub frames: &'a [Observation],
    pub identities: Option<&'a [Vec<i64>]>,
    /// Error of the base model: see [`error`].
    pub base_error: f64,
}

impl Evidence<'_> {
    pub fn of(&self, model: &Model, folds: Option<&Folds>) -> Result<Fitted, Error> {
        let frames = self.frames;
        let mut inference = model.inference.clone();
        let tracked = model.followed.as_ref().map(|followed| followed.tracked.clone());
        let residuals = match tracked {
            Some(_) => along_tracks(frames, &inference),
            None => {
                let residuals = whitened_residuals(frames, &model.request, &inference)?;
                inference.doubts.extend(examine_residuals(frames, &model.request, &inference, &residuals)?);
                residuals
            }
        };
        let places: Vec<Vec<Vector<f64>>> = frames
            .iter()
            .map(|frame| frame.targets().map(|(datum, _)| frame.position_of_datum(datum)).collect())
            .collect();
        let cells: Vec<Option<Moving>> = frames.iter().map(cell_data).collect();
        // The cells of the last frame of tracks go nowhere.
        let frames_that_move = frames.iter().rposition(|frame| frame.targets().next().is_some());
        let fields = (0..frames_that_move.map_or(0, |last| last + 1))
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
        let mut diagnostics = diagnose(&fields, identities.as_deref(), model.request.seed);
        if tracked.is_some() {
            // These residuals are correlated by the errors of the positions that they share.
            diagnostics.structure = Structure::untested();
        }
        let held_out = folds.map(HeldOut::of);
        let budget = self.budget(&inference, error(model, folds));
        Ok(Fitted { budget, held_out, residuals, diagnostics, inference, tracked })
    }

    fn budget(&self, inference: &Inference, error: f64) -> Budget {
        let components: usize = self.frames.iter().map(Observation::components).sum();
        let velocity_noise = components as f64 * inference.noise.velocity.powi(2) / inference.total;
        Budget {
            position_noise: inference.nmse.noise_floor - velocity_noise,
            velocity_noise,
            base: 1.0 - self.base_error,
            effects: self.base_error - error,
            unexplained: error - inference.nmse.noise_floor,
        }
    }
}

/// What a model leaves of the squared velocities: at the measured positions, or, of tracks, on motions held out, because a polarity is fitted to
/// each cell.
pub(super) fn error(model: &Model, folds: Option<&Folds>) -> f64 {
    match (&model.followed, folds) {
        (Some(_), Some(folds)) => folds.error()[0],
        _ => model.inference.nmse.un_nudged,
    }
}

/// What the motions along fitted tracks differ by from those seen, in units of the root mean square of a component.
fn along_tracks(frames: &[Observation], inference: &Inference) -> Vec<Vec<Vector<f64>>> {
    let of_frame = |(frame, fitted): (&Observation, &FrameResult)| -> Vec<Vector<f64>> {
        frame.targets().map(|(datum, v)| v - fitted.predicted_data[datum]).collect()
    };
    let mut all: Vec<Vec<Vector<f64>>> = frames.iter().zip(&inference.frames).map(of_frame).collect();
    let sum: f64 = all.iter().flatten().map(Vector::norm_squared).sum();
    let count = 2 * all.iter().map(Vec::len).sum::<usize>();
    let unit = (count as f64 / sum.max(f64::MIN_POSITIVE)).sqrt();
    all.iter_mut().flatten().for_each(|rest| *rest *= unit);
    all
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
