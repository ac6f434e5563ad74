//! Whether simulated movies of the models are like the measured one.

use schemars::JsonSchema;
use serde::Serialize;

/// What models make of the cells of a movie against what was seen, for all that was measured on it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CheckReport {
    /// Frames of the data set that are compared, the first of them the one from which models go on.
    pub frames: Vec<usize>,
    /// Simulated movies of each model.
    #[schemars(range(min = 1))]
    pub draws: usize,
    /// Share of all movies, the measured one included, in which something is as unusual as the most unusual of the measured one.
    pub p: ByModel<f64>,
    /// What was compared.
    pub quantities: Vec<CheckedQuantity>,
    /// What it comes to, in a sentence.
    pub words: String,
}

/// One of each model.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ByModel<T> {
    /// The base model.
    pub base: T,
    /// The model with the effects that were added; `null` if there are none.
    pub extended: Option<T>,
}

impl<T> ByModel<T> {
    /// Both with what they are called.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &T)> {
        let extended = self.extended.as_ref().map(|own| ("with effects", own));
        [("base model", &self.base)].into_iter().chain(extended)
    }
}

/// One of the functions that were measured, or a number: a function of nothing with a single value.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CheckedQuantity {
    /// Name, as in `observe`.
    pub name: &'static str,
    /// The same in words.
    pub words: &'static str,
    /// What it is a function of; empty for a number.
    pub axis: &'static str,
    /// Unit of that.
    pub axis_unit: String,
    /// Unit of the values.
    pub unit: String,
    /// Lags, distances, wave numbers or values.
    pub at: Vec<f64>,
    /// Measured.
    pub measured: Vec<f64>,
    /// Simulated.
    pub simulated: ByModel<Simulated>,
}

/// What the movies of a model have.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Simulated {
    /// Share of all movies that are as far from the mean as the measured one.
    pub p: f64,
    /// The 5 % quantile of the simulated movies at each point.
    pub low: Vec<f64>,
    /// The median.
    pub median: Vec<f64>,
    /// The 95 % quantile.
    pub high: Vec<f64>,
}
