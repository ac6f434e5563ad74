//! Velocities on a grid: what optical flow or particle image velocimetry measures of cells that move as the model says.
//!
//! ```text
//! v_g = Σ_i w_gi v_i / Σ_i w_gi        w_gi = area of cell i in the square of grid point g, or
//!                                      w_gi = exp(−|x_g − r_i|² / 2s²)
//! ```
//!
//! Weights depend on where the cells are, so ∂v_g/∂r has a part from the velocities and a part from the weights.

use voronudge_geometry::{Domain, Grid, Tessellation, Vector, Visibility, overlaps, side_pieces};
use voronudge_model::BlockMatrix;

/// Velocities on a regular grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// The grid points, and the squares around them.
    pub grid: Grid,
    /// Measured velocities (n_y n_x, row by row); `None` where a grid point is missing.
    pub velocities: Vec<Option<Vector<f64>>>,
    /// How cells' velocities are averaged.
    pub window: Window,
}

/// The average over cells that a grid point stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Window {
    /// Over the square around the grid point, in which every point moves with the cell that it belongs to.
    Square,
    /// Over the cells' centres with weights `exp(−d²/2s²)`, cut at `d = 4s`.
    Gaussian {
        /// `s`, in the unit of length.
        width: f64,
    },
}

/// Distance at which a Gaussian window is cut, in widths; its weight there is 3e-4.
const CUT: f64 = 4.0;

/// Least share of a window that trusted cells must fill for its velocity to be used.
const FILLED: f64 = 0.999;

/// The averages at given positions: sparse weights of cells for each grid point, and how they change.
#[derive(Debug, Clone)]
pub(crate) struct Sampling {
    /// First entry of each grid point, and the number of entries at the end.
    start: Vec<usize>,
    cell: Vec<u32>,
    /// Normalised over the trusted cells of a window.
    weight: Vec<f64>,
    filled: Vec<bool>,
    shift_start: Vec<usize>,
    shifts: Vec<Shift>,
}

/// `dv_g += (u_to − u_from) (direction · dr_moved)` with `u_i = v_i − v_g` for trusted cells and zero for others: what
/// moving a cell gains for one cell, at the expense of another.
#[derive(Debug, Clone, Copy)]
struct Shift {
    to: u32,
    from: Option<u32>,
    moved: u32,
    direction: Vector<f64>,
}

impl Sampling {
    pub fn new(
        flow: &Flow,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        visibility: &[Visibility],
    ) -> Self {
        let trusted = |cell: u32| visibility[cell as usize] == Visibility::Counted;
        match flow.window {
            Window::Square => Self::squares(flow, tessellation, positions, trusted),
            Window::Gaussian { width } => {
                Self::gaussian(flow, tessellation.domain(), positions, width, trusted)
            }
        }
    }

    /// Grid points whose window is filled by trusted cells.
    pub fn filled(&self) -> &[bool] {
        &self.filled
    }

    fn squares(
        flow: &Flow,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        trusted: impl Fn(u32) -> bool,
    ) -> Self {
        let overlaps = overlaps(tessellation, positions, &flow.grid);
        let pieces = side_pieces(tessellation, positions, &flow.grid);
        let whole = flow.grid.square_area();
        let mut sampling = Self::empty();
        for square in 0..flow.velocities.len() {
            let entries = overlaps.square(square);
            let area: f64 = entries.iter().filter(|entry| trusted(entry.cell)).map(|entry| entry.area).sum();
            sampling.filled.push(area > FILLED * whole);
            if area > 0.0 {
                for entry in entries.iter().filter(|entry| trusted(entry.cell)) {
                    sampling.cell.push(entry.cell);
                    sampling.weight.push(entry.area / area);
                }
                for piece in pieces.square(square) {
                    let (to, from) = (piece.cell, piece.neighbour);
                    for (moved, gradient) in [to, from].into_iter().zip(piece.area_gradient()) {
                        sampling.shifts.push(Shift {
                            to,
                            from: Some(from),
                            moved,
                            direction: gradient / area,
                        });
                    }
                }
            }
            sampling.end_row();
        }
        sampling
    }

