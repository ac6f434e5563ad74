//! Cells in tiles that lie together, however they are numbered.

use crate::chunk::CHUNK;
use rayon::prelude::*;
use voronudge_geometry::{Tessellation, Vector};

/// Cells of a tile in the mean: some have more than others, and none more than [`CHUNK`].
const USUAL: usize = 800;

/// Share of half-edges between tiles up to which cells stay in the order of their numbers.
const LEAVING: f64 = 0.2;

/// All cells at positions (N), in tiles of [`CHUNK`] at most: in the order of their numbers if neighbours are near each other in it, else those in one
/// square of a grid over all of them.
pub(crate) fn tiles(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<Vec<u32>> {
    let (cells, domain) = (positions.len(), tessellation.domain());
    let leaving = |cell: usize| {
        let neighbours = tessellation.neighbours(cell).iter();
        neighbours.filter(|&&other| other as usize / CHUNK != cell / CHUNK).count()
    };
    let leaving = || (0..cells).into_par_iter().with_min_len(CHUNK).map(leaving).sum::<usize>();
    if cells <= CHUNK || leaving() as f64 <= LEAVING * tessellation.half_edges() as f64 {
        let tile = |first: usize| (first as u32..(first + CHUNK).min(cells) as u32).collect();
        return (0..cells).step_by(CHUNK).map(tile).collect();
    }
    let wrapped: Vec<Vector<f64>> = positions.par_iter().map(|r| domain.wrap(*r)).collect();
    let ends = |[low, high]: [Vector<f64>; 2], r: &Vector<f64>| [low.inf(r), high.sup(r)];
    let [low, high] = wrapped.iter().fold([wrapped[0]; 2], ends);
    let size = high - low;
    let side = (size.x * size.y * USUAL as f64 / cells as f64).sqrt();
    // Cells along a line have no area.
    let along = |length: f64| ((length / side).min(cells as f64 / USUAL as f64).ceil() as usize).max(1);
    let [columns, rows] = [along(size.x), along(size.y)];
    let square = |r: &Vector<f64>| {
        let number =
            |at: f64, length: f64, count: usize| ((at / length * count as f64) as usize).min(count - 1);
        number(r.y - low.y, size.y, rows) * columns + number(r.x - low.x, size.x, columns)
    };
    let squares: Vec<usize> = wrapped.par_iter().map(square).collect();
    let mut tiles: Vec<Vec<u32>> = vec![Vec::new(); columns * rows];
    for (cell, square) in squares.into_iter().enumerate() {
        tiles[square].push(cell as u32);
    }
    tiles.iter().flat_map(|tile| tile.chunks(CHUNK)).map(<[u32]>::to_vec).collect()
}
