//! T1 proposals: flips of contacts that could as well be others.
//!
//! Within one topology the objective is about quadratic, with H = JᵀJ + kI. The cheapest way to shrink a side of length
//! ℓ and gradient g to −m, just beyond the flip, is
//!
//! ```text
//! δ = −H⁻¹ g (ℓ + m) / (gᵀH⁻¹g)       at a cost of  (ℓ + m)² / (gᵀH⁻¹g)
//! ```
//!
//! Sides are tried in the order of that cost. Each trial starts beyond its flip and descends; it counts if the objective
//! around the four cells is less afterwards. Sides far from each other are tried together.

use super::{Found, Watch, optimise};
use crate::Error;
use crate::objective::Objective;
use rayon::prelude::*;
use std::collections::HashSet;
use std::ops::ControlFlow;
use voronudge_geometry::{Side, Tessellation};

/// Largest cost of a flip that is tried, in units of σ_v²: a change of −2 log likelihood.
const LARGEST_COST: f64 = 30.0;

/// Length beyond the flip at which a trial starts, in units of ℓ₀.
const MARGIN: f64 = 0.02;

/// Steps of a trial.
const TRIAL_STEPS: u64 = 8;

/// Rings of cells around a flip in which a trial is judged.
const ZONE: usize = 2;

/// Batches of flips tried at once, whatever the number of threads.
const BATCHES: usize = 8;

/// Batches tried at most: a tissue that the model does not describe has flips without end.
const MOST_GROUPS: usize = 60;

/// Least gain that counts, in units of σ_v².
const GAIN: f64 = 0.02;

/// Right-hand sides solved at once.
const SOLVED_AT_ONCE: usize = 64;

/// A side that could flip.
struct Candidate {
    key: (usize, [usize; 4]),
    cost: f64,
    /// Displacement of all cells of its frame.
    displacement: Vec<f64>,
    /// Cells around it.
    zone: Vec<usize>,
}

/// Flips contacts as long as that makes the objective less.
pub(super) fn flip(
    objective: &Objective<'_>,
    found: &mut Found,
    max_steps: u64,
    watch: &mut Watch<'_>,
) -> Result<(), Error> {
    let unit = objective.levels.velocity.powi(2);
    let mut failed: HashSet<(usize, [usize; 4])> = HashSet::new();
    for group in 0..MOST_GROUPS {
        watch.tell("contacts", (group as u64, MOST_GROUPS as u64), found.value / objective.expected())?;
        let mut waiting = candidates(objective, &found.parameters)?;
        waiting.retain(|candidate| !failed.contains(&candidate.key));
        if waiting.is_empty() {
            break;
        }
        let batches: Vec<Vec<Candidate>> =
            (0..BATCHES).map(|_| apart(&mut waiting)).filter(|batch| !batch.is_empty()).collect();
        let before = shares(objective, &found.parameters);
        let trials = batches
            .par_iter()
            .map(|batch| trial(objective, &found.parameters, &before, batch))
            .collect::<Result<Vec<_>, _>>()?;
        found.transitions_tried += batches.iter().map(Vec::len).sum::<usize>();
        let mut winners: Vec<(f64, &Candidate, &[f64])> = Vec::new();
        for (batch, (parameters, gains)) in batches.iter().zip(&trials) {
            let better = batch.iter().zip(gains).filter(|(_, gain)| **gain > GAIN * unit);
            winners.extend(better.map(|(candidate, gain)| (*gain, candidate, parameters.as_slice())));
        }
        winners.sort_by(|a, b| b.0.total_cmp(&a.0));
        let made = adopt(objective, found, &winners, max_steps)?;
        found.trace.push(found.value);
        let touched: HashSet<(usize, usize)> = made
            .iter()
            .flat_map(|candidate| candidate.zone.iter().map(|cell| (candidate.key.0, *cell)))
            .collect();
        failed.extend(batches.iter().flatten().map(|candidate| candidate.key));
        failed.retain(|(frame, cells)| !cells.iter().any(|cell| touched.contains(&(*frame, *cell))));
    }
    let mut silent = |_, _| ControlFlow::Continue(());
    let polished = optimise(objective, found.parameters.clone(), max_steps, &mut silent)?;
    found.steps += polished.steps;
    if polished.value <= found.value {
        found.parameters = polished.parameters;
        found.value = polished.value;
        found.status = polished.status;
        found.trace.push(found.value);
    }
    Ok(())
}

