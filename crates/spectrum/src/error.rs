use thiserror::Error;

/// Why there is no spectrum.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// Too many cells for all eigenvalues.
    #[error("all modes of {cells} cells are more than the {limit} cells a dense matrix is meant for")]
    TooManyCells {
        /// Cells that may move.
        cells: usize,
        /// The limit.
        limit: usize,
    },
    /// No cell may move.
    #[error("no cell counts, so there are no modes")]
    NoCells,
    /// No modes were asked for.
    #[error("0 modes were asked for, but at least 1 is needed")]
    NoModes,
    /// A shift that is not finite.
    #[error("the shift {real} + {imaginary} i is not finite")]
    Shift {
        /// Real part.
        real: f64,
        /// Imaginary part.
        imaginary: f64,
    },
    /// A band of frequencies that is empty or not finite.
    #[error("the band of frequencies from {low} to {high} is not one: 0 ≤ low < high is needed")]
    Band {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// The Jacobian has an entry that is not finite.
    #[error("the Jacobian is not finite at cell {cell}")]
    NotFinite {
        /// The cell.
        cell: usize,
    },
    /// Fewer cells than the lattice needs so that second neighbours are distinct.
    #[error(
        "a honeycomb of {columns} × {rows} cells, but at least 5 × 6 and an even number of rows are needed"
    )]
    Honeycomb {
        /// Cells in a row.
        columns: usize,
        /// Rows.
        rows: usize,
    },
    /// Fewer rows that move than a strip needs.
    #[error("a strip of {rows} rows that move, but at least {least} are needed")]
    FewRows {
        /// Rows that move.
        rows: usize,
        /// The least.
        least: usize,
    },
    /// A row whose cells are no lattice along y.
    #[error("the cells of row {row} do not lie on a line along the strip at equal distances")]
    CrookedRow {
        /// The row that moves, from the left.
        row: usize,
    },
    /// The lattice could not be tessellated.
    #[error("the honeycomb: {0}")]
    Tessellation(voronudge_geometry::Error),
    /// What the linear algebra said.
    #[error("{0}")]
    LinearAlgebra(voronudge_linalg::Error),
}

impl Error {
    /// Advice on what to change, if there is any.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::TooManyCells { .. } => {
                "ask for some modes: --largest 8 for those that grow fastest, --near RE IM for those near a point, --band LOW \
                 HIGH for a band of frequencies; or raise --dense-limit if there is time and memory"
            }
            Self::NoCells => {
                "in an open field only cells count whose polygon and whose neighbours' polygons are closed"
            }
            Self::NoModes => "ask for one mode or more",
            Self::Shift { .. } | Self::Band { .. } => {
                "give rates in 1/time of the data; frequencies are angular"
            }
            Self::NotFinite { .. } => "two vertices may lie at one point there, or a parameter is too large",
            Self::FewRows { .. } => "give more rows; a row at each end is held with --ends held",
            Self::CrookedRow { .. } => "the tissue gives way at these parameters; lower P_0 or the chirality",
            Self::Honeycomb { .. } | Self::Tessellation(_) => "use the default lattice",
            Self::LinearAlgebra(voronudge_linalg::Error::OutOfMemory { .. }) => {
                "ask for fewer modes, or for --largest, whose real shift needs half the memory of --near"
            }
            Self::LinearAlgebra(_) => "ask for other modes: another shift, or more of them",
        })
    }
}

impl From<voronudge_linalg::Error> for Error {
    fn from(error: voronudge_linalg::Error) -> Self {
        Self::LinearAlgebra(error)
    }
}
