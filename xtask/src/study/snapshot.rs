//! Noisy snapshots of a chiral liquid whose truth is known.

use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_infer::{Constraints, KnownNoise, Observation, Quantity, Request};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{RandomPlacement, Simulation, generator};

/// What the snapshots are made with.
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
    pub position: f64,
    pub velocity: f64,
}

/// A periodic tissue in its steady state, velocities in units of their root mean square.
pub struct Snapshot {
    /// Positions without noise (N).
    pub positions: Vec<Vector<f64>>,
    /// As measured.
    pub measured: Observation,
    /// Without noise.
    pub exact: Observation,
    /// Root mean square velocity in units of K_P ℓ₀: the coefficients of the fit times this are those of the model.
    pub rms: f64,
    edges: Vec<(u32, u32, [i16; 2])>,
}

impl Snapshot {
    /// Simulates for t = 10 from a random placement, and adds Gaussian noise.
    pub fn new(cells: usize, seed: u64, noise: Noise) -> Result<Self, Box<dyn std::error::Error>> {
        let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2])?;
        let domain = Domain::Periodic(cell_box);
        let start = RandomPlacement::new(cells, cell_box).draw(&mut generator(1000 + seed))?;
        let mut simulation = Simulation::new(start, domain, Model::chiral_voronoi(&TRUTH))?;
        for _ in 0..2000 {
            simulation.step(0.005)?;
        }
        let mut rng = Pcg64::seed_from_u64(2000 + seed);
        let mut noisy = |v: Vector<f64>, normal: Normal<f64>| {
            Vector::new(v.x + normal.sample(&mut rng), v.y + normal.sample(&mut rng))
        };
        let (r, v) = (simulation.positions(), simulation.velocities());
        let rms = (v.iter().map(|v| v.norm_squared()).sum::<f64>() / cells as f64).sqrt();
        let (on_r, on_v) = (Normal::new(0.0, noise.position)?, Normal::new(0.0, noise.velocity)?);
        let positions = r.iter().map(|r| noisy(*r, on_r)).collect();
        let velocities: Vec<_> = v.iter().map(|v| Some(noisy(v / rms, on_v))).collect();
        let exact: Vec<_> = v.iter().map(|v| Some(v / rms)).collect();
        Ok(Self {
            positions: r.to_vec(),
            exact: Observation::new(0, r.to_vec(), exact, domain, 3.0)?,
            edges: Tessellation::new(r, domain)?.edges(),
            measured: Observation::new(0, positions, velocities, domain, 3.0)?,
            rms,
        })
    }

    /// A fit with K_A held at its true value.
    pub fn request(&self, noise: KnownNoise) -> Request {
        let k_a = TRUTH.area_elasticity / self.rms;
        Request { noise, ..Request::new(Constraints::fixed([(Quantity::AreaElasticity, k_a)])) }
    }

    /// The true value of a quantity in the units of the fit.
    pub fn truth(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::AreaElasticity => TRUTH.area_elasticity / self.rms,
            Quantity::PerimeterElasticity => TRUTH.perimeter_elasticity / self.rms,
            Quantity::PreferredPerimeter => TRUTH.preferred_perimeter,
            Quantity::Chirality => TRUTH.chirality,
            Quantity::ChiralCoefficient => TRUTH.perimeter_elasticity * TRUTH.chirality / self.rms,
        }
    }

    /// Delaunay edges that the true positions do not have.
    pub fn wrong_edges(&self, tessellation: &Tessellation) -> usize {
        tessellation.edges().iter().filter(|edge| self.edges.binary_search(edge).is_err()).count()
    }

    /// True edges that are missing although their Voronoi side is longer than some length.
    pub fn lost_sides(&self, tessellation: &Tessellation, longer_than: f64) -> usize {
        let found = tessellation.edges();
        let exact = &self.exact.tessellation;
        (0..exact.len())
            .flat_map(|cell| exact.ring(cell).map(move |h| (cell, h)))
            .filter_map(|(cell, h)| {
                voronudge_geometry::Side::new(exact, &self.positions, cell, h).map(|side| (h, side))
            })
            .filter(|(h, side)| *h < exact.twin(*h) && side.length > longer_than)
            .filter(|(h, side)| {
                let (from, to, image) = (side.cells[0] as u32, side.cells[1] as u32, exact.image(*h));
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

/// Quartiles of some numbers: lower, median, upper. NaN of none.
pub fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|p| {
        let Some(last) = values.len().checked_sub(1) else {
            return f64::NAN;
        };
        let at = p * last as f64;
        let low = at.floor() as usize;
        values[low] + at.fract() * (values[(low + 1).min(last)] - values[low])
    })
}

/// Runs a task for each seed, one thread per seed and none within, so that times are those of one core.
pub fn on_one_core_each<R: Send>(
    seeds: u64,
    task: impl Fn(u64) -> Result<R, Box<dyn std::error::Error>> + Sync,
) -> Result<Vec<R>, Box<dyn std::error::Error>> {
    let next = std::sync::atomic::AtomicU64::new(0);
    let results = std::sync::Mutex::new(Vec::new());
    let work = || -> Result<(), String> {
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|error| error.to_string())?;
        loop {
            let seed = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if seed >= seeds {
                return Ok(());
            }
            let result = pool.install(|| task(seed).map_err(|error| error.to_string()))?;
            results.lock().map_err(|_| "a thread failed")?.push((seed, result));
        }
    };
    let threads = std::thread::available_parallelism()?.get();
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .try_for_each(|handle| handle.join().unwrap_or_else(|_| Err("a thread failed".into())))
    })?;
    let mut results = results.into_inner().map_err(|_| "a thread failed")?;
    results.sort_by_key(|(seed, _)| *seed);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}
