//! The fit: naive, then nudged, with noise levels, intervals and errors.

use crate::coefficients::parameters;
use crate::cross_validation::{BLOCKS, Folds, Split, cross_validate};
use crate::curvature;
use crate::doubts::examine;
use crate::estimates::Fitted;
use crate::least_squares::{self, residuals_as_measured};
use crate::noisy_fit::{at_limit, fit, go_on, to_the_end};
use crate::normal_equations::{NormalEquations, Reduced};
use crate::normal_matrix::{invert, within_bounds};
use crate::objective::{Nudged, Objective};
use crate::robust::reweighed;
use crate::search::Watch;
use crate::spread::{self, Differing};
use crate::{
    CoefficientSpace, CrossValidation, Direction, Doubt, Error, Estimate, Examination, FrameResult,
    Inference, KindEstimates, KnownNoise, Method, Nmse, NoiseLevels, Observation, ParameterEstimates,
    Progress, Request, Status,
};
use nalgebra::DVector;
use std::ops::ControlFlow;
use voronudge_geometry::{Tessellation, Vector};

/// Rounds in which velocities that nothing explains lose their weight.
const REWEIGHTINGS: usize = 3;

/// Decrease of Φ, in units of σ_v², that coefficients may promise where the search ended to be given the rest of their way.
const REST: f64 = 1.0;

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
    let explained = to_be_explained(frames, &space)?;
    let naive = least_squares::fit(frames, &request.structure, &space)?;
    nudged(frames, request, (&space, &naive), explained, observe).map_err(|error| match error {
        // Where the cells were measured their velocities tell the coefficients apart.
        Error::Degenerate => voronudge_linalg::Error::NotPositiveDefinite.into(),
        other => other,
    })
}

