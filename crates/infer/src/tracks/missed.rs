//! Cells of a movie that were not detected.
//!
//! Over three frames a cell moves about as fast as from the first to the third, and is at its mean place in the second: to second order in the
//! time between frames that is a snapshot with velocities. Cells are looked for in these as in any snapshot. What is found again in the
//! next frame, moved along with its neighbours, is one cell. It goes on as far as there is room for it, or until a track ends or begins
//! there, which then is its own.

use super::ends::lengthen;
use super::instants::{Instant, instants};
use super::movie::{Movie, Sighting, Track};
use super::neighbours::Motion;
use crate::{
    Change, ChangeKind, CompletedFrame, Completion, Error, KnownNoise, Observation, Origin, Progress,
    Request, complete,
};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use voronudge_geometry::Vector;

/// Distance, in units of ℓ₀, from its predicted place at which a cell is found again.
const REACH: f64 = 0.35;

/// Snapshots in which a cell must be found, if there are as many.
const FEWEST: usize = 2;

/// Frames of a snapshot, if there are as many.
const FRAMES: usize = 3;

/// Cells of a movie that were not detected.
#[derive(Debug, Clone)]
pub struct Latent {
    /// Share of the cells that were not detected: as given, or estimated.
    pub missed_rate: f64,
    /// Standard error of a coordinate and evidence of each track without a name, in their order.
    found: Vec<[f64; 2]>,
}

/// A cell in a frame.
#[derive(Debug, Clone, Copy)]
struct Found {
    place: Vector<f64>,
    label: Option<i64>,
    standard_error: f64,
    evidence: f64,
}

/// A cell in successive frames.
#[derive(Debug, Clone)]
struct Chain {
    first: usize,
    found: Vec<Found>,
}

impl Chain {
    /// The label that has most evidence in its frames together.
    fn label(&self) -> Option<i64> {
        let mut evidence: BTreeMap<i64, f64> = BTreeMap::new();
        for (label, found) in self.found.iter().filter_map(|found| Some((found.label?, found))) {
            *evidence.entry(label).or_default() += found.evidence;
        }
        evidence.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(label, _)| label)
    }

    /// The frame after the last in which it was found.
    fn end(&self) -> usize {
        self.first + self.found.len()
    }
}

