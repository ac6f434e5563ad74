//! From data to a search: how cells were measured is found out first, and again with the effects that were found.

use super::Asked;
use super::history::History;
use super::measured::Findings;
use super::surroundings::{self, ExternalMap};
use crate::command::fit::{Prepared, PreparedTracks};
use crate::command::replicates::Kept;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::run::Run;
use crate::snapshot::Snapshot;
use std::sync::Arc;
use voronudge_infer::discover::{Discovery, Search, discover, discover_in_tracks};
use voronudge_infer::{Completion, Error, Observation};
use voronudge_io::DataSet;
use voronudge_model::{Environment, Structure};
use voronudge_report::discover_report::Predictors;

/// Relative change of a width, and change of a share, that is none.
const SAME: f64 = 0.02;

/// Data before anything was found out about how they were measured.
pub(super) struct Raw {
    pub prepared: Prepared,
    /// The tracks, if these are fitted themselves.
    tracks: Option<PreparedTracks>,
    /// What preceded velocities.
    pub past: Option<Past>,
}

/// What preceded the frames.
pub(super) struct Past {
    pub history: Option<History>,
    pub predictors: Option<Predictors>,
}

/// What is searched.
pub(super) struct Material {
    pub prepared: Prepared,
    /// The tracks, if these are fitted themselves.
    pub tracks: Option<PreparedTracks>,
}

/// A search.
pub(super) struct Searched {
    pub material: Material,
    pub search: Search,
    pub discovery: Discovery,
}

/// A data set with a map of a field that cells may follow.
type Data<'a> = (&'a DataSet, Option<&'a ExternalMap>);

impl Asked<'_> {
    pub fn raw(&self, data: &DataSet, run: &mut Run) -> Result<Raw, Failure> {
        if let Some((prepared, tracks)) = self.tracks(data, run)? {
            return Ok(Raw { prepared, tracks: Some(tracks), past: None });
        }
        let (prepared, past) = self.prepare(&self.arguments.snapshots, data, None, run)?;
        Ok(Raw { prepared, tracks: None, past: Some(past) })
    }

    /// Searches what was found out about the measurement by the base model, and, if an effect that was found shows it in another light, once
    /// more. What predicts velocities held out better is kept.
    pub fn searched(
        &self,
        raw: &Raw,
        data: Data<'_>,
        kept: &mut Kept,
        progress: &mut Progress,
    ) -> Result<Searched, Failure> {
        let place = |error: Error| raw.prepared.place(error, &self.arguments.snapshots);
        let base = &raw.prepared.request.structure;
        let material = self.understood(raw, base, progress).map_err(place)?;
        let found = self.search(raw, self.surrounded(raw, data, material)?, kept, progress)?;
        let Some(structure) = extended(raw, &found.discovery) else { return Ok(found) };
        match self.understood(raw, &structure, progress) {
            Ok(again) if !again.is_measured_like(&found.material) => {
                let again = self.search(raw, self.surrounded(raw, data, again)?, kept, progress)?;
                Ok(if again.predicts_better_than(&found) { again } else { found })
            }
            Err(Error::Interrupted) => Err(place(Error::Interrupted)),
            // Beside the effects the data do not tell how they were measured.
            Ok(_) | Err(_) => Ok(found),
        }
    }

    /// The data with what a model says about how they were measured.
    fn understood(
        &self,
        raw: &Raw,
        structure: &Structure,
        progress: &mut Progress,
    ) -> Result<Material, Error> {
        let (mut prepared, mut tracks) = (raw.prepared.clone(), raw.tracks.clone());
        let base = std::mem::replace(&mut prepared.request.structure, structure.clone());
        let surroundings = Arc::new(Environment::default().about(surroundings::origin(&prepared)));
        let about = |frame: &Observation| frame.clone().within(surroundings.clone());
        prepared.observations = prepared.observations.iter().map(about).collect();
        self.arguments.latent.understand(tracks.as_mut(), &mut prepared, progress)?;
        prepared.request.structure = base;
        Ok(Material { prepared, tracks })
    }

    /// The same with what surrounds and preceded the cells.
    fn surrounded(
        &self,
        raw: &Raw,
        (data, map): Data<'_>,
        mut material: Material,
    ) -> Result<Material, Failure> {
        if let Some(past) = &raw.past {
            let snapshots = &self.arguments.snapshots;
            surroundings::surround(&mut material.prepared, (snapshots, data), map, past.history.as_ref())?;
        }
        Ok(material)
    }

    fn search(
        &self,
        raw: &Raw,
        material: Material,
        kept: &mut Kept,
        progress: &mut Progress,
    ) -> Result<Searched, Failure> {
        let Material { prepared, tracks } = &material;
        let search = Search {
            identities: identities(prepared),
            determined: Findings::determined(prepared),
            ..self.arguments.options.search(self.candidates.to_vec(), prepared.request.clone())
        };
        let mut observe = |state: voronudge_infer::Progress<'_>| progress.tell(state);
        let searched: Result<Discovery, Error> = match tracks {
            Some(tracks) => discover_in_tracks(&tracks.movie, &search, &mut observe),
            None => discover(&prepared.observations, &search, kept, &mut observe),
        };
        let discovery = searched.map_err(|error| raw.prepared.place(error, &self.arguments.snapshots))?;
        Ok(Searched { material, search, discovery })
    }
}

