//! Problems for argmin whose cells are placed once for all that is asked of a point.

use crate::Error;
use crate::levenberg_marquardt::Obstacles;
use crate::normal_equations::NormalEquations;
use argmin::core::{CostFunction, Error as ArgminError, Jacobian};
use std::cell::RefCell;
use std::rc::Rc;

/// An objective of where cells are.
pub(crate) trait Placing {
    /// The cells at a point, with what the model says of them.
    type Placed;

    fn placed_at(&self, at: &[f64]) -> Result<Self::Placed, Error>;

    fn value_of(&self, placed: &Self::Placed, at: &[f64]) -> f64;

    fn linearise_of(&self, placed: &Self::Placed, at: &[f64]) -> Result<NormalEquations, Error>;

    /// The places (pairs of nudges) without which a step would gain about what it promises, if these are few.
    fn obstacles_between(
        &self,
        _before: (&Self::Placed, &[f64]),
        _after: (&Self::Placed, &[f64]),
        _promised: f64,
    ) -> Option<Vec<usize>> {
        None
    }
}

/// How many points are remembered: the present one, and the last that was tried.
const REMEMBERED: usize = 2;

/// A point with the cells there.
type Known<P> = (Vec<f64>, Rc<<P as Placing>::Placed>);

/// An objective with the cells at the points that it was last asked of.
pub(crate) struct Remembering<'o, P: Placing> {
    objective: &'o P,
    /// The latest first.
    recent: RefCell<Vec<Known<P>>>,
}

impl<'o, P: Placing> Remembering<'o, P> {
    pub fn new(objective: &'o P) -> Self {
        Self { objective, recent: RefCell::default() }
    }

    fn placed(&self, at: &[f64]) -> Result<Rc<P::Placed>, Error> {
        let mut recent = self.recent.borrow_mut();
        match recent.iter().position(|(known, _)| known == at) {
            Some(known) => recent[..=known].rotate_right(1),
            None => {
                let placed = Rc::new(self.objective.placed_at(at)?);
                recent.truncate(REMEMBERED - 1);
                recent.insert(0, (at.to_vec(), placed));
            }
        }
        Ok(recent[0].1.clone())
    }
}

impl<P: Placing> CostFunction for Remembering<'_, P> {
    type Param = Vec<f64>;
    type Output = f64;

    /// Infinite where cells cannot be: a trial that moves cells onto each other, or opens the polygon of a cell that counts, is no solution.
    fn cost(&self, at: &Vec<f64>) -> Result<f64, ArgminError> {
        Ok(self.placed(at).map_or(f64::INFINITY, |placed| self.objective.value_of(&placed, at)))
    }
}

impl<P: Placing> Jacobian for Remembering<'_, P> {
    type Param = Vec<f64>;
    type Jacobian = NormalEquations;

    fn jacobian(&self, at: &Vec<f64>) -> Result<NormalEquations, ArgminError> {
        Ok(self.objective.linearise_of(&*self.placed(at)?, at)?)
    }
}

impl<P: Placing> Obstacles for Remembering<'_, P> {
    fn obstacles(&self, at: &[f64], trial: &[f64], promised: f64) -> Option<Vec<usize>> {
        let (before, after) = (self.placed(at).ok()?, self.placed(trial).ok()?);
        self.objective.obstacles_between((&before, at), (&after, trial), promised)
    }
}
