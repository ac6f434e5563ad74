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
    /// Injected beside its mother.
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
    /// The mother's place in the list of lives, if there is one: a cell that takes the place of an extruded one on a vertex has none.
    pub mother: Option<usize>,
}
