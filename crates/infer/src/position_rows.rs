//! Measured positions as data of a fit: where cells are against where they were seen.
//!
//! ```text
//! √m_i (y_i − r_i),      m_i = (σ_r / σ_i)²
//! ```
//!
//! σ_r is the error that the noise levels speak of, σ_i that of the cell. A cell that was not seen has m_i = 0 and no row.

use crate::Observation;
use crate::rows::Rows;
use nalgebra::DMatrix;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// The rows of the measured positions of one frame.
pub(crate) struct PositionRows {
    jacobian: BlockMatrix,
    rows: Vec<(usize, Vector<f64>, DMatrix<f64>)>,
}

impl PositionRows {
    /// The rows for cells displaced by nudges, for p free coefficients.
    pub fn new(frame: &Observation, nudges: &[f64], p: usize) -> Self {
        let stiffness = (0..frame.positions.len()).map(|cell| frame.stiffness(cell));
        Self::of_sites(stiffness, nudges, p)
    }

    /// The same for any places with their stiffness m, whose displacements from where they were seen are the nudges.
    pub fn of_sites(stiffness: impl Iterator<Item = f64>, nudges: &[f64], p: usize) -> Self {
        let mut jacobian = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
        let mut rows = Vec::new();
        for (place, (m, e)) in stiffness.zip(nudges.chunks_exact(2)).enumerate() {
            if m > 0.0 {
                let root = m.sqrt();
                rows.push((place, Vector::new(-root * e[0], -root * e[1]), DMatrix::zeros(2, p)));
                jacobian.column.push(place as u32);
                jacobian.block.push([root, 0.0, 0.0, root]);
            }
            jacobian.row_start.push(jacobian.column.len());
        }
        Self { jacobian, rows }
    }

    pub fn rows(&self) -> Rows<'_> {
        Rows { jacobian: &self.jacobian, rows: &self.rows }
    }
}
