//! Products of sparse matrices of blocks with their transposes.

use crate::Error;
use rayon::prelude::*;
use std::ops::Range;
use voronudge_linalg::SymmetricMatrix;
use voronudge_model::BlockMatrix;

/// Block columns per task.
const CHUNK: usize = 256;

/// No number.
const NONE: u32 = u32::MAX;

/// Some of the rows of a matrix, their columns ascending.
pub(crate) fn chosen(matrix: &BlockMatrix, rows: impl Iterator<Item = usize>) -> BlockMatrix {
    let mut chosen = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
    let mut order: Vec<usize> = Vec::new();
    for row in rows {
        order.extend(matrix.row_start[row]..matrix.row_start[row + 1]);
        order.sort_unstable_by_key(|at| matrix.column[*at]);
        chosen.column.extend(order.iter().map(|at| matrix.column[*at]));
        chosen.block.extend(order.drain(..).map(|at| matrix.block[at]));
        chosen.row_start.push(chosen.column.len());
    }
    chosen
}

/// The transpose of a matrix with so many block columns.
pub(crate) fn transposed(matrix: &BlockMatrix, columns: usize) -> BlockMatrix {
    let Transposed { start, entry } = Transposed::new(matrix, columns);
    let block = |&(_, at): &(usize, usize)| {
        let b = matrix.block[at];
        [b[0], b[2], b[1], b[3]]
    };
    BlockMatrix {
        row_start: start,
        column: entry.iter().map(|(row, _)| *row as u32).collect(),
        block: entry.iter().map(block).collect(),
    }
}

/// Lengths of some columns, their rows, and the values of all matrices there.
type Part<const N: usize> = (Vec<usize>, Vec<usize>, [Vec<f64>; N]);

/// The same for any number of matrices up to seven.
pub(crate) fn of_all(
    matrices: &[&BlockMatrix],
    links: impl Iterator<Item = (usize, usize)>,
    columns: usize,
    together: impl Fn(usize, usize) -> bool + Sync,
) -> Result<Vec<SymmetricMatrix>, Error> {
    fn some<const N: usize>(
        matrices: &[&BlockMatrix],
        links: impl Iterator<Item = (usize, usize)>,
        columns: usize,
        together: impl Fn(usize, usize) -> bool + Sync,
    ) -> Result<Vec<SymmetricMatrix>, Error> {
        let matrices: [&BlockMatrix; N] = matrices.try_into().map_err(|_| Error::Degenerate)?;
        Ok(grams(matrices, links, columns, together)?.into())
    }
    match matrices.len() {
        2 => some::<2>(matrices, links, columns, together),
        3 => some::<3>(matrices, links, columns, together),
        6 => some::<6>(matrices, links, columns, together),
        _ => some::<7>(matrices, links, columns, together),
    }
}

