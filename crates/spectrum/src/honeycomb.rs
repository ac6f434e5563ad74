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
        // Cells of unit area: spacing a with a² √3/2 = 1.
        let spacing = (2.0 / 3f64.sqrt()).sqrt();
        let height = 1.0 / spacing;
        let place = |along: f64, across: f64| match arrangement {
            Arrangement::RowsAlongX => [along, across],
            // Turned by a quarter.
            Arrangement::RowsAlongY => [-across, along],
        };
        let positions: Vec<_> = (0..columns * rows)
            .map(|cell| {
                let (column, row) = (cell % columns, cell / columns);
                let shift = 0.5 * (row % 2) as f64;
                Vector::from(place((column as f64 + shift) * spacing, row as f64 * height))
            })
            .collect();
        let lengths = place(columns as f64 * spacing, rows as f64 * height).map(f64::abs);
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
        let q = Vector::from(q);
        let mut sums = [[[0.0; 2]; 2]; 2];
        for (column, block) in jacobian.row(cell) {
            let shift = self.tessellation.domain().shortest(self.positions[column] - self.positions[cell]);
            let (sin, cos) = q.dot(&shift).sin_cos();
            for (entry, value) in block.iter().enumerate() {
                sums[0][entry / 2][entry % 2] -= value * cos;
                sums[1][entry / 2][entry % 2] -= value * sin;
            }
        }
        sums
    }
}
