//! Between data sets, whose cells come and go, and snapshots of the cells that are there.

use ndarray::{Array, Array3, ArrayD, ArrayView2, Axis, Ix2, RemoveAxis};
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Seen, Vector};

use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::{Error, SettingFault};
use crate::noise::Noise;
use crate::y_axis::YAxis;

/// Standard deviations of the positions by which circumdisks stay away from the border of a field of view.
const MARGIN: f64 = 3.0;

/// Label of a cell without one.
pub const NO_LABEL: i64 = -1;

/// The cells present in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Index of each cell on the data set's axis of cells (N).
    pub cells: Vec<usize>,
    /// Their positions (N) in the unit of length, y up.
    pub positions: Vec<Vector<f64>>,
}

impl Snapshot {
    /// The cells of a frame, below [`DataSet::frames`], of a data set.
    ///
    /// ```
    /// use ndarray::array;
    /// use voronudge_io::{Boundary, DataSet, Snapshot};
    /// let data = DataSet::new(array![[[0.0, 1.0], [f64::NAN, f64::NAN], [2.0, 3.0]]], Boundary::Open);
    /// assert_eq!(Snapshot::new(&data, 0).cells, [0, 2]);
    /// ```
    #[must_use]
    pub fn new(data: &DataSet, frame: usize) -> Self {
        let (cells, positions) = data
            .positions
            .index_axis(Axis(0), frame)
            .rows()
            .into_iter()
            .enumerate()
            .filter(|(_, r)| r[0].is_finite() && r[1].is_finite())
            .map(|(cell, r)| (cell, Vector::new(r[0], r[1])))
            .unzip();
        Self { cells, positions }
    }

    /// The error with cells numbered as in the file, where absent cells count.
    #[must_use]
    pub fn in_file_numbers(&self, error: voronudge_geometry::Error) -> voronudge_geometry::Error {
        use voronudge_geometry::Error;
        match error {
            Error::DuplicateCells { first, second, x, y } => {
                Error::DuplicateCells { first: self.cells[first], second: self.cells[second], x, y }
            }
            Error::Position { cell, x, y } => Error::Position { cell: self.cells[cell], x, y },
            other => other,
        }
    }

    /// Vectors of these cells (N) from an array over all cells (cells, 2); `None` where not finite.
    #[must_use]
    pub fn pick(&self, all: ArrayView2<'_, f64>) -> Vec<Option<Vector<f64>>> {
        self.cells
            .iter()
            .map(|&cell| Vector::new(all[(cell, 0)], all[(cell, 1)]))
            .map(|v| Some(v).filter(|v| v.x.is_finite() && v.y.is_finite()))
            .collect()
    }
}

impl DataSet {
    /// The boundary as the geometry knows it, the same in all frames.
    ///
    /// # Errors
    /// [`Error::Setting`] if the box changes ([`SettingFault::Sheared`]), or if there are walls ([`SettingFault::Walled`]).
    pub fn domain(&self) -> Result<Domain, Error> {
        if self.box_offset.is_some() {
            return Err(Error::Setting(SettingFault::Sheared));
        }
        self.domain_at(0)
    }

    /// The boundary in a frame.
    ///
    /// # Errors
    /// [`Error::Setting`] if there are walls ([`SettingFault::Walled`]) or the box is none ([`SettingFault::Box`]).
    pub fn domain_at(&self, frame: usize) -> Result<Domain, Error> {
        if let Some(walls) = self.walls {
            return Err(Error::Setting(SettingFault::Walled { walls }));
        }
        Ok(match self.boundary {
            Boundary::Periodic { lengths } => {
                let offset = self.box_offset.as_ref().and_then(|offsets| offsets.get(frame));
                let cell_box = PeriodicBox::sheared(lengths, offset.copied().unwrap_or(0.0));
                Domain::Periodic(cell_box.map_err(|fault| Error::Setting(SettingFault::Box(fault)))?)
            }
            Boundary::Open => Domain::Open,
        })
    }

