//! Tissues and fields for the tests of this folder.

use super::ResidualField;
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, PeriodicBox, Vector};

/// A disordered tissue of `side²` cells of unit area, periodic or cut out.
pub struct Tissue {
    pub places: Vec<Vector<f64>>,
    pub domain: Domain,
}

impl Tissue {
    pub fn periodic(side: u32) -> Self {
        let length = f64::from(side);
        Self { domain: Domain::Periodic(PeriodicBox::new([length, length]).unwrap()), ..Self::open(side) }
    }

    pub fn open(side: u32) -> Self {
        let mut generator = Pcg64::seed_from_u64(u64::from(side));
        let mut jitter = || generator.random_range(-0.25..0.25);
        let places = (0..side * side)
            .map(|i| {
                let row = i / side;
                let x = f64::from(i % side) + 0.5 * f64::from(row % 2) + jitter();
                Vector::new(x, f64::from(row) + jitter())
            })
            .collect();
        Self { places, domain: Domain::Open }
    }

    pub fn field<'a>(&'a self, residuals: &'a [Vector<f64>]) -> ResidualField<'a> {
        ResidualField::new(0, &self.places, residuals, self.domain, 1.0).unwrap()
    }

    pub fn of(&self, field: impl Fn(&Vector<f64>) -> Vector<f64>) -> Vec<Vector<f64>> {
        self.places.iter().map(field).collect()
    }

    /// White noise of unit variance in each component.
    pub fn white(&self, generator: &mut Pcg64) -> Vec<Vector<f64>> {
        self.places.iter().map(|_| noise(generator)).collect()
    }

    /// `L` with `L Lᵀ` the matrix of `exp(−d/length)`, in the plane.
    pub fn root_of_exponential(&self, length: f64) -> DMatrix<f64> {
        let count = self.places.len();
        let covariance =
            DMatrix::from_fn(count, count, |i, j| (-(self.places[i] - self.places[j]).norm() / length).exp());
        covariance.cholesky().unwrap().l()
    }
}

/// A vector of two standard normal numbers.
pub fn noise(generator: &mut Pcg64) -> Vector<f64> {
    Vector::new(StandardNormal.sample(generator), StandardNormal.sample(generator))
}

/// A field with components of unit variance and independent of each other, from a root of its covariance.
pub fn correlated(root: &DMatrix<f64>, generator: &mut Pcg64) -> Vec<Vector<f64>> {
    let white = DMatrix::from_fn(root.nrows(), 2, |_, _| StandardNormal.sample(generator));
    let field = root * white;
    (0..root.nrows()).map(|i| Vector::new(field[(i, 0)], field[(i, 1)])).collect()
}
