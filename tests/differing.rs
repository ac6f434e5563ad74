//! A liquid of cells that differ from each other, measured with noise.

use crate::{Noise, advance, noisy};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use std::error::Error;
use std::sync::Arc;
use voronudge_geometry::{CellPolygon, Domain, FieldOfView, PeriodicBox, Tessellation, Vector};
use voronudge_infer::{CrossValidation, FitParameter, KnownNoise, Observation, Request};
use voronudge_model::{CellFactors, CellParameter, Environment, Model, Parameters};
use voronudge_simulate::{RandomPlacement, Simulation, generator};

/// The mean parameters of the cells.
pub const MEAN: Parameters<f64> = Parameters {
    area_elasticity: 1.0,
    perimeter_elasticity: 1.0,
    preferred_perimeter: 4.0,
    preferred_area: 1.0,
    chirality: 1.0,
};

/// From when on cells differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Since {
    /// Their shapes have followed what they have of their own.
    Placement,
    /// They have settled alike.
    FirstFrame,
}

/// Cells in a box, whose parameters have a spread of their own, at several times.
#[derive(Debug, Clone)]
pub struct Differing {
    /// Deviation of each cell, relative to the mean, of each parameter that has a spread.
    pub deviations: Vec<(CellParameter, Vec<f64>)>,
    /// Positions and velocities (N) at each time, velocities in units of their root mean square.
    pub frames: Vec<[Vec<Vector<f64>>; 2]>,
    domain: Domain,
    /// Root mean square velocity in units of K_P ℓ₀.
    pub rms: f64,
}

impl Differing {
    /// Simulates for t = 10 from a random placement, then from frame to frame. Deviations are normal, of the standard deviations given.
    ///
    /// # Errors
    /// Those of the placement and the simulation.
    pub fn new(
        cells: usize,
        seed: u64,
        frames: usize,
        spreads: &[(CellParameter, f64)],
    ) -> Result<Self, Box<dyn Error>> {
        Self::since(Since::Placement, cells, seed, frames, spreads)
    }

