//! The fit: naive, then nudged, with noise levels, intervals and errors.

use crate::coefficients::parameters;
use crate::cross_validation::cross_validate;
use crate::degrees_of_freedom::degrees_of_freedom;
use crate::estimates::{directions, estimates};
use crate::fit::nudged_fit;
use crate::least_squares::{self, invert, predict, residuals};
use crate::noise::{FIRST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE, Spent};
use crate::objective::Objective;
use crate::{
    CoefficientSpace, Error, FrameResult, Inference, Nmse, NoiseLevels, NoiseSource, Observation, Progress,
    Request,
};
use nalgebra::{DMatrix, Vector4};
use std::ops::ControlFlow;
use voronudge_model::{Model, Term, base_terms, jacobian};

/// Rounds of estimating the noise levels.
const NOISE_ROUNDS: usize = 6;

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
    let space = CoefficientSpace::new(&request.fixed)?;
    let used: usize = frames.iter().map(|frame| frame.targets().count()).sum();
    let required = 2 * space.dimension() + 2;
    if used < required {
        return Err(Error::TooFewVelocities { used, required });
    }
    let total: f64 = frames.iter().flat_map(Observation::targets).map(|(_, v)| v.norm_squared()).sum();
    if total <= 0.0 {
        return Err(Error::NothingMoves);
    }
    let terms = base_terms(request.preferred_area);
    let naive = least_squares::fit(frames, &terms, &space)?;
    let mut levels = first_levels(frames, request, &terms, &space, &naive)?;
    let estimated = request.position_noise.is_none() || request.velocity_noise.is_none();
    let mut objective = Objective { frames, terms: &terms, space: &space, spring: levels.spring() };
    let mut fit = nudged_fit(&mut objective, &naive, &levels, request.max_steps, "fit", observe)?;
    let mut steps = fit.steps;
    let mut spent = account(&objective, &fit.parameters, used)?;
    for _ in 0..if estimated { NOISE_ROUNDS } else { 0 } {
        let updated = spent.update(&levels);
        let next = NoiseLevels {
            position: request.position_noise.unwrap_or(updated.position),
            velocity: request.velocity_noise.unwrap_or(updated.velocity),
        };
        let change = (next.spring() / levels.spring()).ln().abs();
        levels = next;
        fit = nudged_fit(&mut objective, &naive, &levels, request.max_steps, "noise and fit", observe)?;
        steps += fit.steps;
        spent = account(&objective, &fit.parameters, used)?;
        if change < 0.05 {
            break;
        }
    }
    let cross_validated =
        cross_validate(frames, &terms, &space, &levels, request.max_steps.min(12), observe)?;
    let (free, nudges) = objective.split(&fit.parameters);
    let coefficients = space.coefficients(free);
    let objective_value = (spent.residual + levels.spring() * spent.nudges) / levels.velocity.powi(2);
    let expected = spent.components - spent.free;
    // Where the model misses more than the noise explains, the misfit counts as noise.
    let variance = levels.velocity.powi(2) * (objective_value / expected.max(1.0)).max(1.0);
    let information = schur(&objective, &fit.parameters)?;
    let covariance = invert(information.clone())? * variance;
    let residual_at = |beta: &[f64]| -> f64 {
        let coefficients = space.coefficients(beta);
        let squares =
            |frame| residuals(frame, &terms, coefficients.as_slice()).map(|(_, rest)| rest.norm_squared());
        frames.iter().map(|frame| squares(frame).sum::<f64>()).sum()
    };
    let mut sensitivity = 0.0;
    let results = frames
        .iter()
        .zip(&nudges)
        .enumerate()
        .map(|(index, (frame, nudges))| {
            frame_result(&objective, frame, nudges, &coefficients)
                .map(|(result, own)| {
                    sensitivity += own;
                    result
                })
                .map_err(|source| Error::Geometry { frame: index, source })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let cells: usize = frames.iter().map(|frame| frame.positions.len()).sum();
    Ok(Inference {
        parameters: estimates(&coefficients, &space.covariance(&covariance), &request.fixed),
        model_parameters: parameters(&coefficients, request.preferred_area),
        naive: parameters(&space.coefficients(&naive), request.preferred_area),
        nmse: Nmse {
            naive: residual_at(&naive) / total,
            nudged: spent.residual / total,
            un_nudged: residual_at(free) / total,
            noise_floor: (spent.components * levels.velocity.powi(2) + sensitivity * levels.position.powi(2))
                / total,
            cross_validated,
        },
        noise: levels,
        noise_source: if estimated { NoiseSource::Estimated } else { NoiseSource::Given },
        degrees_of_freedom: spent.degrees_of_freedom,
        nudge_rms: (spent.nudges / cells as f64).sqrt(),
        directions: directions(&space, &(information / variance)),
        frames: results,
        status: fit.status,
        steps,
        objective: objective_value,
        expected_objective: expected,
        trace: fit.trace.iter().map(|phi| phi / levels.velocity.powi(2)).collect(),
        used,
    })
}

/// Noise levels before any nudged fit: as given, or a usual position noise and the spread of the naive residual.
fn first_levels(
    frames: &[Observation],
    request: &Request,
    terms: &[Term],
    space: &CoefficientSpace,
    naive: &[f64],
) -> Result<NoiseLevels, Error> {
    for (name, value) in [("position", request.position_noise), ("velocity", request.velocity_noise)] {
        if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
            return Err(Error::Noise { name, value });
        }
    }
    let coefficients = space.coefficients(naive);
    let mut sizes: Vec<f64> = frames
        .iter()
        .flat_map(|frame| residuals(frame, terms, coefficients.as_slice()))
        .flat_map(|(_, rest)| [rest.x.abs(), rest.y.abs()])
        .collect();
    sizes.sort_unstable_by(f64::total_cmp);
    // The median absolute deviation of a normal distribution is 0.6745 standard deviations.
    let spread = sizes[sizes.len() / 2] / 0.6745;
    Ok(NoiseLevels {
        position: request.position_noise.unwrap_or(FIRST_POSITION_NOISE),
        velocity: request.velocity_noise.unwrap_or((0.3 * spread).max(SMALLEST_VELOCITY_NOISE)),
    })
}

