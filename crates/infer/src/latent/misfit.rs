//! What velocities near a place say together.
//!
//! An error of a position moves the velocities of a dozen cells at once. With the residuals r of the velocities nearby and their
//! derivatives J by the measured positions,
//!
//! ```text
//! C = σ_v² diag(λ) + σ_r² J Jᵀ,      −2 log p = min_λ { rᵀC⁻¹r + log det C + Σ (ν log λ_i + ν/λ_i) }
//! ```
//!
//! so that what positions can explain costs little, and what they cannot explain stands out. The factors λ make the errors of
//! velocities a Student distribution of ν degrees of freedom; without errors of positions it is that of [`super::law::deviance`].

use super::law::FREEDOM;
use nalgebra::{DMatrix, DVector};

/// Steps of the factors λ from the beginning, and from those of a place nearby.
const STEPS: [usize; 2] = [4, 2];

/// Residuals of velocities nearby and what moves them.
pub(super) struct Residuals {
    /// r, component by component.
    pub residuals: DVector<f64>,
    /// Derivatives of the velocities by the coordinates of free cells.
    pub by_free: DMatrix<f64>,
    /// Derivatives by the measured coordinates, in units of their errors: σ_r J.
    pub by_measured: DMatrix<f64>,
    /// σ_v²
    pub variance: f64,
}

/// How well velocities are explained.
pub(super) struct Misfit {
    /// −2 log p, up to a constant for each velocity.
    pub deviance: f64,
    /// Information on the coordinates of free cells.
    pub information: DMatrix<f64>,
    /// Minus half the slope of −2 log p by those.
    pub gradient: DVector<f64>,
}

impl Residuals {
    /// From the factors of a place nearby, or none, which it leaves improved; `None` if there is no finite answer.
    pub fn misfit(&self, factors: &mut Vec<f64>) -> Option<Misfit> {
        let Self { residuals, by_free, by_measured, variance } = self;
        let of_positions = by_measured * by_measured.transpose();
        let count = residuals.len() / 2;
        let steps = STEPS[usize::from(factors.len() == count)];
        factors.resize(count, 1.0);
        for step in 0..=steps {
            let mut covariance = of_positions.clone();
            for (i, factor) in factors.iter().enumerate() {
                covariance[(2 * i, 2 * i)] += variance * factor;
                covariance[(2 * i + 1, 2 * i + 1)] += variance * factor;
            }
            let factored = covariance.cholesky()?;
            let weighted = factored.solve(residuals);
            if step == steps {
                let log_determinant = 2.0 * factored.l_dirty().diagonal().iter().map(|x| x.ln()).sum::<f64>();
                let prior: f64 = factors.iter().map(|factor| FREEDOM * (factor.ln() + 1.0 / factor)).sum();
                let constant = (FREEDOM + 2.0) * (1.0 + (FREEDOM / (FREEDOM + 2.0)).ln());
                let deviance = residuals.dot(&weighted) + log_determinant + prior - constant * count as f64;
                let gradient = by_free.transpose() * &weighted;
                let information = by_free.transpose() * factored.solve(by_free);
                return deviance.is_finite().then_some(Misfit { deviance, information, gradient });
            }
            // A column of L⁻¹ begins at its diagonal.
            let square = |from: usize| {
                let behind = 2 * count - from;
                let mut column = DVector::zeros(behind);
                column[0] = 1.0;
                factored
                    .l_dirty()
                    .view((from, from), (behind, behind))
                    .solve_lower_triangular_mut(&mut column);
                column.norm_squared()
            };
            for (i, factor) in factors.iter_mut().enumerate() {
                let pull = variance * weighted.rows(2 * i, 2).norm_squared();
                let trace = variance * (square(2 * i) + square(2 * i + 1));
                // The majorised problem in each factor has this solution.
                *factor *= ((pull + FREEDOM / (*factor * *factor)) / (trace + FREEDOM / *factor)).sqrt();
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::law::deviance;
    use super::*;

    fn residuals(values: &[f64], by_measured: DMatrix<f64>) -> Residuals {
        let residuals = DVector::from_column_slice(values);
        Residuals { by_free: DMatrix::zeros(values.len(), 0), residuals, by_measured, variance: 0.01 }
    }

    #[test]
    fn without_errors_of_positions_velocities_are_independent() {
        let values = [0.1, 0.2, 0.5, -0.3, 0.02, 0.0];
        let alone: f64 = values.chunks_exact(2).map(|r| deviance(r[0] * r[0] + r[1] * r[1], 0.01)).sum();
        let together = residuals(&values, DMatrix::zeros(6, 0)).misfit(&mut Vec::new()).unwrap();
        assert!((together.deviance - alone).abs() < 0.3, "{} {alone}", together.deviance);
    }

    #[test]
    fn what_one_position_moves_together_counts_little() {
        let along = DMatrix::from_column_slice(4, 1, &[0.4, 0.1, 0.3, -0.2]);
        let explained: Vec<f64> = along.iter().copied().collect();
        let against = [0.4, -0.1, -0.3, -0.2];
        let [explained, against] =
            [&explained[..], &against].map(|r| residuals(r, along.clone()).misfit(&mut Vec::new()).unwrap());
        assert!(explained.deviance + 6.0 < against.deviance);
    }
}
