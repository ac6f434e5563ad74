//! Does the residual diverge or turn?
//!
//! Around each cell, `u ≈ u₀ + G d` is fitted to the cell and its n − 1 neighbours. With `div = G_xx + G_yy` and
//! `curl = G_yx − G_xy`,
//!
//! ```text
//! |G|² = ½ div² + ½ curl² + ½ [(G_xx − G_yy)² + (G_xy + G_yx)²]
//! ```
//!
//! White noise of variance s² contributes `½ s² tr M⁻¹`, the same again, and twice that, where `M = Σ (d − d̄)(d − d̄)ᵀ`.
//! The noise is taken from what the same fit leaves, `s² = leftover / 2(n − 3)`, and its contribution is subtracted. So
//! the split is that of structure which is smooth over a ring of neighbours; rougher structure counts as noise.
//!
//! Over a periodic box the mean of |G|² is that of `div² + curl²`, so `½ div² : ½ curl²` is the ratio of the curl-free to
//! the divergence-free part of the field (Helmholtz), weighted with the square of the wave number. Pure shear belongs to
//! both or neither, and is given apart.

use super::pool::Pool;
use super::random_signs::{Stream, upper_tail};
use super::{LEVEL, ResidualField};
use nalgebra::Matrix2;
use voronudge_geometry::Vector;

/// Fewest members of a ring, with its cell: one more than a fit with three coefficients needs to leave something.
const FEWEST: usize = 5;
/// A ring as good as on a line determines no gradient: least ratio of the eigenvalues of M.
const FLATTEST: f64 = 0.05;

/// One part of the squared gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Mean over cells of its term in |G|², less what noise contributes, in squared standards per squared length; may be
    /// negative by chance.
    pub power: f64,
    /// The term over the contribution of noise: one, if white.
    pub ratio: f64,
    /// Probability under random signs of at least this ratio.
    pub p: f64,
}

/// The split of the gradient's power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Split {
    /// `½ div²`
    pub divergence: Part,
    /// `½ curl²`
    pub curl: Part,
    /// `½ [(G_xx − G_yy)² + (G_xy + G_yx)²]`
    pub shear: Part,
    /// Shares of divergence and curl in the sum of both; `None` if their sum is not significant at the level of 5 %.
    pub shares: Option<Shares>,
}

/// Shares that add up to one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// The curl-free part.
    pub divergence: f64,
    /// The divergence-free part.
    pub curl: f64,
}

/// Splits residuals into divergence, curl and shear; frames are pooled.
pub fn split(frames: &[ResidualField<'_>], seed: u64) -> Split {
    let pool = Pool::new(frames);
    let rings: Vec<Ring> = frames
        .iter()
        .zip(&pool.starts)
        .flat_map(|(frame, &start)| (0..frame.places.len()).filter_map(move |i| Ring::new(frame, start, i)))
        .collect();
    let count = rings.len().max(1) as f64;
    let least = f64::MIN_POSITIVE + 1e-12 * pool.mean_square();
    // Divergence, curl, shear and noise, each a mean.
    let powers = |signs: &[f64]| -> [f64; 4] {
        let mut sum = [0.0; 4];
        for ring in &rings {
            let gradient = ring.gradient(|j| signs[j] * pool.residuals[j]);
            sum.iter_mut().zip(gradient.powers(ring)).for_each(|(s, p)| *s += p / count);
        }
        sum
    };
    let ratios = |[divergence, curl, shear, noise]: [f64; 4]| {
        let noise = noise.max(least);
        [divergence / noise, curl / noise, 0.5 * shear / noise, 0.5 * (divergence + curl) / noise]
    };
    let [div, curl, shear, both] =
        upper_tail(pool.residuals.len(), seed, Stream::Split, |signs| ratios(powers(signs)));
    let [d, c, s, noise] = powers(&vec![1.0; pool.residuals.len()]);
    let part = |power: f64, (ratio, p): (f64, f64)| Part { power, ratio, p };
    let (divergence, curl) = (part(d - noise, div), part(c - noise, curl));
    let [d, c] = [divergence.power.max(0.0), curl.power.max(0.0)];
    let shares =
        (both.1 < LEVEL && d + c > 0.0).then(|| Shares { divergence: d / (d + c), curl: c / (d + c) });
    Split { divergence, curl, shear: part(s - 2.0 * noise, shear), shares }
}

/// A cell and its neighbours, prepared for the fit.
pub(super) struct Ring {
    /// Each member in the pool and its weight w in `G = Σ u wᵀ`.
    members: Vec<(usize, Vector<f64>)>,
    moments: Matrix2<f64>,
    /// `tr M⁻¹`
    trace: f64,
}

impl Ring {
    /// The ring of datum `i` of a frame whose residuals start at `start` in the pool; `None` if too few or on a line.
    pub fn new(frame: &ResidualField<'_>, start: usize, i: usize) -> Option<Self> {
        let near =
            frame.neighbours[i].iter().map(|&j| (start + j as usize, frame.displacement(i, j as usize)));
        let mut members: Vec<(usize, Vector<f64>)> = near.collect();
        members.push((start + i, Vector::zeros()));
        let middle = members.iter().map(|(_, d)| d).sum::<Vector<f64>>() / members.len() as f64;
        members.iter_mut().for_each(|(_, d)| *d -= middle);
        let moments: Matrix2<f64> = members.iter().map(|(_, d)| d * d.transpose()).sum();
        let inverse = moments.try_inverse()?;
        let flat = moments.determinant() < FLATTEST * (0.5 * moments.trace()).powi(2);
        if members.len() < FEWEST || flat {
            return None;
        }
        members.iter_mut().for_each(|(_, d)| *d = inverse * *d);
        Some(Self { members, moments, trace: inverse.trace() })
    }

    /// The fit to residuals that are given by their number in the pool.
    pub fn gradient(&self, residual: impl Fn(usize) -> Vector<f64>) -> Gradient {
        let (mut matrix, mut sum, mut square) = (Matrix2::zeros(), Vector::zeros(), 0.0);
        for (j, weight) in &self.members {
            let u = residual(*j);
            matrix += u * weight.transpose();
            sum += u;
            square += u.norm_squared();
        }
        let count = self.members.len() as f64;
        let explained = (matrix * self.moments * matrix.transpose()).trace();
        let left = (square - sum.norm_squared() / count - explained).max(0.0);
        Gradient { matrix, variance: left / (2.0 * (count - 3.0)) }
    }
}

/// A fitted gradient.
pub(super) struct Gradient {
    matrix: Matrix2<f64>,
    /// Variance of one component of what is left.
    variance: f64,
}

impl Gradient {
    pub fn divergence(&self) -> f64 {
        self.matrix.trace()
    }

    pub fn curl(&self) -> f64 {
        self.matrix[(1, 0)] - self.matrix[(0, 1)]
    }

    /// Divergence, curl, shear, and the noise in the first or second.
    fn powers(&self, ring: &Ring) -> [f64; 4] {
        let g = &self.matrix;
        let shear = [g[(0, 0)] - g[(1, 1)], g[(0, 1)] + g[(1, 0)]];
        [
            0.5 * self.divergence().powi(2),
            0.5 * self.curl().powi(2),
            0.5 * (shear[0].powi(2) + shear[1].powi(2)),
            0.5 * self.variance * ring.trace,
        ]
    }
}
