//! Cells that go through the same operations, because they have as many sides.

use crate::{Lanes, Scalar, Tessellation, Vector};
use std::ops::Range;

/// At most [`BySides::MOST_CELLS`] consecutive cells in the order of their numbers of sides, to be worked on in [`Lanes`].
#[derive(Debug)]
pub struct BySides<'a> {
    tessellation: &'a Tessellation,
    first: usize,
    order: [u16; BySides::MOST_CELLS],
    /// Where the cells of each number of sides begin, the others at zero; and where all end.
    begin: [u16; BySides::MOST_SIDES + 2],
}

impl<'a> BySides<'a> {
    /// Most cells.
    pub const MOST_CELLS: usize = 1024;

    /// Most sides of cells that are worked on together.
    pub const MOST_SIDES: usize = 15;

    /// Counts the sides of cells.
    pub fn new(tessellation: &'a Tessellation, cells: Range<usize>) -> Self {
        let sides = |cell: usize| {
            let sides = tessellation.ring(cell).len();
            if tessellation.is_closed(cell) && (3..=Self::MOST_SIDES).contains(&sides) { sides } else { 0 }
        };
        let (mut order, mut begin) = ([0; Self::MOST_CELLS], [0; Self::MOST_SIDES + 2]);
        for cell in cells.clone() {
            begin[sides(cell) + 1] += 1;
        }
        for sides in 0..=Self::MOST_SIDES {
            begin[sides + 1] += begin[sides];
        }
        let (mut next, first) = (begin, cells.start);
        for (number, cell) in (0..).zip(cells) {
            let next = &mut next[sides(cell)];
            order[usize::from(*next)] = number;
            *next += 1;
        }
        Self { tessellation, first, order, begin }
    }

    #[inline(always)]
    fn with(&self, sides: usize) -> &[u16] {
        &self.order[usize::from(self.begin[sides])..usize::from(self.begin[sides + 1])]
    }

    /// The cells that are open or have too many sides, or too few.
    pub fn others(&self) -> impl Iterator<Item = usize> {
        self.with(0).iter().map(|&number| self.first + usize::from(number))
    }

    /// The cells of a number of sides, as many at once as there are lanes; fewer in the end.
    #[inline(always)]
    pub fn batches(&self, sides: usize) -> impl Iterator<Item = Batch<'_>> {
        let batch = |numbers| Batch { tessellation: self.tessellation, first: self.first, numbers };
        self.with(sides).chunks(Lanes::WIDTH).map(batch)
    }
}

/// As many cells as there are lanes, or fewer, with one number of sides.
#[derive(Debug, Clone, Copy)]
pub struct Batch<'a> {
    tessellation: &'a Tessellation,
    first: usize,
    numbers: &'a [u16],
}

impl Batch<'_> {
    /// The cells of the lanes.
    #[inline(always)]
    pub fn cells(&self) -> impl ExactSizeIterator<Item = usize> {
        self.numbers.iter().map(|&number| self.first + usize::from(number))
    }

    /// Writes the real parts of displacements to the neighbours, one lane to a cell. Lanes that are left over repeat the first.
    #[inline(always)]
    pub fn fill_ring<S: Scalar>(&self, positions: &[Vector<S>], ring: &mut [Vector<Lanes>]) {
        for lane in 0..Lanes::WIDTH {
            let number = self.numbers[if lane < self.numbers.len() { lane } else { 0 }];
            let to = self.tessellation.displacements(positions, self.first + usize::from(number));
            for (point, d) in ring.iter_mut().zip(to) {
                point.x.0[lane] = d.x.real();
                point.y.0[lane] = d.y.real();
            }
        }
    }
}
