//! The motion of the cells from one frame to the next, integrated from where they are in the first.
//!
//! ```text
//! x' = x + h/6 (F_1 + 2 F_2 + 2 F_3 + F_4) + h Σ turns
//! F_1 = F(x),   F_2 = F(x + h/2 F_1),   F_3 = F(x + h/2 F_2),   F_4 = F(x + h F_3)
//! ```
//!
//! Cells whose motion is explained go as the model says, with their polarity, if cells crawl, and their share of the translation of the stage;
//! the others go straight from where they are in one frame to where they are in the next. What changes of neighbours within a step add is in [`super::turn`].

use super::objective::MovieObjective;
use super::stages::{STAGES, Stage};
use super::turn::{Turn, single_terms};
use crate::Error;
use crate::objective::Nudged;
use voronudge_geometry::{MovingTessellation, Vector};
use voronudge_model::Model;

/// One step.
pub(super) struct Step<'a> {
    /// The cells at its stages.
    pub stages: [Stage<'a>; 4],
    /// The transitions in between.
    pub turns: Vec<Turn>,
}

/// The steps from one frame to the next.
pub(crate) struct Passage<'a> {
    pub(super) steps: Vec<Step<'a>>,
    /// Displacement of each cell of the interval, translation included.
    pub moved: Vec<Vector<f64>>,
}

/// What does not change from step to step.
struct Way<'a, 's> {
    objective: MovieObjective<'a>,
    interval: usize,
    /// Velocity of each cell besides that of the model, or of its straight way.
    beside: &'s [Vector<f64>],
    coefficients: &'s [f64],
    terms: Vec<Model<f64>>,
}

impl<'a> Passage<'a> {
    /// The motion over an interval in some steps; `first` are the positions of the cells of its first frame, `beside` the velocities that the cells
    /// of the interval have besides those of the model.
    pub fn new(
        objective: MovieObjective<'a>,
        interval: usize,
        count: usize,
        first: &[Vector<f64>],
        beside: &[Vector<f64>],
        coefficients: &[f64],
    ) -> Result<Self, Error> {
        let between = &objective.states.intervals[interval];
        let span = objective.span(interval);
        let terms = single_terms(objective.structure, between.halfway.environment());
        let way = Way { objective, interval, beside, coefficients, terms };
        let begin: Vec<Vector<f64>> = between.ends.iter().map(|own| first[own[0] as usize]).collect();
        let mut moving = between
            .halfway
            .moving_to(&begin)
            .map_err(|source| Error::Geometry { frame: interval, source })?;
        let (mut at, mut steps) = (begin.clone(), Vec::with_capacity(count));
        for _ in 0..count {
            let (step, next) = way.step(&mut moving, at, span / count as f64)?;
            steps.push(step);
            at = next;
        }
        let moved = at.iter().zip(&begin).map(|(end, begin)| end - begin).collect();
        Ok(Self { steps, moved })
    }
}

/// Whether a cell has a velocity: it has none while its polygon or one next to it is open. Then it goes with the stage.
pub(super) fn is_known(velocity: Vector<f64>) -> bool {
    velocity.norm_squared().is_finite()
}

impl<'a> Way<'a, '_> {
    /// One step of a length, and where it ends.
    fn step(
        &self,
        moving: &mut MovingTessellation,
        begin: Vec<Vector<f64>>,
        length: f64,
    ) -> Result<(Step<'a>, Vec<Vector<f64>>), Error> {
        let led = &self.objective.states.intervals[self.interval].led;
        let after = |velocity: &dyn Fn(usize) -> Vector<f64>, time: f64| -> Vec<Vector<f64>> {
            let next = |(cell, r): (usize, &Vector<f64>)| {
                let own = if led[cell] { velocity(cell) } else { Vector::zeros() };
                let own = if is_known(own) { own } else { Vector::zeros() };
                r + (self.beside[cell] + own) * time
            };
            begin.iter().enumerate().map(next).collect()
        };
        let stage = |moving: &mut _, before: &Stage<'_>, share: f64| {
            self.moving(moving, after(&|cell| before.1[cell], share * length))
        };
        let first = self.moving(moving, begin.clone())?;
        let second = stage(moving, &first, STAGES[1].0)?;
        let third = stage(moving, &second, STAGES[2].0)?;
        let fourth = stage(moving, &third, STAGES[3].0)?;
        let stages = [first, second, third, fourth];
        let turns = Turn::within(&stages, &self.terms, length / self.objective.span(self.interval));
        let weighted =
            |cell: usize| STAGES.iter().zip(&stages).map(|((_, weight), at)| at.1[cell] * *weight).sum();
        let mut next = after(&weighted, length);
        for turn in &turns {
            for (number, cell) in turn.cells.iter().enumerate().filter(|(_, cell)| led[**cell]) {
                next[*cell] += turn.added(number, self.coefficients) * length;
            }
        }
        Ok((Step { stages, turns }, next))
    }

    /// The cells of the interval at some time.
    fn moving(
        &self,
        moving: &mut MovingTessellation,
        positions: Vec<Vector<f64>>,
    ) -> Result<Stage<'a>, Error> {
        let MovieObjective { structure, states, .. } = self.objective;
        moving.renew(&positions).map_err(|_| Error::Diverges { frame: self.interval })?;
        let environment = states.intervals[self.interval].halfway.environment().clone();
        let nudged = Nudged::placed(structure, environment, positions, moving.tessellation().clone(), None);
        let velocities = nudged.velocities(self.coefficients);
        Ok((nudged, velocities))
    }
}
