//! Which effects can be tested on the data.

use super::search::Search;
use crate::{Drives, Observation, Velocities};
use voronudge_model::effect::Kind;
use voronudge_model::{CellParameter, Column, Effect};

/// Frames below which nothing goes on.
const FEWEST_FRAMES: usize = 3;

/// Cells of all frames above which it is not looked for what single ones have of their own.
const MOST_CELLS: usize = 1200;

/// Why an effect of the measurement is no candidate.
const OF_MEASUREMENT: &str = "it belongs to the measurement, and was determined with it before the search";

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

    /// Whether it is of the polarity of cells, which has no columns.
    pub fn is_of_polarity(&self) -> bool {
        self.effect.is_of_polarity()
    }

    /// Whether it is about what turns polarities.
    pub fn turns_polarity(&self) -> bool {
        self.effect.turns_polarity()
    }

    /// What drives polarities, if it says that something does.
    pub fn drives(&self) -> Drives {
        let is = |id: &str| self.effect.id == id;
        Drives { contact_inhibition: is("contact_inhibition"), velocity_alignment: is("velocity_alignment") }
    }

    /// Whether it is that polarities turn towards those of the neighbours.
    pub fn is_alignment(&self) -> bool {
        self.effect.id == "polarity_alignment"
    }

    /// Whether it is the polarity of cells itself.
    pub fn is_polarity(&self) -> bool {
        self.is_of_polarity() && !self.turns_polarity()
    }

    /// The parameter in which cells differ, if that is what it says. It has no columns.
    pub fn differing(&self) -> Option<CellParameter> {
        self.effect.differing_parameter()
    }

    /// Whether it is the measurement that does it.
    pub fn is_of_measurement(&self) -> bool {
        self.effect.kind == Kind::Observation
    }

    /// Whether it may be named as what is missing.
    pub fn is_named(&self) -> bool {
        self.effect.kind != Kind::Description
    }
}

/// The candidates with the columns that all frames share. An effect that some frames know nothing of, such as one with a
/// memory in the first frame, is zero there. What was determined with the measurement is no question any more.
pub(super) fn candidates(frames: &[Observation], search: &Search) -> Vec<Candidate> {
    let mut all = offered(frames, &search.candidates);
    for own in all.iter_mut().filter(|own| search.determined.contains(&own.effect.id)) {
        own.columns = Err(OF_MEASUREMENT);
    }
    let of_cells = of_cells(frames);
    for own in all.iter_mut().filter(|own| own.differing().is_some()) {
        own.columns = of_cells.map(|()| Vec::new());
    }
    all
}

/// Whether cells can have parameters of their own.
fn of_cells(frames: &[Observation]) -> Result<(), &'static str> {
    match frames.iter().map(|frame| frame.positions.len()).sum::<usize>() {
        _ if frames.iter().any(|frame| matches!(frame.velocities, Velocities::OnGrid(_))) => {
            Err("velocities on a grid are not those of single cells")
        }
        0..=MOST_CELLS => Ok(()),
        _ => Err("it is looked for among 1200 cells of all frames at most; infer --vary takes more"),
    }
}

/// The same for effects whatever is known.
pub(super) fn offered(frames: &[Observation], effects: &[&'static Effect]) -> Vec<Candidate> {
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

/// The same for tracks, which are followed from frame to frame: a polarity is an unknown state of each cell, what a velocity may be is no
/// question, and what would need the velocities of all cells at once is not followed.
pub(super) fn candidates_of_tracks(frames: &[Observation], effects: &[&'static Effect]) -> Vec<Candidate> {
    let mut all = offered(frames, effects);
    let goes_on = |own: &Candidate| own.is_of_polarity() || own.effect.is_random_motion();
    for own in &mut all {
        own.columns = match own.effect.id {
            _ if goes_on(own) && frames.len() < FEWEST_FRAMES => {
                Err("it shows in how cells go on, which takes three frames or more")
            }
            _ if goes_on(own) => Ok(Vec::new()),
            _ if own.differing().is_some() => Err(
                "it is told from velocities of cells: --difference central, and infer --vary, ask of these",
            ),
            "persistence" => Err("with tracks, what persists is the polarity of the cells: see there"),
            "alignment" => {
                Err("with tracks, what aligns are the polarities of the cells: see polarity_alignment")
            }
            "time_lag" => Err("cells are followed from frame to frame: there is no lag"),
            "flow_gain" | "flow_blur" => Err("there is no flow field"),
            "centroid_bias" => Err(OF_MEASUREMENT),
            _ if !own.is_linear() => {
                Err("it is not followed from frame to frame; --difference central asks of velocities")
            }
            _ => continue,
        };
    }
    all
}
