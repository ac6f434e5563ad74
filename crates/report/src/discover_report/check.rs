//! Whether simulated movies of the models are like the measured one.

use schemars::JsonSchema;
use serde::Serialize;

/// Simulated movies of the models compared with the measured one, in everything that was measured on it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CheckReport {
    /// Indices of the frames that are compared, zero-based; the models are run from the first of them.
    pub frames: Vec<usize>,
    /// Number of simulated movies for each model.
    #[schemars(range(min = 1))]
    pub draws: usize,
    /// Share of all movies, the measured one included, in which some quantity is at least as unusual as the most unusual one of the measured movie.
    pub p: ByModel<f64>,
    /// The quantities that were compared.
    pub quantities: Vec<CheckedQuantity>,
    /// The result in a sentence.
    pub words: String,
}

/// One value for each model.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ByModel<T> {
    /// For the base model.
    pub base: T,
    /// For the model with the effects that were added; `null` if there are none.
    pub extended: Option<T>,
}

impl<T> ByModel<T> {
    /// Both with what they are called.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &T)> {
        let extended = self.extended.as_ref().map(|own| ("with effects", own));
        [("base model", &self.base)].into_iter().chain(extended)
    }
}

/// A function that was measured, or a number, which has a single value and no axis.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CheckedQuantity {
    /// Name of the quantity, as in `observe`.
    pub name: &'static str,
    /// The quantity in words.
    pub words: &'static str,
    /// The variable that it is a function of; empty for a number.
    pub axis: &'static str,
    /// Unit of this variable.
    pub axis_unit: String,
    /// Unit of the values.
    pub unit: String,
    /// Values of the variable: lags, distances, wave numbers or values of a quantity.
    pub at: Vec<f64>,
    /// Measured value at each of these.
    pub measured: Vec<f64>,
    /// Results of the simulated movies.
    pub simulated: ByModel<Simulated>,
}

/// Results of the simulated movies of one model.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Simulated {
    /// Share of all movies that are at least as far from the mean as the measured one.
    pub p: f64,
    /// 5 % quantile of the simulated movies at each point.
    pub low: Vec<f64>,
    /// Median of the simulated movies at each point.
    pub median: Vec<f64>,
    /// 95 % quantile of the simulated movies at each point.
    pub high: Vec<f64>,
}
