//! Which unknowns of a sparse symmetric matrix are eliminated together, and where their entries go.

use crate::SymmetricMatrix;
use crate::dissection::{Dissection, Front, Place};
use crate::graph::Graph;
use faer::MatRef;
use std::ops::Range;

/// The fronts of a pattern. A front holds its own unknowns and those behind them that they couple to; a factor has a column for each of its own,
/// one front after the other, each after all that it is made of.
#[derive(Debug)]
pub(crate) struct Fronts {
    dissection: Dissection,
    /// Unknowns of a node.
    group: usize,
    /// First entry of each front in a factor, and the end.
    start: Vec<usize>,
    /// Where the matrix' blocks of two nodes go, by fronts.
    blocks: Vec<Block>,
    block_start: Vec<usize>,
    /// Where the nodes to which each front couples are in the next front.
    lift: Vec<Vec<u32>>,
    /// The first front below each, or itself.
    first_below: Vec<usize>,
    /// Front of each position.
    front_of: Vec<u32>,
    /// Multiplications in each and all below, about.
    work: Vec<usize>,
}

/// Where what the lower triangle of a matrix has of two nodes goes.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    /// First of its columns in the matrix, and how far before the end of each of them its rows begin.
    column: u32,
    back: u32,
    /// First of its entries in the columns of the front.
    at: u32,
    /// Whether the node of the rows is eliminated first.
    turned: bool,
    /// Whether it is one node's.
    same: bool,
}

/// Where two nodes meet: in which front, in the columns of the one that is eliminated first and the rows of the other.
#[derive(Clone, Copy)]
struct Seat {
    index: usize,
    across: usize,
    down: usize,
    /// Whether the second node is eliminated first.
    turned: bool,
    same: bool,
}

impl Fronts {
    /// Analyses the pattern of a matrix whose unknowns belong, in groups of one size that follow each other, to places.
    pub fn new(matrix: &SymmetricMatrix, places: &[Place], group: usize) -> Self {
        let (column_start, row) = matrix.places();
        let graph = Graph::of_lower_triangle(column_start, row, group);
        let dissection = Dissection::new(&graph, places);
        let count = dissection.fronts.len();
        let mut fronts = Self {
            start: vec![0],
            front_of: Vec::with_capacity(places.len()),
            lift: vec![Vec::new(); count],
            first_below: Vec::with_capacity(count),
            work: Vec::with_capacity(count),
            blocks: Vec::new(),
            block_start: Vec::new(),
            dissection,
            group,
        };
        for index in 0..count {
            fronts.arrange(index);
        }
        fronts.enter(matrix);
        fronts
    }

    /// Where a front is in a factor, and where those below are in it.
    fn arrange(&mut self, index: usize) {
        let fronts = &self.dissection.fronts;
        let front = &fronts[index];
        let (own, all) = self.sizes(index);
        self.start.push(self.start[index] + own * all);
        self.front_of.resize(front.first + front.own, index as u32);
        self.first_below.push(front.children.first().map_or(index, |child| self.first_below[*child]));
        self.work.push(own * all * all + front.children.iter().map(|child| self.work[*child]).sum::<usize>());
        for &child in &front.children {
            // All that a front couples to is in the next.
            let boundary = fronts[child].boundary.iter();
            self.lift[child] = boundary.filter_map(|position| Some(front.local(*position)? as u32)).collect();
        }
    }

    /// Where the entries of a matrix go, which come in whole blocks.
    fn enter(&mut self, matrix: &SymmetricMatrix) {
        let (column_start, row) = matrix.places();
        let mut block_start = vec![0; self.count() + 1];
        let mut all = Vec::with_capacity(row.len() / (self.group * self.group) + self.dissection.order.len());
        for (node, column) in (0..matrix.order()).step_by(self.group).enumerate() {
            let range = column_start[column]..column_start[column + 1];
            for k in range.clone().step_by(self.group) {
                let Some(seat) = self.seat(node, row[k] / self.group) else { continue };
                let at = seat.across * self.sizes(seat.index).1 + seat.down;
                let (back, at) = ((range.end - k) as u32, at as u32);
                let block = Block { column: column as u32, back, at, turned: seat.turned, same: seat.same };
                block_start[seat.index + 1] += 1;
                all.push((seat.index, block));
            }
        }
        for index in 1..block_start.len() {
            block_start[index] += block_start[index - 1];
        }
        let (mut next, mut blocks) = (block_start.clone(), vec![Block::default(); all.len()]);
        for (index, block) in all {
            blocks[next[index]] = block;
            next[index] += 1;
        }
        (self.blocks, self.block_start) = (blocks, block_start);
    }

