//! Displacements predicted: from the measured positions, and from places that were fitted without them.

use super::motions::Motion;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::rule::Rule;
use super::states::States;
use crate::Error;
use crate::cross_validation::Folds;
use crate::search::Watch;
use nalgebra::DMatrix;
use std::collections::{BTreeMap, BTreeSet};
use voronudge_geometry::Vector;

/// Folds at most.
const FOLDS: usize = 4;

/// Fewest intervals of which some are left out as a whole.
const FEWEST_INTERVALS: usize = 3;

/// Regions of the field along each axis, over which errors scatter beside folds; and parts that are left out where intervals are few.
const REGIONS: usize = 4;
const PARTS: usize = 2;

/// Steps of integration from frame to frame up to which cells hardly relax in between.
const FEW_STEPS: usize = 4;

/// Damping of the step from the fit to all to the fit to some: of places, which may be held by nothing, and of what is always held. Polarities are
/// held so loosely that with more they would stay where the motions left out had put them.
const DAMPING_OF_PLACES: f64 = 1e-6;
const DAMPING: f64 = 1e-9;

/// Share of the information of the fit to all by which its coefficients are kept where the rest of the data do not determine them: one step would lead
/// far beyond where it is worth anything.
const KNOWN: f64 = 0.05;

/// The motions between the frames as they were measured, with the translations of a fit.
pub(super) struct AsMeasured<'a> {
    objective: MovieObjective<'a>,
    /// Displacements: none but the translations.
    displacements: Vec<f64>,
    /// Mean velocities of the motions of cells that were seen at both frames, between where they were seen, translations removed.
    pub velocities: Vec<Option<Vector<f64>>>,
}

impl<'a> AsMeasured<'a> {
    /// With the translations among the unknowns of a fit.
    pub fn new(objective: MovieObjective<'a>, of_fit: &[f64]) -> Self {
        let mut displacements = vec![0.0; 2 * objective.states.blocks()];
        let (first, count) = objective.states.drifts;
        let drifts = 2 * first..2 * (first + count);
        displacements[drifts.clone()].copy_from_slice(&of_fit[drifts]);
        let MovieObjective { movie, states, .. } = objective;
        let velocity = |motion: &Motion| {
            let track = &movie.tracks[motion.track as usize];
            let at = |end: usize| {
                let (frame, cell) = (motion.interval + end, motion.cells[end] as usize);
                let seen =
                    states.position(frame, cell, &displacements) + states.instants[frame].cells.aim(cell);
                track.at(frame).map(|_| seen)
            };
            let drift = objective.drift(motion.interval, &displacements);
            Some((at(1)? - at(0)? - drift) / objective.span(motion.interval))
        };
        let velocities = states.motions.iter().map(velocity).collect();
        Self { objective, displacements, velocities }
    }

    /// The unknowns for some β.
    fn with(&self, free: &[f64]) -> Vec<f64> {
        free.iter().chain(&self.displacements).copied().collect()
    }

    /// The unknowns for β and the polarities of a fit.
    fn at(&self, of_fit: &[f64]) -> Vec<f64> {
        let (free, of_fit) = self.objective.split(of_fit);
        let mut at = self.with(free);
        let polarities = 2 * self.objective.states.polarities.range().start
            ..2 * self.objective.states.polarities.range().end;
        at[free.len()..][polarities.clone()].copy_from_slice(&of_fit[polarities]);
        at
    }

    /// Sum of the squares of what some β leave of these velocities, if the cells are followed by a rule from where they were seen.
    pub fn missed(&self, free: &[f64], rule: Rule) -> Result<f64, Error> {
        let objective = MovieObjective { rule, ..self.objective };
        let placed = objective.displaced(&self.with(free))?;
        let means = objective.seen_velocities(&placed, &self.displacements)?;
        let missed = self.velocities.iter().zip(means);
        let missed = missed.filter_map(|(seen, mean)| Some((seen.as_ref()? - mean).norm_squared()));
        Ok(missed.sum())
    }

