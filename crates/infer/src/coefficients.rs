//! Parameters, coefficients of terms, and which of them are free.
//!
//! Velocities are linear in the coefficients `c = (K_A, K_P P_0, K_P, K_P α)`. Holding any of K_A, K_P, P_0, α confines c
//! to an affine space `c = c₀ + B β`, in which β is fitted.

use crate::Error;
use nalgebra::{DMatrix, DVector, Matrix4, Vector4};
use voronudge_model::Parameters;

/// Parameters held at a value.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fixed {
    /// Area elasticity `K_A`.
    pub area_elasticity: Option<f64>,
    /// Perimeter elasticity `K_P`; not zero.
    pub perimeter_elasticity: Option<f64>,
    /// Preferred perimeter `P_0`.
    pub preferred_perimeter: Option<f64>,
    /// Chirality `α`.
    pub chirality: Option<f64>,
}

/// The affine space `c = c₀ + B β` of coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct CoefficientSpace {
    origin: Vector4<f64>,
    basis: DMatrix<f64>,
}

impl CoefficientSpace {
    /// The space that the fixed parameters leave.
    ///
    /// # Errors
    /// [`Error::Fixed`], [`Error::NothingToFit`].
    pub fn new(fixed: &Fixed) -> Result<Self, Error> {
        let given =
            [fixed.area_elasticity, fixed.perimeter_elasticity, fixed.preferred_perimeter, fixed.chirality];
        if given.into_iter().flatten().any(|value| !value.is_finite()) {
            return Err(Error::Fixed("a parameter is fixed to a value that is not finite"));
        }
        if fixed.perimeter_elasticity == Some(0.0) {
            return Err(Error::Fixed("K_P is fixed to zero, which leaves P_0 and alpha without meaning"));
        }
        let mut origin = Vector4::zeros();
        let mut directions = Vec::new();
        match fixed.area_elasticity {
            Some(k_a) => origin[0] = k_a,
            None => directions.push(Vector4::new(1.0, 0.0, 0.0, 0.0)),
        }
        // P_0 and α, where fixed, move with K_P.
        let with_k_p =
            Vector4::new(0.0, fixed.preferred_perimeter.unwrap_or(0.0), 1.0, fixed.chirality.unwrap_or(0.0));
        if fixed.preferred_perimeter.is_none() {
            directions.push(Vector4::new(0.0, 1.0, 0.0, 0.0));
        }
        match fixed.perimeter_elasticity {
            Some(k_p) => origin += with_k_p * k_p,
            None => directions.push(with_k_p),
        }
        if fixed.chirality.is_none() {
            directions.push(Vector4::new(0.0, 0.0, 0.0, 1.0));
        }
        if directions.is_empty() {
            return Err(Error::NothingToFit);
        }
        let basis = DMatrix::from_fn(4, directions.len(), |row, column| directions[column][row]);
        Ok(Self { origin, basis })
    }

    /// Number of free directions.
    pub fn dimension(&self) -> usize {
        self.basis.ncols()
    }

    /// `c = c₀ + B β`.
    pub fn coefficients(&self, free: &[f64]) -> Vector4<f64> {
        self.origin + &self.basis * DVector::from_column_slice(free)
    }

    /// `c₀`.
    pub(crate) fn origin(&self) -> &Vector4<f64> {
        &self.origin
    }

    /// `B`.
    pub(crate) fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// Covariance of the coefficients from that of β.
    pub fn covariance(&self, free: &DMatrix<f64>) -> Matrix4<f64> {
        let full = &self.basis * free * self.basis.transpose();
        Matrix4::from_fn(|row, column| full[(row, column)])
    }
}

/// Parameters of the model from the coefficients of its terms; `P_0` and `α` are ratios to `K_P`.
pub(crate) fn parameters(coefficients: &Vector4<f64>, preferred_area: f64) -> Parameters<f64> {
    Parameters {
        area_elasticity: coefficients[0],
        perimeter_elasticity: coefficients[2],
        preferred_perimeter: coefficients[1] / coefficients[2],
        preferred_area,
        chirality: coefficients[3] / coefficients[2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fixed_ratio_moves_with_k_p() {
        let fixed = Fixed { preferred_perimeter: Some(4.0), chirality: Some(-2.0), ..Fixed::default() };
        let space = CoefficientSpace::new(&fixed).unwrap();
        assert_eq!(space.dimension(), 2);
        assert_eq!(space.coefficients(&[0.1, 3.0]), Vector4::new(0.1, 12.0, 3.0, -6.0));
    }

    #[test]
    fn nothing_to_fit_and_a_zero_k_p_are_refused() {
        let all = Fixed {
            area_elasticity: Some(0.1),
            perimeter_elasticity: Some(1.0),
            preferred_perimeter: Some(4.0),
            chirality: Some(0.0),
        };
        assert_eq!(CoefficientSpace::new(&all).unwrap_err(), Error::NothingToFit);
        let zero = Fixed { perimeter_elasticity: Some(0.0), ..Fixed::default() };
        assert!(matches!(CoefficientSpace::new(&zero), Err(Error::Fixed(_))));
    }
}
