//! Sparse LU factorisation of `A − σ 1` by fronts (multifrontal, nested dissection).

use crate::dissection::{Dissection, Front, Place};
use crate::graph::Graph;
use crate::{BlockSparse, Error};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
    solve_unit_upper_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::traits::ComplexField;
use faer::{Accum, Mat, MatMut, Par};
use num_complex::Complex64;
use std::ops::{AddAssign, SubAssign};
use std::sync::OnceLock;

/// Results must not depend on the number of threads: a front is one thread's work.
const SEQUENTIAL: Par = Par::Seq;

/// Real or complex numbers of double precision.
pub(crate) trait Number: ComplexField + Copy + Send + Sync + AddAssign + SubAssign {
    /// Of a shift, the imaginary part only where there is room for one.
    fn from_complex(value: Complex64) -> Self;
    fn is_regular(self) -> bool;
    /// Solves for a complex vector.
    fn solve_complex(lu: &SparseLu<Self>, side: Side, x: &[Complex64], solution: &mut [Complex64]);
}

impl Number for f64 {
    fn from_complex(value: Complex64) -> Self {
        value.re
    }
    fn is_regular(self) -> bool {
        self.is_finite() && self != 0.0
    }
    /// Real and imaginary part are two right-hand sides.
    fn solve_complex(lu: &SparseLu<Self>, side: Side, x: &[Complex64], solution: &mut [Complex64]) {
        let mut parts: Vec<f64> = x.iter().map(|x| x.re).chain(x.iter().map(|x| x.im)).collect();
        lu.solve(side, &mut parts);
        let (real, imaginary) = parts.split_at(x.len());
        for (k, solution) in solution.iter_mut().enumerate() {
            *solution = Complex64::new(real[k], imaginary[k]);
        }
    }
}

impl Number for Complex64 {
    fn from_complex(value: Complex64) -> Self {
        value
    }
    fn is_regular(self) -> bool {
        self.re.is_finite() && self.im.is_finite() && self != Complex64::ZERO
    }
    fn solve_complex(lu: &SparseLu<Self>, side: Side, x: &[Complex64], solution: &mut [Complex64]) {
        solution.copy_from_slice(x);
        lu.solve(side, solution);
    }
}

/// Whether a system is solved as it is or transposed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    AsGiven,
    Transposed,
}

/// `A − σ 1` factorised. Pivots are chosen within fronts.
pub(crate) struct SparseLu<T: Number> {
    dissection: Dissection,
    factors: Vec<OnceLock<Factor<T>>>,
}

/// `P F₁₁ = L U`, `U₁₂ = L⁻¹ P F₁₂`, `L₂₁ = F₂₁ U⁻¹` of the matrix `F` of a front.
struct Factor<T: Number> {
    lu: Mat<T>,
    /// Row of `F₁₁` that comes to each place.
    row: Vec<usize>,
    upper: Mat<T>,
    lower: Mat<T>,
}

impl<T: Number> SparseLu<T> {
    /// Factorises; `places` are the places of the block rows in the plane, by which the matrix is dissected.
    pub fn new(matrix: &BlockSparse, shift: Complex64, places: &[[f64; 2]]) -> Result<Self, Error> {
        if places.len() != matrix.rows() {
            return Err(Error::Malformed("one place is needed for each block row"));
        }
        let transposed = matrix.transposed();
        let places: Vec<Place> = places.iter().map(|&[x, y]| Some([x, y, 0.0])).collect();
        let dissection = Dissection::new(&Graph::of_blocks(matrix, &transposed), &places);
        let factors: Vec<_> = dissection.fronts.iter().map(|_| OnceLock::new()).collect();
        let job = Job {
            matrix,
            transposed: &transposed,
            shift: T::from_complex(shift),
            dissection: &dissection,
            factors: &factors,
        };
        for &root in &dissection.roots {
            job.factorise(root)?;
        }
        Ok(Self { dissection, factors })
    }