    /// Where every cell would have been seen: within the declared field of view, or the hull of the cells; in the unit of length. Circumdisks
    /// stay away from its border by three standard deviations of the positions, where these are known.
    ///
    /// # Errors
    /// Those of [`SeenArea::region`](crate::SeenArea::region).
    pub fn view(&self) -> Result<FieldOfView, voronudge_geometry::Error> {
        let usual = FieldOfView::default();
        let seen = match &self.field_of_view {
            Some(area) => Seen::Within(area.region()?),
            None => Seen::Hull,
        };
        Ok(match self.position_noise {
            Some(Noise::Absolute(error)) => FieldOfView { seen, least_margin: MARGIN * error, ..usual },
            Some(Noise::Relative(share)) => {
                FieldOfView { seen, margin: usual.margin.max(MARGIN * share), ..usual }
            }
            Some(Noise::Estimated) | None => FieldOfView { seen, ..usual },
        })
    }

    /// The measured labels of the cells of one frame (N), if there are any; `None` of a cell without one (−1 in the file).
    #[must_use]
    pub fn labels_of(&self, snapshot: &Snapshot, frame: usize) -> Option<Vec<Option<i64>>> {
        let all = self.all_labels(frame)?;
        Some(snapshot.cells.iter().map(|&cell| all[cell]).collect())
    }

    /// The same of all cells of the data set (cells), absent ones too.
    #[must_use]
    pub fn all_labels(&self, frame: usize) -> Option<Vec<Option<i64>>> {
        let labels = self.labels.as_ref()?;
        let label = |cell: usize| labels.get((frame, cell)).copied().filter(|label| *label != NO_LABEL);
        Some((0..self.cells()).map(label).collect())
    }

    /// Vectors of the cells of several frames, as an array (frames, cells, 2) with y as in the files, or (cells, 2) if the
    /// data set has a single frame. NaN where a cell is absent.
    pub fn vectors_as_given<'a>(
        &self,
        frames: impl ExactSizeIterator<Item = (&'a Snapshot, &'a [Vector<f64>])>,
    ) -> ArrayD<f64> {
        let flip = self.y_sign();
        let mut array = Array3::from_elem((frames.len(), self.cells(), 2), f64::NAN);
        for (index, (snapshot, vectors)) in frames.enumerate() {
            for (&cell, v) in snapshot.cells.iter().zip(vectors) {
                array[(index, cell, 0)] = v.x;
                array[(index, cell, 1)] = flip * v.y;
            }
        }
        self.as_given(array)
    }

    /// Numbers of the cells of several frames, as an array (frames, cells), or (cells,) if the data set has a single frame.
    pub fn scalars_as_given<'a>(
        &self,
        frames: impl ExactSizeIterator<Item = (&'a Snapshot, &'a [f64])>,
    ) -> ArrayD<f64> {
        let mut array = Array3::from_elem((frames.len(), self.cells(), 1), f64::NAN);
        for (index, (snapshot, values)) in frames.enumerate() {
            for (&cell, value) in snapshot.cells.iter().zip(values) {
                array[(index, cell, 0)] = *value;
            }
        }
        let array = array.remove_axis(Axis(2));
        match array.view().into_dimensionality::<Ix2>() {
            Ok(view) if self.frames() == 1 => view.row(0).to_owned().into_dyn(),
            _ => array.into_dyn(),
        }
    }

    /// An array whose first axis counts frames; without it if the data set has a single frame.
    pub fn as_given<D: RemoveAxis>(&self, array: Array<f64, D>) -> ArrayD<f64> {
        if self.frames() == 1 { array.index_axis_move(Axis(0), 0).into_dyn() } else { array.into_dyn() }
    }

    /// What turns y up into the y of the files: 1 or −1.
    #[must_use]
    pub fn y_sign(&self) -> f64 {
        match self.y_axis {
            YAxis::Up => 1.0,
            YAxis::Down => -1.0,
        }
    }
}
