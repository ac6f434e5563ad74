//! Cells followed from frame to frame.

use crate::Error;
use std::sync::Arc;
use voronudge_geometry::{Domain, FieldOfView, Vector};
use voronudge_model::Environment;

/// A cell has room for itself if none is nearer than this, in units of ℓ₀.
const ROOM: f64 = 0.5;

/// Where a cell was seen in a frame, or is thought to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// The position.
    pub position: Vector<f64>,
    /// Standard deviation of each of its coordinates, in units of that of the noise levels: infinite if the cell was not detected.
    pub error: f64,
}

impl Sighting {
    /// Of a cell that was not detected.
    pub(super) fn unseen(position: Vector<f64>) -> Self {
        Self { position, error: f64::INFINITY }
    }
}

/// One cell while it is followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// First frame in which the cell was seen.
    pub first: usize,
    /// Where it was seen from then on, or is thought to be, up to the last frame; `None` in a gap. In a periodic box positions go
    /// on beyond its sides, so that two that follow each other are less than half a box apart.
    pub seen: Vec<Option<Sighting>>,
    /// Its names, each with the frame from which on it bears it: its number in the frames that the movie was made from. None for a cell that
    /// was never detected.
    pub names: Vec<(usize, usize)>,
    /// Its label, if cells have labels.
    pub label: Option<i64>,
}

impl Track {
    /// Frame after the last in which the cell was seen.
    pub fn end(&self) -> usize {
        self.first + self.seen.len()
    }

    /// Where the cell was seen in a frame.
    pub fn at(&self, frame: usize) -> Option<Vector<f64>> {
        self.sighting(frame).filter(|sighting| sighting.error.is_finite()).map(|sighting| sighting.position)
    }

    /// Where the cell was seen in a frame, or is thought to be.
    pub(super) fn thought_at(&self, frame: usize) -> Option<Vector<f64>> {
        self.sighting(frame).map(|sighting| sighting.position)
    }

    /// Standard deviation of each coordinate of its position in a frame, in units of that of the noise levels: infinite if it was not seen.
    pub(super) fn error(&self, frame: usize) -> f64 {
        self.sighting(frame).map_or(f64::INFINITY, |sighting| sighting.error)
    }

    pub(crate) fn sighting(&self, frame: usize) -> Option<Sighting> {
        self.seen.get(frame.checked_sub(self.first)?).copied().flatten()
    }

    /// The name that it bears in a frame, if it has one.
    pub fn name(&self, frame: usize) -> Option<usize> {
        let later = self.names.partition_point(|(from, _)| *from <= frame);
        self.names.get(later.saturating_sub(1)).map(|name| name.1)
    }

    /// Goes on with what was seen from a frame on, perhaps at other images of a periodic box.
    pub(super) fn go_on(
        &mut self,
        domain: Domain,
        frame: usize,
        seen: impl Iterator<Item = Option<Sighting>> + Clone,
    ) {
        if self.seen.is_empty() {
            self.first = frame;
        }
        self.seen.resize(frame - self.first, None);
        let before = self.seen.iter().rev().flatten().next().map(|sighting| sighting.position);
        let image = match (before, seen.clone().flatten().next()) {
            (Some(from), Some(to)) => domain.shortest(to.position - from) - (to.position - from),
            _ => Vector::zeros(),
        };
        let moved = |seen: Sighting| Sighting { position: seen.position + image, ..seen };
        self.seen.extend(seen.map(|seen| seen.map(moved)));
    }

    /// Lets the cell be at a place, unseen, in the frame before its first or after its last.
    pub(super) fn lengthen(&mut self, frame: usize, position: Vector<f64>) {
        let unseen = Some(Sighting::unseen(position));
        if frame < self.first {
            self.first = frame;
            self.seen.insert(0, unseen);
        } else {
            self.seen.push(unseen);
        }
    }

    /// Takes back what was put at its beginning or end.
    pub(super) fn shorten(&mut self, frame: usize) {
        if frame == self.first {
            self.first += 1;
            self.seen.remove(0);
        } else {
            self.seen.truncate(frame - self.first);
        }
    }