    /// What errors of the positions alone make of the sum of the squared velocities beside predictions of held-out motions: where these are forces at
    /// measured positions, what they do to the forces included, of no motion more than `most`: beyond, as between cells that nearly coincide, forces are
    /// no linear function of positions. With the unknowns of the fit.
    pub fn noise(&self, at: &[f64], most: f64) -> Result<f64, Error> {
        let variance = self.objective.levels.position.powi(2);
        if follows_from_fit(&self.objective) {
            return Ok(variance * self.noise_of_motions());
        }
        // The motions themselves are predicted, and not what happened to each cell by itself.
        let states = &States { own_motion: None, ..self.objective.states.clone() };
        let objective = MovieObjective { rule: Rule::Trapezoid, states, ..self.objective };
        let usual = objective.movie.interval();
        let of_motions = objective.sensitivities(at)?.into_iter().zip(&objective.states.motions);
        let seen = of_motions.zip(&self.velocities).filter(|(_, velocity)| velocity.is_some());
        let of_motion = |square: f64, motion: &Motion| {
            (variance * square * usual / objective.span(motion.interval)).min(most)
        };
        Ok(seen.map(|((square, motion), _)| of_motion(square, motion)).sum())
    }

    /// The same of the measured motions themselves, for errors of unit variance.
    fn noise_of_motions(&self) -> f64 {
        let MovieObjective { movie, states, .. } = self.objective;
        let of_motion = |motion: &Motion| {
            let track = &movie.tracks[motion.track as usize];
            let [first, last] = [0, 1].map(|end| track.error(motion.interval + end));
            2.0 * (first * first + last * last) / self.objective.span(motion.interval).powi(2)
        };
        // Nothing was measured where the cell was not seen.
        states.motions.iter().map(of_motion).filter(|square| square.is_finite()).sum()
    }
}

/// Whether motions that are held out are predicted from the places of the cells in a fit without them, and not by the forces at measured positions.
fn follows_from_fit(objective: &MovieObjective<'_>) -> bool {
    objective.rule.steps() > FEW_STEPS || objective.movie.share() > 0.0
}

/// What the fits without some motions say of these.
pub(super) struct HeldOut {
    /// The folds.
    pub folds: Folds,
    /// Predicted mean velocities, by interval and track.
    pub predicted: MeanVelocities,
}

/// Mean velocities by interval and track.
pub(super) type MeanVelocities = Vec<BTreeMap<u32, Vector<f64>>>;

