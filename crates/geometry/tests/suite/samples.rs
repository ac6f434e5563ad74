//! Positions to tessellate.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{Domain, Error, PeriodicBox, Vector};

/// Independent cells, anywhere in a rectangle.
pub fn random(cells: usize, lengths: [f64; 2], seed: u64) -> Vec<Vector<f64>> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    (0..cells)
        .map(|_| Vector::new(rng.random_range(0.0..lengths[0]), rng.random_range(0.0..lengths[1])))
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

/// A square lattice at unit density: four cells meet at every vertex.
pub fn squares(columns: usize, rows: usize) -> Vec<Vector<f64>> {
    (0..columns * rows).map(|i| Vector::new((i % columns) as f64, (i / columns) as f64)).collect()
}

/// A rectangular periodic box.
pub fn periodic(lengths: [f64; 2]) -> Result<Domain, Error> {
    PeriodicBox::new(lengths).map(Domain::Periodic)
}

/// A sheared periodic box.
pub fn sheared(lengths: [f64; 2], offset: f64) -> Result<Domain, Error> {
    PeriodicBox::sheared(lengths, offset).map(Domain::Periodic)
}

/// The largest difference between two lists.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
