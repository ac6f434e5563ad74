//! Waves on a honeycomb from the Jacobian of the simulated model.

use crate::Error;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_model::{BlockMatrix, Model, jacobian};

/// How the rows of a honeycomb lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrangement {
    /// Rows of neighbours along x.
    RowsAlongX,
    /// Rows of neighbours along y, as in the paper.
    RowsAlongY,
}

/// A periodic honeycomb of cells of unit area, and its Jacobian.
#[derive(Debug, Clone)]
pub struct Honeycomb {
    positions: Vec<Vector<f64>>,
    lengths: [f64; 2],
    tessellation: Tessellation,
}

impl Honeycomb {
    /// A honeycomb of an even number of `rows` with `columns` cells each.
    ///
    /// # Errors
    /// [`Error::Honeycomb`] if it is so small that a cell meets itself within two rings, or `rows` is odd.
    pub fn new(columns: usize, rows: usize, arrangement: Arrangement) -> Result<Self, Error> {
        if columns < 5 || rows < 6 || rows % 2 == 1 {
            return Err(Error::Honeycomb { columns, rows });
        }
        let (mut positions, mut lengths) = voronudge_geometry::honeycomb(columns, rows);
        if arrangement == Arrangement::RowsAlongY {
            positions.iter_mut().for_each(|r| *r = Vector::new(-r.y, r.x));
            lengths.reverse();
        }
        let domain = PeriodicBox::new(lengths).map_err(Error::Tessellation)?;
        let tessellation =
            Tessellation::new(&positions, Domain::Periodic(domain)).map_err(Error::Tessellation)?;
        Ok(Self { positions, lengths, tessellation })
    }

    /// Positions of the cells (N), in ℓ_0.
    pub fn positions(&self) -> &[Vector<f64>] {
        &self.positions
    }

    /// The periodic box.
    pub fn lengths(&self) -> [f64; 2] {
        self.lengths
    }

    /// The tessellation.
    pub fn tessellation(&self) -> &Tessellation {
        &self.tessellation
    }

    /// The Jacobian of a model.
    pub fn jacobian(&self, model: &Model<f64>) -> BlockMatrix {
        jacobian(&self.tessellation, &self.positions, model)
    }

    /// Real and imaginary part of `D(q) = −Σ_j J_{0j} exp(i q·(r_j − r_0))`, exact for any wave vector `q` (1/ℓ_0), since no
    /// cell reaches halfway around the box. `jacobian` is that of [`Honeycomb::jacobian`], `cell` any cell.
    pub fn dynamical_matrix(&self, jacobian: &BlockMatrix, cell: usize, q: [f64; 2]) -> [[[f64; 2]; 2]; 2] {
        bloch_matrix(&self.tessellation, &self.positions, jacobian, cell, q)
    }
}

/// Real and imaginary part of `−Σ_j J_ij exp(i q·(r_j − r_i))` for cell i of a lattice, by the nearest images. That is D(q) for
/// any wave vector `q` (1/length) where no cell acts halfway around the box.
pub fn bloch_matrix(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    jacobian: &BlockMatrix,
    cell: usize,
    q: [f64; 2],
) -> [[[f64; 2]; 2]; 2] {
    let q = Vector::from(q);
    let mut sums = [[[0.0; 2]; 2]; 2];
    for (column, block) in jacobian.row(cell) {
        let shift = tessellation.domain().shortest(positions[column] - positions[cell]);
        let (sin, cos) = q.dot(&shift).sin_cos();
        for (entry, value) in block.iter().enumerate() {
            sums[0][entry / 2][entry % 2] -= value * cos;
            sums[1][entry / 2][entry % 2] -= value * sin;
        }
    }
    sums
}
