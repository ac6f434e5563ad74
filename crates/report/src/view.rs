//! What the figures draw: cells of a frame as plain numbers.
//!
//! Lengths, velocities and areas are in the units of [`Units`](crate::Units); the y axis points up, as in the
//! model, so a figure shows image data the way the microscope did.

/// Whether a cell took part in the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellStatus {
    /// The cell's velocity was fitted.
    Used,
    /// The cell was left out (no velocity, held, not compared, …).
    LeftOut,
    /// The cell was not detected: the fit put it there.
    NotDetected,
    /// The cell was left out because its polygon or that of a neighbour could be another one, had all cells been seen.
    Uncertain,
}

/// One cell of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct CellView {
    /// Number of the cell in the data; `None` of one that is not among them.
    pub number: Option<usize>,
    /// Position of the cell centre.
    pub centre: [f64; 2],
    /// Voronoi vertices in order, next to the centre (not wrapped by a periodic box); empty where
    /// the polygon is not closed.
    pub polygon: Vec<[f64; 2]>,
    /// Area of the polygon.
    pub area: f64,
    /// Perimeter of the polygon.
    pub perimeter: f64,
    /// Whether the cell took part in the fit.
    pub status: CellStatus,
    /// Measured velocity.
    pub measured: Option<[f64; 2]>,
    /// Vorticity of the measured velocities around the cell, in 1/time.
    pub vorticity: Option<f64>,
    /// Velocity that the fitted model gives.
    pub predicted: Option<[f64; 2]>,
    /// Polarity: the velocity that the cell has of itself, where cells crawl.
    pub polarity: Option<[f64; 2]>,
    /// Velocity that fits predict which did not see it.
    pub held_out: Option<[f64; 2]>,
    /// Displacement of the centre in the fit (nudged minus measured position).
    pub nudge: [f64; 2],
}

impl CellView {
    /// Measured minus predicted velocity, where both are known and finite.
    #[must_use]
    pub fn residual(&self) -> Option<[f64; 2]> {
        residual(self.measured?, self.predicted?)
    }

    /// Shape index P/√A.
    #[must_use]
    pub fn shape_index(&self) -> f64 {
        self.perimeter / self.area.sqrt()
    }

    /// Whether the cell took part in the fit.
    #[must_use]
    pub fn is_used(&self) -> bool {
        self.status == CellStatus::Used
    }
}

/// A line segment, for example one Delaunay edge.
pub type Segment = [[f64; 2]; 2];

/// Neighbour contacts that the nudges changed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChangedEdges {
    /// Contacts of the measured positions that the nudged positions do not have.
    pub lost: Vec<Segment>,
    /// Contacts of the nudged positions that the measured positions do not have.
    pub gained: Vec<Segment>,
}

/// One frame of a data set with what the fit made of it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameView {
    /// Name of the frame in headings, for example `frame 6`.
    pub label: String,
    /// Its time, if it is one of a movie.
    pub time: Option<f64>,
    /// Its cells.
    pub cells: Vec<CellView>,
    /// Contacts changed by the nudges.
    pub changed_edges: ChangedEdges,
    /// Lower left and upper right corner of the periodic box, outlined where given.
    pub outline: Option<[[f64; 2]; 2]>,
    /// Closed lines around the field of view, outlined where given.
    pub region: Vec<Vec<[f64; 2]>>,
}

impl FrameView {
    /// Typical distance between cells: the median of √area, over the used cells if there are any.
    /// `None` for a frame without a finite area.
    #[must_use]
    pub fn spacing(&self) -> Option<f64> {
        let roots = |all: bool| {
            let cells = self.cells.iter().filter(move |cell| all || cell.is_used());
            crate::numbers::quantile(cells.map(|cell| cell.area.sqrt()), 0.5)
        };
        roots(false).or_else(|| roots(true)).filter(|&spacing| spacing > 0.0)
    }

    /// Mean area of the used cells; not finite where there is none.
    #[must_use]
    pub fn mean_area(&self) -> f64 {
        let used = self.cells.iter().filter(|cell| cell.is_used() && cell.area.is_finite());
        let (sum, count) = used.fold((0.0, 0.0), |(sum, count), cell| (sum + cell.area, count + 1.0));
        sum / count
    }

    /// Number of cells of a status.
    #[must_use]
    pub fn count(&self, status: CellStatus) -> usize {
        self.cells.iter().filter(|cell| cell.status == status).count()
    }

    /// The cells that were not detected.
    pub fn not_detected(&self) -> impl Iterator<Item = &CellView> {
        self.cells.iter().filter(|cell| cell.status == CellStatus::NotDetected)
    }
}

/// Measured minus predicted, where it is finite.
#[must_use]
pub(crate) fn residual(measured: [f64; 2], predicted: [f64; 2]) -> Option<[f64; 2]> {
    let residual = [measured[0] - predicted[0], measured[1] - predicted[1]];
    is_finite(residual).then_some(residual)
}

/// Whether both components are finite.
#[must_use]
pub(crate) fn is_finite(vector: [f64; 2]) -> bool {
    vector[0].is_finite() && vector[1].is_finite()
}

/// Length of a vector.
#[must_use]
pub(crate) fn length(vector: [f64; 2]) -> f64 {
    vector[0].hypot(vector[1])
}
