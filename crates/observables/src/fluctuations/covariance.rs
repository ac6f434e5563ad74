//! Lagged covariances of the waves of a shell, whole and without a stretch of one wave.

use super::course::Course;
use crate::RateMatrix;
use nalgebra::{Complex, Matrix2, Vector2};
use std::ops::{AddAssign, Sub};

/// Number of lags: 0, τ_0, τ_0 + τ and τ_0 + 2τ.
pub(super) const LAGS: usize = 4;

/// Most stretches that a course is cut into.
const MOST_STRETCHES: usize = 16;

type Pair = Vector2<Complex<f64>>;

/// Sums over the times t of a stretch, of `u(t + τ)`, `u(t)` and `u(t + τ) u(t)†` for each lag τ.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: f64,
    start: Pair,
    later: [Pair; LAGS],
    products: [Matrix2<Complex<f64>>; LAGS],
}

impl Sums {
    /// Takes in the time t.
    fn add(&mut self, field: &[[Complex<f64>; 2]], t: usize, lags: [usize; LAGS]) {
        let start = Pair::from(field[t]);
        let later = lags.map(|lag| Pair::from(field[t + lag]));
        let regular = |pair: &Pair| pair.iter().all(|a| a.re.is_finite() && a.im.is_finite());
        if !regular(&start) || !later.iter().all(regular) {
            return;
        }
        self.count += 1.0;
        self.start += start;
        for (lag, later) in later.into_iter().enumerate() {
            self.later[lag] += later;
            self.products[lag] += later * start.adjoint();
        }
    }

    /// Those of both, or without the other.
    fn combined(mut self, other: &Self, sign: f64) -> Self {
        self.count += sign * other.count;
        let sign = Complex::from(sign);
        self.start += other.start * sign;
        for lag in 0..LAGS {
            self.later[lag] += other.later[lag] * sign;
            self.products[lag] += other.products[lag] * sign;
        }
        self
    }

    /// Sums of products of deviations from the means of the course: the real part, because q and −q are as likely.
    fn deviations(&self) -> Deviations {
        if self.count < 2.0 {
            return Deviations::NONE;
        }
        let of_lag = |lag: usize| {
            let entry = |a: usize, b: usize| {
                (self.products[lag][(a, b)] - self.later[lag][a] * self.start[b].conj() / self.count).re
            };
            RateMatrix([[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]])
        };
        Deviations { count: self.count, products: std::array::from_fn(of_lag) }
    }
}

/// Products of deviations, summed over times and waves.
#[derive(Debug, Clone, Copy)]
struct Deviations {
    count: f64,
    products: [RateMatrix; LAGS],
}

impl Deviations {
    const NONE: Self = Self { count: 0.0, products: [RateMatrix::ZERO; LAGS] };

    fn covariances(&self) -> Covariances {
        Covariances(self.products.map(|product| product * (1.0 / self.count)))
    }
}

impl AddAssign for Deviations {
    fn add_assign(&mut self, other: Self) {
        self.count += other.count;
        for (own, other) in self.products.iter_mut().zip(other.products) {
            *own = *own + other;
        }
    }
}

impl Sub for Deviations {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        let products = std::array::from_fn(|lag| self.products[lag] - other.products[lag]);
        Self { count: self.count - other.count, products }
    }
}

/// Real covariances `C(τ)` of a shell at the lags.
#[derive(Debug, Clone, Copy)]
pub(super) struct Covariances(pub [RateMatrix; LAGS]);

/// Covariances of a shell, and what they are without one stretch of one wave, of all stretches and waves in turn.
pub(super) struct Covariance {
    pub all: Covariances,
    pub without: Vec<Covariances>,
}

impl Covariance {
    /// Of the courses of each wave, cut into stretches that have `length` frames at least.
    pub fn new(waves: &[&[Course]], lags: [usize; LAGS], length: usize) -> Self {
        let frames = waves.first().and_then(|own| own.first()).map_or(0, |course| course.field.len());
        let starts = frames.saturating_sub(lags[LAGS - 1]);
        let stretches = (starts / length.max(1)).clamp(2, MOST_STRETCHES);
        let of_course = |course: &Course| -> (Sums, Vec<Sums>) {
            let mut parts = vec![Sums::default(); stretches];
            for t in 0..starts {
                parts[t * stretches / starts].add(&course.field, t, lags);
            }
            (parts.iter().fold(Sums::default(), |sum, part| sum.combined(part, 1.0)), parts)
        };
        let of_wave = |courses: &&[Course]| -> (Deviations, Vec<Deviations>) {
            let mut whole = Deviations::NONE;
            let mut without = vec![Deviations::NONE; stretches];
            for course in *courses {
                let (sums, parts) = of_course(course);
                whole += sums.deviations();
                for (without, part) in without.iter_mut().zip(&parts) {
                    *without += sums.combined(part, -1.0).deviations();
                }
            }
            (whole, without)
        };
        let each: Vec<(Deviations, Vec<Deviations>)> = waves.iter().map(of_wave).collect();
        let mut total = Deviations::NONE;
        each.iter().for_each(|(whole, _)| total += *whole);
        let without = each.iter().flat_map(|(whole, without)| {
            let rest = total - *whole;
            without.iter().map(move |own| {
                let mut sum = rest;
                sum += *own;
                sum.covariances()
            })
        });
        Self { all: total.covariances(), without: without.collect() }
    }
}