/// Takes the nudges around the winners from their trials, as far as that is an improvement in all. Returns what was made.
fn adopt<'c>(
    objective: &Objective<'_>,
    found: &mut Found,
    winners: &[(f64, &'c Candidate, &[f64])],
    max_steps: u64,
) -> Result<Vec<&'c Candidate>, Error> {
    let offsets = offsets(objective);
    // All winners that are apart; if they do not go together, the best one alone with all that its trial changed.
    let mut together = found.parameters.clone();
    let mut made: Vec<&Candidate> = Vec::new();
    let mut taken: HashSet<(usize, usize)> = HashSet::new();
    for (_, candidate, parameters) in winners {
        let frame = candidate.key.0;
        if candidate.zone.iter().all(|cell| !taken.contains(&(frame, *cell))) {
            for cell in &candidate.zone {
                taken.insert((frame, *cell));
                let at = offsets[frame] + 2 * cell;
                together[at..at + 2].copy_from_slice(&parameters[at..at + 2]);
            }
            made.push(candidate);
        }
    }
    let Some(best) = winners.first() else {
        return Ok(Vec::new());
    };
    for (start, made) in [(together, made), (best.2.to_vec(), vec![best.1])] {
        let mut silent = |_, _| ControlFlow::Continue(());
        let optimum = optimise(objective, start, TRIAL_STEPS.min(max_steps), &mut silent)?;
        found.steps += optimum.steps;
        if optimum.value < found.value {
            found.parameters = optimum.parameters;
            found.value = optimum.value;
            found.status = optimum.status;
            found.transitions_made += made.len();
            return Ok(made);
        }
    }
    Ok(Vec::new())
}

/// Descends from beyond the flips of a batch; the gain of each within its zone.
fn trial(
    objective: &Objective<'_>,
    from: &[f64],
    before: &[Vec<f64>],
    batch: &[Candidate],
) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let offsets = offsets(objective);
    let mut start = from.to_vec();
    for candidate in batch {
        let own = &mut start[offsets[candidate.key.0]..];
        own.iter_mut().zip(&candidate.displacement).for_each(|(e, d)| *e += d);
    }
    let mut silent = |_, _| ControlFlow::Continue(());
    let parameters = optimise(objective, start, TRIAL_STEPS, &mut silent)?.parameters;
    let after = shares(objective, &parameters);
    let gains = batch
        .iter()
        .map(|candidate| {
            let frame = candidate.key.0;
            candidate.zone.iter().map(|&cell| before[frame][cell] - after[frame][cell]).sum()
        })
        .collect();
    Ok((parameters, gains))
}

/// Each cell's share of Φ, by frame.
fn shares(objective: &Objective<'_>, parameters: &[f64]) -> Vec<Vec<f64>> {
    let (free, nudges) = objective.split(parameters);
    let coefficients = objective.space.coefficients(free);
    let share = |(frame, nudges): (&crate::Observation, &&[f64])| {
        let mut shares: Vec<f64> =
            nudges.chunks_exact(2).map(|e| objective.spring() * (e[0] * e[0] + e[1] * e[1])).collect();
        match objective.nudge(frame, nudges) {
            Ok(nudged) => {
                for (datum, rest) in objective.residuals(frame, &nudged, &coefficients) {
                    shares[frame.owner(datum)] += rest.norm_squared();
                }
            }
            Err(_) => shares.fill(f64::INFINITY),
        }
        shares
    };
    objective.frames.iter().zip(&nudges).map(share).collect()
}

/// Where the nudges of each frame begin.
fn offsets(objective: &Objective<'_>) -> Vec<usize> {
    let mut next = objective.space.dimension();
    let begin = |frame: &crate::Observation| {
        let own = next;
        next += 2 * frame.positions.len();
        own
    };
    objective.frames.iter().map(begin).collect()
}