    fn gaussian(
        flow: &Flow,
        domain: Domain,
        positions: &[Vector<f64>],
        width: f64,
        trusted: impl Fn(u32) -> bool,
    ) -> Self {
        let mut rows: Vec<Vec<(u32, Vector<f64>)>> = vec![Vec::new(); flow.velocities.len()];
        for (cell, r) in positions.iter().enumerate() {
            flow.grid
                .for_centres_near(domain, *r, CUT * width, |datum, d| rows[datum].push((cell as u32, d)));
        }
        let mut sampling = Self::empty();
        for row in rows {
            let weighted: Vec<(u32, Vector<f64>, f64)> = row
                .into_iter()
                .map(|(i, d)| (i, d, (-0.5 * d.norm_squared() / (width * width)).exp()))
                .collect();
            let all: f64 = weighted.iter().map(|entry| entry.2).sum();
            let sum: f64 = weighted.iter().filter(|entry| trusted(entry.0)).map(|entry| entry.2).sum();
            sampling.filled.push(sum > 0.0 && sum > FILLED * all);
            for (cell, d, w) in weighted.into_iter().filter(|entry| trusted(entry.0)) {
                sampling.cell.push(cell);
                sampling.weight.push(w / sum);
                let direction = d * (w / (sum * width * width));
                sampling.shifts.push(Shift { to: cell, from: None, moved: cell, direction });
            }
            sampling.end_row();
        }
        sampling
    }

    fn empty() -> Self {
        Self {
            start: vec![0],
            cell: Vec::new(),
            weight: Vec::new(),
            filled: Vec::new(),
            shift_start: vec![0],
            shifts: Vec::new(),
        }
    }

    fn end_row(&mut self) {
        self.start.push(self.cell.len());
        self.shift_start.push(self.shifts.len());
    }

    fn entries(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.start[row]..self.start[row + 1];
        self.cell[range.clone()].iter().map(|&cell| cell as usize).zip(self.weight[range].iter().copied())
    }

    /// The averages of a field given for each cell.
    pub fn average(&self, field: &[Vector<f64>]) -> Vec<Vector<f64>> {
        (0..self.filled.len())
            .map(|row| self.entries(row).fold(Vector::zeros(), |sum, (cell, w)| sum + field[cell] * w))
            .collect()
    }

