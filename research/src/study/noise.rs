//! Noise levels from one snapshot by restricted maximum likelihood.

use super::seeds::{on_one_core_each, quartiles};
use crate::Outcome;
use claims::{Noise, Tissue};
use std::ops::ControlFlow;
use voronudge_infer::{CrossValidation, KnownNoise, Request, infer};

const CELLS: usize = 100;

/// Medians of the estimated noise levels over the true ones.
pub fn levels(seeds: u64) -> Outcome {
    println!("| σ_r % | σ_v % | σ̂_r/σ_r | σ̂_v/σ_v | identity | seconds |\n|---|---|---|---|---|---|");
    for position in [0.005, 0.01, 0.02, 0.03] {
        for velocity in [0.02, 0.05, 0.1] {
            let noise = Noise { position, velocity };
            let rows = on_one_core_each(seeds, |seed| {
                let tissue = Tissue::new(CELLS, seed)?;
                let request = Request {
                    cross_validation: CrossValidation::Skipped,
                    ..tissue.request(KnownNoise::default())
                };
                let begun = std::time::Instant::now();
                let fit =
                    infer(&[tissue.measured(noise, seed)?], &request, &mut |_| ControlFlow::Continue(()))?;
                let left = 2.0 * CELLS as f64 - fit.degrees_of_freedom - 3.0;
                Ok([
                    fit.noise.position / position,
                    fit.noise.velocity / velocity,
                    fit.contribution_ratio / (fit.degrees_of_freedom / left),
                    begun.elapsed().as_secs_f64(),
                ])
            })?;
            let column = |index: usize| {
                let [low, median, high] = quartiles(rows.iter().map(|row| row[index]).collect());
                format!("{median:.3} ({low:.2}–{high:.2})")
            };
            println!(
                "| {} | {} | {} | {} | {} | {} |",
                100.0 * position,
                100.0 * velocity,
                column(0),
                column(1),
                column(2),
                column(3)
            );
        }
    }
    Ok(())
}
