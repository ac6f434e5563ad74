//! Between data sets, whose cells come and go, and snapshots of the cells that are there.

use crate::failure::Failure;
use ndarray::{Array, Array3, ArrayD, ArrayView2, Axis, Ix2, RemoveAxis};
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Seen, Vector};
use voronudge_io::{Boundary, DataSet, Noise, YAxis};

/// The boundary as the geometry knows it, for what does not know of boxes that change.
pub(crate) fn domain(data: &DataSet) -> Result<Domain, Failure> {
    if data.box_offset.is_some() {
        return Err(Failure::new(
            "the periodic box of these data is sheared, which this command does not know of",
        )
        .with_hint("evaluate, spectrum and simulate --start do"));
    }
    domain_at(data, 0)
}

/// The boundary of a frame.
pub(crate) fn domain_at(data: &DataSet, frame: usize) -> Result<Domain, Failure> {
    if let Some(walls) = data.walls {
        return Err(Failure::new(format!(
            "the cells of these data are between walls (\"{walls}\"), which this command does not know of"
        ))
        .with_hint(
            "only simulate and channel do; without the line walls the box would be periodic, which is another tissue",
        ));
    }
    Ok(match data.boundary {
        Boundary::Periodic { lengths } => {
            let offset = data.box_offset.as_ref().and_then(|offsets| offsets.get(frame));
            Domain::Periodic(PeriodicBox::sheared(lengths, offset.copied().unwrap_or(0.0))?)
        }
        Boundary::Open => Domain::Open,
    })
}

/// Standard deviations of the positions by which circumdisks stay away from the border of a field of view.
const MARGIN: f64 = 3.0;

/// Where every cell would have been seen, in the unit of the data.
pub(crate) fn field_of_view(data: &DataSet) -> Result<FieldOfView, Failure> {
    let usual = FieldOfView::default();
    let seen = match &data.field_of_view {
        Some(area) => Seen::Within(area.region()?),
        None => Seen::Hull,
    };
    Ok(match data.position_noise {
        Some(Noise::Absolute(error)) => FieldOfView { seen, least_margin: MARGIN * error, ..usual },
        Some(Noise::Relative(share)) => {
            FieldOfView { seen, margin: usual.margin.max(MARGIN * share), ..usual }
        }
        None => FieldOfView { seen, ..usual },
    })
}

/// The cells present in one frame.
#[derive(Clone)]
pub(crate) struct Snapshot {
    /// Index of each cell on the data set's axis of cells.
    pub cells: Vec<usize>,
    pub positions: Vec<Vector<f64>>,
}

impl Snapshot {
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

    /// Vectors of these cells from an array over all cells; `None` where not finite.
    pub fn pick(&self, all: ArrayView2<'_, f64>) -> Vec<Option<Vector<f64>>> {
        self.cells
            .iter()
            .map(|&cell| Vector::new(all[(cell, 0)], all[(cell, 1)]))
            .map(|v| Some(v).filter(|v| v.x.is_finite() && v.y.is_finite()))
            .collect()
    }
}

/// Label of a cell without one.
const NO_LABEL: i64 = -1;

/// The measured labels of the cells of one frame, if there are any.
pub(crate) fn labels(data: &DataSet, snapshot: &Snapshot, frame: usize) -> Option<Vec<Option<i64>>> {
    let labels = data.labels.as_ref()?;
    let label = |cell: &usize| labels.get((frame, *cell)).copied().filter(|label| *label != NO_LABEL);
    Some(snapshot.cells.iter().map(label).collect())
}

/// Vectors of the cells of several frames, as an array (frames, cells, 2) with y as in the files, or (cells, 2) if the
/// data set has a single frame. NaN where a cell is absent.
pub(crate) fn to_array<'a>(
    data: &DataSet,
    frames: impl ExactSizeIterator<Item = (&'a Snapshot, &'a [Vector<f64>])>,
) -> ArrayD<f64> {
    let flip = y_sign(data);
    let mut array = Array3::from_elem((frames.len(), data.cells(), 2), f64::NAN);
    for (index, (snapshot, vectors)) in frames.enumerate() {
        for (&cell, v) in snapshot.cells.iter().zip(vectors) {
            array[(index, cell, 0)] = v.x;
            array[(index, cell, 1)] = flip * v.y;
        }
    }
    as_given(data, array)
}

/// What turns y up into the y of the files.
pub(crate) fn y_sign(data: &DataSet) -> f64 {
    match data.y_axis {
        YAxis::Up => 1.0,
        YAxis::Down => -1.0,
    }
}

/// Numbers of the cells of several frames, as an array (frames, cells), or (cells,) if the data set has a single frame.
pub(crate) fn to_scalars<'a>(
    data: &DataSet,
    frames: impl ExactSizeIterator<Item = (&'a Snapshot, &'a [f64])>,
) -> ArrayD<f64> {
    let mut array = Array3::from_elem((frames.len(), data.cells(), 1), f64::NAN);
    for (index, (snapshot, values)) in frames.enumerate() {
        for (&cell, value) in snapshot.cells.iter().zip(values) {
            array[(index, cell, 0)] = *value;
        }
    }
    let array = array.remove_axis(Axis(2));
    match array.view().into_dimensionality::<Ix2>() {
        Ok(view) if data.frames() == 1 => view.row(0).to_owned().into_dyn(),
        _ => array.into_dyn(),
    }
}

/// An array whose first axis counts frames; without it if the data set has a single frame.
pub(crate) fn as_given<D: RemoveAxis>(data: &DataSet, array: Array<f64, D>) -> ArrayD<f64> {
    if data.frames() == 1 { array.index_axis_move(Axis(0), 0).into_dyn() } else { array.into_dyn() }
}
