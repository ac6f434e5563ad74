//! What fits to synthetic data came to, as lines.

use super::header::Header;
use crate::failure::Failure;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Display;
use voronudge_infer::Inference;

/// Name of a part among the results.
pub(crate) const FILE: &str = "replicates.jsonl";

/// More fits of one series than can be asked for.
const MOST_REPLICATES: usize = 10_000;

/// Largest difference of two fits, as a share of the largest coefficient, that is one of rounding.
const ROUNDING: f64 = 1e-6;

/// A number that is the same again after it was written and read, also one that is not finite.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
enum Number {
    Finite(f64),
    Other(String),
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        if value.is_finite() { Self::Finite(value) } else { Self::Other(value.to_string()) }
    }
}

impl Number {
    fn value(&self) -> f64 {
        match self {
            Self::Finite(value) => *value,
            Self::Other(text) => text.parse().unwrap_or(f64::NAN),
        }
    }
}

fn numbers(values: &[f64]) -> Vec<Number> {
    values.iter().copied().map(Number::from).collect()
}

/// A line after the header.
#[derive(Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum Line {
    /// So many fits to data that a fit could have made, told by its numbers.
    Series { series: usize, count: usize, fit: Vec<Number> },
    /// What one of them came to; `null` if it failed.
    Outcome { series: usize, index: usize, values: Option<Vec<Number>> },
}

/// Fits to data that one fit could have made.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Series {
    pub count: usize,
    /// The numbers of the fit that the data are made from.
    fit: Vec<f64>,
    /// Those made, by number.
    pub outcomes: BTreeMap<usize, Option<Vec<f64>>>,
}

impl Series {
    /// None made yet.
    pub fn new(made_from: &Inference, count: usize) -> Self {
        let levels = [made_from.noise.position, made_from.noise.velocity];
        let fit = made_from.coefficients.iter().copied().chain(levels).collect();
        Self { count, fit, outcomes: BTreeMap::new() }
    }

    /// Takes over what is known of the same series.
    fn add(&mut self, other: Self) {
        self.outcomes.extend(other.outcomes);
    }

    pub fn to_line(&self, series: usize) -> Result<String, Failure> {
        Ok(serde_json::to_string(&Line::Series { series, count: self.count, fit: numbers(&self.fit) })?)
    }
}

/// A line for one fit.
pub(super) fn outcome_line(series: usize, index: usize, outcome: Option<&[f64]>) -> Result<String, Failure> {
    Ok(serde_json::to_string(&Line::Outcome { series, index, values: outcome.map(numbers) })?)
}

/// Whether data of two series were made from the same fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Agreement {
    Exact,
    /// But for rounding: the largest difference as a share of the largest coefficient.
    Rounded(f64),
    /// They were made from different fits.
    None,
}

impl Agreement {
    pub fn of(one: &Series, other: &Series) -> Self {
        if one.count != other.count || one.fit.len() != other.fit.len() {
            return Self::None;
        }
        let largest = one.fit.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let pairs = one.fit.iter().zip(&other.fit).filter(|(a, b)| a != b);
        match pairs.map(|(a, b)| (a - b).abs() / largest).fold(0.0, f64::max) {
            0.0 => Self::Exact,
            difference if difference <= ROUNDING => Self::Rounded(difference),
            _ => Self::None,
        }
    }
}

/// A header with the fits made so far, or all of them.
#[derive(Debug, Clone)]
pub(crate) struct Made {
    pub header: Header,
    pub series: Vec<Series>,
}

impl Made {
    /// Reads lines; `place` is where they come from.
    pub fn parse<'a>(lines: impl Iterator<Item = &'a str>, place: impl Display) -> Result<Self, Failure> {
        let unreadable = |line: usize, fault: String| {
            let text = format!("{place}, line {}: not a line of fits to synthetic data ({fault})", line + 1);
            Failure::new(text)
                .with_hint("another command or another version of the program may have made it; begin anew")
        };
        let mut lines = lines.enumerate();
        let first = lines.next().map_or("", |(_, line)| line);
        let header = serde_json::from_str(first).map_err(|error| unreadable(0, error.to_string()))?;
        let mut made = Self { header, series: Vec::new() };
        for (number, line) in lines {
            let line = serde_json::from_str(line).map_err(|error| unreadable(number, error.to_string()))?;
            made.take(line).ok_or_else(|| unreadable(number, "it belongs to none before".into()))?;
        }
        Ok(made)
    }

    /// Takes in a line; none if it cannot follow those before.
    fn take(&mut self, line: Line) -> Option<()> {
        match line {
            Line::Series { series, count, fit } => {
                let fit = fit.iter().map(Number::value).collect();
                let new = Series { count, fit, outcomes: BTreeMap::new() };
                (series == self.series.len() && count <= MOST_REPLICATES).then(|| self.series.push(new))
            }
            Line::Outcome { series, index, values } => {
                let own = self.series.get_mut(series).filter(|own| index < own.count)?;
                let values = values.map(|values| values.iter().map(Number::value).collect());
                own.outcomes.insert(index, values);
                Some(())
            }
        }
    }

    /// Takes over what others know of the same series, and series that are not known here.
    pub fn add(&mut self, others: Vec<Series>) {
        for (at, other) in others.into_iter().enumerate() {
            match self.series.get_mut(at) {
                Some(own) => own.add(other),
                None => self.series.push(other),
            }
        }
    }

    /// The content of a part, the same whatever the order in which the fits ended.
    pub fn to_text(&self) -> Result<String, Failure> {
        let mut text = serde_json::to_string(&self.header)? + "\n";
        for (at, series) in self.series.iter().enumerate() {
            text += &(series.to_line(at)? + "\n");
            for (index, outcome) in &series.outcomes {
                text += &(outcome_line(at, *index, outcome.as_deref())? + "\n");
            }
        }
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_as_they_were() {
        for value in [0.1 + 0.2, 1.0, -0.0, 5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let text = serde_json::to_string(&Number::from(value)).unwrap();
            let back: Number = serde_json::from_str(&text).unwrap();
            assert_eq!(back.value().to_bits(), value.to_bits(), "{text}");
        }
    }
}
