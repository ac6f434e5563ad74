//! What finer steps of integration add to a fit with coarser ones.
//!
//! Steps finer than one from frame to frame have no unknowns in the fit. About a point, the places between two frames begin on the cubic that
//! has the places and velocities of both, and are moved to where the misfit of each motion is shared out evenly over its steps. What the finer
//! rule then says of the displacements, less what the coarser one says, is put into the next fit (deferred correction).

use super::objective::MovieObjective;
use super::rule::Rule;
use super::states::{Motion, Place, States};
use crate::Error;
use std::collections::HashMap;
use voronudge_geometry::Vector;

/// Rounds in which places between two frames are brought to where the misfit of their interval is shared out evenly.
const EVENINGS: usize = 6;

/// Unevenness that counts as none, in units of ℓ₀.
const EVEN: f64 = 1e-6;

/// Displacements that a rule adds to those of a coarser one, for each motion.
pub(super) struct Added {
    pub rule: Rule,
    pub displacements: Vec<Vector<f64>>,
}

impl Added {
    /// What a finer rule adds to the displacement of each motion by the rule at hand, at a point.
    pub(super) fn new(objective: &MovieObjective<'_>, at: &[f64], rule: Rule) -> Result<Self, Error> {
        let (states, finer) = (objective.states, States::new(objective.movie, rule)?);
        let mut between = transfer(objective, &finer, at)?;
        let fine = MovieObjective { states: &finer, ..*objective };
        let mut rests = fine.residuals(&fine.place(&between)?, &between);
        for _ in 0..EVENINGS {
            if rule.steps == 1 || share_out(&fine, &rests, &mut between) < EVEN {
                break;
            }
            rests = fine.residuals(&fine.place(&between)?, &between);
        }
        let misfit = |objective: &MovieObjective<'_>, rests: &[Vector<f64>]| -> HashMap<_, _> {
            let each = objective.states.motions.iter().zip(rests.chunks_exact(objective.states.rule.steps));
            each.map(|(motion, rests)| {
                let all: Vector<f64> = rests.iter().sum();
                ((motion.interval, motion.track), all / objective.unit(motion.interval))
            })
            .collect()
        };
        let with_finer = misfit(&fine, &rests);
        let coarse = misfit(objective, &objective.residuals(&objective.place(at)?, at));
        let more = |motion: &Motion| {
            let key = (motion.interval, motion.track);
            motion.added + with_finer.get(&key).map_or_else(Vector::zeros, |finer| coarse[&key] - finer)
        };
        Ok(Self { rule, displacements: states.motions.iter().map(more).collect() })
    }
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
pub(super) fn transfer(objective: &MovieObjective<'_>, to: &States, at: &[f64]) -> Result<Vec<f64>, Error> {
    let (from, movie) = (objective.states, objective.movie);
    let placed = objective.place(at)?;
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
    Ok(next)
}

/// The cubic with these places and slopes at 0 and 1.
fn cubic(places: [Vector<f64>; 2], slopes: [Vector<f64>; 2], t: f64) -> Vector<f64> {
    let u = 1.0 - t;
    places[0] * (u * u * (1.0 + 2.0 * t)) + places[1] * (t * t * (1.0 + 2.0 * u)) + slopes[0] * (t * u * u)
        - slopes[1] * (t * t * u)
}
