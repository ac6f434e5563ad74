//! From loose to tight data, the springs held: a stiff start keeps the nudges from falling into wrong neighbourhoods.

use super::found::Found;
use super::optimise::{TOLERANCE, optimise};
use super::watch::Watch;
use crate::objective::Objective;
use crate::{Error, NoiseLevels};
use std::ops::ControlFlow;

/// Factors on σ_v of one stage after another.
const STAGES: [f64; 5] = [10.0, 5.0, 2.5, 1.5, 1.0];

/// Steps at each stage but the last.
const STEPS_PER_STAGE: u64 = 6;

/// A fit by continuation, from zero nudges and the given β.
pub(crate) fn follow(
    objective: &Objective<'_>,
    free: &[f64],
    max_steps: u64,
    stage: &str,
    watch: &mut Watch<'_>,
) -> Result<Found, Error> {
    let mut at = free.to_vec();
    at.resize(free.len() + objective.nudge_count(), 0.0);
    let all_steps = STEPS_PER_STAGE * (STAGES.len() as u64 - 1) + max_steps;
    let (mut steps, mut trace) = (0, Vec::new());
    let mut found = None;
    for (index, factor) in STAGES.into_iter().enumerate() {
        let last = index + 1 == STAGES.len();
        let velocity = objective.levels.velocity * factor;
        let loose = Objective { levels: NoiseLevels { velocity, ..objective.levels }, ..*objective };
        let mut observer = |step: u64, value: f64| {
            trace.push(value);
            match watch.tell(stage, (steps + step, all_steps), value / objective.expected()) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        };
        let optimum = optimise(
            &loose,
            std::mem::take(&mut at),
            if last { max_steps } else { STEPS_PER_STAGE },
            TOLERANCE,
            &mut observer,
        )?;
        steps += optimum.steps;
        if last {
            found = Some(optimum);
        } else {
            at = optimum.parameters;
        }
    }
    let optimum = found.ok_or_else(|| Error::Optimiser("no stage".into()))?;
    Ok(Found { steps, ..optimum.found(trace) })
}