/// Looks for cells of a movie that were not detected. `missed_rate` is the share of the cells that is not detected, if it is known. Tracks
/// must have been joined, if they are to be. Lengths in units of ℓ₀, velocities of order one.
///
/// # Errors
/// As [`complete`].
pub fn complete_tracks(
    movie: &Movie,
    request: &Request,
    missed_rate: Option<f64>,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<(Movie, Latent), Error> {
    let motions: Vec<Motion<'_>> = (0..movie.frames() - 1).map(|frame| Motion::new(movie, frame)).collect();
    // How far the dynamics scatter is no error of a mean velocity, in which there is all that moves cells beside the model.
    let request = Request { noise: KnownNoise { velocity: None, ..request.noise }, ..request.clone() };
    let completion = complete(&snapshots(movie)?, &request, missed_rate, observe)?;
    // Of two frames, the first; a snapshot of these is half-way to the second.
    let (centre, aside) = if movie.frames() < FRAMES { (0, 0.5) } else { (FRAMES / 2, 0.0) };
    let of_frame = |(index, frame): (usize, &CompletedFrame)| {
        let inserted = frame.changes.iter().filter(|change| change.kind == ChangeKind::Inserted);
        let found = |change: &Change| {
            let place = change.added.first()?;
            let place = place - motions[index].around(*place, None) * aside;
            let label = change.labels.first().copied().flatten();
            Some(Found { place, label, standard_error: change.standard_error, evidence: change.evidence })
        };
        inserted.filter_map(found).collect()
    };
    let found: Vec<Vec<Found>> = completion.frames.iter().enumerate().map(of_frame).collect();
    let chains = chains(movie, &motions, centre, found);
    let (movie, found) = with_cells(movie, &motions, &chains);
    // Two neighbours of which one is never detected leave one hole: that one is looked for first.
    let movie = lengthen(movie)?;
    Ok((movie, Latent { missed_rate: completion.missed_rate, found }))
}

/// The cells in each few successive frames, at their mean places, with their mean velocities.
fn snapshots(movie: &Movie) -> Result<Vec<Observation>, Error> {
    let frames = FRAMES.min(movie.frames());
    let snapshot = |(first, instants): (usize, &[Instant])| {
        let last = first + frames - 1;
        let drift: Vector<f64> = (first..last).map(|frame| movie.first_drift(frame)).sum();
        let mut places: BTreeMap<u32, Vec<Vector<f64>>> = BTreeMap::new();
        for instant in instants {
            for (track, r) in instant.tracks.iter().zip(&instant.cells.positions) {
                places.entry(*track).or_default().push(*r);
            }
        }
        let (mut positions, mut velocities, mut tracks) = (Vec::new(), Vec::new(), Vec::new());
        for (track, all) in places.iter().filter(|(_, all)| all.len() == frames) {
            tracks.push(*track);
            positions.push(all.iter().sum::<Vector<f64>>() / frames as f64);
            let own = &movie.tracks[*track as usize];
            let is_seen = own.at(first).is_some() && own.at(last).is_some();
            let moved = all[frames - 1] - all[0] - drift;
            velocities.push(is_seen.then(|| moved / (movie.times[last] - movie.times[first])));
        }
        let cells =
            Observation::new(first, positions, velocities, movie.domain, movie.field_of_view.clone())?;
        Ok(cells.within(movie.environment_of(&tracks)))
    };
    instants(movie)?.windows(frames).enumerate().map(snapshot).collect()
}

/// What was found in one frame after the other, from the first of these on.
fn chains(movie: &Movie, motions: &[Motion<'_>], first: usize, found: Vec<Vec<Found>>) -> Vec<Chain> {
    let fewest = FEWEST.min(found.len());
    let mut chains: Vec<Chain> = Vec::new();
    for (frame, own) in (first..).zip(found) {
        let mut goes_on: Vec<(usize, Vector<f64>)> = Vec::new();
        for (index, chain) in chains.iter().enumerate().filter(|(_, chain)| chain.end() == frame) {
            if let Some(last) = chain.found.last() {
                goes_on.push((index, last.place + motions[frame - 1].around(last.place, None)));
            }
        }
        for found in own {
            let distance = |place: &Vector<f64>| movie.domain.shortest(found.place - place).norm();
            let nearest = (0..goes_on.len())
                .min_by(|a, b| distance(&goes_on[*a].1).total_cmp(&distance(&goes_on[*b].1)));
            match nearest.filter(|nearest| distance(&goes_on[*nearest].1) < REACH) {
                Some(nearest) => chains[goes_on.swap_remove(nearest).0].found.push(found),
                None => chains.push(Chain { first: frame, found: vec![found] }),
            }
        }
    }
    chains.retain(|chain| chain.found.len() >= fewest);
    chains
}

/// The movie with the cells of some chains, and standard error and evidence of those that are no part of a track.
fn with_cells(movie: &Movie, motions: &[Motion<'_>], chains: &[Chain]) -> (Movie, Vec<[f64; 2]>) {
    let mut taken = vec![false; movie.tracks.len()];
    let (mut cells, mut found) = (Vec::new(), Vec::new());
    for chain in chains {
        let mut whole = Track { first: 0, seen: Vec::new(), names: Vec::new(), label: None };
        for part in (Way { movie, motions, taken: &taken, chain }).parts() {
            match part {
                Part::Latent(frame, position) => {
                    let unseen = Some(Sighting::unseen(position));
                    whole.go_on(movie.domain, frame, [unseen].into_iter());
                }
                Part::Track(number) => {
                    let track = &movie.tracks[number];
                    whole.go_on(movie.domain, track.first, track.seen.iter().copied());
                    whole.names.extend(&track.names);
                    whole.label = whole.label.or(track.label);
                    taken[number] = true;
                }
            }
        }
        whole.label = whole.label.or_else(|| chain.label());
        if whole.names.is_empty() {
            let least = chain.found.iter().map(|found| found.standard_error).fold(f64::INFINITY, f64::min);
            found.push([least, chain.found.iter().map(|found| found.evidence).sum()]);
        }
        cells.push(whole);
    }
    let others = movie.tracks.iter().zip(taken).filter(|(_, taken)| !taken).map(|(track, _)| track.clone());
    let mut completed = movie.clone();
    completed.tracks = others.chain(cells).collect();
    (completed, found)
}

/// A part of the track of a cell that was not always detected.
enum Part {
    /// Not detected in a frame: where it is thought to be.
    Latent(usize, Vector<f64>),
    /// A track, as long as it lasts.
    Track(usize),
}

/// The way of a cell through a movie.
struct Way<'a> {
    movie: &'a Movie,
    motions: &'a [Motion<'a>],
    /// Tracks that are other cells'.
    taken: &'a [bool],
    chain: &'a Chain,
}

impl Way<'_> {
    /// Its parts in the order of time: back from the first frame in which it was found, then on.
    fn parts(&self) -> Vec<Part> {
        let Chain { first, found } = self.chain;
        let (mut parts, mut place) = (Vec::new(), found[0].place);
        for frame in (0..=*first).rev() {
            match self.movie.taken_by(frame, place) {
                None => parts.push(Part::Latent(frame, place)),
                Some(track) => {
                    if self.movie.tracks[track].end() == frame + 1 && !self.taken[track] {
                        parts.push(Part::Track(track));
                    }
                    break;
                }
            }
            if frame > 0 {
                place -= self.motions[frame - 1].around(place, None);
            }
        }
        parts.reverse();
        let mut frame = first + 1;
        place = found[0].place;
        while frame < self.movie.frames() {
            place = match found.get(frame - first) {
                Some(found) => found.place,
                None => place + self.motions[frame - 1].around(place, None),
            };
            match self.movie.taken_by(frame, place) {
                None => parts.push(Part::Latent(frame, place)),
                Some(track) if self.movie.tracks[track].first == frame && !self.taken[track] => {
                    parts.push(Part::Track(track));
                    frame = self.movie.tracks[track].end();
                    if frame < self.chain.end() {
                        continue;
                    }
                    break;
                }
                Some(_) => break,
            }
            frame += 1;
        }
        parts
    }
}

