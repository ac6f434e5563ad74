//! The product of a sparse matrix of blocks with its transpose.

use crate::Error;
use rayon::prelude::*;
use voronudge_linalg::SymmetricMatrix;
use voronudge_model::BlockMatrix;

/// Block columns per task.
const CHUNK: usize = 256;

/// `JᵀJ` over some of the rows of J, lower triangle with the whole diagonal; J has a block column for each cell.
pub(crate) fn gram(
    jacobian: &BlockMatrix,
    rows: impl Iterator<Item = usize> + Clone,
    cells: usize,
) -> Result<SymmetricMatrix, Error> {
    let transposed = Transposed::new(jacobian, rows, cells);
    type Part = (Vec<usize>, Vec<usize>, Vec<f64>);
    let parts: Vec<Part> = (0..cells.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let (mut lengths, mut rows, mut values) = (Vec::new(), Vec::new(), Vec::new());
            let mut place = vec![usize::MAX; cells];
            let mut entries: Vec<(usize, [f64; 4])> = Vec::new();
            for column in chunk * CHUNK..((chunk + 1) * CHUNK).min(cells) {
                entries.push((column, [0.0; 4]));
                place[column] = 0;
                for &(row, at) in transposed.column(column) {
                    let own = &jacobian.block[at];
                    for (other, b) in jacobian.row(row).filter(|(other, _)| *other >= column) {
                        // bᵀ · own
                        let product = [
                            b[0] * own[0] + b[2] * own[2],
                            b[0] * own[1] + b[2] * own[3],
                            b[1] * own[0] + b[3] * own[2],
                            b[1] * own[1] + b[3] * own[3],
                        ];
                        if place[other] == usize::MAX {
                            place[other] = entries.len();
                            entries.push((other, product));
                        } else {
                            let sum = &mut entries[place[other]].1;
                            sum.iter_mut().zip(product).for_each(|(s, x)| *s += x);
                        }
                    }
                }
                entries.iter().for_each(|(other, _)| place[*other] = usize::MAX);
                entries.sort_unstable_by_key(|entry| entry.0);
                for axis in 0..2 {
                    let first = rows.len();
                    for (other, block) in &entries {
                        for component in 0..2 {
                            if 2 * other + component >= 2 * column + axis {
                                rows.push(2 * other + component);
                                values.push(block[2 * component + axis]);
                            }
                        }
                    }
                    lengths.push(rows.len() - first);
                }
                entries.clear();
            }
            (lengths, rows, values)
        })
        .collect();
    let mut column_start = Vec::with_capacity(2 * cells + 1);
    column_start.push(0);
    let (mut rows, mut values, mut end) = (Vec::new(), Vec::new(), 0);
    for (part_lengths, part_rows, part_values) in parts {
        column_start.extend(part_lengths.iter().map(|length| {
            end += length;
            end
        }));
        rows.extend(part_rows);
        values.extend(part_values);
    }
    Ok(SymmetricMatrix::new(column_start, rows, values)?)
}

/// Where each block column has entries: row and index of the block.
struct Transposed {
    start: Vec<usize>,
    entry: Vec<(usize, usize)>,
}

impl Transposed {
    fn new(matrix: &BlockMatrix, rows: impl Iterator<Item = usize> + Clone, columns: usize) -> Self {
        let mut start = vec![0; columns + 1];
        for row in rows.clone() {
            for (column, _) in matrix.row(row) {
                start[column + 1] += 1;
            }
        }
        for column in 0..columns {
            start[column + 1] += start[column];
        }
        let (mut next, mut entry) = (start.clone(), vec![(0, 0); start[columns]]);
        for row in rows {
            for (at, (column, _)) in (matrix.row_start[row]..).zip(matrix.row(row)) {
                entry[next[column]] = (row, at);
                next[column] += 1;
            }
        }
        Self { start, entry }
    }

    fn column(&self, column: usize) -> &[(usize, usize)] {
        &self.entry[self.start[column]..self.start[column + 1]]
    }
}