/// `JᵀJ` of each of some matrices J with so many block columns, those of a row ascending, of pairs of columns that go together: lower triangles with
/// the whole diagonal, all on the pattern of their sum and of some links between columns, the later one first.
pub(crate) fn grams<const N: usize>(
    matrices: [&BlockMatrix; N],
    links: impl Iterator<Item = (usize, usize)>,
    columns: usize,
    together: impl Fn(usize, usize) -> bool + Sync,
) -> Result<[SymmetricMatrix; N], Error> {
    let mut linked = vec![Vec::new(); columns];
    links.for_each(|(later, earlier)| linked[earlier].push(later as u32));
    let transposed = matrices.map(|matrix| (matrix, Transposed::new(matrix, columns)));
    let parts: Vec<Part<N>> = (0..columns.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let (mut lengths, mut rows, mut values) = (Vec::new(), Vec::new(), [const { Vec::new() }; N]);
            let mut place = vec![NONE; columns];
            let mut others: Vec<u32> = Vec::new();
            let mut sums = [const { Vec::<[f64; 4]>::new() }; N];
            for (column, links) in linked.iter().enumerate().skip(chunk * CHUNK).take(CHUNK) {
                let mut meet = |other: u32| {
                    if together(column, other as usize)
                        && std::mem::replace(&mut place[other as usize], 0) == NONE
                    {
                        others.push(other);
                    }
                };
                meet(column as u32);
                links.iter().for_each(|other| meet(*other));
                for (matrix, transposed) in &transposed {
                    for onwards in transposed.onwards(column, matrix) {
                        matrix.column[onwards].iter().for_each(|other| meet(*other));
                    }
                }
                others.sort_unstable();
                others.iter().zip(0..).for_each(|(other, own)| place[*other as usize] = own);
                for ((matrix, transposed), sums) in transposed.iter().zip(&mut sums) {
                    sums.clear();
                    sums.resize(others.len(), [0.0; 4]);
                    for onwards in transposed.onwards(column, matrix) {
                        let own = matrix.block[onwards.start];
                        for (other, b) in matrix.column[onwards.clone()].iter().zip(&matrix.block[onwards]) {
                            if !together(column, *other as usize) {
                                continue;
                            }
                            // bᵀ · own
                            let product = [
                                b[0] * own[0] + b[2] * own[2],
                                b[0] * own[1] + b[2] * own[3],
                                b[1] * own[0] + b[3] * own[2],
                                b[1] * own[1] + b[3] * own[3],
                            ];
                            let sum = &mut sums[place[*other as usize] as usize];
                            sum.iter_mut().zip(product).for_each(|(s, x)| *s += x);
                        }
                    }
                }
                for axis in 0..2 {
                    let first = rows.len();
                    let below = others.iter().map(|other| [2 * *other as usize, 2 * *other as usize + 1]);
                    lower(&mut rows, below, axis);
                    lengths.push(rows.len() - first);
                    for (values, sums) in values.iter_mut().zip(&sums) {
                        lower(values, sums.iter().map(|block| [block[axis], block[2 + axis]]), axis);
                    }
                }
                others.drain(..).for_each(|other| place[other as usize] = NONE);
            }
            (lengths, rows, values)
        })
        .collect();
    let mut column_start = Vec::with_capacity(2 * columns + 1);
    column_start.push(0);
    let (mut rows, mut values, mut end) = (Vec::new(), [const { Vec::new() }; N], 0);
    for (part_lengths, part_rows, part_values) in parts {
        column_start.extend(part_lengths.iter().map(|length| {
            end += length;
            end
        }));
        rows.extend(part_rows);
        values.iter_mut().zip(part_values).for_each(|(all, part)| all.extend(part));
    }
    let pattern = SymmetricMatrix::new(column_start, rows, vec![0.0; values[0].len()])?;
    let mut matrices = [const { None }; N];
    for (matrix, values) in matrices.iter_mut().zip(values) {
        *matrix = Some(pattern.with_values(values)?);
    }
    Ok(matrices.map(|matrix| matrix.unwrap_or_else(|| pattern.clone())))
}

/// Adds a column of what it has of one block after the other, which begin with that on the diagonal: of the second column, this has but one below.
fn lower<T: Copy>(column: &mut Vec<T>, mut blocks: impl ExactSizeIterator<Item = [T; 2]>, axis: usize) {
    column.reserve(2 * blocks.len());
    if axis == 1
        && let Some([_, own]) = blocks.next()
    {
        column.push(own);
    }
    blocks.for_each(|block| column.extend_from_slice(&block));
}

/// Where each block column has entries: row and index of the block.
struct Transposed {
    start: Vec<usize>,
    entry: Vec<(usize, usize)>,
}

impl Transposed {
    fn new(matrix: &BlockMatrix, columns: usize) -> Self {
        let rows = 0..matrix.row_start.len() - 1;
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

    /// The parts of rows from a column on.
    fn onwards(&self, column: usize, matrix: &BlockMatrix) -> impl Iterator<Item = Range<usize>> {
        let entries = &self.entry[self.start[column]..self.start[column + 1]];
        entries.iter().map(|(row, at)| *at..matrix.row_start[row + 1])
    }
}
