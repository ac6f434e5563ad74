//! From data to a search: how cells were measured is found out first, and again with the effects that were found.

use super::Asked;
use super::history::History;
use super::surroundings::{self, ExternalMap};
use crate::command::fit::with_location;
use crate::command::replicates::Kept;
use crate::failure::Failure;
use crate::problem::Problem;
use crate::progress::Progress;
use crate::run::Run;
use std::sync::Arc;
use voronudge_infer::discover::{Discovery, Search};
use voronudge_infer::{Completion, Error, Observation};
use voronudge_io::DataSet;
use voronudge_model::{Environment, Structure};
use voronudge_report::discover_report::Predictors;

/// Relative change of a width, and change of a share, that is none.
const SAME: f64 = 0.02;

/// Data before anything was found out about how they were measured.
pub(super) struct Raw {
    pub prepared: Problem,
    /// What preceded velocities.
    pub past: Option<Past>,
}

/// What preceded the frames.
pub(super) struct Past {
    pub history: Option<History>,
    pub predictors: Option<Predictors>,
}

/// A search.
pub(super) struct Searched {
    pub prepared: Problem,
    pub search: Search,
    pub discovery: Discovery,
}

/// A data set with a map of a field that cells may follow.
type Data<'a> = (&'a DataSet, Option<&'a ExternalMap>);

impl Asked<'_> {
    pub fn raw(&self, data: &DataSet, run: &mut Run) -> Result<Raw, Failure> {
        if let Some(prepared) = self.tracks(data, run)? {
            return Ok(Raw { prepared, past: None });
        }
        let (prepared, past) = self.prepare(&self.arguments.snapshots, data, None, run)?;
        Ok(Raw { prepared, past: Some(past) })
    }

    /// Searches what was found out about the measurement by the base model, and, if the effects that were found show it in another light, once
    /// more. What predicts velocities held out better is kept.
    pub fn searched(
        &self,
        raw: &Raw,
        data: Data<'_>,
        kept: &mut Kept,
        progress: &mut Progress,
    ) -> Result<Searched, Failure> {
        let placed = |error: Error| with_location(&raw.prepared, error, &self.arguments.snapshots);
        let base = &raw.prepared.request.structure;
        let understood = self.understood(raw, base, progress).map_err(placed)?;
        let found = self.search(raw, self.surrounded(raw, data, understood)?, kept, progress)?;
        let mut worse: Option<Searched> = None;
        for structure in extended(raw, &found.discovery) {
            let again = match self.understood(raw, &structure, progress) {
                Ok(again) => again,
                Err(Error::Interrupted) => return Err(placed(Error::Interrupted)),
                // Beside the effects the data do not tell how they were measured.
                Err(_) => continue,
            };
            if worse.iter().chain([&found]).any(|known| are_measured_alike(&again, &known.prepared)) {
                continue;
            }
            let again = self.search(raw, self.surrounded(raw, data, again)?, kept, progress)?;
            if again.predicts_better_than(&found) {
                return Ok(again);
            }
            worse = Some(again);
        }
        Ok(found)
    }

    /// The data with what a model says about how they were measured.
    fn understood(
        &self,
        raw: &Raw,
        structure: &Structure,
        progress: &mut Progress,
    ) -> Result<Problem, Error> {
        let mut prepared = raw.prepared.clone();
        let base = std::mem::replace(&mut prepared.request.structure, structure.clone());
        let surroundings = Arc::new(Environment::default().about(prepared.origin()));
        let about = |frame: &Observation| frame.clone().within(surroundings.clone());
        prepared.observations = prepared.observations.iter().map(about).collect();
        prepared.understand(&mut |state| progress.tell(state))?;
        prepared.request.structure = base;
        Ok(prepared)
    }

    /// The same with what surrounds and preceded the cells.
    fn surrounded(
        &self,
        raw: &Raw,
        (data, map): Data<'_>,
        mut prepared: Problem,
    ) -> Result<Problem, Failure> {
        prepared.label_tracks(data);
        if let Some(past) = &raw.past {
            let snapshots = &self.arguments.snapshots;
            surroundings::surround(&mut prepared, (snapshots, data), map, past.history.as_ref())?;
        }
        Ok(prepared)
    }

    fn search(
        &self,
        raw: &Raw,
        prepared: Problem,
        kept: &mut Kept,
        progress: &mut Progress,
    ) -> Result<Searched, Failure> {
        let search = self.arguments.options.search(self.candidates.to_vec(), prepared.search());
        let searched = prepared.discover(&search, kept, &mut |state| progress.tell(state));
        let discovery =
            searched.map_err(|error| with_location(&raw.prepared, error, &self.arguments.snapshots))?;
        Ok(Searched { prepared, search, discovery })
    }
}

/// The model with the first effect that was found, and with all of them, as far as these can act on the data as they were given: on any cells,
/// not on those that are known by name. An effect that stands out under a wrong idea of the measurement may draw others after it that make up for
/// what is wrong; with these in the model the idea would look right.
fn extended(raw: &Raw, discovery: &Discovery) -> Vec<Structure> {
    let prepared = &raw.prepared;
    let domain = match prepared.observations.first() {
        Some(frame) if prepared.tracks.is_none() => frame.tessellation.domain(),
        _ => return Vec::new(),
    };
    let anywhere = Environment::default().about(prepared.origin());
    let there = discovery.columns_there(|effect| effect.columns(&anywhere, domain));
    // What has no columns shows no measurement in another light.
    let first = discovery.selected.iter().map(|own| own.columns.len()).find(|columns| *columns > 0);
    let (Ok(all), Some(first)) = (there, first) else { return Vec::new() };
    let mut ends = vec![first, all.len()];
    ends.dedup();
    ends.into_iter().map(|end| prepared.request.structure.with(&all[..end])).collect()
}

impl Searched {
    fn predicts_better_than(&self, other: &Self) -> bool {
        let error = |own: &Self| own.discovery.after.held_out.map(|error| error.value);
        error(self).zip(error(other)).is_some_and(|(own, other)| own < other)
    }
}

/// Whether the same was found out about the measurement.
fn are_measured_alike(one: &Problem, other: &Problem) -> bool {
    let changes = |prepared: &Problem| prepared.completion.as_ref().map(all_changes);
    let (own, others) = (&one.measurement, &other.measurement);
    let width = |own: &voronudge_infer::Measurement| own.width.map_or(0.0, |width| width.value);
    own.kind == others.kind
        && (width(own) - width(others)).abs() <= SAME * width(others)
        && (own.share.value - others.share.value).abs() <= SAME
        && changes(one) == changes(other)
}

/// The changes of each frame: of which kind, and which detections they take away.
fn all_changes(completion: &Completion) -> Vec<Vec<(voronudge_infer::ChangeKind, Vec<usize>)>> {
    let of_frame = |frame: &voronudge_infer::CompletedFrame| {
        frame.changes.iter().map(|change| (change.kind, change.removed.clone())).collect()
    };
    completion.frames.iter().map(of_frame).collect()
}