    /// The same of cells that differ from some time on.
    ///
    /// # Errors
    /// Those of the placement and the simulation.
    pub fn since(
        since: Since,
        cells: usize,
        seed: u64,
        frames: usize,
        spreads: &[(CellParameter, f64)],
    ) -> Result<Self, Box<dyn Error>> {
        let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2])?;
        let domain = Domain::Periodic(cell_box);
        let mut rng = Pcg64::seed_from_u64(3000 + seed);
        let (mut factors, mut deviations) = (CellFactors::default(), Vec::new());
        for (parameter, spread) in spreads.iter().filter(|(_, spread)| *spread > 0.0) {
            let normal = Normal::new(0.0, *spread)?;
            let own: Vec<f64> = (0..cells).map(|_| normal.sample(&mut rng)).collect();
            // The mean over these cells is what a fit can find.
            let mean = own.iter().sum::<f64>() / cells as f64;
            let own: Vec<f64> = own.iter().map(|u| u - mean).collect();
            factors = factors.with(*parameter, own.iter().map(|u| 1.0 + u).collect())?;
            deviations.push((*parameter, own));
        }
        let environment = Arc::new(Environment::default().with_cell_factors(factors)?);
        let alike = Model::chiral_voronoi(&MEAN);
        let model = alike.clone().within(&environment);
        let start = RandomPlacement::new(cells, cell_box).draw(&mut generator(1000 + seed))?;
        let settling = if since == Since::Placement { model.clone() } else { alike };
        let mut simulation = Simulation::new(start, domain, settling)?;
        advance(&mut simulation, 10.0)?;
        if since == Since::FirstFrame {
            simulation = Simulation::new(simulation.positions().to_vec(), domain, model)?;
        }
        let mut all = Vec::with_capacity(frames);
        for frame in 0..frames {
            if frame > 0 {
                advance(&mut simulation, 0.5)?;
            }
            all.push([simulation.positions().to_vec(), simulation.velocities().to_vec()]);
        }
        let squares: f64 = all.iter().flat_map(|[_, v]| v).map(Vector::norm_squared).sum();
        let rms = (squares / (frames * cells) as f64).sqrt();
        all.iter_mut().flat_map(|[_, v]| v).for_each(|v| *v /= rms);
        Ok(Self { deviations, frames: all, domain, rms })
    }

    /// What is left of K_A and of K_P where a fit takes what cells have of their own to be independent of their shapes: one less the slopes of A_0 by the area and
    /// of P_0 by the perimeter over the cells of the first frame.
    ///
    /// # Errors
    /// Those of the tessellation.
    pub fn left_of_elasticities(&self) -> Result<[f64; 2], Box<dyn Error>> {
        let positions = &self.frames[0][0];
        let tessellation = Tessellation::new(positions, self.domain)?;
        let mut polygon = CellPolygon::default();
        let mut shapes = Vec::with_capacity(positions.len());
        for cell in 0..positions.len() {
            polygon.fill(&tessellation, positions, cell);
            shapes.push([polygon.shape().area, polygon.shape().perimeter]);
        }
        let preferred = [
            (CellParameter::PreferredArea, MEAN.preferred_area),
            (CellParameter::PreferredPerimeter, MEAN.preferred_perimeter),
        ];
        Ok([0, 1].map(|which| {
            let (parameter, mean) = preferred[which];
            let Some((_, own)) = self.deviations.iter().find(|(known, _)| *known == parameter) else {
                return 1.0;
            };
            let centre = shapes.iter().map(|shape| shape[which]).sum::<f64>() / shapes.len() as f64;
            let pairs = || own.iter().zip(&shapes).map(|(u, shape)| (mean * u, shape[which] - centre));
            1.0 - pairs().map(|(u, shape)| u * shape).sum::<f64>()
                / pairs().map(|(_, shape)| shape * shape).sum::<f64>()
        }))
    }

    /// What would be measured, with Gaussian noise on every component; cells are known again from frame to frame.
    ///
    /// # Errors
    /// If two cells come to lie on each other.
    pub fn measured(&self, noise: Noise, seed: u64) -> Result<Vec<Observation>, Box<dyn Error>> {
        let mut noisy = noisy(seed);
        let observe = |(index, [r, v]): (usize, &[Vec<Vector<f64>>; 2])| {
            let positions = noisy(r, noise.position)?;
            let velocities: Vec<_> = noisy(v, noise.velocity)?.into_iter().map(Some).collect();
            let identities = (0..positions.len()).map(Some).collect();
            let frame = Observation::new(index, positions, velocities, self.domain, FieldOfView::default())?;
            Ok(frame.with_identities(identities))
        };
        self.frames.iter().enumerate().map(observe).collect()
    }

    /// A fit of all parameters that lets cells differ in some, noise levels estimated, without cross-validation.
    pub fn request(&self, varied: &[CellParameter]) -> Request {
        Request {
            noise: KnownNoise::default(),
            cross_validation: CrossValidation::Skipped,
            varied: varied.to_vec(),
            ..Request::new(voronudge_infer::Constraints::default())
        }
    }

    /// The true mean of a quantity in the units of the fit.
    pub fn truth(&self, quantity: FitParameter) -> f64 {
        match quantity {
            FitParameter::AreaElasticity => MEAN.area_elasticity / self.rms,
            FitParameter::PerimeterElasticity => MEAN.perimeter_elasticity / self.rms,
            FitParameter::PreferredPerimeter => MEAN.preferred_perimeter,
            FitParameter::Chirality => MEAN.chirality,
            FitParameter::ChiralCoefficient => MEAN.perimeter_elasticity * MEAN.chirality / self.rms,
        }
    }

    /// Standard deviation over the cells of a parameter, relative to the mean; zero if they do not differ.
    pub fn spread(&self, parameter: CellParameter) -> f64 {
        let own = self.deviations.iter().find(|(known, _)| *known == parameter);
        own.map_or(0.0, |(_, u)| (u.iter().map(|u| u * u).sum::<f64>() / u.len() as f64).sqrt())
    }
}
