//! Cells that were not detected, and detections that are no cells.
//!
//! A cell that was not detected spoils the polygons of about six neighbours and the velocities of about eighteen: 36 data
//! for two unknown coordinates. Four kinds of changes make a frame complete: a cell is put in, a detection is taken away, one
//! detection is split into two cells, two are merged into one.
//!
//! ```text
//! coefficients that few data cannot decide  ─>  the most promising places  ─>  placed by the velocities nearby
//!         ^                                                                             │ evidence
//!         └──  all changes placed anew, those without evidence undone  <──  the best ones, far from each other
//! ```
//!
//! The order matters: coefficients that follow the first wrong cell never recover. Where no further change has evidence, cells that were
//! put in near each other are placed anew together (`arrangement`).

mod arrangement;
mod change;
mod law;
mod misfit;
mod neighbourhood;
mod polygons;
mod proposal;
mod scene;

pub use change::{Change, ChangeKind};
pub use scene::Origin;

use crate::noise::FIRST_POSITION_NOISE;
use crate::search::Watch;
use crate::{CoefficientSpace, Error, NoiseLevels, Observation, Progress, Request};
use arrangement::rearranged;
use law::{Law, coefficients};
use polygons::Polygons;
use proposal::{Evidence, Stage, assess, proposals, reassess, split_between};
use rayon::prelude::*;
use scene::Scene;
use std::ops::ControlFlow;

/// Evidence that a change needs, in −2 log likelihood: odds of twenty to one.
const LEAST_EVIDENCE: f64 = 6.0;

/// Share of the best evidence of a round that others need to be taken with it: the first coefficients are rough.
const WITH_THE_BEST: f64 = 0.3;

/// Distance, in ℓ₀, of changes that are made together.
const APART: f64 = 3.5;

/// Rounds at most.
const ROUNDS: usize = 30;

/// Rounds in a row that undo as much as they make, before the search ends.
const IDLE_ROUNDS: usize = 4;

/// Velocity noise assumed if it is not known, in units of the velocities.
const FIRST_VELOCITY_NOISE: f64 = 0.05;

/// Rates of faults assumed first, per cell.
const FIRST_RATE: [f64; 4] = [0.02, 0.003, 0.003, 0.003];

/// Cells of each kind that an estimated rate counts beside those found.
const RATE_PRIOR: f64 = 0.5;

/// A frame whose detections have been looked over.
#[derive(Debug, Clone)]
pub struct CompletedFrame {
    /// The frame with all changes made: detections that are kept in their order, then cells that were put in. The latter have
    /// no measured position.
    pub observation: Observation,
    /// Where each of its cells comes from.
    pub origins: Vec<Origin>,
    /// What was changed.
    pub changes: Vec<Change>,
}

/// Frames whose detections have been looked over.
#[derive(Debug, Clone)]
pub struct Completion {
    /// The frames, in the order given.
    pub frames: Vec<CompletedFrame>,
    /// Share of the cells that were not detected: as given, or estimated.
    pub missed_rate: f64,
}

impl Completion {
    /// Number of changes of a kind.
    pub fn count(&self, kind: ChangeKind) -> usize {
        let changes = self.frames.iter().flat_map(|frame| &frame.changes);
        changes.filter(|change| change.kind == kind).count()
    }
}

/// How often detections are at fault, per cell, in the order of [`ChangeKind::ALL`].
#[derive(Debug, Clone)]
struct Rates {
    of_kind: [f64; 4],
    missed: Option<f64>,
}

impl Rates {
    fn new(missed: Option<f64>) -> Self {
        let mut of_kind = FIRST_RATE;
        of_kind[0] = missed.unwrap_or(of_kind[0]);
        Self { of_kind, missed }
    }

