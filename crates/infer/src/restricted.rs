//! How the errors of the measured positions and velocities both follow from one fit.
//!
//! Linearised about the measured positions, the data are `y = Xβ + J u + n` with position errors u and velocity errors
//! n, so `cov y = σ_v² W` with `W = I + JJᵀ/k`. Restricted maximum likelihood is least in
//!
//! ```text
//! −2 log L = (n − p) log σ_v² + log det W + log det XᵀW⁻¹X + yᵀPy / σ_v²,     P = W⁻¹ − W⁻¹X (XᵀW⁻¹X)⁻¹ XᵀW⁻¹
//! ```
//!
//! For given k the best σ_v² is `yᵀPy / (n − p)`, which leaves a function of k alone.

use crate::linearisation::Held;
use crate::noise::{LARGEST_POSITION_NOISE, SMALLEST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE};
use crate::normal_equations::NormalEquations;
use crate::whitened::{Leftover, Whitened};
use crate::{Error, KnownNoise, NoiseLevels};
use rayon::prelude::*;

/// The likelihood is first looked at on three values of log k, this far apart, and moves by at most twice that.
const SPACING: f64 = 1.0;

/// Points through which parabolas are laid at most, beyond these.
const MOST_POINTS: usize = 12;

/// Share of a bracket that a parabola's vertex keeps from its ends.
const INSIDE: f64 = 0.02;

/// Precision of log k.
const PRECISION: f64 = 3e-3;

/// The restricted likelihood of one linearised problem.
pub(crate) struct Restricted<'a> {
    pub equations: &'a NormalEquations,
    pub components: f64,
    pub known: KnownNoise,
    /// What holds the unknowns, if it is not what holds them in the equations.
    pub held: Option<&'a Held>,
}

/// The restricted likelihood at some k.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Likelihood {
    /// −2 log L, up to a constant.
    pub criterion: f64,
    /// σ_v²
    pub variance: f64,
}

impl Restricted<'_> {
    /// The noise levels of greatest restricted likelihood near the present ones, and −2 log L there. They move by no more than the linearisation is
    /// worth: a factor of about e each.
    pub fn most_likely(&self, present: NoiseLevels) -> Result<(NoiseLevels, f64), Error> {
        let at = |log_k: f64| Ok::<_, Error>((log_k, self.likelihood(log_k)?));
        let centre = present.spring().ln();
        let first = [centre - SPACING, centre, centre + SPACING];
        let mut bracket: Vec<(f64, Likelihood)> = first.into_par_iter().map(at).collect::<Result<_, _>>()?;
        // Further to the side that is more likely.
        for side in [0, 2] {
            if least(&bracket) == side {
                let further = at(centre + 2.0 * (side as f64 - 1.0) * SPACING)?;
                bracket.insert(if side == 0 { 0 } else { bracket.len() }, further);
            }
        }
        for _ in 0..MOST_POINTS {
            let best = least(&bracket);
            if best == 0 || best + 1 == bracket.len() {
                break;
            }
            bracket = bracket[best - 1..=best + 1].to_vec();
            let [a, b, c] = [0, 1, 2].map(|k| bracket[k].0);
            let vertex = vertex([0, 1, 2].map(|k| (bracket[k].0, bracket[k].1.criterion)));
            let next = vertex.clamp(a + INSIDE * (c - a), c - INSIDE * (c - a));
            if (next - b).abs() < PRECISION {
                break;
            }
            bracket.insert(if next < b { 1 } else { 2 }, at(next)?);
        }
        let (log_k, likelihood) = bracket[least(&bracket)];
        Ok((self.levels(log_k, &likelihood), likelihood.criterion))
    }

    /// The levels that belong to k, within their limits.
    fn levels(&self, log_k: f64, likelihood: &Likelihood) -> NoiseLevels {
        let root = (0.5 * log_k).exp();
        let velocity = likelihood.variance.sqrt().max(self.known.velocity.unwrap_or(SMALLEST_VELOCITY_NOISE));
        let position = self
            .known
            .position
            .unwrap_or_else(|| (velocity / root).clamp(SMALLEST_POSITION_NOISE, LARGEST_POSITION_NOISE));
        NoiseLevels { position, velocity }
    }

    /// n − p.
    pub fn left(&self) -> f64 {
        (self.components - self.equations.dimension() as f64).max(1.0)
    }

    /// −2 log L, up to a constant.
    pub fn criterion(&self, log_k: f64) -> Result<f64, Error> {
        Ok(self.likelihood(log_k)?.criterion)
    }

    /// The same with the σ_v² that belongs to k.
    pub fn likelihood(&self, log_k: f64) -> Result<Likelihood, Error> {
        Ok(self.of(log_k, self.leftover(log_k)?))
    }

    /// The same of what the best coefficients leave there.
    pub fn of(&self, log_k: f64, leftover: Leftover) -> Likelihood {
        let left = self.left();
        let variance = self.known.variance(log_k).unwrap_or(leftover.misfit / left);
        let criterion = left * variance.ln() + leftover.log_determinant + leftover.misfit / variance;
        Likelihood { criterion, variance }
    }

    fn leftover(&self, log_k: f64) -> Result<Leftover, Error> {
        let frames = self.equations.frames.par_iter();
        let parts = frames
            .map(|frame| match self.held {
                Some(held) => frame.whiten_held(log_k.exp(), held),
                None => frame.whiten(log_k.exp()),
            })
            .collect::<Result<Vec<_>, _>>()?;
        Whitened::sum(&parts, self.equations.dimension()).restricted()
    }
}

