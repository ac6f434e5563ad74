//! How much is left unknown of where a cell is, and how it crawls, by how it moved before: of each cell by itself.
//!
//! A component p of the polarity is stationary with ⟨p(t) p(t′)⟩ = V exp(−κ|t − t′|). What was seen of it are mean velocities over the intervals before, less
//! what forces did: means of p with errors that neighbouring intervals share, because a position ends one and begins the next,
//!
//! ```text
//! ẑ_s = (1/h_s) ∫ p dt + n_s,    ⟨n_s²⟩ = σ_v² + σ_r² (2/h_s² + g²/2),    ⟨n_s n_{s+1}⟩ = σ_r² (g²/4 − 1/(h_s h_{s+1}))
//! ```
//!
//! Forces are the means of those at both ends, as measured, where errors of positions change each component by gσ_r, g² being the mean square of the rows of ∂F/∂r.
//! What these leave of the variance of p at the end of the last interval is that of linear prediction.

use crate::Error;
use nalgebra::{DMatrix, DVector};

/// (1 − e^{−x})/x
fn faded(x: f64) -> f64 {
    if x < 1e-8 { 1.0 } else { -(-x).exp_m1() / x }
}

/// 2(x − 1 + e^{−x})/x², the variance of a mean over x relaxation times.
fn of_mean(x: f64) -> f64 {
    if x < 1e-3 { 1.0 - x / 3.0 + x * x / 12.0 } else { 2.0 * (x - 1.0 + (-x).exp()) / (x * x) }
}

/// Errors of what was seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    /// σ_v
    pub scatter: f64,
    /// σ_r
    pub position: f64,
    /// g
    pub sensitivity: f64,
}

/// Variance left of a component of variance V that is forgotten at the rate κ, seen over intervals of these lengths that follow each other.
pub(super) fn left_of_polarity(
    (variance, rate): (f64, f64),
    intervals: &[f64],
    noise: Noise,
) -> Result<f64, Error> {
    let count = intervals.len();
    let ends: Vec<f64> = intervals
        .iter()
        .scan(0.0, |end, h| {
            *end += h;
            Some(*end)
        })
        .collect();
    let last = ends.last().copied().unwrap_or(0.0);
    let Noise { scatter, position, sensitivity } = noise;
    let of_forces = (position * sensitivity).powi(2);
    let covariance = DMatrix::from_fn(count, count, |i, j| {
        let (early, late) = (i.min(j), i.max(j));
        let [x, y] = [intervals[early], intervals[late]];
        if i == j {
            return variance * of_mean(rate * x)
                + scatter.powi(2)
                + 2.0 * (position / x).powi(2)
                + 0.5 * of_forces;
        }
        let between = ends[late] - y - ends[early];
        let shared = if late == early + 1 { position.powi(2) / (x * y) - 0.25 * of_forces } else { 0.0 };
        variance * faded(rate * x) * faded(rate * y) * (-rate * between).exp() - shared
    });
    let with_last = DVector::from_fn(count, |i, _| {
        variance * faded(rate * intervals[i]) * (-rate * (last - ends[i])).exp()
    });
    let weights = covariance.cholesky().ok_or(Error::Degenerate)?.solve(&with_last);
    Ok((variance - weights.dot(&with_last)).max(0.0))
}

/// Variance left of a coordinate that was seen at the ends of these intervals, and moves by so much that nothing predicts in each.
pub(super) fn left_of_position(intervals: &[f64], scatter: f64, position: f64) -> f64 {
    let seen = position * position;
    intervals.iter().fold(seen, |left, interval| {
        let before = left + (scatter * interval).powi(2);
        before * seen / (before + seen).max(f64::MIN_POSITIVE)
    })
}