impl Latent {
    /// What is different from the detections in each frame, for the movie with its latent cells and its
    /// [`observations`](Movie::observations).
    pub fn completion(&self, movie: &Movie, observations: &[Observation]) -> Completion {
        let nameless: Vec<usize> =
            (0..movie.tracks.len()).filter(|track| movie.tracks[*track].names.is_empty()).collect();
        let of_track: BTreeMap<usize, [f64; 2]> =
            nameless.into_iter().zip(self.found.iter().copied()).collect();
        let frames = observations.iter().enumerate().map(|(frame, observation)| {
            let (mut origins, mut changes, mut detected) = (Vec::new(), Vec::new(), 0);
            for (track, position) in movie.present(frame).zip(&observation.positions) {
                match of_track.get(&track) {
                    None => {
                        origins.push(Origin::Detected(detected));
                        detected += 1;
                    }
                    Some([standard_error, evidence]) => {
                        origins.push(Origin::Added(changes.len(), 0));
                        changes.push(Change {
                            kind: ChangeKind::Inserted,
                            removed: Vec::new(),
                            added: vec![*position],
                            labels: vec![movie.tracks[track].label],
                            standard_error: *standard_error,
                            evidence: *evidence,
                        });
                    }
                }
            }
            CompletedFrame { observation: observation.clone(), origins, changes }
        });
        Completion { frames: frames.collect(), missed_rate: self.missed_rate }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::Drift;
    use crate::tracks::infer_tracks;
    use crate::tracks::sample::{Filmed, TRUTH};
    use crate::{Constraints, FitParameter};
    use voronudge_geometry::FieldOfView;

    /// Two cells are never seen, one is lost after the first frame, and one comes back under another name.
    #[test]
    fn cells_that_were_not_detected_are_found() {
        let (mut film, domain, chiral) = Filmed { size: [144, 5], step: 0.1, error: 0.01, seed: 6 }.film();
        let truth = film.clone();
        for (frame, cells) in film.iter_mut().enumerate() {
            let back = cells[80].filter(|_| frame == 4);
            cells.push(back);
            for (cell, last) in [(17, 0), (60, 0), (101, 1), (80, 1)] {
                cells[cell] = cells[cell].filter(|_| frame < last);
            }
        }
        let times = (0..5).map(|frame| 0.1 * f64::from(frame)).collect();
        let movie = Movie::new(times, &film, domain, FieldOfView::default(), Drift::None).unwrap();
        let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]);
        let request = Request::new(constraints);
        let (completed, latent) =
            complete_tracks(&movie, &request, None, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(completed.tracks.len(), 144);
        let completion = latent.completion(&completed, &completed.observations().unwrap());
        assert_eq!(completion.count(ChangeKind::Inserted), 10);
        let (found, tracked) =
            infer_tracks(&completed, &request, &mut |_| ControlFlow::Continue(())).unwrap();
        for (cell, (cells, places)) in [17, 60, 101, 80]
            .into_iter()
            .flat_map(|cell| truth.iter().zip(&tracked.trajectories).map(move |frame| (cell, frame)))
        {
            let r = cells[cell].unwrap();
            let misses = places.iter().flatten().map(|own| domain.shortest(own - r).norm());
            let miss = misses.fold(f64::INFINITY, f64::min);
            assert!(miss < 0.1, "{cell}: {miss}");
        }
        let p = &found.parameters;
        assert!(
            (p.chiral_coefficient.value / chiral - 1.0).abs() < 0.03,
            "{:?} {chiral}",
            p.chiral_coefficient
        );
        assert!(p.preferred_perimeter.covers(TRUTH[0]), "{:?}", p.preferred_perimeter);
    }

    /// Cells that crawl are not taken for the neighbours of others that nobody saw, how little the dynamics scatter by may be stated.
    #[test]
    fn cells_that_crawl_hide_no_others() {
        let (movie, _) =
            Filmed { size: [64, 5], step: 0.1, error: 0.01, seed: 3 }.movie_of_crawling(0.5, 1.0);
        let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]);
        let noise = KnownNoise { position: Some(0.01), velocity: Some(0.02) };
        let request = Request { noise, ..Request::new(constraints) };
        let (completed, _) =
            complete_tracks(&movie, &request, None, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(completed.tracks.len(), movie.tracks.len());
    }
}
