//! Tissues as a microscope shows them, for studies of the program: a window, cells that are not seen, errors, labels.

use ndarray::{Array2, Array3};
use rand::Rng;
use rand_distr::StandardNormal;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_io::{Boundary, DataSet, OutputDirectory};
use voronudge_model::{CellFactors, CellParameter, Environment, Model, Parameters};
use voronudge_simulate::{Distribution, RandomPlacement, Simulation, generator, recommended_time_step};

/// Side of what is seen, in ℓ₀, and width of what is not seen around it.
const SIDE: f64 = 18.0;
const UNSEEN: f64 = 4.0;
/// Share of the cells that is not detected in a window.
const MISSED: f64 = 0.02;
/// σ_r in ℓ₀, and σ_v as a share of the root mean square velocity.
const ERRORS: [f64; 2] = [0.015, 0.05];
/// Frames of tracks, and about how far cells move from one to the next.
const FRAMES: usize = 4;
const MOVED: f64 = 0.1;

/// What is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// A periodic tissue with all its cells, and their velocities.
    Whole,
    /// A window without some of them, and their velocities.
    Window,
    /// The same window in several frames, without velocities.
    Tracks,
}

impl View {
    pub fn name(self) -> &'static str {
        match self {
            Self::Whole => "periodic, all cells",
            Self::Window => "window, 2 % missed",
            Self::Tracks => "window, 2 % missed, tracks of 4 frames",
        }
    }
}

/// A tissue and how it is seen. Lengths in ℓ₀, times in 1/K_P.
pub struct Scene {
    pub parameters: Parameters<f64>,
    /// Two kinds of cells, as many of each, which are so far from the mean parameters, as shares of these: labels 0 and 1.
    pub kinds: [(CellParameter, f64); 2],
    /// Time after the random start.
    pub time: f64,
    pub view: View,
    pub seed: u64,
}

impl Scene {
    fn model(&self, types: &[f64]) -> Result<Model<f64>, Box<dyn Error>> {
        let factors = self.kinds.iter().try_fold(CellFactors::default(), |factors, (parameter, share)| {
            factors.with(*parameter, types.iter().map(|side| 1.0 + share * side).collect())
        })?;
        let environment = Environment::default().with_cell_factors(factors)?;
        Ok(Model::chiral_voronoi(&self.parameters).within(&Arc::new(environment)))
    }

    /// Writes what is seen as a data set.
    pub fn write(&self, folder: &Path) -> Result<(), Box<dyn Error>> {
        let mut rng = generator(self.seed);
        let margin = if self.view == View::Whole { 0.0 } else { UNSEEN };
        let width = SIDE + 2.0 * margin;
        let cells = (width * width).round() as usize;
        let cell_box = PeriodicBox::new([width; 2])?;
        let positions = RandomPlacement::new(cells, cell_box).draw(&mut rng)?;
        // One below the mean and one above it.
        let types: Vec<f64> = Distribution::TwoTypes
            .draw(1.0, cells, &mut rng)
            .iter()
            .map(|multiple| (multiple - 1.0).signum())
            .collect();
        let mut simulation = Simulation::new(positions, Domain::Periodic(cell_box), self.model(&types)?)?;
        let step = recommended_time_step(&self.parameters, 1.0);
        let advance = |simulation: &mut Simulation, time: f64| -> Result<(), Box<dyn Error>> {
            let steps = (time / step).ceil().max(1.0);
            (0..steps as usize).try_for_each(|_| simulation.step(time / steps))?;
            Ok(())
        };
        advance(&mut simulation, self.time)?;
        let squares: f64 = simulation.velocities().iter().map(|v| v.norm_squared()).sum();
        let speed = (squares / cells as f64).sqrt();
        let frames = if self.view == View::Tracks { FRAMES } else { 1 };
        let interval = MOVED / speed;
        let seen: Vec<usize> = (0..cells)
            .filter(|&cell| {
                let inside = cell_box
                    .wrap(simulation.positions()[cell])
                    .iter()
                    .all(|x| (margin..margin + SIDE).contains(x));
                let detected = margin == 0.0 || rng.random::<f64>() >= MISSED;
                inside && detected
            })
            .collect();
        let mut draw = |deviation: f64| -> f64 { deviation * rng.sample::<f64, _>(StandardNormal) };
        let mut places = Array3::zeros((frames, seen.len(), 2));
        let mut velocities = Array3::zeros((1, seen.len(), 2));
        // Cells go on where they are, whatever side of the box that is.
        let first: Vec<Vector<f64>> = simulation.positions().to_vec();
        for frame in 0..frames {
            if frame > 0 {
                advance(&mut simulation, interval)?;
            }
            for (number, &cell) in seen.iter().enumerate() {
                let start = cell_box.wrap(first[cell]);
                let moved = cell_box.shortest(simulation.positions()[cell] - first[cell]);
                for axis in 0..2 {
                    places[(frame, number, axis)] = start[axis] + moved[axis] - margin + draw(ERRORS[0]);
                    if frame == 0 {
                        velocities[(0, number, axis)] =
                            simulation.velocities()[cell][axis] + draw(ERRORS[1] * speed / 2f64.sqrt());
                    }
                }
            }
        }
        let boundary = match self.view {
            View::Whole => Boundary::Periodic { lengths: [width; 2] },
            _ => Boundary::Open,
        };
        let labels = seen.iter().map(|&cell| i64::from(types[cell] > 0.0)).collect();
        let labels = Array2::from_shape_vec((1, seen.len()), labels)?;
        let labels = labels.broadcast((frames, seen.len())).ok_or("labels for each frame")?.to_owned();
        let data = DataSet {
            velocities: (self.view != View::Tracks).then_some(velocities),
            labels: Some(labels),
            frame_interval: interval,
            length_unit: "ℓ₀".into(),
            time_unit: "τ".into(),
            ..DataSet::new(places, boundary)
        };
        let mut out = OutputDirectory::create(folder)?;
        data.save(&mut out)?;
        out.commit()?;
        Ok(())
    }
}
