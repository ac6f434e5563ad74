//! The matrix D(q) of a shell from its lagged covariances.

use super::course::Course;
use super::covariance::{Covariance, Covariances, LAGS};
use super::evidence::significance;
use crate::RateMatrix;
use nalgebra::{Complex, SMatrix, SVector};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::f64::consts::{FRAC_PI_2, PI};

/// Stretches that errors come from are at least so many times of the slowest relaxation.
const APART: f64 = 4.0;

/// Times of the slowest relaxation in a recording without which it says little of that.
const ENOUGH: f64 = 8.0;

/// Stretches of waves without which they tell no errors.
const FEWEST: usize = 6;

/// How waves of a shell relax.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    /// τ in frames.
    pub lag: usize,
    /// D(q) of `∂_t u = −D u` from τ_0 and τ_0 + τ, rows first, in components along q and a quarter turn ahead (1/time).
    pub matrix: [[f64; 2]; 2],
    /// Standard errors of its entries.
    pub standard_errors: [[f64; 2]; 2],
    /// D(q) from τ_0 and τ_0 + 2τ: the same where waves relax linearly and without memory. NaN where that is no propagator, or waves turn by half a turn over 2τ.
    pub twice: [[f64; 2]; 2],
    /// Its standard errors.
    pub twice_errors: [[f64; 2]; 2],
    /// D(q) from lag zero and τ_0 + τ, errors of localisation left in.
    pub uncorrected: [[f64; 2]; 2],
    /// Probability of a difference of the propagator over 2τ from the square of that over τ that is as large, if waves relax linearly and without memory; NaN if it
    /// cannot be told.
    pub linear: f64,
    /// Probability of entries off the diagonal that are as large without chirality.
    pub achiral: f64,
    /// Real parts of the eigenvalues, the slower decay first.
    pub decay_rates: [f64; 2],
    /// Their standard errors.
    pub decay_errors: [f64; 2],
    /// Magnitude of the imaginary parts of the eigenvalues: the angular frequency of odd waves.
    pub frequency: f64,
    /// Its 95 % interval, from that of the discriminant.
    pub frequency_interval: [f64; 2],
    /// Variance that is in C(0) beside what D tells of it, in each component: σ_r² of errors of localisation where displacements are resolved (length²).
    pub noise: f64,
    /// Its standard error.
    pub noise_error: f64,
    /// Stretches of waves that errors come from.
    pub stretches: usize,
    /// Times of the slowest relaxation in a course.
    pub relaxations: f64,
}

impl Relaxation {
    /// Whether there are errors, and eight times of the slowest relaxation or more; of fewer neither errors nor the correction of biases can be relied on.
    pub fn is_reliable(&self) -> bool {
        self.relaxations >= ENOUGH && self.stretches >= FEWEST
    }
}

/// Numbers that are estimated together.
const COUNT: usize = 20;
const TWICE: usize = 4;
const UNCORRECTED: usize = 8;
const DISCRIMINANT: usize = 12;
const DECAY: usize = 13;
const NOISE: usize = 15;
const MEMORY: usize = 16;

/// The relaxation of waves that relax alike, each seen as a whole, from the course of each: amplitudes along q and a quarter turn ahead in each frame, one `interval` (time)
/// after the other. τ_0 is `first_lag` frames. `None` if nothing can be told.
pub fn relaxation_of_waves(
    waves: &[Vec<[Complex<f64>; 2]>],
    first_lag: usize,
    interval: f64,
) -> Option<Relaxation> {
    let course = |field: &Vec<[Complex<f64>; 2]>| {
        [Course { field: field.clone(), density: vec![Complex::ZERO; field.len()] }]
    };
    let courses: Vec<[Course; 1]> = waves.iter().map(course).collect();
    let courses: Vec<&[Course]> = courses.iter().map(<[Course; 1]>::as_slice).collect();
    relaxation(&courses, (first_lag, None), interval, 1.0)
}

/// The relaxation of the waves of a shell, of which the courses are given wave by wave; `dependence` is what standard errors are multiplied by.
pub(super) fn relaxation(
    waves: &[&[Course]],
    (first_lag, lag): (usize, Option<usize>),
    interval: f64,
    dependence: f64,
) -> Option<Relaxation> {
    let frames = waves.first()?.first()?.field.len();
    let lag = match lag {
        Some(lag) => lag,
        None => suited_lag(waves, first_lag, frames),
    };
    let lags = [0, first_lag, first_lag + lag, first_lag + 2 * lag];
    let times = [first_lag, lag].map(|frames| frames as f64 * interval);
    // At first as many stretches as there can be: what the slowest relaxation is does not depend on them.
    let rough = estimate(&Covariance::new(waves, lags, 1).all, times)?;
    let slowest = rough[DECAY].max(0.0);
    let length =
        if slowest > 0.0 { (APART / (slowest * interval)).min(frames as f64) } else { frames as f64 };
    let covariance = Covariance::new(waves, lags, (length as usize).max(2 * lags[LAGS - 1]));
    let whole = estimate(&covariance.all, times)?;
    let missing = [f64::NAN; COUNT];
    let without: Vec<[f64; COUNT]> =
        covariance.without.iter().map(|own| estimate(own, times).unwrap_or(missing)).collect();
    Some(jackknifed(&whole, &without, dependence, lag, slowest * interval * frames as f64))
}

