//! The rows of tables, in any order, put on a rectangular grid.

use std::path::{Path, PathBuf};

use ndarray::Array4;

use crate::error::{Error, GridFault, TableFault};
use crate::flow::{FlowField, grid_error};
use crate::memory::SIZE_LIMIT;
use crate::table::{Vector, VectorTable};
use crate::tracks::frame_span;

/// How far a row may be from its grid point, in spacings: what the digits of a printed
/// coordinate may leave.
const TOLERANCE: f64 = 0.05;

/// The grid has at most this many times more points than there are rows for.
const SPARSENESS: usize = 10;

/// A grid in the units and directions of the tables.
pub(super) struct Arranged {
    pub(super) flow: FlowField,
    /// The tables' number of the first frame; 0 where they do not number frames.
    pub(super) first_frame: i64,
}

/// Puts all rows on one grid: of one table by its frames, of several with one frame each.
pub(super) fn arrange(tables: &[(PathBuf, VectorTable)]) -> Result<Arranged, Error> {
    let (first_frame, frames) = frames_of(tables)?;
    let rows = || tables.iter().flat_map(|(_, table)| &table.vectors);
    let place = tables.first().map_or(Path::new(""), |(path, _)| path);
    let fit = |axis, values| Nodes::fit(axis, values).map_err(|fault| grid_error(place, fault));
    let x = fit('x', rows().map(|row| row.x).collect())?;
    let y = fit('y', rows().map(|row| row.y).collect())?;

    let placed: Vec<(usize, &Path, &Vector, [usize; 2])> = tables
        .iter()
        .enumerate()
        .flat_map(|(file, (path, table))| table.vectors.iter().map(move |row| (file, path, row)))
        .map(|(file, path, row)| {
            let failure = |fault| table_error(path, row, fault);
            let frame = if tables.len() == 1 { row.frame.abs_diff(first_frame) as usize } else { file };
            let node = [y.index('y', row.y).map_err(failure)?, x.index('x', row.x).map_err(failure)?];
            Ok((frame, path.as_path(), row, node))
        })
        .collect::<Result<_, Error>>()?;
    check_size(place, frames, &x, &y, placed.len())?;

    let mut velocities = Array4::from_elem((frames, y.count, x.count, 2), f64::NAN);
    let mut taken = vec![false; frames * y.count * x.count];
    for (frame, path, row, [j, i]) in placed {
        if std::mem::replace(&mut taken[(frame * y.count + j) * x.count + i], true) {
            return Err(table_error(
                path,
                row,
                TableFault::NodeTwice { x: row.x, y: row.y, frame: row.frame },
            ));
        }
        velocities[[frame, j, i, 0]] = row.displacement[0];
        velocities[[frame, j, i, 1]] = row.displacement[1];
    }
    Ok(Arranged { flow: FlowField { velocities, x: x.coordinates(), y: y.coordinates() }, first_frame })
}

/// The number of the first frame and how many there are.
fn frames_of(tables: &[(PathBuf, VectorTable)]) -> Result<(i64, usize), Error> {
    let spans: Vec<(i64, usize)> = tables
        .iter()
        .map(|(path, table)| {
            let span = frame_span(table.vectors.iter().map(|row| row.frame));
            span.map_err(|fault| Error::Table { path: path.clone(), line: None, fault })
        })
        .collect::<Result<_, _>>()?;
    if let [span] = spans.as_slice() {
        return Ok(*span);
    }
    for ((path, _), (_, frames)) in tables.iter().zip(&spans) {
        if *frames > 1 {
            return Err(grid_error(path, GridFault::SeveralFrames { frames: *frames }));
        }
    }
    Ok((0, spans.len()))
}