    /// Replaces columns of right-hand sides, in the order of the matrix, by solutions.
    pub fn solve(&self, side: Side, columns: &mut [T]) {
        let order = 2 * self.dissection.order.len();
        if order == 0 {
            return;
        }
        let count = columns.len() / order;
        let node = |row: usize| 2 * self.dissection.order[row / 2] as usize + row % 2;
        let mut x = Mat::from_fn(order, count, |row, column| columns[column * order + node(row)]);
        for (front, factor) in self.steps() {
            front.eliminate(factor, side, x.as_mut());
        }
        for (front, factor) in self.steps().rev() {
            front.substitute(factor, side, x.as_mut());
        }
        for column in 0..count {
            for row in 0..order {
                columns[column * order + node(row)] = x[(row, column)];
            }
        }
    }

    fn steps(&self) -> impl DoubleEndedIterator<Item = (&Front, &Factor<T>)> {
        let pairs = self.dissection.fronts.iter().zip(&self.factors);
        pairs.filter_map(|(front, factor)| Some((front, factor.get()?)))
    }
}

/// A factorisation at work.
struct Job<'a, T: Number> {
    matrix: &'a BlockSparse,
    transposed: &'a BlockSparse,
    shift: T,
    dissection: &'a Dissection,
    factors: &'a [OnceLock<Factor<T>>],
}

impl<T: Number> Job<'_, T> {
    /// Factorises a front and all below it; what it leaves for its boundary.
    fn factorise(&self, index: usize) -> Result<Mat<T>, Error> {
        let front = &self.dissection.fronts[index];
        let below = self.factorise_all(&front.children)?;
        let (own, coupled) = (2 * front.own, 2 * front.boundary.len());
        let mut full = Mat::<T>::zeros(own + coupled, own + coupled);
        self.enter_matrix(front, &mut full);
        for (&child, update) in front.children.iter().zip(below) {
            self.add_update(front, &self.dissection.fronts[child], &update, &mut full);
        }
        let (mut f11, f12, mut f21, mut f22) = full.as_mut().split_at_mut(own, own);
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
        let mut upper = Mat::from_fn(own, coupled, |k, column| f12[(row[k], column)]);
        solve_unit_lower_triangular_in_place(f11.rb(), upper.as_mut(), SEQUENTIAL);
        solve_lower_triangular_in_place(f11.rb().transpose(), f21.rb_mut().transpose_mut(), SEQUENTIAL);
        matmul(
            f22.rb_mut(),
            Accum::Add,
            f21.rb(),
            upper.as_ref(),
            T::from_complex((-1.0).into()),
            SEQUENTIAL,
        );
        let factor = Factor { lu: f11.to_owned(), row, upper, lower: f21.to_owned() };
        let update = f22.to_owned();
        // Each front is met once, so the cell is empty.
        let _ = self.factors[index].set(factor);
        Ok(update)
    }

    fn factorise_all(&self, fronts: &[usize]) -> Result<Vec<Mat<T>>, Error> {
        match fronts {
            &[first, second] => {
                let (a, b) = rayon::join(|| self.factorise(first), || self.factorise(second));
                Ok(vec![a?, b?])
            }
            all => all.iter().map(|&front| self.factorise(front)).collect(),
        }
    }

    /// The entries of the matrix that are eliminated in this front.
    fn enter_matrix(&self, front: &Front, full: &mut Mat<T>) {
        let Dissection { order, position, .. } = self.dissection;
        let real = |x: f64| T::from_complex(x.into());
        for own in 0..front.own {
            let node = order[front.first + own] as usize;
            for (other, b) in self.matrix.row(node) {
                if let Some(at) = front.local(position[other]) {
                    for (k, entry) in b.iter().enumerate() {
                        let place = (2 * own + k / 2, 2 * at + k % 2);
                        full[place] += real(*entry);
                    }
                }
            }
            for (other, b) in self.transposed.row(node) {
                if let Some(at) = front.local(position[other]).filter(|&at| at >= front.own) {
                    for (k, entry) in b.iter().enumerate() {
                        let place = (2 * at + k % 2, 2 * own + k / 2);
                        full[place] += real(*entry);
                    }
                }
            }
            for k in 2 * own..2 * own + 2 {
                full[(k, k)] -= self.shift;
            }
        }
    }

    fn add_update(&self, front: &Front, child: &Front, update: &Mat<T>, full: &mut Mat<T>) {
        let places: Vec<usize> = child
            .boundary
            .iter()
            .filter_map(|&position| front.local(position))
            .flat_map(|at| [2 * at, 2 * at + 1])
            .collect();
        for (column, &to_column) in places.iter().enumerate() {
            for (row, &to_row) in places.iter().enumerate() {
                full[(to_row, to_column)] += update[(row, column)];
            }
        }
    }
}

