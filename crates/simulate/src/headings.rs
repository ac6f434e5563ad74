//! The polarities of cells that propel themselves.

use voronudge_geometry::{Scalar, Vector};

/// Polarities of cells, `p = v₀ s (cos θ, sin θ)`.
#[derive(Debug, Clone)]
pub(crate) struct Headings<S: Scalar> {
    /// θ (N, radians); empty if nothing propels itself.
    pub angles: Vec<S>,
    /// s (N); empty if it is one.
    pub speeds: Vec<S>,
}

impl<S: Scalar> Default for Headings<S> {
    fn default() -> Self {
        Self { angles: Vec::new(), speeds: Vec::new() }
    }
}

impl<S: Scalar> Headings<S> {
    /// The polarity of a cell over v₀.
    pub fn of(&self, cell: usize) -> Vector<S> {
        let angle = self.angles.get(cell).copied().unwrap_or(S::constant(0.0));
        Vector::new(angle.cos(), angle.sin()) * self.speeds.get(cell).copied().unwrap_or(S::constant(1.0))
    }

    /// Puts polarities over v₀ in place of those that are there.
    pub fn set(&mut self, polarities: Vec<Vector<S>>) {
        self.angles = polarities.iter().map(|p| p.y.atan2(p.x)).collect();
        self.speeds = polarities.iter().map(|p| (p.x * p.x + p.y * p.y).sqrt()).collect();
    }
}
