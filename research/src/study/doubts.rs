//! How often a fit doubts data that are as it takes them, and data that are not.

use super::seeds::on_one_core_each;
use crate::Outcome;
use claims::{Noise, Tissue};
use rand::SeedableRng;
use rand::seq::index::sample;
use rand_pcg::Pcg64;
use std::error::Error;
use std::ops::ControlFlow;
use voronudge_geometry::{CellPolygon, FieldOfView, Vector};
use voronudge_infer::{FitParameter, KnownNoise, Observation, Part, infer};

const CELLS: usize = 225;

/// Standard errors by which K_P α is off in a fit that should be doubted.
const OFF: f64 = 3.0;

/// What is wrong with the data.
#[derive(Debug, Clone, Copy)]
enum Fault {
    Nothing,
    /// Cells that are not seen, per thousand.
    Missed(usize),
    /// Centroids instead of sites.
    Centroids,
}

/// A fit: whether K_P α is off by more than three standard errors, and what is in doubt.
struct Fitted {
    is_off: bool,
    doubtful: Vec<Part>,
}

/// Counts doubts about fits of complete data, of data with missed cells and of centroids.
pub fn run(seeds: u64) -> Outcome {
    let noise = Noise { position: 0.015, velocity: 0.05 };
    let parts = [
        Part::Objective,
        Part::PositionNoise,
        Part::Cells,
        Part::Outliers,
        Part::Pattern,
        Part::Tracks,
        Part::Positions,
    ];
    let names: Vec<&str> = parts.iter().map(|part| part.name()).collect();
    println!("| data | noise | sets | off | doubted | off and doubted | {} |", names.join(" | "));
    println!("|{}", "---|".repeat(6 + parts.len()));
    for (name, fault) in [
        ("complete", Fault::Nothing),
        ("2 % missed", Fault::Missed(20)),
        ("5 % missed", Fault::Missed(50)),
        ("centroids", Fault::Centroids),
    ] {
        for (levels, known) in [("estimated", KnownNoise::default()), ("given", noise.known())] {
            let fits = on_one_core_each(seeds, |seed| fit(noise, known, fault, seed))?;
            let count = |is: &dyn Fn(&Fitted) -> bool| fits.iter().filter(|fit| is(fit)).count();
            let of_parts: Vec<String> =
                parts.iter().map(|part| count(&|fit| fit.doubtful.contains(part)).to_string()).collect();
            println!(
                "| {name} | {levels} | {} | {} | {} | {} | {} |",
                fits.len(),
                count(&|fit| fit.is_off),
                count(&|fit| !fit.doubtful.is_empty()),
                count(&|fit| fit.is_off && !fit.doubtful.is_empty()),
                of_parts.join(" | ")
            );
        }
    }
    Ok(())
}

fn fit(noise: Noise, known: KnownNoise, fault: Fault, seed: u64) -> Result<Fitted, Box<dyn Error>> {
    let tissue = Tissue::new(CELLS, 3000 + seed)?;
    let frame = observed(&tissue, noise, fault, seed)?;
    let result = infer(&[frame], &tissue.request(known), &mut |_| ControlFlow::Continue(()))?;
    let found = result.parameters.chiral_coefficient;
    let off = (found.value - tissue.truth(FitParameter::ChiralCoefficient)).abs();
    Ok(Fitted {
        is_off: off > OFF * found.standard_error,
        doubtful: result.doubts.iter().map(voronudge_infer::Doubt::part).collect(),
    })
}

fn observed(tissue: &Tissue, noise: Noise, fault: Fault, seed: u64) -> Result<Observation, Box<dyn Error>> {
    let whole = tissue.measured(noise, seed)?;
    let (positions, velocities) = match fault {
        Fault::Nothing => return Ok(whole),
        Fault::Missed(share) => {
            let mut generator = Pcg64::seed_from_u64(4000 + seed);
            let missed = sample(&mut generator, CELLS, (CELLS * share).div_ceil(1000));
            let kept = || (0..CELLS).filter(|cell| !missed.iter().any(|other| other == *cell));
            (
                kept().map(|cell| whole.positions[cell]).collect(),
                kept().map(|cell| whole.velocities.values()[cell]).collect(),
            )
        }
        Fault::Centroids => {
            let offsets = (0..CELLS).map(|cell| centroid(tissue, cell));
            let positions = whole.positions.iter().zip(offsets).map(|(r, offset)| r + offset).collect();
            (positions, whole.velocities.values().to_vec())
        }
    };
    Ok(Observation::new(0, positions, velocities, whole.tessellation.domain(), FieldOfView::default())?)
}

/// The centroid of a cell's polygon relative to its site.
fn centroid(tissue: &Tissue, cell: usize) -> Vector<f64> {
    let mut polygon = CellPolygon::default();
    polygon.fill(&tissue.tessellation, &tissue.positions, cell);
    let corners: Vec<Vector<f64>> = polygon.vertices().collect();
    let triangles = (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]));
    let weighted: Vector<f64> = triangles.map(|(a, b)| (a + b) * ((a.x * b.y - a.y * b.x) / 6.0)).sum();
    weighted / polygon.shape().area
}
