//! A chiral liquid whose truth is known, measured with noise: what the claims in `claims/` and the studies of the
//! project are made with.

pub mod channel;
pub mod differing;
pub mod measured;

use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use std::error::Error;
use voronudge_geometry::{Domain, FieldOfView, Grid, PeriodicBox, Side, Tessellation, Vector};
use voronudge_infer::{
    Constraints, CrossValidation, FitParameter, Flow, KnownNoise, Observation, Request, Velocities, Window,
    WindowKind,
};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{RandomPlacement, Simulation, generator};

/// What the tissues are made with.
pub const TRUTH: Parameters<f64> = Parameters {
    area_elasticity: 0.1,
    perimeter_elasticity: 1.0,
    preferred_perimeter: 4.0,
    preferred_area: 1.0,
    chirality: 3.4,
};

/// Errors of one component: of positions in units of ℓ₀, of velocities in units of their root mean square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// σ_r
    pub position: f64,
    /// σ_v
    pub velocity: f64,
}

impl Noise {
    /// As what a fit is told.
    pub fn known(self) -> KnownNoise {
        KnownNoise { position: Some(self.position), velocity: Some(self.velocity) }
    }
}

/// A periodic tissue of unit cells in its steady state, velocities in units of their root mean square.
#[derive(Debug, Clone)]
pub struct Tissue {
    /// Positions (N).
    pub positions: Vec<Vector<f64>>,
    /// Velocities (N).
    pub velocities: Vec<Vector<f64>>,
    /// Tessellation of the positions.
    pub tessellation: Tessellation,
    /// Root mean square velocity in units of K_P ℓ₀: the coefficients of a fit times this are those of the model.
    pub rms: f64,
    edges: Vec<(u32, u32, [i16; 2])>,
}

impl Tissue {
    /// Simulates for t = 10 from a random placement.
    ///
    /// # Errors
    /// Those of the placement and the simulation.
    pub fn new(cells: usize, seed: u64) -> Result<Self, Box<dyn Error>> {
        Self::of(&steady(cells, seed)?)
    }

    /// The same tissue at several times, these far apart, velocities in units of their common root mean square.
    ///
    /// # Errors
    /// Those of the placement and the simulation.
    pub fn trajectory(
        cells: usize,
        seed: u64,
        times: usize,
        interval: f64,
    ) -> Result<Vec<Self>, Box<dyn Error>> {
        let mut simulation = steady(cells, seed)?;
        let mut all = Vec::with_capacity(times);
        for time in 0..times {
            if time > 0 {
                advance(&mut simulation, interval)?;
            }
            all.push(Self::of(&simulation)?);
        }
        let squares: f64 = all.iter().map(|tissue| tissue.rms.powi(2)).sum();
        let common = (squares / times as f64).sqrt();
        Ok(all.into_iter().map(|tissue| tissue.in_units_of(common)).collect())
    }

    fn of(simulation: &Simulation) -> Result<Self, Box<dyn Error>> {
        let positions = simulation.positions().to_vec();
        let tessellation = Tessellation::new(&positions, simulation.tessellation().domain())?;
        let velocities = simulation.velocities().to_vec();
        let own = Self { edges: tessellation.edges(), positions, velocities, tessellation, rms: 1.0 };
        Ok(own.normalised())
    }

    /// The same cells with other velocities, given in the units of these.
    #[must_use]
    pub fn moving(&self, velocities: Vec<Vector<f64>>) -> Self {
        Self { velocities, ..self.clone() }.normalised()
    }

    fn normalised(self) -> Self {
        let squares: f64 = self.velocities.iter().map(Vector::norm_squared).sum();
        let unit = self.rms * (squares / self.velocities.len() as f64).sqrt();
        self.in_units_of(unit)
    }

    fn in_units_of(mut self, rms: f64) -> Self {
        self.velocities.iter_mut().for_each(|v| *v = *v * self.rms / rms);
        Self { rms, ..self }
    }

    /// What would be measured of each cell, with Gaussian noise on every component.
    ///
    /// # Errors
    /// If two cells come to lie on each other.
    pub fn measured(&self, noise: Noise, seed: u64) -> Result<Observation, Box<dyn Error>> {
        let mut noisy = noisy(seed);
        let positions = noisy(&self.positions, noise.position)?;
        let velocities: Vec<_> = noisy(&self.velocities, noise.velocity)?.into_iter().map(Some).collect();
        Ok(Observation::new(0, positions, velocities, self.tessellation.domain(), FieldOfView::default())?)
    }

