//! The cells at which a step of a fit to snapshots fails.

use super::{Moving, Objective};
use crate::obstacles::{around, failing};
use crate::position_rows::squares;
use crate::residuals::residuals;
use voronudge_geometry::Vector;

/// What a term of Φ belongs to, with its frame.
#[derive(Debug, Clone, Copy)]
enum Owner {
    Velocity(usize, usize),
    Position(usize, usize),
}

impl Objective<'_> {
    /// The terms of Φ, but for cells that were not seen and priors.
    fn terms(&self, placed: &[Moving<'_>], parameters: &[f64]) -> Vec<(Owner, f64)> {
        let mut terms = Vec::new();
        let frames = self.frames.iter().zip(self.split(parameters).1).zip(placed);
        for (index, ((frame, nudges), (nudged, predicted))) in frames.enumerate() {
            let of_velocity = |(datum, rest): (usize, Vector<f64>)| {
                (Owner::Velocity(index, datum), frame.weight(datum) * rest.norm_squared())
            };
            terms.extend(residuals(frame, predicted.as_measured()).into_iter().map(of_velocity));
            let springs = squares(frame, &nudged.tessellation, &nudged.positions, nudges).enumerate();
            terms
                .extend(springs.map(|(cell, square)| (Owner::Position(index, cell), self.spring() * square)));
        }
        terms
    }

    /// The cells, counted through all frames, at which a step from one point to another fails, with those around them, if they are few.
    pub(super) fn obstacles(
        &self,
        before: (&Vec<Moving<'_>>, &[f64]),
        after: (&Vec<Moving<'_>>, &[f64]),
        promised: f64,
    ) -> Option<Vec<usize>> {
        let [old, new] = [before, after].map(|(placed, parameters)| self.terms(placed, parameters));
        let cells: Vec<usize> = self.frames.iter().map(|frame| frame.positions.len()).collect();
        let mut marked: Vec<Vec<bool>> = cells.iter().map(|count| vec![false; *count]).collect();
        for owner in failing(&old, &new, promised, cells.iter().sum())? {
            let (frame, cells) = match owner {
                Owner::Position(frame, cell) => (frame, vec![cell]),
                Owner::Velocity(frame, datum) => (frame, before.0[frame].0.measured_in(datum)),
            };
            for cell in cells.into_iter().flat_map(|cell| around(&before.0[frame].0.tessellation, cell)) {
                marked[frame][cell] = true;
            }
        }
        let places = marked.into_iter().flatten().enumerate();
        Some(places.filter(|(_, marked)| *marked).map(|(place, _)| place).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levenberg_marquardt::Obstacles;
    use crate::normal_equations::Step;
    use crate::objective::Nudged;
    use crate::placing::Remembering;
    use crate::sample::{flow, observation_of};
    use crate::{CoefficientSpace, Constraints, NoiseLevels, Observation, Window, WindowKind, least_squares};
    use voronudge_model::Structure;

    /// Calls with a problem, a point, a good step from there and what it promises.
    fn with_good_step(frames: &[Observation], check: impl Fn(&Objective<'_>, &[f64], &[f64], f64)) {
        let structure = Structure::base(1.0);
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let levels = NoiseLevels { position: 0.02, velocity: 0.1 };
        let objective = Objective::new(frames, &structure, &space, levels);
        let mut at = least_squares::fit(frames, &structure, &space).unwrap();
        at.resize(at.len() + objective.nudge_count(), 0.0);
        let Step { step, promised } = objective.linearise(&at).unwrap().step(1e-3, &[]).unwrap();
        let good: Vec<f64> = at.iter().zip(&step).map(|(x, s)| x + s).collect();
        check(&objective, &at, &good, promised);
    }

    /// Of two frames a cell of each goes astray: both are named with those around, and without these the step is good. If it is all of them the
    /// step is bad as a whole.
    #[test]
    fn a_step_fails_where_cells_go_astray() {
        let frames = [observation_of(14, 0.01, 0.1, 3), observation_of(14, 0.01, 0.1, 4)];
        with_good_step(&frames, |objective, at, good, promised| {
            let problem = Remembering::new(objective);
            let first = objective.space.dimension();
            let astray = |places: &mut dyn Iterator<Item = usize>| {
                let mut trial = good.to_vec();
                places.for_each(|place| trial[first + 2 * place] += 0.4);
                trial
            };
            let (one, other) = (20, 196 + 100);
            let trial = astray(&mut [one, other].into_iter());
            let gained = |trial: &[f64]| objective.value(at) - objective.value(trial);
            assert!(gained(good) > 0.5 * promised && gained(&trial) < 0.25 * promised);
            let places = problem.obstacles(at, &trial, promised).unwrap();
            assert!(places.contains(&one) && places.contains(&other) && places.len() < 200, "{places:?}");
            let mut without = trial.clone();
            for place in places {
                let own = first + 2 * place..first + 2 * place + 2;
                without[own.clone()].copy_from_slice(&at[own]);
            }
            assert!(gained(&without) > 0.25 * promised, "{} {promised}", gained(&without));
            assert!(problem.obstacles(at, &astray(&mut (0..392).step_by(3)), promised).is_none());
        });
    }

    /// A grid point is a matter of the cells in the middle of its window.
    #[test]
    fn grid_points_are_of_the_cells_in_their_windows() {
        let frames = [flow(Window { kind: WindowKind::GaussianArea, width: 0.4 })];
        let structure = Structure::base(1.0);
        let nudged = Nudged::as_measured(&frames[0], &structure);
        for datum in 0..36 {
            let centre = frames[0].position_of_datum(datum);
            let domain = frames[0].tessellation.domain();
            let nearest = (0..36).min_by(|a, b| {
                let distance = |cell: usize| domain.shortest(frames[0].positions[cell] - centre).norm();
                distance(*a).total_cmp(&distance(*b))
            });
            let cells = nudged.measured_in(datum);
            assert!(cells.contains(&nearest.unwrap()) && cells.len() <= 5, "{datum} {cells:?}");
        }
    }
}
