//! The derivatives of where a passage ends by where it begins, by the coefficients and by the translation.
//!
//! ```text
//! dF_i = J(x_i) dx_i + X(x_i) dβ,      x_i and x' as in [`super::passage`]
//! ```
//!
//! Derivatives by the places of cells farther than two rings are left out: what a cell does to others falls off fast.

use super::block::{Block, IDENTITY, accumulate};
use super::objective::MovieObjective;
use super::passage::{Passage, Step, is_known};
use super::stages::{Derivatives, Part, Stage};
use crate::residuals::{Columns, combined};
use nalgebra::DMatrix;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::BlockMatrix;

/// Rings of cells whose places and polarities count: those of a force.
const RINGS: usize = 2;

/// The place of a column that is not in a row.
const OUT_OF_REACH: u32 = 0;

/// Derivatives of the places of the cells of an interval: a row for each cell.
#[derive(Clone)]
pub(super) struct Tangent {
    /// First entry of each row, and the number of entries.
    start: Vec<usize>,
    /// By the place of a cell of the interval in the first frame, or (behind all of these) in the second, or by the way that it crawls.
    column: Vec<u32>,
    block: Vec<Block>,
    /// By the translation and the free coefficients: matrices (2, 2 + p), row by row.
    dense: Vec<f64>,
    width: usize,
}

/// Columns of the translation among the dense ones.
const DRIFT: usize = 2;

impl Tangent {
    /// Where the passage of an interval ends, but for the ways that cells crawl if these are told apart ([`super::own_motion`]).
    pub fn at_end(
        objective: &MovieObjective<'_>,
        interval: usize,
        passage: &Passage<'_>,
        coefficients: &[f64],
    ) -> Self {
        let told_apart = objective.states.own_motion.is_some();
        let ways = objective.memory.is_some() && !told_apart;
        Self::within(objective, interval, passage, coefficients, (RINGS, ways))
    }

    /// The same with the ways that the cells near by crawl.
    pub fn of_ways(
        objective: &MovieObjective<'_>,
        interval: usize,
        passage: &Passage<'_>,
        coefficients: &[f64],
    ) -> Self {
        Self::within(objective, interval, passage, coefficients, (RINGS, true))
    }

    /// The same, for what the coefficients and the translation do to all cells alone.
    pub fn of_coefficients(
        objective: &MovieObjective<'_>,
        interval: usize,
        passage: &Passage<'_>,
        coefficients: &[f64],
    ) -> Self {
        Self::within(objective, interval, passage, coefficients, (0, objective.memory.is_some()))
    }

    /// The same, by the places of cells so many rings away at most, and perhaps by the ways that they crawl.
    fn within(
        objective: &MovieObjective<'_>,
        interval: usize,
        passage: &Passage<'_>,
        coefficients: &[f64],
        (rings, crawls): (usize, bool),
    ) -> Self {
        let led = &objective.states.intervals[interval].led;
        let span = objective.span(interval);
        let length = span / passage.steps.len() as f64;
        let advance = Advance { crawls, led, span, length, along: objective.along() };
        let basis = objective.space.basis();
        let environment = objective.states.intervals[interval].halfway.environment();
        let model = objective.structure.model(coefficients, environment);
        let mut tangent = Self::still(
            led,
            &passage.steps[0].stages[0].0.tessellation,
            rings,
            DRIFT + objective.space.dimension(),
            crawls,
        );
        let by = Derivatives::of(passage.steps.len());
        let mut work = Work { slope: tangent.clone(), next: tangent.clone(), stage: tangent.clone() };
        for (number, step) in passage.steps.iter().enumerate() {
            work.step(&tangent, step, by, (coefficients, number), &advance);
            let Work { next, stage, .. } = &mut work;
            for turn in &step.turns {
                let by_places = turn.added_by_places(&model, by);
                for (index, cell) in turn.cells.iter().enumerate().filter(|(_, cell)| led[**cell]) {
                    let jump = turn.added_by_fraction(index, coefficients) * advance.length;
                    for (from, slopes) in [&tangent, &*stage].into_iter().zip(&turn.slopes) {
                        for (other, slope) in turn.cells.iter().zip(slopes) {
                            let block =
                                [jump.x * slope.x, jump.x * slope.y, jump.y * slope.x, jump.y * slope.y];
                            next.add(*cell, &block, from, *other);
                        }
                    }
                    next.add_dense(*cell, &(turn.added_by_coefficients(index, basis, by) * advance.length));
                    for (from, of_cells) in [&tangent, &*stage].into_iter().zip(&by_places) {
                        for (other, block) in &of_cells[index] {
                            next.add(*cell, &block.map(|b| b * advance.length), from, *other as usize);
                        }
                    }
                }
            }
            advance.straight(next, number as f64 + 1.0);
            std::mem::swap(&mut tangent, next);
        }
        tangent
    }

