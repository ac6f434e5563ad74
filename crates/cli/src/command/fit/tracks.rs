//! Tracks as a movie in scaled units, and what came of them.

use super::measured::Measured;
use super::prepare::{Prepared, Question};
use crate::failure::Failure;
use crate::run::Run;
use crate::snapshot::{Snapshot, as_given, y_sign};
use ndarray::Array3;
use voronudge_geometry::Vector;
use voronudge_infer::{Drift, Inference, Movie, Tracked};
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_report::infer_report::{MeanRemoved, TracksReport};

/// The tracks of a data set, those that break joined.
pub(crate) struct PreparedTracks {
    pub movie: Movie,
    /// How many joins were made.
    joined: usize,
}

impl PreparedTracks {
    /// The problem of some frames; the snapshots of `Prepared` hold the cells in gaps of their tracks too.
    pub fn new(
        question: Question<'_>,
        measured: Measured,
        frames: Vec<usize>,
        run: &mut Run,
    ) -> Result<(Prepared, Self), Failure> {
        let (data, arguments) = (question.data, question.arguments);
        let mut prepared = question.prepare(measured, frames, run)?;
        let scale = prepared.scale;
        let times =
            prepared.frames.iter().map(|frame| *frame as f64 * data.frame_interval / scale.time).collect();
        let mut places = Vec::with_capacity(prepared.frames.len());
        for (snapshot, observation) in prepared.snapshots.iter().zip(&prepared.observations) {
            let mut of_frame = vec![None; data.cells()];
            for (cell, r) in snapshot.cells.iter().zip(&observation.positions) {
                of_frame[*cell] = Some(*r);
            }
            places.push(of_frame);
        }
        let Some(first) = prepared.observations.first() else {
            return Err(Failure::new("there is no frame").at(arguments.data.positions_file().display()));
        };
        let (domain, field_of_view) = (first.tessellation.domain(), first.field_of_view.clone());
        let drift = match prepared.mean_removed {
            MeanRemoved::None => Drift::None,
            _ => Drift::PerInterval,
        };
        let place = |error| prepared.place(error, arguments);
        let mut movie = Movie::new(times, &places, domain, field_of_view, drift).map_err(place)?;
        let joined = movie.join();
        let observations = movie.observations().map_err(place)?;
        prepared.snapshots = (0..movie.frames())
            .map(|frame| Snapshot {
                cells: movie.present(frame).map(|track| movie.tracks[track].name(frame)).collect(),
                positions: observations[frame].positions.iter().map(|r| r * scale.length).collect(),
            })
            .collect();
        prepared.observations = observations;
        Ok((prepared, Self { movie, joined }))
    }

    /// For the report.
    pub fn report(&self, prepared: &Prepared, result: &Inference, tracked: &Tracked) -> TracksReport {
        let scale = &prepared.scale;
        let (frames, tracks) = (self.movie.frames(), &self.movie.tracks);
        TracksReport {
            tracks: tracks.len(),
            joined: self.joined,
            gaps: tracks.iter().map(|track| track.gaps()).sum(),
            begun: tracks.iter().filter(|track| track.first > 0).count(),
            ended: tracks.iter().filter(|track| track.end() < frames).count(),
            substeps: tracked.integration.substeps,
            order: tracked.integration.order,
            integration_error: tracked.integration.error,
            sigma_r: result.noise.position,
            sigma_d: result.noise.velocity * self.movie.interval(),
            drifts: match self.movie.drift {
                Drift::None => Vec::new(),
                Drift::PerInterval => {
                    tracked.drifts.iter().map(|d| [d.x * scale.length, d.y * scale.length]).collect()
                }
            },
        }
    }

    /// Writes the trajectories (frames, cells, 2), each in the column of the first name of its track.
    pub fn write(
        &self,
        out: &mut OutputDirectory,
        data: &DataSet,
        prepared: &Prepared,
        tracked: &Tracked,
    ) -> Result<(), Failure> {
        let flip = y_sign(data);
        let mut all = Array3::from_elem((self.movie.frames(), data.cells(), 2), f64::NAN);
        for (frame, places) in tracked.trajectories.iter().enumerate() {
            for (track, place) in self.movie.tracks.iter().zip(places) {
                let Some(r) = place.map(|r: Vector<f64>| r * prepared.scale.length) else { continue };
                let cell = track.name(track.first);
                all[(frame, cell, 0)] = r.x;
                all[(frame, cell, 1)] = flip * r.y;
            }
        }
        out.write_array("trajectories.npy", as_given(data, all).view())?;
        Ok(())
    }
}
