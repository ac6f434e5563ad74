//! At which lags, distances and wave numbers a recording is measured, and which cells are the parts that errors come from.

use crate::curve::PARTS;
use crate::tapers::{TAPERS, weights};
use crate::window::Window;
use crate::{Error, Frame, Recording};
use voronudge_geometry::{Domain, Vector, areas};

/// Lags at most, and frames whose configurations are measured at most.
const MOST_LAGS: usize = 24;
const MOST_STILLS: usize = 20;

/// Width of bins of distances, and the largest distance, in mean spacings.
const BIN: f64 = 0.25;
const REACH: f64 = 6.0;

/// Largest wave number in units of the inverse mean spacing; neighbours are at about 2π.
const LARGEST_WAVE_NUMBER: f64 = 4.0 * std::f64::consts::PI;

/// Sines that structure factors may cost.
const MOST_SINES: f64 = 2e7;

/// At what a recording is measured. Made from one recording, it serves for all that are to be compared with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Mean spacing of the cells: the root of the mean area of those that count.
    pub(crate) spacing: f64,
    /// Lags in frames, and the time of one.
    pub(crate) lags: Vec<usize>,
    pub(crate) interval: f64,
    /// Number of bins of distances.
    pub(crate) bins: usize,
    /// Frames whose configurations are measured.
    pub(crate) stills: Vec<usize>,
    /// Part that each track belongs to.
    pub(crate) parts: Vec<usize>,
    /// What waves are measured in; `None` of a periodic box, or if there is no such window.
    pub(crate) window: Option<Window>,
    /// Largest wave number.
    pub(crate) largest: f64,
}

impl Plan {
    /// For recordings like this one.
    ///
    /// # Errors
    /// [`Error::NothingInView`].
    pub fn of(recording: &Recording) -> Result<Self, Error> {
        let frames = recording.frames();
        let own: Vec<f64> = frames
            .iter()
            .flat_map(|frame| {
                let areas = areas(&frame.tessellation, &frame.positions);
                frame.in_view().map(|cell| areas[cell]).collect::<Vec<_>>()
            })
            .collect();
        if own.is_empty() {
            return Err(Error::NothingInView);
        }
        let spacing = (own.iter().sum::<f64>() / own.len() as f64).sqrt();
        let span = frames[frames.len() - 1].time - frames[0].time;
        let interval = span / (frames.len().max(2) - 1) as f64;
        let stills = evenly(frames.len(), MOST_STILLS);
        let window = Window::of(recording);
        let (side, area) = match (&window, frames[0].tessellation.domain()) {
            (_, Domain::Periodic(cell)) => (0.5 * cell.lengths()[0].min(cell.lengths()[1]), cell.area()),
            (Some(window), Domain::Open) => (0.5 * window.lengths[0].min(window.lengths[1]), window.area()),
            (None, Domain::Open) => (REACH * spacing, 0.0),
        };
        let reach = (side / spacing).min(REACH);
        // Half a disc of wave vectors, each with a sine for each cell and frame.
        let cells = area / (spacing * spacing);
        let of_unit = area / (8.0 * std::f64::consts::PI) * cells * stills.len() as f64;
        let largest = (MOST_SINES / of_unit).sqrt().min(LARGEST_WAVE_NUMBER / spacing);
        Ok(Self {
            spacing,
            lags: lags(frames.len()),
            interval,
            bins: (reach / BIN).floor() as usize,
            stills,
            parts: parts(recording),
            window,
            largest,
        })
    }

    /// With structure factors up to a wave number in units of the inverse mean spacing, if that is less.
    #[must_use]
    pub fn up_to(mut self, wave_number: f64) -> Self {
        self.largest = self.largest.min(wave_number / self.spacing);
        self
    }

    /// Root of the mean area of the cells that count.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Time between two frames on average.
    pub fn interval(&self) -> f64 {
        self.interval
    }

