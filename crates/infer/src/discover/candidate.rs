//! Which effects can be tested on the data.

use crate::Observation;
use voronudge_model::effect::Kind;
use voronudge_model::{Column, Effect};

/// An effect on offer.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub effect: &'static Effect,
    /// Its columns, or why it cannot be tested.
    pub columns: Result<Vec<Column>, &'static str>,
}

impl Candidate {
    /// Whether its columns are there whatever the coefficients are.
    pub fn is_linear(&self) -> bool {
        self.columns.iter().flatten().all(|column| matches!(column, Column::Term(_)))
    }

    /// Whether it may be named as what is missing.
    pub fn is_named(&self) -> bool {
        self.effect.kind != Kind::Description
    }
}

/// The candidates with the columns that all frames share. An effect that some frames know nothing of, such as one with a
/// memory in the first frame, is zero there.
pub(super) fn candidates(frames: &[Observation], effects: &[&'static Effect]) -> Vec<Candidate> {
    let of = |effect: &&'static Effect| {
        let mut shared: Result<Vec<Column>, &'static str> = Err("there is no frame");
        for (index, frame) in frames.iter().enumerate() {
            let own = effect.columns(frame.environment(), frame.tessellation.domain());
            shared = match (shared, own) {
                (Ok(columns), Ok(own)) if columns != own => {
                    return Candidate { effect, columns: Err("its data differ in kind from frame to frame") };
                }
                (Err(_), Ok(own)) => Ok(own),
                (Err(_), Err(reason)) if index == 0 => Err(reason),
                (shared, _) => shared,
            };
        }
        Candidate { effect, columns: shared }
    };
    effects.iter().map(of).collect()
}
