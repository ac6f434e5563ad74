//! A small tissue for the tests of this crate.

use crate::objective::Objective;
use crate::{CoefficientSpace, Constraints, Flow, NoiseLevels, Observation, Velocities, Window};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, FieldOfView, Grid, PeriodicBox, Tessellation, Vector, Visibility};
use voronudge_model::{Model, Structure, velocities};

/// Coefficients of the tissue, `(K_A, K_P P_0, K_P, K_P α)`.
pub const COEFFICIENTS: [f64; 4] = [0.1, 4.0, 1.0, 1.5];

/// A periodic tissue of 36 cells with noise on positions and velocities.
pub fn observation(position_noise: f64, velocity_noise: f64, seed: u64) -> Observation {
    observation_of(6, position_noise, velocity_noise, seed)
}

/// The same of any even number of cells along each side.
pub fn observation_of(side: u32, position_noise: f64, velocity_noise: f64, seed: u64) -> Observation {
    let (positions, domain) = cells_of(side);
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    let terms = voronudge_model::base_terms(1.0);
    let model = Model::with_coefficients(&terms, &COEFFICIENTS);
    let v = velocities(&tessellation, &positions, &model);
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut noisy = |v: &Vector<f64>, sigma: f64| {
        let normal = Normal::new(0.0, sigma).unwrap();
        Vector::new(v.x + normal.sample(&mut rng), v.y + normal.sample(&mut rng))
    };
    let measured = positions.iter().map(|r| noisy(r, position_noise)).collect();
    let velocities: Vec<_> = v.iter().map(|v| Some(noisy(v, velocity_noise))).collect();
    Observation::new(0, measured, velocities, domain, FieldOfView::default()).unwrap()
}

/// Hands on the objective of such a tissue, of whose positions a share is that of centroids, and the point of some coefficients and no nudges.
pub fn with_objective(side: u32, share: f64, test: impl FnOnce(&Objective<'_>, &[f64])) {
    let levels = NoiseLevels { position: 0.02, velocity: 0.02 };
    let space = CoefficientSpace::new(&Constraints::default()).unwrap();
    let structure = Structure::base(1.0);
    let frames = [observation_of(side, 0.02, 0.02, 3).with_positions_at(share).unwrap()];
    let objective = Objective::new(&frames, &structure, &space, levels);
    let mut at = vec![0.1, 3.9, 1.0, 1.6];
    at.resize(4 + objective.nudge_count(), 0.0);
    test(&objective, &at);
}

/// Positions of the tissue, without noise.
pub fn cells() -> (Vec<Vector<f64>>, Domain) {
    cells_of(6)
}

fn cells_of(side: u32) -> (Vec<Vector<f64>>, Domain) {
    let positions = (0..side * side)
        .map(|i| {
            let x = f64::from(i);
            let row = f64::from(i / side);
            Vector::new(f64::from(i % side) + 0.5 * (row % 2.0) + 0.2 * x.sin(), row + 0.2 * (2.3 * x).cos())
        })
        .collect();
    (positions, Domain::Periodic(PeriodicBox::new([f64::from(side); 2]).unwrap()))
}

/// The same tissue seen on a grid of unit spacing without noise.
pub fn flow(window: Window) -> Observation {
    let (positions, domain) = cells();
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    let terms = voronudge_model::base_terms(1.0);
    let v = velocities(&tessellation, &positions, &Model::with_coefficients(&terms, &COEFFICIENTS));
    let grid = Grid::new([0.3, 0.4], [1.0, 1.0], [6, 6]).unwrap();
    let empty = Flow { grid, velocities: vec![None; 36], window };
    let visibility = vec![Visibility::Counted; 36];
    let sampling = crate::flow::Sampling::new(&empty, &tessellation, &positions, &visibility);
    let velocities = sampling.average(&v).into_iter().map(Some).collect();
    Observation::new(
        0,
        positions,
        Velocities::OnGrid(Flow { velocities, ..empty }),
        domain,
        FieldOfView::default(),
    )
    .unwrap()
}
