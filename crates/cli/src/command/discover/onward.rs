//! The models of a search, to go on by themselves among the cells of a movie.

use super::Asked;
use super::material::Searched;
use crate::failure::Failure;
use crate::problem::{self, Measured, Problem};
use crate::run::Run;
use voronudge_infer::Movie;
use voronudge_infer::forecast::Forecaster;
use voronudge_io::{DataSet, Difference, derive_velocities};
use voronudge_model::Structure;

/// The cells of some frames, in the scale of the fit.
pub(super) fn movie(
    asked: &Asked<'_>,
    data: &DataSet,
    prepared: &Problem,
    frames: Vec<usize>,
    run: &mut Run,
) -> Result<Movie, Failure> {
    let snapshots = &asked.arguments.snapshots;
    let means = derive_velocities(data, Difference::Forward)
        .map_err(|error| Failure::from(error).at(snapshots.data.positions_file().display()))?;
    let inquiry = asked.inquiry(snapshots, data, Some(prepared.scale));
    let onward = inquiry.prepare(Measured::Tracks(means), frames, run)?;
    let tracks = onward.tracks.ok_or(problem::Error::NoFrame)?;
    Ok(tracks.movie.with_positions_at(prepared.measurement.share.value))
}

/// The base model, and the one with effects if there are some that can act in a movie.
pub(super) struct Rivals<'a> {
    searched: &'a Searched,
    extended: Option<Structure>,
}

impl<'a> Rivals<'a> {
    /// Says so where the effects cannot act.
    pub fn new(searched: &'a Searched, movie: &Movie, run: &mut Run) -> Self {
        let discovery = &searched.discovery;
        let columns = discovery.columns_there(|effect| movie.columns(effect));
        let extended = match columns {
            Err(absent) => {
                run.warn(format!("the model with effects does not go on by itself: {absent}"));
                None
            }
            Ok(columns) if discovery.shared().next().is_some() => {
                Some(searched.search.fit.structure.with(&columns))
            }
            Ok(_) => None,
        };
        Self { searched, extended }
    }

    /// How many models there are.
    pub fn count(&self) -> usize {
        1 + usize::from(self.extended.is_some())
    }

    /// The models, the base model first.
    pub fn models(&self) -> Vec<Forecaster<'_>> {
        let Searched { search, discovery, .. } = self.searched;
        let base = (&search.fit.structure, &discovery.before);
        let extended = self.extended.as_ref().map(|structure| (structure, &discovery.after));
        std::iter::once(base)
            .chain(extended)
            .map(|(structure, fitted)| Forecaster {
                structure,
                coefficients: fitted.inference.coefficients.as_slice(),
                tracked: fitted.tracked.as_ref(),
            })
            .collect()
    }
}