/// Takes candidates whose zones do not meet, cheapest first.
fn apart(waiting: &mut Vec<Candidate>) -> Vec<Candidate> {
    let mut taken: HashSet<(usize, usize)> = HashSet::new();
    let (mut batch, mut rest) = (Vec::new(), Vec::new());
    for candidate in waiting.drain(..) {
        let frame = candidate.key.0;
        if candidate.zone.iter().any(|cell| taken.contains(&(frame, *cell))) {
            rest.push(candidate);
        } else {
            taken.extend(candidate.zone.iter().map(|cell| (frame, *cell)));
            batch.push(candidate);
        }
    }
    *waiting = rest;
    batch
}

/// All sides whose flip is cheap enough, cheapest first.
fn candidates(objective: &Objective<'_>, at: &[f64]) -> Result<Vec<Candidate>, Error> {
    let equations = objective.linearise(at)?;
    let (_, nudges) = objective.split(at);
    let limit = LARGEST_COST * objective.levels.velocity.powi(2);
    let spring = objective.spring();
    let mut all = Vec::new();
    for (index, (frame, nudges)) in objective.frames.iter().zip(&nudges).enumerate() {
        let nudged =
            objective.nudge(frame, nudges).map_err(|source| Error::Geometry { frame: index, source })?;
        let factor = equations.frames[index].factor(spring)?;
        // gᵀH⁻¹g ≤ g²/k bounds the cost from below.
        let sides: Vec<Side> = sides(&nudged.tessellation, &nudged.positions)
            .filter(|side| {
                let steepness: f64 = side.gradient.iter().map(|g| g.norm_squared()).sum();
                (side.length + MARGIN).powi(2) * spring <= limit * steepness
            })
            .collect();
        let n = nudges.len();
        let found: Vec<Vec<Candidate>> = sides
            .par_chunks(SOLVED_AT_ONCE)
            .map(|sides| {
                let mut solved = vec![0.0; n * sides.len()];
                for (column, side) in solved.chunks_exact_mut(n).zip(sides) {
                    for (cell, g) in side.cells.iter().zip(side.gradient) {
                        column[2 * cell] += g.x;
                        column[2 * cell + 1] += g.y;
                    }
                }
                factor.solve(&mut solved);
                let candidate = |(side, column): (&Side, &[f64])| {
                    let yields: f64 = (side.cells.iter().zip(side.gradient))
                        .map(|(cell, g)| g.x * column[2 * cell] + g.y * column[2 * cell + 1])
                        .sum();
                    let target = side.length + MARGIN;
                    let cost = target * target / yields;
                    (cost <= limit).then(|| Candidate {
                        key: (index, side.cells),
                        cost,
                        displacement: column.iter().map(|s| -s * target / yields).collect(),
                        zone: zone(&nudged.tessellation, &side.cells),
                    })
                };
                sides.iter().zip(solved.chunks_exact(n)).filter_map(candidate).collect()
            })
            .collect();
        all.extend(found.into_iter().flatten());
    }
    all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Ok(all)
}

/// Each side once.
fn sides(
    tessellation: &Tessellation,
    positions: &[voronudge_geometry::Vector<f64>],
) -> impl Iterator<Item = Side> {
    (0..tessellation.len())
        .flat_map(|cell| tessellation.ring(cell).map(move |h| (cell, h)))
        .filter(|(_, h)| *h < tessellation.twin(*h))
        .filter_map(|(cell, h)| Side::new(tessellation, positions, cell, h))
}

/// The cells within some rings of given ones, ascending.
fn zone(tessellation: &Tessellation, cells: &[usize]) -> Vec<usize> {
    let mut zone: Vec<usize> = cells.to_vec();
    zone.sort_unstable();
    zone.dedup();
    for _ in 0..ZONE {
        let further: Vec<usize> =
            zone.iter().flat_map(|cell| tessellation.neighbours(*cell)).map(|cell| *cell as usize).collect();
        zone.extend(further);
        zone.sort_unstable();
        zone.dedup();
    }
    zone
}
