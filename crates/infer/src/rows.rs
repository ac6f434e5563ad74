//! Linearised data of one kind: rows of residuals with their derivatives, and their products.

use crate::gram::{chosen, transposed};
use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::sync::OnceLock;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// The two unknowns of a block, of some vectors that go together.
pub(crate) type Pair<const L: usize> = [[f64; L]; 2];

/// Vectors of n numbers, one after the other, side by side; lanes beyond are zero.
pub(crate) fn to_lanes<const L: usize>(vectors: &[f64], n: usize) -> Vec<Pair<L>> {
    let mut lanes = vec![[[0.0; L]; 2]; n / 2];
    for (lane, vector) in vectors.chunks_exact(n.max(1)).enumerate() {
        for (pair, own) in lanes.iter_mut().zip(vector.chunks_exact(2)) {
            (pair[0][lane], pair[1][lane]) = (own[0], own[1]);
        }
    }
    lanes
}

/// The first of some vectors, one after the other.
pub(crate) fn from_lanes<const L: usize>(lanes: &[Pair<L>], vectors: usize) -> Vec<f64> {
    (0..vectors).flat_map(|lane| lanes.iter().flat_map(move |pair| [pair[0][lane], pair[1][lane]])).collect()
}

/// Datum, residual, and its derivative by the free coefficients (2, p).
pub(crate) type Row = (usize, Vector<f64>, DMatrix<f64>);

/// Residuals of one kind with their derivatives: by the coordinates, a block column for each place, and by the free
/// coefficients.
pub(crate) struct Rows<'a> {
    /// ∂F/∂ε; only the rows of `rows` matter.
    pub jacobian: &'a BlockMatrix,
    /// Row of the Jacobian, residual r, and the derivative by the free coefficients (2, p).
    pub rows: &'a [(usize, Vector<f64>, DMatrix<f64>)],
}

/// `y = r + Jε` of one datum.
pub(crate) fn linearised_back(
    jacobian: &BlockMatrix,
    (datum, residual): (usize, Vector<f64>),
    nudges: &[f64],
) -> Vector<f64> {
    jacobian.row(datum).fold(residual, |y, (column, b)| {
        let (ex, ey) = (nudges[2 * column], nudges[2 * column + 1]);
        y + Vector::new(b[0] * ex + b[1] * ey, b[2] * ex + b[3] * ey)
    })
}

/// Rows of a product per task.
const CHUNK: usize = 1024;

/// A row of blocks times vectors, side by side in lanes.
#[inline(always)]
fn product<const L: usize>(columns: &[u32], blocks: &[[f64; 4]], u: &[Pair<L>]) -> Pair<L> {
    let [mut p, mut q] = [[0.0; L]; 2];
    for (column, b) in columns.iter().zip(blocks) {
        let [x, y] = &u[*column as usize];
        for lane in 0..L {
            p[lane] += b[0] * x[lane] + b[1] * y[lane];
            q[lane] += b[2] * x[lane] + b[3] * y[lane];
        }
    }
    [p, q]
}

/// A matrix times a factor and vectors, side by side in lanes, added to others: some rows of it, from a first one on.
struct SomeRows<'a, const L: usize> {
    matrix: &'a BlockMatrix,
    first: usize,
    factor: f64,
    u: &'a [Pair<L>],
    to: &'a mut [Pair<L>],
}

impl<const L: usize> WithSimd for SomeRows<'_, L> {
    type Output = ();

    // What is called from here has to be compiled into it, to be compiled for the processor.
    #[inline(always)]
    fn with_simd<A: Simd>(self, _: A) {
        let BlockMatrix { row_start, column, block } = self.matrix;
        for (row, to) in row_start[self.first..].windows(2).zip(self.to) {
            let own = product(&column[row[0]..row[1]], &block[row[0]..row[1]], self.u);
            for axis in 0..2 {
                for lane in 0..L {
                    to[axis][lane] += self.factor * own[axis][lane];
                }
            }
        }
    }
}

/// Adds a matrix times a factor and vectors, side by side in lanes.
fn add_product<const L: usize>(matrix: &BlockMatrix, factor: f64, u: &[Pair<L>], to: &mut [Pair<L>]) {
    to.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, to)| {
        Arch::new().dispatch(SomeRows { matrix, first: chunk * CHUNK, factor, u, to });
    });
}

