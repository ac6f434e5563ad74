//! From fitted coefficients and their information matrix to estimates and directions.

use crate::coefficients::covariance_of;
use crate::fit_parameter::BASE;
use crate::quadratic::{Functional, Interval, Quadratic, Ratio};
use crate::{CoefficientSpace, Constraints, Direction, Error, Estimate, FitParameter, ParameterEstimates};
use nalgebra::{DMatrix, DVector, Matrix4, Vector4};

/// A change of −2 log likelihood that one parameter exceeds by chance in 5 % of cases: the 95 % quantile of χ²₁.
pub const CHI_SQUARED_95: f64 = 3.841_458_820_694_124;

/// Two-sided 95 % quantile of the normal distribution.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Usual sizes of the coefficients `K_A`, `K_P P_0`, `K_P`, `K_P α` relative to K_P, in units of ℓ₀, which the components of a [`Direction`] are
/// measured in: P_0 is about the perimeter of a regular hexagon.
pub const COEFFICIENT_SIZES: [f64; 4] = [1.0, 3.722, 1.0, 1.0];

/// Distance from a bound, in standard errors, that is rounding.
const ROUNDING: f64 = 1e-9;

/// The same for the end of an interval, which is the end of a search.
const ROUNDING_OF_ENDS: f64 = 1e-5;

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

/// The coefficients of the base model, as some cells have them, in terms of β: `c = origin + gradient β`.
pub(crate) struct Rows {
    origin: Vector4<f64>,
    /// (4, free)
    pub gradient: DMatrix<f64>,
    /// Whether they are those of the base model itself, which bounds are about.
    bounded: bool,
}

impl Rows {
    /// At β.
    pub fn coefficients(&self, free: &[f64]) -> Vector4<f64> {
        let change = &self.gradient * DVector::from_column_slice(free);
        self.origin + change.fixed_rows::<BASE>(0)
    }

    /// Their covariance, from that of β.
    fn covariance(&self, free: &DMatrix<f64>) -> Matrix4<f64> {
        covariance_of(&self.gradient, free)
    }

    fn functional(&self, index: usize) -> Functional {
        Functional { constant: self.origin[index], gradient: self.gradient.row(index).transpose() }
    }
}

/// Standard errors to first order, bounds apart; zero of what is held.
pub(crate) struct StandardErrors {
    /// Of each quantity of [`FitParameter::ALL`].
    pub parameters: [f64; FitParameter::ALL.len()],
    /// Of the coefficients of effects.
    pub effects: Vec<f64>,
}

