//! Velocities that nothing explains: what is left of faulty data does not decide a parameter.
//!
//! A velocity is taken for one of a contaminated normal distribution, with a share η of errors that are κ times larger. Its
//! residual is judged as the error of its prediction from all other data: with G = J_i (wJᵀJ + kHᵀH)⁻¹ J_iᵀ,
//!
//! ```text
//! q = r̂ᵀ (1 − wG)⁻¹ (1 + G(1 − wG)⁻¹)⁻¹ (1 − wG)⁻¹ r̂ / σ_v²
//! ```
//!
//! The weight is that of the posterior, `w = 1 − p (1 − κ⁻²)`, with the probability p of a large error; η follows from all
//! velocities together. Where no velocity is more likely faulty than not, the fit stays as it is, and so do its intervals.

mod leverage;

use crate::objective::Objective;
use crate::placing::Placing;
use crate::residuals::residuals;
use crate::{Error, Observation};
use leverage::About;
use nalgebra::Matrix2;
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// κ²: variance of the errors of faulty velocities, in units of that of the others.
const VARIANCE: f64 = 100.0;

/// η lies between one half of a velocity and this share.
const LARGEST_SHARE: f64 = 0.1;

/// Steps of the estimate of η.
const STEPS: usize = 20;

/// Squared residual, in units of σ_v², below which a velocity is sound without looking at its leverage.
const SOUND: f64 = 2.0;

/// Median of χ²₂.
const MEDIAN: f64 = 1.386_294_361_119_890_6;

/// The frames with weights of their velocities about a fit; `None` if they are all sound and already count as that.
pub(crate) fn reweighed(objective: &Objective<'_>, at: &[f64]) -> Result<Option<Vec<Observation>>, Error> {
    let squares: Vec<Vec<(usize, f64)>> = squares(objective, at)?;
    let mut all: Vec<f64> = squares.iter().flatten().map(|(_, square)| *square).collect();
    if all.is_empty() {
        return Ok(None);
    }
    let count = all.len() as f64;
    let middle = all.len() / 2;
    let median = *all.select_nth_unstable_by(middle, f64::total_cmp).1;
    // Where the model misses more than the noise explains, the misfit counts as noise.
    let scale = (median / MEDIAN).max(1.0);
    let fault = |square: f64, share: f64| fault(square / scale, share);
    let mut share = 0.01;
    for _ in 0..STEPS {
        let sum: f64 = all.iter().map(|square| fault(*square, share)).sum();
        share = (sum / count).clamp(0.5 / count, LARGEST_SHARE);
    }
    let any = all.iter().any(|square| fault(*square, share) > 0.5);
    let weighted = objective.frames.iter().any(Observation::is_weighted);
    if !any && !weighted {
        return Ok(None);
    }
    let frames = objective.frames.iter().zip(&squares).map(|(frame, squares)| {
        let mut weights = vec![1.0; frame.velocities.values().len()];
        for (datum, square) in squares {
            weights[*datum] = posterior_weight(*square / scale, share);
        }
        frame.clone().with_weights(weights)
    });
    Ok(Some(frames.collect()))
}

/// How much likelier a large error is than a usual one, by its square in units of the usual variance and the share of large ones.
fn odds(square: f64, share: f64) -> f64 {
    share / (1.0 - share) / VARIANCE * (0.5 * square * (1.0 - 1.0 / VARIANCE)).exp()
}

/// The probability that an error is a large one.
fn fault(square: f64, share: f64) -> f64 {
    let odds = odds(square, share);
    if odds.is_finite() { odds / (1.0 + odds) } else { 1.0 }
}

/// The weight w of a datum of two components whose squared error is so large, in units of the usual variance.
pub(crate) fn posterior_weight(square: f64, share: f64) -> f64 {
    1.0 - fault(square, share) * (1.0 - 1.0 / VARIANCE)
}

/// −2 log of the likelihood of such a datum, less that of none: its derivative by the square is the weight.
pub(crate) fn loss(square: f64, share: f64) -> f64 {
    let (odds, none) = (odds(square, share), odds(0.0, share));
    // Beyond all numbers a large error is certain.
    let logarithm = match odds.is_finite() {
        true => odds.ln_1p(),
        false => none.ln() + 0.5 * square * (1.0 - 1.0 / VARIANCE),
    };
    square - 2.0 * (logarithm - none.ln_1p())
}

/// q of each velocity, by frame.
fn squares(objective: &Objective<'_>, at: &[f64]) -> Result<Vec<Vec<(usize, f64)>>, Error> {
    let (free, nudges) = objective.split(at);
    let coefficients = objective.space.coefficients(free);
    let placed = objective.placed_at(at)?;
    let variance = objective.levels.velocity.powi(2);
    (objective.linear(&placed, at, &[])?.into_par_iter().zip(&placed).zip(&nudges))
        .map(|((linear, (nudged, predicted)), nudges)| {
            let frame = linear.frame;
            let rests = residuals(frame, predicted.as_measured());
            let is_sound = |rest: &Vector<f64>| rest.norm_squared() / variance < SOUND;
            let jacobian = nudged.jacobian(coefficients.as_slice(), &predicted.of_cells);
            let asked: Vec<usize> =
                rests.iter().filter(|(_, rest)| !is_sound(rest)).map(|(datum, _)| *datum).collect();
            let about = About { linear: &linear, jacobian: &jacobian, nudges, spring: objective.spring() };
            let mut leverages = about.leverages(&asked)?.into_iter();
            let mut square = |datum: usize, rest: Vector<f64>| {
                let plain = rest.norm_squared() / variance;
                if is_sound(&rest) {
                    return plain;
                }
                let Some(g) = leverages.next() else { return plain };
                let own = Matrix2::identity() - g * frame.weight(datum);
                let Some(inverse) = own.try_inverse() else { return plain };
                let error = inverse * rest;
                let spread = Matrix2::identity() + g * inverse;
                spread.try_inverse().map_or(plain, |inverse| error.dot(&(inverse * error)) / variance)
            };
            Ok(rests.into_iter().map(|(datum, rest)| (datum, square(datum, rest))).collect())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small errors count as squares, large ones as squares of errors ten times larger, beyond all numbers too.
    #[test]
    fn the_weight_is_the_derivative_of_the_loss() {
        const STEP: f64 = 1e-4;
        assert_eq!(loss(0.0, 0.01), 0.0);
        for square in [0.5, 3.0, 12.0, 18.0, 25.0, 100.0, 1e4] {
            let slope = (loss(square + STEP, 0.01) - loss(square - STEP, 0.01)) / (2.0 * STEP);
            assert!((slope - posterior_weight(square, 0.01)).abs() < 1e-6, "{square}: {slope}");
        }
        assert!((loss(2.0, 0.01) - 2.0).abs() < 2e-3 && posterior_weight(2.0, 0.01) > 0.999);
        let far = loss(1e5, 0.01) - loss(9e4, 0.01);
        assert!((far - 1e4 / VARIANCE).abs() < 1e-6, "{far}");
    }
}
