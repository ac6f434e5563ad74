//! Further starts within the noise.

use super::found::Found;
use super::optimise::{TOLERANCE, optimise};
use super::transitions;
use super::watch::Watch;
use crate::Error;
use crate::objective::Objective;
use crate::seeds::{Purpose, seed_of};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

/// How far to search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Steps of one optimisation at the final noise levels.
    pub max_steps: u64,
    /// Starts in all.
    pub starts: usize,
    pub seed: u64,
}
use std::ops::ControlFlow;

/// Displacement of a new start from the best point, in units of σ_r.
const DISPLACEMENT: f64 = 0.7;

/// Displaces the best point by a share of the position noise, descends, flips contacts, and keeps what is better.
pub(super) fn try_another(
    objective: &Objective<'_>,
    found: &mut Found,
    effort: &Effort,
    start: usize,
    watch: &mut Watch<'_>,
) -> Result<(), Error> {
    let mut rng = Pcg64::seed_from_u64(seed_of(effort.seed, Purpose::Start, start as u64));
    let normal = Normal::new(0.0, DISPLACEMENT * objective.levels.position)
        .map_err(|_| Error::Noise { name: "position", value: objective.levels.position })?;
    let mut at = found.parameters.clone();
    at[objective.space.dimension()..].iter_mut().for_each(|e| *e += normal.sample(&mut rng));
    let mut trace = Vec::new();
    let mut observer = |step: u64, value: f64| {
        trace.push(value);
        match watch.tell("further start", (step, effort.max_steps), value / objective.expected()) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    };
    let optimum = optimise(objective, at, effort.max_steps, TOLERANCE, &mut observer)?;
    let mut other = optimum.found(trace);
    transitions::flip(objective, &mut other, effort.max_steps, watch)?;
    found.steps += other.steps;
    found.transitions_tried += other.transitions_tried;
    found.starts.push(other.value);
    if other.value < found.value {
        found.parameters = other.parameters;
        found.value = other.value;
        found.status = other.status;
        found.trace = other.trace;
        found.transitions_made = other.transitions_made;
    }
    Ok(())
}
