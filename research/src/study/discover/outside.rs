//! Something that no effect describes: how often one is named all the same. Velocities are made here, apart from the
//! columns of the catalogue, but for those of the mosaic, which is a column whose labels the search is not told.

use super::Plan;
use super::added::{Sample, generator, once, surroundings};
use super::table::{self, head, percent, row, seconds, verdict};
use crate::Outcome;
use claims::{Noise, Tissue};
use rand::Rng;
use std::error::Error;
use std::f64::consts::TAU;
use std::sync::Arc;
use voronudge_geometry::{Vector, quarter_turn};
use voronudge_infer::discover::Verdict;
use voronudge_model::effect::{LabelParameter, LabelledParameter};
use voronudge_model::{Model, velocities};

/// Root mean square velocity of what is added, relative to that of the base model.
const SIZES: [f64; 2] = [0.15, 0.3];

/// Radius of a vortex, in units of ℓ₀.
const VORTEX: f64 = 1.5;

const NOISE: Noise = Noise { position: 0.01, velocity: 0.1 };

#[derive(Clone, Copy)]
enum Unknown {
    Vortex,
    Wave,
    Mosaic,
    Polarity,
}

pub fn run(plan: &Plan) -> Outcome {
    println!("### Outside the catalogue, σ_r 1 %, σ_v 10 % ({})\n", plan.describe());
    head(&[
        "added",
        "size %",
        "attributed",
        "partial",
        "structure",
        "white",
        "nothing missing",
        "usually named",
        "s",
    ]);
    let all = [
        ("Gaussian vortex", Unknown::Vortex),
        ("travelling wave", Unknown::Wave),
        ("hidden mosaic of α", Unknown::Mosaic),
        ("hidden polarity", Unknown::Polarity),
    ];
    for size in SIZES {
        for (what, unknown) in all {
            let name = format!("outside, {what}, {} %", percent(size));
            if !plan.includes(&name) {
                continue;
            }
            let sample = |seed, drawn| sample(&plan.tissue(seed)?, drawn, unknown, size);
            let found = plan.search(&name, NOISE, sample, |found| found.verdict_is(Verdict::Attributed))?;
            row(&[
                what.to_owned(),
                percent(size),
                verdict(&found, Verdict::Attributed),
                verdict(&found, Verdict::Partial),
                verdict(&found, Verdict::UnexplainedStructured),
                verdict(&found, Verdict::UnexplainedWhite),
                verdict(&found, Verdict::NothingMissing),
                table::named(&found),
                seconds(&found),
            ]);
        }
    }
    println!();
    Ok(())
}

fn sample(tissue: &Tissue, seed: u64, unknown: Unknown, size: f64) -> Result<Sample, Box<dyn Error>> {
    let field = unknown.velocities(tissue, seed)?;
    let squares: f64 = field.iter().map(Vector::norm_squared).sum();
    let scale = size / (squares / field.len() as f64).sqrt();
    let moving = tissue.velocities.iter().zip(field).map(|(v, added)| v + added * scale).collect();
    once(&tissue.moving(moving), NOISE, seed)
}

impl Unknown {
    /// Velocities in any unit.
    fn velocities(self, tissue: &Tissue, seed: u64) -> Result<Vec<Vector<f64>>, Box<dyn Error>> {
        let mut rng = generator(seed);
        let domain = tissue.tessellation.domain();
        let width = (tissue.positions.len() as f64).sqrt();
        let positions = tissue.positions.iter();
        Ok(match self {
            Self::Vortex => {
                let centre = Vector::new(rng.random::<f64>(), rng.random::<f64>()) * width;
                let turning = |r: &Vector<f64>| {
                    let x = domain.shortest(r - centre);
                    quarter_turn(x) * (-0.5 * x.norm_squared() / VORTEX.powi(2)).exp()
                };
                positions.map(turning).collect()
            }
            Self::Wave => {
                let q = Vector::new(2.0, 1.0) * (TAU / width);
                let (phase, angle) = (TAU * rng.random::<f64>(), TAU * rng.random::<f64>());
                let along = Vector::new(angle.cos(), angle.sin());
                positions.map(|r| along * (q.dot(r) + phase).cos()).collect()
            }
            Self::Mosaic => {
                let labels = tissue.positions.iter().map(|_| Some(i64::from(rng.random::<bool>()))).collect();
                let environment = Arc::new(surroundings(tissue).with_labels(labels)?);
                let parameter = LabelledParameter::Chirality;
                let model = Model::single(LabelParameter { label: 1, parameter }.into()).within(&environment);
                velocities(&tissue.tessellation, &tissue.positions, &model)
            }
            Self::Polarity => {
                let pointing = |_| {
                    let angle = TAU * rng.random::<f64>();
                    Vector::new(angle.cos(), angle.sin())
                };
                positions.map(pointing).collect()
            }
        })
    }
}
