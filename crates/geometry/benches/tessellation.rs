//! Tessellation of disordered periodic tissues, per cell and against the number of cells, and the parts of cells in the patches of a grid, per
//! patch. One thread.
//!
//! `cargo bench -p voronudge-geometry`

#![allow(clippy::expect_used, reason = "a benchmark of fixed input")]

use divan::{Bencher, counter::ItemsCount};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{
    Domain, Grid, MovingTessellation, Patch, PeriodicBox, Tessellation, Vector, overlaps, side_pieces,
};

fn main() {
    divan::main();
}

/// A jittered square lattice at unit density. `Shuffled` numbers the cells in random order, so that neighbours are far
/// apart in memory.
fn tissue(side: usize, order: Order, jitter: f64) -> (Vec<Vector<f64>>, Domain) {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut positions: Vec<_> = (0..side * side)
        .map(|i| {
            let mut at = |k: usize| k as f64 + 0.5 + rng.random_range(-jitter..jitter);
            Vector::new(at(i % side), at(i / side))
        })
        .collect();
    if let Order::Shuffled = order {
        for i in (1..positions.len()).rev() {
            positions.swap(i, rng.random_range(0..=i));
        }
    }
    let cell_box = PeriodicBox::new([side as f64; 2]).expect("a positive box");
    (positions, Domain::Periodic(cell_box))
}

#[derive(Debug, Clone, Copy)]
enum Order {
    Rows,
    Shuffled,
}

/// A disordered tissue tessellated anew in the same memory, as in a simulation or a fit.
#[divan::bench(args = [(10, Order::Rows), (100, Order::Rows), (1000, Order::Rows), (1000, Order::Shuffled)], sample_count = 10, sample_size = 3)]
fn renew(bencher: Bencher, (side, order): (usize, Order)) {
    let (positions, domain) = tissue(side, order, 0.3);
    let mut tessellation = Tessellation::new(&positions, domain).expect("distinct cells");
    bencher
        .counter(ItemsCount::new(positions.len()))
        .bench_local(|| tessellation.renew(divan::black_box(&positions)));
}

/// Almost random points, whose large empty circles need wider strips, in fresh memory.
#[divan::bench(args = [10, 100, 1000], sample_count = 10)]
fn new_from_almost_random_points(bencher: Bencher, side: usize) {
    let (positions, domain) = tissue(side, Order::Rows, 0.45);
    bencher
        .counter(ItemsCount::new(positions.len()))
        .bench(|| Tessellation::new(divan::black_box(&positions), domain));
}

/// Cells that move to and fro by a few per cent of their spacing, as in a stage of a Runge–Kutta step: flips.
#[divan::bench(args = [(10, Order::Rows), (100, Order::Rows), (1000, Order::Rows), (1000, Order::Shuffled)], sample_count = 10, sample_size = 3)]
fn follow(bencher: Bencher, (side, order): (usize, Order)) {
    let (positions, domain) = tissue(side, order, 0.3);
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let moved: Vec<_> = (positions.iter())
        .map(|r| r + Vector::new(rng.random_range(-0.01..0.01), rng.random_range(-0.01..0.01)))
        .collect();
    let mut moving = MovingTessellation::new(&positions, domain).expect("distinct cells");
    let mut there = false;
    bencher.counter(ItemsCount::new(positions.len())).bench_local(|| {
        there = !there;
        moving.renew(divan::black_box(if there { &moved } else { &positions }))
    });
}

/// Patches a half apart that overlap, as windows of a flow field do, over all of a tissue.
fn patches(side: usize, patch: Patch) -> Grid {
    let grid = Grid::new([0.25; 2], [0.5; 2], [2 * side; 2]).expect("positive spacings");
    grid.with_patch(patch)
}

const PATCHES: [(usize, Patch); 4] = [
    (10, Patch::Square(1.0)),
    (100, Patch::Square(1.0)),
    (10, Patch::Gaussian(0.7)),
    (100, Patch::Gaussian(0.7)),
];

/// What is found in each patch of a tissue.
fn in_patches<T>(
    bencher: Bencher,
    (side, patch): (usize, Patch),
    find: impl Fn(&Tessellation, &[Vector<f64>], &Grid) -> T,
) {
    let ((positions, domain), grid) = (tissue(side, Order::Rows, 0.3), patches(side, patch));
    let tessellation = Tessellation::new(&positions, domain).expect("distinct cells");
    bencher
        .counter(ItemsCount::new(grid.len()))
        .bench_local(|| find(&tessellation, divan::black_box(&positions), &grid));
}

/// The area of each cell in each patch.
#[divan::bench(args = PATCHES, sample_count = 10)]
fn areas_in_patches(bencher: Bencher, tissue: (usize, Patch)) {
    in_patches(bencher, tissue, overlaps);
}

/// The pieces of sides in each patch, by which these areas change.
#[divan::bench(args = PATCHES, sample_count = 10)]
fn sides_in_patches(bencher: Bencher, tissue: (usize, Patch)) {
    in_patches(bencher, tissue, side_pieces);
}