    /// Follows from what was found.
    fn estimate(&mut self, scenes: &[Scene<'_>]) {
        let cells: usize = scenes.iter().map(|scene| scene.origins.len()).sum();
        for (rate, kind) in self.of_kind.iter_mut().zip(ChangeKind::ALL) {
            let changes = scenes.iter().flat_map(|scene| &scene.changes);
            let count = changes.filter(|change| change.kind == kind).count();
            *rate = (count as f64 + RATE_PRIOR) / (cells as f64 + 2.0 * RATE_PRIOR);
        }
        self.of_kind[0] = self.missed.unwrap_or(self.of_kind[0]);
    }

    /// Log odds of a fault where one is looked for.
    fn log_odds(&self, kind: ChangeKind, polygons: &Polygons) -> f64 {
        let index = ChangeKind::ALL.iter().position(|own| *own == kind).unwrap_or(0);
        let odds = self.of_kind[index] / (1.0 - self.of_kind[index]);
        // A missing cell can be in any void.
        let places = if kind == ChangeKind::Inserted { polygons.voids } else { 1.0 };
        (odds / places).ln()
    }
}

/// Looks for cells that were not detected, and for detections that are no cells. `missed_rate` is the share of the cells that
/// is not detected, if it is known. Lengths in units of ℓ₀, velocities in units of their root mean square. Where the cells are
/// too few to learn from, nothing is changed.
///
/// # Errors
/// [`Error`] if there is too little to fit, the terms cannot be told apart, or the caller stops.
pub fn complete(
    frames: &[Observation],
    request: &Request,
    missed_rate: Option<f64>,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Completion, Error> {
    let mut scenes: Vec<Scene<'_>> = frames.iter().map(Scene::new).collect();
    let mut rates = Rates::new(missed_rate);
    if let Some(polygons) = Polygons::new(&scenes) {
        let space = request.space()?;
        let levels = NoiseLevels {
            position: request.noise.position.unwrap_or(FIRST_POSITION_NOISE),
            velocity: request.noise.velocity.unwrap_or(FIRST_VELOCITY_NOISE),
        };
        let known = request.noise.position.is_some() && request.noise.velocity.is_some();
        let labels = labels(frames, request);
        let least_excess = if known { 1.0 } else { 0.0 };
        let search = Search { request, space, levels, polygons, labels, least_excess };
        search.run(&mut scenes, &mut rates, &mut Watch { observe })?;
    }
    let completed = |scene: Scene<'_>| CompletedFrame {
        observation: scene.observation,
        origins: scene.origins,
        changes: scene.changes,
    };
    let missed_rate = rates.of_kind[0];
    Ok(Completion { frames: scenes.into_iter().map(completed).collect(), missed_rate })
}

/// A search for changes.
struct Search<'a> {
    request: &'a Request,
    space: CoefficientSpace,
    levels: NoiseLevels,
    polygons: Polygons,
    labels: Vec<(Option<i64>, f64)>,
    least_excess: f64,
}

/// The labels of cells that have parameters of their own, and −2 log of their shares of the cells; none at all, which is certain, where cells are alike.
fn labels(frames: &[Observation], request: &Request) -> Vec<(Option<i64>, f64)> {
    let Some(kinds) = &request.kinds else { return vec![(None, 0.0)] };
    let of_cells = || frames.iter().flat_map(|frame| frame.environment().labels()).flatten();
    let all = of_cells().count().max(1) as f64;
    let share = |label: i64| of_cells().filter(|own| **own == label).count() as f64 / all;
    let known = std::iter::once(kinds.reference).chain(kinds.others.iter().copied());
    known.map(|label| (Some(label), -2.0 * share(label).max(f64::MIN_POSITIVE).ln())).collect()
}

