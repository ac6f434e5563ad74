//! Tracks that jump from one cell to another: a tracker that mixes up two of them, or takes one that came back for another.
//!
//! How the neighbours move says where a cell should be, with an error of scale s that has wide tails ([`super::join`]). A track goes on where
//! that is likelier than that a cell which has nothing to do with it is seen at such a place by chance, which happens to one in [`RARE`]:
//!
//! ```text
//! log t₂(d) > log ρ,      ρ = 1 / RARE to a unit area
//! ```
//!
//! and two go on as they are where that is not [`RARE`]² times likelier with their ends exchanged. Elsewhere tracks are cut, and the parts may be joined to others, as those of broken
//! tracks are. What moves less than half-way to another cell is never cut.

use super::movie::{Movie, Track};
use super::neighbours::{Motion, log_density};
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// One in so many cells of a frame, at most, is mixed up with another.
const RARE: f64 = 1000.0;

/// The least jump, in distances to the nearest cell.
const LEAST: f64 = 0.5;

/// Distance to the nearest cell in a tissue, in units of ℓ₀, about.
const NEAREST: f64 = 0.8;

/// A track that jumps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Jump {
    /// The cell that jumps: its number in the frames that the movie was made from.
    pub cell: usize,
    /// The frame before, and the next in which it was seen.
    pub frames: [usize; 2],
}

impl Movie {
    /// Where tracks jump to another cell, by track and frame; positions in any unit. Tracks must not be joined yet.
    pub fn jumps(&self) -> Vec<Jump> {
        let Some(nearest) = nearest_distance(self) else { return Vec::new() };
        let motions = (0..self.frames() - 1).into_par_iter().map(|frame| Motion::new(self, frame)).collect();
        let expected = Expected { movie: self, motions, unit: nearest / NEAREST };
        let of_track = |(number, track): (usize, &Track)| {
            let seen: Vec<usize> =
                (track.first..track.end()).filter(|frame| track.at(*frame).is_some()).collect();
            let jumped = |pair: &[usize]| {
                let frames = [pair[0], pair[1]];
                let cell = track.name(frames[0])?;
                expected.jumps(number, frames).then_some(Jump { cell, frames })
            };
            seen.windows(2).filter_map(jumped).collect::<Vec<_>>()
        };
        self.tracks.par_iter().enumerate().flat_map_iter(of_track).collect()
    }

    /// Cuts tracks where they jump, as [`jumps`](Self::jumps) of a movie of the same tracks found. Parts bear the name of the whole.
    pub fn cut(&mut self, jumps: &[Jump]) {
        for jump in jumps.iter().rev() {
            let [before, after] = jump.frames;
            let is_own = |track: &&mut Track| {
                track.name(before) == Some(jump.cell) && track.first <= before && after < track.end()
            };
            let Some(track) = self.tracks.iter_mut().find(is_own) else { continue };
            let rest = track.seen.split_off(after - track.first);
            track.seen.truncate(before + 1 - track.first);
            let (names, label) = (vec![(after, jump.cell)], track.label);
            self.tracks.push(Track { first: after, seen: rest, names, label });
        }
    }
}

/// Where cells should be, by how their neighbours move.
struct Expected<'a> {
    movie: &'a Movie,
    motions: Vec<Motion<'a>>,
    /// A cell size, in the unit of the positions.
    unit: f64,
}

impl Expected<'_> {
    /// Whether a track jumps between two frames that follow each other for it.
    fn jumps(&self, track: usize, frames: [usize; 2]) -> bool {
        let Some((far, own)) = self.log_likelihood([track, track], frames) else { return false };
        if far < LEAST * NEAREST {
            return false;
        }
        if own < -RARE.ln() {
            return true;
        }
        // Two that change places say so together.
        let gain = |other: usize| {
            let along = |pair| Some(self.log_likelihood(pair, frames)?.1);
            Some(along([track, other])? + along([other, track])? - own - along([other, other])?)
        };
        let reach = 2.0 * far * self.unit;
        let Some(from) = self.movie.tracks[track].at(frames[0]) else { return false };
        let is_near = |other: &usize| {
            let there = self.movie.tracks[*other].at(frames[1]);
            there.is_some_and(|to| self.movie.domain.shortest(to - from).norm() < reach)
        };
        self.movie
            .present(frames[0])
            .filter(|other| *other != track && is_near(other))
            .any(|other| gain(other).is_some_and(|gain| gain > 2.0 * RARE.ln()))
    }

    /// How far, in cell sizes, the end of one track is from where the beginning of another should have come to, and the logarithm of how likely that is.
    fn log_likelihood(
        &self,
        [beginning, end]: [usize; 2],
        [before, after]: [usize; 2],
    ) -> Option<(f64, f64)> {
        let tracks = &self.movie.tracks;
        let (mut place, to) = (tracks[beginning].at(before)?, tracks[end].at(after)?);
        let mut square = 0.0;
        for motion in &self.motions[before..after] {
            place += motion.around(place, motion.step_of(beginning));
            square += motion.square;
        }
        let miss = self.movie.domain.shortest(to - place).norm() / self.unit;
        Some((miss, log_density(miss * miss, square / (self.unit * self.unit))))
    }
}

