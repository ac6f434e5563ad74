//! All questions to a fit and its data.

use super::steps::long_steps;
use super::tails::tails;
use super::voids::voids;
use super::{Doubt, LEVEL};
use crate::diagnostics::{ResidualField, structure};
use crate::discover::measurement_scores;
use crate::whitening::whitened_residuals;
use crate::{Error, Inference, Observation, Request, Velocities};
use voronudge_geometry::Vector;

/// Effects of the catalogue that are errors of measurement, of velocities of cells and of those on a grid: what they move, a fit
/// explains with wrong parameters.
const EFFECTS: [&[&str]; 2] = [&["centroid_bias", "time_lag"], &["centroid_bias", "flow_blur"]];

/// Mean of half the squared whitened residuals, of which one is expected, below which there is nothing in them.
pub(crate) const EXACT: f64 = 0.05;

/// What there is to doubt in a fit beside its course.
///
/// # Errors
/// [`Error`] of the linearised problem.
pub(crate) fn examine(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
) -> Result<Vec<Doubt>, Error> {
    examine_residuals(frames, request, result, &whitened_residuals(frames, request, result)?)
}

/// The same with the whitened residuals of each frame.
///
/// # Errors
/// [`Error`] of the linearised problem.
pub(crate) fn examine_residuals(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
    residuals: &[Vec<Vector<f64>>],
) -> Result<Vec<Doubt>, Error> {
    let halved: Vec<f64> = residuals.iter().flatten().map(|u| 0.5 * u.norm_squared()).collect();
    // Far below the noise there is rounding, or nudges that explain everything.
    let is_exact = halved.iter().sum::<f64>() < EXACT * halved.len() as f64;
    let steps = request.frame_interval.and_then(|interval| long_steps(frames, interval));
    let of_data = [voids(frames).map(Doubt::Voids), steps.map(Doubt::LongSteps)];
    let mut doubts: Vec<Doubt> = of_data.into_iter().flatten().collect();
    if is_exact {
        return Ok(doubts);
    }
    let pattern = is_patterned(frames, residuals, request.seed)?.then_some(Doubt::Pattern);
    doubts.extend([tails(&halved).map(Doubt::Tails), pattern].into_iter().flatten());
    let on_grid = frames.iter().any(|frame| matches!(frame.velocities, Velocities::OnGrid(_)));
    let effects = measurement_scores(frames, request, result, EFFECTS[usize::from(on_grid)])?;
    let followed = effects.into_iter().filter(|(_, p, _)| *p < LEVEL);
    doubts.extend(followed.map(|(id, _, size)| Doubt::Effect(id, size)));
    Ok(doubts)
}

/// Whether residuals have a structure in space.
fn is_patterned(frames: &[Observation], residuals: &[Vec<Vector<f64>>], seed: u64) -> Result<bool, Error> {
    let places: Vec<Vec<Vector<f64>>> = frames
        .iter()
        .map(|frame| frame.targets().map(|(datum, _)| frame.position_of_datum(datum)).collect())
        .collect();
    let fields = (0..frames.len())
        .map(|k| ResidualField::new(k, &places[k], &residuals[k], frames[k].tessellation.domain(), 1.0))
        .collect::<Result<Vec<_>, _>>()?;
    // Random signs tell no p below 0.001, and two tests are made.
    Ok(structure(&fields, None, seed).p <= 2.0 * LEVEL)
}
