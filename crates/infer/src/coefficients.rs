//! Coefficients of terms, and which of them are free.
//!
//! Velocities are linear in the coefficients `c = (K_A, K_P P_0, K_P, K_P α)`. Holding a parameter confines c to an affine
//! space `c = c₀ + B β`, in which β is fitted; bounds confine β to half-spaces.

use crate::fit_parameter::BASE;
use crate::quadratic::HalfSpace;
use crate::{Constraints, Error, FitParameter, Prior};
use nalgebra::{DMatrix, DVector, Matrix4, Vector4};
use voronudge_model::Parameters;

/// Preferred area of the base model: a gauge.
pub(crate) const PREFERRED_AREA: f64 = 1.0;

/// Components of a direction that count as zero, relative to the largest.
const ZERO: f64 = 1e-12;

/// The affine space `c = c₀ + B β` of coefficients, with bounds and priors. The first four coefficients are those of the
/// base model; effects follow, each free.
#[derive(Debug, Clone, PartialEq)]
pub struct CoefficientSpace {
    origin: DVector<f64>,
    basis: DMatrix<f64>,
    /// `aᵀc ≥ b`, in the coefficients of the base model.
    at_least: Vec<(Vector4<f64>, f64)>,
    priors: Vec<(FitParameter, Prior)>,
}

impl CoefficientSpace {
    /// The space that constraints leave of the base model.
    ///
    /// # Errors
    /// [`Error::Constraint`], [`Error::NothingToFit`].
    pub fn new(constraints: &Constraints) -> Result<Self, Error> {
        constraints.check()?;
        let mut space = Self {
            origin: DVector::zeros(BASE),
            basis: DMatrix::identity(BASE, BASE),
            at_least: Vec::new(),
            priors: constraints.priors.iter().map(|(quantity, prior)| (*quantity, *prior)).collect(),
        };
        for (quantity, value) in &constraints.fixed {
            space = space.hold(*quantity, *value)?;
        }
        if space.dimension() == 0 {
            return Err(Error::NothingToFit);
        }
        for (quantity, [low, high]) in &constraints.bounds {
            for (value, side) in [(*low, 1.0), (*high, -1.0)] {
                if value.is_finite() {
                    let (normal, bound) = quantity.plane(value);
                    space.at_least.push((normal * side, bound * side));
                }
            }
        }
        if constraints.bounds.keys().any(|quantity| quantity.is_ratio()) {
            space.at_least.push((Vector4::ith(2, 1.0), 0.0));
        }
        Ok(space)
    }

    /// The same space with the free coefficients of effects added, up to so many coefficients in all; or without those
    /// beyond so many.
    #[must_use]
    pub(crate) fn with_coefficients(&self, coefficients: usize) -> Self {
        let rows = coefficients.max(BASE);
        let (own, columns) = (self.origin.len(), self.base_dimension() + rows - BASE);
        let mut basis = DMatrix::zeros(rows, columns);
        basis.view_mut((0, 0), (BASE, self.base_dimension())).copy_from(&self.base_basis());
        for effect in 0..rows - BASE {
            basis[(BASE + effect, self.base_dimension() + effect)] = 1.0;
        }
        let origin = DVector::from_fn(rows, |k, _| if k < own { self.origin[k] } else { 0.0 });
        Self { origin, basis, ..self.clone() }
    }

