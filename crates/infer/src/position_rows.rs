//! Measured positions as data of a fit: where cells are against where they were seen.
//!
//! ```text
//! √m_i (y_i − H_i(r)),      m_i = (σ_r / σ_i)²,      H_i(r) = r_i + c (centroid_i(r) − r_i)
//! ```
//!
//! σ_r is the error that the noise levels speak of, σ_i that of the cell. A cell that was not seen has m_i = 0 and no row. The share c
//! says what of a cell its position is: 0 for Voronoi sites, 1 for centroids. Cells whose polygon cannot be trusted are taken for
//! measured at their sites.

use crate::Observation;
use crate::free_cells::Free;
use crate::rows::Rows;
use nalgebra::DMatrix;
use voronudge_geometry::{CellPolygon, Tessellation, Vector, centroid_slopes};
use voronudge_model::BlockMatrix;

/// The rows of the measured positions of one frame.
pub(crate) struct PositionRows {
    jacobian: BlockMatrix,
    rows: Vec<(usize, Vector<f64>, DMatrix<f64>)>,
}

impl PositionRows {
    /// The rows for cells of a frame displaced by nudges to `positions`, for p free coefficients; the derivative by c is that of
    /// coefficient `of_share`, if it is one of them.
    pub fn new(
        frame: &Observation,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        nudges: &[f64],
        p: usize,
        of_share: Option<usize>,
    ) -> Self {
        let share = frame.share();
        let mut rows = Rowed::new(p);
        let mut polygon = CellPolygon::default();
        let mut pinned = Vec::new();
        for place in 0..positions.len() {
            let root = frame.stiffness(place).sqrt();
            if root > 0.0 {
                let held = frame.is_held(place);
                let polygonal = (share != 0.0 || of_share.is_some())
                    && frame.fill_polygon(&mut polygon, tessellation, positions, place);
                let mut offset = Vector::zeros();
                if polygonal {
                    offset = polygon.centroid();
                    if share != 0.0 {
                        centroid_slopes(tessellation, positions, place, |neighbour, block| {
                            let block = block.map(|slope| share * root * slope);
                            if !frame.is_held(neighbour) {
                                rows.add(neighbour, block);
                            }
                            if !held {
                                rows.add(place, block.map(|slope| -slope));
                            }
                        });
                    }
                }
                if held {
                    pinned.push(place);
                } else {
                    rows.add(place, [root, 0.0, 0.0, root]);
                }
                // A place that cannot move is a datum if one that it sees can.
                if !held || rows.is_begun() {
                    let nudge = Vector::new(nudges[2 * place], nudges[2 * place + 1]);
                    let rest = (frame.aim(place) - nudge - offset * share) * root;
                    rows.end(place, rest, of_share.map(|k| (k, offset * root)));
                    continue;
                }
            }
            rows.skip();
        }
        for place in pinned {
            rows.add(place, [1.0, 0.0, 0.0, 1.0]);
            let row = rows.jacobian.row_start.len() - 1;
            rows.end(row, Vector::zeros(), None);
        }
        Self { jacobian: rows.jacobian, rows: rows.rows }
    }

    /// Leaves out what says of held cells that they are held, and makes the columns those of free ones.
    pub fn keep(&mut self, free: &Free) {
        let places = free.count();
        self.rows.retain(|row| row.0 < places);
        free.renumber(&mut self.jacobian);
    }

    /// Those that depend on free cells, with columns of these alone.
    pub fn around(&self, free: &Free) -> Self {
        let (jacobian, rows) = free.part_of(&self.rows());
        Self { jacobian, rows }
    }

    pub fn rows(&self) -> Rows<'_> {
        Rows { jacobian: &self.jacobian, rows: &self.rows }
    }
}

/// `m ‖y − H(r)‖²` of the cells of a frame that were seen.
pub(crate) fn squares(
    frame: &Observation,
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    nudges: &[f64],
) -> impl Iterator<Item = f64> {
    let mut polygon = CellPolygon::default();
    let square = move |(cell, e): (usize, &[f64])| {
        let mut rest = frame.aim(cell) - Vector::new(e[0], e[1]);
        if frame.share() != 0.0 && frame.fill_polygon(&mut polygon, tessellation, positions, cell) {
            rest -= polygon.centroid() * frame.share();
        }
        frame.stiffness(cell) * rest.norm_squared()
    };
    nudges.chunks_exact(2).enumerate().map(square)
}

/// Largest derivative of a centroid. On the way to a fit a cell can come so near another that a corner goes wherever the least displacement
/// sends it; such a row is scaled down to this, or it would hide all others behind rounding.
const LARGEST: f64 = 1e3;