    /// Where two nodes meet in a factor, if they do.
    fn seat(&self, one: usize, other: usize) -> Option<Seat> {
        let [one, other] = [one, other].map(|node| self.dissection.position[node]);
        let (first, second) = (one.min(other), one.max(other));
        let index = self.front_of[first as usize] as usize;
        let front = &self.dissection.fronts[index];
        let [across, down] =
            [Some(first as usize - front.first), front.local(second)].map(|at| at.map(|at| at * self.group));
        Some(Seat { index, across: across?, down: down?, turned: other < one, same: one == other })
    }

    /// The front of an entry where two nodes meet, and where it is in a factor.
    fn entry(&self, seat: Seat, of_one: usize, of_other: usize) -> (usize, usize) {
        let Seat { index, across, down, turned, same } = seat;
        let turned = if same { of_other < of_one } else { turned };
        let (first, second) = if turned { (of_other, of_one) } else { (of_one, of_other) };
        (index, self.start[index] + (across + first) * self.sizes(index).1 + down + second)
    }

    /// Where the entry of a matrix is in a factor; `None` if there is none.
    pub fn entry_index(&self, i: usize, j: usize) -> Option<usize> {
        let seat = self.seat(i / self.group, j / self.group)?;
        Some(self.entry(seat, i % self.group, j % self.group).1)
    }

    /// Number of fronts.
    pub fn count(&self) -> usize {
        self.dissection.fronts.len()
    }

    /// Entries of a factor.
    pub fn entries(&self) -> usize {
        self.start[self.count()]
    }

    /// Number of unknowns.
    pub fn order(&self) -> usize {
        self.dissection.order.len() * self.group
    }

    /// The unknowns in the order of elimination.
    pub fn unknowns(&self) -> impl Iterator<Item = usize> + '_ {
        let firsts = self.dissection.order.iter().map(|node| self.group * *node as usize);
        firsts.flat_map(|first| first..first + self.group)
    }

    fn front(&self, index: usize) -> &Front {
        &self.dissection.fronts[index]
    }

    /// Fronts without a next one.
    pub fn roots(&self) -> &[usize] {
        &self.dissection.roots
    }

    /// Fronts of which a front is the next.
    pub fn children(&self, index: usize) -> &[usize] {
        &self.front(index).children
    }

    /// Unknowns of its own, and all of a front.
    pub fn sizes(&self, index: usize) -> (usize, usize) {
        let front = self.front(index);
        (self.group * front.own, self.group * (front.own + front.boundary.len()))
    }

    /// How many entries a front and all below it have in a factor.
    pub fn entries_below(&self, index: usize) -> usize {
        self.start[index + 1] - self.start[self.first_below[index]]
    }

    /// Multiplications in a front and all below, about.
    pub fn work(&self, index: usize) -> usize {
        self.work[index]
    }

    /// The columns of a front in a factor.
    pub fn columns<'a>(&self, index: usize, values: &'a [f64]) -> MatRef<'a, f64> {
        let (own, all) = self.sizes(index);
        MatRef::from_column_major_slice(&values[self.start[index]..self.start[index + 1]], all, own)
    }

    /// Puts the entries of a matrix into the columns of a front.
    pub fn fill(&self, index: usize, matrix: &SymmetricMatrix, columns: &mut [f64]) {
        let (column_start, _) = matrix.places();
        let (values, height) = (matrix.values(), self.sizes(index).1);
        columns.fill(0.0);
        for block in &self.blocks[self.block_start[index]..self.block_start[index + 1]] {
            let at = block.at as usize;
            for j in 0..self.group {
                let end = column_start[block.column as usize + j + 1];
                // A node's own block is a triangle.
                let first = if block.same { j } else { 0 };
                let from = end + first - block.back as usize;
                for (value, i) in values[from..].iter().zip(first..self.group) {
                    let (across, down) = if block.turned { (i, j) } else { (j, i) };
                    columns[at + across * height + down] = *value;
                }
            }
        }
    }

    /// Positions of its own unknowns.
    pub fn own(&self, index: usize) -> Range<usize> {
        let front = self.front(index);
        self.group * front.first..self.group * (front.first + front.own)
    }

    /// Positions of the unknowns behind a front to which it couples.
    pub fn coupled(&self, index: usize) -> impl Iterator<Item = usize> + '_ {
        self.spread(&self.front(index).boundary)
    }

    /// Where these are in the next front.
    pub fn lifted(&self, index: usize) -> Vec<usize> {
        self.spread(&self.lift[index]).collect()
    }

    fn spread<'a>(&'a self, nodes: &'a [u32]) -> impl Iterator<Item = usize> + 'a {
        nodes.iter().flat_map(|node| (0..self.group).map(|k| self.group * *node as usize + k))
    }
}
