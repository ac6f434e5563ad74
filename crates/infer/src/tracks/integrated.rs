//! What integrating over the unknown ways of the cells adds to the likelihood of the coefficients.
//!
//! Places after the first, polarities and what else moves a cell are random; the likelihood of β is an integral over them. About its greatest
//! integrand (Laplace's method)
//!
//! ```text
//! −2 log L(β) = Φ(β, x̂)/σ_v² + log det H(β, x̂) + const
//! ```
//!
//! with x̂ the unknowns that make Φ least for β, and H the second derivative of Φ with respect to them, but for the first place of each cell, which is
//! no random number: the cells stand where they stood. The determinant depends on β. A stiff tissue yields less to polarities and forgets faster where
//! its cells were, so that the least of Φ by itself is one of too soft a tissue. Its slope, along the ridge x̂(β), is found from
//! differences, and stands beside Φ until the fit has moved. With z the independent directions of β, in standard errors,
//!
//! ```text
//! log det H(β) ≈ const + Σ_k s_k f(z_k),      f(z) = z / (1 + (z/R)⁴)^¼
//! ```
//!
//! f is z as far as the slope is known, and ends at R: where the data hardly determine a direction, a line would lead a fit away for ever.

use nalgebra::{DMatrix, DVector};

/// R
const REACH: f64 = 4.0;

/// log det H about some free coefficients of the model.
#[derive(Debug, Clone)]
pub(crate) struct Integrated {
    /// Those coefficients.
    pub(super) about: DVector<f64>,
    /// Its slope along independent directions.
    pub(super) slope: DVector<f64>,
    /// These directions, a standard error long: lower triangular.
    pub(super) directions: DMatrix<f64>,
}

impl Integrated {
    /// Whether it is one of a model with so many free coefficients.
    pub fn is_of(&self, coefficients: usize) -> bool {
        self.about.len() == coefficients
    }

    /// Of a share of the data.
    pub fn of_share(&self, share: f64) -> Self {
        Self { slope: &self.slope * share, ..self.clone() }
    }

    /// How far some free coefficients are, z.
    fn distance(&self, free: &[f64]) -> DVector<f64> {
        let mut z = DVector::from_column_slice(free) - &self.about;
        self.directions.solve_lower_triangular_mut(&mut z);
        z
    }

    /// By how much log det H rises to some free coefficients.
    pub(super) fn rise(&self, free: &[f64]) -> f64 {
        let reached = |z: f64| z / (1.0 + (z / REACH).powi(4)).powf(0.25);
        self.slope.dot(&self.distance(free).map(reached))
    }

    /// Its derivative by these.
    pub(super) fn derivative(&self, free: &[f64]) -> DVector<f64> {
        let left = |z: f64| (1.0 + (z / REACH).powi(4)).powf(-1.25);
        let mut along = self.slope.component_mul(&self.distance(free).map(left));
        self.directions.tr_solve_lower_triangular_mut(&mut along);
        along
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line near by, which ends; the derivative is that of the rise.
    #[test]
    fn what_integrating_adds_has_an_end() {
        let own = Integrated {
            about: DVector::from_vec(vec![1.0, -2.0]),
            slope: DVector::from_vec(vec![3.0, -1.0]),
            directions: DMatrix::from_row_slice(2, 2, &[0.1, 0.0, 0.3, 0.2]),
        };
        let at = |z: [f64; 2]| -> Vec<f64> {
            (&own.about + &own.directions * DVector::from_column_slice(&z)).as_slice().to_vec()
        };
        assert!((own.rise(&at([0.5, -1.0])) - 2.5).abs() < 3e-3);
        assert!(own.rise(&at([1e6, -1e6])) < 4.0 * REACH + 1e-9);
        for z in [[0.0, 0.0], [2.0, -5.0], [-7.0, 3.0]] {
            let free = at(z);
            for (k, slope) in own.derivative(&free).iter().enumerate() {
                let moved = |by: f64| {
                    let mut there = free.clone();
                    there[k] += by;
                    own.rise(&there)
                };
                let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                assert!((difference - slope).abs() < 1e-6 * slope.abs().max(1.0), "{difference} {slope}");
            }
        }
    }
}
