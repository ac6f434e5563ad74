//! Whether the advice on what to measure next is right: what is advised is done, and the standard error that a fit then has is compared with
//! the one that was foreseen.
//!
//! Cases take turns: velocities of cells in one to three frames, and tracks over four to six. Numbers of cells, parameters and errors are drawn.
//! The program is run as a user would; besides what it advises, one more measurement is made in each case, another one from case to case.

use super::seeds::on_cores;
use super::{Program, parameters, random};
use crate::Outcome;
use claims::measured::{MeasuredSet, Truth, Velocities};
use ndarray::Array3;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde_json::Value;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use voronudge_geometry::Vector;
use voronudge_infer::Design;
use voronudge_model::Parameters;

/// Time before the first frame, in 1/K_P, and a step of the integration.
const SETTLING: f64 = 10.0;
const STEP: f64 = 0.004;
/// Share by which what is reached may differ from what was foreseen.
const ACCEPTED: f64 = 0.25;

/// A measurement.
#[derive(Debug, Clone, Copy)]
struct Case {
    seed: u64,
    tracks: bool,
    cells: usize,
    frames: usize,
    /// Of snapshots: the time between frames; of tracks: how far a cell moves.
    apart: f64,
    position_noise: f64,
    velocity_noise: f64,
    parameters: Parameters<f64>,
}

/// What came of a measurement that was foreseen.
struct Reached {
    advised: bool,
    design: String,
    quantity: String,
    foreseen: f64,
    reached: f64,
}

impl Reached {
    fn is_right(&self) -> bool {
        (self.reached / self.foreseen - 1.0).abs() < ACCEPTED
    }
}

pub fn run(seeds: u64, only: &[String]) -> Outcome {
    let program = Program::new(None, "--complete false")?;
    let folder = tempfile::tempdir()?;
    let cores = std::thread::available_parallelism()?.get();
    println!(
        "| case | data | advised | measured instead | least certain | standard error foreseen | reached | right |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let all = on_cores(cores, seeds, |seed| {
        let case = Case::draw(seed);
        if !only.is_empty() && !only.iter().any(|text| case.name().contains(text.as_str())) {
            return Ok(Vec::new());
        }
        let reached = case.judge(&program, &folder.path().join(seed.to_string()))?;
        for own in &reached {
            println!(
                "| {seed} | {} | {} | {} | {} | × {:.2} | × {:.2} | {} |",
                case.name(),
                if own.advised { "yes" } else { "no" },
                own.design,
                own.quantity,
                own.foreseen,
                own.reached,
                if own.is_right() { "yes" } else { "**no**" }
            );
        }
        Ok(reached)
    })?;
    let all: Vec<Reached> = all.into_iter().flatten().collect();
    let count = |which: &dyn Fn(&&Reached) -> bool| {
        let own: Vec<&Reached> = all.iter().filter(which).collect();
        let right = own.iter().filter(|own| own.is_right()).count();
        let ratios = own.iter().map(|own| own.reached / own.foreseen).collect();
        let [low, middle, high] = super::seeds::quartiles(ratios);
        format!("{right} of {} | {middle:.2} ({low:.2} to {high:.2})", own.len())
    };
    println!("\n| measured instead | within 25 % | reached / foreseen: median (quartiles) |\n|---|---|---|");
    println!("| what is advised | {} |", count(&|own| own.advised));
    for design in Design::ALL {
        println!("| {} | {} |", design.name(), count(&|own| own.design == design.name()));
    }
    Ok(())
}

impl Case {
    fn draw(seed: u64) -> Self {
        let mut drawn = Pcg64::seed_from_u64(7000 + seed);
        let tracks = seed % 2 == 1;
        let cells = [100, 121, 144, 169, 196][drawn.random_range(0..5)];
        let preferred_perimeter = drawn.random_range(3.8..4.0);
        let parameters = parameters(preferred_perimeter, drawn.random_range(0.5..3.0));
        let (frames, apart) = match tracks {
            true => (drawn.random_range(4..7), drawn.random_range(0.06..0.14)),
            false => (drawn.random_range(1..4), 1.0),
        };
        let position_noise = drawn.random_range(0.01..0.03);
        let velocity_noise = drawn.random_range(0.03..0.1);
        Self { seed, tracks, cells, frames, apart, position_noise, velocity_noise, parameters }
    }