fn check_size(path: &Path, frames: usize, x: &Nodes, y: &Nodes, rows: usize) -> Result<(), Error> {
    let points = (x.count as u64).saturating_mul(y.count as u64).saturating_mul(frames as u64);
    let limit = (rows as u64).saturating_mul(SPARSENESS as u64);
    // Frames in between may be empty, so the rows are held against one grid at least.
    let grid = (x.count as u64).saturating_mul(y.count as u64);
    let fault = if grid > limit {
        GridFault::Sparse { rows, points: grid }
    } else if points.saturating_mul(16) > SIZE_LIMIT {
        GridFault::TooLarge { frames, points: grid, bytes: points.saturating_mul(16), limit: SIZE_LIMIT }
    } else {
        return Ok(());
    };
    Err(grid_error(path, fault))
}

/// The grid points along one axis.
struct Nodes {
    first: f64,
    spacing: f64,
    count: usize,
}

impl Nodes {
    /// The even grid that the coordinates of all rows suggest.
    fn fit(axis: char, mut values: Vec<f64>) -> Result<Self, GridFault> {
        values.sort_unstable_by(f64::total_cmp);
        let (Some(&lowest), Some(&highest)) = (values.first(), values.last()) else {
            return Err(GridFault::TooFew { axis, found: 0 });
        };
        // Closer than the rounding of single precision, two coordinates are one computed twice.
        let same = |a: &f64, b: &f64| b - a <= f64::from(f32::EPSILON) * a.abs().max(b.abs());
        let lines: Vec<&[f64]> = values.chunk_by(same).collect();
        // A row astray makes a line of its own; it must not say where the others lie.
        let most = lines.iter().map(|line| line.len()).max().unwrap_or_default();
        let full: Vec<&[f64]> = lines.into_iter().filter(|line| 2 * line.len() >= most).collect();
        let (Some(from), Some(to)) = (full.first(), full.last()) else {
            return Err(GridFault::TooFew { axis, found: 0 });
        };
        let (from, to) = (from[0], to[0]);
        let mut gaps: Vec<(f64, usize)> =
            full.windows(2).map(|pair| (pair[1][0] - pair[0][0], pair[0].len().min(pair[1].len()))).collect();
        gaps.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let Some(median) = weighted_median(&gaps) else {
            return Err(GridFault::TooFew { axis, found: 1 });
        };
        let single = gaps.iter().map(|gap| gap.0).filter(|&gap| gap > 0.5 * median && gap < 1.5 * median);
        let (sum, steps) = single.fold((0.0, 0.0), |(sum, steps), gap| (sum + gap, steps + 1.0));
        let spacing = (to - from) / ((to - from) / (sum / steps)).round().max(1.0);
        let before = ((from - lowest) / spacing).round();
        let after = ((highest - from) / spacing).round();
        Ok(Self {
            first: from - before * spacing,
            spacing,
            count: ((before + after) as usize).saturating_add(1),
        })
    }

    fn index(&self, axis: char, value: f64) -> Result<usize, TableFault> {
        let index = ((value - self.first) / self.spacing).round();
        let astray = (value - self.first - index * self.spacing).abs();
        if astray <= TOLERANCE * self.spacing {
            return Ok(index as usize);
        }
        Err(TableFault::OffGrid { axis, value, first: self.first, spacing: self.spacing })
    }

    fn coordinates(&self) -> Vec<f64> {
        (0..self.count).map(|index| self.first + index as f64 * self.spacing).collect()
    }
}

/// The median of gaps in ascending order, each with the number of rows on both of its sides.
///
/// A column may be missing as a whole, and a row may be astray; most rows are neither.
fn weighted_median(gaps: &[(f64, usize)]) -> Option<f64> {
    let total: usize = gaps.iter().map(|gap| gap.1).sum();
    let mut passed = 0;
    gaps.iter().find_map(|&(gap, rows)| {
        passed += rows;
        (2 * passed > total).then_some(gap)
    })
}

fn table_error(path: &Path, row: &Vector, fault: TableFault) -> Error {
    Error::Table { path: path.to_path_buf(), line: (row.line > 0).then_some(row.line), fault }
}
