//! Repair by flips, with a proof of what comes out.

use super::lawson::Lawson;
use super::scan::{Finding, scan};
use super::splice::Spare;
use crate::{Tessellation, Vector};

/// The work space of repairs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Repair {
    lawson: Lawson,
    spare: Spare,
}

impl Repair {
    /// Makes a tessellation that of the positions by flips, and counts them. If that fails it stays as it was.
    pub fn attempt(&mut self, tessellation: &mut Tessellation, positions: &[Vector<f64>]) -> Option<usize> {
        let Finding::Suspects(suspects) = scan(tessellation, positions) else {
            return None;
        };
        if suspects.iter().all(Vec::is_empty) {
            return Some(0);
        }
        let flips = self.lawson.settle(tessellation, positions, &suspects).ok()?;
        self.spare.splice(tessellation, &self.lawson);
        Some(flips)
    }
}
