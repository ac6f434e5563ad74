//! Cholesky factors of the normal equations of movies: cells on a square lattice, in some frames, coupled to all within four steps of the king and to
//! those within three in the frame before, two unknowns each.
//!
//! `cargo bench -p voronudge-linalg`; with `RAYON_NUM_THREADS=1` on one core

#![allow(clippy::expect_used, reason = "a benchmark of fixed input")]

use divan::Bencher;
use voronudge_linalg::{Cholesky, DissectedCholesky, DissectedPattern, SymmetricMatrix};

fn main() {
    divan::main();
}

/// Cells along a side and frames.
const MOVIES: [[usize; 2]; 5] = [[10, 1], [18, 1], [18, 6], [32, 1], [32, 4]];

type Places = Vec<Option<[f64; 3]>>;

fn movie([side, frames]: [usize; 2]) -> (SymmetricMatrix, Places) {
    let cell = |frame: usize, y: usize, x: usize| (frame * side + y) * side + x;
    let within = |at: usize, reach: usize| at.saturating_sub(reach)..side.min(at + reach + 1);
    let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
    let mut places = Vec::new();
    for own in 0..frames * side * side {
        let (frame, y, x) = (own / (side * side), own / side % side, own % side);
        places.push(Some([x as f64, y as f64, frame as f64]));
        let near = |frame: usize, reach: usize| {
            within(y, reach).flat_map(move |y| within(x, reach).map(move |x| cell(frame, y, x)))
        };
        let later = if frame + 1 < frames { Some(near(frame + 1, 3)) } else { None };
        let others: Vec<usize> =
            near(frame, 4).filter(|other| *other > own).chain(later.into_iter().flatten()).collect();
        for axis in 0..2 {
            row.push(2 * own + axis);
            value.push(400.0);
            if axis == 0 {
                row.push(2 * own + 1);
                value.push(0.2);
            }
            for other in others.iter().flat_map(|other| [2 * other, 2 * other + 1]) {
                row.push(other);
                value.push(((own + other) as f64).sin());
            }
            start.push(row.len());
        }
    }
    (SymmetricMatrix::new(start, row, value).expect("a lower triangle"), places)
}

fn factorised(size: [usize; 2]) -> DissectedCholesky {
    let (matrix, places) = movie(size);
    DissectedPattern::new(&matrix, &places).and_then(|own| own.factor(&matrix)).expect("a dominant diagonal")
}

#[divan::bench(args = MOVIES)]
fn pattern(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    let (matrix, places) = movie(size);
    bencher.bench_local(|| DissectedPattern::new(&matrix, &places));
}

#[divan::bench(args = MOVIES)]
fn factor(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    let (matrix, places) = movie(size);
    let pattern = DissectedPattern::new(&matrix, &places).expect("places of all cells");
    bencher.bench_local(|| pattern.factor(&matrix));
}

/// Pattern and factor of faer, in the order of approximate minimum degree.
#[divan::bench(args = MOVIES)]
fn minimum_degree(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    let (matrix, _) = movie(size);
    bencher.bench_local(|| Cholesky::new(&matrix));
}

/// For six right-hand sides.
#[divan::bench(args = MOVIES)]
fn solve(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    let factor = factorised(size);
    let mut right = vec![1.0; 12 * size[0] * size[0] * size[1]];
    bencher.bench_local(|| factor.solve(&mut right));
}

#[divan::bench(args = MOVIES)]
fn entries_of_the_inverse(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    let factor = factorised(size);
    bencher.bench_local(|| factor.selected_inverse());
}
