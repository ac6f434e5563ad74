//! The sparse Jacobian ∂v/∂r.

use crate::response::respond_jacobian;
use crate::{BlockMatrix, JacobianBuilder, Model};
use voronudge_geometry::{Tessellation, Vector};

/// `J_{ij} = ∂v_i/∂r_j` at frozen topology, exact to rounding.
///
/// Each element is differentiated on its own, in coordinates relative to its cell; for shape terms the row and column of
/// the cell itself follow from the balance of forces and from translation. In an open field of view the rows of cells
/// without a velocity are empty. For one Jacobian after another see [`JacobianBuilder`].
///
/// Terms reach two rings. Responses reach further, and some of them leave something out, as their
/// [`exactness`](crate::FlowResponse::exactness) tells: of `time_lag` and `centroid_bias` the part with the second
/// derivative of the terms, of `internal_drag` the entries of the inverse below 1e-7 of the largest in a row. Everything
/// else is exact.
pub fn jacobian(tessellation: &Tessellation, positions: &[Vector<f64>], model: &Model<f64>) -> BlockMatrix {
    let mut matrix = BlockMatrix::default();
    JacobianBuilder::default().build(tessellation, positions, model, &mut matrix);
    matrix
}

impl JacobianBuilder {
    /// As [`jacobian`], into an existing matrix.
    pub fn build(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        model: &Model<f64>,
        matrix: &mut BlockMatrix,
    ) {
        self.build_terms(tessellation, positions, model, matrix);
        if !model.responses.is_empty() {
            *matrix = respond_jacobian(tessellation, positions, model, std::mem::take(matrix));
        }
    }
}
