//! T1 proposals: flips of contacts that could as well be others.
//!
//! Within one topology the objective is about quadratic, with H = JᵀJ + kI. The cheapest way to shrink a side of length
//! ℓ and gradient g to −m, just beyond the flip, is
//!
//! ```text
//! δ = −H⁻¹ g (ℓ + m) / (gᵀH⁻¹g)       at a cost of  (ℓ + m)² / (gᵀH⁻¹g)
//! ```
//!
//! Each side whose flip is cheap is tried in a patch of its own, the coefficients held: the trial starts beyond the flip
//! and descends. Those flips that make the objective less and do not touch each other are made together, and the whole
//! descends again.

use super::found::Found;
use super::optimise::{TOLERANCE, optimise, refine};
use super::patch::{Patch, Whole};
use super::watch::Watch;
use crate::objective::Objective;
use crate::residuals::residuals;
use crate::{CoefficientSpace, Error, Observation};
use rayon::prelude::*;
use std::collections::HashSet;
use std::ops::ControlFlow;
use voronudge_geometry::Side;

/// Largest cost of a flip that is tried, in units of σ_v²: a change of −2 log likelihood.
const LARGEST_COST: f64 = 30.0;

/// Length beyond the flip at which a trial starts, in units of ℓ₀.
const MARGIN: f64 = 0.02;

/// Steps of a trial.
const TRIAL_STEPS: u64 = 10;

/// A trial is given up after so many steps if the last one gained less than this share of what it still lacks.
const FIRST_STEPS: u64 = 3;
const HOPE: f64 = 0.15;

/// Least gain that counts, in units of σ_v².
const GAIN: f64 = 0.02;

/// Rounds of trials at most.
const MOST_ROUNDS: u64 = 12;

/// Mean gain of a trial, in units of σ_v², below which the search ends: so little says nothing about contacts, and a
/// tissue that the model does not describe has thousands of such flips.
const WORTHWHILE: f64 = 0.02;

/// Trials at once, cheapest first, whatever the number of threads: at least so many, and a share of all. Where those are not worthwhile
/// together, dearer ones are not tried; of more parts, one that is not would come sooner by chance.
const AT_ONCE: usize = 256;
const MOST_PARTS: usize = 16;

/// A side, by the frame and its four cells.
type Key = (usize, [usize; 4]);

/// A flip that was tried.
struct Trial {
    key: Key,
    /// Decrease of the objective.
    gain: f64,
    /// Cells that were free, with their new nudges.
    moved: Vec<(usize, [f64; 2])>,
}

/// Flips contacts as long as that makes the objective less.
pub(super) fn flip(
    objective: &Objective<'_>,
    found: &mut Found,
    max_steps: u64,
    watch: &mut Watch<'_>,
) -> Result<(), Error> {
    let mut failed: HashSet<Key> = HashSet::new();
    for _ in 0..MOST_ROUNDS {
        let trials = trials(objective, found, &failed, watch)?;
        if trials.is_empty() {
            break;
        }
        let worthwhile = WORTHWHILE * trials.len() as f64 * objective.levels.velocity.powi(2);
        found.transitions_tried += trials.len();
        failed.extend(trials.iter().map(|trial| trial.key));
        let before = found.value;
        let changed = adopt(objective, found, trials, max_steps)?;
        found.trace.push(found.value);
        failed.retain(|(frame, cells)| !cells.iter().any(|cell| changed.contains(&(*frame, *cell))));
        if before - found.value < worthwhile {
            break;
        }
    }
    Ok(())
}

/// Makes the flips that gain and do not touch each other. Returns the cells that moved.
fn adopt(
    objective: &Objective<'_>,
    found: &mut Found,
    mut trials: Vec<Trial>,
    max_steps: u64,
) -> Result<HashSet<(usize, usize)>, Error> {
    let least = GAIN * objective.levels.velocity.powi(2);
    trials.retain(|trial| trial.gain > least);
    trials.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut taken: HashSet<(usize, usize)> = HashSet::new();
    trials.retain(|trial| {
        let cells: Vec<_> = trial.moved.iter().map(|(cell, _)| (trial.key.0, *cell)).collect();
        let apart = !cells.iter().any(|cell| taken.contains(cell));
        if apart {
            taken.extend(cells);
        }
        apart
    });
    let offsets = offsets(objective);
    // If they do not go together, half of them may, and at last the best alone.
    while !trials.is_empty() {
        let mut start = found.parameters.clone();
        for trial in &trials {
            for (cell, nudge) in &trial.moved {
                let at = offsets[trial.key.0] + 2 * cell;
                start[at..at + 2].copy_from_slice(nudge);
            }
        }
        let optimum = refine(objective, start, max_steps)?;
        found.steps += optimum.steps;
        if optimum.value < found.value {
            found.parameters = optimum.parameters;
            found.value = optimum.value;
            found.status = optimum.status;
            found.transitions_made += trials.len();
            let moved =
                |trial: &Trial| trial.moved.iter().map(|(cell, _)| (trial.key.0, *cell)).collect::<Vec<_>>();
            return Ok(trials.iter().flat_map(moved).collect());
        }
        trials.truncate(trials.len() / 2);
    }
    Ok(HashSet::new())
}

