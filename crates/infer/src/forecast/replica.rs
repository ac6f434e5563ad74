//! A movie that a model makes of the cells of another: the same cells, seen in the same frames with the same errors, those at the rim led as they were seen to
//! go.

use super::ahead::{Known, Moving, Tissue};
use super::start::{Start, of_neighbours};
use super::turning::Turning;
use super::{Forecaster, Outset};
use crate::{Error, Movie};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use voronudge_geometry::{CellPolygon, Tessellation, Vector};

/// Where the cells of each frame are seen, by track.
pub(super) type Places = Vec<Vec<Option<Vector<f64>>>>;

/// What replicas are made of.
pub(super) struct Stage<'a> {
    pub movie: &'a Movie,
    pub model: &'a Forecaster<'a>,
    /// What errors call it.
    pub name: &'static str,
    /// The frames of the movie from the first on.
    pub starts: &'a [Start<'a>],
    /// What is known of the first.
    pub outset: Outset,
    /// Steps of integration from frame to frame.
    pub steps: usize,
    /// Standard deviation of a coordinate of a measured position.
    pub noise: f64,
}

impl Stage<'_> {
    /// One replica, from one of the draws of the outset.
    pub fn play(&self, draw: usize, seed: u64) -> Result<Places, Error> {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let Outset { begun, drawn, turning } = &self.outset;
        let begun = drawn.get(draw).unwrap_or(begun);
        let mut moving = Moving::begin(begun, turning.as_ref(), &mut normal);
        let mut earlier: Known =
            (0..moving.positions.len()).map(|cell| self.starts[0].velocity_before(cell)).collect();
        let mut all = Vec::with_capacity(self.starts.len());
        for (k, start) in self.starts.iter().enumerate() {
            let tessellation = Tessellation::new(&moving.positions, self.movie.domain)
                .map_err(|source| Error::Geometry { frame: start.frame, source })?;
            all.push(self.seen((start, &tessellation), &moving.positions, &mut normal));
            let Some(next) = self.starts.get(k + 1) else { break };
            let time = start.time(start.frame, next.frame);
            let tissue = Tissue::after(start, self.model, std::mem::take(&mut earlier));
            let turning = self.model.turning(start, &tessellation);
            let led = self.led(start, next);
            let from = moving.positions.clone();
            tissue.go_on(&mut moving, turning.as_ref(), (time, self.steps), &led, &mut normal)?;
            let moved: Vec<Vector<f64>> =
                moving.positions.iter().zip(&from).map(|(to, from)| to - from).collect();
            let width = from.iter().map(|r| (r - from[0]).norm()).fold(0.0, f64::max);
            if !moved.iter().all(|moved| moved.norm() <= width) {
                return Err(Error::FliesApart { model: self.name, intervals: k + 1 });
            }
            let moved = moved.into_iter().map(|moved| Some(moved / time)).collect();
            (moving, earlier) = self.change(start, next, (moving, moved), turning.as_ref(), &mut normal);
        }
        Ok(all)
    }

    /// How fast cells at the rim go until the next frame, as far as that was seen.
    fn led(&self, start: &Start<'_>, next: &Start<'_>) -> Known {
        let (from, to) = (start.frame, next.frame);
        let time = start.time(from, to);
        let drift = self.movie.drifted(from, to);
        let of_cell = |(cell, track): (usize, &usize)| {
            if start.in_view[cell] {
                return None;
            }
            Some((self.movie.near(*track, to)? - self.movie.near(*track, from)? - drift) / time)
        };
        start.tracks.iter().enumerate().map(of_cell).collect()
    }

    /// The cells of the next frame: those whose tracks end are taken out, those whose tracks begin are put in, where they were seen and as far from there as
    /// their neighbours are.
    fn change(
        &self,
        start: &Start<'_>,
        next: &Start<'_>,
        (moving, moved): (Moving, Known),
        turning: Option<&Turning>,
        mut normal: impl FnMut() -> f64,
    ) -> (Moving, Known) {
        let drift = self.movie.drifted(start.frame, next.frame);
        let before: Vec<Option<usize>> =
            next.tracks.iter().map(|track| start.tracks.binary_search(track).ok()).collect();
        let astray: Known = before
            .iter()
            .zip(&next.cells.positions)
            .map(|(before, seen)| before.map(|cell| moving.positions[cell] + drift - seen))
            .collect();
        let mut positions = Vec::with_capacity(before.len());
        let mut polarities = Vec::with_capacity(before.len());
        for (cell, before) in before.iter().enumerate() {
            match before {
                Some(before) => {
                    positions.push(moving.positions[*before] + drift);
                    polarities.push(moving.polarities[*before]);
                }
                None => {
                    let around = of_neighbours(&next.cells.tessellation, cell, &astray);
                    positions.push(next.cells.positions[cell] + around.unwrap_or_else(Vector::zeros));
                    let drawn = Vector::new(normal(), normal());
                    polarities.push(turning.map_or_else(Vector::zeros, |turning| turning.unknown(drawn)));
                }
            }
        }
        let earlier = before.iter().map(|before| moved[(*before)?]).collect();
        (Moving { positions, polarities }, earlier)
    }

    /// Where the cells that were seen in a frame would be seen.
    fn seen(
        &self,
        (start, tessellation): (&Start<'_>, &Tessellation),
        positions: &[Vector<f64>],
        mut normal: impl FnMut() -> f64,
    ) -> Vec<Option<Vector<f64>>> {
        let mut places = vec![None; self.movie.tracks.len()];
        let mut polygon = CellPolygon::default();
        for (cell, track) in start.tracks.iter().enumerate() {
            let drawn = Vector::new(normal(), normal());
            let own = &self.movie.tracks[*track];
            let Some(sighting) = own.sighting(start.frame).filter(|own| own.error.is_finite()) else {
                continue;
            };
            let mut r = positions[cell] + drawn * (sighting.error * self.noise);
            if self.movie.share() != 0.0 && tessellation.is_closed(cell) && start.in_view[cell] {
                polygon.fill(tessellation, positions, cell);
                r += polygon.centroid() * self.movie.share();
            }
            places[*track] = Some(r);
        }
        places
    }
}

/// Where the cells of a movie were seen.
pub(super) fn measured(movie: &Movie, starts: &[Start<'_>]) -> Places {
    let of_frame = |start: &Start<'_>| movie.tracks.iter().map(|track| track.at(start.frame)).collect();
    starts.iter().map(of_frame).collect()
}
