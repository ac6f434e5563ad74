//! Displacements predicted from the measured positions, also those left out of the fit.
//!
//! The prediction of a displacement is the mean of the forces at both of its ends, as measured. An error of a measured position
//! then adds to the displacement with one sign at one end and the other at the other, and to the forces with the same sign at both, so that
//! errors of measurement cannot pose as a prediction (as they do where the force is taken at the beginning alone).

use super::movie::Movie;
use super::objective::MovieObjective;
use super::states::{Motion, States};
use crate::Error;
use crate::cross_validation::ratio;
use crate::search::Watch;
use std::collections::BTreeMap;
use voronudge_geometry::Vector;

/// Folds at most.
const FOLDS: usize = 4;

/// Fewest intervals of which some are left out as a whole.
const FEWEST_INTERVALS: usize = 3;

/// Damping of the step from the fit to all to the fit to some.
const DAMPING: f64 = 1e-6;

/// The motions between the frames as they were measured, with the translations of a fit.
pub(super) struct AsMeasured<'a> {
    /// The objective with no instants between frames.
    objective: MovieObjective<'a>,
    /// Displacements: none but the translations.
    displacements: Vec<f64>,
}

impl<'a> AsMeasured<'a> {
    /// `objective` has no instants between frames; `drifts` are the unknowns of the translations of a fit.
    pub fn new(objective: MovieObjective<'a>, drifts: &[f64]) -> Self {
        let mut displacements = vec![0.0; 2 * objective.states.blocks()];
        let first = 2 * objective.states.drifts.0;
        displacements[first..].copy_from_slice(drifts);
        Self { objective, displacements }
    }

    /// The unknowns for some β.
    pub fn at(&self, free: &[f64]) -> Vec<f64> {
        free.iter().chain(&self.displacements).copied().collect()
    }

    /// Mean velocities of the motions, translations removed.
    pub fn velocities(&self) -> Vec<Vector<f64>> {
        let MovieObjective { movie, states, .. } = self.objective;
        let velocity = |motion: &Motion| {
            let at = |node: usize| {
                let cell = motion.cells[node] as usize;
                states.position(motion.interval + node, cell, &self.displacements)
            };
            let drift = self.objective.drift(motion.interval, &self.displacements);
            (at(1) - at(0) - drift) / (movie.times[motion.interval + 1] - movie.times[motion.interval])
        };
        states.motions.iter().map(velocity).collect()
    }

    /// What the mean of the forces leaves of each displacement, in units of velocity.
    pub fn residuals(&self, free: &[f64]) -> Result<Vec<Vector<f64>>, Error> {
        let at = self.at(free);
        Ok(self.objective.residuals(&self.objective.place(&at)?, &at))
    }
}

/// What the fits without some motions say of these.
pub(super) struct HeldOut {
    /// Squared error in units of the squared velocities, pooled over folds, and its standard error.
    pub error: [f64; 2],
    /// Predicted mean velocities, by interval and track.
    pub predicted: MeanVelocities,
}

/// Mean velocities by interval and track.
pub(super) type MeanVelocities = Vec<BTreeMap<u32, Vector<f64>>>;

/// The error of displacements that were left out of the fit. `objective` and `at` are the fit to all; `None` if there are too few motions.
///
/// Whole intervals are left out, or parts of the field where there are few. The fit without a fold is one Gauss–Newton step from the fit
/// to all.
pub(super) fn cross_validate(
    objective: &MovieObjective<'_>,
    at: &[f64],
    measured: &AsMeasured<'_>,
    watch: &mut Watch<'_>,
) -> Result<Option<HeldOut>, Error> {
    let coarse = measured.objective.states;
    let folds = folds(objective.movie, coarse);
    let velocities = measured.velocities();
    let numbers: Vec<usize> = (0..FOLDS).collect();
    let tested = watch.each("cross-validation", &numbers, 1.0, |fold| {
        let left = |motion: &Motion| folds[motion.track as usize][motion.interval] != *fold;
        let motions: Vec<Motion> = objective.states.motions.iter().filter(|m| left(m)).cloned().collect();
        let p = objective.space.dimension();
        if motions.len() == objective.states.motions.len() || motions.len() < 2 * p + 2 {
            return Ok(None);
        }
        let states = States { motions, ..objective.states.clone() };
        let step = MovieObjective { states: &states, ..*objective }.linearise(at)?.step(DAMPING)?.step;
        let free: Vec<f64> = at.iter().zip(&step).take(p).map(|(b, s)| b + s).collect();
        let rests = measured.residuals(&free)?;
        let (mut error, mut total, mut predicted) = (0.0, 0.0, Vec::new());
        for ((motion, rest), v) in coarse.motions.iter().zip(&rests).zip(&velocities) {
            if !left(motion) {
                error += rest.norm_squared();
                total += v.norm_squared();
                predicted.push((motion.interval, motion.track, v - rest));
            }
        }
        Ok((total > 0.0).then_some(((error, total), predicted)))
    })?;
    let tested: Vec<_> = tested.into_iter().flatten().collect();
    let mut predicted = vec![BTreeMap::new(); objective.movie.frames() - 1];
    for (interval, track, v) in tested.iter().flat_map(|fold| &fold.1) {
        predicted[*interval].insert(*track, *v);
    }
    let error = ratio(tested.iter().map(|fold| fold.0));
    Ok((tested.len() >= 2).then_some(HeldOut { error, predicted }))
}

/// The fold of each motion, by track and interval.
fn folds(movie: &Movie, states: &States) -> Vec<Vec<usize>> {
    let intervals = movie.frames() - 1;
    let mut folds = vec![vec![usize::MAX; intervals]; movie.tracks.len()];
    let median = |axis: usize| {
        let mut all: Vec<f64> = states.start.iter().map(|r| r[axis]).collect();
        all.sort_unstable_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let middle = Vector::new(median(0), median(1));
    for motion in &states.motions {
        let fold = if intervals >= FEWEST_INTERVALS {
            motion.interval * FOLDS.min(intervals) / intervals
        } else {
            let r = states.instants[motion.interval].cells.positions[motion.cells[0] as usize];
            usize::from(r.x > middle.x) + 2 * usize::from(r.y > middle.y)
        };
        folds[motion.track as usize][motion.interval] = fold;
    }
    folds
}
