//! The scaling of mean square velocities about the transition.

use crate::generator;
use argmin::core::{CostFunction, Error as ArgminError, Executor, State as _};
use argmin::solver::neldermead::NelderMead;
use rand::Rng;
use rayon::prelude::*;
use thiserror::Error;

/// The power of |α| that the paper divides velocities by: `⟨v²⟩/|α|^0.4`.
///
/// It is a matter of convention: `|α|^a |ΔP|^β V(x)` is `|ΔP|^(β + φa) x^a V(x)`, so only φ and β + 0.4 φ can be told from data.
pub const AMPLITUDE_EXPONENT: f64 = 0.4;

/// Simplex steps of one fit.
const MOST_STEPS: u64 = 200;

/// The share of the points that must lie among those of other rows.
const COVERED: f64 = 0.6;

/// The preferred perimeter at which the paper's disordered tissues lose their rigidity, in ℓ₀:
///
/// `P_0*(α) = 3.81 − |α|` for `|α| ≤ 0.2` (the paper, "Phase diagram and dynamical phase transition"; measured, not derived).
///
/// ```
/// assert!((voronudge_simulate::collapse::critical_perimeter(-0.2) - 3.61).abs() < 1e-12);
/// ```
pub fn critical_perimeter(chirality: f64) -> f64 {
    3.81 - chirality.abs()
}

/// A mean square velocity of the phase diagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityPoint {
    /// `P_0` in ℓ₀.
    pub preferred_perimeter: f64,
    /// `α`; points of one chirality are a row.
    pub chirality: f64,
    /// `⟨v²⟩` in (K_P ℓ₀)².
    pub mean_square_velocity: f64,
}

/// The exponents of the scaling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponents {
    /// β, the power of |ΔP|.
    pub beta: f64,
    /// φ, the power of |ΔP| in the argument.
    pub phi: f64,
}

impl Exponents {
    /// Those of the paper.
    pub const PAPER: Self = Self { beta: 3.0, phi: 4.0 };
}

/// A point on the collapse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaledVelocity {
    /// `|α|/|ΔP|^φ`
    pub argument: f64,
    /// `⟨v²⟩/(|α|^0.4 |ΔP|^β)`
    pub value: f64,
    /// `ΔP = P_0 − P_0*(α)`: negative in the solid.
    pub distance: f64,
}

/// Why exponents cannot be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CollapseError {
    /// Too few chiralities.
    #[error("{rows} chiralities with two or more moving points, but a collapse needs at least 3")]
    Rows {
        /// How many there are.
        rows: usize,
    },
    /// The curves do not overlap.
    #[error("scaled curves of different chiralities do not overlap")]
    Apart,
}

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Its interval, from the 2.5th to the 97.5th percentile of the bootstrap.
    pub interval: [f64; 2],
}

/// The exponents that collapse data best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollapseFit {
    /// β.
    pub beta: Interval,
    /// φ.
    pub phi: Interval,
    /// The scatter that is left, see [`collapse_scatter`].
    pub scatter: f64,
}

/// Velocities on the axes of the paper's Widom-like scaling (Extended Data fig. m1E),
///
/// `⟨v²⟩/|α|^0.4 = |ΔP|^β V_±(|α|/|ΔP|^φ)`, `ΔP = P_0 − P_0*(α)`, with one function V on either side of the transition.
///
/// Points at α = 0 or ΔP = 0 have no place on them and come out as infinite or NaN.
///
/// ```
/// use voronudge_simulate::collapse::{Exponents, VelocityPoint, scaled_velocities};
/// let point = VelocityPoint { preferred_perimeter: 4.21, chirality: 0.1, mean_square_velocity: 0.5 };
/// let scaled = scaled_velocities(&[point], Exponents::PAPER)[0];
/// assert!((scaled.distance - 0.5).abs() < 1e-12 && (scaled.argument - 1.6).abs() < 1e-10);
/// ```
pub fn scaled_velocities(points: &[VelocityPoint], exponents: Exponents) -> Vec<ScaledVelocity> {
    let scaled = |point: &VelocityPoint| {
        let (alpha, distance) =
            (point.chirality.abs(), point.preferred_perimeter - critical_perimeter(point.chirality));
        let reach = distance.abs();
        ScaledVelocity {
            argument: alpha / reach.powf(exponents.phi),
            value: point.mean_square_velocity / (alpha.powf(AMPLITUDE_EXPONENT) * reach.powf(exponents.beta)),
            distance,
        }
    };
    points.iter().map(scaled).collect()
}

/// How far scaled points are from one curve: the root mean square of the natural logarithm of the ratio of each point to the
/// curve through the points of the other rows. 0.1 means that points lie within about 10 % of it.
///
/// For each point the logarithms of the two neighbours in argument, in every other row on the same side of the transition, are
/// interpolated linearly, and averaged over these rows (after Houdayer and Hartmann 2004, with equal weights). Points beyond
/// the ends of all other rows are left out.
///
/// # Errors
/// [`CollapseError::Apart`] if these are more than four tenths of all; [`CollapseError::Rows`].
pub fn collapse_scatter(points: &[VelocityPoint], exponents: Exponents) -> Result<f64, CollapseError> {
    let curves = Curves::new(points)?;
    curves.scatter(exponents).ok_or(CollapseError::Apart)
}