    /// `∂v_g/∂r_j` from the velocities of the cells and their Jacobian.
    pub fn jacobian(&self, velocities: &[Vector<f64>], of_cells: &BlockMatrix) -> BlockMatrix {
        let averages = self.average(velocities);
        let mut matrix = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
        let mut place = vec![usize::MAX; velocities.len()];
        let mut trusted = vec![false; velocities.len()];
        for (row, average) in averages.iter().enumerate() {
            let first = matrix.column.len();
            let mut add = |column: usize, block: [f64; 4]| {
                if place[column] == usize::MAX {
                    place[column] = matrix.column.len();
                    matrix.column.push(column as u32);
                    matrix.block.push(block);
                } else {
                    let sum = &mut matrix.block[place[column]];
                    sum.iter_mut().zip(block).for_each(|(s, b)| *s += b);
                }
            };
            for (cell, w) in self.entries(row) {
                trusted[cell] = true;
                of_cells.row(cell).for_each(|(column, block)| add(column, block.map(|b| w * b)));
            }
            for shift in &self.shifts[self.shift_start[row]..self.shift_start[row + 1]] {
                let excess = |cell: u32| match trusted[cell as usize] {
                    true => velocities[cell as usize] - average,
                    false => Vector::zeros(),
                };
                let u = excess(shift.to) - shift.from.map_or(Vector::zeros(), excess);
                let d = shift.direction;
                add(shift.moved as usize, [u.x * d.x, u.x * d.y, u.y * d.x, u.y * d.y]);
            }
            matrix.column[first..].iter().for_each(|&column| place[column as usize] = usize::MAX);
            self.entries(row).for_each(|(cell, _)| trusted[cell] = false);
            matrix.row_start.push(matrix.column.len());
        }
        matrix
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{COEFFICIENTS, cells};
    use voronudge_geometry::FieldOfView;
    use voronudge_model::{Model, base_terms, jacobian, velocities};

    fn windows() -> [Window; 2] {
        [Window::Square, Window::Gaussian { width: 0.5 }]
    }

    /// ∂v_g/∂r against central differences of what is measured.
    #[test]
    fn jacobians_are_those_of_the_averages() {
        let (positions, domain) = cells();
        let terms = base_terms(1.0);
        let model = Model::with_coefficients(&terms, &COEFFICIENTS);
        let tessellation = Tessellation::new(&positions, domain).unwrap();
        let visibility = vec![Visibility::Counted; positions.len()];
        for window in windows() {
            let grid = Grid::new([-0.7, 0.4], [0.9, 1.1], [6, 5]).unwrap();
            let flow = Flow { grid, velocities: vec![None; 30], window };
            let average = |positions: &[Vector<f64>]| {
                let sampling = Sampling::new(&flow, &tessellation, positions, &visibility);
                sampling.average(&velocities(&tessellation, positions, &model))
            };
            let sampling = Sampling::new(&flow, &tessellation, &positions, &visibility);
            assert!(sampling.filled().iter().all(|filled| *filled));
            let v = velocities(&tessellation, &positions, &model);
            let exact = sampling.jacobian(&v, &jacobian(&tessellation, &positions, &model));
            let scale = exact.block.iter().flatten().fold(0.0, |max: f64, b| max.max(b.abs()));
            for cell in 0..positions.len() {
                for axis in 0..2 {
                    let at = |sign: f64| {
                        let mut moved = positions.clone();
                        moved[cell][axis] += sign * 1e-5;
                        average(&moved)
                    };
                    let (above, below) = (at(1.0), at(-1.0));
                    for datum in 0..30 {
                        let difference = (above[datum] - below[datum]) / 2e-5;
                        let block =
                            exact.row(datum).find(|(column, _)| *column == cell).map(|(_, block)| *block);
                        let block = block.unwrap_or([0.0; 4]);
                        let found = Vector::new(block[axis], block[2 + axis]);
                        // The cut of a Gaussian window leaves steps of 3e-4 of a weight.
                        let tolerance = if window == Window::Square { 1e-7 } else { 2e-6 };
                        assert!((difference - found).norm() < tolerance * scale, "{window:?} {datum} {cell}");
                    }
                }
            }
        }
    }

    /// A field that is the same for all cells is the same at every grid point, also across the boundary.
    #[test]
    fn averages_keep_a_uniform_field() {
        let (positions, domain) = cells();
        let tessellation = Tessellation::new(&positions, domain).unwrap();
        let visibility = vec![Visibility::Counted; positions.len()];
        for window in windows() {
            let grid = Grid::new([-1.0, -2.0], [0.5, 0.7], [15, 14]).unwrap();
            let flow = Flow { grid, velocities: vec![None; 210], window };
            let sampling = Sampling::new(&flow, &tessellation, &positions, &visibility);
            let uniform = vec![Vector::new(0.3, -2.0); positions.len()];
            let worst =
                sampling.average(&uniform).iter().map(|v| (v - uniform[0]).norm()).fold(0.0, f64::max);
            assert!(worst < 1e-12, "{worst:e}");
        }
    }

    /// Grid points that no trusted cells fill take no part.
    #[test]
    fn an_open_field_leaves_out_the_rim() {
        let (positions, _) = cells();
        let grid = Grid::new([-3.0, -3.0], [1.0, 1.0], [12, 12]).unwrap();
        for window in windows() {
            let flow = Flow { grid, velocities: vec![Some(Vector::new(1.0, 0.0)); 144], window };
            let frame = crate::Observation::new(
                0,
                positions.clone(),
                crate::Velocities::OnGrid(flow),
                Domain::Open,
                FieldOfView::default(),
            );
            let targets = frame.unwrap().targets().count();
            assert!(targets < 20, "{window:?} {targets}");
        }
    }
}
