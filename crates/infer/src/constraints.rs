//! What is known of the parameters beforehand.

use crate::{Error, FitParameter, Scale};
use std::collections::BTreeMap;

/// A Gaussian prior.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Mean.
    pub mean: f64,
    /// Standard deviation, positive.
    pub standard_deviation: f64,
}

/// Parameters held, bounded, or known to some precision.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Constraints {
    /// Held at a value; `K_P` not at zero.
    pub fixed: BTreeMap<FitParameter, f64>,
    /// Kept between two values, of which one may be infinite. Bounds on `P_0` or `α` imply `K_P ≥ 0`, because they are
    /// ratios to it.
    pub bounds: BTreeMap<FitParameter, [f64; 2]>,
    /// Gaussian priors.
    pub priors: BTreeMap<FitParameter, Prior>,
}

impl Constraints {
    /// Parameters held, and nothing else.
    pub fn fixed(fixed: impl IntoIterator<Item = (FitParameter, f64)>) -> Self {
        Self { fixed: fixed.into_iter().collect(), ..Self::default() }
    }

    /// What is known in the units of the data, in those of a fit.
    #[must_use]
    pub fn scaled(&self, scale: &Scale) -> Self {
        let unit = |quantity: &FitParameter| scale.factor(*quantity);
        Self {
            fixed: self.fixed.iter().map(|(q, value)| (*q, value / unit(q))).collect(),
            bounds: self.bounds.iter().map(|(q, ends)| (*q, ends.map(|end| end / unit(q)))).collect(),
            priors: self
                .priors
                .iter()
                .map(|(q, prior)| {
                    let standard_deviation = prior.standard_deviation / unit(q);
                    (*q, Prior { mean: prior.mean / unit(q), standard_deviation })
                })
                .collect(),
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        if self.fixed.values().any(|value| !value.is_finite()) {
            return Err(Error::Constraint("a parameter is fixed to a value that is not finite"));
        }
        if self.fixed.get(&FitParameter::PerimeterElasticity) == Some(&0.0) {
            return Err(Error::Constraint(
                "K_P is fixed to zero, which leaves P_0 and alpha without meaning",
            ));
        }
        for (quantity, [low, high]) in &self.bounds {
            if low.is_nan() || high.is_nan() || low >= high {
                return Err(Error::Constraint("a lower bound is not below its upper bound"));
            }
            if self.fixed.get(quantity).is_some_and(|value| value < low || value > high) {
                return Err(Error::Constraint("a parameter is fixed outside of its bounds"));
            }
        }
        for prior in self.priors.values() {
            if !prior.mean.is_finite()
                || !prior.standard_deviation.is_finite()
                || prior.standard_deviation <= 0.0
            {
                return Err(Error::Constraint(
                    "a prior needs a finite mean and a positive standard deviation",
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constraints_are_scaled_like_the_quantities_they_hold() {
        let scale = Scale { length: 10.0, time: 4.0 };
        let given = Constraints {
            fixed: [(FitParameter::PreferredPerimeter, 38.0), (FitParameter::Chirality, 2.0)].into(),
            bounds: [(FitParameter::AreaElasticity, [0.0, f64::INFINITY])].into(),
            priors: [(FitParameter::ChiralCoefficient, Prior { mean: 0.5, standard_deviation: 0.25 })].into(),
        };
        let fit = given.scaled(&scale);
        assert!((fit.fixed[&FitParameter::PreferredPerimeter] - 3.8).abs() < 1e-12);
        assert_eq!(fit.fixed[&FitParameter::Chirality], 2.0);
        assert_eq!(fit.bounds[&FitParameter::AreaElasticity], [0.0, f64::INFINITY]);
        let prior = fit.priors[&FitParameter::ChiralCoefficient];
        assert!((prior.mean - 2.0).abs() < 1e-12 && (prior.standard_deviation - 1.0).abs() < 1e-12);
        // K_A per area and time.
        assert!((scale.factor(FitParameter::AreaElasticity) - 1.0 / 400.0).abs() < 1e-15);
    }
}
