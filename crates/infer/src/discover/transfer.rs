//! What was found on some data, put to the test on others.

use super::result::{Discovery, HeldOut};
use super::search::Search;
use crate::Observation;
use crate::cross_validation::Folds;
use voronudge_model::{Column, Effect};

/// How well other velocities are predicted with everything as it was fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transfer {
    /// By the base model.
    pub before: HeldOut,
    /// By the model with the effects added.
    pub after: HeldOut,
    /// Fall of the error by the effects, and its standard error over frames.
    pub gain: [f64; 2],
}

/// An effect that was found cannot act on other data.
#[derive(Debug, Clone, Copy, thiserror::Error)]
#[error("{}: {reason}", effect.id)]
pub struct Absent {
    /// The effect.
    pub effect: &'static Effect,
    /// Why.
    pub reason: &'static str,
}

impl Discovery {
    /// The columns of the effects added, in their order; some have none.
    pub fn columns(&self) -> impl Iterator<Item = Column> + '_ {
        self.selected.iter().flat_map(|own| own.columns.iter().copied())
    }

    /// The same where effects have the columns `there`.
    ///
    /// # Errors
    /// [`Absent`] if one of them needs what is not there.
    pub fn columns_there(
        &self,
        there: impl Fn(&Effect) -> Result<Vec<Column>, &'static str>,
    ) -> Result<Vec<Column>, Absent> {
        for own in self.selected.iter().filter(|own| !own.columns.is_empty()) {
            let absent = |reason| Absent { effect: own.effect, reason };
            if there(own.effect).map_err(absent)? != own.columns {
                return Err(absent("these data have it in another form"));
            }
        }
        Ok(self.columns().collect())
    }

    /// Predicts the velocities of other frames, in the same units, at their measured positions, with what all cells share. `search` is what led to the
    /// result.
    ///
    /// # Errors
    /// [`Absent`] if an effect that was added needs what the other data do not have.
    pub fn predict(&self, search: &Search, frames: &[Observation]) -> Result<Transfer, Absent> {
        for frame in frames {
            let there = |effect: &Effect| effect.columns(frame.environment(), frame.tessellation.domain());
            self.columns_there(there)?;
        }
        let base = &search.fit.structure;
        let with = base.with(&self.columns().collect::<Vec<_>>());
        let before = Folds::predicted(frames, base, self.before.inference.coefficients.as_slice());
        let after = Folds::predicted(frames, &with, self.after.inference.coefficients.as_slice());
        Ok(Transfer { before: HeldOut::of(&before), after: HeldOut::of(&after), gain: before.gain(&after) })
    }
}
