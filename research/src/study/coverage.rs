//! How often 95 % intervals contain the truth, and how far estimates are from it in standard errors.

use super::seeds::on_one_core_each;
use crate::Outcome;
use claims::{Noise, Tissue};
use std::ops::ControlFlow;
use std::time::Instant;
use voronudge_infer::{FitParameter, KnownNoise, infer};

const CELLS: usize = 100;
const NOISE: [Noise; 4] = [
    Noise { position: 0.01, velocity: 0.05 },
    Noise { position: 0.02, velocity: 0.05 },
    Noise { position: 0.03, velocity: 0.05 },
    Noise { position: 0.02, velocity: 0.1 },
];

/// What is counted, in the order of the columns.
const QUANTITIES: [FitParameter; 5] = [
    FitParameter::ChiralCoefficient,
    FitParameter::Chirality,
    FitParameter::PerimeterElasticity,
    FitParameter::PreferredPerimeter,
    FitParameter::AreaElasticity,
];

/// One fit.
struct Row {
    /// Whether the interval contains the truth, the error in standard errors, and relative to the truth.
    of: [(bool, f64, f64); QUANTITIES.len()],
    wrong_edges: [usize; 2],
    /// Φ over its expected value.
    objective: f64,
    doubted: bool,
    seconds: f64,
}

/// A table with a row for each position noise, of K_A held and free, of noise levels given and estimated.
pub fn run(seeds: u64, cells: Option<usize>, only: &[String]) -> Outcome {
    let cells = cells.unwrap_or(CELLS);
    println!(
        "| {cells} cells | K_P α: covered, mean pull, its spread, mean error % | α | K_P | P_0 | K_A | wrong contacts | Φ/expected | doubted | s |\n\
         |---|---|---|---|---|---|---|---|---|---|"
    );
    for noise in NOISE {
        let [position, velocity] = [noise.position, noise.velocity].map(|level| 100.0 * level);
        for (area, held) in [("held", true), ("free", false)] {
            for (levels, known) in [("given", noise.known()), ("estimated", KnownNoise::default())] {
                let name = format!("σ_r {position} %, σ_v {velocity} %, K_A {area}, noise {levels}");
                if !only.is_empty() && !only.iter().any(|text| name.contains(text)) {
                    continue;
                }
                let rows = on_one_core_each(seeds, |seed| row(cells, seed, noise, known, held))?;
                println!("| {name} | {}", told(&rows));
            }
        }
    }
    Ok(())
}

fn row(
    cells: usize,
    seed: u64,
    noise: Noise,
    known: KnownNoise,
    held: bool,
) -> Result<Row, Box<dyn std::error::Error>> {
    let tissue = Tissue::new(cells, seed)?;
    let mut request = tissue.request(known);
    if !held {
        request.constraints.fixed.clear();
    }
    let frames = [tissue.measured(noise, seed)?];
    let begun = Instant::now();
    let fit = infer(&frames, &request, &mut |_| ControlFlow::Continue(()))?;
    let row = Row {
        of: QUANTITIES.map(|quantity| {
            let (estimate, truth) = (fit.parameters.get(quantity), tissue.truth(quantity));
            let error = estimate.value - truth;
            (estimate.covers(truth), error / estimate.standard_error, error / truth)
        }),
        wrong_edges: [&frames[0].tessellation, &fit.frames[0].tessellation]
            .map(|tessellation| tissue.wrong_edges(tessellation)),
        objective: fit.objective / fit.expected_objective,
        doubted: !fit.doubts.is_empty(),
        seconds: begun.elapsed().as_secs_f64(),
    };
    // A study that is stopped leaves what it has done.
    eprintln!("seed {seed}: {}", told(std::slice::from_ref(&row)));
    Ok(row)
}

/// The columns after the name.
fn told(rows: &[Row]) -> String {
    let count = rows.len() as f64;
    let mean = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / count;
    let columns: String = (0..QUANTITIES.len())
        .map(|index| {
            // What is held has no standard error.
            if rows.iter().all(|row| !row.of[index].1.is_finite()) {
                return "– | ".into();
            }
            let covered = rows.iter().filter(|row| row.of[index].0).count();
            let pull = mean(&|row| row.of[index].1);
            let spread = mean(&|row| (row.of[index].1 - pull).powi(2)).sqrt();
            let error = 100.0 * mean(&|row| row.of[index].2);
            format!("{covered} of {count}, {pull:+.2}, {spread:.2}, {error:+.2} | ")
        })
        .collect();
    format!(
        "{columns}{:.0} → {:.0} | {:.3} | {} | {:.1} |",
        mean(&|row| row.wrong_edges[0] as f64),
        mean(&|row| row.wrong_edges[1] as f64),
        mean(&|row| row.objective),
        rows.iter().filter(|row| row.doubted).count(),
        mean(&|row| row.seconds)
    )
}
