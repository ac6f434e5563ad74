//! Tessellation of disordered periodic tissues, per cell and against the number of cells. One thread.
//!
//! `cargo bench -p voronudge-geometry`

#![allow(clippy::expect_used, reason = "a benchmark of fixed input")]

use divan::{Bencher, counter::ItemsCount};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};

fn main() {
    divan::main();
}

/// A jittered square lattice: disordered, without coincident cells, at unit density. `Shuffled` numbers the cells in
/// random order, so that neighbours are far apart in memory.
fn tissue(side: usize, order: Order) -> (Vec<Vector<f64>>, Domain) {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut positions: Vec<_> = (0..side * side)
        .map(|i| {
            let mut at = |k: usize| k as f64 + rng.random_range(0.05..0.95);
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

#[divan::bench(args = [(10, Order::Rows), (100, Order::Rows), (1000, Order::Rows), (1000, Order::Shuffled)], sample_count = 10)]
fn tessellate(bencher: Bencher, (side, order): (usize, Order)) {
    let (positions, domain) = tissue(side, order);
    bencher
        .counter(ItemsCount::new(positions.len()))
        .bench(|| Tessellation::new(divan::black_box(&positions), domain));
}