    /// What optical flow would measure on a grid: averages over squares in which every point moves with the cell whose
    /// centre is nearest, from 20 × 20 points of each.
    ///
    /// # Errors
    /// If two cells come to lie on each other.
    pub fn on_grid(&self, spacing: f64, noise: Noise, seed: u64) -> Result<Observation, Box<dyn Error>> {
        const POINTS: usize = 20;
        let domain = self.tessellation.domain();
        let side = (self.positions.len() as f64).sqrt();
        let size = (side / spacing).floor() as usize;
        let grid = Grid::new([0.5 * spacing; 2], [spacing; 2], [size, size])?;
        let nearest = |point: Vector<f64>| {
            let distance = |cell: &usize| domain.shortest(point - self.positions[*cell]).norm_squared();
            (0..self.positions.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        let averages: Vec<Vector<f64>> = (0..grid.len())
            .map(|square| {
                let offset = |k: usize| ((k as f64 + 0.5) / POINTS as f64 - 0.5) * spacing;
                let points =
                    (0..POINTS * POINTS).map(|k| Vector::new(offset(k % POINTS), offset(k / POINTS)));
                let sum: Vector<f64> =
                    points.map(|offset| self.velocities[nearest(grid.centre(square) + offset)]).sum();
                sum / (POINTS * POINTS) as f64
            })
            .collect();
        let mut noisy = noisy(seed);
        let positions = noisy(&self.positions, noise.position)?;
        let velocities = noisy(&averages, noise.velocity)?.into_iter().map(Some).collect();
        let flow = Flow { grid, velocities, window: Window { kind: WindowKind::Square, width: spacing } };
        Ok(Observation::new(0, positions, Velocities::OnGrid(flow), domain, FieldOfView::default())?)
    }

    /// A fit with K_A held at its true value, without cross-validation.
    pub fn request(&self, noise: KnownNoise) -> Request {
        let constraints =
            Constraints::fixed([(FitParameter::AreaElasticity, self.truth(FitParameter::AreaElasticity))]);
        Request { noise, cross_validation: CrossValidation::Skipped, ..Request::new(constraints) }
    }

    /// The true value of a quantity in the units of the fit.
    pub fn truth(&self, quantity: FitParameter) -> f64 {
        match quantity {
            FitParameter::AreaElasticity => TRUTH.area_elasticity / self.rms,
            FitParameter::PerimeterElasticity => TRUTH.perimeter_elasticity / self.rms,
            FitParameter::PreferredPerimeter => TRUTH.preferred_perimeter,
            FitParameter::Chirality => TRUTH.chirality,
            FitParameter::ChiralCoefficient => TRUTH.perimeter_elasticity * TRUTH.chirality / self.rms,
        }
    }

    /// Delaunay edges that the tissue does not have.
    pub fn wrong_edges(&self, tessellation: &Tessellation) -> usize {
        tessellation.edges().iter().filter(|edge| self.edges.binary_search(edge).is_err()).count()
    }

    /// Edges of the tissue that are missing although their Voronoi side is longer than some length.
    pub fn lost_sides(&self, tessellation: &Tessellation, longer_than: f64) -> usize {
        let (own, found) = (&self.tessellation, tessellation.edges());
        let sides = (0..own.len()).flat_map(|cell| own.ring(cell).map(move |h| (cell, h)));
        sides
            .filter_map(|(cell, h)| Some((h, Side::new(own, &self.positions, cell, h)?)))
            .filter(|(h, side)| *h < own.twin(*h) && side.length > longer_than)
            .filter(|(h, side)| {
                let (from, to, image) = (side.cells[0] as u32, side.cells[1] as u32, own.image(*h));
                let edge = if from <= to { (from, to, image) } else { (to, from, [-image[0], -image[1]]) };
                found.binary_search(&edge).is_err()
            })
            .count()
    }

    /// Root mean square distance per cell from the true positions.
    pub fn position_error(&self, positions: &[Vector<f64>]) -> f64 {
        let squares: f64 = positions.iter().zip(&self.positions).map(|(a, b)| (a - b).norm_squared()).sum();
        (squares / positions.len() as f64).sqrt()
    }
}

/// A tissue that has come to its steady state.
fn steady(cells: usize, seed: u64) -> Result<Simulation, Box<dyn Error>> {
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2])?;
    let start = RandomPlacement::new(cells, cell_box).draw(&mut generator(1000 + seed))?;
    let mut simulation = Simulation::new(start, Domain::Periodic(cell_box), Model::chiral_voronoi(&TRUTH))?;
    advance(&mut simulation, 10.0)?;
    Ok(simulation)
}

fn advance(simulation: &mut Simulation, time: f64) -> Result<(), Box<dyn Error>> {
    const STEP: f64 = 0.005;
    for _ in 0..(time / STEP).round() as usize {
        simulation.step(STEP)?;
    }
    Ok(())
}

/// Adds Gaussian noise to one field after another.
fn noisy(seed: u64) -> impl FnMut(&[Vector<f64>], f64) -> Result<Vec<Vector<f64>>, rand_distr::NormalError> {
    let mut rng = Pcg64::seed_from_u64(2000 + seed);
    move |field, sigma| {
        let normal = Normal::new(0.0, sigma)?;
        Ok(field.iter().map(|v| v + Vector::new(normal.sample(&mut rng), normal.sample(&mut rng))).collect())
    }
}
