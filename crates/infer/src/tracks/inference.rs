//! The fit of a movie: coefficients, trajectories, noise levels, intervals and errors.

use super::fit::fit;
use super::fitted_movie::Fit;
use super::held_out::{AsMeasured, HeldOut, MeanVelocities, cross_validate};
use super::look::Seen;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::placed::Placed;
use super::present::Dynamics;
use super::result::{Integration, Tracked};
use super::rule::Rule;
use super::states::States;
use crate::coefficients::parameters;
use crate::cross_validation::Folds;
use crate::diagnostics::robust_variance;
use crate::doubts::{EXACT, tails, turning, voids};
use crate::fit_parameter::BASE;
use crate::inference::{changed_edges, doubts, estimates};
use crate::noisy_fit::at_limit;
use crate::position_rows::PositionRows;
use crate::search::Watch;
use crate::{Activity, CrossValidation, Doubt, Error, FrameResult, Inference, Nmse, Progress, Request};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use voronudge_geometry::Vector;

/// Fits the model to cells followed through time: the trajectories are nudged, at the frames and between, until the model explains
/// how they go on.
///
/// Lengths in units of ℓ₀ and times such that velocities are of order one serve best (see [`crate::Scale`]). `observe` is told of
/// progress and may stop the fit. Frames of the result hold the cells of [`Movie::observations`], in the same order.
///
/// Errors are those of the mean velocities of cells between two frames, as seen: [`nudged`](crate::Nmse::nudged) of those along the
/// trajectories; [`un_nudged`](crate::Nmse::un_nudged) of cells that are followed from where they were seen;
/// [`naive`](crate::Nmse::naive) of the mean of the velocities at both frames as measured; and held out, either of the
/// latter kind or, for long steps, of cells that are followed from their places in a fit without these displacements.
///
/// # Errors
/// [`Error`] if there is too little to fit, the terms cannot be told apart, or the caller stops.
pub fn infer_tracks(
    movie: &Movie,
    request: &Request,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<(Inference, Tracked), Error> {
    let (inference, mut followed) = follow(movie, request, None, &mut Watch { observe })?;
    followed.tracked.prospects = followed.prospects(movie, request, &inference).ok();
    Ok((inference, followed.tracked))
}

/// Where a fit of a movie has come to.
pub(crate) struct Followed {
    pub tracked: Tracked,
    /// Errors of motions left out of the fit.
    pub held_out: Option<Folds>,
    pub(super) fit: Fit,
}

/// See [`infer_tracks`]; perhaps from where the fit of a similar model has come to, with coefficients to begin with.
pub(crate) fn follow(
    movie: &Movie,
    request: &Request,
    from: Option<(&Followed, &[f64])>,
    watch: &mut Watch<'_>,
) -> Result<(Inference, Followed), Error> {
    let space = request.space()?;
    let mut states = States::new(movie)?;
    if request.activity != Activity::None {
        states = states.crawling(movie, BASE);
    }
    if request.activity == Activity::Alignment {
        states = states.aligning();
    }
    if request.activity != Activity::None {
        states = states.driven_by(request.drives);
    }
    let (explained, required) = (states.motions.len(), 2 * space.dimension() + 2);
    if explained < required {
        return Err(Error::TooFewVelocities { used: explained, required });
    }
    let from = from.and_then(|(earlier, coefficients)| {
        Some((&earlier.fit, earlier.point_for(&states, space.nearest(coefficients))?))
    });
    let found = fit(movie, states, request, &space, from, watch)?;
    let levels = found.levels;
    let (states, structure) = (&found.states, &request.structure);
    let (rule, memory) = (found.rule, found.memory);
    let objective = MovieObjective { movie, states, rule, structure, space: &space, levels, memory };
    let (free, displacements) = objective.split(&found.parameters);
    let measured = AsMeasured::new(objective, displacements);
    let velocities = &measured.velocities;
    let total: f64 = velocities.iter().flatten().map(|v| v.norm_squared()).sum();
    let used = velocities.iter().flatten().count();
    if total <= 0.0 {
        return Err(Error::NothingMoves);
    }
    let parts = objective.parts(&found.parameters)?;
    let variance = levels.velocity.powi(2);
    let (value, expected) = (found.value / variance, objective.expected() / variance);
    let equations = objective.linearise(&found.parameters)?;
    let reduced = equations.reduced()?;
    let information = reduced.information.clone();
    let variance_of_fit = variance * (value / expected).max(1.0);
    let estimated = estimates(&equations, reduced, &space, request, free, variance_of_fit, None)?;
    let held_out = match request.cross_validation {
        CrossValidation::Done => cross_validate(&measured, &found.parameters, &information, watch)?,
        CrossValidation::Skipped => None,
    };
    let noise_floor = match at_limit(&levels, &request.noise) {
        true => f64::NAN,
        false => {
            let of_places = measured.noise(&found.parameters, total / used as f64)?;
            (2.0 * used as f64 * variance + of_places) / total
        }
    };
    let placed = objective.displaced(&found.parameters)?;
    let stray = tails(&strays(&objective, &placed, displacements)).map(Doubt::Tails);
    let mut tracked = tracked(&objective, &found);
    let coefficients = space.coefficients(free);
    let means = mean_velocities(&objective, &placed, displacements)?;
    let components = objective.explained_components(&placed, &found.parameters);
    // Of cells that crawl the velocity at a frame is not the model's alone.
    let own_velocities = states.motions.iter().filter(|_| found.memory.is_none()).filter_map(|motion| {
        let along = placed.instants[motion.interval].1.of_cells[motion.cells[0] as usize];
        Some([along, *means[motion.interval].get(&motion.track)?])
    });
    let turning = turning(own_velocities).map(Doubt::Turning);
    let weights = motion_weights(states, objective.weights(&placed, &found.parameters));
    let missed = velocities.iter().zip(&states.motions).filter_map(|(seen, motion)| {
        let mean = means[motion.interval].get(&motion.track)?;
        Some((seen.as_ref()? - mean).norm_squared())
    });
    let nudged: f64 = missed.sum();
    let inference = Inference {
        spreads: Vec::new(),
        parameters: estimated.parameters,
        effects: estimated.effects,
        kinds: estimated.kinds,
        directions: estimated.directions,
        model_parameters: parameters(&coefficients),
        naive: parameters(&space.coefficients(&found.naive)),
        nmse: Nmse {
            naive: measured.missed(&found.naive, Rule::Trapezoid)? / total,
            nudged: nudged / total,
            un_nudged: measured.missed(free, found.rule)? / total,
            noise_floor,
            cross_validated: held_out.as_ref().map(|held_out| held_out.folds.error()),
        },
        coefficients,
        noise: levels,
        noise_source: request.noise.source(),
        degrees_of_freedom: equations.degrees_of_freedom()? - 2.0 * states.polarities.count() as f64,
        nudge_rms: (parts.nudges / states.anchors.len().max(1) as f64).sqrt(),
        contribution_ratio: levels.spring() * parts.nudges / parts.residual,
        frames: frame_results(
            placed,
            states,
            &means,
            &weights,
            &objective.polarities(displacements),
            held_out.as_ref(),
        ),
        status: found.status,
        steps: found.steps,
        objective: value,
        expected_objective: expected,
        trace: found.trace.clone(),
        starts: vec![value],
        transitions: [0, 0],
        doubts: doubts(value, expected, &levels, &request.noise, found.status)
            .into_iter()
            .chain((found.error > ACCEPTED_ERROR).then_some(Doubt::Integration(found.error)))
            .chain(turning)
            .chain(voids(&movie.seen_by(states.clone())).map(Doubt::Voids))
            .chain(stray)
            .collect(),
        used,
        total,
    };
    let seen = Seen { objective, equations: &equations, components, known: request.noise };
    tracked.polarity = seen.polarity(displacements)?;
    let held_out = held_out.map(|held_out| held_out.folds);
    Ok((inference, Followed { tracked, held_out, fit: found }))
}

/// Half the squared distances of the cells from where they were seen, of those whose motion is explained, in units of the usual one in
/// their frame.
fn strays(objective: &MovieObjective<'_>, placed: &Placed<'_>, displacements: &[f64]) -> Vec<f64> {
    let explained = objective.states.explained();
    let of_frame = objective.of_seen(placed, displacements, |frame, cells, nudged, nudges| {
        let rows = PositionRows::new(cells, &nudged.tessellation, &nudged.positions, nudges, 0, None);
        let own = rows.rows().rows.iter().filter(|(cell, ..)| explained[frame][*cell]);
        let halved: Vec<f64> = own.map(|(_, rest, _)| 0.5 * rest.norm_squared()).collect();
        let usual = robust_variance(&halved).map_or(f64::INFINITY, |(variance, _)| variance);
        halved.into_iter().map(|square| [square, square / usual]).collect::<Vec<_>>()
    });
    let all: Vec<[f64; 2]> = of_frame.into_iter().flatten().collect();
    // Far below the noise there is rounding.
    let variance = objective.levels.position.powi(2);
    let is_exact = all.iter().map(|square| square[0]).sum::<f64>() < EXACT * variance * all.len() as f64;
    all.into_iter().filter(|_| !is_exact).map(|square| square[1]).collect()
}

/// Mean velocities of the model along the trajectories, as they would be measured.
fn mean_velocities(
    objective: &MovieObjective<'_>,
    placed: &Placed<'_>,
    displacements: &[f64],
) -> Result<MeanVelocities, Error> {
    let mut means = vec![BTreeMap::new(); objective.movie.frames() - 1];
    let seen = objective.seen_velocities(placed, displacements)?;
    for (motion, mean) in objective.states.motions.iter().zip(seen) {
        means[motion.interval].insert(motion.track, mean);
    }
    Ok(means)
}

/// How much the motion of each cell of a frame to the next one counts; one where none is explained.
fn motion_weights(states: &States, of_motions: Vec<f64>) -> Vec<Vec<f64>> {
    let mut weights: Vec<Vec<f64>> =
        states.instants.iter().map(|instant| vec![1.0; instant.tracks.len()]).collect();
    for (motion, weight) in states.motions.iter().zip(of_motions) {
        weights[motion.interval][motion.cells[0] as usize] = weight;
    }
    weights
}

/// The frames of a movie at their nudged positions; data are the mean velocities up to the next frame.
fn frame_results(
    placed: Placed<'_>,
    states: &States,
    means: &MeanVelocities,
    weights: &[Vec<f64>],
    polarities: &[Vec<Option<Vector<f64>>>],
    held_out: Option<&HeldOut>,
) -> Vec<FrameResult> {
    let instants = states.instants.iter().zip(placed.instants).enumerate();
    instants
        .map(|(frame, (instant, (nudged, evaluated)))| {
            let [edges_lost, edges_gained] = changed_edges(&instant.cells.tessellation, &nudged.tessellation);
            let mean = |means: &MeanVelocities, track: &u32| -> Option<Vector<f64>> {
                means.get(frame).and_then(|means| means.get(track)).copied()
            };
            FrameResult {
                polarities: polarities[frame].clone(),
                weights: weights[frame].clone(),
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
            }
        })
        .collect()
}

/// The trajectories.
fn tracked(objective: &MovieObjective<'_>, found: &Fit) -> Tracked {
    let MovieObjective { movie, states, .. } = *objective;
    let (_, displacements) = objective.split(&found.parameters);
    let mut trajectories = Vec::with_capacity(movie.frames());
    for (frame, instant) in states.instants.iter().enumerate() {
        let mut places = vec![None; movie.tracks.len()];
        for (track, r) in instant.tracks.iter().zip(objective.positions(frame, displacements)) {
            places[*track as usize] = Some(r);
        }
        trajectories.push(places);
    }
    Tracked {
        trajectories,
        drifts: (0..movie.frames() - 1).map(|interval| objective.drift(interval, displacements)).collect(),
        integration: Integration {
            substeps: found.rule.steps(),
            order: found.rule.order(),
            error: found.error,
        },
        polarity: None,
        prospects: None,
        dynamics: Dynamics { rule: found.rule, memory: found.memory, levels: found.levels },
    }
}

/// Standard errors by which a finer integration may change a coefficient.
const ACCEPTED_ERROR: f64 = 0.5;

/// No vector.
const NOWHERE: Vector<f64> = Vector::new(f64::NAN, f64::NAN);
