//! Chiral currents at an edge without torque: an estimate from one row of cells.

use crate::{MeanField, Parameters, hexagon_side};

/// A row of cells along the edge of a honeycomb whose other side exerts no chiral force on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeRow {
    /// Force on a cell along the edge, `6 K_P |α| d`: what the two missing neighbours no longer exert.
    pub force: f64,
    /// Force along the edge per displacement of the row against the bulk, `K_P (P_MF − P_0)/d`.
    pub stiffness: f64,
}

impl MeanField {
    /// What moves the row of cells at an edge, and what holds it. Derivation: `docs/mean-field.md`, "Edge currents".
    pub fn edge_row(&self) -> EdgeRow {
        let Parameters { perimeter_elasticity: k_p, chirality: alpha, .. } = self.parameters();
        let d = hexagon_side();
        EdgeRow { force: 6.0 * k_p * alpha.abs() * d, stiffness: 6.0 * k_p * self.distance_to_limit() }
    }

    /// The paper's threshold of edge currents, `|α| ≥ √3 (P_MF − P_0)/(4 P_MF)`, zero beyond the limit of stability.
    ///
    /// It is half of [`MeanField::edge_slip_chirality`]: see `docs/corrections.md`, "The threshold of edge currents".
    pub fn edge_current_threshold(&self) -> f64 {
        0.25 * 3f64.sqrt() * self.distance_to_limit().max(0.0)
    }

    /// The chirality at which the row of [`MeanField::edge_row`] slips by half a cell, `√3 d/2`, and changes its
    /// neighbours: `|α| = √3 (P_MF − P_0)/(2 P_MF)`, zero beyond the limit of stability.
    ///
    /// The argument is the paper's, with force and displacement in one frame; the result is twice the printed one. Both
    /// extrapolate the linear response to half a cell and leave the missing neighbours' own response out.
    pub fn edge_slip_chirality(&self) -> f64 {
        0.5 * 3f64.sqrt() * self.distance_to_limit().max(0.0)
    }
}
