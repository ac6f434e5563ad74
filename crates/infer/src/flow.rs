//! Velocities on a grid: what optical flow or particle image velocimetry measures of cells that move as the model says.
//!
//! ```text
//! v_g = Σ_i w_gi v_i / Σ_i w_gi        w_gi = area of cell i in the square of grid point g, or
//!                                      w_gi = exp(−|x_g − r_i|² / 2s²), or
//!                                      w_gi = ∫ exp(−|x_g − x|² / 2s²) over cell i
//! ```
//!
//! Weights depend on where the cells are, so ∂v_g/∂r has a part from the velocities and a part from the weights; and they depend on
//! the width of the window.

use voronudge_geometry::{Domain, Grid, Patch, Tessellation, Vector, Visibility, overlaps, side_pieces};
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
pub struct Window {
    /// Its shape and what it averages.
    pub kind: WindowKind,
    /// Side of a square, standard deviation s of a Gaussian, in the unit of length.
    pub width: f64,
}

/// Shapes of windows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WindowKind {
    /// Over the square around the grid point, in which every point moves with the cell that it belongs to. Where spacings differ
    /// it is a rectangle of the same area with sides in their ratio.
    Square,
    /// Over the cells' centres with weights `exp(−d²/2s²)`, cut at `d = 5s`.
    Gaussian,
    /// Over the plane with the same weights; every point moves with the cell that it belongs to.
    GaussianArea,
}

impl WindowKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Square, Self::Gaussian, Self::GaussianArea];

    /// The width to begin with, for a grid of some spacing.
    pub fn usual_width(self, grid: &Grid) -> f64 {
        let [dx, dy] = grid.spacing();
        let spacing = (dx * dy).sqrt();
        match self {
            Self::Square => spacing,
            Self::Gaussian | Self::GaussianArea => 0.5 * spacing,
        }
    }
}

/// Distance at which a Gaussian window is cut, in widths; its weight there is 4e-6.
const CUT: f64 = 5.0;

/// Weight of a cell that a grid point mostly stands for, as a share of the largest.
const MAIN: f64 = 0.5;

/// Least share of a window that trusted cells must fill for its velocity to be used.
const FILLED: f64 = 0.999;

/// The averages at given positions: sparse weights of cells for each grid point.
#[derive(Debug, Clone)]
pub(crate) struct Sampling {
    /// The grid with the patches that windows of areas stand for.
    grid: Grid,
    window: Window,
    /// First entry of each grid point, and the number of entries at the end.
    start: Vec<usize>,
    cell: Vec<u32>,
    /// Normalised over the trusted cells of a window.
    weight: Vec<f64>,
    /// Derivative of the weight by the width of the window.
    by_width: Vec<f64>,
    /// From the centres of cells to the grid point, where they have the weight.
    displacement: Vec<Vector<f64>>,
    /// Weight of all trusted cells of each window.
    total: Vec<f64>,
    filled: Vec<bool>,
}

impl Sampling {
    pub fn new(
        flow: &Flow,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        visibility: &[Visibility],
    ) -> Self {
        let trusted = |cell: u32| visibility[cell as usize] == Visibility::Counted;
        let Window { kind, width } = flow.window;
        let mut sampling = Self {
            grid: match kind {
                WindowKind::Square => flow.grid.with_patch(Patch::Square(width)),
                WindowKind::GaussianArea => flow.grid.with_patch(Patch::Gaussian(width)),
                WindowKind::Gaussian => flow.grid,
            },
            window: flow.window,
            start: vec![0],
            cell: Vec::new(),
            weight: Vec::new(),
            by_width: Vec::new(),
            displacement: Vec::new(),
            total: Vec::new(),
            filled: Vec::new(),
        };
        match kind {
            WindowKind::Gaussian => sampling.fill_by_centres(tessellation.domain(), positions, trusted),
            WindowKind::Square | WindowKind::GaussianArea => {
                sampling.fill_by_area(tessellation, positions, trusted);
            }
        }
        sampling
    }

    /// Grid points whose window is filled by trusted cells.
    pub fn filled(&self) -> &[bool] {
        &self.filled
    }

    /// Averages over patches of the plane.
    fn fill_by_area(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        trusted: impl Fn(u32) -> bool,
    ) {
        let overlaps = overlaps(tessellation, positions, &self.grid);
        let whole = self.grid.patch_area();
        for square in 0..self.grid.len() {
            let entries = overlaps.square(square).iter().filter(|entry| trusted(entry.cell));
            let (area, growth) = entries
                .clone()
                .fold((0.0, 0.0), |(area, growth), entry| (area + entry.area, growth + entry.by_width));
            if area > 0.0 {
                for entry in entries {
                    let weight = entry.area / area;
                    self.cell.push(entry.cell);
                    self.weight.push(weight);
                    self.by_width.push((entry.by_width - weight * growth) / area);
                }
            }
            self.end_row(area, area > FILLED * whole);
        }
    }