/// The largest power of two frames over which the determinant of the covariance falls to no less than 1/e, half a relaxation time of both waves, and these turn by less than
/// a quarter.
fn suited_lag(waves: &[&[Course]], first_lag: usize, frames: usize) -> usize {
    let most = frames / 8;
    let mut best = 1;
    let mut lag = 1;
    while first_lag + 2 * lag <= most {
        let lags = [0, first_lag, first_lag + lag, first_lag + 2 * lag];
        let Covariances(of) = Covariance::new(waves, lags, frames).all;
        let step = of[1].inverse().and_then(|inverse| RateMatrix::of_propagator(of[2] * inverse, 1.0));
        let slow =
            |step: RateMatrix| step.frequency() < FRAC_PI_2 && step.decay_rates().iter().sum::<f64>() < 1.0;
        if !step.is_some_and(slow) {
            break;
        }
        best = lag;
        lag *= 2;
    }
    best
}

/// All that covariances tell; `None` if they are those of no relaxation. Times are τ_0 and τ.
fn estimate(Covariances(of): &Covariances, [first, time]: [f64; 2]) -> Option<[f64; COUNT]> {
    let inverse = of[1].inverse()?;
    let (once, further) = (of[2] * inverse, of[3] * inverse);
    let matrix = RateMatrix::of_propagator(once, time)?;
    // Beyond half a turn the logarithm is that of another frequency.
    let twice =
        RateMatrix::of_propagator(further, 2.0 * time).filter(|_| 2.0 * time * matrix.frequency() < PI);
    let uncorrected =
        of[0].inverse().and_then(|inverse| RateMatrix::of_propagator(of[2] * inverse, first + time));
    let explained = matrix.propagator(-first) * of[1];
    let excess = of[0] - explained;
    let mut all = [f64::NAN; COUNT];
    let mut put = |from: usize, RateMatrix(rows): RateMatrix| {
        all[from..from + 4].copy_from_slice(rows.as_flattened());
    };
    put(0, matrix);
    put(MEMORY, further - once * once);
    twice.into_iter().for_each(|twice| put(TWICE, twice));
    uncorrected.into_iter().for_each(|own| put(UNCORRECTED, own));
    all[DISCRIMINANT] = matrix.discriminant();
    all[DECAY..DECAY + 2].copy_from_slice(&matrix.decay_rates());
    all[NOISE] = 0.5 * (excess.0[0][0] + excess.0[1][1]);
    all.iter().take(4).all(|entry| entry.is_finite()).then_some(all)
}

/// Estimates corrected for their bias, and their errors, from those without one stretch.
fn jackknifed(
    whole: &[f64; COUNT],
    without: &[[f64; COUNT]],
    dependence: f64,
    lag: usize,
    relaxations: f64,
) -> Relaxation {
    let count = without.len() as f64;
    let mean: [f64; COUNT] = std::array::from_fn(|k| without.iter().map(|own| own[k]).sum::<f64>() / count);
    let value: [f64; COUNT] = std::array::from_fn(|k| {
        let corrected = count * whole[k] - (count - 1.0) * mean[k];
        if corrected.is_finite() { corrected } else { whole[k] }
    });
    let told = if without.len() < FEWEST { f64::NAN } else { 1.0 };
    let scale = told * dependence * dependence * (count - 1.0) / count;
    let covariance = |of: &dyn Fn(&[f64; COUNT]) -> f64, other: &dyn Fn(&[f64; COUNT]) -> f64| {
        let (a, b) = (of(&mean), other(&mean));
        scale * without.iter().map(|own| (of(own) - a) * (other(own) - b)).sum::<f64>()
    };
    let error = |k: usize| covariance(&|own| own[k], &|own| own[k]).sqrt();
    let square =
        |from: usize, of: &dyn Fn(usize) -> f64| [[of(from), of(from + 1)], [of(from + 2), of(from + 3)]];
    let memory = SVector::<f64, 4>::from_fn(|k, _| value[MEMORY + k]);
    let of_memory =
        SMatrix::<f64, 4, 4>::from_fn(|j, k| covariance(&|own| own[MEMORY + j], &|own| own[MEMORY + k]));
    let odd = SVector::<f64, 2>::from_fn(|k, _| value[1 + k]);
    let of_odd = SMatrix::<f64, 2, 2>::from_fn(|j, k| covariance(&|own| own[1 + j], &|own| own[1 + k]));
    let quantile =
        StudentsT::new(0.0, 1.0, (count - 1.0).max(1.0)).map_or(1.96, |law| law.inverse_cdf(0.975));
    let reach = quantile * error(DISCRIMINANT);
    let frequency = |discriminant: f64| (-discriminant).max(0.0).sqrt();
    Relaxation {
        lag,
        matrix: square(0, &|k| value[k]),
        standard_errors: square(0, &error),
        twice: square(TWICE, &|k| value[k]),
        twice_errors: square(TWICE, &error),
        uncorrected: square(UNCORRECTED, &|k| value[k]),
        linear: significance(&memory, of_memory, without.len()),
        achiral: significance(&odd, of_odd, without.len()),
        decay_rates: [value[DECAY], value[DECAY + 1]],
        decay_errors: [error(DECAY), error(DECAY + 1)],
        frequency: frequency(value[DISCRIMINANT]),
        frequency_interval: [frequency(value[DISCRIMINANT] + reach), frequency(value[DISCRIMINANT] - reach)],
        noise: value[NOISE],
        noise_error: error(NOISE),
        stretches: without.len(),
        relaxations,
    }
}
