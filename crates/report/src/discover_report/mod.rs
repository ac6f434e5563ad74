//! `report.json` of the command `discover`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that
//! are not finite are written as `null`. What `infer` reports too has the types of
//! [`crate::infer_report`].

mod check;
mod evidence;
mod forecast;
mod model_fit;
mod ranking;
mod selected;
mod verdict;

pub use check::{ByModel, CheckReport, CheckedQuantity, Simulated};
pub use evidence::{Calibration, NoiseBudget, NullSets, Prediction, Predictors, StructureTest, Unexplained};
pub use forecast::{ForecastReport, Forecasters};
pub use model_fit::{DescriptionFit, HeldOutError, ModelFit, ModelNmse};
pub use ranking::{CandidateStatus, EffectKind, Gain, RankedEffect};
pub use selected::{EffectCoefficient, SelectedEffect};
pub use verdict::Verdict;

use schemars::JsonSchema;
use serde::Serialize;

use crate::before_after::BeforeAfter;
use crate::infer_report::{
    CellCounts, FlowGrid, GivenConstraints, Measurement, ProspectsReport, Quantity, RunRecord,
};
use crate::units::Units;

/// Everything `discover` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DiscoverReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless.
    pub units: Units,
    /// Cell size ℓ₀; ℓ₀² is the mean area of the cells used.
    pub length_scale: Quantity,
    /// Which frames and cells were used.
    pub cells: CellCounts,
    /// How the cells were measured.
    pub measurement: Measurement,
    /// Grid of the flow field; `null` for velocities of cells.
    pub flow: Option<FlowGrid>,
    /// Constraints on the parameters that were given before the fits.
    pub constraints: GivenConstraints,
    /// The answer as one word.
    pub verdict: Verdict,
    /// The answer in a sentence.
    pub sentence: String,
    /// What the answer does not say, in a sentence; empty if nothing needs to be said.
    pub caveat: String,
    /// What to measure next, in a sentence; empty if there is nothing to advise.
    pub measure_next: String,
    /// What would be known of the last model from more, or better, measurements; `null` where it is not computed.
    pub prospects: Option<ProspectsReport>,
    /// The base model and the model with the selected effects, at the top level of the file.
    #[serde(flatten)]
    pub models: BeforeAfter<ModelFit>,
    /// The base model with a generic description of what it leaves unexplained, which is not a mechanism; `null` where it was not fitted.
    pub description: Option<DescriptionFit>,
    /// The effects that were added, in the order of their selection.
    pub selected: Vec<SelectedEffect>,
    /// All candidates, the smallest p first, after what was found about the measurement.
    pub ranking: Vec<RankedEffect>,
    /// What remains unexplained after the last fit.
    pub unexplained: Unexplained,
    /// Composition of the squared velocities.
    pub noise_budget: BeforeAfter<NoiseBudget>,
    /// The earlier velocities from which effects with a memory were predicted; `null` if no such effect was tried.
    pub predictors: Option<Predictors>,
    /// Predictions for the data sets of `--predict`; empty without it.
    pub predictions: Vec<Prediction>,
    /// Forecasts compared with what the cells did, with `--forecast`; `null` otherwise.
    pub forecast: Option<ForecastReport>,
    /// Simulated movies of the models compared with the measured one, with `--check`; `null` otherwise.
    pub check: Option<CheckReport>,
    /// Fall of −2 log p of held-out velocities, given all others, due to the added effects, summed over all folds; `null` where it is not known.
    pub likelihood_gain: Option<Gain>,
    /// Synthetic data sets without an effect that were fitted in the same way.
    pub null_sets: NullSets,
    /// How the search behaved on the null sets.
    pub calibration: Option<Calibration>,
}

impl DiscoverReport {
    /// Whether an effect was added, so that before and after differ.
    #[must_use]
    pub fn is_extended(&self) -> bool {
        !self.selected.is_empty()
    }

    /// Reasons not to trust the last fit. That the base model does not fit where it lacks something
    /// is no doubt but the finding.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        self.models.after.fit.as_ref().map_or_else(Vec::new, |fit| fit.doubts.clone())
    }
}