    /// The part of the space in which a quantity has a value.
    ///
    /// # Errors
    /// [`Error::Constraint`] if it has another value throughout.
    pub fn hold(&self, quantity: FitParameter, value: f64) -> Result<Self, Error> {
        let (normal, bound) = quantity.plane(value);
        let own = self.origin.fixed_rows::<BASE>(0);
        let rest = bound - normal.dot(&own);
        let along = self.in_free(&normal);
        let size = along.amax();
        if size <= ZERO * self.basis.amax().max(1.0) {
            let scale = bound.abs().max(normal.component_mul(&own).amax());
            return if rest.abs() <= 1e-9 * scale {
                Ok(self.clone())
            } else {
                Err(Error::Constraint("fixed parameters contradict each other"))
            };
        }
        // One direction gives way; rather one that moves the quantity itself than K_P, so that ratios move with K_P.
        let moves = |k: &usize| {
            self.basis[(quantity.coefficient(), *k)].abs() > ZERO && along[*k].abs() > ZERO * size
        };
        let pivot = (0..self.dimension()).find(moves).unwrap_or_else(|| along.iamax());
        let direction = self.basis.column(pivot) / along[pivot];
        let others: Vec<DVector<f64>> = (0..self.dimension())
            .filter(|k| *k != pivot)
            .map(|k| self.basis.column(k) - &direction * along[k])
            .collect();
        let mut held = self.clone();
        held.origin += &direction * rest;
        held.basis = DMatrix::from_fn(self.origin.len(), others.len(), |row, column| others[column][row]);
        Ok(held)
    }

    /// The space with so many further directions, after all others, along which no coefficient changes.
    pub(crate) fn widened(&self, directions: usize) -> Self {
        let basis = self.basis.clone().resize_horizontally(self.dimension() + directions, 0.0);
        Self { basis, ..self.clone() }
    }

    /// The space of these coefficients alone.
    pub(crate) fn pinned(c: &[f64]) -> Self {
        Self {
            origin: DVector::from_column_slice(c),
            basis: DMatrix::zeros(c.len(), 0),
            at_least: Vec::new(),
            priors: Vec::new(),
        }
    }

    /// Number of free directions.
    pub fn dimension(&self) -> usize {
        self.basis.ncols()
    }

    /// Number of free directions of the base model: they come first.
    pub(crate) fn base_dimension(&self) -> usize {
        self.dimension() - (self.origin.len() - BASE).min(self.dimension())
    }

    /// `c = c₀ + B β`.
    pub fn coefficients(&self, free: &[f64]) -> DVector<f64> {
        &self.origin + &self.basis * DVector::from_column_slice(free)
    }

    /// The β whose coefficients are nearest to c.
    pub(crate) fn nearest(&self, c: &[f64]) -> Vec<f64> {
        let normal = self.basis.transpose() * &self.basis;
        let right = self.basis.transpose() * (DVector::from_column_slice(c) - &self.origin);
        normal.cholesky().map(|factor| factor.solve(&right).as_slice().to_vec()).unwrap_or_default()
    }

    /// `c₀`.
    pub(crate) fn origin(&self) -> &DVector<f64> {
        &self.origin
    }

    /// `B`.
    pub(crate) fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    fn base_basis(&self) -> DMatrix<f64> {
        self.basis.view((0, 0), (BASE, self.base_dimension())).into_owned()
    }

    /// `Bᵀa` for a function of the coefficients of the base model.
    pub(crate) fn in_free(&self, gradient: &Vector4<f64>) -> DVector<f64> {
        self.basis.rows(0, BASE).transpose() * gradient
    }

    /// The bounds as half-spaces of β, those without effect on it left out.
    pub(crate) fn half_spaces(&self) -> Vec<HalfSpace> {
        let own = self.origin.fixed_rows::<BASE>(0);
        let in_free = |(normal, bound): &(Vector4<f64>, f64)| HalfSpace {
            normal: self.in_free(normal),
            bound: bound - normal.dot(&own),
        };
        self.at_least.iter().map(in_free).filter(|half| half.normal.amax() > ZERO).collect()
    }

    /// Gaussian priors.
    pub(crate) fn priors(&self) -> &[(FitParameter, Prior)] {
        &self.priors
    }

    /// The penalty of the priors for given coefficients, `σ_v² Σ (q − m)² / s²`.
    pub(crate) fn penalty(&self, c: &DVector<f64>, velocity: f64) -> f64 {
        let scaled = |(quantity, prior): &(FitParameter, Prior)| {
            (quantity.of(c.as_slice()) - prior.mean) * velocity / prior.standard_deviation
        };
        self.priors.iter().map(scaled).map(|rest| rest * rest).sum()
    }

    /// Covariance of the coefficients of the base model from that of β.
    pub fn covariance(&self, free: &DMatrix<f64>) -> Matrix4<f64> {
        covariance_of(&self.base_rows(), free)
    }

