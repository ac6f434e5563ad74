//! Sparse Cholesky factorisation by fronts (multifrontal, nested dissection).
//!
//! With the columns C of the own unknowns of a front and the rows R of those to which they couple
//!
//! ```text
//! F_CC = L_CC L_CCᵀ        L_RC = F_RC L_CC⁻ᵀ        F_RR − L_RC L_RCᵀ  goes to the next front
//! ```
//!
//! so that all work is on dense matrices. Fronts on the two sides of a separator do not know of each other and are made at the same time; what they
//! leave is added in their order, so results do not depend on threads.

use crate::fronts::Fronts;
use crate::room::Room;
use crate::symmetric_matrix::Places;
use crate::{Error, SelectedInverse, SymmetricMatrix};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, Par};
use std::sync::Arc;

/// Multiplications from which on a product is shared out, and other work, and to how many: the same for any number of threads, so that results
/// are.
const SHARED: usize = 100_000_000;
const DEAR: usize = 1_000_000_000;
const TASKS: usize = 2;

/// Multiplications below which fronts side by side are one thread's work.
const SMALL: usize = 2_000_000;

/// Entries from which on several factors at once would take much memory.
const LARGE: usize = 40_000_000;

/// How many times as large as the median the largest entry of a diagonal may be beside which nothing is lost.
const UNEVEN: f64 = 1e10;

/// Share of an entry of the diagonal that is more than its rounding.
const RAISE: f64 = 1e-11;

/// How a product of so many multiplications is shared out.
pub(crate) fn shared(work: usize) -> Par {
    if work >= SHARED { Par::rayon(TASKS) } else { Par::Seq }
}

/// The same for what shares out worse.
fn shared_if_dear(work: usize) -> Par {
    if work >= DEAR { Par::rayon(TASKS) } else { Par::Seq }
}

/// The order of elimination for a sparsity pattern: reusable for matrices that differ in their values only.
#[derive(Debug, Clone)]
pub struct DissectedPattern {
    fronts: Arc<Fronts>,
    /// Where the matrix has entries.
    entries: Arc<Places>,
}

impl DissectedPattern {
    /// Analyses the pattern of a matrix whose unknowns belong, in groups of one size that follow each other, to places in the plane or
    /// in space and time; those of a place that is `None` are coupled to all. The order is that of nested dissection by planes.
    ///
    /// # Errors
    /// [`Error::Malformed`] if unknowns cannot be shared out evenly, or the unknowns of two places are not coupled all to all.
    pub fn new(matrix: &SymmetricMatrix, places: &[Option<[f64; 3]>]) -> Result<Self, Error> {
        let order = matrix.order();
        if places.is_empty() || !order.is_multiple_of(places.len()) {
            return Err(Error::Malformed("places and unknowns do not fit together"));
        }
        let group = order / places.len();
        if !matrix.is_of_blocks(group) {
            return Err(Error::Malformed("the unknowns of two places are not coupled all to all"));
        }
        Ok(Self { fronts: Arc::new(Fronts::new(matrix, places, group)), entries: matrix.shared_places() })
    }

    /// Whether a matrix has this pattern.
    pub fn is_of(&self, matrix: &SymmetricMatrix) -> bool {
        matrix.is_at(&self.entries)
    }

    /// Entries of the matrix.
    pub(crate) fn matrix_entries(&self) -> usize {
        self.entries.count()
    }

    /// Whether factors are so large that several at once would take much memory.
    pub fn is_large(&self) -> bool {
        self.fronts.entries() >= LARGE
    }

    /// Factorises a matrix of this pattern.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`], [`Error::OutOfMemory`]; [`Error::Malformed`] if it has another pattern.
    pub fn factor(&self, matrix: &SymmetricMatrix) -> Result<DissectedCholesky, Error> {
        if !self.is_of(matrix) {
            return Err(Error::Malformed(
                "a matrix has another pattern than the order of elimination is for",
            ));
        }
        let mut values =
            Room::new(self.fronts.entries()).ok_or(Error::OutOfMemory { order: matrix.order() })?;
        let job = Job { fronts: &self.fronts, matrix };
        job.all(self.fronts.roots(), &mut values)?;
        Ok(DissectedCholesky { fronts: Arc::clone(&self.fronts), values })
    }