/// Rows and their products.
#[derive(Debug)]
pub(crate) struct Group {
    /// J, a row for each datum, its columns ascending.
    pub jacobian: BlockMatrix,
    /// Jᵀ, once it is asked for.
    transposed: OnceLock<BlockMatrix>,
    /// JᵀX (n × p, by columns), then Jᵀy as the last column.
    pub mixed: Vec<f64>,
    /// Jᵀr
    pub gradient: Vec<f64>,
    /// XᵀX
    pub free_normal: DMatrix<f64>,
    /// Xᵀr
    pub free_gradient: DVector<f64>,
    /// Xᵀy
    pub free_data: DVector<f64>,
    /// yᵀy
    pub data: f64,
    /// Number of components of r.
    pub components: usize,
}

impl Group {
    /// The products of rows about the nudges ε, for p free coefficients.
    pub fn new(rows: &Rows<'_>, nudges: &[f64], p: usize) -> Self {
        let n = nudges.len();
        let mut group = Self {
            jacobian: chosen(rows.jacobian, rows.rows.iter().map(|row| row.0)),
            transposed: OnceLock::new(),
            mixed: vec![0.0; n * (p + 1)],
            gradient: vec![0.0; n],
            free_normal: DMatrix::zeros(p, p),
            free_gradient: DVector::zeros(p),
            free_data: DVector::zeros(p),
            data: 0.0,
            components: 2 * rows.rows.len(),
        };
        for (datum, residual, x) in rows.rows {
            let y = linearised_back(rows.jacobian, (*datum, *residual), nudges);
            group.data += y.norm_squared();
            group.free_normal += x.transpose() * x;
            group.free_gradient += x.transpose() * DVector::from_column_slice(residual.as_slice());
            group.free_data += x.transpose() * DVector::from_column_slice(y.as_slice());
            for (column, b) in rows.jacobian.row(*datum) {
                let transposed = |v: Vector<f64>| [b[0] * v.x + b[2] * v.y, b[1] * v.x + b[3] * v.y];
                let add = |to: &mut [f64], v: Vector<f64>| {
                    to.iter_mut().zip(transposed(v)).for_each(|(sum, part)| *sum += part);
                };
                for k in 0..p {
                    let at = k * n + 2 * column;
                    add(&mut group.mixed[at..at + 2], Vector::new(x[(0, k)], x[(1, k)]));
                }
                let at = p * n + 2 * column;
                add(&mut group.mixed[at..at + 2], y);
                add(&mut group.gradient[2 * column..2 * column + 2], *residual);
            }
        }
        group
    }

    /// Adds JᵀJu times a factor to vectors, side by side in lanes; Ju is left in the room given.
    pub fn add_products<const L: usize>(
        &self,
        factor: f64,
        u: &[Pair<L>],
        to: &mut [Pair<L>],
        room: &mut Vec<Pair<L>>,
    ) {
        room.clear();
        room.resize(self.jacobian.row_start.len() - 1, [[0.0; L]; 2]);
        add_product(&self.jacobian, 1.0, u, room);
        let back = self.transposed.get_or_init(|| transposed(&self.jacobian, to.len()));
        add_product(back, factor, room, to);
    }

    /// ‖Ju‖²
    pub fn square(&self, u: &[Pair<1>]) -> f64 {
        let BlockMatrix { row_start, column, block } = &self.jacobian;
        let of_row = |row: &[usize]| {
            let own = product(&column[row[0]..row[1]], &block[row[0]..row[1]], u);
            own.iter().flatten().map(|own| own * own).sum::<f64>()
        };
        row_start.windows(2).map(of_row).sum()
    }

    /// The diagonal of JᵀJ.
    pub fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.gradient.len()];
        for (column, b) in self.jacobian.column.iter().zip(&self.jacobian.block) {
            diagonal[2 * *column as usize] += b[0] * b[0] + b[2] * b[2];
            diagonal[2 * *column as usize + 1] += b[1] * b[1] + b[3] * b[3];
        }
        diagonal
    }
}
