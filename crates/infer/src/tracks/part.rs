//! Parts of a movie.

use super::movie::{Movie, Sighting, Track};
use voronudge_geometry::Vector;

impl Movie {
    /// The first frames alone. A cell in a gap that goes beyond these is there, unseen.
    pub(crate) fn beginning(&self, frames: usize) -> Self {
        let frames = frames.min(self.frames());
        let part = |(number, track): (usize, &Track)| {
            let sighting = |frame: usize| {
                track.sighting(frame).or_else(|| self.near(number, frame).map(Sighting::unseen))
            };
            let seen: Vec<_> = (track.first..track.end().min(frames)).map(sighting).collect();
            (!seen.is_empty()).then(|| Track { seen, ..track.clone() })
        };
        Self {
            times: self.times[..frames].to_vec(),
            tracks: self.tracks.iter().enumerate().filter_map(part).collect(),
            stage: self.stage[..frames].to_vec(),
            ..self.clone()
        }
    }

    /// Where a cell was seen last, up to a frame that is within its track.
    pub(crate) fn last_place(&self, track: usize, frame: usize) -> Option<Vector<f64>> {
        let own = &self.tracks[track];
        let seen = |f: usize| Some(own.thought_at(f)? + self.drifted(f, frame));
        (own.first..=frame).rev().find_map(seen)
    }

    /// Some frames that follow each other, without anything that is known from later ones, and the number of each of its tracks here.
    pub(super) fn between(&self, from: usize, to: usize) -> (Self, Vec<usize>) {
        let part = |(number, track): (usize, &Track)| {
            let (first, end) = (track.first.max(from), track.end().min(to + 1));
            let sighting = |frame: usize| {
                let unseen = || self.last_place(number, frame).map(Sighting::unseen);
                track.sighting(frame).or_else(|| if frame == first || frame == to { unseen() } else { None })
            };
            let seen: Vec<_> = (first..end).map(sighting).collect();
            let names = track.name(first).map(|name| (0, name)).into_iter().collect();
            (!seen.is_empty())
                .then(|| (Track { first: first - from, seen, names, label: track.label }, number))
        };
        let (tracks, numbers) = self.tracks.iter().enumerate().filter_map(part).unzip();
        let part = Self {
            times: self.times[from..=to].to_vec(),
            tracks,
            stage: self.stage[from..=to].to_vec(),
            ..self.clone()
        };
        (part, numbers)
    }
}
