//! Tracks as a movie in scaled units, and what came of them.

use super::measured::Measured;
use super::prepare::{Prepared, Question};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::run::Run;
use crate::snapshot::{Snapshot, as_given, domain, y_sign};
use ndarray::Array3;
use voronudge_geometry::{FieldOfView, Vector};
use voronudge_infer::{Drift, Error, Inference, Jump, Latent, Movie, Request, Tracked, complete_tracks};
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_report::infer_report::{MeanRemoved, TracksReport};

/// Where the tracks of some frames jump to other cells.
fn jumps(data: &DataSet, frames: &[usize]) -> Result<Vec<Jump>, Failure> {
    let snapshots: Vec<Snapshot> = frames.iter().map(|frame| Snapshot::new(data, *frame)).collect();
    let places = places(data, &snapshots, 1.0);
    let times = frames.iter().map(|frame| *frame as f64).collect();
    // Frames that make no movie are refused for what they are later.
    let movie = Movie::new(times, &places, domain(data)?, FieldOfView::default(), Drift::None);
    Ok(movie.map_or_else(|_| Vec::new(), |movie| movie.jumps()))
}

/// Where each cell of a data set is in each frame, in some unit of length.
fn places(data: &DataSet, snapshots: &[Snapshot], unit: f64) -> Vec<Vec<Option<Vector<f64>>>> {
    let of_frame = |snapshot: &Snapshot| {
        let mut of_frame = vec![None; data.cells()];
        for (cell, r) in snapshot.cells.iter().zip(&snapshot.positions) {
            of_frame[*cell] = Some(r / unit);
        }
        of_frame
    };
    snapshots.iter().map(of_frame).collect()
}

/// The tracks of a data set, those that jump cut and those that break joined.
#[derive(Clone)]
pub(crate) struct PreparedTracks {
    pub movie: Movie,
    /// The cells that were not detected, if they were looked for.
    latent: Option<Latent>,
    /// How often a track jumped to another cell, and was cut there.
    cut: usize,
    /// How many joins were made.
    joined: usize,
}

impl PreparedTracks {
    /// The problem of some frames, before anything was found out about the cells: see [`show`](Self::show).
    pub fn new(
        question: Question<'_>,
        mut measured: Measured,
        frames: Vec<usize>,
        run: &mut Run,
    ) -> Result<(Prepared, Self), Failure> {
        let (data, arguments) = (question.data, question.arguments);
        let jumps = jumps(data, &frames)?;
        for jump in &jumps {
            measured.forget(frames[jump.frames[0]], jump.cell);
        }
        let prepared = question.prepare(measured, frames, run)?;
        let scale = prepared.scale;
        let times =
            prepared.frames.iter().map(|frame| *frame as f64 * data.frame_interval / scale.time).collect();
        let places = places(data, &prepared.snapshots, scale.length);
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
        if let Some(own) = &prepared.own_errors {
            let mut errors = vec![vec![1.0; data.cells()]; own.len()];
            for ((of_frame, snapshot), own) in errors.iter_mut().zip(&prepared.snapshots).zip(own) {
                snapshot.cells.iter().zip(own).for_each(|(cell, error)| of_frame[*cell] = *error);
            }
            movie = movie.with_position_errors(&errors);
        }
        movie.cut(&jumps);
        let joined = movie.join();
        Ok((prepared, Self { movie, latent: None, cut: jumps.len(), joined }))
    }

    /// Puts in the cells that were not detected.
    pub(super) fn complete(
        &mut self,
        request: &Request,
        missed_rate: Option<f64>,
        progress: &mut Progress,
    ) -> Result<(), Error> {
        let mut observe = |state: voronudge_infer::Progress<'_>| progress.tell(state);
        let (movie, latent) = complete_tracks(&self.movie, request, missed_rate, &mut observe)?;
        (self.movie, self.latent) = (movie, Some(latent));
        Ok(())
    }

    /// Lets the snapshots be those of the movie, cells in gaps of their tracks too.
    pub fn show(&self, prepared: &mut Prepared) -> Result<(), Error> {
        let movie = &self.movie;
        prepared.observations = movie.observations()?;
        prepared.snapshots = (0..movie.frames())
            .map(|frame| {
                let (cells, positions) = movie
                    .present(frame)
                    .filter_map(|track| {
                        let r = movie.near(track, frame)?;
                        Some((movie.tracks[track].name(frame)?, r * prepared.scale.length))
                    })
                    .unzip();
                Snapshot { cells, positions }
            })
            .collect();
        prepared.completion =
            self.latent.as_ref().map(|latent| latent.completion(movie, &prepared.observations));
        Ok(())
    }

    /// For the report.
    pub fn report(&self, prepared: &Prepared, result: &Inference, tracked: &Tracked) -> TracksReport {
        let scale = &prepared.scale;
        let frames = self.movie.frames();
        let tracks: Vec<_> = self.movie.tracks.iter().filter(|track| !track.names.is_empty()).collect();
        TracksReport {
            tracks: tracks.len(),
            cut: self.cut,
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

    /// Writes the trajectories (frames, cells, 2), each in the column of the first name of its track; the name of the file begins with `prefix`.
    pub fn write(
        &self,
        out: &mut OutputDirectory,
        prefix: &str,
        data: &DataSet,
        prepared: &Prepared,
        tracked: &Tracked,
    ) -> Result<(), Failure> {
        let flip = y_sign(data);
        let mut all = Array3::from_elem((self.movie.frames(), data.cells(), 2), f64::NAN);
        for (frame, places) in tracked.trajectories.iter().enumerate() {
            for (track, place) in self.movie.tracks.iter().zip(places) {
                let Some(r) = place.map(|r: Vector<f64>| r * prepared.scale.length) else { continue };
                let Some(cell) = track.name(track.first) else { continue };
                all[(frame, cell, 0)] = r.x;
                all[(frame, cell, 1)] = flip * r.y;
            }
        }
        out.write_array(&format!("{prefix}trajectories.npy"), as_given(data, all).view())?;
        Ok(())
    }
}