/// Residuals, nudges and degrees of freedom at a solution.
fn account(objective: &Objective<'_>, parameters: &[f64], used: usize) -> Result<Spent, Error> {
    let (residual, nudges) = objective.parts(parameters);
    let degrees_of_freedom = objective
        .linearise(parameters)?
        .iter()
        .map(|frame| degrees_of_freedom(frame, objective.spring))
        .sum::<Result<f64, _>>()?;
    Ok(Spent {
        residual,
        components: 2.0 * used as f64,
        nudges,
        degrees_of_freedom,
        free: objective.space.dimension() as f64,
    })
}

/// The information on β with the nudges eliminated, in units of 1/σ_v².
fn schur(objective: &Objective<'_>, parameters: &[f64]) -> Result<DMatrix<f64>, Error> {
    let p = objective.space.dimension();
    let mut sum = DMatrix::zeros(p, p);
    for frame in objective.linearise(parameters)? {
        sum += frame.eliminate(0.0)?.schur;
    }
    Ok(sum)
}

/// One frame at its nudged positions, and `‖∂v/∂r‖²` over the velocities used.
fn frame_result(
    objective: &Objective<'_>,
    frame: &Observation,
    nudges: &[f64],
    coefficients: &Vector4<f64>,
) -> Result<(FrameResult, f64), voronudge_geometry::Error> {
    let nudged = objective.nudge(frame, nudges)?;
    let predicted = (0..frame.positions.len())
        .map(|cell| predict(&nudged.columns, coefficients.as_slice(), cell))
        .collect();
    let (before, after) = (frame.tessellation.edges(), nudged.tessellation.edges());
    let missing_from = |edges: &[(u32, u32, [i16; 2])], others: &[(u32, u32, [i16; 2])]| {
        edges
            .iter()
            .filter(|edge| others.binary_search(edge).is_err())
            .map(|edge| (edge.0, edge.1))
            .collect::<Vec<_>>()
    };
    let model = Model::with_coefficients(objective.terms, coefficients.as_slice());
    let jacobian = jacobian(&nudged.tessellation, &nudged.positions, &model);
    let sensitivity = frame
        .targets()
        .flat_map(|(cell, _)| {
            jacobian.row(cell).map(|(_, block)| block.iter().map(|entry| entry * entry).sum::<f64>())
        })
        .sum();
    let result = FrameResult {
        edges_lost: missing_from(&before, &after),
        edges_gained: missing_from(&after, &before),
        nudged_positions: nudged.positions,
        tessellation: nudged.tessellation,
        predicted,
    };
    Ok((result, sensitivity))
}
