//! Who was born when, from whom, and died when.

use serde::{Deserialize, Serialize};

/// How a cell came to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// There from the beginning.
    Founder,
    /// Injected on a vertex.
    Vertex,
    /// Injected beside its mother, or one of two daughters.
    Division,
}

/// The life of one cell.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Life {
    /// How it came to be.
    pub origin: Origin,
    /// When it was born; of founders the beginning of the run.
    pub born: f64,
    /// When it was extruded, if it was.
    pub extruded: Option<f64>,
    /// When it divided in two, if it did; its daughters are lives of their own.
    pub divided: Option<f64>,
    /// The mother's place in the list of lives, if there is one: a cell that takes the place of an extruded one on a vertex has none.
    pub mother: Option<usize>,
}

impl Life {
    /// The beginning of a life.
    pub(super) fn begun(origin: Origin, born: f64, mother: Option<usize>) -> Self {
        Self { origin, born, extruded: None, divided: None, mother }
    }

    /// Whether it goes on.
    pub fn goes_on(&self) -> bool {
        self.extruded.is_none() && self.divided.is_none()
    }
}
