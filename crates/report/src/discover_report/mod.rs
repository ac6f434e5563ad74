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
    /// The cell size ℓ₀, ℓ₀² = mean area of the cells used.
    pub length_scale: Quantity,
    /// Which cells were used.
    pub cells: CellCounts,
    /// How they were measured.
    pub measurement: Measurement,
    /// The grid of a flow field; `null` for velocities of cells.
    pub flow: Option<FlowGrid>,
    /// What was said of the parameters before the fits.
    pub constraints: GivenConstraints,
    /// The answer.
    pub verdict: Verdict,
    /// The answer in a sentence.
    pub sentence: String,
    /// What the answer does not say, in a sentence; empty if nothing needs to be said.
    pub caveat: String,
    /// What to measure next, in a sentence; empty if there is nothing to advise.
    pub measure_next: String,
    /// What would be known of the last model if more, or better, had been measured; `null` where that is not computed.
    pub prospects: Option<ProspectsReport>,
    /// The base model and the model with the selected effects, at the top level of the file.
    #[serde(flatten)]
    pub models: BeforeAfter<ModelFit>,
    /// The base model with a generic description of what it leaves unexplained, no mechanism; `null` where it was not fitted.
    pub description: Option<DescriptionFit>,
    /// The effects that were added, in the order of their selection.
    pub selected: Vec<SelectedEffect>,
    /// Every candidate, the smallest p first.
    pub ranking: Vec<RankedEffect>,
    /// What remains after the last fit.
    pub unexplained: Unexplained,
    /// What the squared velocities are made of.
    pub noise_budget: BeforeAfter<NoiseBudget>,
    /// What effects with a memory were predicted from; `null` if none was tried.
    pub predictors: Option<Predictors>,
    /// Data sets of `--predict`; empty without.
    pub predictions: Vec<Prediction>,
    /// What the cells do next, said before, with `--forecast`; `null` otherwise.
    pub forecast: Option<ForecastReport>,
    /// Whether simulated movies of the models are like the measured one, with `--check`; `null` otherwise.
    pub check: Option<CheckReport>,
    /// By how much the added effects lower −2 log p of velocities held out, given all others, over all folds; `null` where that is not known.
    pub likelihood_gain: Option<Gain>,
    /// The synthetic data without an effect that were fitted in the same way.
    pub null_sets: NullSets,
    /// How the search behaved on them; `null` if there are none.
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
