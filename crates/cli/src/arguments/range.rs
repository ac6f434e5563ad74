//! Numbers and ranges of numbers as they are typed.

use super::LARGEST_PARAMETER;
use crate::failure::Failure;
use serde::{Deserialize, Serialize};

/// Values that nobody means.
const MOST_VALUES: usize = 1000;

/// Evenly spaced values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Range {
    pub from: f64,
    pub to: f64,
    pub count: usize,
}

impl Range {
    /// From first, last and how many, as typed after `--name`.
    pub fn new(name: &str, typed: &[f64], example: &str) -> Result<Self, Failure> {
        let hint = format!("write for example --{name} {example}");
        let fault = |text: String| Failure::new(format!("--{name} {text}")).with_hint(hint.clone());
        let &[from, to, count] = typed else {
            return Err(fault("needs three numbers".into()));
        };
        if from.abs().max(to.abs()) > LARGEST_PARAMETER || from.is_nan() || to.is_nan() {
            return Err(fault(format!(
                "{from:e} {to:e}: both ends must be finite, and at most {LARGEST_PARAMETER:e} in magnitude"
            )));
        }
        if !(1.0..=MOST_VALUES as f64).contains(&count) || count.fract() != 0.0 {
            return Err(fault(format!("has a count of {count}, but it must be 1 to {MOST_VALUES}")));
        }
        if (count == 1.0) != (from == to) || from > to {
            return Err(fault(format!("{from} {to} {count}: values must rise, or be a single one")));
        }
        Ok(Self { from, to, count: count as usize })
    }

    pub fn values(&self) -> Vec<f64> {
        let step = (self.to - self.from) / (self.count.max(2) - 1) as f64;
        // Rounded so that 3 + 7 × 0.1 is 3.7.
        let round = |value: f64| (value * 1e12).round() / 1e12;
        (0..self.count).map(|index| round(self.from + index as f64 * step)).collect()
    }
}

/// The number of an option that must be positive and has a default.
pub(crate) fn positive(name: &str, value: f64) -> Result<f64, Failure> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(Failure::new(format!("{name} is {value}, but it must be positive and finite"))
        .with_hint("leave it out for the default"))
}
