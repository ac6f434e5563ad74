//! The fit: naive, then nudged, with noise levels, intervals and errors.

use crate::coefficients::parameters;
use crate::cross_validation::{BLOCKS, Folds, Split, cross_validate};
use crate::doubts::examine;
use crate::estimates::Fitted;
use crate::least_squares::{self, residuals_as_measured};
use crate::noisy_fit::{at_limit, fit, go_on};
use crate::objective::{Nudged, Objective};
use crate::robust::reweighed;
use crate::search::Watch;
use crate::{
    CrossValidation, Doubt, Error, Examination, FrameResult, Inference, Nmse, NoiseLevels, NoiseSource,
    Observation, Progress, Request, Status,
};
use nalgebra::DVector;
use std::ops::ControlFlow;
use voronudge_geometry::Vector;

/// Rounds in which velocities that nothing explains lose their weight.
const REWEIGHTINGS: usize = 3;

/// Standard deviations by which an objective may exceed its expected value.
const ACCEPTED_EXCESS: f64 = 3.0;

/// Fits the model to snapshots. Frames share the parameters and have nudges of their own.
///
/// Positions in units of ℓ₀ and velocities of order one serve best (see [`crate::Scale`]); the estimates are in the same
/// units. `observe` is told of progress and may stop the fit.
///
/// # Errors
/// [`Error`] if there is too little to fit, the terms cannot be told apart, or the caller stops.
pub fn infer(
    frames: &[Observation],
    request: &Request,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Inference, Error> {
    let space = request.space()?;
    let used: usize = frames.iter().map(|frame| frame.targets().count()).sum();
    let required =
        2 * space.dimension() + 2 + frames.iter().map(Observation::background_dimension).sum::<usize>() / 2;
    if used < required {
        return Err(Error::TooFewVelocities { used, required });
    }
    let total: f64 = frames.iter().flat_map(Observation::explainable).map(|v| v.norm_squared()).sum();
    if total <= 0.0 {
        return Err(Error::NothingMoves);
    }
    let structure = &request.structure;
    let naive = least_squares::fit(frames, structure, &space)?;
    let mut watch = Watch { observe };
    let unset = NoiseLevels { position: 1.0, velocity: 1.0 };
    let mut objective = Objective { frames, structure, space: &space, levels: unset };
    let mut found = fit(&mut objective, &naive, request, &mut watch)?;
    let mut levels = objective.levels;
    let mut weighted: Option<Vec<Observation>> = None;
    for _ in 0..REWEIGHTINGS {
        let frames = weighted.as_deref().unwrap_or(frames);
        let Some(next) = reweighed(&Objective { frames, levels, ..objective }, &found.parameters)? else {
            break;
        };
        let mut objective = Objective { frames: &next, levels, ..objective };
        found = go_on(&mut objective, found, request, &mut watch)?;
        levels = objective.levels;
        weighted = Some(next);
    }
    let given = frames;
    let frames = weighted.as_deref().unwrap_or(given);
    let objective = Objective { frames, levels, ..objective };
    let folds = match request.cross_validation {
        CrossValidation::Done => {
            cross_validate(&objective, &found.parameters, &Split::new(frames, BLOCKS), &mut watch)?
        }
        CrossValidation::Skipped => None,
    };
    let (free, nudges) = objective.split(&found.parameters);
    let coefficients = space.coefficients(free);
    let parts = objective.parts(&found.parameters);
    let variance = levels.velocity.powi(2);
    let (value, expected) = (found.value / variance, objective.expected() / variance);
    // Where the model misses more than the noise explains, the misfit counts as noise.
    let excess = (value / expected).max(1.0);
    let equations = objective.linearise(&found.parameters)?;
    let reduced = equations.reduced()?;
    let centre = equations.unbounded(&reduced)?;
    let information = reduced.information / (variance * excess);
    let fitted =
        Fitted { space: &space, constraints: &request.constraints, free, information: &information, centre };
    let residual_at = |beta: &[f64]| -> f64 {
        let coefficients = space.coefficients(beta);
        let squares = |frame| residuals_as_measured(frame, structure, coefficients.as_slice());
        frames.iter().flat_map(squares).map(|(_, rest)| rest.norm_squared()).sum()
    };
    let mut results = Vec::with_capacity(frames.len());
    for (index, (frame, nudges)) in frames.iter().zip(&nudges).enumerate() {
        let held_out = match &folds {
            Some(folds) => folds.velocities[index].clone(),
            None => vec![None; frame.velocities.values().len()],
        };
        results.push(frame_result(frame, objective.place(index, nudges)?, &coefficients, held_out));
    }
    let cells: usize = frames.iter().map(|frame| frame.positions.len()).sum();
    let estimated = request.noise.position.is_none() || request.noise.velocity.is_none();
    let deviation = (value - expected) / (2.0 * expected).sqrt();
    let doubts = [
        (deviation > ACCEPTED_EXCESS).then_some(Doubt::Objective(deviation)),
        at_limit(&levels, &request.noise).then_some(Doubt::PositionNoise),
        (found.status == Status::StepLimit).then_some(Doubt::Steps),
    ];
    let mut inference = Inference {
        parameters: fitted.estimates()?,
        effects: fitted.effects()?,
        model_parameters: parameters(&coefficients),
        naive: parameters(&space.coefficients(&naive)),
        nmse: Nmse {
            naive: residual_at(&naive) / total,
            nudged: parts.residual / total,
            un_nudged: residual_at(free) / total,
            noise_floor: match at_limit(&levels, &request.noise) {
                // Nudges as large as that are beyond the linear range.
                true => f64::NAN,
                false => {
                    let positions = equations.sensitivity() * levels.position.powi(2);
                    (objective.components() as f64 * variance + positions) / total
                }
            },
            cross_validated: folds.as_ref().map(Folds::error),
        },
        coefficients,
        noise: levels,
        noise_source: if estimated { NoiseSource::Estimated } else { NoiseSource::Given },
        degrees_of_freedom: equations.degrees_of_freedom()?,
        nudge_rms: (parts.nudges / cells as f64).sqrt(),
        contribution_ratio: objective.spring() * parts.nudges / parts.residual,
        directions: fitted.directions()?,
        frames: results,
        status: found.status,
        steps: found.steps,
        objective: value,
        expected_objective: expected,
        trace: found.trace.iter().map(|phi| phi / variance).collect(),
        starts: found.starts.iter().map(|phi| phi / variance).collect(),
        transitions: [found.transitions_tried, found.transitions_made],
        doubts: doubts.into_iter().flatten().collect(),
        used,
        total,
    };
    if request.examination == Examination::Done {
        let further = examine(given, request, &inference)?;
        inference.doubts.extend(further);
    }
    Ok(inference)
}

/// One frame at its nudged positions.
fn frame_result(
    frame: &Observation,
    nudged: Nudged<'_>,
    coefficients: &DVector<f64>,
    held_out: Vec<Option<Vector<f64>>>,
) -> FrameResult {
    let evaluated = nudged.evaluate(coefficients.as_slice());
    let (before, after) = (frame.tessellation.edges(), nudged.tessellation.edges());
    let missing_from = |edges: &[(u32, u32, [i16; 2])], others: &[(u32, u32, [i16; 2])]| {
        edges
            .iter()
            .filter(|edge| others.binary_search(edge).is_err())
            .map(|edge| (edge.0, edge.1))
            .collect::<Vec<_>>()
    };
    let weights = match frame.is_weighted() {
        true => (0..frame.velocities.values().len()).map(|datum| frame.weight(datum)).collect(),
        false => Vec::new(),
    };
    FrameResult {
        weights,
        edges_lost: missing_from(&before, &after),
        edges_gained: missing_from(&after, &before),
        predicted: evaluated.of_cells,
        predicted_data: evaluated.predicted,
        held_out,
        nudged_positions: nudged.positions,
        tessellation: nudged.tessellation,
    }
}
