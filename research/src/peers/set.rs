//! A movie of a simulated tissue: what every method is given, and the truth.

use crate::study::{parameters, random};
use ndarray::{Array3, Array4, ArrayView};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use std::error::Error;
use std::path::Path;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_io::OutputDirectory;
use voronudge_model::{Column, Effect, Environment, Structure, velocities};
use voronudge_simulate::{Driving, Simulation};

/// Cells of a set, frames that are fitted, and frames after these that nobody fits.
const CELLS: usize = 64;
const FITTED: usize = 10;
const HELD_OUT: usize = 5;
/// Root mean square velocity of an effect, of that of the tissue without it.
const SHARE: f64 = 0.15;
/// Time before the first frame, and after the onset of an effect, in 1/K_P; steps of the integration, and those between frames.
const SETTLING: [f64; 2] = [10.0, 1.0];
const STEP: f64 = 0.005;
const STEPS: usize = 20;
/// Places for the neighbours of a cell; no cell has more.
const SLOTS: usize = 12;

/// Candidates that all methods have, by the names of the catalogue.
pub const CANDIDATES: [&str; 7] = [
    "drift",
    "alpha_adhesion",
    "alpha_pressure",
    "alpha_area",
    "nonlinear_area",
    "coordination_tension",
    "edge_tension",
];
/// Those that act in sets with an effect, in turn.
const ACTING: [&str; 3] = ["alpha_area", "drift", "coordination_tension"];
/// The base model by names of columns.
pub const BASE: [&str; 4] = ["K_A", "K_P P_0", "K_P", "K_P alpha"];

/// How cells were seen, and whether they scatter.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    pub name: &'static str,
    /// How far the model moves a cell from frame to frame, root mean square.
    pub moved: f64,
    /// σ_r
    pub noise: f64,
    /// Standard deviation of what a coordinate moves at random in an interval.
    pub scatter: f64,
}

/// The kinds of sets.
pub const KINDS: [Kind; 4] = [
    Kind { name: "short steps, scattering as much", moved: 0.02, noise: 0.002, scatter: 0.02 },
    Kind { name: "sharp, scattering", moved: 0.05, noise: 0.003, scatter: 0.01 },
    Kind { name: "blurred, scattering", moved: 0.05, noise: 0.02, scatter: 0.01 },
    Kind { name: "blurred, not scattering", moved: 0.05, noise: 0.02, scatter: 0.0 },
];

/// A movie with its truth.
pub struct Set {
    pub cell_box: PeriodicBox,
    pub interval: f64,
    /// Measured positions of the frames fitted, not wrapped.
    pub measured: Vec<Vec<Vector<f64>>>,
    /// True positions of the frames held out.
    pub held_out: Vec<Vec<Vector<f64>>>,
    /// The effect that acts.
    pub effect: Option<&'static str>,
    /// True coefficients of all columns.
    pub truth: Vec<f64>,
    structure: Structure,
}

impl Set {
    /// A tissue of a seed; with an effect, if it should have one.
    pub fn new(kind: Kind, seed: u64, lacks: bool) -> Result<Self, Box<dyn Error>> {
        let mut drawn = Pcg64::seed_from_u64(11_000 + seed);
        let preferred_perimeter = drawn.random_range(3.8..4.0);
        let parameters = parameters(preferred_perimeter, drawn.random_range(0.5..2.0));
        let cell_box = PeriodicBox::new([(CELLS as f64).sqrt(); 2])?;
        let domain = Domain::Periodic(cell_box);
        let mut tissue = random(CELLS, &parameters, 12_000 + seed)?;
        settle(&mut tissue, SETTLING[0])?;
        let (structure, places) = structure(domain)?;
        let mut truth = vec![0.0; structure.dimension()];
        truth[..BASE.len()].copy_from_slice(&parameters.coefficients());
        let effect = lacks.then(|| ACTING[seed as usize % ACTING.len()]);
        if let Some(effect) = effect {
            let speed = root_mean_square(tissue.velocities());
            let column = places.iter().position(|name| *name == effect).ok_or("no such column")?;
            let alone = field(&structure, column, tissue.tessellation(), tissue.positions())?;
            truth[column] = SHARE * speed / root_mean_square(&alone);
            let model = structure.model(&truth, &Environment::default().into());
            tissue = Simulation::new(tissue.positions().to_vec(), domain, model)?;
            settle(&mut tissue, SETTLING[1])?;
        }
        let interval = kind.moved / root_mean_square(tissue.velocities());
        let diffusion = kind.scatter.powi(2) / (2.0 * interval);
        tissue = tissue.with_driving(Driving { diffusion, seed, ..Driving::default() })?;
        let mut frames = vec![tissue.positions().to_vec()];
        while frames.len() < FITTED + HELD_OUT {
            (0..STEPS).try_for_each(|_| tissue.step(interval / STEPS as f64))?;
            let before = &frames[frames.len() - 1];
            let moved = tissue.positions().iter().zip(before);
            frames.push(moved.map(|(to, from)| from + domain.shortest(to - from)).collect());
        }
        let held_out = frames.split_off(FITTED);
        let mut noise = Pcg64::seed_from_u64(13_000 + seed);
        let mut drawn = || -> f64 { StandardNormal.sample(&mut noise) };
        let mut seen = |r: &Vector<f64>| r + Vector::new(drawn(), drawn()) * kind.noise;
        let measured = frames.iter().map(|frame| frame.iter().map(&mut seen).collect()).collect();
        Ok(Self { cell_box, interval, measured, held_out, effect, truth, structure })
    }