    /// At the beginning: each cell by its own place. Rows have room for what is within reach.
    fn still(led: &[bool], tessellation: &Tessellation, rings: usize, width: usize, crawls: bool) -> Self {
        let cells = led.len();
        let mut own = Self {
            start: vec![0],
            column: Vec::new(),
            block: Vec::new(),
            dense: vec![0.0; 2 * width * cells],
            width,
        };
        let mut seen = vec![usize::MAX; cells];
        for cell in 0..cells {
            let first = own.column.len();
            own.column.push(cell as u32);
            seen[cell] = cell;
            let mut ring = first;
            for _ in 0..rings {
                let end = own.column.len();
                for at in ring..end {
                    for next in tessellation.neighbours(own.column[at] as usize) {
                        if seen[*next as usize] != cell {
                            seen[*next as usize] = cell;
                            own.column.push(*next);
                        }
                    }
                }
                ring = end;
            }
            for at in first..own.column.len() {
                let other = own.column[at];
                if !led[other as usize] {
                    own.column.push(other + cells as u32);
                } else if crawls {
                    own.column.push(other + 2 * cells as u32);
                }
            }
            own.block.resize(own.column.len(), [0.0; 4]);
            own.block[first] = IDENTITY;
            own.start.push(own.column.len());
        }
        own
    }

    /// The derivatives of one cell's place: column and block.
    pub fn row(&self, cell: usize) -> impl Iterator<Item = (usize, &Block)> {
        let range = self.start[cell]..self.start[cell + 1];
        self.column[range.clone()].iter().map(|column| *column as usize).zip(&self.block[range])
    }

    /// The derivative of one cell's place by the translation.
    pub fn by_translation(&self, cell: usize) -> Block {
        let own = &self.dense[2 * self.width * cell..];
        [own[0], own[1], own[self.width], own[self.width + 1]]
    }

    /// The derivative of one cell's place by the free coefficients (2, p).
    pub fn by_coefficients(&self, cell: usize) -> DMatrix<f64> {
        let own = &self.dense[2 * self.width * cell..2 * self.width * (cell + 1)];
        DMatrix::from_fn(2, self.width - DRIFT, |i, k| own[i * self.width + DRIFT + k])
    }

    /// Becomes another with the same columns.
    fn take(&mut self, other: &Self) {
        self.block.copy_from_slice(&other.block);
        self.dense.copy_from_slice(&other.dense);
    }

    /// Adds another times a factor.
    fn go_on(&mut self, other: &Self, factor: f64) {
        let blocks = self.block.iter_mut().flatten().zip(other.block.iter().flatten());
        blocks.chain(self.dense.iter_mut().zip(&other.dense)).for_each(|(own, other)| *own += factor * other);
    }

    /// Adds a block times a row of another to a row.
    fn add(&mut self, cell: usize, block: &Block, from: &Self, other: usize) {
        let own = self.start[cell]..self.start[cell + 1];
        for (column, b) in from.row(other) {
            if let Some(at) = self.column[own.clone()].iter().position(|c| *c as usize == column) {
                accumulate(&mut self.block[own.start + at], block, b);
            }
        }
        self.add_dense_of(cell, block, from, other);
    }

    fn add_dense_of(&mut self, cell: usize, block: &Block, from: &Self, other: usize) {
        let width = self.width;
        let own = &mut self.dense[2 * width * cell..2 * width * (cell + 1)];
        let theirs = &from.dense[2 * width * other..2 * width * (other + 1)];
        for k in 0..width {
            let [x, y] = [theirs[k], theirs[width + k]];
            own[k] += block[0] * x + block[1] * y;
            own[width + k] += block[2] * x + block[3] * y;
        }
    }

    /// Adds derivatives by the coefficients.
    fn add_dense(&mut self, cell: usize, x: &DMatrix<f64>) {
        let own = &mut self.dense[2 * self.width * cell..];
        for k in 0..x.ncols() {
            own[DRIFT + k] += x[(0, k)];
            own[self.width + DRIFT + k] += x[(1, k)];
        }
    }
}

