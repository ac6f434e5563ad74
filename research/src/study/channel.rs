//! The chirality that the flow in a channel implies, against the one put in.

use super::seeds::{Replicas, mean, on_one_core_each};
use crate::Outcome;
use claims::channel::{BIRTH_LAYER, Case, line};

/// (P_0/ℓ_0, α)
const CASES: [(f64, f64); 6] = [(4.0, 2.9), (4.0, 2.0), (4.0, 1.0), (3.5, 0.5), (3.0, 1.0), (3.0, 2.9)];

pub fn run(replicas: Replicas) -> Outcome {
    let seeds: Vec<u64> = replicas.seeds().collect();
    let case = |task: u64| {
        let (preferred_perimeter, chirality) = CASES[task as usize % CASES.len()];
        Case { lengths: [12.0, 20.0], preferred_perimeter, chirality, time: 150.0 }
    };
    let tasks = replicas.count * CASES.len() as u64;
    let found = on_one_core_each(tasks, |task| {
        let (case, seed) = (case(task), seeds[task as usize / CASES.len()]);
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
    println!(
        "channels of 12 × 20 cells, t = 150/K_P, {} tissues; means and standard errors\n",
        replicas.count
    );
    println!(
        "| P_0/ℓ_0 | α | largest v_x | largest v_y | α of the flow / α, all distances | beyond {BIRTH_LAYER} ℓ_0 |"
    );
    println!("|---|---|---|---|---|---|");
    for (index, (perimeter, chirality)) in CASES.iter().enumerate() {
        let own: Vec<&[f64; 4]> = found.iter().skip(index).step_by(CASES.len()).collect();
        let column = |column: usize| mean(&own.iter().map(|row| row[column]).collect::<Vec<_>>());
        let [v_x, v_y, all, beyond] = [0, 1, 2, 3].map(column);
        println!(
            "| {perimeter} | {chirality} | {:.2} | {:.2} | {:.2} ± {:.2} | {:.2} ± {:.2} |",
            v_x.0, v_y.0, all.0, all.1, beyond.0, beyond.1
        );
    }
    Ok(())
}
