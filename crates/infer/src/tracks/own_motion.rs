//! What the model leaves of the motion of a cell, freed of what its neighbours were pushed by.
//!
//! A cell that is pushed on its way from one frame to the next, by its polarity or by something that nothing explains, pushes its neighbours, and
//! these theirs. If w are the ways that cells are pushed along by themselves, they end at `x' = X(x, β) + U w`, with U the derivative of the passage by
//! the ways. What is left of the motions, r, is therefore not what happened to each cell by itself; that is
//!
//! ```text
//! s = V r,      V ≈ U⁻¹
//! ```
//!
//! It is s that scatters independently from cell to cell, and it does not depend on the polarities of others: in the equations of cells that crawl, a polarity is
//! coupled to the motions of its own cell alone, and separators of a dissection have places only. The rows of V are those of the inverse of U among the cells near
//! by. U is that at one point of a fit, kept while it goes on: any V is as good a measure of what is left, if it is near the inverse.

use super::block::{Block, accumulate};
use super::motions::Motion;
use nalgebra::DMatrix;
use std::sync::Arc;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// No motion.
const NONE: u32 = u32::MAX;

/// V of each interval.
#[derive(Debug, Clone)]
pub(crate) struct OwnMotion {
    pub(super) intervals: Arc<Vec<Freed>>,
}

/// V of an interval: a row for each cell that is led.
#[derive(Debug)]
pub(super) struct Freed {
    pub start: Vec<usize>,
    /// Cells of the interval.
    pub column: Vec<u32>,
    pub block: Vec<Block>,
}

impl OwnMotion {
    /// V of what is left of some motions of an interval.
    pub fn of(&self, motions: &[Motion], rests: &mut [Vector<f64>]) {
        let Some(own) = motions.first().and_then(|first| self.intervals.get(first.interval)) else { return };
        let among = own.among(motions);
        let given = rests.to_vec();
        for (motion, rest) in motions.iter().zip(rests) {
            let freed = own.row(motion, &among).map(|(other, [xx, xy, yx, yy])| {
                let r = given[other];
                Vector::new(xx * r.x + xy * r.y, yx * r.x + yy * r.y)
            });
            *rest = freed.sum();
        }
    }

    /// V of the rows of these motions, in the columns that each has, and of their derivatives by the coefficients (2, p).
    pub fn of_rows(&self, motions: &[Motion], rows: &mut BlockMatrix, columns: &mut [DMatrix<f64>]) {
        let Some(own) = motions.first().and_then(|first| self.intervals.get(first.interval)) else { return };
        let among = own.among(motions);
        let width = rows.column.iter().map(|column| *column as usize + 1).max().unwrap_or(0);
        let mut at = vec![NONE; width];
        let (given, given_columns) = (rows.block.clone(), columns.to_vec());
        rows.block.fill([0.0; 4]);
        for (number, motion) in motions.iter().enumerate() {
            let range = rows.row_start[number]..rows.row_start[number + 1];
            range.clone().for_each(|k| at[rows.column[k] as usize] = k as u32);
            columns[number].fill(0.0);
            for (other, block) in own.row(motion, &among) {
                for k in rows.row_start[other]..rows.row_start[other + 1] {
                    let to = at[rows.column[k] as usize];
                    if to != NONE {
                        accumulate(&mut rows.block[to as usize], block, &given[k]);
                    }
                }
                let (theirs, sum) = (&given_columns[other], &mut columns[number]);
                for k in 0..sum.ncols() {
                    sum[(0, k)] += block[0] * theirs[(0, k)] + block[1] * theirs[(1, k)];
                    sum[(1, k)] += block[2] * theirs[(0, k)] + block[3] * theirs[(1, k)];
                }
            }
            rows.column[range].iter().for_each(|column| at[*column as usize] = NONE);
        }
    }

    /// The cells of an interval whose ways count for where a cell ends.
    pub fn pushing(&self, interval: usize, cell: usize) -> &[u32] {
        let own = &self.intervals[interval];
        &own.column[own.start[cell]..own.start[cell + 1]]
    }
}

impl Freed {
    /// The number of the motion of each cell among some motions.
    fn among(&self, motions: &[Motion]) -> Vec<u32> {
        let mut among = vec![NONE; self.start.len() - 1];
        motions.iter().zip(0..).for_each(|(motion, number)| among[motion.between as usize] = number);
        among
    }

    /// The row of a motion among some motions.
    fn row<'a>(&'a self, motion: &Motion, among: &'a [u32]) -> impl Iterator<Item = (usize, &'a Block)> {
        let range = self.start[motion.between as usize]..self.start[motion.between as usize + 1];
        let all = self.column[range.clone()].iter().zip(&self.block[range]);
        let number = |(cell, block): (&u32, &'a Block)| (among[*cell as usize], block);
        all.map(number).filter(|(number, _)| *number != NONE).map(|(number, block)| (number as usize, block))
    }
}
