//! From fitted coefficients and their information matrix to estimates and directions.

use crate::quadratic::{Functional, Interval, Quadratic, Ratio};
use crate::{CoefficientSpace, Constraints, Direction, Error, Estimate, ParameterEstimates, Quantity};
use nalgebra::{DMatrix, DVector};

/// A change of −2 log likelihood that one parameter exceeds by chance in 5 % of cases: the 95 % quantile of χ²₁.
pub const CHI_SQUARED_95: f64 = 3.841_458_820_694_124;

/// The quadratic about a fit.
pub(crate) struct Fitted<'a> {
    pub space: &'a CoefficientSpace,
    pub constraints: &'a Constraints,
    /// β
    pub free: &'a [f64],
    /// Half the second derivative of −2 log likelihood with respect to β.
    pub information: &'a DMatrix<f64>,
    /// Where that quadratic would be least if there were no bounds.
    pub centre: DVector<f64>,
}

impl Fitted<'_> {
    /// Parameters with likelihood-ratio intervals. Ratios have Fieller's, which need not be symmetric nor bounded; bounds
    /// shorten intervals to what they leave.
    pub fn estimates(&self) -> Result<ParameterEstimates, Error> {
        let quadratic = Quadratic::new(self.centre.clone(), self.information)?;
        let covariance = self.space.covariance(&crate::least_squares::invert(self.information.clone())?);
        let c = self.space.coefficients(self.free);
        let bounds = self.space.half_spaces();
        let coefficient = |index: usize| Functional {
            constant: self.space.origin()[index],
            gradient: self.space.basis().row(index).transpose(),
        };
        let estimate = |quantity: Quantity| {
            let value = quantity.of(&c);
            if self.held(quantity) {
                return Estimate { value, standard_error: 0.0, interval: [Some(value); 2] };
            }
            let gradient = quantity.gradient(&c);
            let variance = (gradient.transpose() * covariance * gradient).sum();
            let interval = if quantity.is_ratio() {
                let ratio = Ratio {
                    numerator: coefficient(quantity.coefficient()),
                    denominator: coefficient(2),
                    positive_denominator: self.constraints.bounds.keys().any(|bounded| bounded.is_ratio()),
                };
                quadratic.ratio_interval(&ratio, &bounds, CHI_SQUARED_95)
            } else {
                quadratic.linear_interval(&coefficient(quantity.coefficient()), &bounds, CHI_SQUARED_95)
            };
            let Interval { lower, upper } = interval.unwrap_or(Interval { lower: None, upper: None });
            Estimate { value, standard_error: variance.max(0.0).sqrt(), interval: [lower, upper] }
        };
        Ok(ParameterEstimates {
            area_elasticity: estimate(Quantity::AreaElasticity),
            perimeter_elasticity: estimate(Quantity::PerimeterElasticity),
            preferred_perimeter: estimate(Quantity::PreferredPerimeter),
            chirality: estimate(Quantity::Chirality),
            chiral_coefficient: estimate(Quantity::ChiralCoefficient),
        })
    }

    /// Whether a quantity has one value throughout the space.
    fn held(&self, quantity: Quantity) -> bool {
        let (normal, _) = quantity.plane(quantity.of(&self.space.coefficients(self.free)));
        let along = self.space.basis().transpose() * normal;
        along.amax() <= 1e-12 * self.space.basis().amax()
    }

    /// Eigenvectors of the information on β as directions in the space of coefficients, stiffest first.
    pub fn directions(&self) -> Vec<Direction> {
        let eigen = self.information.clone().symmetric_eigen();
        let mut directions: Vec<Direction> = (0..self.information.nrows())
            .map(|k| {
                let along = self.space.basis() * eigen.eigenvectors.column(k);
                // The sign of an eigenvector is arbitrary: the largest component is positive.
                let sign = along[along.iamax()].signum() / along.norm();
                Direction {
                    eigenvalue: eigen.eigenvalues[k],
                    components: std::array::from_fn(|i| sign * along[i]),
                }
            })
            .collect();
        directions.sort_by(|a, b| b.eigenvalue.total_cmp(&a.eigenvalue));
        directions
    }
}
