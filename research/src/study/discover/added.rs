//! Data sets, and what is in them beyond the base model.

use claims::{Noise, TRUTH, Tissue};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use std::error::Error;
use std::sync::Arc;
use voronudge_geometry::{Domain, Vector};
use voronudge_infer::Observation;
use voronudge_model::{Column, Effect, Environment, Model, base_terms, columns, velocities};

/// What is searched, and the truth.
pub struct Sample {
    pub frames: Vec<Observation>,
    pub identities: Option<Vec<Vec<i64>>>,
    pub added: Vec<Added>,
}

/// An effect in the data.
pub struct Added {
    pub effect: &'static Effect,
    pub columns: Vec<Column>,
    /// In the units of the fit.
    pub coefficients: Vec<f64>,
    /// Root mean square velocity beyond what the base model could say as well, relative to that of the base model.
    pub beyond: f64,
}

/// How large an effect is: a root mean square velocity relative to that of the base model.
#[derive(Clone, Copy)]
pub enum Size {
    /// Of all that it adds.
    Whole(f64),
    /// Of what the base model could not say as well.
    Beyond(f64),
}

/// The middle of the box as the origin.
pub fn surroundings(tissue: &Tissue) -> Environment {
    let middle = match tissue.tessellation.domain() {
        Domain::Periodic(cell_box) => Vector::from(cell_box.lengths()) * 0.5,
        Domain::Open => Vector::zeros(),
    };
    Environment::default().about(middle)
}

/// Random numbers for what is added to a tissue, apart from those of its noise.
pub fn generator(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(3000 + seed)
}

/// A tissue measured once.
pub fn once(tissue: &Tissue, noise: Noise, seed: u64) -> Result<Sample, Box<dyn Error>> {
    let frame = tissue.measured(noise, seed)?.within(Arc::new(surroundings(tissue)));
    Ok(Sample { frames: vec![frame], identities: None, added: Vec::new() })
}

/// A tissue with effects of the catalogue, measured once.
pub fn with_effects(
    tissue: &Tissue,
    seed: u64,
    noise: Noise,
    effects: &[(&'static str, Size)],
) -> Result<Sample, Box<dyn Error>> {
    let environment = Arc::new(surroundings(tissue));
    let mut rng = generator(seed);
    let mut added = Vec::with_capacity(effects.len());
    for (id, size) in effects {
        let effect = Effect::from_id(id).ok_or_else(|| format!("{id} is not in the catalogue"))?;
        let columns = effect.columns(&environment, tissue.tessellation.domain())?;
        let direction: Vec<f64> = match columns.len() {
            1 => vec![1.0],
            count => (0..count).map(|_| StandardNormal.sample(&mut rng)).collect(),
        };
        let beside = Beside { tissue, environment: &environment, columns: &columns };
        let (coefficients, beyond) = beside.scaled(&direction, *size);
        added.push(Added { effect, columns, coefficients, beyond });
    }
    let all =
        |added: &Added| added.columns.iter().copied().zip(added.coefficients.clone()).collect::<Vec<_>>();
    let field = moved(tissue, &environment, &added.iter().flat_map(all).collect::<Vec<_>>());
    let field = field.into_iter().map(|v| v / tissue.rms).collect();
    let moving = tissue.moving(field);
    for own in &mut added {
        let unit = moving.rms.powi(i32::from(own.effect.unit.time));
        own.coefficients.iter_mut().for_each(|c| *c *= unit);
    }
    Ok(Sample { added, ..once(&moving, noise, seed)? })
}

/// Velocities of the model with columns more, in units of K_P ℓ₀.
fn moved(tissue: &Tissue, environment: &Arc<Environment>, added: &[(Column, f64)]) -> Vec<Vector<f64>> {
    let base = Model::chiral_voronoi(&TRUTH).within(environment);
    let model = added.iter().fold(base, |model, (column, c)| model.with(*column, *c));
    velocities(&tissue.tessellation, &tissue.positions, &model)
}

/// Columns beside the base model.
struct Beside<'a> {
    tissue: &'a Tissue,
    environment: &'a Arc<Environment>,
    columns: &'a [Column],
}

impl Beside<'_> {
    /// Coefficients along a direction such that the effect has a size, and its size beyond the base model.
    fn scaled(&self, direction: &[f64], size: Size) -> (Vec<f64>, f64) {
        let (mut scale, mut sizes) = (1e-3, [0.0; 2]);
        // The velocities are linear in most coefficients, and nearly so in others.
        for _ in 0..40 {
            let coefficients: Vec<f64> = direction.iter().map(|c| scale * c).collect();
            sizes = self.sizes(&coefficients);
            scale *= match size {
                Size::Whole(goal) => goal / sizes[0],
                Size::Beyond(goal) => goal / sizes[1],
            };
        }
        (direction.iter().map(|c| scale * c).collect(), sizes[1])
    }

    /// Root mean square velocity that coefficients add, and of its part beyond the base model.
    fn sizes(&self, coefficients: &[f64]) -> [f64; 2] {
        let added: Vec<(Column, f64)> =
            self.columns.iter().copied().zip(coefficients.iter().copied()).collect();
        let with = moved(self.tissue, self.environment, &added);
        let field: Vec<Vector<f64>> =
            with.iter().zip(&self.tissue.velocities).map(|(v, base)| v / self.tissue.rms - base).collect();
        let (tessellation, positions) = (&self.tissue.tessellation, &self.tissue.positions);
        let base = columns(tessellation, positions, &base_terms(TRUTH.preferred_area), self.environment);
        let n = field.len();
        let flat = |field: &[Vector<f64>], k: usize| field[k / 2][k % 2];
        let x = DMatrix::from_fn(2 * n, base.len(), |i, j| flat(&base[j], i));
        let y = DVector::from_fn(2 * n, |i, _| flat(&field, i));
        let shared = x.clone().svd(true, true).solve(&y, 1e-12).map_or(y.clone(), |c| &y - &x * c);
        [y.norm(), shared.norm()].map(|norm| norm / (n as f64).sqrt())
    }
}
