//! What is found on one data set, put to the test on others.

use super::Asked;
use super::report::held_out_error;
use crate::failure::Failure;
use crate::problem::Problem;
use crate::run::Run;
use clap::Args;
use std::path::PathBuf;
use voronudge_infer::Observation;
use voronudge_infer::discover::{Absent, Discovery, Search, Transfer};
use voronudge_io::DataSet;
use voronudge_report::discover_report::Prediction;

#[derive(Debug, Args)]
#[command(next_help_heading = "Search")]
pub(super) struct PredictionArguments {
    /// Predict the velocities of another data set with the model found on this one, without fitting. May be repeated.
    #[arg(long, value_name = "DATASET")]
    predict: Vec<PathBuf>,
}

/// Another data set in the scale of the fit.
pub(super) struct Other {
    folder: PathBuf,
    observations: Vec<Observation>,
}

impl PredictionArguments {
    /// Whether other data sets are to be predicted.
    pub fn is_asked(&self) -> bool {
        !self.predict.is_empty()
    }

    /// Reads the other data sets; their files count as inputs of the first.
    pub fn load(
        &self,
        asked: &Asked<'_>,
        (data, prepared): (&mut DataSet, &Problem),
        run: &mut Run,
    ) -> Result<Vec<Other>, Failure> {
        let mut others = Vec::new();
        for folder in &self.predict {
            let snapshots = asked.arguments.snapshots.of_folder(folder);
            let other = snapshots.data.load()?;
            for (what, own, given) in [
                ("length", &data.length_unit, &other.length_unit),
                ("time", &data.time_unit, &other.time_unit),
            ] {
                if own != given {
                    return Err(Failure::new(format!(
                        "the unit of {what} is {given}, but that of the data that are fitted is {own}"
                    ))
                    .with_hint("coefficients have units: bring both data sets to the same")
                    .at(folder.display()));
                }
            }
            let own = asked.other(&snapshots, &other, prepared.scale, run)?;
            data.inputs.extend(other.inputs);
            others.push(Other { folder: folder.clone(), observations: own.observations });
        }
        Ok(others)
    }
}

impl Other {
    /// The errors of the base model and of that with the effects found, with parameters as they are; none, with a warning, if
    /// an effect cannot act there.
    pub fn predicted(&self, search: &Search, discovery: &Discovery, run: &mut Run) -> Option<Prediction> {
        let dataset = self.folder.display().to_string();
        let transfer = discovery.predict(search, &self.observations);
        let absent = |absent: &Absent| run.warn(format!("{dataset} is not predicted: {absent}"));
        let Transfer { before, after, gain } = transfer.inspect_err(absent).ok()?;
        Some(Prediction {
            dataset,
            velocities: self.observations.iter().map(|frame| frame.targets().count()).sum(),
            before: held_out_error(before),
            after: held_out_error(after),
            gain: gain.into(),
        })
    }
}
