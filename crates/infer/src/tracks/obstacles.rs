//! Where a step fails: the cells at which the linearised problem does not hold, because contacts change there.

use super::instants::Place;
use super::objective::MovieObjective;
use super::placed::Placed;
use crate::obstacles::{around, failing};
use crate::position_rows::squares;

/// What a term of Φ belongs to.
#[derive(Debug, Clone, Copy)]
enum Owner {
    /// The motion of this number.
    Motion(usize),
    /// The measured position of a cell at a frame.
    Position(usize, usize),
}

impl MovieObjective<'_> {
    /// The terms of Φ that belong to cells.
    fn terms(&self, (placed, parameters): (&Placed<'_>, &[f64])) -> Vec<(Owner, f64)> {
        let residuals = self.residuals(placed, parameters);
        let motions = residuals.iter().enumerate();
        let mut terms: Vec<(Owner, f64)> =
            motions.map(|(number, rest)| (Owner::Motion(number), self.counted(rest))).collect();
        let spring = self.levels.spring();
        let of_frames = self.of_seen(placed, self.split(parameters).1, |frame, cells, nudged, nudges| {
            let all = squares(cells, &nudged.tessellation, &nudged.positions, nudges).enumerate();
            all.map(|(cell, square)| (Owner::Position(frame, cell), spring * square)).collect::<Vec<_>>()
        });
        terms.extend(of_frames.into_iter().flatten());
        terms
    }

    /// Marks the places of a cell at a frame and of its neighbours.
    fn mark(&self, frame: usize, cell: usize, marked: &mut [bool]) {
        let instant = &self.states.instants[frame];
        for cell in around(&instant.cells.tessellation, cell) {
            if let Place::Own(place) = instant.place[cell] {
                marked[place as usize] = true;
            }
        }
    }
}

impl MovieObjective<'_> {
    /// The places at which a step from one point to another fails, if they are few.
    pub(super) fn obstacles(
        &self,
        before: (&Placed<'_>, &[f64]),
        after: (&Placed<'_>, &[f64]),
        promised: f64,
    ) -> Option<Vec<usize>> {
        let (before, after) = (self.terms(before), self.terms(after));
        let mut marked = vec![false; self.states.blocks()];
        for owner in failing(&before, &after, promised, self.states.anchors.len())? {
            match owner {
                Owner::Motion(number) => {
                    let motion = &self.states.motions[number];
                    for (end, cell) in motion.cells.iter().enumerate() {
                        self.mark(motion.interval + end, *cell as usize, &mut marked);
                    }
                }
                Owner::Position(frame, cell) => self.mark(frame, cell, &mut marked),
            }
        }
        Some((0..marked.len()).filter(|place| marked[*place]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levenberg_marquardt::Obstacles;
    use crate::normal_equations::Step;
    use crate::placing::Remembering;
    use crate::tracks::first::naive_coefficients;
    use crate::tracks::rule::Rule;
    use crate::tracks::sample::Filmed;
    use crate::tracks::states::States;
    use crate::{CoefficientSpace, Constraints, NoiseLevels};
    use voronudge_model::Structure;

    /// A good step in which some cells are led astray: a few of them are named, with their neighbours, and without them the step is good; if
    /// it is all of them, the step is bad as a whole.
    #[test]
    fn a_step_fails_where_cells_go_astray() {
        let (movie, _) = Filmed { size: [144, 3], step: 0.1, error: 0.02, seed: 3 }.movie();
        let (states, structure) = (States::new(&movie).unwrap(), Structure::base(1.0));
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let levels = NoiseLevels { position: 0.02, velocity: 0.1 };
        let (movie, states, structure, space) = (&movie, &states, &structure, &space);
        let rule = Rule::RungeKutta(1);
        let objective = &MovieObjective { movie, states, rule, structure, space, levels, memory: None };
        let problem = Remembering::new(objective);
        let onwards = |at: &[f64]| {
            let Step { step, promised } = objective.linearise(at).unwrap().step(1e-3, &[]).unwrap();
            (at.iter().zip(&step).map(|(x, s)| x + s).collect::<Vec<f64>>(), promised)
        };
        let (at, _) = onwards(&objective.start(&naive_coefficients(objective).unwrap()));
        let (good, promised) = onwards(&at);
        let gained = objective.value(&at) - objective.value(&good);
        assert!(gained > 0.7 * promised, "{gained} {promised}");
        let first = space.dimension();
        let astray = |places: &mut dyn Iterator<Item = usize>| {
            let mut trial = good.clone();
            places.for_each(|place| trial[first + 2 * place] += 0.4);
            trial
        };
        let (one, other) = (100, 301);
        let trial = astray(&mut [one, other].into_iter());
        let lost = objective.value(&trial) - objective.value(&at);
        assert!(lost > 0.0, "{lost} {gained} {promised}");
        let places = problem.obstacles(&at, &trial, promised).unwrap();
        assert!(places.contains(&one) && places.contains(&other) && places.len() < 150, "{places:?}");
        let mut without = trial.clone();
        for place in places {
            let own = first + 2 * place..first + 2 * place + 2;
            without[own.clone()].copy_from_slice(&at[own]);
        }
        let kept = objective.value(&at) - objective.value(&without);
        assert!(kept > 0.3 * promised, "{kept} {promised}");
        let everywhere = astray(&mut (0..states.anchors.len()).step_by(3));
        assert!(problem.obstacles(&at, &everywhere, promised).is_none());
    }
}