    /// Averages over the cells' centres.
    fn fill_by_centres(&mut self, domain: Domain, positions: &[Vector<f64>], trusted: impl Fn(u32) -> bool) {
        let width = self.window.width;
        let mut rows: Vec<Vec<(u32, Vector<f64>)>> = vec![Vec::new(); self.grid.len()];
        for (cell, r) in positions.iter().enumerate() {
            self.grid
                .for_centres_near(domain, *r, CUT * width, |datum, d| rows[datum].push((cell as u32, d)));
        }
        for row in rows {
            let weighted: Vec<(u32, Vector<f64>, f64)> = row
                .into_iter()
                .map(|(i, d)| (i, d, (-0.5 * d.norm_squared() / (width * width)).exp()))
                .collect();
            let all: f64 = weighted.iter().map(|entry| entry.2).sum();
            let sum: f64 = weighted.iter().filter(|entry| trusted(entry.0)).map(|entry| entry.2).sum();
            // ∂w/∂s = w d²/s³
            let growth = |d: Vector<f64>| d.norm_squared() / width.powi(3);
            let counted = weighted.into_iter().filter(|entry| trusted(entry.0));
            let mean = counted.clone().map(|(_, d, w)| growth(d) * w / sum).sum::<f64>();
            for (cell, d, w) in counted {
                self.cell.push(cell);
                self.weight.push(w / sum);
                self.by_width.push((growth(d) - mean) * w / sum);
                self.displacement.push(d);
            }
            self.end_row(sum, sum > 0.0 && sum > FILLED * all);
        }
    }

    fn end_row(&mut self, total: f64, filled: bool) {
        self.start.push(self.cell.len());
        self.total.push(total);
        self.filled.push(filled);
    }

    fn entries(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.start[row]..self.start[row + 1];
        self.cell[range.clone()].iter().map(|&cell| cell as usize).zip(self.weight[range].iter().copied())
    }

    /// The cells that a grid point mostly stands for.
    pub fn main_cells(&self, datum: usize) -> impl Iterator<Item = usize> {
        let most = self.entries(datum).map(|entry| entry.1).fold(0.0, f64::max);
        self.entries(datum).filter(move |(_, weight)| *weight >= MAIN * most).map(|(cell, _)| cell)
    }

    /// The averages of a field given for each cell.
    pub fn average(&self, field: &[Vector<f64>]) -> Vec<Vector<f64>> {
        (0..self.filled.len())
            .map(|row| self.entries(row).fold(Vector::zeros(), |sum, (cell, w)| sum + field[cell] * w))
            .collect()
    }

    /// The derivative of the averages of a field by the width of the window.
    pub fn width_slope(&self, field: &[Vector<f64>]) -> Vec<Vector<f64>> {
        let of_row = |row: usize| {
            let range = self.start[row]..self.start[row + 1];
            let terms = self.cell[range.clone()].iter().zip(&self.by_width[range]);
            terms.fold(Vector::zeros(), |sum, (cell, slope)| sum + field[*cell as usize] * *slope)
        };
        (0..self.filled.len()).map(of_row).collect()
    }

    /// `∂v_g/∂r_j` from the velocities of the cells and their Jacobian, at the positions of the averages.
    ///
    /// What moving a cell gains for cell i, at the expense of cell j, changes the average by `(u_i − u_j) (direction · dr)` with
    /// `u_i = v_i − v_g` for trusted cells and zero for others.
    pub fn jacobian(
        &self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        velocities: &[Vector<f64>],
        of_cells: &BlockMatrix,
    ) -> BlockMatrix {
        let averages = self.average(velocities);
        let sides = match self.window.kind {
            WindowKind::Gaussian => None,
            WindowKind::Square | WindowKind::GaussianArea => {
                Some(side_pieces(tessellation, positions, &self.grid))
            }
        };
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
            let mut shift = |moved: usize, u: Vector<f64>, direction: Vector<f64>| {
                let d = direction;
                add(moved, [u.x * d.x, u.x * d.y, u.y * d.x, u.y * d.y]);
            };
            match &sides {
                Some(sides) if self.total[row] > 0.0 => {
                    let excess = |cell: usize| match trusted[cell] {
                        true => velocities[cell] - average,
                        false => Vector::zeros(),
                    };
                    for piece in sides.square(row) {
                        let cells = [piece.cell as usize, piece.neighbour as usize];
                        let u = excess(cells[0]) - excess(cells[1]);
                        for (moved, gradient) in cells.into_iter().zip(piece.area_gradient()) {
                            shift(moved, u, gradient / self.total[row]);
                        }
                    }
                }
                Some(_) => {}
                None => {
                    let displacements = &self.displacement[self.start[row]..self.start[row + 1]];
                    for ((cell, w), d) in self.entries(row).zip(displacements) {
                        shift(cell, velocities[cell] - average, *d * (w / self.window.width.powi(2)));
                    }
                }
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

    /// Squares that touch, that overlap, that leave gaps, and Gaussians.
    fn windows() -> [Window; 5] {
        let window = |kind, width| Window { kind, width };
        [
            window(WindowKind::Square, 0.99f64.sqrt()),
            window(WindowKind::Square, 1.6),
            window(WindowKind::Square, 0.8),
            // No cell is at the cut.
            window(WindowKind::Gaussian, 0.52),
            window(WindowKind::GaussianArea, 0.5),
        ]
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
            let of_cells = jacobian(&tessellation, &positions, &model);
            let exact = sampling.jacobian(&tessellation, &positions, &v, &of_cells);
            let scale = exact.block.iter().flatten().fold(0.0, |max: f64, b| max.max(b.abs()));
            let at_width = |width: f64| {
                let flow = Flow { window: Window { width, ..window }, ..flow.clone() };
                Sampling::new(&flow, &tessellation, &positions, &visibility).average(&v)
            };
            let (wider, narrower) = (at_width(window.width + 1e-5), at_width(window.width - 1e-5));
            for (datum, slope) in sampling.width_slope(&v).into_iter().enumerate() {
                let difference = (wider[datum] - narrower[datum]) / 2e-5;
                assert!((difference - slope).norm() < 1e-5, "{window:?} {datum} {difference} {slope}");
            }
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
                        // The cut of a Gaussian window leaves steps of 4e-6 of a weight.
                        let tolerance = if window.kind == WindowKind::Square { 1e-7 } else { 2e-6 };
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
