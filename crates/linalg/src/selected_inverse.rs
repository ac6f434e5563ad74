//! Entries of the inverse of a sparse symmetric matrix where its Cholesky factor has entries.
//!
//! With the columns C of a front, the rows R of those behind to which they couple, and `Y = L_RC L_CC⁻¹`,
//!
//! ```text
//! Z_RC = −Z_RR Y        Z_CC = (L_CC L_CCᵀ)⁻¹ + Yᵀ Z_RR Y
//! ```
//!
//! (Takahashi, Fagan, Chen 1973). All entries of Z_RR belong to the next front, so from the last front to the first this takes about
//! three times the work of the factor, for all entries together.

use crate::Error;
use crate::dissected_cholesky::shared;
use crate::fronts::Fronts;
use crate::room::Room;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, Mat};
use std::sync::Arc;

/// The entries, in the arrangement of the factor.
#[derive(Debug, Clone)]
pub struct SelectedInverse {
    fronts: Arc<Fronts>,
    values: Room,
}

impl SelectedInverse {
    pub(crate) fn new(fronts: Arc<Fronts>, factor: &[f64]) -> Result<Self, Error> {
        let out_of_memory = Error::OutOfMemory { order: fronts.order() };
        let mut values = Room::new(fronts.entries()).ok_or(out_of_memory)?;
        Job { fronts: &fronts, factor }.all(fronts.roots(), &Mat::new(), &mut values);
        Ok(Self { fronts, values })
    }

    /// An entry of the inverse; `None` where the factor has none.
    pub fn entry(&self, i: usize, j: usize) -> Option<f64> {
        self.fronts.entry_index(i, j).map(|place| self.values[place])
    }
}

/// An inversion at work.
struct Job<'a> {
    fronts: &'a Fronts,
    factor: &'a [f64],
}

impl Job<'_> {
    /// Some fronts side by side, with all below, in their part of the inverse; that among all unknowns of the next front is known.
    fn all(&self, fronts: &[usize], next: &Mat<f64>, values: &mut [f64]) {
        if let [one] = fronts {
            return self.one(*one, next, values);
        }
        let (some, others) = fronts.split_at(fronts.len() / 2);
        if others.is_empty() {
            return;
        }
        let own = some.iter().map(|index| self.fronts.entries_below(*index)).sum();
        let (here, there) = values.split_at_mut(own);
        rayon::join(|| self.all(some, next, here), || self.all(others, next, there));
    }

    /// A front, then all below it.
    fn one(&self, index: usize, next: &Mat<f64>, values: &mut [f64]) {
        let (own, all) = self.fronts.sizes(index);
        let tasks = shared(own * all * all);
        let (below, columns) = values.split_at_mut(values.len() - own * all);
        let (diagonal, further) = self.fronts.columns(index, self.factor).split_at_row(own);
        let mut y = further.to_owned();
        solve_upper_triangular_in_place(diagonal.transpose(), y.transpose_mut(), tasks);
        let places = self.fronts.lifted(index);
        let mut full = Mat::<f64>::zeros(all, all);
        for (j, from) in places.iter().enumerate() {
            let from = next.col_as_slice(*from);
            let to = &mut full.col_as_slice_mut(own + j)[own..];
            to.iter_mut().zip(&places).for_each(|(to, place)| *to = from[*place]);
        }
        let (mut z_cc, mut z_cr, mut z_rc, z_rr) = full.as_mut().split_at_mut(own, own);
        matmul(z_rc.rb_mut(), Accum::Replace, z_rr.rb(), y.as_ref(), -1.0, tasks);
        z_cr.copy_from(z_rc.rb().transpose());
        let mut root = Mat::<f64>::identity(own, own);
        solve_lower_triangular_in_place(diagonal, root.as_mut(), tasks);
        matmul(z_cc.rb_mut(), Accum::Replace, root.transpose(), root.as_ref(), 1.0, tasks);
        matmul(z_cc, Accum::Add, y.transpose(), z_rc.rb(), -1.0, tasks);
        for (j, to) in columns.chunks_exact_mut(all.max(1)).enumerate() {
            to.copy_from_slice(full.col_as_slice(j));
        }
        self.all(self.fronts.children(index), &full, below);
    }
}