    /// In an open field, weights of a place beside the stage in the tapers through which waves are seen: nought outside the window.
    pub fn tapers(&self, place: Vector<f64>) -> [f64; TAPERS] {
        let within = self.window.as_ref().and_then(|window| Some(weights(window, window.share(place)?)));
        within.unwrap_or([0.0; TAPERS])
    }

    /// Width of a bin of distances.
    pub(crate) fn bin(&self) -> f64 {
        BIN * self.spacing
    }

    /// Area of the ring of a bin.
    pub(crate) fn ring_area(&self, ring: usize) -> f64 {
        std::f64::consts::PI * self.bin() * self.bin() * (2 * ring + 1) as f64
    }

    /// Rings around a place in which every cell would have been seen.
    pub(crate) fn rings_in_view(&self, frame: &Frame, place: Vector<f64>) -> usize {
        let free = frame.region.as_ref().map_or(f64::INFINITY, |region| region.distance_from_border(place));
        (0..self.bins).take_while(|ring| (ring + 1) as f64 * self.bin() <= free).count()
    }

    /// The middle of each bin of distances.
    pub(crate) fn distances(&self) -> Vec<f64> {
        (0..self.bins).map(|bin| (bin as f64 + 0.5) * self.bin()).collect()
    }

    /// The times of the lags.
    pub(crate) fn times(&self) -> Vec<f64> {
        self.lags.iter().map(|lag| *lag as f64 * self.interval).collect()
    }
}

/// Lags of 1 to so many frames less one: all, or such that each is larger than the last by about the same factor.
fn lags(frames: usize) -> Vec<usize> {
    let longest = frames.saturating_sub(1);
    if longest <= MOST_LAGS {
        return (1..=longest).collect();
    }
    let factor = (longest as f64).powf(1.0 / (MOST_LAGS - 1) as f64);
    let mut lags: Vec<usize> = (0..MOST_LAGS).map(|k| factor.powi(k as i32).round() as usize).collect();
    lags.dedup();
    lags
}

/// Some of so many frames, as far from each other as they can be.
fn evenly(frames: usize, most: usize) -> Vec<usize> {
    let count = frames.min(most);
    let last = count.saturating_sub(1).max(1);
    (0..count).map(|k| k * (frames - 1) / last).collect()
}

/// The part of each track by where the cell first counts: quarters in x, each cut in quarters in y, with equal numbers of cells.
fn parts(recording: &Recording) -> Vec<usize> {
    const SIDE: usize = 4;
    const { assert!(SIDE * SIDE == PARTS) };
    let mut first: Vec<Option<Vector<f64>>> = vec![None; recording.tracks()];
    for frame in recording.frames() {
        for cell in frame.in_view() {
            let r = frame.tessellation.domain().wrap(frame.positions[cell] - frame.stage);
            first[frame.tracks[cell]].get_or_insert(r);
        }
    }
    let mut parts = vec![0; first.len()];
    let mut seen: Vec<(usize, Vector<f64>)> =
        first.iter().enumerate().filter_map(|(track, r)| Some((track, (*r)?))).collect();
    seen.sort_by(|a, b| a.1.x.total_cmp(&b.1.x));
    let quarter = |all: usize, k: usize| (k * SIDE / all.max(1)).min(SIDE - 1);
    let all = seen.len();
    for (k, own) in seen.iter().enumerate() {
        parts[own.0] = quarter(all, k);
    }
    for column in 0..SIDE {
        let mut own: Vec<_> = seen
            .iter()
            .enumerate()
            .filter(|(k, _)| quarter(all, *k) == column)
            .map(|(_, own)| *own)
            .collect();
        own.sort_by(|a, b| a.1.y.total_cmp(&b.1.y));
        for (k, (track, _)) in own.iter().enumerate() {
            parts[*track] = column + SIDE * quarter(own.len(), k);
        }
    }
    parts
}