    /// Moves the cell, unseen in a frame, to another place.
    pub(super) fn put(&mut self, frame: usize, position: Vector<f64>) {
        self.seen[frame - self.first] = Some(Sighting::unseen(position));
    }

    /// Number of frames within the track in which the cell was not seen.
    pub fn gaps(&self) -> usize {
        (self.first..self.end()).filter(|frame| self.at(*frame).is_none()).count()
    }
}

/// What moves all cells alike from one frame to the next without being a motion of the tissue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drift {
    /// Nothing: the camera stands still.
    None,
    /// A translation in each interval: drift or jumps of the stage.
    PerInterval,
}

/// Positions of cells in several frames, the same cells under the same number.
#[derive(Debug, Clone)]
pub struct Movie {
    /// Time of each frame (F), ascending.
    pub times: Vec<f64>,
    /// The cells.
    pub tracks: Vec<Track>,
    /// The boundary condition.
    pub domain: Domain,
    /// Where every cell would have been seen.
    pub field_of_view: FieldOfView,
    /// What moves all cells alike.
    pub drift: Drift,
    /// The share c of the way from a cell's site to its centroid at which its position is measured.
    pub(super) share: f64,
    /// The usual time between two frames.
    pub(super) usual: f64,
    /// How far the stage had moved in each frame, as far as the increments tell.
    pub(super) stage: Vec<Vector<f64>>,
    /// What terms refer to: the middle of the box, or the mean place of the cells.
    pub(super) environment: Arc<Environment>,
}

impl Movie {
    /// A movie from the position of each cell in each frame; `frames` and `times` are as long as each other (F), each frame has an
    /// entry for every cell. Cells that are in no frame have no track.
    ///
    /// # Errors
    /// [`Error::Frames`] for fewer than two frames, times that do not ascend, or frames of different length.
    pub fn new(
        times: Vec<f64>,
        frames: &[Vec<Option<Vector<f64>>>],
        domain: Domain,
        field_of_view: FieldOfView,
        drift: Drift,
    ) -> Result<Self, Error> {
        let cells = frames.first().map_or(0, Vec::len);
        let ascending = times.windows(2).all(|pair| pair[1] > pair[0]) && times.iter().all(|t| t.is_finite());
        if frames.len() < 2 || times.len() != frames.len() || !ascending {
            return Err(Error::Frames { frames: frames.len(), times: times.len() });
        }
        if frames.iter().any(|frame| frame.len() != cells) {
            return Err(Error::Frames { frames: frames.len(), times: times.len() });
        }
        let tracks = (0..cells).filter_map(|cell| track(frames, cell, domain)).collect();
        let mut lengths: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        lengths.sort_unstable_by(f64::total_cmp);
        let usual = lengths[lengths.len() / 2];
        let stage = vec![Vector::zeros(); times.len()];
        let environment = Arc::new(Environment::default().about(middle(domain, frames)));
        let mut movie =
            Self { times, tracks, domain, field_of_view, drift, share: 0.0, usual, stage, environment };
        for frame in 1..movie.frames() {
            movie.stage[frame] = movie.stage[frame - 1] + movie.median_step(frame - 1);
        }
        Ok(movie)
    }

    /// Lets positions have errors of their own: standard deviations in units of that of the noise levels, for each frame of each cell that the
    /// movie was made from. Tracks must not be joined yet.
    #[must_use]
    pub fn with_position_errors(mut self, relative: &[Vec<f64>]) -> Self {
        for track in &mut self.tracks {
            let name = track.name(track.first);
            for (frame, sighting) in (track.first..).zip(&mut track.seen) {
                let error = name.and_then(|name| relative.get(frame)?.get(name));
                if let (Some(sighting), Some(error)) = (sighting, error) {
                    sighting.error = *error;
                }
            }
        }
        self
    }

    /// Takes positions for points at a share c of the way from the sites to the centroids of cells.
    #[must_use]
    pub fn with_positions_at(self, share: f64) -> Self {
        Self { share, ..self }
    }

