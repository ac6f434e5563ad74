//! Where the model leads cells that were not seen, from where they were before or will be.
//!
//! Such a cell is put to the middle of the room that the others leave, which can be a third of its size from where it is, in a neighbourhood of other contacts. Motions
//! around it are then nothing that the model explains, count little, and no longer lead it back. With some coefficients known it is better begun where these lead.

use super::course::Course;
use super::instants::Place;
use super::motions::Motion;
use super::objective::MovieObjective;
use super::passage::Passage;
use super::states::States;
use crate::Error;
use voronudge_geometry::Vector;

/// Rounds in which a place before a track begins is found such that the motion from there leads to where it does.
const ROUNDS: usize = 3;

/// A cell does not go farther than this from the middle of its room, in units of ℓ₀.
const FARTHEST: f64 = 0.6;

impl Course<'_, '_> {
    /// The point at which unseen cells are where the model leads them, if that is likelier.
    pub(super) fn place_unseen(&self, states: &States, at: Vec<f64>) -> Result<Vec<f64>, Error> {
        let objective = self.objective(states);
        let placed = Unseen { objective }.led(at.clone())?;
        let is_better = placed != at && objective.value(&placed) < objective.value(&at);
        Ok(if is_better { placed } else { at })
    }
}

struct Unseen<'a> {
    objective: MovieObjective<'a>,
}

impl Unseen<'_> {
    /// All of them, forwards in time and then, of tracks that have not begun, backwards.
    fn led(&self, mut at: Vec<f64>) -> Result<Vec<f64>, Error> {
        let states = self.objective.states;
        let mut is_free = vec![true; states.start.len()];
        states.anchors.iter().for_each(|place| is_free[*place as usize] = false);
        if !is_free.contains(&true) {
            return Ok(at);
        }
        let of_end = |motion: &Motion, end: usize| match states.instants[motion.interval + end].place
            [motion.cells[end] as usize]
        {
            Place::Own(place) if is_free[place as usize] => Some(place as usize),
            _ => None,
        };
        let mut is_led = vec![false; states.start.len()];
        let intervals: Vec<&[Motion]> =
            states.motions.chunk_by(|one, next| one.interval == next.interval).collect();
        for motions in &intervals {
            let unseen: Vec<(&Motion, usize)> =
                motions.iter().filter_map(|motion| Some((motion, of_end(motion, 1)?))).collect();
            if unseen.is_empty() {
                continue;
            }
            let [moved, first] = self.moved(motions[0].interval, &at)?;
            for (motion, place) in unseen {
                let to = first[motion.cells[0] as usize] + moved[motion.between as usize];
                is_led[place] |= self.put(&mut at, (motion, 1, place), to);
            }
        }
        for motions in intervals.iter().rev() {
            let begins = |motion: &Motion| of_end(motion, 0).filter(|place| !is_led[*place]);
            let unseen: Vec<(&Motion, usize)> =
                motions.iter().filter_map(|motion| Some((motion, begins(motion)?))).collect();
            for _ in 0..if unseen.is_empty() { 0 } else { ROUNDS } {
                let interval = motions[0].interval;
                let [moved, _] = self.moved(interval, &at)?;
                let last = self.objective.positions(interval + 1, self.objective.split(&at).1);
                for (motion, place) in &unseen {
                    let from = last[motion.cells[1] as usize] - moved[motion.between as usize];
                    self.put(&mut at, (motion, 0, *place), from);
                }
            }
        }
        Ok(at)
    }

    /// How far the cells of an interval go by the model, and where those of its first frame are.
    fn moved(&self, interval: usize, at: &[f64]) -> Result<[Vec<Vector<f64>>; 2], Error> {
        let (free, displacements) = self.objective.split(at);
        let coefficients = self.objective.space.coefficients(free);
        let [first, last] =
            [interval, interval + 1].map(|frame| self.objective.positions(frame, displacements));
        let beside = self.objective.beside(interval, [&first, &last], displacements);
        let steps = self.objective.rule.steps();
        let passage =
            Passage::new(self.objective, interval, steps, &first, &beside, coefficients.as_slice())?;
        Ok([passage.moved, first])
    }

    /// Puts the cell at an end of a motion somewhere, unless that is too far from its room.
    fn put(&self, at: &mut [f64], (motion, end, place): (&Motion, usize, usize), to: Vector<f64>) -> bool {
        let room =
            self.objective.states.instants[motion.interval + end].cells.positions[motion.cells[end] as usize];
        let way = self.objective.movie.domain.shortest(to - room);
        let is_near = way.norm() <= FARTHEST;
        if is_near {
            let own = self.objective.space.dimension() + 2 * place;
            (at[own], at[own + 1]) = (way.x, way.y);
        }
        is_near
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::ends::lengthen;
    use crate::tracks::movie::{Drift, Movie};
    use crate::tracks::rule::Rule;
    use crate::tracks::sample::{Filmed, TRUTH};
    use crate::{CoefficientSpace, Constraints, FitParameter, NoiseLevels};
    use voronudge_geometry::FieldOfView;
    use voronudge_model::Structure;

    /// With the right coefficients, cells that were not seen at first, in between or at last are led to where they were, nearer than to the middle of their room.
    #[test]
    fn unseen_cells_are_led_to_where_they_were() {
        let (mut film, domain, chiral) = Filmed { size: [144, 5], step: 0.1, error: 0.002, seed: 6 }.film();
        let truth = film.clone();
        let hidden: Vec<(usize, usize)> =
            (0..8).flat_map(|k| [(0, 3 + 17 * k), (2, 9 + 17 * k), (4, 14 + 17 * k)]).collect();
        for &(frame, cell) in &hidden {
            film[frame][cell] = None;
        }
        let times = (0..5).map(|frame| 0.1 * f64::from(frame)).collect();
        let movie = Movie::new(times, &film, domain, FieldOfView::default(), Drift::None).unwrap();
        let movie = lengthen(movie).unwrap();
        let space =
            CoefficientSpace::new(&Constraints::fixed([(FitParameter::AreaElasticity, 0.0)])).unwrap();
        let states = States::new(&movie).unwrap();
        let objective = MovieObjective {
            movie: &movie,
            states: &states,
            rule: Rule::RungeKutta(8),
            structure: &Structure::base(1.0),
            space: &space,
            levels: NoiseLevels { position: 0.002, velocity: 0.15 },
            memory: None,
        };
        let unit = chiral / TRUTH[1];
        let at = objective.start(&space.nearest(&[0.0, unit * TRUTH[0], unit, chiral]));
        let led = Unseen { objective }.led(at.clone()).unwrap();
        assert!(objective.value(&led) < objective.value(&at));
        let misses = |at: &[f64]| -> Vec<f64> {
            let miss = |&(frame, cell): &(usize, usize)| {
                let here = states.instants[frame].tracks.iter().position(|track| *track as usize == cell);
                let place = objective.positions(frame, &at[space.dimension()..])[here.unwrap()];
                domain.shortest(place - truth[frame][cell].unwrap()).norm()
            };
            hidden.iter().map(miss).collect()
        };
        let largest = |misses: Vec<f64>| misses.into_iter().fold(0.0, f64::max);
        let (before, after) = (largest(misses(&at)), largest(misses(&led)));
        assert!(before > 0.1 && after < 0.05, "{before} {after}");
        // Those that were seen are where they were.
        let moved = (led.iter().zip(&at)).skip(space.dimension()).filter(|(led, at)| led != at).count();
        assert!(moved <= 2 * hidden.len(), "{moved}");
    }
}