/// Derivatives on their way.
struct Work {
    slope: Tangent,
    /// Those at the end of a step, without its transitions.
    next: Tangent,
    /// Those at a stage; of a step that is done, at its last one.
    stage: Tangent,
}

impl Work {
    /// A step without its transitions.
    fn step(
        &mut self,
        from: &Tangent,
        step: &Step<'_>,
        by: Derivatives,
        (coefficients, number): (&[f64], usize),
        advance: &Advance<'_>,
    ) {
        let Self { slope, next, stage } = self;
        next.take(from);
        stage.take(from);
        for (index, parts) in by.parts() {
            let local = Local::at(&step.stages[*index], coefficients);
            for Part { weight, onwards } in *parts {
                advance.slope(slope, stage, &local);
                next.go_on(slope, weight * advance.length);
                if let Some(share) = onwards {
                    stage.take(from);
                    stage.go_on(slope, share * advance.length);
                    advance.straight(stage, number as f64 + share);
                }
            }
        }
    }
}

/// Derivatives of velocities at a stage.
struct Local<'a> {
    velocities: &'a [Vector<f64>],
    jacobian: BlockMatrix,
    by_coefficient: Columns,
}

impl<'a> Local<'a> {
    fn at((cells, velocities): &'a Stage<'_>, coefficients: &[f64]) -> Self {
        let by_coefficient = cells.evaluate(coefficients).by_coefficient;
        Self { velocities, jacobian: cells.jacobian_of_cells(coefficients), by_coefficient }
    }
}

/// What does not change from step to step.
struct Advance<'a> {
    /// Whether cells crawl.
    crawls: bool,
    led: &'a [bool],
    /// Time between the frames, and of a step.
    span: f64,
    length: f64,
    /// The directions of the free coefficients.
    along: Vec<Vec<f64>>,
}

impl Advance<'_> {
    /// J dx + X dβ + (dd + du) / T for the cells that are led.
    fn slope(&self, to: &mut Tangent, from: &Tangent, at: &Local<'_>) {
        to.block.fill([0.0; 4]);
        to.dense.fill(0.0);
        let width = to.width;
        // The row of a cell behind a place for what is out of its reach: of a product every other entry is.
        let (mut index, mut row) = (vec![OUT_OF_REACH; 3 * self.led.len()], Vec::new());
        for cell in (0..self.led.len()).filter(|cell| self.led[*cell]) {
            to.dense[2 * width * cell] = 1.0 / self.span;
            to.dense[2 * width * cell + width + 1] = 1.0 / self.span;
            if !is_known(at.velocities[cell]) {
                continue;
            }
            let own = to.start[cell]..to.start[cell + 1];
            row.clear();
            row.resize(1 + own.len(), [0.0; 4]);
            for (at, column) in (1..).zip(&to.column[own.clone()]) {
                index[*column as usize] = at;
            }
            if self.crawls {
                row[index[2 * self.led.len() + cell] as usize] = IDENTITY.map(|one| one / self.span);
            }
            for (other, block) in at.jacobian.row(cell) {
                for (column, b) in from.row(other) {
                    accumulate(&mut row[index[column] as usize], block, b);
                }
                to.add_dense_of(cell, block, from, other);
            }
            to.block[own.clone()].copy_from_slice(&row[1..]);
            to.column[own].iter().for_each(|column| index[*column as usize] = OUT_OF_REACH);
            let dense = &mut to.dense[2 * width * cell..];
            for (k, along) in self.along.iter().enumerate() {
                let x: Vector<f64> = combined(&at.by_coefficient, along, cell);
                dense[DRIFT + k] += x.x;
                dense[width + DRIFT + k] += x.y;
            }
        }
    }

    /// Sets the rows of the cells that go straight, after so many steps.
    fn straight(&self, to: &mut Tangent, steps: f64) {
        let (cells, share) = (self.led.len(), steps * self.length / self.span);
        for cell in (0..cells).filter(|cell| !self.led[*cell]) {
            let own = to.start[cell]..to.start[cell + 1];
            for at in own {
                to.block[at] = match to.column[at] as usize {
                    column if column == cell => IDENTITY.map(|one| one * (1.0 - share)),
                    column if column == cell + cells => IDENTITY.map(|one| one * share),
                    _ => [0.0; 4],
                };
            }
        }
    }
}