    /// The same of a matrix some of whose diagonal entries may be so much larger than most that others are lost in rounding beside them: entries of the
    /// diagonal are then raised by more than their rounding.
    ///
    /// # Errors
    /// Those of [`factor`](Self::factor).
    pub fn factor_raised(&self, matrix: &mut SymmetricMatrix) -> Result<DissectedCholesky, Error> {
        match self.factor(matrix) {
            Err(Error::NotPositiveDefinite) if is_uneven(matrix.diagonal().collect()) => {
                let raised: Vec<f64> = matrix.diagonal().map(|entry| RAISE * entry).collect();
                matrix.add_to_diagonal(raised);
                self.factor(matrix)
            }
            done => done,
        }
    }
}

/// Whether the largest entry of a diagonal is far from the median.
fn is_uneven(mut diagonal: Vec<f64>) -> bool {
    diagonal.sort_unstable_by(f64::total_cmp);
    diagonal.last().is_some_and(|largest| *largest > UNEVEN * diagonal[diagonal.len() / 2])
}

/// A factorised matrix `P A Pᵀ = L Lᵀ`, P a permutation by nested dissection.
#[derive(Debug, Clone)]
pub struct DissectedCholesky {
    fronts: Arc<Fronts>,
    /// Columns of L, one front after the other.
    values: Room,
}

/// A factorisation at work.
struct Job<'a> {
    fronts: &'a Fronts,
    matrix: &'a SymmetricMatrix,
}

/// What a front leaves to the next: a square matrix by columns, of which the lower triangle counts.
type Update = Room;

impl Job<'_> {
    /// Some fronts side by side, with all below, in their part of a factor.
    fn all(&self, fronts: &[usize], values: &mut [f64]) -> Result<Vec<Update>, Error> {
        if let [one] = fronts {
            return Ok(vec![self.one(*one, values)?]);
        }
        let (some, others) = fronts.split_at(fronts.len() / 2);
        if others.is_empty() {
            return Ok(Vec::new());
        }
        let sum = |own: &[usize], of: &dyn Fn(usize) -> usize| own.iter().map(|index| of(*index)).sum();
        let (here, there) = values.split_at_mut(sum(some, &|index| self.fronts.entries_below(index)));
        let work = |own: &[usize]| -> usize { sum(own, &|index| self.fronts.work(index)) };
        let (a, b) = match work(some).min(work(others)) < SMALL {
            true => (self.all(some, here), self.all(others, there)),
            false => rayon::join(|| self.all(some, here), || self.all(others, there)),
        };
        let mut updates = a?;
        updates.extend(b?);
        Ok(updates)
    }

    /// A front with all below it.
    fn one(&self, index: usize, values: &mut [f64]) -> Result<Update, Error> {
        let (own, all) = self.fronts.sizes(index);
        let (children, coupled) = (self.fronts.children(index), all - own);
        let (below, columns) = values.split_at_mut(values.len() - own * all);
        let updates = self.all(children, below)?;
        self.fronts.fill(index, self.matrix, columns);
        let out_of_memory = Error::OutOfMemory { order: self.fronts.order() };
        let mut left = Room::new(coupled * coupled).ok_or(out_of_memory)?;
        if !children.is_empty() {
            let columns = left.chunks_exact_mut(coupled.max(1)).enumerate();
            columns.for_each(|(k, column)| column[k..].fill(0.0));
        }
        for (child, update) in children.iter().zip(updates) {
            self.add(*child, &update, (columns, all), (&mut left, own));
        }
        let columns = MatMut::from_column_major_slice_mut(columns, all, own);
        let (mut diagonal, mut further) = columns.split_at_row_mut(own);
        let tasks = shared_if_dear(own * own * own / 3);
        let room = cholesky_in_place_scratch::<f64>(own, tasks, Default::default());
        cholesky_in_place(
            diagonal.rb_mut(),
            Default::default(),
            tasks,
            MemStack::new(&mut MemBuffer::new(room)),
            Default::default(),
        )
        .map_err(|_| Error::NotPositiveDefinite)?;
        let tasks = shared_if_dear(own * own * coupled);
        solve_lower_triangular_in_place(diagonal.rb(), further.rb_mut().transpose_mut(), tasks);
        triangular::matmul(
            MatMut::from_column_major_slice_mut(&mut left, coupled, coupled),
            BlockStructure::TriangularLower,
            if children.is_empty() { Accum::Replace } else { Accum::Add },
            further.rb(),
            BlockStructure::Rectangular,
            further.rb().transpose(),
            BlockStructure::Rectangular,
            -1.0,
            shared(own * coupled * coupled),
        );
        Ok(left)
    }

    /// Adds what a front leaves to the next one: to its columns, of some height, and to what that leaves behind so many own unknowns.
    fn add(
        &self,
        child: usize,
        update: &Update,
        (columns, height): (&mut [f64], usize),
        (left, own): (&mut [f64], usize),
    ) {
        let places = self.fronts.lifted(child);
        for (j, from) in update.chunks_exact(places.len().max(1)).enumerate() {
            let (to, offset) = match places[j].checked_sub(own) {
                None => (&mut columns[places[j] * height..][..height], 0),
                Some(column) => (&mut left[column * (height - own)..][..height - own], own),
            };
            for (value, row) in from[j..].iter().zip(&places[j..]) {
                to[row - offset] += value;
            }
        }
    }
}