    /// `∂c/∂β` of the coefficients of the base model (4, free).
    pub(crate) fn base_rows(&self) -> DMatrix<f64> {
        self.basis.rows(0, BASE).into_owned()
    }
}

/// Covariance of coefficients from that of β, by which they change as these rows (4, free) say.
pub(crate) fn covariance_of(rows: &DMatrix<f64>, free: &DMatrix<f64>) -> Matrix4<f64> {
    let full = rows * free * rows.transpose();
    Matrix4::from_fn(|row, column| full[(row, column)])
}

/// Parameters of the model from the coefficients of its terms; `P_0` and `α` are ratios to `K_P`.
pub(crate) fn parameters(coefficients: &DVector<f64>) -> Parameters<f64> {
    let value = |quantity: FitParameter| quantity.of(coefficients.as_slice());
    Parameters {
        area_elasticity: value(FitParameter::AreaElasticity),
        perimeter_elasticity: value(FitParameter::PerimeterElasticity),
        preferred_perimeter: value(FitParameter::PreferredPerimeter),
        preferred_area: PREFERRED_AREA,
        chirality: value(FitParameter::Chirality),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use FitParameter::{
        AreaElasticity, ChiralCoefficient, Chirality, PerimeterElasticity, PreferredPerimeter,
    };

    #[test]
    fn a_fixed_ratio_moves_with_k_p() {
        let fixed = Constraints::fixed([(PreferredPerimeter, 4.0), (Chirality, -2.0)]);
        let space = CoefficientSpace::new(&fixed).unwrap();
        assert_eq!(space.dimension(), 2);
        assert_eq!(space.coefficients(&[0.1, 3.0]).as_slice(), [0.1, 12.0, 3.0, -6.0]);
        let wide = space.with_coefficients(6);
        assert_eq!(wide.coefficients(&[0.1, 3.0, 7.0, 8.0]).as_slice(), [0.1, 12.0, 3.0, -6.0, 7.0, 8.0]);
        assert_eq!((wide.dimension(), wide.base_dimension()), (4, 2));
        assert_eq!(wide.with_coefficients(4), space);
    }

    #[test]
    fn held_quantities_keep_their_values() {
        let all = [(AreaElasticity, 0.2), (PerimeterElasticity, 1.5), (PreferredPerimeter, 3.9)];
        for pair in [[all[0], all[1]], [all[1], all[2]], [(ChiralCoefficient, 2.0), (Chirality, 4.0)]] {
            let space = CoefficientSpace::new(&Constraints::fixed(pair)).unwrap();
            assert_eq!(space.dimension(), 2);
            let c = space.coefficients(&[0.7, 1.3]);
            for (quantity, value) in pair {
                assert!(
                    (quantity.of(c.as_slice()) - value).abs() < 1e-12,
                    "{quantity:?} {}",
                    quantity.of(c.as_slice())
                );
            }
            let back = space.nearest(c.as_slice());
            assert!((back[0] - 0.7).abs() < 1e-12 && (back[1] - 1.3).abs() < 1e-12);
        }
    }

    #[test]
    fn contradictions_and_senseless_values_are_refused() {
        let refused = |fixed: &[(FitParameter, f64)]| {
            CoefficientSpace::new(&Constraints::fixed(fixed.iter().copied())).unwrap_err()
        };
        let all =
            [(AreaElasticity, 0.1), (PerimeterElasticity, 1.0), (PreferredPerimeter, 4.0), (Chirality, 0.0)];
        assert_eq!(refused(&all), Error::NothingToFit);
        assert!(matches!(refused(&[(PerimeterElasticity, 0.0)]), Error::Constraint(_)));
        let contradiction = [(PerimeterElasticity, 1.0), (Chirality, 2.0), (ChiralCoefficient, 3.0)];
        assert!(matches!(refused(&contradiction), Error::Constraint(_)));
        let bounds = Constraints { bounds: [(AreaElasticity, [1.0, 0.0])].into(), ..Constraints::default() };
        assert!(matches!(CoefficientSpace::new(&bounds), Err(Error::Constraint(_))));
    }
}
