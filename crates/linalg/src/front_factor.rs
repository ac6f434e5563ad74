//! The dense factor of one front of a sparse matrix.

use crate::Error;
use crate::dissection::Front;
use crate::number::Number;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
    solve_unit_upper_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::reborrow::{IntoConst, Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Results must not depend on the number of threads: [`COLUMNS`] of a front are one thread's work.
const SEQUENTIAL: Par = Par::Seq;

/// Columns of a front that are one task.
const COLUMNS: usize = 256;

/// Whether a system is solved as it is or transposed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    AsGiven,
    Transposed,
}

impl Side {
    fn other(self) -> Self {
        match self {
            Self::AsGiven => Self::Transposed,
            Self::Transposed => Self::AsGiven,
        }
    }
}

/// The matrix of a front in the making: its own columns, what its own rows have besides, and the rest.
pub(crate) struct FrontMatrix<T: Number> {
    columns: Mat<T>,
    upper: Mat<T>,
    rest: Mat<T>,
}

impl<T: Number> FrontMatrix<T> {
    pub fn zeros(own: usize, coupled: usize) -> Self {
        Self {
            columns: Mat::zeros(own + coupled, own),
            upper: Mat::zeros(own, coupled),
            rest: Mat::zeros(coupled, coupled),
        }
    }

    #[inline]
    pub fn entry(&mut self, row: usize, column: usize) -> &mut T {
        let own = self.columns.ncols();
        match (row.checked_sub(own), column.checked_sub(own)) {
            (_, None) => &mut self.columns[(row, column)],
            (None, Some(column)) => &mut self.upper[(row, column)],
            (Some(row), Some(column)) => &mut self.rest[(row, column)],
        }
    }

    /// Eliminates its own unknowns; what that leaves for the boundary. `is_leaf`: nothing was eliminated below, so couplings are those of the sparse matrix.
    pub fn factorise(self, is_leaf: bool) -> Result<(Factor<T>, Mat<T>), Error> {
        let sparse = is_leaf.then(|| self.couplings());
        let Self { mut columns, mut upper, mut rest } = self;
        let own = columns.ncols();
        let (mut f11, f21) = columns.as_mut().split_at_row_mut(own);
        let (mut row, mut inverse) = (vec![0; own], vec![0; own]);
        let room = lu_in_place_scratch::<usize, T>(own, own, SEQUENTIAL, Default::default());
        lu_in_place(
            f11.rb_mut(),
            &mut row,
            &mut inverse,
            SEQUENTIAL,
            MemStack::new(&mut MemBuffer::new(room)),
            Default::default(),
        );
        if !(0..own).all(|k| f11[(k, k)].is_regular()) {
            return Err(Error::Singular);
        }
        let (f11, mut f21) = (f11.into_const(), f21.transpose_mut());
        f21.rb_mut().par_col_chunks_mut(COLUMNS).for_each(|columns| {
            solve_lower_triangular_in_place(f11.transpose(), columns, SEQUENTIAL);
        });
        let f21 = f21.into_const().transpose();
        let pieces = upper.par_col_chunks_mut(COLUMNS).zip(rest.par_col_chunks_mut(COLUMNS));
        pieces.for_each(|(mut upper, rest)| {
            let permuted = Mat::from_fn(own, upper.ncols(), |k, column| upper[(row[k], column)]);
            upper.copy_from(&permuted);
            solve_unit_lower_triangular_in_place(f11, upper.rb_mut(), SEQUENTIAL);
            matmul(rest, Accum::Add, f21, upper.rb(), minus_one(), SEQUENTIAL);
        });
        let factor = match sparse {
            Some(couplings) => Factor { lu: f11.to_owned(), row, coupling: Coupling::Given(couplings) },
            None => Factor { lu: columns, row, coupling: Coupling::Eliminated(upper) },
        };
        Ok((factor, rest))
    }

    /// The blocks that couple its own nodes to those of the boundary.
    fn couplings(&self) -> Vec<Blocks<T>> {
        let (own, coupled) = (self.columns.ncols(), self.upper.ncols());
        let pairs = (0..own / 2).flat_map(|a| (0..coupled / 2).map(move |b| (a, b)));
        let blocks = pairs.map(|(a, b)| {
            let entries = [0, 1, 2, 3].map(|k| (2 * a + k / 2, 2 * b + k % 2));
            Blocks {
                nodes: [a as u32, b as u32],
                upper: entries.map(|(own, coupled)| self.upper[(own, coupled)]),
                lower: entries.map(|(row, column)| self.columns[(own + 2 * b + row % 2, 2 * a + column % 2)]),
            }
        });
        let zero = T::from_complex(0.0.into());
        blocks.filter(|blocks| blocks.upper.iter().chain(&blocks.lower).any(|entry| *entry != zero)).collect()
    }
}

/// What couples one of its own nodes to one of the boundary: `F₁₂` and `F₂₁`, each `[xx, xy, yx, yy]`.
struct Blocks<T> {
    nodes: [u32; 2],
    upper: [T; 4],
    lower: [T; 4],
}

/// `P F₁₁ = L U` of the matrix `F` of a front, and what couples it to the boundary.
pub(crate) struct Factor<T: Number> {
    /// L and U, and where they are eliminated L₂₁ below.
    lu: Mat<T>,
    /// Row of `F₁₁` that comes to each place.
    row: Vec<usize>,
    coupling: Coupling<T>,
}

