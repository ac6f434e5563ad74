//! What chance makes of the best of many candidates.

use super::lineup::Projected;
use nalgebra::DVector;
use rand::SeedableRng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Synthetic scores drawn.
const DRAWS: usize = 2000;

/// The distribution of the smallest p of all candidates if the model lacks nothing.
#[derive(Debug, Clone)]
pub(super) struct Chance {
    /// Ascending.
    smallest: Vec<f64>,
    candidates: usize,
}

impl Chance {
    /// Draws the scores of all candidates together, as correlated as their columns are.
    pub fn new(projected: &Projected<'_>, candidates: &[usize], seed: u64) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let gram = &projected.gram;
        let scale: Vec<f64> = gram.diagonal().iter().map(|g| g.max(0.0).sqrt()).collect();
        let eigen = nalgebra::DMatrix::from_fn(gram.nrows(), gram.ncols(), |i, j| {
            let unit = scale[i] * scale[j];
            if unit > 0.0 { gram[(i, j)] / unit } else { 0.0 }
        })
        .symmetric_eigen();
        let rank = eigen.eigenvalues.iter().filter(|e| **e > 1e-9).count() as f64;
        let remainder = ChiSquared::new((projected.left - rank).max(1.0)).ok();
        let root = &eigen.eigenvectors
            * nalgebra::DMatrix::from_diagonal(&eigen.eigenvalues.map(|e| e.max(0.0).sqrt()));
        let variance = projected.rest / projected.left;
        let mut smallest: Vec<f64> = (0..DRAWS)
            .map(|_| {
                let normal = DVector::from_fn(gram.nrows(), |_, _| {
                    let x: f64 = StandardNormal.sample(&mut rng);
                    x
                });
                let within: f64 = (normal.iter().zip(eigen.eigenvalues.iter()))
                    .filter(|(_, e)| **e > 1e-9)
                    .map(|(x, _)| x * x)
                    .sum();
                let rest = within + remainder.map_or(0.0, |chi| chi.sample(&mut rng));
                let unit = projected.variance().unwrap_or(variance);
                let z =
                    (&root * normal).zip_map(&DVector::from_column_slice(&scale), |z, s| z * s * unit.sqrt());
                candidates
                    .iter()
                    .map(|candidate| projected.score_of(*candidate, &z, rest * unit).p)
                    .fold(1.0, f64::min)
            })
            .collect();
        smallest.sort_unstable_by(f64::total_cmp);
        Self { smallest, candidates: candidates.len() }
    }

    /// Probability of so small a p of any candidate.
    pub fn adjusted(&self, p: f64) -> f64 {
        let reached = self.smallest.partition_point(|own| *own <= p);
        let drawn = (reached + 1) as f64 / (self.smallest.len() + 1) as f64;
        // Far out, where no draw has come, the bound of Bonferroni tells more.
        drawn.min(p * self.candidates as f64).clamp(0.0, 1.0)
    }

    /// The p that a single candidate needs for a level.
    pub fn single_p(&self, level: f64) -> f64 {
        let place = (level * self.smallest.len() as f64) as usize;
        self.smallest.get(place).copied().unwrap_or(level).min(level)
    }
}
