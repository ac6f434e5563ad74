//! The law by which velocities are judged while detections are in doubt, and coefficients that no small part of the data
//! decides.
//!
//! Residuals have a Student distribution of two components at a fixed scale,
//!
//! ```text
//! −2 log p(r) = 2 log s² + (ν + 2) log(1 + r²/(ν s²)),     s² = c² (σ_v² + ½ σ_r² Σ_j ‖J_j‖²),     ν = 4
//! ```
//!
//! so that velocities around a cell that was not detected count little. A scale estimated anew each time would hide them.

use crate::normal_matrix::{invert, within_bounds};
use crate::objective::Nudged;
use crate::residuals::{free_rows, residuals};
use crate::{CoefficientSpace, Error, NoiseLevels, Observation};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;
use voronudge_model::{BlockMatrix, Structure};

/// Degrees of freedom of the errors' distribution.
pub(super) const FREEDOM: f64 = 4.0;

/// Rounds in which the scale of each residual follows the coefficients, and steps in each.
const ROUNDS: usize = 3;
const STEPS: usize = 12;

/// Change of a coefficient that counts as none.
const SETTLED: f64 = 1e-4;

/// Variance of a residual, in units of the mean square velocity, while nothing is known of it.
const FIRST_VARIANCE: f64 = 0.05;

/// Share of the smallest residuals that tell the scale, and the quantile of χ²₂ that they end at.
const SMALLEST: f64 = 0.1;
const QUANTILE: f64 = 0.210_721_031_315_652_6;

/// The law by which velocities are judged.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law<'a> {
    pub structure: &'a Structure,
    pub coefficients: &'a [f64],
    pub levels: NoiseLevels,
    /// c²: variance of residuals in units of what the noise levels lead to expect.
    pub excess: f64,
}

/// One velocity as a law sees it.
pub(super) struct Judged {
    pub datum: usize,
    pub predicted: Vector<f64>,
    pub residual: Vector<f64>,
    /// Variance of a component.
    pub variance: f64,
}

/// Minus twice the log density of a residual, but for a constant.
pub(super) fn deviance(square: f64, variance: f64) -> f64 {
    2.0 * variance.ln() + (FREEDOM + 2.0) * (square / variance / FREEDOM).ln_1p()
}

/// The weight of a residual in least squares.
fn weight(square: f64, variance: f64) -> f64 {
    (FREEDOM + 2.0) / (FREEDOM + square / variance) / variance
}

impl Law<'_> {
    /// Variance of a component of one velocity, with the variance `(σ_i/σ_r)²` of each cell's position.
    pub fn variance(
        &self,
        jacobian: &BlockMatrix,
        datum: usize,
        of_cell: impl Fn(usize) -> Option<f64>,
    ) -> f64 {
        let sum: f64 = jacobian
            .row(datum)
            .filter_map(|(cell, b)| Some(of_cell(cell)? * b.iter().map(|x| x * x).sum::<f64>()))
            .sum();
        self.excess * (self.levels.velocity.powi(2) + 0.5 * sum * self.levels.position.powi(2))
    }

    /// σ_v². What is left beyond the noise levels is in both errors; where less is left than they say, positions are better.
    pub fn velocity_variance(&self) -> f64 {
        self.excess.max(1.0) * self.levels.velocity.powi(2)
    }

    /// σ_r²
    pub fn position_variance(&self) -> f64 {
        self.excess * self.levels.position.powi(2)
    }

    /// All velocities of a frame that count.
    pub fn judge(&self, frame: &Observation) -> Vec<Judged> {
        let nudged = Nudged::as_measured(frame, self.structure);
        let evaluated = nudged.evaluate(self.coefficients);
        let jacobian = nudged.jacobian(self.coefficients, &evaluated.of_cells);
        let of_cell = |cell: usize| Some(frame.stiffness(cell)).filter(|m| *m > 0.0).map(f64::recip);
        residuals(frame, &evaluated.predicted)
            .into_iter()
            .map(|(datum, residual)| Judged {
                datum,
                predicted: evaluated.predicted[datum],
                residual,
                variance: self.variance(&jacobian, datum, of_cell),
            })
            .collect()
    }

    /// c² such that the smallest residuals are as small as expected: a few per cent of missing cells spoil half of all
    /// velocities, but not those.
    pub fn excess(&self, frames: &[&Observation]) -> f64 {
        let plain = Law { excess: 1.0, ..*self };
        let mut squares: Vec<f64> = frames
            .iter()
            .flat_map(|frame| plain.judge(frame))
            .map(|row| row.residual.norm_squared() / row.variance)
            .collect();
        squares.sort_unstable_by(f64::total_cmp);
        squares.get((SMALLEST * squares.len() as f64) as usize).map_or(1.0, |square| square / QUANTILE)
    }
}

/// Coefficients by reweighted least squares at the positions of the frames, from a start if there is one.
pub(super) fn coefficients(
    frames: &[&Observation],
    structure: &Structure,
    space: &CoefficientSpace,
    levels: NoiseLevels,
    start: Option<&[f64]>,
    excess: f64,
) -> Result<Vec<f64>, Error> {
    let p = space.dimension();
    let mut free = start.map_or_else(|| vec![0.0; p], <[f64]>::to_vec);
    for round in 0..ROUNDS {
        let at = space.coefficients(&free);
        let law = Law { structure, coefficients: at.as_slice(), levels, excess };
        // Without coefficients there is no scale yet.
        let first = start.is_none() && round == 0;
        let mut rows: Vec<(Vector<f64>, DMatrix<f64>, f64)> = Vec::new();
        for frame in frames {
            let evaluated = Nudged::as_measured(frame, structure).evaluate(at.as_slice());
            let columns = free_rows(frame, &evaluated.by_coefficient, space);
            let judged: Vec<(Vector<f64>, f64)> = match first {
                true => {
                    let rests = residuals(frame, &evaluated.predicted).into_iter();
                    rests.map(|(_, rest)| (rest, FIRST_VARIANCE)).collect()
                }
                false => law.judge(frame).into_iter().map(|row| (row.residual, row.variance)).collect(),
            };
            // Linear in the coefficients: what would be left with none of them.
            rows.extend(
                columns.into_iter().zip(judged).map(|(x, (rest, s))| (rest + along(&x, &free), x, s)),
            );
        }
        for step in 0..STEPS {
            let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
            for (y, x, variance) in &rows {
                let rest = y - along(x, &free);
                let w = if first && step == 0 { 1.0 } else { weight(rest.norm_squared(), *variance) };
                normal += x.transpose() * x * w;
                right += x.transpose() * DVector::from_column_slice(y.as_slice()) * w;
            }
            let centre = invert(normal.clone())? * right;
            let next = within_bounds(space, centre, normal)?.as_slice().to_vec();
            let change = free.iter().zip(&next).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            free = next;
            if change < SETTLED {
                break;
            }
        }
    }
    Ok(free)
}

fn along(x: &DMatrix<f64>, free: &[f64]) -> Vector<f64> {
    let predicted = x * DVector::from_column_slice(free);
    Vector::new(predicted[0], predicted[1])
}