enum Coupling<T: Number> {
    /// `U₁₂ = L⁻¹ P F₁₂`, beside `L₂₁ = F₂₁ U⁻¹`.
    Eliminated(Mat<T>),
    /// `F₁₂` and `F₂₁` as they are in the sparse matrix, which takes less memory.
    Given(Vec<Blocks<T>>),
}

impl<T: Number> Factor<T> {
    fn lu(&self) -> MatRef<'_, T> {
        self.lu.subrows(0, self.row.len())
    }

    /// What takes its own unknowns out of the rows of the boundary, as it is eliminated.
    fn outward<'a>(&'a self, upper: &'a Mat<T>, side: Side) -> MatRef<'a, T, usize, usize, isize, isize> {
        match side {
            Side::AsGiven => self.lu.subrows(self.row.len(), upper.ncols()).as_dyn_stride(),
            Side::Transposed => upper.transpose().as_dyn_stride(),
        }
    }

    /// Forward substitution: takes what is its own out of the rows of the boundary.
    pub fn eliminate(&self, front: &Front, side: Side, mut x: MatMut<'_, T>) {
        let count = x.ncols();
        let mut own = x.rb_mut().subrows_mut(2 * front.first, 2 * front.own);
        let mut taken = Mat::zeros(2 * front.boundary.len(), count);
        match &self.coupling {
            Coupling::Eliminated(upper) => {
                self.solve_first(side, own.rb_mut());
                let coupling = self.outward(upper, side);
                matmul(taken.as_mut(), Accum::Replace, coupling, own.rb(), one(), SEQUENTIAL);
            }
            Coupling::Given(blocks) => {
                let mut solved = own.to_owned();
                self.solve_first(side, solved.as_mut());
                self.solve_second(side, solved.as_mut());
                for Blocks { nodes: [a, b], upper, lower } in blocks {
                    let block = if side == Side::AsGiven { *lower } else { transposed(*upper) };
                    add_product(block, solved.as_ref(), *a as usize, taken.as_mut(), *b as usize);
                }
            }
        }
        for (k, row) in rows_of_boundary(front).enumerate() {
            for column in 0..count {
                x[(row, column)] -= taken[(k, column)];
            }
        }
    }

    /// Backward substitution: the rows of the boundary are known.
    pub fn substitute(&self, front: &Front, side: Side, mut x: MatMut<'_, T>) {
        let count = x.ncols();
        let mut known = Mat::zeros(2 * front.boundary.len(), count);
        for (k, row) in rows_of_boundary(front).enumerate() {
            for column in 0..count {
                known[(k, column)] = x[(row, column)];
            }
        }
        let mut own = x.rb_mut().subrows_mut(2 * front.first, 2 * front.own);
        match &self.coupling {
            Coupling::Eliminated(upper) => {
                let coupling = self.outward(upper, side.other()).transpose();
                matmul(own.rb_mut(), Accum::Add, coupling, known.as_ref(), minus_one(), SEQUENTIAL);
            }
            Coupling::Given(blocks) => {
                let mut sum = Mat::zeros(own.nrows(), count);
                for Blocks { nodes: [a, b], upper, lower } in blocks {
                    let block = if side == Side::AsGiven { *upper } else { transposed(*lower) };
                    add_product(block, known.as_ref(), *b as usize, sum.as_mut(), *a as usize);
                }
                own -= &sum;
                self.solve_first(side, own.rb_mut());
            }
        }
        self.solve_second(side, own);
    }

    /// The first triangle of `F₁₁`.
    fn solve_first(&self, side: Side, mut own: MatMut<'_, T>) {
        match side {
            Side::AsGiven => {
                let permuted = Mat::from_fn(own.nrows(), own.ncols(), |k, column| own[(self.row[k], column)]);
                own.copy_from(&permuted);
                solve_unit_lower_triangular_in_place(self.lu(), own, SEQUENTIAL);
            }
            Side::Transposed => solve_lower_triangular_in_place(self.lu().transpose(), own, SEQUENTIAL),
        }
    }

    /// The second triangle of `F₁₁`.
    fn solve_second(&self, side: Side, mut own: MatMut<'_, T>) {
        match side {
            Side::AsGiven => solve_upper_triangular_in_place(self.lu(), own, SEQUENTIAL),
            Side::Transposed => {
                solve_unit_upper_triangular_in_place(self.lu().transpose(), own.rb_mut(), SEQUENTIAL);
                let solved = own.to_owned();
                for (k, &row) in self.row.iter().enumerate() {
                    own.rb_mut().row_mut(row).copy_from(solved.row(k));
                }
            }
        }
    }
}

fn one<T: Number>() -> T {
    T::from_complex(1.0.into())
}

fn minus_one<T: Number>() -> T {
    T::from_complex((-1.0).into())
}

fn transposed<T>([xx, xy, yx, yy]: [T; 4]) -> [T; 4] {
    [xx, yx, xy, yy]
}

/// Adds a block times a node's rows to those of another node.
fn add_product<T: Number>(
    [xx, xy, yx, yy]: [T; 4],
    of: MatRef<'_, T>,
    node: usize,
    mut to: MatMut<'_, T>,
    other: usize,
) {
    for column in 0..to.ncols() {
        let (x, y) = (of[(2 * node, column)], of[(2 * node + 1, column)]);
        to[(2 * other, column)] += xx * x;
        to[(2 * other, column)] += xy * y;
        to[(2 * other + 1, column)] += yx * x;
        to[(2 * other + 1, column)] += yy * y;
    }
}

fn rows_of_boundary(front: &Front) -> impl Iterator<Item = usize> {
    front.boundary.iter().flat_map(|&position| [2 * position as usize, 2 * position as usize + 1])
}
