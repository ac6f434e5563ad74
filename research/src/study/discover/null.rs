//! Data that lack nothing: how often an effect is found all the same.

use super::added::{Sample, once, surroundings};
use super::table::{count, head, percent, row, seconds, verdict};
use super::{Found, Plan};
use crate::Outcome;
use claims::{Noise, Tissue};
use std::error::Error;
use std::sync::Arc;
use voronudge_infer::discover::Verdict;

const POSITION_NOISE: [f64; 4] = [0.0, 0.01, 0.02, 0.03];
const VELOCITY_NOISE: [f64; 3] = [0.05, 0.1, 0.2];
const FRAMES: [usize; 2] = [1, 5];

/// Time between frames: cells go about half of their size.
const INTERVAL: f64 = 1.0;

pub fn run(plan: &Plan) -> Outcome {
    println!("### Data that lack nothing ({})\n", plan.describe());
    head(&[
        "frames",
        "σ_r %",
        "σ_v %",
        "an effect is found",
        "attributed",
        "structure",
        "white",
        "not testable",
        "s",
    ]);
    for frames in FRAMES {
        for position in POSITION_NOISE {
            for velocity in VELOCITY_NOISE {
                let noise = Noise { position, velocity };
                let name = format!(
                    "null, frames {frames}, σ_r {} %, σ_v {} %",
                    percent(position),
                    percent(velocity)
                );
                if !plan.includes(&name) {
                    continue;
                }
                let sample = |seed, drawn| sample(plan, [seed, drawn], frames, noise);
                let failed = |found: &Found| !found.verdict_is(Verdict::NothingMissing);
                let found = plan.search(&name, noise, sample, failed)?;
                row(&[
                    frames.to_string(),
                    percent(position),
                    percent(velocity),
                    count(&found, Found::selected),
                    verdict(&found, Verdict::Attributed),
                    verdict(&found, Verdict::UnexplainedStructured),
                    verdict(&found, Verdict::UnexplainedWhite),
                    verdict(&found, Verdict::NotTestable),
                    seconds(&found),
                ]);
            }
        }
    }
    println!();
    Ok(())
}

/// One frame, or several of one trajectory, each with the velocities that were measured a frame before.
fn sample(
    plan: &Plan,
    [seed, drawn]: [u64; 2],
    frames: usize,
    noise: Noise,
) -> Result<Sample, Box<dyn Error>> {
    if frames == 1 {
        return once(&plan.tissue(seed)?, noise, drawn);
    }
    let tissues = Tissue::trajectory(plan.cells, seed, frames + 1, INTERVAL)?;
    let mut measured = Vec::with_capacity(tissues.len());
    for (time, tissue) in tissues.iter().enumerate() {
        measured.push(tissue.measured(noise, drawn + 100_000 * time as u64)?);
    }
    let earlier: Vec<_> = measured.iter().map(|frame| frame.velocities.values().to_vec()).collect();
    let mut observations = Vec::with_capacity(frames);
    for ((frame, tissue), earlier) in measured.into_iter().zip(&tissues).skip(1).zip(earlier) {
        observations.push(frame.within(Arc::new(surroundings(tissue).with_earlier(earlier)?)));
    }
    let identities = vec![(0..plan.cells as i64).collect(); frames];
    Ok(Sample { frames: observations, identities: Some(identities), added: Vec::new() })
}
