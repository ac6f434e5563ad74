//! From tracks to displacements.

use crate::failure::Failure;
use std::path::Path;
use voronudge_geometry::{PeriodicBox, Vector};
use voronudge_infer::phase_diffusion::Pattern;
use voronudge_io::{Boundary, DataSet, read_vectors};

/// The displacements of the cells that are there in all frames.
pub(super) struct TrackedPattern {
    /// Index of each cell on the data set's axis of cells.
    pub cells: Vec<usize>,
    pub pattern: Pattern,
}

impl TrackedPattern {
    /// Displacements from given places, or from the mean place of each cell.
    ///
    /// In a periodic box each step between frames, and that from the place given, is taken as the shortest among the images.
    pub fn new(data: &DataSet, frames: &[usize], reference: Option<&Path>) -> Result<Self, Failure> {
        let Boundary::Periodic { lengths } = data.boundary else {
            return Err(Failure::new("the field of view is open, but waves are those of a periodic box").with_hint(
                "if the pattern repeats, give its --box; of an open field of view take the largest piece that nearly does",
            ));
        };
        let domain = PeriodicBox::new(lengths)?;
        let at = |frame: usize, cell: usize| {
            Vector::new(data.positions[(frame, cell, 0)], data.positions[(frame, cell, 1)])
        };
        let is_there = |cell: &usize| frames.iter().all(|&frame| at(frame, *cell).x.is_finite());
        let given = reference.map(|path| places(data, path)).transpose()?;
        let cells: Vec<usize> = (0..data.cells())
            .filter(is_there)
            .filter(|&cell| given.as_ref().is_none_or(|given| given[cell].x.is_finite()))
            .collect();
        if cells.is_empty() {
            return Err(Failure::new(format!("no cell is present in all {} frames", frames.len()))
                .with_hint("cells must be tracked; choose frames in which they are, by --frames"));
        }
        let mut displacements = vec![vec![Vector::zeros(); cells.len()]; frames.len()];
        let mut rest = Vec::with_capacity(cells.len());
        for (index, &cell) in cells.iter().enumerate() {
            let first = frames.first().map_or_else(Vector::zeros, |&frame| at(frame, cell));
            let mut path = Vec::with_capacity(frames.len());
            let mut r = first;
            for (k, &frame) in frames.iter().enumerate() {
                let step = at(frame, cell) - if k == 0 { first } else { at(frames[k - 1], cell) };
                r += if data.unwrapped { step } else { domain.shortest(step) };
                path.push(r);
            }
            let place = match &given {
                Some(given) => first - domain.shortest(first - given[cell]),
                None => path.iter().sum::<Vector<f64>>() / path.len().max(1) as f64,
            };
            for (frame, r) in path.iter().enumerate() {
                displacements[frame][index] = r - place;
            }
            rest.push(place);
        }
        let times = frames.iter().map(|&frame| frame as f64 * data.frame_interval).collect();
        Ok(Self { cells, pattern: Pattern { domain, reference: rest, displacements, times } })
    }
}

/// The places of a file, one for each cell, y up.
fn places(data: &DataSet, path: &Path) -> Result<Vec<Vector<f64>>, Failure> {
    let read = read_vectors(path)?;
    let (frames, cells, _) = read.dim();
    if frames != 1 || cells != data.cells() {
        return Err(Failure::new(format!(
            "{}: has {frames} frames of {cells} places, but the data set has {} cells",
            path.display(),
            data.cells()
        ))
        .with_hint("give one place for each entry of the axis of cells, NaN where it is not known"));
    }
    let up = data.y_sign();
    Ok((0..cells).map(|cell| Vector::new(read[(0, cell, 0)], up * read[(0, cell, 1)])).collect())
}
