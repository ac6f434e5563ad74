//! Tissues to check.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{Domain, Error, PeriodicBox, Vector};
use voronudge_model::Parameters;

/// A tissue: positions and their boundary.
pub type Tissue = (Vec<Vector<f64>>, Domain);

/// Independent cells, anywhere in a rectangle.
pub fn random(cells: usize, lengths: [f64; 2], seed: u64) -> Vec<Vector<f64>> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    (0..cells)
        .map(|_| Vector::new(rng.random_range(0.0..lengths[0]), rng.random_range(0.0..lengths[1])))
        .collect()
}

/// A square lattice at unit density, each coordinate displaced by up to `jitter`.
pub fn jittered(columns: usize, rows: usize, jitter: f64, seed: u64) -> Vec<Vector<f64>> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    (0..columns * rows)
        .map(|i| {
            let mut shift = || if jitter > 0.0 { rng.random_range(-jitter..jitter) } else { 0.0 };
            Vector::new((i % columns) as f64 + shift(), (i / columns) as f64 + shift())
        })
        .collect()
}

/// A triangular lattice at unit density, rows along x, with its box. The number of rows is even.
pub fn honeycomb(columns: usize, rows: usize) -> (Vec<Vector<f64>>, [f64; 2]) {
    let a = (2.0 / 3f64.sqrt()).sqrt();
    let height = a * 3f64.sqrt() / 2.0;
    let positions = (0..columns * rows)
        .map(|i| {
            let (column, row) = (i % columns, i / columns);
            Vector::new((column as f64 + 0.5 * (row % 2) as f64) * a, row as f64 * height)
        })
        .collect();
    (positions, [columns as f64 * a, rows as f64 * height])
}

/// A rectangular periodic box.
pub fn periodic(lengths: [f64; 2]) -> Result<Domain, Error> {
    PeriodicBox::new(lengths).map(Domain::Periodic)
}

/// A sheared periodic box.
pub fn sheared(lengths: [f64; 2], offset: f64) -> Result<Domain, Error> {
    PeriodicBox::sheared(lengths, offset).map(Domain::Periodic)
}

/// A parameter set in which no coefficient is like another.
pub fn parameters() -> Parameters<f64> {
    Parameters {
        area_elasticity: 0.37,
        perimeter_elasticity: 1.21,
        preferred_perimeter: 3.68,
        preferred_area: 1.0,
        chirality: -0.83,
    }
}

/// The largest difference between two fields.
pub fn difference(a: &[Vector<f64>], b: &[Vector<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max)
}

/// The largest component of a field.
pub fn largest(field: &[Vector<f64>]) -> f64 {
    field.iter().map(|v| v.amax()).fold(0.0, f64::max)
}