/// The most likely of some points.
fn least(points: &[(f64, Likelihood)]) -> usize {
    let criterion = |k: &usize| points[*k].1.criterion;
    (0..points.len()).min_by(|a, b| criterion(a).total_cmp(&criterion(b))).unwrap_or(0)
}

/// Where a parabola through three points is least, the middle one below both others.
fn vertex([(a, fa), (b, fb), (c, fc)]: [(f64, f64); 3]) -> f64 {
    let (left, right) = ((b - a) * (fb - fc), (b - c) * (fb - fa));
    let vertex = b - 0.5 * ((b - a) * left - (b - c) * right) / (left - right);
    if vertex.is_finite() { vertex } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::Objective;
    use crate::residuals::residuals;
    use crate::{CoefficientSpace, Constraints};
    use nalgebra::{DMatrix, DVector};
    use voronudge_model::Structure;

    /// −2 log L with dense matrices, from the definition: the likelihood of the data projected on what no coefficient
    /// can explain.
    #[test]
    fn the_criterion_is_that_of_the_dense_form() {
        let frames = [crate::sample::observation(0.03, 0.05, 1)];
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let structure = Structure::base(1.0);
        let levels = NoiseLevels { position: 0.03, velocity: 0.05 };
        let objective = Objective::new(&frames, &structure, &space, levels);
        let mut at = vec![0.1, 3.9, 1.0, 1.6];
        at.extend((0..72).map(|k| 0.01 * f64::from(k).sin()));
        let equations = objective.linearise(&at).unwrap();
        let (free, nudges) = objective.split(&at);
        let nudged = objective.displaced(0, nudges[0]).unwrap();
        let c = space.coefficients(free);
        let evaluated = nudged.evaluate(c.as_slice());
        let j =
            DMatrix::from_row_slice(72, 72, &nudged.jacobian(c.as_slice(), &evaluated.of_cells).to_dense());
        let x = DMatrix::from_fn(72, 4, |row, term| evaluated.by_coefficient[term][row / 2][row % 2]);
        let residual: Vec<f64> = residuals(&frames[0], &evaluated.predicted)
            .into_iter()
            .flat_map(|(_, rest)| [rest.x, rest.y])
            .collect();
        let y = DVector::from_column_slice(&residual) + &j * DVector::from_column_slice(nudges[0]);
        for known in [
            KnownNoise::default(),
            KnownNoise { position: Some(0.02), velocity: None },
            KnownNoise { position: None, velocity: Some(0.07) },
        ] {
            let restricted = Restricted { equations: &equations, components: 72.0, known, held: None };
            let dense = |log_k: f64| {
                let w = DMatrix::identity(72, 72) + &j * j.transpose() / log_k.exp();
                let inverse = w.clone().try_inverse().unwrap();
                let information = x.transpose() * &inverse * &x;
                let beta = information.clone().try_inverse().unwrap() * x.transpose() * &inverse * &y;
                let rest = &y - &x * beta;
                let misfit = (rest.transpose() * &inverse * &rest).sum();
                let log_det =
                    |m: &DMatrix<f64>| m.clone().symmetric_eigen().eigenvalues.map(|e| e.ln()).sum();
                let variance = match known {
                    KnownNoise { velocity: Some(v), .. } => v * v,
                    KnownNoise { position: Some(r), .. } => r * r * log_k.exp(),
                    _ => misfit / 68.0,
                };
                68.0 * variance.ln() + log_det(&w) + log_det(&information) + misfit / variance
            };
            for log_k in [-3.0, 0.0, 2.5] {
                let (sparse, dense) = (restricted.criterion(log_k).unwrap(), dense(log_k));
                assert!((sparse - dense).abs() < 1e-8 * dense.abs().max(1.0), "{sparse} {dense}");
            }
            // One call moves by a limited step.
            let found = (0..12).fold(levels, |levels, _| restricted.most_likely(levels).unwrap().0);
            let least = restricted.criterion(found.spring().ln()).unwrap();
            for aside in [-0.1, 0.1] {
                assert!(restricted.criterion(found.spring().ln() + aside).unwrap() > least - 1e-6);
            }
            assert!(known.position.is_none_or(|r| r == found.position));
            assert!(known.velocity.is_none_or(|v| v == found.velocity));
        }
    }
}
