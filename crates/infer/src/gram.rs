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

/// Some of the rows of a matrix.
pub(crate) struct Chosen<'a> {
    pub matrix: &'a BlockMatrix,
    pub rows: Vec<usize>,
}

impl Chosen<'_> {
    /// These rows alone, their columns ascending.
    fn sorted(&self) -> BlockMatrix {
        let mut matrix = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
        let mut order: Vec<usize> = Vec::new();
        for &row in &self.rows {
            order.extend(self.matrix.row_start[row]..self.matrix.row_start[row + 1]);
            order.sort_unstable_by_key(|at| self.matrix.column[*at]);
            matrix.column.extend(order.iter().map(|at| self.matrix.column[*at]));
            matrix.block.extend(order.drain(..).map(|at| self.matrix.block[at]));
            matrix.row_start.push(matrix.column.len());
        }
        matrix
    }
}

/// Lengths of some columns, their rows, and the values of all matrices there.
type Part<const N: usize> = (Vec<usize>, Vec<usize>, [Vec<f64>; N]);

/// The same for any number of matrices up to seven.
pub(crate) fn of_all(
    chosen: Vec<Chosen<'_>>,
    links: impl Iterator<Item = (usize, usize)>,
    columns: usize,
) -> Result<Vec<SymmetricMatrix>, Error> {
    fn some<const N: usize>(
        chosen: Vec<Chosen<'_>>,
        links: impl Iterator<Item = (usize, usize)>,
        columns: usize,
    ) -> Result<Vec<SymmetricMatrix>, Error> {
        let chosen: [Chosen<'_>; N] = chosen.try_into().map_err(|_| Error::Degenerate)?;
        Ok(grams(chosen, links, columns)?.into())
    }
    match chosen.len() {
        2 => some::<2>(chosen, links, columns),
        3 => some::<3>(chosen, links, columns),
        6 => some::<6>(chosen, links, columns),
        _ => some::<7>(chosen, links, columns),
    }
}

/// `JᵀJ` over the chosen rows of each of some matrices J with so many block columns: lower triangles with the whole
/// diagonal, all on the pattern of their sum and of some links between columns, the later one first.
pub(crate) fn grams<const N: usize>(
    chosen: [Chosen<'_>; N],
    links: impl Iterator<Item = (usize, usize)>,
    columns: usize,
) -> Result<[SymmetricMatrix; N], Error> {
    let mut linked = vec![Vec::new(); columns];
    links.for_each(|(later, earlier)| linked[earlier].push(later as u32));
    let sorted = chosen.map(|chosen| chosen.sorted());
    let transposed = sorted.each_ref().map(|matrix| (matrix, Transposed::new(matrix, columns)));
    let parts: Vec<Part<N>> = (0..columns.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let (mut lengths, mut rows, mut values) = (Vec::new(), Vec::new(), [const { Vec::new() }; N]);
            let mut place = vec![NONE; columns];
            let mut others: Vec<u32> = Vec::new();
            let mut sums = [const { Vec::<[f64; 4]>::new() }; N];
            for (column, links) in linked.iter().enumerate().skip(chunk * CHUNK).take(CHUNK) {
                let mut meet = |other: u32| {
                    if std::mem::replace(&mut place[other as usize], 0) == NONE {
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
