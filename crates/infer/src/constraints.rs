//! What is known of the parameters beforehand.

use crate::{Error, Quantity};
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
    pub fixed: BTreeMap<Quantity, f64>,
    /// Kept between two values, of which one may be infinite. Bounds on `P_0` or `α` imply `K_P ≥ 0`, because they are
    /// ratios to it.
    pub bounds: BTreeMap<Quantity, [f64; 2]>,
    /// Gaussian priors.
    pub priors: BTreeMap<Quantity, Prior>,
}

impl Constraints {
    /// Parameters held, and nothing else.
    pub fn fixed(fixed: impl IntoIterator<Item = (Quantity, f64)>) -> Self {
        Self { fixed: fixed.into_iter().collect(), ..Self::default() }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        if self.fixed.values().any(|value| !value.is_finite()) {
            return Err(Error::Constraint("a parameter is fixed to a value that is not finite"));
        }
        if self.fixed.get(&Quantity::PerimeterElasticity) == Some(&0.0) {
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
