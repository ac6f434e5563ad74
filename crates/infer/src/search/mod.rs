//! The search for the least penalised objective.
//!
//! The objective has a kink, often a jump, wherever neighbours change, and so many minima. One fit is led from loose to
//! tight data; contacts that could as well be others are then flipped one after another; further starts within the
//! noise do the same. The best is kept.

mod continuation;
mod descent;
mod found;
mod optimise;
mod patch;
mod starts;
mod transitions;
mod watch;

pub(crate) use continuation::follow;
pub(crate) use descent::descend;
pub(crate) use found::Found;
pub(crate) use optimise::{Optimum, optimise, optimise_knowing, refine};
pub(crate) use starts::Effort;
pub(crate) use watch::{AT_ONCE, Watch};

use crate::Error;
use crate::objective::Objective;

/// Goes on from a point: transitions, and further starts.
pub(crate) fn improve(
    objective: &Objective<'_>,
    found: &mut Found,
    effort: &Effort,
    watch: &mut Watch<'_>,
) -> Result<(), Error> {
    transitions::flip(objective, found, effort.max_steps, watch)?;
    found.starts = vec![found.value];
    for start in 1..effort.starts {
        starts::try_another(objective, found, effort, start, watch)?;
    }
    Ok(())
}
