//! What finer steps of integration add to a fit with coarser ones.
//!
//! Steps finer than one from frame to frame have no unknowns in the fit. About a point, the places between two frames begin on the cubic that
//! has the places and velocities of both, and are moved to where the misfit of each motion is shared out evenly over its steps. What the finer
//! rule then says of the displacements, less what the coarser one says, is put into the next fit (deferred correction).

use super::objective::{MovieObjective, Placed};
use super::states::{Motion, Place, States};
use crate::Error;
use std::collections::HashMap;
use voronudge_geometry::Vector;

/// Rounds in which places between two frames are brought to where the misfit of their interval is shared out evenly.
const EVENINGS: usize = 6;

/// Unevenness that counts as none, in units of ℓ₀.
const EVEN: f64 = 1e-6;

/// A point as a finer rule sees it.
pub(super) struct Finer {
    /// The point on the instants of that rule.
    pub at: Vec<f64>,
    /// What that rule adds to the displacement of each motion by the rule at hand.
    pub added: Vec<Vector<f64>>,
}

impl Finer {
    /// A point by the rule whose states are given.
    pub fn new(objective: &MovieObjective<'_>, at: &[f64], finer: &States) -> Result<Self, Error> {
        let placed = objective.place(at)?;
        let mut between = transfer(objective, &placed, finer, at);
        let fine = MovieObjective { states: finer, ..*objective };
        let mut rests = fine.residuals(&fine.place(&between)?, &between);
        for _ in 0..EVENINGS {
            if finer.rule.steps == 1 || share_out(&fine, &rests, &mut between) < EVEN {
                break;
            }
            rests = fine.residuals(&fine.place(&between)?, &between);
        }
        let with_finer: HashMap<_, _> = misfits(&fine, &rests)
            .map(|(motion, misfit)| ((motion.interval, motion.track), misfit))
            .collect();
        let coarse = objective.residuals(&placed, at);
        let more = |(motion, misfit): (&Motion, Vector<f64>)| {
            let finer = with_finer.get(&(motion.interval, motion.track));
            motion.added + finer.map_or_else(Vector::zeros, |finer| misfit - finer)
        };
        let added = misfits(objective, &coarse).map(more).collect();
        Ok(Self { at: between, added })
    }
}

/// What is left of the displacement of each motion over all its steps.
fn misfits<'a>(
    objective: &MovieObjective<'a>,
    rests: &'a [Vector<f64>],
) -> impl Iterator<Item = (&'a Motion, Vector<f64>)> {
    let objective = *objective;
    let MovieObjective { states, .. } = objective;
    states.motions.iter().zip(rests.chunks_exact(states.rule.steps)).map(move |(motion, rests)| {
        let all: Vector<f64> = rests.iter().sum();
        (motion, all / objective.unit(motion.interval))
    })
}

/// Moves the places within intervals such that the misfit of each motion is the same in all its steps, if forces stay as they are; tells
/// the furthest move.
fn share_out(fine: &MovieObjective<'_>, rests: &[Vector<f64>], at: &mut [f64]) -> f64 {
    let (p, states) = (fine.space.dimension(), fine.states);
    let steps = states.rule.steps;
    let mut furthest: f64 = 0.0;
    for (motion, rests) in states.motions.iter().zip(rests.chunks_exact(steps)) {
        let unit = fine.unit(motion.interval);
        let all: Vector<f64> = rests.iter().sum();
        let mut so_far = Vector::zeros();
        for (node, rest) in (1..steps).zip(rests) {
            so_far += rest;
            let instant = &states.instants[motion.interval * steps + node];
            let Place::Own(own) = instant.place[motion.cells[node] as usize] else { continue };
            let move_by = (all * (node as f64 / steps as f64) - so_far) / unit;
            let block = p + 2 * own as usize;
            at[block] += move_by.x;
            at[block + 1] += move_by.y;
            furthest = furthest.max(move_by.norm());
        }
    }
    furthest
}

/// A point on the instants of a finer rule: those between two frames are on the cubic that has the places and velocities of both.
fn transfer(objective: &MovieObjective<'_>, placed: &Placed<'_>, to: &States, at: &[f64]) -> Vec<f64> {
    let (from, movie) = (objective.states, objective.movie);
    let (free, displacements) = objective.split(at);
    let mut next = free.to_vec();
    next.resize(free.len() + 2 * to.blocks(), 0.0);
    let steps = to.rule.steps;
    for (index, instant) in to.instants.iter().enumerate() {
        let (frame, share) = (index / steps, (index % steps) as f64 / steps as f64);
        let at_end = |end: usize| -> HashMap<u32, (Vector<f64>, Vector<f64>)> {
            let Some(tracks) = from.instants.get(frame + end).map(|instant| &instant.tracks) else {
                return HashMap::new();
            };
            let (nudged, evaluated) = &placed.instants[frame + end];
            let there = nudged.positions.iter().copied().zip(evaluated.of_cells.iter().copied());
            tracks.iter().copied().zip(there).collect()
        };
        let ends = [at_end(0), if share > 0.0 { at_end(1) } else { HashMap::new() }];
        for (track, place) in instant.tracks.iter().zip(&instant.place) {
            let (Place::Own(own), Some(first)) = (place, ends[0].get(track)) else { continue };
            let r = match ends[1].get(track) {
                None => first.0,
                Some(last) => {
                    let span = movie.times[frame + 1] - movie.times[frame];
                    let drift = objective.drift(frame, displacements);
                    cubic([first.0, last.0], [first.1 * span + drift, last.1 * span + drift], share)
                }
            };
            let displacement = r - to.start[*own as usize];
            let block = free.len() + 2 * *own as usize;
            next[block..block + 2].copy_from_slice(displacement.as_slice());
        }
    }
    let [old, new] = [from, to].map(|states| 2 * states.drifts.0);
    next[free.len() + new..].copy_from_slice(&displacements[old..]);
    next
}

/// The cubic with these places and slopes at 0 and 1.
fn cubic(places: [Vector<f64>; 2], slopes: [Vector<f64>; 2], t: f64) -> Vector<f64> {
    let u = 1.0 - t;
    places[0] * (u * u * (1.0 + 2.0 * t)) + places[1] * (t * t * (1.0 + 2.0 * u)) + slopes[0] * (t * u * u)
        - slopes[1] * (t * t * u)
}