/// The error of displacements that were left out of the fit. `at` is the fit to all, with the information on its coefficients; `None` if there are too few motions.
///
/// Whole intervals but the first are left out, no two in a row, or parts of the field where there are few. The fit without a fold, of
/// coefficients and places, is one Gauss–Newton step from the fit to all. An error of a measured position must not pose as a prediction, as it
/// does where cells are followed from where they were seen. Cells that hardly relax from frame to frame are predicted by the mean of the
/// forces at both ends as measured, in which such an error has one sign and in the displacement two; others are followed from their places in
/// the fit without the fold, because forces at measured positions are mostly error. So are cells that were not measured at their sites: little of
/// where neighbours stand along the line between them is left in their centroids.
pub(super) fn cross_validate(
    measured: &AsMeasured<'_>,
    at: &[f64],
    information: &DMatrix<f64>,
    watch: &mut Watch<'_>,
) -> Result<Option<HeldOut>, Error> {
    let objective = &measured.objective;
    let all = objective.states;
    let folds = folds(objective.movie, all);
    let numbers: Vec<usize> = (0..FOLDS).collect();
    let known = information * KNOWN;
    let regions = Regions::new(all, REGIONS);
    let tested = watch.each("cross-validation", &numbers, 1.0, |fold| {
        let left = |motion: &Motion| folds[motion.track as usize][motion.interval] != *fold;
        let motions: Vec<Motion> = all.motions.iter().filter(|m| left(m)).copied().collect();
        let p = objective.space.dimension();
        if motions.len() == all.motions.len() || motions.len() < 2 * p + 2 {
            return Ok(None);
        }
        let share = motions.len() as f64 / all.motions.len() as f64;
        let integrated = all.integrated.as_ref().map(|own| own.of_share(share));
        let states = States { motions, integrated, ..all.clone() };
        let mut without = fitted_to(&MovieObjective { states: &states, ..*objective }, at, &known)?;
        forget_unseen(all, &states.motions, &mut without[p..]);
        let (rule, point) = match follows_from_fit(objective) {
            true => (objective.rule, without),
            false => (Rule::Trapezoid, measured.at(&without)),
        };
        let objective = MovieObjective { rule, ..*objective };
        let placed = objective.displaced(&point)?;
        let means = objective.seen_velocities(&placed, objective.split(&point).1)?;
        let (mut squares, mut predicted) = (vec![(0.0, 0.0); regions.count()], Vec::new());
        for ((motion, seen), mean) in all.motions.iter().zip(&measured.velocities).zip(means) {
            if left(motion) {
                continue;
            }
            let Some(seen) = seen else { continue };
            // Without a polygon nothing is predicted.
            let mean = if mean.norm_squared().is_finite() { mean } else { Vector::zeros() };
            let (error, total) = &mut squares[regions.of(all, motion)];
            *error += (seen - mean).norm_squared();
            *total += seen.norm_squared();
            predicted.push((motion.interval, motion.track, mean));
        }
        Ok(squares.iter().any(|(_, total)| *total > 0.0).then_some((squares, predicted)))
    })?;
    let tested: Vec<_> = tested.into_iter().flatten().collect();
    let mut predicted = vec![BTreeMap::new(); objective.movie.frames() - 1];
    for (interval, track, v) in tested.iter().flat_map(|fold| &fold.1) {
        predicted[*interval].insert(*track, *v);
    }
    let of_frames = intervals(objective.movie) >= FEWEST_INTERVALS;
    let squares: Vec<Vec<(f64, f64)>> = tested.into_iter().map(|fold| fold.0).collect();
    Ok((squares.len() >= 2).then(|| HeldOut { folds: Folds::of_regions(of_frames, &squares), predicted }))
}

/// A Gauss–Newton step from some unknowns to those of a fit, near some coefficients.
fn fitted_to(objective: &MovieObjective<'_>, at: &[f64], known: &DMatrix<f64>) -> Result<Vec<f64>, Error> {
    let places = vec![DAMPING_OF_PLACES; objective.states.polarities_begin()];
    let step = objective.linearise(at)?.step_near(DAMPING, &places, known)?.step;
    Ok(at.iter().zip(&step).map(|(at, step)| at + step).collect())
}

/// Polarities of cells none of whose motions are in a fit: nothing is known of these but what the forces on all cells say of first polarities, which is
/// worth nothing where a cell stands oddly.
fn forget_unseen(all: &States, fitted: &[Motion], displacements: &mut [f64]) {
    let seen: BTreeSet<u32> = fitted.iter().map(|motion| motion.track).collect();
    for motion in all.motions.iter().filter(|motion| !seen.contains(&motion.track)) {
        for block in all.polarity(motion).into_iter().flatten() {
            displacements[2 * block..2 * block + 2].fill(0.0);
        }
    }
}

fn intervals(movie: &Movie) -> usize {
    movie.frames() - 1
}