/// Rows on the way.
struct Rowed {
    p: usize,
    jacobian: BlockMatrix,
    rows: Vec<(usize, Vector<f64>, DMatrix<f64>)>,
}

impl Rowed {
    fn new(p: usize) -> Self {
        Self { p, jacobian: BlockMatrix { row_start: vec![0], ..BlockMatrix::default() }, rows: Vec::new() }
    }

    fn begin(&self) -> usize {
        self.jacobian.row_start[self.jacobian.row_start.len() - 1]
    }

    fn is_begun(&self) -> bool {
        self.jacobian.column.len() > self.begin()
    }

    /// Adds to a block of the row that is on the way.
    fn add(&mut self, column: usize, block: [f64; 4]) {
        let first = self.begin();
        match self.jacobian.column[first..].iter().position(|known| *known as usize == column) {
            Some(at) => {
                let sum = &mut self.jacobian.block[first + at];
                sum.iter_mut().zip(block).for_each(|(sum, part)| *sum += part);
            }
            None => {
                self.jacobian.column.push(column as u32);
                self.jacobian.block.push(block);
            }
        }
    }

    fn end(&mut self, row: usize, rest: Vector<f64>, slope: Option<(usize, Vector<f64>)>) {
        let mut by_coefficient = DMatrix::zeros(2, self.p);
        if let Some((k, slope)) = slope {
            by_coefficient.set_column(k, &slope);
        }
        let begin = self.begin();
        let own = &mut self.jacobian.block[begin..];
        let largest = own.iter().flatten().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
        if largest > LARGEST {
            own.iter_mut().flatten().for_each(|entry| *entry *= LARGEST / largest);
        }
        self.rows.push((row, rest, by_coefficient));
        self.skip();
    }

    fn skip(&mut self) {
        self.jacobian.row_start.push(self.jacobian.column.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{cells, observation};

    /// Rows of a frame at a share of the way to the centroids, with one cell held, against differences.
    #[test]
    fn derivatives_are_those_of_the_residuals() {
        let frame = observation(0.02, 0.05, 4).with_positions_at(0.7).unwrap();
        let (count, domain) = (cells().0.len(), cells().1);
        let errors: Vec<f64> = (0..count).map(|cell| 1.0 + 0.3 * (cell as f64).sin()).collect();
        let frame = frame.with_position_errors(&errors);
        let nudges: Vec<f64> = (0..2 * count).map(|k| 0.02 * (k as f64).cos()).collect();
        let rows_at = |share: f64, nudges: &[f64]| {
            let frame = frame.clone().at_share(share);
            let place =
                |cell: usize| frame.positions[cell] + Vector::new(nudges[2 * cell], nudges[2 * cell + 1]);
            let positions: Vec<Vector<f64>> = (0..count).map(place).collect();
            let tessellation = Tessellation::new(&positions, domain).unwrap();
            let total = squares(&frame, &tessellation, &positions, nudges).sum::<f64>();
            (PositionRows::new(&frame, &tessellation, &positions, nudges, 1, Some(0)), total)
        };
        let (exact, total) = rows_at(0.7, &nudges);
        let sum: f64 = exact.rows.iter().map(|row| row.1.norm_squared()).sum();
        assert!((sum - total).abs() < 1e-12 * sum);
        let step = 1e-6;
        let ([above, _], [below, _]) = (
            [rows_at(0.7 + step, &nudges).0, rows_at(0.7, &nudges).0],
            [rows_at(0.7 - step, &nudges).0, rows_at(0.7, &nudges).0],
        );
        for (k, (_, _, by_share)) in exact.rows.iter().enumerate() {
            let difference = (below.rows[k].1 - above.rows[k].1) / (2.0 * step);
            assert!((difference - by_share.column(0)).norm() < 1e-8);
        }
        for moved in [0, 17, 41] {
            let shifted = |sign: f64| {
                let mut nudges = nudges.clone();
                nudges[moved] += sign * step;
                rows_at(0.7, &nudges).0
            };
            let (above, below) = (shifted(1.0), shifted(-1.0));
            for (k, (row, ..)) in exact.rows.iter().enumerate() {
                let difference = (below.rows[k].1 - above.rows[k].1) / (2.0 * step);
                let block = exact.jacobian.row(*row).find(|(column, _)| *column == moved / 2);
                let found =
                    block.map_or(Vector::zeros(), |(_, b)| Vector::new(b[moved % 2], b[2 + moved % 2]));
                assert!((difference - found).norm() < 1e-6, "{moved} {row}: {difference} {found}");
            }
        }
    }
}
