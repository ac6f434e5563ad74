//! Do few residuals stand out?
//!
//! For normal residuals the mean of `|u|²/2` estimates σ², and so do its n/2 smallest values alone, which few wrong data cannot
//! move. Their ratio is 1 ± n^(−1/2): the variances of the two are σ⁴/n and 2σ⁴/n, and the first is efficient.

use crate::diagnostics::robust_variance;

/// Standard deviations by which the ratio may exceed one. It is skewed and the residuals of a fit are not quite normal, so that
/// the three of a level of 0.001 would be too few.
const DEVIATIONS: f64 = 4.5;

/// A ratio below this is of no consequence.
const LEAST: f64 = 1.25;

/// By how much the scatter of all halved squared residuals exceeds that of the smaller half, where this is no chance.
pub(crate) fn tails(halved_squares: &[f64]) -> Option<f64> {
    let (robust, _) = robust_variance(halved_squares)?;
    let count = halved_squares.len() as f64;
    let ratio = halved_squares.iter().sum::<f64>() / count / robust;
    (ratio > LEAST.max(1.0 + DEVIATIONS / count.sqrt())).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_distr::{Distribution, Exp1};
    use rand_pcg::Pcg64;

    /// Halved squares of normal vectors are exponential; some are those of residuals four times as large.
    fn drawn(count: usize, wrong: f64, seed: u64) -> Vec<f64> {
        let mut generator = Pcg64::seed_from_u64(seed);
        let mut draw = |_| {
            let x: f64 = Exp1.sample(&mut generator);
            if generator.random::<f64>() < wrong { 16.0 * x } else { x }
        };
        (0..count).map(&mut draw).collect()
    }

    #[test]
    fn normal_residuals_seldom_have_tails_and_mixed_ones_do() {
        let alarms = |count, wrong| (0..2000).filter(|s| tails(&drawn(count, wrong, *s)).is_some()).count();
        for count in [40, 100, 400] {
            let (null, mixed) = (alarms(count, 0.0), alarms(count, 0.1));
            assert!(null <= 12, "{count}: {null} of 2000 without a fault");
            assert!(count < 100 || mixed > 1800, "{count}: {mixed} of 2000 with faults");
        }
    }
}