impl Fitted<'_> {
    /// Standard errors alone.
    pub fn standard_errors(&self) -> Result<StandardErrors, Error> {
        let free = crate::normal_matrix::invert(self.information.clone())?;
        let rows = self.rows([None; BASE]);
        let covariance = rows.covariance(&free);
        let effects = self.space.base_dimension()..self.free.len();
        Ok(StandardErrors {
            parameters: FitParameter::ALL.map(|quantity| self.standard_error(quantity, &rows, &covariance)),
            effects: effects.map(|k| free[(k, k)].max(0.0).sqrt()).collect(),
        })
    }

    /// That of a quantity, from the covariance of the coefficients.
    fn standard_error(&self, quantity: FitParameter, rows: &Rows, covariance: &Matrix4<f64>) -> f64 {
        if self.held(quantity, rows) {
            return 0.0;
        }
        let gradient = quantity.gradient(rows.coefficients(self.free).as_slice());
        (gradient.transpose() * covariance * gradient).sum().max(0.0).sqrt()
    }

    /// The coefficients of cells in which coefficients of effects, by their number, are added to those of the base model.
    pub fn rows(&self, added: [Option<usize>; BASE]) -> Rows {
        let mut origin: Vector4<f64> = self.space.origin().fixed_rows::<BASE>(0).into();
        let mut gradient = self.space.base_rows();
        for (k, effect) in added.into_iter().enumerate().filter_map(|(k, effect)| Some((k, effect?))) {
            origin[k] += self.space.origin()[BASE + effect];
            let sum = gradient.row(k) + self.space.basis().row(BASE + effect);
            gradient.set_row(k, &sum);
        }
        Rows { origin, gradient, bounded: added == [None; BASE] }
    }

    /// Parameters with likelihood-ratio intervals. Ratios have Fieller's, which need not be symmetric nor bounded; bounds
    /// shorten intervals to what they leave.
    pub fn estimates(&self) -> Result<ParameterEstimates, Error> {
        self.estimates_of(&self.rows([None; BASE]))
    }

    /// The same of cells that have coefficients of their own.
    pub fn estimates_of(&self, rows: &Rows) -> Result<ParameterEstimates, Error> {
        let quadratic = Quadratic::new(self.centre.clone(), self.information)?;
        let covariance = rows.covariance(&crate::normal_matrix::invert(self.information.clone())?);
        let c = rows.coefficients(self.free);
        let bounds = self.space.half_spaces();
        let coefficient = |index: usize| rows.functional(index);
        // Where K_P ends at zero, ratios to it have no value; what their intervals say stays true.
        let no_scale = c[2].abs() <= ROUNDING * covariance[(2, 2)].max(0.0).sqrt();
        let estimate = |quantity: FitParameter| {
            let value = if no_scale && quantity.is_ratio() { f64::NAN } else { quantity.of(c.as_slice()) };
            if self.held(quantity, rows) {
                return Estimate { value, standard_error: 0.0, interval: [Some(value); 2] };
            }
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
            let standard_error = self.standard_error(quantity, rows, &covariance);
            let ends = [lower, upper];
            let stopped = |bound: &&f64| (value - **bound).abs() <= ROUNDING * standard_error;
            let own = self.constraints.bounds.get(&quantity).filter(|_| rows.bounded);
            match own.and_then(|bounds| bounds.iter().find(stopped)) {
                None => Estimate { value, standard_error, interval: ends },
                Some(&bound) => {
                    let near = |end: &f64| (end - bound).abs() <= ROUNDING_OF_ENDS * standard_error;
                    let ends = ends.map(|end| if end.as_ref().is_some_and(near) { Some(bound) } else { end });
                    Estimate { value: bound, standard_error, interval: ends }
                }
            }
        };
        Ok(ParameterEstimates {
            area_elasticity: estimate(FitParameter::AreaElasticity),
            perimeter_elasticity: estimate(FitParameter::PerimeterElasticity),
            preferred_perimeter: estimate(FitParameter::PreferredPerimeter),
            chirality: estimate(FitParameter::Chirality),
            chiral_coefficient: estimate(FitParameter::ChiralCoefficient),
        })
    }

    /// Coefficients of effects, which no bound restricts.
    pub fn effects(&self) -> Result<Vec<Estimate>, Error> {
        let quadratic = Quadratic::new(self.centre.clone(), self.information)?;
        let errors = self.standard_errors()?.effects;
        let base = self.space.base_dimension();
        let estimate = |k: usize| {
            let function = Functional {
                constant: 0.0,
                gradient: DVector::from_fn(self.free.len(), |i, _| f64::from(i == k)),
            };
            let interval = quadratic.linear_interval(&function, &self.space.half_spaces(), CHI_SQUARED_95);
            let Interval { lower, upper } = interval.unwrap_or(Interval { lower: None, upper: None });
            Estimate { value: self.free[k], standard_error: errors[k - base], interval: [lower, upper] }
        };
        Ok((base..self.free.len()).map(estimate).collect())
    }

    /// Whether a quantity has one value throughout the space.
    fn held(&self, quantity: FitParameter, rows: &Rows) -> bool {
        let c = rows.coefficients(self.free);
        let mut normal = Vector4::ith(quantity.coefficient(), 1.0);
        if quantity.is_ratio() {
            normal *= c[2];
            normal[2] = -c[quantity.coefficient()];
        }
        let along = rows.gradient.transpose() * normal;
        along.amax() <= 1e-12 * self.space.basis().amax() * normal.amax()
    }

    /// Principal axes of the covariance of the coefficients, each measured in its usual size: stiffest first.
    pub fn directions(&self) -> Result<Vec<Direction>, Error> {
        let covariance = self.space.covariance(&crate::normal_matrix::invert(self.information.clone())?);
        let relative =
            Matrix4::from_fn(|i, j| covariance[(i, j)] / (COEFFICIENT_SIZES[i] * COEFFICIENT_SIZES[j]));
        let eigen = relative.symmetric_eigen();
        let mut order: Vec<usize> = (0..4).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        // What is held has no variance.
        let free = order.split_off(4 - self.space.base_dimension());
        let directions = free.into_iter().map(|k| {
            let along = eigen.eigenvectors.column(k);
            // The sign of an eigenvector is arbitrary: the largest component is positive.
            let sign = along[along.iamax()].signum();
            Direction {
                eigenvalue: 1.0 / eigen.eigenvalues[k],
                components: std::array::from_fn(|i| sign * along[i]),
            }
        });
        Ok(directions.collect())
    }
}
