//! The fit of a movie: coefficients, trajectories, noise levels, intervals and errors.

use super::fit::{Fit, fit};
use super::held_out::{AsMeasured, HeldOut, MeanVelocities, cross_validate};
use super::movie::Movie;
use super::objective::{MovieObjective, Placed};
use super::result::{Integration, Tracked};
use super::rule::Rule;
use super::states::States;
use crate::coefficients::parameters;
use crate::diagnostics::robust_variance;
use crate::doubts::{EXACT, tails, voids};
use crate::inference::{changed_edges, doubts, estimates};
use crate::noisy_fit::at_limit;
use crate::position_rows::PositionRows;
use crate::search::Watch;
use crate::{CrossValidation, Doubt, Error, FrameResult, Inference, Nmse, Observation, Progress, Request};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use voronudge_geometry::Vector;

/// Fits the model to cells followed through time: the trajectories are nudged, at the frames and between, until the model explains
/// how they go on.
///
/// Lengths in units of ℓ₀ and times such that velocities are of order one serve best (see [`crate::Scale`]). `observe` is told of
/// progress and may stop the fit. Frames of the result hold the cells of [`Movie::observations`], in the same order.
///
/// Errors are those of the mean velocities of cells between two frames, as seen. They are predicted by the mean of the model's velocities at
/// both frames as measured, but for [`nudged`](crate::Nmse::nudged) by those along the trajectories.
///
/// # Errors
/// [`Error`] if there is too little to fit, the terms cannot be told apart, or the caller stops.
pub fn infer_tracks(
    movie: &Movie,
    request: &Request,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<(Inference, Tracked), Error> {
    let space = request.space()?;
    let coarse = States::new(movie, Rule::TRAPEZOID)?;
    let (used, required) = (coarse.motions.len(), 2 * space.dimension() + 2);
    if used < required {
        return Err(Error::TooFewVelocities { used, required });
    }
    let mut watch = Watch { observe };
    let found = fit(movie, request, &space, &mut watch)?;
    let levels = found.levels;
    let objective =
        MovieObjective { movie, states: &found.states, structure: &request.structure, space: &space, levels };
    let (free, displacements) = objective.split(&found.parameters);
    let between = MovieObjective { states: &coarse, ..objective };
    let measured = AsMeasured::new(between, &displacements[2 * found.states.drifts.0..]);
    let total: f64 = measured.velocities().iter().map(|v| v.norm_squared()).sum();
    if total <= 0.0 {
        return Err(Error::NothingMoves);
    }
    let share_missed = |free: &[f64]| -> Result<f64, Error> {
        Ok(measured.residuals(free)?.iter().map(|rest| rest.norm_squared()).sum::<f64>() / total)
    };
    let parts = objective.parts(&found.parameters)?;
    let variance = levels.velocity.powi(2);
    let (value, expected) = (found.value / variance, objective.expected() / variance);
    let equations = objective.linearise(&found.parameters)?;
    let reduced = equations.reduced()?;
    let variance_of_fit = variance * (value / expected).max(1.0);
    let estimated = estimates(&equations, reduced, &space, request, free, variance_of_fit)?;
    let held_out = match request.cross_validation {
        CrossValidation::Done => cross_validate(&objective, &found.parameters, &measured, &mut watch)?,
        CrossValidation::Skipped => None,
    };
    let noise_floor = match at_limit(&levels, &request.noise) {
        true => f64::NAN,
        false => {
            let positions = between.linearise(&measured.at(free))?.sensitivity() * levels.position.powi(2);
            (2.0 * used as f64 * variance + positions) / total
        }
    };
    let placed = objective.place(&found.parameters)?;
    let stray = tails(&strays(&objective, &placed, displacements)).map(Doubt::Tails);
    let tracked = tracked(&objective, &found);
    let coefficients = space.coefficients(free);
    let means = mean_velocities(&objective, &placed);
    let missed = measured.velocities().into_iter().zip(&coarse.motions).map(|(seen, motion)| {
        let mean = means[motion.interval].get(&motion.track);
        mean.map_or(0.0, |mean| (seen - mean).norm_squared())
    });
    let nudged: f64 = missed.sum();
    let inference = Inference {
        parameters: estimated.parameters,
        effects: estimated.effects,
        directions: estimated.directions,
        model_parameters: parameters(&coefficients),
        naive: parameters(&space.coefficients(&found.naive)),
        nmse: Nmse {
            naive: share_missed(&found.naive)?,
            nudged: nudged / total,
            un_nudged: share_missed(free)?,
            noise_floor,
            cross_validated: held_out.as_ref().map(|held_out| held_out.error),
        },
        coefficients,
        noise: levels,
        noise_source: request.noise.source(),
        degrees_of_freedom: equations.degrees_of_freedom()?,
        nudge_rms: (parts.nudges / found.states.anchors.len().max(1) as f64).sqrt(),
        contribution_ratio: levels.spring() * parts.nudges / parts.residual,
        frames: frame_results(placed, &found.states, &means, held_out.as_ref()),
        status: found.status,
        steps: found.steps,
        objective: value,
        expected_objective: expected,
        trace: found.trace,
        starts: vec![value],
        transitions: [0, 0],
        doubts: doubts(value, expected, &levels, &request.noise, found.status)
            .into_iter()
            .chain((found.error > ACCEPTED_ERROR).then_some(Doubt::Integration(found.error)))
            .chain(voids(&movie.seen_by(coarse.clone())).map(Doubt::Voids))
            .chain(stray)
            .collect(),
        used,
        total,
    };
    Ok((inference, tracked))
}

/// Half the squared distances of the cells from where they were seen, of those whose motion is explained, in units of the usual one in
/// their frame.
fn strays(objective: &MovieObjective<'_>, placed: &Placed<'_>, displacements: &[f64]) -> Vec<f64> {
    let states = objective.states;
    let mut explained: Vec<Vec<bool>> =
        states.instants.iter().map(|instant| vec![false; instant.tracks.len()]).collect();
    for motion in &states.motions {
        for (node, cell) in motion.cells.iter().enumerate() {
            explained[motion.interval * states.rule.steps + node][*cell as usize] = true;
        }
    }
    let of_frame = |(index, cells): (usize, &Observation)| {
        let nudged = &placed.instants[index].0;
        let nudges = objective.nudges(index, displacements);
        let rows = PositionRows::new(cells, &nudged.tessellation, &nudged.positions, &nudges, 0, None);
        let own = rows.rows().rows.iter().filter(|(cell, ..)| explained[index][*cell]);
        let halved: Vec<f64> = own.map(|(_, rest, _)| 0.5 * rest.norm_squared()).collect();
        let usual = robust_variance(&halved).map_or(f64::INFINITY, |(variance, _)| variance);
        halved.into_iter().map(move |square| [square, square / usual]).collect::<Vec<_>>()
    };
    let all: Vec<[f64; 2]> = objective.frames().flat_map(of_frame).collect();
    // Far below the noise there is rounding.
    let variance = objective.levels.position.powi(2);
    let is_exact = all.iter().map(|square| square[0]).sum::<f64>() < EXACT * variance * all.len() as f64;
    all.into_iter().filter(|_| !is_exact).map(|square| square[1]).collect()
}

/// Mean velocities of the model along the trajectories.
fn mean_velocities(objective: &MovieObjective<'_>, placed: &Placed<'_>) -> MeanVelocities {
    let MovieObjective { movie, states, .. } = *objective;
    let mut means = vec![BTreeMap::new(); movie.frames() - 1];
    for motion in &states.motions {
        let steps = states.rule.steps;
        let sum: Vector<f64> = (0..steps).map(|step| objective.mean_velocity(placed, motion, step)).sum();
        let mean = sum / steps as f64;
        means[motion.interval].insert(motion.track, mean);
    }
    means
}

/// The frames of a movie at their nudged positions; data are the mean velocities up to the next frame.
fn frame_results(
    placed: Placed<'_>,
    states: &States,
    means: &MeanVelocities,
    held_out: Option<&HeldOut>,
) -> Vec<FrameResult> {
    let instants = states.instants.iter().zip(placed.instants);
    instants
        .filter_map(|(instant, (nudged, evaluated))| {
            let frame = instant.frame?;
            let [edges_lost, edges_gained] = changed_edges(&instant.cells.tessellation, &nudged.tessellation);
            let mean = |means: &MeanVelocities, track: &u32| -> Option<Vector<f64>> {
                means.get(frame).and_then(|means| means.get(track)).copied()
            };
            Some(FrameResult {
                weights: Vec::new(),
                edges_lost,
                edges_gained,
                predicted: evaluated.of_cells,
                predicted_data: instant
                    .tracks
                    .iter()
                    .map(|track| mean(means, track).unwrap_or(NOWHERE))
                    .collect(),
                held_out: instant
                    .tracks
                    .iter()
                    .map(|track| held_out.and_then(|held_out| mean(&held_out.predicted, track)))
                    .collect(),
                nudged_positions: nudged.positions,
                tessellation: nudged.tessellation,
            })
        })
        .collect()
}

/// The trajectories.
fn tracked(objective: &MovieObjective<'_>, found: &Fit) -> Tracked {
    let MovieObjective { movie, states, .. } = *objective;
    let (_, displacements) = objective.split(&found.parameters);
    let mut trajectories = Vec::with_capacity(movie.frames());
    for (index, instant) in states.instants.iter().enumerate().filter(|(_, i)| i.frame.is_some()) {
        let mut places = vec![None; movie.tracks.len()];
        for (track, r) in instant.tracks.iter().zip(objective.positions(index, displacements)) {
            places[*track as usize] = Some(r);
        }
        trajectories.push(places);
    }
    Tracked {
        trajectories,
        drifts: (0..movie.frames() - 1).map(|interval| objective.drift(interval, displacements)).collect(),
        integration: Integration { substeps: found.substeps, order: states.rule.order(), error: found.error },
    }
}

/// Standard errors by which a finer integration may change a coefficient.
const ACCEPTED_ERROR: f64 = 0.5;

/// No vector.
const NOWHERE: Vector<f64> = Vector::new(f64::NAN, f64::NAN);
