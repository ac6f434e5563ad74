//! Fit and noise levels in turn.

use crate::excerpt::excerpts;
use crate::least_squares::{self, residuals_as_measured};
use crate::noise::{FIRST_POSITION_NOISE, LARGEST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE};
use crate::objective::{Objective, Patches};
use crate::restricted::Restricted;
use crate::search::{Effort, Found, Watch, descend, follow, improve, refine};
use crate::unknown::Unknown;
use crate::{Error, KnownNoise, Method, NoiseLevels, Observation, Request};

/// Rounds of estimating the noise levels before contacts are flipped, and after.
const ROUNDS: [usize; 2] = [6, 3];

/// Steps of the optimiser where only noise levels are wanted.
const NOISE_STEPS: u64 = 60;

/// Steps of the optimiser between two estimates.
pub(crate) const STEPS_PER_ROUND: u64 = 8;

/// Position noise, in units of ℓ₀, of positions that are almost exact.
const ALMOST_EXACT: f64 = 2e-3;

/// Change of log σ that counts as none.
pub(crate) const SETTLED: f64 = 0.02;

/// Steps of the optimiser, of those that are allowed, before it is known which velocities count: large frames are led to their end once it is.
fn on_the_way(frames: &[Observation], most: u64) -> u64 {
    if frames.iter().any(Patches::are_of) { STEPS_PER_ROUND.min(most) } else { most }
}

/// Finds parameters, nudges and, where they are not known, noise levels, large frames [to the end](to_the_end) but for some steps. The objective has the levels on return.
pub(crate) fn fit(
    objective: &mut Objective<'_>,
    naive: &[f64],
    request: &Request,
    watch: &mut Watch<'_>,
) -> Result<Found, Error> {
    objective.levels = first_levels(objective, naive, &request.noise)?;
    let estimated = request.noise.position.is_none() || request.noise.velocity.is_none();
    let (max_steps, starts) = match request.method {
        Method::Search { max_steps, starts } => (max_steps, starts),
        Method::Descent { max_steps, loss } => {
            // The paper's optimiser takes noise levels as they are: those that a search finds, if none are given.
            if estimated {
                let found = follow(objective, naive, NOISE_STEPS, "noise", watch)?;
                settle(objective, found, request, NOISE_STEPS, ROUNDS[0], watch)?;
            }
            return descend(objective, naive, loss, max_steps, watch);
        }
    };
    let mut found = if !estimated {
        follow(objective, naive, max_steps, "fit", watch)?
    } else if let Some(part) = excerpts(objective.frames)? {
        let naive = least_squares::fit(&part, objective.structure, objective.space)?;
        let mut own = Objective { frames: &part, ..*objective };
        own.levels = first_levels(&own, &naive, &request.noise)?;
        let begun = begin(&mut own, &naive, request, max_steps, watch)?;
        objective.levels = own.levels;
        follow(objective, own.split(&begun.parameters).0, max_steps, "fit", watch)?
    } else {
        let begun = begin(objective, naive, request, max_steps, watch)?;
        // The levels have moved on from those of the continuation.
        better(begun, follow(objective, naive, max_steps, "fit", watch)?)
    };
    improve(objective, &mut found, &Effort { max_steps, starts, seed: request.seed }, watch)?;
    if estimated {
        let most = on_the_way(objective.frames, max_steps);
        found = settle(objective, found, request, most, ROUNDS[1], watch)?.found;
    }
    Ok(found)
}

/// A fit from which noise levels follow that were but guessed, and the levels.
fn begin(
    objective: &mut Objective<'_>,
    naive: &[f64],
    request: &Request,
    max_steps: u64,
    watch: &mut Watch<'_>,
) -> Result<Found, Error> {
    // It is not worth a fit to the end.
    let first = follow(objective, naive, STEPS_PER_ROUND.min(max_steps), "fit", watch)?;
    let settled = settle(objective, first, request, max_steps, ROUNDS[0], watch)?;
    Ok(match exact_positions(objective, naive, request, max_steps, settled.criterion, watch)? {
        Some((levels, other)) if other.criterion < settled.criterion => {
            objective.levels = levels;
            other.found
        }
        _ => settled.found,
    })
}

/// A fit whose noise levels have settled.
struct Settled {
    found: Found,
    /// −2 log restricted likelihood of the levels, up to a constant of the data.
    criterion: f64,
}

/// Goes on from a fit to data with other weights, large frames [to the end](to_the_end) but for some steps.
pub(crate) fn go_on(
    objective: &mut Objective<'_>,
    found: Found,
    request: &Request,
    watch: &mut Watch<'_>,
) -> Result<Found, Error> {
    let max_steps = match request.method {
        Method::Search { max_steps, .. } => max_steps,
        // Weights are no concern of the paper's optimiser.
        Method::Descent { .. } => return Ok(found),
    };
    // Known levels stay as they are.
    let most = on_the_way(objective.frames, max_steps);
    Ok(settle(objective, found, request, most, ROUNDS[1], watch)?.found)
}

