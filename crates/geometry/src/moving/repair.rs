//! Repair by flips, with a proof of what comes out.

use super::lawson::Lawson;
use super::scan::Scan;
use super::splice::Splice;
use crate::{Tessellation, Vector};

/// The work space of repairs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Repair {
    lawson: Lawson,
    splice: Splice,
}

impl Repair {
    /// Makes a tessellation that of the positions by flips, and counts them. If that fails it stays as it was.
    pub fn attempt(&mut self, tessellation: &mut Tessellation, positions: &[Vector<f64>]) -> Option<usize> {
        let scan = Scan::new(tessellation, positions)?;
        let flips = self.lawson.settle(&scan).ok()?;
        if flips > 0 {
            self.splice.splice(tessellation, &self.lawson);
        }
        Some(flips)
    }
}
