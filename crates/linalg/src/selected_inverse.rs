//! Entries of the inverse of a sparse symmetric matrix where its Cholesky factor has entries.
//!
//! With the columns C of a dense block of the factor, the rows R below them, and `Y = L_RC L_CC⁻¹`,
//!
//! ```text
//! Z_RC = −Z_RR Y        Z_CC = (L_CC L_CCᵀ)⁻¹ + Yᵀ Z_RR Y
//! ```
//!
//! (Takahashi, Fagan, Chen 1973). All entries of Z_RR belong to blocks further on, so from the last block to the first this takes about
//! three times the work of the factor, for all entries together.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::sparse::linalg::cholesky::supernodal::{SupernodalLltRef, SymbolicSupernodalCholesky};
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use faer::{Accum, Mat, MatRef, Par};
use std::sync::Arc;

/// The entries, in the arrangement of the factor; blocks on the diagonal are full.
#[derive(Debug, Clone)]
pub struct SelectedInverse {
    symbolic: Arc<SymbolicCholesky<usize>>,
    /// The dense block of each column.
    block: Vec<u32>,
    values: Vec<f64>,
}

impl SelectedInverse {
    /// Of a factor in dense blocks; `None` if it is not in that form.
    pub(crate) fn new(symbolic: &Arc<SymbolicCholesky<usize>>, factor: &[f64]) -> Option<Self> {
        let SymbolicCholeskyRaw::Supernodal(blocks) = symbolic.raw() else { return None };
        let count = blocks.n_supernodes();
        let mut block = Vec::with_capacity(blocks.nrows());
        for k in 0..count {
            block.resize(blocks.supernode_end()[k], k as u32);
        }
        let mut inverse = Self { symbolic: Arc::clone(symbolic), block, values: vec![0.0; blocks.len_val()] };
        let factor = SupernodalLltRef::new(blocks, factor);
        for k in (0..count).rev() {
            inverse.fill(blocks, k, factor.supernode(k).val());
        }
        Some(inverse)
    }

    /// The entries of one block, those further on known.
    fn fill(&mut self, blocks: &SymbolicSupernodalCholesky<usize>, k: usize, factor: MatRef<'_, f64>) {
        let (below, columns) = (blocks.supernode(k).pattern(), factor.ncols());
        let (diagonal, rest) = factor.split_at_row(columns);
        let mut y = rest.to_owned();
        solve_upper_triangular_in_place(diagonal.transpose(), y.transpose_mut(), Par::Seq);
        let further = self.among(blocks, below);
        let mut spread = Mat::<f64>::zeros(below.len(), columns);
        matmul(spread.as_mut(), Accum::Replace, further.as_ref(), y.as_ref(), 1.0, Par::Seq);
        let mut root = Mat::<f64>::identity(columns, columns);
        solve_lower_triangular_in_place(diagonal, root.as_mut(), Par::Seq);
        let mut own = Mat::<f64>::zeros(columns, columns);
        matmul(own.as_mut(), Accum::Replace, root.transpose(), root.as_ref(), 1.0, Par::Seq);
        matmul(own.as_mut(), Accum::Add, y.transpose(), spread.as_ref(), 1.0, Par::Seq);
        let rows = columns + below.len();
        let values = &mut self.values[blocks.col_ptr_for_val()[k]..][..rows * columns];
        for (j, column) in values.chunks_exact_mut(rows).enumerate() {
            let (upper, lower) = column.split_at_mut(columns);
            upper.iter_mut().enumerate().for_each(|(i, z)| *z = own[(i, j)]);
            lower.iter_mut().enumerate().for_each(|(i, z)| *z = -spread[(i, j)]);
        }
    }