/// Where the nudges of each frame begin.
fn offsets(objective: &Objective<'_>) -> Vec<usize> {
    let mut next = objective.space.dimension();
    let begin = |frame: &Observation| {
        let own = next;
        next += 2 * frame.positions.len();
        own
    };
    objective.frames.iter().map(begin).collect()
}

/// Tries every side whose flip is cheap and has not failed before.
fn trials(
    objective: &Objective<'_>,
    found: &Found,
    failed: &HashSet<Key>,
    watch: &mut Watch<'_>,
) -> Result<Vec<Trial>, Error> {
    let (free, nudges) = objective.split(&found.parameters);
    let coefficients = objective.space.coefficients(free);
    let pinned = CoefficientSpace::pinned(coefficients.as_slice());
    let mut all = Vec::new();
    for (index, (frame, nudges)) in objective.frames.iter().zip(&nudges).enumerate() {
        let nudged = objective.displaced(index, nudges)?;
        let predicted = nudged.evaluate(coefficients.as_slice()).predicted;
        let mut targets = vec![None; predicted.len()];
        for (datum, rest) in residuals(frame, &predicted) {
            targets[datum] = Some(predicted[datum] + rest);
        }
        let whole = Whole { frame, nudges, nudged: &nudged, targets: &targets };
        let tessellation = &nudged.tessellation;
        let mut sides: Vec<Side> = (0..tessellation.len())
            .flat_map(|cell| tessellation.ring(cell).map(move |h| (cell, h)))
            .filter(|(_, h)| *h < tessellation.twin(*h))
            .filter_map(|(cell, h)| Side::new(tessellation, &nudged.positions, cell, h))
            .filter(|side| may_be_cheap(objective, side) && !failed.contains(&(index, side.cells)))
            .collect();
        sides.sort_by(|a, b| least_cost(a).total_cmp(&least_cost(b)));
        let at_once = sides.len().div_ceil(MOST_PARTS).max(AT_ONCE);
        for (done, chunk) in sides.chunks(at_once).enumerate() {
            let progress = ((done * at_once) as u64, sides.len() as u64);
            watch.tell("contacts", progress, found.value / objective.expected())?;
            let tried = chunk
                .par_iter()
                .map(|side| trial(objective, &pinned, &whole, index, side))
                .collect::<Result<Vec<_>, _>>()?;
            let tried: Vec<Trial> = tried.into_iter().flatten().collect();
            let gain: f64 = tried.iter().map(|trial| trial.gain.max(0.0)).sum();
            let worthwhile = WORTHWHILE * tried.len() as f64 * objective.levels.velocity.powi(2);
            all.extend(tried);
            if gain < worthwhile {
                break;
            }
        }
    }
    Ok(all)
}

/// `gᵀH⁻¹g ≤ g²/k` bounds the cost of a flip from below; here in units of k.
fn least_cost(side: &Side) -> f64 {
    let steepness: f64 = side.gradient.iter().map(|g| g.norm_squared()).sum();
    (side.length + MARGIN).powi(2) / steepness
}

/// Whether a flip can cost little.
fn may_be_cheap(objective: &Objective<'_>, side: &Side) -> bool {
    least_cost(side) * objective.spring() <= LARGEST_COST * objective.levels.velocity.powi(2)
}

/// Descends from beyond the flip of a side; `None` if the flip costs too much.
fn trial(
    objective: &Objective<'_>,
    pinned: &CoefficientSpace,
    whole: &Whole<'_>,
    frame: usize,
    side: &Side,
) -> Result<Option<Trial>, Error> {
    let patch = Patch::new(whole, &side.cells)?;
    let local = patch.objective(objective.structure, pinned, objective.levels);
    let present = patch.start();
    let factor = local.linearise(&present)?.frames[0].factor(objective.spring())?;
    let mut gradient = vec![0.0; present.len()];
    for (cell, g) in side.cells.iter().zip(side.gradient) {
        if let Some(own) = patch.column_index(*cell) {
            gradient[2 * own] += g.x;
            gradient[2 * own + 1] += g.y;
        }
    }
    let mut solved = gradient.clone();
    factor.solve(&mut solved);
    let yields: f64 = gradient.iter().zip(&solved).map(|(g, s)| g * s).sum();
    let target = side.length + MARGIN;
    let unit = objective.levels.velocity.powi(2);
    if target * target > LARGEST_COST * unit * yields {
        return Ok(None);
    }
    let before = local.value(&present);
    let start = present.iter().zip(&solved).map(|(e, s)| e - s * target / yields).collect();
    let mut previous = f64::INFINITY;
    let mut observer = |step: u64, value: f64| {
        let hopeless = step >= FIRST_STEPS && previous - value < HOPE * (value - before);
        previous = value;
        if hopeless { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let key = (frame, side.cells);
    let optimum = match optimise(&local, start, TRIAL_STEPS, TOLERANCE, &mut observer) {
        Err(Error::Interrupted) => return Ok(Some(Trial { key, gain: 0.0, moved: Vec::new() })),
        other => other?,
    };
    let nudge = |own: usize| [optimum.parameters[2 * own], optimum.parameters[2 * own + 1]];
    Ok(Some(Trial {
        key,
        gain: before - optimum.value,
        moved: patch.free().enumerate().map(|(own, cell)| (cell, nudge(own))).collect(),
    }))
}