impl DissectedCholesky {
    /// Replaces right-hand sides by solutions: one or several vectors of the matrix' order, one after the other.
    pub fn solve(&self, right_hand_sides: &mut [f64]) {
        self.with_permuted(right_hand_sides, |x| {
            self.eliminate(x);
            self.substitute_back(x);
        });
    }

    /// Replaces independent random numbers of unit variance by such of the covariance A⁻¹, `Pᵀ L⁻ᵀ z`: one or several vectors of the matrix'
    /// order, one after the other.
    pub fn draw(&self, independent: &mut [f64]) {
        self.with_permuted(independent, |x| self.substitute_back(x));
    }

    /// Changes vectors whose entries are in the order of elimination, a column each.
    fn with_permuted(&self, vectors: &mut [f64], change: impl FnOnce(&mut Mat<f64>)) {
        let order = self.fronts.order();
        let count = vectors.len() / order.max(1);
        let places: Vec<usize> = self.fronts.unknowns().collect();
        let mut x = Mat::from_fn(order, count, |row, column| vectors[column * order + places[row]]);
        change(&mut x);
        for (column, out) in vectors.chunks_exact_mut(order.max(1)).enumerate() {
            x.col_as_slice(column).iter().zip(&places).for_each(|(x, place)| out[*place] = *x);
        }
    }

    /// L⁻¹x
    fn eliminate(&self, x: &mut Mat<f64>) {
        let fronts = &*self.fronts;
        for index in 0..fronts.count() {
            let own = fronts.own(index);
            let (diagonal, further) = fronts.columns(index, &self.values).split_at_row(own.len());
            let mut solved = x.as_mut().subrows_mut(own.start, own.len());
            solve_lower_triangular_in_place(diagonal, solved.rb_mut(), Par::Seq);
            let mut taken = Mat::<f64>::zeros(further.nrows(), solved.ncols());
            matmul(taken.as_mut(), Accum::Replace, further, solved.rb(), 1.0, Par::Seq);
            for column in 0..x.ncols() {
                let (taken, x) = (taken.col_as_slice(column), x.col_as_slice_mut(column));
                fronts.coupled(index).zip(taken).for_each(|(row, taken)| x[row] -= taken);
            }
        }
    }

    /// L⁻ᵀx
    fn substitute_back(&self, x: &mut Mat<f64>) {
        let fronts = &*self.fronts;
        for index in (0..fronts.count()).rev() {
            let own = fronts.own(index);
            let (diagonal, further) = fronts.columns(index, &self.values).split_at_row(own.len());
            let mut known = Mat::<f64>::zeros(further.nrows(), x.ncols());
            for column in 0..x.ncols() {
                let (known, x) = (known.col_as_slice_mut(column), x.col_as_slice(column));
                fronts.coupled(index).zip(known).for_each(|(row, known)| *known = x[row]);
            }
            let mut solved = x.as_mut().subrows_mut(own.start, own.len());
            matmul(solved.rb_mut(), Accum::Add, further.transpose(), known.as_ref(), -1.0, Par::Seq);
            solve_upper_triangular_in_place(diagonal.transpose(), solved, Par::Seq);
        }
    }

    /// `log det A = 2 Σ log L_ii`: the determinant itself may be far outside the range of `f64`.
    pub fn log_determinant(&self) -> f64 {
        let of_front = |index: usize| {
            let columns = self.fronts.columns(index, &self.values);
            (0..columns.ncols()).map(|k| columns[(k, k)].ln()).sum::<f64>()
        };
        2.0 * (0..self.fronts.count()).map(of_front).sum::<f64>()
    }

    /// The inverse of the matrix where the factor has entries.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn selected_inverse(&self) -> Result<SelectedInverse, Error> {
        SelectedInverse::new(Arc::clone(&self.fronts), &self.values)
    }
}
