//! Naive least squares, first-order descent as the paper describes it, and the search, on the same snapshots.

mod figures;
mod table;

use super::seeds::on_one_core_each;
use crate::Outcome;
use claims::{Noise, Tissue};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;
use voronudge_infer::{
    CrossValidation, FitParameter, Inference, KnownNoise, Loss, Method, Observation, Progress, Request, infer,
};

const POSITION_NOISE: [f64; 5] = [0.0, 0.01, 0.02, 0.05, 0.1];
const VELOCITY_NOISE: [f64; 2] = [0.02, 0.1];
const CELLS: [usize; 2] = [100, 400];

/// Where positions have no noise, the fits are told this much: springs need some.
const LEAST_POSITION_NOISE: f64 = 0.005;

/// Steps of the first-order descent, times the number of cells.
const DESCENT_WORK: u64 = 100_000;

/// One method on one tissue.
#[derive(Clone, Copy)]
struct Outcomes {
    /// Relative errors of K_P α and P_0.
    chiral: f64,
    perimeter: f64,
    /// Errors of K_P α in standard errors, and whether both intervals cover; of methods that have intervals.
    covered: Option<[bool; 2]>,
    deviation: f64,
    wrong_edges: usize,
    lost_sides: usize,
    position_error: f64,
    /// Φ over its expected value.
    objective: f64,
    flagged: bool,
    seconds: f64,
}

/// All methods on one tissue.
struct Row {
    edges_before: usize,
    sides_before: usize,
    naive: Outcomes,
    paper: Outcomes,
    ours: Outcomes,
    /// Seconds until the search is at the objective where the descent ends, or below.
    seconds_to_paper: f64,
}

/// One cell of the table.
struct Setting {
    cells: usize,
    noise: Noise,
    rows: Vec<Row>,
}

pub fn run(seeds: u64, cells: Option<usize>, figures: Option<&Path>) -> Outcome {
    let mut settings = Vec::new();
    for cells in CELLS.into_iter().filter(|own| cells.is_none_or(|only| only == *own)) {
        for velocity in VELOCITY_NOISE {
            for position in POSITION_NOISE {
                let noise = Noise { position, velocity };
                let begun = Instant::now();
                let rows = on_one_core_each(seeds, |seed| row(cells, noise, seed))?;
                let setting = Setting { cells, noise, rows };
                // A study that is stopped leaves what it has done.
                eprintln!(
                    "{:.0} s\n{}\n{}",
                    begun.elapsed().as_secs_f64(),
                    table::errors(&setting),
                    table::costs(&setting)
                );
                settings.push(setting);
            }
        }
    }
    table::print(&settings);
    if let Some(folder) = figures {
        figures::write(&settings, folder)?;
    }
    Ok(())
}

fn row(cells: usize, noise: Noise, seed: u64) -> Result<Row, Box<dyn std::error::Error>> {
    let tissue = Tissue::new(cells, seed)?;
    let measured = tissue.measured(noise, seed)?;
    let known = KnownNoise {
        position: Some(noise.position.max(LEAST_POSITION_NOISE)),
        velocity: Some(noise.velocity),
    };
    let search = Request { cross_validation: CrossValidation::Skipped, ..tissue.request(known) };
    let descent = Request {
        method: Method::Descent { max_steps: DESCENT_WORK / cells as u64, loss: Loss::Norms },
        ..search.clone()
    };
    let begun = Instant::now();
    let paper = infer(std::slice::from_ref(&measured), &descent, &mut |_| ControlFlow::Continue(()))?;
    let paper_seconds = begun.elapsed().as_secs_f64();
    let goal = paper.objective / paper.expected_objective;
    let (begun, mut reached) = (Instant::now(), None);
    let ours = infer(std::slice::from_ref(&measured), &search, &mut |progress: Progress<'_>| {
        // During the continuation the objective is told with stiffer springs, so that it is never too small.
        if progress.objective <= goal && reached.is_none() {
            reached = Some(begun.elapsed().as_secs_f64());
        }
        ControlFlow::Continue(())
    })?;
    let seconds = begun.elapsed().as_secs_f64();
    let sides = |tessellation| tissue.lost_sides(tessellation, noise.position.max(0.01));
    let naive = naive(&tissue, &measured, &ours, noise);
    Ok(Row {
        edges_before: tissue.wrong_edges(&measured.tessellation),
        sides_before: sides(&measured.tessellation),
        naive,
        paper: outcomes(&tissue, &paper, noise, paper_seconds),
        ours: outcomes(&tissue, &ours, noise, seconds),
        seconds_to_paper: match reached {
            Some(reached) => reached,
            None if ours.objective <= paper.objective => seconds,
            None => f64::INFINITY,
        },
    })
}

fn outcomes(tissue: &Tissue, fit: &Inference, noise: Noise, seconds: f64) -> Outcomes {
    let (chiral, perimeter) = (FitParameter::ChiralCoefficient, FitParameter::PreferredPerimeter);
    let estimate = |quantity| fit.parameters.get(quantity);
    let error = |quantity| (estimate(quantity).value / tissue.truth(quantity) - 1.0).abs();
    let covers = |quantity| estimate(quantity).covers(tissue.truth(quantity));
    Outcomes {
        chiral: error(chiral),
        perimeter: error(perimeter),
        covered: Some([covers(chiral), covers(perimeter)]),
        deviation: (estimate(chiral).value - tissue.truth(chiral)).abs() / estimate(chiral).standard_error,
        wrong_edges: tissue.wrong_edges(&fit.frames[0].tessellation),
        lost_sides: tissue.lost_sides(&fit.frames[0].tessellation, noise.position.max(0.01)),
        position_error: tissue.position_error(&fit.frames[0].nudged_positions),
        objective: fit.objective / fit.expected_objective,
        flagged: !fit.doubts.is_empty(),
        seconds,
    }
}

/// Least squares at the measured positions, which every fit reports.
fn naive(tissue: &Tissue, measured: &Observation, fit: &Inference, noise: Noise) -> Outcomes {
    let naive = &fit.naive;
    let chiral = naive.perimeter_elasticity * naive.chirality;
    Outcomes {
        chiral: (chiral / tissue.truth(FitParameter::ChiralCoefficient) - 1.0).abs(),
        perimeter: (naive.preferred_perimeter / tissue.truth(FitParameter::PreferredPerimeter) - 1.0).abs(),
        covered: None,
        deviation: f64::NAN,
        wrong_edges: tissue.wrong_edges(&measured.tessellation),
        lost_sides: tissue.lost_sides(&measured.tessellation, noise.position.max(0.01)),
        position_error: tissue.position_error(&measured.positions),
        objective: f64::NAN,
        flagged: false,
        seconds: f64::NAN,
    }
}
