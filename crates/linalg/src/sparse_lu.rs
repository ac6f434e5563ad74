//! Sparse LU factorisation of `A − σ 1` by fronts (multifrontal, nested dissection).

use crate::block_sparse::Columns;
use crate::dissection::{Dissection, Front, Place};
use crate::front_factor::{Factor, FrontMatrix, Side};
use crate::graph::Graph;
use crate::number::Number;
use crate::{BlockSparse, Error};
use faer::Mat;
use num_complex::Complex64;
use std::sync::OnceLock;

/// Nodes of a front up to which what is below it is factorised side by side; above, the columns of each front are enough work for several threads.
const SIDE_BY_SIDE: usize = 1000;

/// `A − σ 1` factorised. Pivots are chosen within fronts.
pub(crate) struct SparseLu<T: Number> {
    dissection: Dissection,
    factors: Vec<OnceLock<Factor<T>>>,
}

impl<T: Number> SparseLu<T> {
    /// Factorises; `places` are the places of the block rows in the plane, by which the matrix is dissected.
    pub fn new(matrix: &BlockSparse, shift: Complex64, places: &[[f64; 2]]) -> Result<Self, Error> {
        if places.len() != matrix.rows() {
            return Err(Error::Malformed("one place is needed for each block row"));
        }
        let columns = matrix.columns();
        let places: Vec<Place> = places.iter().map(|&[x, y]| Some([x, y, 0.0])).collect();
        let dissection = Dissection::new(&Graph::of_blocks(matrix, &columns), &places);
        let factors: Vec<_> = dissection.fronts.iter().map(|_| OnceLock::new()).collect();
        let job = Job {
            matrix,
            columns: &columns,
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
            factor.eliminate(front, side, x.as_mut());
        }
        for (front, factor) in self.steps().rev() {
            factor.substitute(front, side, x.as_mut());
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
    columns: &'a Columns,
    shift: T,
    dissection: &'a Dissection,
    factors: &'a [OnceLock<Factor<T>>],
}

impl<T: Number> Job<'_, T> {
    /// Factorises a front and all below it; what it leaves for its boundary.
    fn factorise(&self, index: usize) -> Result<Mat<T>, Error> {
        let front = &self.dissection.fronts[index];
        let below = self.factorise_below(front)?;
        let mut full = FrontMatrix::<T>::zeros(2 * front.own, 2 * front.boundary.len());
        self.enter_matrix(front, &mut full);
        for (&child, update) in front.children.iter().zip(below) {
            self.add_update(front, &self.dissection.fronts[child], &update, &mut full);
        }
        let (factor, rest) = full.factorise(front.children.is_empty())?;
        // Each front is met once, so the cell is empty.
        let _ = self.factors[index].set(factor);
        Ok(rest)
    }

    /// Factorises what is below a front, side by side if that takes little memory.
    fn factorise_below(&self, front: &Front) -> Result<Vec<Mat<T>>, Error> {
        match *front.children {
            [first, second] if front.own + front.boundary.len() <= SIDE_BY_SIDE => {
                let (a, b) = rayon::join(|| self.factorise(first), || self.factorise(second));
                Ok(vec![a?, b?])
            }
            _ => front.children.iter().map(|&child| self.factorise(child)).collect(),
        }
    }

    /// The entries of the matrix that are eliminated in this front.
    fn enter_matrix(&self, front: &Front, full: &mut FrontMatrix<T>) {
        let Dissection { order, position, .. } = self.dissection;
        let real = |x: f64| T::from_complex(x.into());
        for own in 0..front.own {
            let node = order[front.first + own] as usize;
            for (other, b) in self.matrix.row(node) {
                if let Some(at) = front.local(position[other]) {
                    for (k, entry) in b.iter().enumerate() {
                        *full.entry(2 * own + k / 2, 2 * at + k % 2) += real(*entry);
                    }
                }
            }
            for (other, b) in self.columns.of(self.matrix, node) {
                if let Some(at) = front.local(position[other]).filter(|&at| at >= front.own) {
                    for (k, entry) in b.iter().enumerate() {
                        *full.entry(2 * at + k / 2, 2 * own + k % 2) += real(*entry);
                    }
                }
            }
            for k in 2 * own..2 * own + 2 {
                *full.entry(k, k) -= self.shift;
            }
        }
    }

    fn add_update(&self, front: &Front, child: &Front, update: &Mat<T>, full: &mut FrontMatrix<T>) {
        let places: Vec<usize> = child
            .boundary
            .iter()
            .filter_map(|&position| front.local(position))
            .flat_map(|at| [2 * at, 2 * at + 1])
            .collect();
        for (column, &to_column) in places.iter().enumerate() {
            for (row, &to_row) in places.iter().enumerate() {
                *full.entry(to_row, to_column) += update[(row, column)];
            }
        }
    }
}
