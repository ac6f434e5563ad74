//! Where a search ended.

use crate::Status;

/// The best point found, and the way to it.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub parameters: Vec<f64>,
    pub value: f64,
    pub status: Status,
    pub steps: u64,
    /// Φ after each step of the continuation and after each round of transitions of the best start.
    pub trace: Vec<f64>,
    pub transitions_tried: usize,
    pub transitions_made: usize,
    /// Φ at the end of each start.
    pub starts: Vec<f64>,
}

impl Found {
    /// The end of one way from one start, no transitions tried.
    pub(super) fn by(parameters: Vec<f64>, value: f64, status: Status, steps: u64, trace: Vec<f64>) -> Self {
        Self {
            starts: vec![value],
            parameters,
            value,
            status,
            steps,
            trace,
            transitions_tried: 0,
            transitions_made: 0,
        }
    }
}
