//! Cells that go through the same operations, because they have as many sides.

use crate::{Arithmetic, Lanes, Scalar, Tessellation, Vector};

/// At most [`BySides::MOST_CELLS`] cells in the order of their numbers of sides, to be worked on in [`Lanes`].
#[derive(Debug)]
pub struct BySides<'a> {
    tessellation: &'a Tessellation,
    order: [u32; BySides::MOST_CELLS],
    /// Where the cells of each number of sides begin, the others at zero; and where all end.
    begin: [u16; BySides::MOST_SIDES + 2],
}

impl<'a> BySides<'a> {
    /// Most cells.
    pub const MOST_CELLS: usize = 1024;

    /// Most sides of cells that are worked on together.
    pub const MOST_SIDES: usize = 15;

    /// Counts the sides of cells.
    pub fn new(tessellation: &'a Tessellation, cells: impl Iterator<Item = usize> + Clone) -> Self {
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
        let mut next = begin;
        for cell in cells {
            let next = &mut next[sides(cell)];
            order[usize::from(*next)] = cell as u32;
            *next += 1;
        }
        Self { tessellation, order, begin }
    }

    #[inline(always)]
    fn with(&self, sides: usize) -> &[u32] {
        &self.order[usize::from(self.begin[sides])..usize::from(self.begin[sides + 1])]
    }

    /// The cells that are open or have too many sides, or too few.
    pub fn others(&self) -> impl Iterator<Item = usize> {
        self.with(0).iter().map(|&cell| cell as usize)
    }

    /// The cells of a number of sides, as many at once as there are lanes; fewer in the end.
    #[inline(always)]
    pub fn batches(&self, sides: usize) -> impl Iterator<Item = Batch<'_>> {
        let batch = |cells| Batch { tessellation: self.tessellation, cells };
        self.with(sides).chunks(Lanes::WIDTH).map(batch)
    }
}

/// As many cells as there are lanes, or fewer, with one number of sides.
#[derive(Debug, Clone, Copy)]
pub struct Batch<'a> {
    tessellation: &'a Tessellation,
    cells: &'a [u32],
}

impl Batch<'_> {
    /// Gives each lane that has a cell to a function, with the cell. The loop is unrolled, so that lanes are known when it is compiled.
    #[inline(always)]
    pub fn each(&self, mut work: impl FnMut(usize, usize)) {
        for lane in 0..Lanes::WIDTH {
            if let Some(&cell) = self.cells.get(lane) {
                work(lane, cell as usize);
            }
        }
    }

    /// Writes displacements to the neighbours, a lane to a cell, by a function that puts a number into a lane. Lanes that are left over
    /// repeat the first.
    #[inline(always)]
    pub fn fill_ring<S: Scalar, L: Arithmetic>(
        &self,
        positions: &[Vector<S>],
        ring: &mut [Vector<L>],
        put: impl Fn(&mut L, usize, S),
    ) {
        for lane in 0..Lanes::WIDTH {
            let cell = self.cells[if lane < self.cells.len() { lane } else { 0 }];
            let to = self.tessellation.displacements(positions, cell as usize);
            for (point, d) in ring.iter_mut().zip(to) {
                put(&mut point.x, lane, d.x);
                put(&mut point.y, lane, d.y);
            }
        }
    }
}