/// The fit that follows least squares, with what it explains: the number of velocities and their squares.
fn nudged(
    frames: &[Observation],
    request: &Request,
    (space, naive): (&CoefficientSpace, &[f64]),
    (used, total): (usize, f64),
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Inference, Error> {
    let structure = &request.structure;
    let mut watch = Watch { observe };
    let unset = NoiseLevels { position: 1.0, velocity: 1.0 };
    let mut objective = Objective::new(frames, structure, space, unset);
    let mut found = fit(&mut objective, naive, request, &mut watch)?;
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
    let mut frames = weighted.as_deref().unwrap_or(given);
    found = to_the_end(&Objective { frames, levels, ..objective }, found, request)?;
    // Velocities held out are predicted with the parameters that all cells share.
    let folds = match request.cross_validation {
        CrossValidation::Done => {
            let alike = Objective { frames, levels, ..objective };
            cross_validate(&alike, &found.parameters, &Split::new(frames, BLOCKS), &mut watch)?
        }
        CrossValidation::Skipped => None,
    };
    let differing = match request.varied.is_empty() {
        true => None,
        false => {
            let alike = Objective { frames, levels, ..objective };
            Some(spread::fit(&alike, found.clone(), request, &mut watch)?)
        }
    };
    let alike = frames;
    if let Some(differing) = &differing {
        (frames, levels, found) = (&differing.frames, differing.levels, differing.found.clone());
    }
    let objective = Objective { frames, levels, ..objective };
    let (free, nudges) = objective.split(&found.parameters);
    let coefficients = space.coefficients(free);
    let parts = objective.parts(&found.parameters);
    let variance = levels.velocity.powi(2);
    let (value, expected) = (found.value / variance, objective.expected() / variance);
    // Where the model misses more than the noise explains, the misfit counts as noise.
    let excess = (value / expected).max(1.0);
    let own = differing.as_ref().map(Differing::own);
    let fitted = Objective { frames: alike, own: own.as_ref(), ..objective };
    let equations = fitted.linearise(&found.parameters)?;
    // What is not known of the measurement makes coefficients uncertain.
    let unknowns = frames.first().map_or(&[][..], Observation::unknowns);
    let mut reduced = match unknowns.is_empty() {
        true => equations.reduced()?,
        false => {
            fitted.linearise_with(&found.parameters, unknowns)?.reduced()?.without_last(unknowns.len())?
        }
    };
    // Neither is what single cells are like.
    let mut spreads = Vec::new();
    if let Some(differing) = &differing {
        reduced.information -= &differing.spent;
        let covariance = space.covariance(&invert(&reduced.information / (variance * excess))?);
        spreads = differing.spreads_beside(&coefficients, &covariance);
    }
    // Where the search ended, and cells are alike, it is known what the curvature of the forces did to the coefficients.
    let bias = match (&request.method, &differing) {
        (Method::Search { .. }, None) => {
            Some(curvature::bias(&objective, &found.parameters, &equations, &reduced)?)
        }
        _ => None,
    };
    let estimated = estimates(&equations, reduced, space, request, free, variance * excess, bias.as_ref())?;
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
        results.push(frame_result(frame, objective.displaced(index, nudges)?, &coefficients, held_out));
    }
    let cells: usize = frames.iter().map(|frame| frame.positions.len()).sum();
    let mut inference = Inference {
        parameters: estimated.parameters,
        effects: estimated.effects,
        kinds: estimated.kinds,
        directions: estimated.directions,
        model_parameters: parameters(&coefficients),
        naive: parameters(&space.coefficients(naive)),
        nmse: Nmse {
            naive: residual_at(naive) / total,
            nudged: parts.residual / total,
            un_nudged: residual_at(free) / total,
            noise_floor: match at_limit(&levels, &request.noise)
                || frames.iter().any(|own| own.share() != 0.0)
            {
                // Nudges as large as that are beyond the linear range, and sites that were found from centroids have errors that the
                // forces made larger, together.
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
        noise_source: request.noise.source(),
        degrees_of_freedom: equations.degrees_of_freedom()?,
        nudge_rms: (parts.nudges / cells as f64).sqrt(),
        contribution_ratio: objective.spring() * parts.nudges / parts.residual,
        frames: results,
        status: found.status,
        steps: found.steps,
        objective: value,
        expected_objective: expected,
        trace: found.trace.iter().map(|phi| phi / variance).collect(),
        starts: found.starts.iter().map(|phi| phi / variance).collect(),
        transitions: [found.transitions_tried, found.transitions_made],
        doubts: doubts(value, expected, &levels, &request.noise, found.status),
        spreads,
        used,
        total,
    };
    if request.examination == Examination::Done {
        let examined = if request.varied.is_empty() { given } else { frames };
        let further = examine(examined, request, &inference)?;
        inference.doubts.extend(further);
    }
    Ok(inference)
}

/// What a fit says of the model.
pub(crate) struct Estimates {
    pub parameters: ParameterEstimates,
    pub effects: Vec<Estimate>,
    pub kinds: Vec<KindEstimates>,
    pub directions: Vec<Direction>,
}

/// Estimates at β from the linearised problem about it, reduced to the coefficients, with σ_v² as the fit bears it out; where the bias of
/// β is known it is taken off, after the rest of the way that the search left.
pub(crate) fn estimates(
    equations: &NormalEquations,
    reduced: Reduced,
    space: &CoefficientSpace,
    request: &Request,
    free: &[f64],
    variance: f64,
    bias: Option<&DVector<f64>>,
) -> Result<Estimates, Error> {
    let mut centre = equations.unbounded(&reduced)?;
    let mut free = DVector::from_column_slice(free);
    if let Some(bias) = bias {
        centre += rest_of_the_way(&reduced, &centre - &free, variance)? - bias;
        free = within_bounds(space, centre.clone(), reduced.information.clone())?;
    }
    let (constraints, information) = (&request.constraints, reduced.information / variance);
    let fitted = Fitted { space, constraints, free: free.as_slice(), information: &information, centre };
    Ok(Estimates {
        parameters: fitted.estimates()?,
        effects: fitted.effects()?,
        kinds: request.kinds.as_ref().map_or(Ok(Vec::new()), |kinds| fitted.kinds(kinds))?,
        directions: fitted.directions()?,
    })
}

/// What the linearised problem would still move the coefficients by, beyond what bounds hold back. The search ends before cells at which
/// forces jump with their contacts; that is for these cells to end, and not for the coefficients, which all cells share. Nothing if it is so much that the
/// search cannot have ended there.
fn rest_of_the_way(reduced: &Reduced, held_back: DVector<f64>, variance: f64) -> Result<DVector<f64>, Error> {
    let rest = invert(reduced.information.clone())? * &reduced.gradient - held_back;
    let promised = rest.dot(&(&reduced.information * &rest));
    Ok(if promised <= REST * variance { rest } else { DVector::zeros(rest.len()) })
}

/// By how many standard deviations an objective, in units of σ_v², is above what is expected.
pub(crate) fn deviation(value: f64, expected: f64) -> f64 {
    (value - expected) / (2.0 * expected).sqrt()
}

/// Reasons not to trust a fit whose objective and its expected value are in units of σ_v².
pub(crate) fn doubts(
    value: f64,
    expected: f64,
    levels: &NoiseLevels,
    known: &KnownNoise,
    status: Status,
) -> Vec<Doubt> {
    let deviation = deviation(value, expected);
    let doubts = [
        (deviation > ACCEPTED_EXCESS).then_some(Doubt::Objective(deviation)),
        at_limit(levels, known).then_some(Doubt::PositionNoise),
        (status == Status::StepLimit).then_some(Doubt::Steps),
    ];
    doubts.into_iter().flatten().collect()
}

/// Pairs of neighbours before, but not after, and the other way round.
pub(crate) fn changed_edges(before: &Tessellation, after: &Tessellation) -> [Vec<(u32, u32)>; 2] {
    let (before, after) = (before.edges(), after.edges());
    let missing_from = |edges: &[(u32, u32, [i16; 2])], others: &[(u32, u32, [i16; 2])]| {
        edges
            .iter()
            .filter(|edge| others.binary_search(edge).is_err())
            .map(|edge| (edge.0, edge.1))
            .collect::<Vec<_>>()
    };
    [missing_from(&before, &after), missing_from(&after, &before)]
}

/// Number of velocities and their sum of squares, where there is enough to fit.
pub(crate) fn to_be_explained(
    frames: &[Observation],
    space: &CoefficientSpace,
) -> Result<(usize, f64), Error> {
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
    Ok((used, total))
}

/// One frame at its nudged positions.
fn frame_result(
    frame: &Observation,
    nudged: Nudged<'_>,
    coefficients: &DVector<f64>,
    held_out: Vec<Option<Vector<f64>>>,
) -> FrameResult {
    let evaluated = nudged.evaluate(coefficients.as_slice());
    let [edges_lost, edges_gained] = changed_edges(&frame.tessellation, &nudged.tessellation);
    let weights = match frame.is_weighted() {
        true => (0..frame.velocities.values().len()).map(|datum| frame.weight(datum)).collect(),
        false => Vec::new(),
    };
    FrameResult {
        polarities: Vec::new(),
        weights,
        edges_lost,
        edges_gained,
        predicted: evaluated.of_cells,
        predicted_data: evaluated.predicted,
        held_out,
        nudged_positions: nudged.positions,
        tessellation: nudged.tessellation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn coefficients_go_the_rest_of_a_short_way() {
        let information = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 2.0]);
        let gradient = DVector::from_vec(vec![0.6, 0.5]);
        let reduced = Reduced { information, gradient };
        let rest = |held_back: [f64; 2], variance: f64| {
            rest_of_the_way(&reduced, DVector::from_row_slice(&held_back), variance).unwrap()
        };
        let is = |found: DVector<f64>, expected: [f64; 2]| {
            assert!((found - DVector::from_row_slice(&expected)).norm() < 1e-12, "{expected:?}");
        };
        // It promises 0.16.
        is(rest([0.0; 2], 0.17), [0.1, 0.2]);
        is(rest([0.0; 2], 0.15), [0.0; 2]);
        // What bounds hold back is no rest.
        is(rest([0.1, 0.0], 0.17), [0.0, 0.2]);
    }
}
