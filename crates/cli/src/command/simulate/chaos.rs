//! The largest Lyapunov exponent after a run, on request.

use super::report::{Exponent, Request};
use crate::failure::Failure;
use crate::progress::Progress;
use std::ops::ControlFlow;
use voronudge_simulate::measure::{LyapunovSchedule, largest_lyapunov_exponent};
use voronudge_simulate::{Driving, Simulation};

/// Whether λ is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Measure {
    Chaos,
    NoChaos,
}

/// What `--lyapunov` asks for, which is of the model alone.
pub(super) fn asked(flag: bool, request: &Request) -> Result<Measure, Failure> {
    let alone = Driving { seed: request.driving.seed, ..Driving::default() };
    let driven = request.driving != alone || request.walls.is_some();
    match (flag, driven) {
        (false, _) => Ok(Measure::NoChaos),
        (true, false) => Ok(Measure::Chaos),
        (true, true) => Err(Failure::new(
            "--lyapunov is of the model alone, without self-propulsion, noise, shear and walls",
        )
        .with_hint("leave --lyapunov out, or what drives or bounds the cells")),
    }
}

/// λ over a further run as long as the first, at the same time step.
pub(super) fn exponent(
    simulation: &Simulation,
    request: &Request,
    progress: &mut Progress,
) -> Result<Exponent, Failure> {
    let schedule = LyapunovSchedule::over(request.time, request.dt);
    let total = (schedule.transient + schedule.steps) as u64;
    let domain = simulation.tessellation().domain();
    let (positions, model) = (simulation.positions(), simulation.model());
    let mut stopped = false;
    let exponent =
        largest_lyapunov_exponent(positions, domain, model, &schedule, request.driving.seed, |step| {
            stopped = progress.step("Lyapunov exponent", step as u64, total).is_break();
            if stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
    if stopped {
        progress.finish();
        return Err(Failure::interrupted_at(
            "interrupted while the Lyapunov exponent was measured; the run is kept",
        )
        .with_hint("the same command with --resume measures it again"));
    }
    Ok(exponent?.into())
}