/// The fold of each motion, by track and interval.
fn folds(movie: &Movie, states: &States) -> Vec<Vec<usize>> {
    let intervals = intervals(movie);
    let mut folds = vec![vec![usize::MAX; intervals]; movie.tracks.len()];
    let parts = Regions::new(states, PARTS);
    for motion in &states.motions {
        let fold = if intervals >= FEWEST_INTERVALS {
            // The first finds where the cells are.
            if motion.interval == 0 { usize::MAX } else { motion.interval % FOLDS.min(intervals - 1) }
        } else {
            parts.of(states, motion)
        };
        folds[motion.track as usize][motion.interval] = fold;
    }
    folds
}

/// Parts of the field between quantiles of where the cells are at first.
struct Regions {
    ends: [Vec<f64>; 2],
}

impl Regions {
    /// So many along each axis.
    fn new(states: &States, along: usize) -> Self {
        let ends = [0, 1].map(|axis| {
            let mut all: Vec<f64> = states.start.iter().map(|r| r[axis]).collect();
            all.sort_unstable_by(f64::total_cmp);
            (1..along).filter_map(|k| all.get(k * all.len() / along).copied()).collect()
        });
        Self { ends }
    }

    fn count(&self) -> usize {
        (self.ends[0].len() + 1) * (self.ends[1].len() + 1)
    }

    /// That in which a motion begins.
    fn of(&self, states: &States, motion: &Motion) -> usize {
        let r = states.instants[motion.interval].cells.positions[motion.cells[0] as usize];
        let [x, y] = [0, 1].map(|axis| self.ends[axis].partition_point(|end| *end < r[axis]));
        x + (self.ends[0].len() + 1) * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::memory::Memory;
    use crate::tracks::sample::followed;
    use crate::{Activity, NoiseLevels};

    /// However much cells do to each other, errors of their positions count for no more than is stated.
    #[test]
    fn errors_of_positions_have_an_end() {
        let (movie, request, followed) = followed(Activity::None);
        let space = request.space().unwrap();
        let objective = followed.objective(&movie, &request.structure, &space);
        let at = &followed.fit.parameters;
        let measured = AsMeasured::new(objective, objective.split(at).1);
        let [all, ended] = [f64::INFINITY, 1e-6].map(|most| measured.noise(at, most).unwrap());
        assert!(all > measured.noise_of_motions() * objective.levels.position.powi(2) && all.is_finite());
        let used = measured.velocities.iter().flatten().count() as f64;
        assert!(ended < all && (ended / used - 1e-6).abs() < 1e-9, "{all} {ended}");
    }

    /// What is predicted of motions that were left out does not depend on the polarities that these had led to, however loosely polarities are held.
    #[test]
    fn motions_left_out_are_forgotten() {
        let (movie, request, followed) = followed(Activity::Alignment);
        let space = request.space().unwrap();
        let fitted = followed.objective(&movie, &request.structure, &space);
        let memory = Memory { times: 0.03, speed: 2.0, free: 0.99, alignment: 5.0 };
        // Places so stiff that the mean stiffness is far above that of polarities.
        let levels = NoiseLevels { position: 1e-4, velocity: 0.2 };
        let motions: Vec<Motion> =
            fitted.states.motions.iter().filter(|motion| motion.interval < 2).copied().collect();
        let states = States { motions, ..fitted.states.clone() };
        let objective = MovieObjective { states: &states, memory: Some(memory), levels, ..fitted };
        let at = &followed.fit.parameters;
        let own = space.dimension() + 2 * states.polarities.range().start;
        let polarities = own..own + 2 * states.polarities.count();
        let mut otherwise = at.clone();
        otherwise[polarities.clone()].iter_mut().for_each(|u| *u = 0.0);
        let unknown = DMatrix::zeros(space.dimension(), space.dimension());
        let [one, other] = [at, &otherwise].map(|at| fitted_to(&objective, at, &unknown).unwrap());
        let of = |at: &[f64]| at[polarities.clone()].to_vec();
        let apart =
            |a: &[f64], b: &[f64]| of(a).iter().zip(of(b)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let share = apart(&one, &other) / apart(at, &otherwise);
        assert!(share < 0.05, "{share}");
    }
}