/// The model with the effects that were found, if these can act on the data as they were given: on any cells, not on those that are known by
/// name.
fn extended(raw: &Raw, discovery: &Discovery) -> Option<Structure> {
    let prepared = &raw.prepared;
    if discovery.selected.is_empty() || raw.tracks.is_some() {
        return None;
    }
    let domain = prepared.observations.first()?.tessellation.domain();
    let anywhere = Environment::default().about(surroundings::origin(prepared));
    let columns = discovery.columns_there(|effect| effect.columns(&anywhere, domain)).ok()?;
    // What has no columns shows no measurement in another light.
    (!columns.is_empty()).then(|| prepared.request.structure.with(&columns))
}

impl Searched {
    fn predicts_better_than(&self, other: &Self) -> bool {
        let error = |own: &Self| own.discovery.after.held_out.map(|error| error.value);
        error(self).zip(error(other)).is_some_and(|(own, other)| own < other)
    }
}

impl Material {
    /// Whether the same was found out about the measurement.
    fn is_measured_like(&self, other: &Self) -> bool {
        let changes = |material: &Self| material.prepared.completion.as_ref().map(all_changes);
        let (own, others) = (&self.prepared.measurement, &other.prepared.measurement);
        let width = |own: &voronudge_infer::Measurement| own.width.map_or(0.0, |width| width.value);
        own.kind == others.kind
            && (width(own) - width(others)).abs() <= SAME * width(others)
            && (own.share.value - others.share.value).abs() <= SAME
            && changes(self) == changes(other)
    }
}

/// The changes of each frame: of which kind, and which detections they take away.
fn all_changes(completion: &Completion) -> Vec<Vec<(voronudge_infer::ChangeKind, Vec<usize>)>> {
    let of_frame = |frame: &voronudge_infer::CompletedFrame| {
        frame.changes.iter().map(|change| (change.kind, change.removed.clone())).collect()
    };
    completion.frames.iter().map(of_frame).collect()
}

/// The name of a cell that is no detection.
const NOT_TRACKED: i64 = -1;

/// The tracks of the cells of each frame, where there are several frames.
fn identities(prepared: &Prepared) -> Option<Vec<Vec<i64>>> {
    let tracked = prepared.frames.len() > 1 && prepared.velocities.flow().is_none();
    let of_frame = |(index, snapshot): (usize, &Snapshot)| {
        let names = snapshot.cells.iter().map(|&cell| cell as i64).collect();
        prepared.of_cells(index, names, &NOT_TRACKED)
    };
    tracked.then(|| prepared.snapshots.iter().enumerate().map(of_frame).collect())
}
