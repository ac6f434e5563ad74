//! What is found of Voronoi cells and their sides in the squares of a grid, square by square.

use crate::grid::Centres;
use crate::{CellPolygon, Grid, Tessellation, Vector};
use rayon::prelude::*;

/// Cells per task.
const CHUNK: usize = 256;

/// Lists of entries, one for each square of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct BySquare<T> {
    start: Vec<usize>,
    entries: Vec<T>,
}

impl<T: Copy> BySquare<T> {
    /// Takes entries with the index of their square; those of one square keep their order.
    pub(crate) fn new(squares: usize, parts: &[Vec<(usize, T)>]) -> Self {
        let mut start = vec![0; squares + 1];
        for (square, _) in parts.iter().flatten() {
            start[square + 1] += 1;
        }
        for square in 0..squares {
            start[square + 1] += start[square];
        }
        let (mut next, mut order) = (start.clone(), vec![(0, 0); start[squares]]);
        for (number, part) in parts.iter().enumerate() {
            for (k, (square, _)) in part.iter().enumerate() {
                order[next[*square]] = (number, k);
                next[*square] += 1;
            }
        }
        let entries = order.into_iter().map(|(part, k)| parts[part][k].1).collect();
        Self { start, entries }
    }

    /// Number of squares.
    pub fn len(&self) -> usize {
        self.start.len() - 1
    }

    /// Whether there is no square.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The entries of a square.
    pub fn square(&self, square: usize) -> &[T] {
        &self.entries[self.start[square]..self.start[square + 1]]
    }
}

/// The part of a cell in a square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// Index of the cell.
    pub cell: u32,
    /// Area of the cell's polygon within the square, all its images together; weighted in a Gaussian patch.
    pub area: f64,
    /// Its derivative by the side of the squares or the standard deviation of the patches.
    pub by_width: f64,
}

impl BySquare<Overlap> {
    /// Area of a square that polygons cover: all of it, except at the rim of an open field.
    pub fn covered(&self, square: usize) -> f64 {
        self.square(square).iter().map(|overlap| overlap.area).sum()
    }
}

/// A side from one vertex to the next, and the neighbour across it, relative to the cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side {
    pub from: Vector<f64>,
    pub to: Vector<f64>,
    pub displacement: Vector<f64>,
}

impl Side {
    /// Visits the squares that the side crosses, with the share of its length there and the midpoint of the piece.
    pub fn pieces(&self, centres: &Centres<'_>, mut visit: impl FnMut(usize, f64, Vector<f64>)) {
        self.crossed(centres, 0, [0.0, 1.0], |ix, part| {
            self.crossed(centres, 1, part, |iy, [s, t]| {
                let middle = self.from + (self.to - self.from) * (0.5 * (s + t));
                visit(centres.grid().index([ix, iy]), t - s, middle);
            });
        });
    }

    /// The pieces of the part `[s, t]` of the side, `0 ≤ s < t ≤ 1`, within the squares of each number along an axis.
    fn crossed(
        &self,
        centres: &Centres<'_>,
        axis: usize,
        [s, t]: [f64; 2],
        mut visit: impl FnMut(usize, [f64; 2]),
    ) {
        let (from, step) = (self.from[axis], self.to[axis] - self.from[axis]);
        let (one, other) = (from + s * step, from + t * step);
        for number in centres.numbers(axis, [one.min(other), one.max(other)]) {
            let [low, high] = centres.ends(axis, number);
            // A side along the line between two squares is in one of them.
            let part = match step {
                0.0 if low <= from && from < high => [s, t],
                0.0 => continue,
                _ if step > 0.0 => [s.max((low - from) / step), t.min((high - from) / step)],
                _ => [s.max((high - from) / step), t.min((low - from) / step)],
            };
            if part[0] < part[1] {
                visit(number, part);
            }
        }
    }
}

/// The least rectangle around a polygon: its lower left and its upper right corner.
pub(crate) fn bounds(polygon: &CellPolygon<f64>) -> [Vector<f64>; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY].map(|end| Vector::new(end, end));
    polygon.vertices().fold(none, |[low, high], vertex| [low.inf(&vertex), high.sup(&vertex)])
}

/// The half-edges of a closed cell, with the sides that they cross.
pub(crate) fn sides(
    tessellation: &Tessellation,
    polygon: &CellPolygon<f64>,
    cell: usize,
) -> impl Iterator<Item = (usize, Side)> {
    let last = polygon.vertices().last();
    let before = last.into_iter().chain(polygon.vertices());
    let ends = before.zip(polygon.vertices()).zip(polygon.ring());
    let side =
        |((from, to), displacement): ((_, _), &Vector<f64>)| Side { from, to, displacement: *displacement };
    tessellation.ring(cell).zip(ends.map(side))
}

/// Collects what `visit` finds for each closed cell, with the index of its square.
pub(crate) fn by_square<S: Default, T: Copy + Send + Sync>(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    grid: &Grid,
    visit: impl Fn(&mut S, &CellPolygon<f64>, usize, &mut Vec<(usize, T)>) + Sync,
) -> BySquare<T> {
    let cells = tessellation.len();
    let parts: Vec<Vec<(usize, T)>> = (0..cells.div_ceil(CHUNK))
        .into_par_iter()
        .map_init(<(CellPolygon<f64>, S)>::default, |(polygon, scratch), chunk| {
            let mut found = Vec::new();
            for cell in chunk * CHUNK..((chunk + 1) * CHUNK).min(cells) {
                if tessellation.is_closed(cell) {
                    polygon.fill(tessellation, positions, cell);
                    visit(scratch, polygon, cell, &mut found);
                }
            }
            found
        })
        .collect();
    BySquare::new(grid.len(), &parts)
}