impl Front {
    fn rows_of_boundary(&self) -> impl Iterator<Item = usize> {
        self.boundary.iter().flat_map(|&position| [2 * position as usize, 2 * position as usize + 1])
    }

    /// Forward substitution: solves for its own rows and takes them out of those of the boundary.
    fn eliminate<T: Number>(&self, factor: &Factor<T>, side: Side, mut x: MatMut<'_, T>) {
        let count = x.ncols();
        let mut own = x.rb_mut().subrows_mut(2 * self.first, 2 * self.own);
        match side {
            Side::AsGiven => {
                let permuted = Mat::from_fn(own.nrows(), count, |k, column| own[(factor.row[k], column)]);
                own.copy_from(&permuted);
                solve_unit_lower_triangular_in_place(factor.lu.as_ref(), own.rb_mut(), SEQUENTIAL);
            }
            Side::Transposed => {
                solve_lower_triangular_in_place(factor.lu.transpose(), own.rb_mut(), SEQUENTIAL);
            }
        }
        let coupling = match side {
            Side::AsGiven => factor.lower.as_ref(),
            Side::Transposed => factor.upper.transpose(),
        };
        let mut taken = Mat::zeros(2 * self.boundary.len(), count);
        let one = T::from_complex(1.0.into());
        matmul(taken.as_mut(), Accum::Replace, coupling.as_dyn_stride(), own.rb(), one, SEQUENTIAL);
        for (k, row) in self.rows_of_boundary().enumerate() {
            for column in 0..count {
                x[(row, column)] -= taken[(k, column)];
            }
        }
    }

    /// Backward substitution: the rows of the boundary are known.
    fn substitute<T: Number>(&self, factor: &Factor<T>, side: Side, mut x: MatMut<'_, T>) {
        let count = x.ncols();
        let mut known = Mat::zeros(2 * self.boundary.len(), count);
        for (k, row) in self.rows_of_boundary().enumerate() {
            for column in 0..count {
                known[(k, column)] = x[(row, column)];
            }
        }
        let coupling = match side {
            Side::AsGiven => factor.upper.as_ref(),
            Side::Transposed => factor.lower.transpose(),
        };
        let mut own = x.rb_mut().subrows_mut(2 * self.first, 2 * self.own);
        let minus = T::from_complex((-1.0).into());
        matmul(own.rb_mut(), Accum::Add, coupling.as_dyn_stride(), known.as_ref(), minus, SEQUENTIAL);
        match side {
            Side::AsGiven => solve_upper_triangular_in_place(factor.lu.as_ref(), own.rb_mut(), SEQUENTIAL),
            Side::Transposed => {
                solve_unit_upper_triangular_in_place(factor.lu.transpose(), own.rb_mut(), SEQUENTIAL);
                let solved = own.to_owned();
                for (k, &row) in factor.row.iter().enumerate() {
                    for column in 0..count {
                        own[(row, column)] = solved[(k, column)];
                    }
                }
            }
        }
    }
}