    fn name(&self) -> &'static str {
        if self.tracks { "tracks" } else { "velocities" }
    }

    /// The same with another measurement; half the interval of velocities is none.
    fn instead(&self, design: Design) -> Self {
        match design {
            Design::TwiceTheFrames => Self { frames: 2 * self.frames, ..*self },
            Design::HalfTheInterval => Self { frames: 2 * self.frames - 1, apart: 0.5 * self.apart, ..*self },
            Design::HalfThePositionNoise => Self { position_noise: 0.5 * self.position_noise, ..*self },
            Design::TwiceTheField => Self { cells: 2 * self.cells, ..*self },
        }
    }

    /// Follows the advice, and makes one other measurement.
    fn judge(&self, program: &Program, folder: &Path) -> Result<Vec<Reached>, Box<dyn Error>> {
        let now = self.prospects(program, &folder.join("now"))?;
        let advised = now["recommended"].as_str().ok_or("nothing is advised")?;
        let quantity = now["least_certain"].as_str().ok_or("nothing is uncertain")?;
        let present = of(&now, quantity)?;
        let expected = present["expected"].as_object().ok_or("nothing is foreseen")?;
        let before = present["standard_error"].as_f64().ok_or("no standard error")?;
        let known = Design::ALL.into_iter().filter(|design| expected.contains_key(design.name()));
        let others: Vec<Design> = known.filter(|design| design.name() != advised).collect();
        let other = others[(self.seed / 2) as usize % others.len()];
        let mut all = Vec::new();
        for design in Design::ALL.into_iter().filter(|own| own.name() == advised || *own == other) {
            let then = self.instead(design).prospects(program, &folder.join(design.name()))?;
            let after = of(&then, quantity)?["standard_error"].as_f64().ok_or("no standard error")?;
            all.push(Reached {
                advised: design.name() == advised,
                design: design.name().into(),
                quantity: quantity.into(),
                foreseen: expected[design.name()].as_f64().unwrap_or(f64::NAN) / before,
                reached: after / before,
            });
        }
        Ok(all)
    }

    /// What the program foresees of data of this kind.
    fn prospects(&self, program: &Program, folder: &Path) -> Result<Value, Box<dyn Error>> {
        let (set, scatter) = self.measure()?;
        set.save(folder)?;
        let mut command = vec!["infer".to_owned()];
        if !self.tracks {
            let noise = [("--position-noise", self.position_noise), ("--velocity-noise", scatter)];
            command.extend(noise.into_iter().flat_map(|(name, value)| [name.to_owned(), value.to_string()]));
        }
        let command: Vec<&str> = command.iter().map(String::as_str).collect();
        let run = program.run(&command, folder, &folder.with_extension("fit"))?;
        let report = run.report.ok_or(run.message)?;
        Ok(report["prospects"].clone())
    }

    /// A simulated tissue, measured, with the error of its velocities.
    fn measure(&self) -> Result<(MeasuredSet, f64), Box<dyn Error>> {
        let mut tissue = random(self.cells, &self.parameters, 8000 + self.seed)?;
        (0..(SETTLING / STEP) as usize).try_for_each(|_| tissue.step(STEP))?;
        let squares = tissue.velocities().iter().map(Vector::norm_squared).sum::<f64>();
        let speed = (squares / self.cells as f64).sqrt();
        let interval = if self.tracks { self.apart / speed } else { self.apart };
        let steps = (interval / STEP).ceil();
        let scatter = self.velocity_noise * speed;
        let mut noise = Pcg64::seed_from_u64(9000 + self.seed);
        let mut positions = Array3::zeros((self.frames, self.cells, 2));
        let mut velocities = Array3::zeros((self.frames, self.cells, 2));
        for frame in 0..self.frames {
            if frame > 0 {
                (0..steps as usize).try_for_each(|_| tissue.step(interval / steps))?;
            }
            for (cell, (r, v)) in tissue.positions().iter().zip(tissue.velocities()).enumerate() {
                for axis in 0..2 {
                    let mut drawn = || -> f64 { StandardNormal.sample(&mut noise) };
                    positions[[frame, cell, axis]] = r[axis] + self.position_noise * drawn();
                    velocities[[frame, cell, axis]] = v[axis] + scatter * drawn();
                }
            }
        }
        let side = (self.cells as f64).sqrt();
        positions.mapv_inplace(|x| x.rem_euclid(side));
        let set = MeasuredSet {
            positions,
            velocities: if self.tracks { Velocities::None } else { Velocities::OfCells(velocities) },
            cell_box: Some(side),
            interval,
            truth: Truth {
                class: self.name().into(),
                seed: self.seed,
                parameters: BTreeMap::new(),
                effect: None,
                noise: [self.position_noise, self.velocity_noise],
                mean_step: 0.0,
                field_of_view: [0.0, 0.0, side, side],
                hidden: Vec::new(),
                doubled: 0,
            },
        };
        Ok((set, scatter))
    }
}

/// A quantity of the prospects.
fn of<'a>(prospects: &'a Value, name: &str) -> Result<&'a Value, Box<dyn Error>> {
    let all = prospects["quantities"].as_array().ok_or("no prospects")?;
    Ok(all.iter().find(|own| own["name"] == name).ok_or("no such quantity")?)
}