    /// The columns of a configuration: of the base model, then of the candidates.
    pub fn columns(&self, positions: &[Vector<f64>]) -> Result<Vec<Vec<Vector<f64>>>, Box<dyn Error>> {
        let tessellation = Tessellation::new(positions, Domain::Periodic(self.cell_box))?;
        (0..self.truth.len()).map(|k| field(&self.structure, k, &tessellation, positions)).collect()
    }

    /// Share of the true velocities that some coefficients miss, at the true positions of the frames held out.
    pub fn error(&self, coefficients: &[f64]) -> Result<f64, Box<dyn Error>> {
        let (mut missed, mut total) = (0.0, 0.0);
        for frame in &self.held_out {
            let columns = self.columns(frame)?;
            for cell in 0..frame.len() {
                let sum = |c: &[f64]| c.iter().zip(&columns).map(|(c, x)| x[cell] * *c).sum::<Vector<f64>>();
                let truth = sum(&self.truth);
                missed += (sum(coefficients) - truth).norm_squared();
                total += truth.norm_squared();
            }
        }
        Ok(missed / total)
    }

    /// Writes what the methods read: a data set, and for those of another language who is next to whom, and the columns.
    pub fn write(&self, folder: &Path) -> Result<(), Box<dyn Error>> {
        let [side, _] = self.cell_box.lengths();
        let (frames, cells) = (self.measured.len(), CELLS);
        let domain = Domain::Periodic(self.cell_box);
        let tessellations: Vec<Tessellation> =
            self.measured.iter().map(|r| Tessellation::new(r, domain)).collect::<Result<_, _>>()?;
        let of = |frame: usize, cell: usize| tessellations[frame].ring(cell).collect::<Vec<_>>();
        let positions = Array3::from_shape_fn((frames, cells, 2), |(f, c, axis)| self.measured[f][c][axis]);
        // The neighbours in the order of the ring, the last one again where there are fewer, then the vectors to their images.
        let mut rings = Array4::zeros((frames, cells, SLOTS, 3));
        for frame in 0..frames {
            for cell in 0..cells {
                let ring = of(frame, cell);
                if ring.len() > SLOTS {
                    return Err("a cell has too many neighbours".into());
                }
                for slot in 0..SLOTS {
                    let h = ring[slot.min(ring.len() - 1)];
                    let other = tessellations[frame].neighbour(h);
                    let apart = self.measured[frame][other] - self.measured[frame][cell];
                    let image = domain.shortest(apart) - apart;
                    rings[[frame, cell, slot, 0]] = other as f64;
                    rings[[frame, cell, slot, 1]] = image.x;
                    rings[[frame, cell, slot, 2]] = image.y;
                }
            }
        }
        let mut columns = Array4::zeros((frames, cells, 2, self.truth.len()));
        for (frame, positions) in self.measured.iter().enumerate() {
            for (k, column) in self.columns(positions)?.into_iter().enumerate() {
                for (cell, v) in column.into_iter().enumerate() {
                    columns[[frame, cell, 0, k]] = v.x;
                    columns[[frame, cell, 1, k]] = v.y;
                }
            }
        }
        let mut out = OutputDirectory::create(folder)?;
        out.write_array("positions.npy", positions.mapv(|x| x.rem_euclid(side)).view())?;
        out.write_array("unwrapped.npy", positions.view())?;
        out.write_array("rings.npy", rings.view())?;
        out.write_array("columns.npy", columns.view())?;
        out.write_array("interval.npy", ArrayView::from(&[self.interval]))?;
        let (interval, units) = (self.interval, "length_unit = \"l\"\ntime_unit = \"t\"\ny_axis = \"up\"");
        let text = format!(
            "boundary = \"periodic\"\nbox = [{side:?}, {side:?}]\nframe_interval = {interval:?}\n{units}\n"
        );
        out.write_text("dataset.toml", &text)?;
        out.commit()?;
        Ok(())
    }
}

/// The base model with all candidates, and the name of each column.
fn structure(domain: Domain) -> Result<(Structure, Vec<&'static str>), Box<dyn Error>> {
    let mut names: Vec<&'static str> = BASE.to_vec();
    let mut columns: Vec<Column> = Vec::new();
    for name in CANDIDATES {
        let effect = Effect::from_id(name).ok_or("no such effect")?;
        let own = effect.columns(&Environment::default(), domain)?;
        names.extend(own.iter().map(|_| name));
        columns.extend(own);
    }
    Ok((Structure::base(1.0).with(&columns), names))
}

/// The names of the columns.
pub fn names() -> Result<Vec<&'static str>, Box<dyn Error>> {
    Ok(structure(Domain::Periodic(PeriodicBox::new([10.0; 2])?))?.1)
}

/// The field of one column.
fn field(
    structure: &Structure,
    column: usize,
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
) -> Result<Vec<Vector<f64>>, Box<dyn Error>> {
    let mut one = vec![0.0; structure.dimension()];
    *one.get_mut(column).ok_or("no such column")? = 1.0;
    Ok(velocities(tessellation, positions, &structure.model(&one, &Environment::default().into())))
}

fn settle(tissue: &mut Simulation, time: f64) -> Result<(), Box<dyn Error>> {
    Ok((0..(time / STEP) as usize).try_for_each(|_| tissue.step(STEP))?)
}

fn root_mean_square(vectors: &[Vector<f64>]) -> f64 {
    (vectors.iter().map(Vector::norm_squared).sum::<f64>() / vectors.len() as f64).sqrt()
}
