//! One Runge–Kutta step (four repairs of the tessellation, four evaluations of the forces) of a chiral liquid that has
//! forgotten its start, per cell and force evaluation, against the number of cells.
//!
//! `cargo bench -p voronudge-simulate`; with `RAYON_NUM_THREADS=1` for one core.

#![allow(clippy::expect_used)]

use divan::{Bencher, counter::ItemsCount};
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{RandomPlacement, Simulation, generator, sort_in_space};

fn main() {
    divan::main();
}

/// The items are force evaluations of one cell.
#[divan::bench(args = [10, 32, 100, 316, 1000], sample_count = 12, sample_size = 1)]
fn step(bencher: Bencher, side: usize) {
    let cell_box = PeriodicBox::new([side as f64; 2]).expect("a positive box");
    let cells = side * side;
    let mut positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(7)).expect("cells");
    sort_in_space(&mut positions, &cell_box);
    let model = Model::chiral_voronoi(&Parameters { chirality: 1.0, ..Parameters::default() });
    let mut simulation =
        Simulation::new(positions, Domain::Periodic(cell_box), model).expect("distinct cells");
    for _ in 0..if side < 1000 { 400 } else { 40 } {
        simulation.step(0.01).expect("a small step");
    }
    bencher
        .counter(ItemsCount::new(4 * cells))
        .bench_local(|| simulation.step(divan::black_box(0.01)).expect("a small step"));
}
