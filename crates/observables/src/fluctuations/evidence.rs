//! How unlikely differences are.

use nalgebra::{SMatrix, SVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Probability of N numbers as far from nought by chance, with their covariance from so many samples (Hotelling's T²); NaN if that cannot be told.
pub(super) fn significance<const N: usize>(
    numbers: &SVector<f64, N>,
    covariance: SMatrix<f64, N, N>,
    samples: usize,
) -> f64 {
    let (size, freedom) = (N as f64, samples as f64 - 1.0);
    if freedom < size {
        return f64::NAN;
    }
    let Some(factor) = covariance.cholesky() else { return f64::NAN };
    let square = numbers.dot(&factor.solve(numbers));
    let left = freedom - size + 1.0;
    FisherSnedecor::new(size, left).map_or(f64::NAN, |law| law.sf(square * left / (size * freedom)))
}

/// Probability of independent probabilities that are as small, by Fisher's method; those that cannot be told are left out. `None` of none.
pub fn together(probabilities: impl IntoIterator<Item = f64>) -> Option<f64> {
    let told: Vec<f64> = probabilities.into_iter().filter(|p| p.is_finite()).collect();
    let statistic: f64 = told.iter().map(|p| -2.0 * p.max(1e-300).ln()).sum();
    ChiSquared::new(2.0 * told.len() as f64).ok().map(|law| law.sf(statistic))
}