/// The exponents with the least [`collapse_scatter`], by the simplex method from a guess, and their intervals from so many
/// bootstrap samples: points drawn with replacement from each row.
///
/// # Errors
/// As [`collapse_scatter`].
pub fn fit_collapse(
    points: &[VelocityPoint],
    guess: Exponents,
    samples: usize,
    seed: u64,
) -> Result<CollapseFit, CollapseError> {
    let curves = Curves::new(points)?;
    let (best, scatter) = curves.fit(guess).ok_or(CollapseError::Apart)?;
    let drawn: Vec<Exponents> = (0..samples as u64)
        .into_par_iter()
        .filter_map(|sample| curves.resampled(seed, sample).fit(best).map(|(found, _)| found))
        .collect();
    let interval = |value: fn(&Exponents) -> f64| {
        let mut values: Vec<f64> = drawn.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = (share * values.len().saturating_sub(1) as f64).round() as usize;
            values.get(place).copied().unwrap_or(f64::NAN)
        };
        Interval { value: value(&best), interval: [at(0.025), at(0.975)] }
    };
    Ok(CollapseFit { beta: interval(|e| e.beta), phi: interval(|e| e.phi), scatter })
}

/// A point in logarithms: of |α|, of |ΔP|, of ⟨v²⟩/|α|^0.4.
type Logarithms = [f64; 3];

/// The rows of the diagram, on both sides of the transition.
struct Curves {
    sides: [Vec<Vec<Logarithms>>; 2],
}

impl Curves {
    fn new(points: &[VelocityPoint]) -> Result<Self, CollapseError> {
        let mut alphas: Vec<f64> = points.iter().map(|point| point.chirality).collect();
        alphas.sort_by(f64::total_cmp);
        alphas.dedup();
        let mut sides = [Vec::new(), Vec::new()];
        for alpha in alphas {
            let row = points.iter().filter(|point| point.chirality == alpha);
            let mut curves = [Vec::new(), Vec::new()];
            for point in row {
                let distance = point.preferred_perimeter - critical_perimeter(alpha);
                let size = alpha.abs().ln();
                let height = point.mean_square_velocity.ln() - AMPLITUDE_EXPONENT * size;
                let logarithms = [size, distance.abs().ln(), height];
                if logarithms.iter().all(|x| x.is_finite()) {
                    curves[usize::from(distance > 0.0)].push(logarithms);
                }
            }
            for (side, mut curve) in sides.iter_mut().zip(curves) {
                curve.sort_by(|a: &Logarithms, b| a[1].total_cmp(&b[1]));
                if curve.len() > 1 {
                    side.push(curve);
                }
            }
        }
        let rows = sides.iter().map(Vec::len).max().unwrap_or(0);
        if rows < 3 { Err(CollapseError::Rows { rows }) } else { Ok(Self { sides }) }
    }

    fn scatter(&self, Exponents { beta, phi }: Exponents) -> Option<f64> {
        let place =
            |[alpha, distance, height]: Logarithms| (alpha - phi * distance, height - beta * distance);
        let (mut squares, mut met, mut all) = (0.0, 0usize, 0usize);
        for side in &self.sides {
            for (own, curve) in side.iter().enumerate() {
                for &point in curve {
                    let (x, y) = place(point);
                    let (mut sum, mut rows) = (0.0, 0.0);
                    for (_, other) in side.iter().enumerate().filter(|(index, _)| *index != own) {
                        if let Some(height) = interpolated(other, x, place) {
                            sum += height;
                            rows += 1.0;
                        }
                    }
                    all += 1;
                    if rows > 0.0 {
                        squares += (y - sum / rows).powi(2);
                        met += 1;
                    }
                }
            }
        }
        let covered = met > 2 && met as f64 >= COVERED * all as f64;
        covered.then(|| (squares / met as f64).sqrt())
    }

    fn fit(&self, guess: Exponents) -> Option<(Exponents, f64)> {
        self.scatter(guess)?;
        let Exponents { beta, phi } = guess;
        let simplex = vec![vec![beta, phi], vec![beta + 0.5, phi], vec![beta, phi + 0.5]];
        let solver = NelderMead::new(simplex).with_sd_tolerance(1e-6).ok()?;
        let found = Executor::new(self, solver).configure(|state| state.max_iters(MOST_STEPS)).run().ok()?;
        let state = found.state();
        let best = state.get_best_param()?;
        Some((Exponents { beta: best[0], phi: best[1] }, state.get_best_cost()))
    }

    /// Points of each row drawn with replacement.
    fn resampled(&self, seed: u64, sample: u64) -> Self {
        let mut rng = generator(crate::seed_of_run(seed, u64::MAX, sample));
        let sides = self.sides.each_ref().map(|side| {
            let rows = side.iter().map(|row| {
                let mut drawn: Vec<Logarithms> =
                    (0..row.len()).map(|_| row[rng.random_range(0..row.len())]).collect();
                drawn.sort_by(|a, b| a[1].total_cmp(&b[1]));
                drawn
            });
            rows.collect()
        });
        Self { sides }
    }
}

/// The height of a curve at an argument; `None` beyond its ends. Arguments fall along a curve for positive φ.
fn interpolated(curve: &[Logarithms], x: f64, place: impl Fn(Logarithms) -> (f64, f64)) -> Option<f64> {
    let pair = curve.windows(2).find(|pair| {
        let ends = [place(pair[0]).0, place(pair[1]).0];
        ends[0].min(ends[1]) <= x && x <= ends[0].max(ends[1]) && ends[0] != ends[1]
    })?;
    let [(x0, y0), (x1, y1)] = [place(pair[0]), place(pair[1])];
    Some(y0 + (x - x0) / (x1 - x0) * (y1 - y0))
}

impl CostFunction for &Curves {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, at: &Vec<f64>) -> Result<f64, ArgminError> {
        let found = self.scatter(Exponents { beta: at[0], phi: at[1] });
        Ok(found.filter(|_| at[1] > 0.1).unwrap_or(1e3))
    }
}