    /// The inverse among some rows, which are those below one block.
    fn among(&self, blocks: &SymbolicSupernodalCholesky<usize>, rows: &[usize]) -> Mat<f64> {
        let mut inverse = Mat::<f64>::zeros(rows.len(), rows.len());
        let mut places = vec![0; rows.len()];
        let mut first = 0;
        while first < rows.len() {
            let k = self.block[rows[first]] as usize;
            let (begin, end) = (blocks.supernode_begin()[k], blocks.supernode_end()[k]);
            let (columns, below) = (end - begin, blocks.supernode(k).pattern());
            let height = columns + below.len();
            let own = rows[first..].partition_point(|row| *row < end) + first;
            // Rows and those below a block ascend both.
            let mut next = 0;
            for (place, row) in places[first..].iter_mut().zip(&rows[first..]) {
                *place = match *row < end {
                    true => row - begin,
                    false => {
                        next += below[next..].partition_point(|other| other < row);
                        columns + next
                    }
                };
            }
            let values = &self.values[blocks.col_ptr_for_val()[k]..][..height * columns];
            for j in first..own {
                let column = &values[(rows[j] - begin) * height..][..height];
                for i in j..rows.len() {
                    inverse[(i, j)] = column[places[i]];
                    inverse[(j, i)] = column[places[i]];
                }
            }
            first = own;
        }
        inverse
    }

    /// An entry of the inverse; `None` where the factor has none.
    pub fn entry(&self, i: usize, j: usize) -> Option<f64> {
        let SymbolicCholeskyRaw::Supernodal(blocks) = self.symbolic.raw() else { return None };
        let place = |unknown: usize| self.symbolic.perm().map_or(unknown, |perm| perm.arrays().1[unknown]);
        let (i, j) = (place(i), place(j));
        let (row, column) = (i.max(j), i.min(j));
        let k = self.block[column] as usize;
        let (begin, end) = (blocks.supernode_begin()[k], blocks.supernode_end()[k]);
        let below = blocks.supernode(k).pattern();
        let place = match row < end {
            true => row - begin,
            false => end - begin + below.binary_search(&row).ok()?,
        };
        let height = end - begin + below.len();
        Some(self.values[blocks.col_ptr_for_val()[k] + (column - begin) * height + place])
    }
}

#[cfg(test)]
mod tests {
    use crate::{CholeskyPattern, SymmetricMatrix};
    use faer::sparse::linalg::SupernodalThreshold;
    use faer::sparse::linalg::cholesky::SymmetricOrdering;

    /// Every entry that there is, against solutions for unit vectors; on a grid whose factor has blocks of many sizes.
    #[test]
    fn entries_are_those_of_the_inverse() {
        let side = 40;
        let n = side * side;
        let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n {
            row.push(i);
            value.push(8.3 + (i as f64).sin());
            let (x, y) = (i % side, i / side);
            // All within two steps of the king.
            let near = (0..=2_i64).flat_map(|up| (-2..=2_i64).map(move |right| (up, right)));
            for (up, right) in near.filter(|(up, right)| (*up, *right) > (0, 0)) {
                let (to_x, to_y) = (x as i64 + right, y as i64 + up);
                if (0..side as i64).contains(&to_x) && to_y < side as i64 {
                    row.push((to_y * side as i64 + to_x) as usize);
                    value.push(-0.3 - 0.05 * (i as f64).cos());
                }
            }
            start.push(row.len());
        }
        let matrix = SymmetricMatrix::new(start, row, value).unwrap();
        let form = |threshold| CholeskyPattern::with_threshold(&matrix, threshold, SymmetricOrdering::Amd);
        let factor = form(SupernodalThreshold::FORCE_SUPERNODAL).unwrap().factor(&matrix).unwrap();
        let inverse = factor.selected_inverse().unwrap();
        let mut known = 0;
        for j in (0..n).step_by(37) {
            let mut column = vec![0.0; n];
            column[j] = 1.0;
            factor.solve(&mut column);
            assert!(inverse.entry(j, j).is_some());
            for (i, exact) in column.iter().enumerate() {
                let Some(entry) = inverse.entry(i, j) else { continue };
                known += 1;
                assert_eq!(inverse.entry(j, i), Some(entry));
                assert!((entry - exact).abs() < 1e-13, "{i} {j}: {entry} {exact}");
            }
        }
        assert!(known > 25 * n / 37, "{known}");
        let other = form(SupernodalThreshold::FORCE_SIMPLICIAL).unwrap().factor(&matrix).unwrap();
        assert!(other.selected_inverse().is_none());
        let (column_start, rows) = matrix.places();
        let all =
            (0..n).flat_map(|j| rows[column_start[j]..column_start[j + 1]].iter().map(move |i| (*i, j)));
        assert!(all.clone().all(|(i, j)| inverse.entry(i, j).is_some()));
    }
}