impl Search<'_> {
    fn run(&self, scenes: &mut [Scene<'_>], rates: &mut Rates, watch: &mut Watch<'_>) -> Result<(), Error> {
        let mut free = self.coefficients(scenes, None)?;
        let (mut excess, mut idle, mut stage) = (f64::INFINITY, 0, Stage::Additions);
        // Whether nothing has changed since no cells had a better arrangement.
        let mut settled = false;
        for round in 0..ROUNDS {
            watch.tell("cells not detected", (round as u64, ROUNDS as u64), 1.0)?;
            let found = {
                let at = self.space.coefficients(&free);
                let law = self.law(at.as_slice(), 1.0);
                // Holes make residuals larger, never smaller.
                let of_frames: Vec<&Observation> = scenes.iter().map(|scene| &scene.observation).collect();
                excess = excess.min(law.excess(&of_frames)).max(self.least_excess);
                let evidence = self.evidence(scenes, at.as_slice(), excess, rates);
                scenes.par_iter_mut().for_each(|scene| scene.explain(&evidence.law));
                self.find(scenes, stage, &evidence)?
            };
            let made: usize = found.iter().map(Vec::len).sum();
            for (scene, own) in scenes.iter_mut().zip(found) {
                if !own.is_empty() {
                    scene.change(scene.changes.iter().cloned().chain(own).collect())?;
                }
            }
            free = self.coefficients(scenes, Some(&free))?;
            let undone = self.revise(scenes, stage, (free.as_slice(), excess), rates)?;
            rates.estimate(scenes);
            idle = if made == undone { idle + 1 } else { 0 };
            settled &= made + undone == 0;
            if made + undone == 0 || idle == IDLE_ROUNDS {
                // What is arranged anew is looked over once more.
                if !settled && round + 1 < ROUNDS {
                    let moved = self.rearrange(scenes, (free.as_slice(), excess), rates)?;
                    settled = moved == 0;
                }
                match stage {
                    _ if !settled => idle = 0,
                    Stage::Additions if made + undone == 0 => (stage, idle) = (Stage::Others, 0),
                    Stage::Additions => (stage, idle) = (Stage::All, 0),
                    Stage::Others | Stage::All => break,
                }
            } else if stage == Stage::Others {
                stage = Stage::All;
            }
            free = self.coefficients(scenes, Some(&free))?;
        }
        Ok(())
    }

    fn coefficients(&self, scenes: &[Scene<'_>], start: Option<&[f64]>) -> Result<Vec<f64>, Error> {
        let frames: Vec<&Observation> = scenes.iter().map(|scene| &scene.observation).collect();
        coefficients(&frames, &self.request.structure, &self.space, self.levels, start, 1.0)
    }

    fn law<'l>(&'l self, coefficients: &'l [f64], excess: f64) -> Law<'l> {
        Law { structure: &self.request.structure, coefficients, levels: self.levels, excess }
    }

    fn evidence<'l>(
        &'l self,
        scenes: &[Scene<'_>],
        coefficients: &'l [f64],
        excess: f64,
        rates: &'l Rates,
    ) -> Evidence<'l> {
        let targets = || scenes.iter().flat_map(|scene| scene.measured.explainable());
        let squares: f64 = targets().map(|v| v.norm_squared()).sum();
        let spread = 0.5 * squares / targets().count().max(1) as f64;
        Evidence {
            law: self.law(coefficients, excess),
            polygons: &self.polygons,
            rates,
            spread,
            labels: &self.labels,
        }
    }

    /// The changes with most evidence that are far from each other, for each frame.
    fn find(
        &self,
        scenes: &[Scene<'_>],
        stage: Stage,
        evidence: &Evidence<'_>,
    ) -> Result<Vec<Vec<Change>>, Error> {
        let tried: Vec<(usize, proposal::Proposal)> = scenes
            .par_iter()
            .enumerate()
            .flat_map_iter(|(index, scene)| {
                proposals(scene, &self.polygons, stage).into_iter().map(move |proposal| (index, proposal))
            })
            .collect();
        let mut changes = tried
            .par_iter()
            .map(|(index, proposal)| {
                Ok((*index, proposal.centre, assess(&scenes[*index], proposal, evidence)?))
            })
            .collect::<Result<Vec<_>, Error>>()?;
        changes.sort_by(|a, b| b.2.evidence.total_cmp(&a.2.evidence));
        let best = changes.first().map_or(0.0, |change| change.2.evidence);
        let least = LEAST_EVIDENCE.max(WITH_THE_BEST * best);
        let mut found: Vec<Vec<(voronudge_geometry::Vector<f64>, Change)>> = vec![Vec::new(); scenes.len()];
        for (index, centre, change) in changes.into_iter().filter(|change| change.2.evidence > least) {
            let scene = &scenes[index];
            if found[index].iter().all(|(other, _)| scene.between(*other, centre).norm() > APART) {
                found[index].push((centre, change));
            }
        }
        Ok(found.into_iter().map(|own| own.into_iter().map(|(_, change)| change).collect()).collect())
    }

    /// Arranges cells that were put in near each other anew where another arrangement has more evidence. Returns how often.
    fn rearrange(
        &self,
        scenes: &mut [Scene<'_>],
        (free, excess): (&[f64], f64),
        rates: &Rates,
    ) -> Result<usize, Error> {
        let at = self.space.coefficients(free);
        let evidence = self.evidence(scenes, at.as_slice(), excess, rates);
        let made = scenes
            .par_iter_mut()
            .map(|scene| {
                scene.explain(&evidence.law);
                // Each is compared with what is around it then: two could take turns without end.
                let most = scene.changes.len();
                let (mut made, mut index) = (0, 0);
                while index < scene.changes.len() && made < most {
                    match rearranged(scene, index, &evidence)? {
                        Some(changes) => {
                            scene.change(changes)?;
                            made += 1;
                        }
                        None => index += 1,
                    }
                }
                Ok(made)
            })
            .collect::<Result<Vec<usize>, Error>>()?;
        Ok(made.into_iter().sum())
    }

    /// Places all changes anew, one after the other, and undoes those that have lost their evidence. Returns their number.
    fn revise(
        &self,
        scenes: &mut [Scene<'_>],
        stage: Stage,
        (free, excess): (&[f64], f64),
        rates: &Rates,
    ) -> Result<usize, Error> {
        let at = self.space.coefficients(free);
        let evidence = self.evidence(scenes, at.as_slice(), excess, rates);
        let undone = scenes
            .par_iter_mut()
            .map(|scene| {
                let before = scene.changes.len();
                scene.explain(&evidence.law);
                let mut index = 0;
                while index < scene.changes.len() {
                    let mut changes = scene.changes.clone();
                    if stage != Stage::Additions
                        && let Some((other, split)) = split_between(scene, index, &evidence)?
                    {
                        changes[index] = split;
                        changes.remove(other);
                        index -= usize::from(other < index);
                        scene.change(changes)?;
                        continue;
                    }
                    let again = reassess(scene, index, stage, &evidence)?;
                    if again.evidence < LEAST_EVIDENCE {
                        changes.remove(index);
                    } else {
                        changes[index] = again;
                        index += 1;
                    }
                    scene.change(changes)?;
                }
                Ok(before - scene.changes.len())
            })
            .collect::<Result<Vec<usize>, Error>>()?;
        Ok(undone.into_iter().sum())
    }
}