/// The median distance of a cell to the nearest other one, in the first frame that has two.
fn nearest_distance(movie: &Movie) -> Option<f64> {
    let frame = (0..movie.frames()).find(|frame| movie.present(*frame).count() > 1)?;
    let places: Vec<Vector<f64>> =
        movie.present(frame).filter_map(|track| movie.near(track, frame)).collect();
    let nearest = |(own, r): (usize, &Vector<f64>)| {
        let others = places.iter().enumerate().filter(|(other, _)| *other != own);
        others.map(|(_, s)| movie.domain.shortest(s - r).norm()).fold(f64::INFINITY, f64::min)
    };
    let mut distances: Vec<f64> = places.iter().enumerate().map(nearest).collect();
    distances.sort_unstable_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::Drift;
    use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, honeycomb};

    /// A honeycomb whose cells move each in its own way by a part of their size from frame to frame, in some unit of length.
    fn moving(step: f64, unit: f64) -> (Vec<Vec<Option<Vector<f64>>>>, Domain) {
        let (cells, lengths) = honeycomb(6, 6);
        let place = |k: usize, cell: usize| {
            let phase = (7 * cell + 5 * k) as f64;
            let own = Vector::new((1.7 * phase).sin(), (2.3 * phase).cos()) * step;
            Some((cells[cell] + own + Vector::new(0.2, 0.0) * k as f64) * unit)
        };
        let frames = (0..6).map(|k| (0..cells.len()).map(|cell| place(k, cell)).collect()).collect();
        (frames, Domain::Periodic(PeriodicBox::new(lengths.map(|l| l * unit)).unwrap()))
    }

    fn movie(frames: &[Vec<Option<Vector<f64>>>], domain: Domain) -> Movie {
        let times = (0..frames.len()).map(|k| k as f64).collect();
        Movie::new(times, frames, domain, FieldOfView::default(), Drift::None).unwrap()
    }

    #[test]
    fn tracks_that_were_mixed_up_are_put_right_and_no_others_are_touched() {
        for unit in [1.0, 30.0] {
            let (mut frames, domain) = moving(0.03, unit);
            let right = movie(&frames, domain);
            assert!(right.jumps().is_empty());
            // Two neighbours change names for good, two others for a frame; one goes to the other end and back.
            for frame in &mut frames[3..] {
                frame.swap(8, 9);
            }
            frames[2].swap(20, 21);
            frames[4][30] = frames[4][30].map(|r| r + Vector::new(3.4, 2.1) * unit);
            let mut mixed = movie(&frames, domain);
            let jumps = mixed.jumps();
            let found: Vec<(usize, usize)> = jumps.iter().map(|own| (own.cell, own.frames[1])).collect();
            assert_eq!(found, [(8, 3), (9, 3), (20, 2), (20, 3), (21, 2), (21, 3), (30, 4), (30, 5)]);
            mixed.cut(&jumps);
            assert_eq!(mixed.tracks.len(), 36 + jumps.len());
            if unit != 1.0 {
                continue;
            }
            mixed.join();
            for cell in [8, 9, 20, 21] {
                let same = |track: &&Track| {
                    (0..6).all(|k| {
                        let [a, b] = [track.at(k), right.tracks[cell].at(k)];
                        a.zip(b).is_some_and(|(a, b)| domain.shortest(a - b).norm() < 1e-12)
                    })
                };
                assert!(mixed.tracks.iter().find(same).is_some(), "{cell}");
            }
        }
        // Cells that move by half their size are not told from others.
        let (frames, domain) = moving(0.4, 1.0);
        assert!(movie(&frames, domain).jumps().is_empty());
    }
}