    /// The share c of the way from a cell's site to its centroid at which its position is measured.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.times.len()
    }

    /// The usual time between two frames: the median.
    pub fn interval(&self) -> f64 {
        self.usual
    }

    /// The displacements of the cells seen in a frame and in the next: cell and displacement.
    pub fn increments(&self, frame: usize) -> impl Iterator<Item = (usize, Vector<f64>)> + '_ {
        let seen =
            move |(cell, track): (usize, &Track)| Some((cell, track.at(frame + 1)? - track.at(frame)?));
        self.tracks.iter().enumerate().filter_map(seen)
    }

    /// Where a cell was seen in a frame, or is thought to be, or, in a gap, on the straight line between the frames before and after in which it was, drift of
    /// the stage apart; `None` before the first and after the last.
    pub fn near(&self, track: usize, frame: usize) -> Option<Vector<f64>> {
        let track = &self.tracks[track];
        if let Some(place) = track.thought_at(frame) {
            return Some(place);
        }
        let seen = |f: usize| Some((f, track.thought_at(f)? - self.stage[f]));
        let before = (track.first..frame).rev().find_map(seen)?;
        let after = (frame + 1..track.end()).find_map(seen)?;
        let share = (self.times[frame] - self.times[before.0]) / (self.times[after.0] - self.times[before.0]);
        Some(before.1 + (after.1 - before.1) * share + self.stage[frame])
    }

    /// The cell nearest to a place in a frame, and its distance.
    pub(super) fn nearest(&self, frame: usize, place: Vector<f64>) -> Option<(f64, usize)> {
        let distance = |track: usize| {
            let there = self.near(track, frame)?;
            Some((self.domain.shortest(there - place).norm(), track))
        };
        self.present(frame).filter_map(distance).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The cell that has the place in a frame where another might be.
    pub(super) fn taken_by(&self, frame: usize, place: Vector<f64>) -> Option<usize> {
        self.nearest(frame, place).filter(|(distance, _)| *distance < ROOM).map(|(_, track)| track)
    }

    /// What moves all cells alike in an interval, as far as the increments tell before any fit: their median, which a few fast
    /// cells do not decide.
    pub fn first_drift(&self, frame: usize) -> Vector<f64> {
        self.drifted(frame, frame + 1)
    }

    /// The same from one frame to another.
    pub(crate) fn drifted(&self, from: usize, to: usize) -> Vector<f64> {
        self.stage[to] - self.stage[from]
    }

    /// The median of the increments, if the stage may move.
    fn median_step(&self, frame: usize) -> Vector<f64> {
        if self.drift == Drift::None {
            return Vector::zeros();
        }
        let all: Vec<Vector<f64>> = self.increments(frame).map(|(_, step)| step).collect();
        let median = |axis: usize| {
            let mut values: Vec<f64> = all.iter().map(|step| step[axis]).collect();
            values.sort_unstable_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(0.0)
        };
        Vector::new(median(0), median(1))
    }

    /// The tracks of the cells of [`observations`](Self::observations) in a frame.
    pub fn present(&self, frame: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.tracks.len())
            .filter(move |track| self.tracks[*track].first <= frame && frame < self.tracks[*track].end())
    }
}

/// The middle of the box, or the mean place of the cells over all frames.
fn middle(domain: Domain, frames: &[Vec<Option<Vector<f64>>>]) -> Vector<f64> {
    if let Domain::Periodic(cell_box) = domain {
        return 0.5 * Vector::from(cell_box.lengths());
    }
    let seen = frames.iter().flatten().flatten();
    let (sum, count) = seen.fold((Vector::zeros(), 0.0), |(sum, count), r| (sum + r, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// One cell's track, if it was seen at all.
fn track(frames: &[Vec<Option<Vector<f64>>>], cell: usize, domain: Domain) -> Option<Track> {
    let first = frames.iter().position(|frame| frame[cell].is_some())?;
    let last = frames.iter().rposition(|frame| frame[cell].is_some())?;
    let mut previous: Option<Vector<f64>> = None;
    let seen = frames[first..=last].iter().map(|frame| {
        let place = frame[cell].map(|r| previous.map_or(r, |from| from + domain.shortest(r - from)));
        previous = place.or(previous);
        place.map(|position| Sighting { position, error: 1.0 })
    });
    Some(Track { first, seen: seen.collect(), names: vec![(first, cell)], label: None })
}
