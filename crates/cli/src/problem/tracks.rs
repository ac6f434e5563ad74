//! Tracks as a movie in scaled units.

use super::{Detections, Error, Observer, Problem};
use voronudge_geometry::{FieldOfView, Vector};
use voronudge_infer::{Drift, Jump, Latent, Movie, complete_tracks, measure_tracks};
use voronudge_io::{DataSet, Snapshot};

/// Where the tracks of some frames jump to other cells.
pub(super) fn jumps(data: &DataSet, frames: &[usize]) -> Result<Vec<Jump>, Error> {
    let snapshots: Vec<Snapshot> = frames.iter().map(|frame| Snapshot::new(data, *frame)).collect();
    let places = places(data, &snapshots, 1.0);
    let times = frames.iter().map(|frame| *frame as f64).collect();
    // Frames that make no movie are refused for what they are later.
    let movie = Movie::new(times, &places, data.domain()?, FieldOfView::default(), Drift::None);
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
#[derive(Debug, Clone)]
pub struct Tracks {
    /// The tracks as they are fitted, scaled.
    pub movie: Movie,
    /// The cells that were not detected, if they were looked for.
    latent: Option<Latent>,
    /// How often a track jumped to another cell, and was cut there.
    pub cut: usize,
    /// How many joins were made.
    pub joined: usize,
}

impl Tracks {
    /// The tracks of a problem, before anything was found out about the cells.
    pub(super) fn new(data: &DataSet, problem: &Problem, jumps: &[Jump]) -> Result<Self, Error> {
        let scale = problem.scale;
        let times =
            problem.frames.iter().map(|frame| *frame as f64 * data.frame_interval / scale.time).collect();
        let places = places(data, &problem.snapshots, scale.length);
        let first = problem.observations.first().ok_or(Error::NoFrame)?;
        let (domain, field_of_view) = (first.tessellation.domain(), first.field_of_view.clone());
        let drift = if problem.mean_removed { Drift::PerInterval } else { Drift::None };
        let mut movie = Movie::new(times, &places, domain, field_of_view, drift)?;
        if let Some(own) = &problem.own_errors {
            let mut errors = vec![vec![1.0; data.cells()]; own.len()];
            for ((of_frame, snapshot), own) in errors.iter_mut().zip(&problem.snapshots).zip(own) {
                snapshot.cells.iter().zip(own).for_each(|(cell, error)| of_frame[*cell] = *error);
            }
            movie = movie.with_position_errors(&errors);
        }
        movie.cut(jumps);
        let joined = movie.join();
        Ok(Self { movie, latent: None, cut: jumps.len(), joined })
    }

    /// Gives the cells their labels: of each the first that it has in these frames.
    pub(super) fn label(&mut self, data: &DataSet, frames: &[usize]) {
        let mut labels = vec![None; if data.labels.is_some() { data.cells() } else { 0 }];
        for of_frame in frames.iter().filter_map(|&frame| data.all_labels(frame)) {
            labels.iter_mut().zip(of_frame).for_each(|(label, own)| *label = label.or(own));
        }
        self.movie.label(&labels);
    }
}

impl Problem {
    /// Finds cells of tracks that were not detected, if that was not said to be needless.
    pub(super) fn complete_tracks(
        &self,
        tracks: &mut Tracks,
        observe: Observer<'_>,
    ) -> Result<(), voronudge_infer::Error> {
        if let Detections::Completed { missed_rate } = self.detections {
            let (movie, latent) = complete_tracks(&tracks.movie, &self.request, missed_rate, observe)?;
            (tracks.movie, tracks.latent) = (movie, Some(latent));
        }
        Ok(())
    }

    /// Determines how the cells of tracks were measured.
    pub(super) fn measure_tracks(
        &mut self,
        tracks: &mut Tracks,
        observe: Observer<'_>,
    ) -> Result<(), voronudge_infer::Error> {
        let (movie, measurement) = measure_tracks(&tracks.movie, &self.request, &self.known, observe)?;
        tracks.movie = movie;
        self.measurement = measurement;
        self.show(tracks)
    }

    /// Lets the snapshots be those of the movie, cells in gaps of their tracks too.
    fn show(&mut self, tracks: &Tracks) -> Result<(), voronudge_infer::Error> {
        let movie = &tracks.movie;
        self.observations = movie.observations()?;
        self.snapshots = (0..movie.frames())
            .map(|frame| {
                let (cells, positions) = movie
                    .present(frame)
                    .filter_map(|track| {
                        let r = movie.near(track, frame)?;
                        Some((movie.tracks[track].name(frame)?, r * self.scale.length))
                    })
                    .unzip();
                Snapshot { cells, positions }
            })
            .collect();
        self.completion = tracks.latent.as_ref().map(|latent| latent.completion(movie, &self.observations));
        Ok(())
    }
}
