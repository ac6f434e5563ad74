//! The chirality that the flow in a channel implies, against the one put in.

use super::seeds::on_one_core_each;
use crate::Outcome;
use claims::channel::{BIRTH_LAYER, Case, line};

/// (P_0/ℓ_0, α)
const CASES: [(f64, f64); 6] = [(4.0, 2.9), (4.0, 2.0), (4.0, 1.0), (3.5, 0.5), (3.0, 1.0), (3.0, 2.9)];

pub fn run(seeds: u64) -> Outcome {
    let case = |task: u64| {
        let (preferred_perimeter, chirality) = CASES[task as usize % CASES.len()];
        Case { lengths: [12.0, 20.0], preferred_perimeter, chirality, time: 150.0 }
    };
    let tasks = seeds * CASES.len() as u64;
    let found = on_one_core_each(tasks, |task| {
        let (case, seed) = (case(task), task / CASES.len() as u64);
        let profile = case.folded_profile(seed)?;
        let peak = |axis: usize| profile.velocity[axis].iter().map(|at| at.value.abs()).fold(0.0, f64::max);
        let [all, beyond] = [0.0, BIRTH_LAYER].map(|from| line(&profile, from));
        Ok([
            peak(0),
            peak(1),
            case.chirality_of_flow(all?.slope)? / case.chirality,
            case.chirality_of_flow(beyond?.slope)? / case.chirality,
        ])
    })?;
    println!("channels of 12 × 20 cells, t = 150/K_P, {seeds} seeds\n");
    println!(
        "| P_0/ℓ_0 | α | largest v_x | largest v_y | α of the flow / α, all distances | beyond {BIRTH_LAYER} ℓ_0 |"
    );
    println!("|---|---|---|---|---|---|");
    for (index, (perimeter, chirality)) in CASES.iter().enumerate() {
        let own: Vec<&[f64; 4]> = found.iter().skip(index).step_by(CASES.len()).collect();
        let mean = |column: usize| own.iter().map(|row| row[column]).sum::<f64>() / own.len() as f64;
        let spread = |column: usize| {
            let squares: f64 = own.iter().map(|row| (row[column] - mean(column)).powi(2)).sum();
            (squares / (own.len().max(2) - 1) as f64).sqrt()
        };
        println!(
            "| {perimeter} | {chirality} | {:.2} | {:.2} | {:.2} ± {:.2} | {:.2} ± {:.2} |",
            mean(0),
            mean(1),
            mean(2),
            spread(2),
            mean(3),
            spread(3)
        );
    }
    Ok(())
}