/// Leads a fit to its end, levels and weights as they are, where that was left for then.
pub(crate) fn to_the_end(objective: &Objective<'_>, found: Found, request: &Request) -> Result<Found, Error> {
    match request.method {
        Method::Search { max_steps, .. } if on_the_way(objective.frames, max_steps) < max_steps => {
            further(objective, found, max_steps)
        }
        Method::Search { .. } | Method::Descent { .. } => Ok(found),
    }
}

/// Some steps more.
fn further(objective: &Objective<'_>, found: Found, steps: u64) -> Result<Found, Error> {
    let optimum = refine(objective, found.parameters, steps)?;
    Ok(Found {
        steps: found.steps + optimum.steps,
        parameters: optimum.parameters,
        value: optimum.value,
        status: optimum.status,
        ..found
    })
}

/// The levels and the fit that follow if positions are taken to be almost exact at first; `None` if their noise is known or
/// levels of that kind are less likely than those of the criterion given.
///
/// The likelihood of the levels can have two maxima: with small nudges, the velocities mostly noise to the model, and with
/// large ones that explain what the model cannot.
fn exact_positions(
    objective: &Objective<'_>,
    naive: &[f64],
    request: &Request,
    max_steps: u64,
    criterion: f64,
    watch: &mut Watch<'_>,
) -> Result<Option<(NoiseLevels, Settled)>, Error> {
    if request.noise.position.is_some() {
        return Ok(None);
    }
    let first = first_levels(objective, naive, &request.noise)?;
    let mut other = Objective { levels: NoiseLevels { position: ALMOST_EXACT, ..first }, ..*objective };
    let mut start = naive.to_vec();
    start.resize(naive.len() + objective.nudge_count(), 0.0);
    if most_likely(&other, &start, &[], &request.noise)?.1 >= criterion {
        return Ok(None);
    }
    let found = refine(&other, start, STEPS_PER_ROUND)?.found(Vec::new());
    let settled = settle(&mut other, found, request, max_steps, ROUNDS[0], watch)?;
    Ok(Some((other.levels, settled)))
}

fn better(one: Found, other: Found) -> Found {
    let steps = one.steps + other.steps;
    let best = if other.value < one.value { other } else { one };
    Found { steps, ..best }
}

/// Estimates noise levels and refits until they stay.
fn settle(
    objective: &mut Objective<'_>,
    mut found: Found,
    request: &Request,
    max_steps: u64,
    rounds: usize,
    watch: &mut Watch<'_>,
) -> Result<Settled, Error> {
    let mut criterion = f64::INFINITY;
    for round in 0..rounds {
        watch.tell("noise", (round as u64, rounds as u64), found.value / objective.expected())?;
        let (next, likelihood) = most_likely(objective, &found.parameters, &[], &request.noise)?;
        criterion = likelihood;
        let change = (next.position / objective.levels.position).ln().abs()
            + (next.velocity / objective.levels.velocity).ln().abs();
        objective.levels = next;
        let settled = change < SETTLED || round + 1 == rounds;
        let steps = if settled { max_steps } else { STEPS_PER_ROUND.min(max_steps) };
        found = further(objective, found, steps)?;
        if settled {
            break;
        }
    }
    Ok(Settled { found, criterion })
}

/// The most likely levels for the problem linearised about a point, with unknowns of the measurement, and their criterion.
pub(crate) fn most_likely(
    objective: &Objective<'_>,
    parameters: &[f64],
    unknowns: &[Unknown],
    known: &KnownNoise,
) -> Result<(NoiseLevels, f64), Error> {
    let (equations, components) = objective.linearise_for_levels(parameters, unknowns)?;
    let restricted =
        Restricted { equations: &equations, components: components as f64, known: *known, held: None };
    restricted.most_likely(objective.levels)
}

/// Whether an estimate of the position noise is at its limit.
pub(crate) fn at_limit(levels: &NoiseLevels, known: &KnownNoise) -> bool {
    known.position.is_none() && levels.position >= 0.99 * LARGEST_POSITION_NOISE
}

/// Noise levels before any nudged fit: as given, or a usual position noise and the spread of the naive residual.
pub(crate) fn first_levels(
    objective: &Objective<'_>,
    naive: &[f64],
    known: &KnownNoise,
) -> Result<NoiseLevels, Error> {
    known.check()?;
    let coefficients = objective.space.coefficients(naive);
    let mut sizes: Vec<f64> = objective
        .frames
        .iter()
        .flat_map(|frame| residuals_as_measured(frame, objective.structure, coefficients.as_slice()))
        .flat_map(|(_, rest)| [rest.x.abs(), rest.y.abs()])
        .collect();
    sizes.sort_unstable_by(f64::total_cmp);
    // The median absolute deviation of a normal distribution is 0.6745 standard deviations.
    let spread = sizes[sizes.len() / 2] / 0.6745;
    Ok(NoiseLevels {
        position: known.position.unwrap_or(FIRST_POSITION_NOISE),
        velocity: known.velocity.unwrap_or((0.3 * spread).max(SMALLEST_VELOCITY_NOISE)),
    })
}
