//! Solid and liquid: mean square velocities at two system sizes, and Lyapunov exponents across the transition.

use super::flows::{parameters, random};
use super::seeds::on_one_core_each;
use crate::Outcome;
use std::ops::ControlFlow;
use voronudge_simulate::measure::{LyapunovSchedule, largest_lyapunov_exponent};
use voronudge_simulate::{Schedule, recommended_time_step, run as simulate};

/// Points (P_0, α) with the value of an independent implementation at Δt = 0.02 and its error; zero stands for a solid.
const POINTS: [(f64, f64, f64, f64); 6] = [
    (4.0, 0.2, 0.95, 0.05),
    (4.0, 1.0, 7.5, 0.2),
    (4.0, 2.9, 31.0, 0.7),
    (3.75, 0.2, 0.038, 0.002),
    (3.5, 0.2, 0.0, 0.0),
    (3.0, 1.0, 0.0, 0.0),
];
const SIZES: [usize; 2] = [100, 400];
const DURATION: f64 = 300.0;
/// The time step of the independent values.
const THEIR_STEP: f64 = 0.02;

/// ⟨v²⟩ with its error, and T1 transitions per cell and time, over the second half of a run.
pub fn velocities() -> Outcome {
    println!("| cells | P_0 | α | Δt | ⟨v²⟩ | T1 rate | independent (Δt 0.02, 100 cells) |");
    println!("|---|---|---|---|---|---|---|");
    let cases: Vec<_> = SIZES
        .into_iter()
        .flat_map(|cells| POINTS.map(|point| (cells, point)))
        .flat_map(|(cells, point)| {
            let converged = recommended_time_step(&parameters(point.0, point.1), 1.0);
            [THEIR_STEP, converged].map(|step| (cells, point, step))
        })
        .collect();
    let rows = on_one_core_each(cases.len() as u64, |k| {
        let (cells, (perimeter, chirality, value, error), time_step) = cases[k as usize];
        let mut simulation = random(cells, &parameters(perimeter, chirality), 1)?;
        let schedule = Schedule { time: DURATION, time_step, frames: 1 };
        let summary = simulate(&mut simulation, &schedule, |_| ControlFlow::Continue(()))?;
        let theirs = if value > 0.0 { format!("{value} ± {error}") } else { "solid".into() };
        Ok(format!(
            "| {cells} | {perimeter} | {chirality} | {time_step:.4} | {:.3e} ± {:.1e} | {:.3} | {theirs} |",
            summary.mean_square_velocity.unwrap_or(f64::NAN),
            summary.mean_square_velocity_error.unwrap_or(f64::NAN),
            summary.transition_rate.unwrap_or(f64::NAN),
        ))
    })?;
    rows.iter().for_each(|row| println!("{row}"));
    Ok(())
}

/// The largest Lyapunov exponent against P_0 at α = 0.2, and in the liquid at α = 0.
pub fn lyapunov(seeds: u64) -> Outcome {
    println!("| P_0 | α | λ, seed by seed |");
    println!("|---|---|---|");
    let chiral = [3.3, 3.4, 3.5, 3.55, 3.6, 3.65, 3.7, 3.75, 3.8, 3.9, 4.0].map(|p| (p, 0.2));
    for (perimeter, chirality) in chiral.into_iter().chain([(3.95, 0.0), (4.1, 0.0)]) {
        let exponents = on_one_core_each(seeds, |seed| {
            let mut simulation = random(100, &parameters(perimeter, chirality), seed)?;
            for _ in 0..30_000 {
                simulation.step(0.01)?;
            }
            let schedule =
                LyapunovSchedule { time_step: 0.01, transient: 5000, steps: 20_000, renormalisation: 10 };
            let domain = simulation.tessellation().domain();
            let observe = |_| ControlFlow::Continue(());
            let exponent = largest_lyapunov_exponent(
                simulation.positions(),
                domain,
                simulation.model(),
                &schedule,
                seed,
                observe,
            )?;
            Ok(format!("{:+.4} ± {:.4}", exponent.value, exponent.standard_error.unwrap_or(f64::NAN)))
        })?;
        println!("| {perimeter} | {chirality} | {} |", exponents.join(", "));
    }
    Ok(())
}
