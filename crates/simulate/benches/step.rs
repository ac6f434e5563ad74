//! One Runge–Kutta step (four tessellations, four evaluations of the forces) of a disordered chiral tissue.
//!
//! `cargo bench -p voronudge-simulate`; with `RAYON_NUM_THREADS=1` for one core.

#![allow(clippy::expect_used)]

use divan::{Bencher, counter::ItemsCount};
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{RandomPlacement, Simulation, generator};

fn main() {
    divan::main();
}

#[divan::bench(args = [10, 100, 1000], sample_count = 5)]
fn step(bencher: Bencher, side: usize) {
    let cell_box = PeriodicBox::new([side as f64; 2]).expect("a positive box");
    let cells = side * side;
    let positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(7)).expect("cells");
    let model = Model::chiral_voronoi(&Parameters { chirality: 1.0, ..Parameters::default() });
    let mut simulation =
        Simulation::new(positions, Domain::Periodic(cell_box), model).expect("distinct cells");
    bencher
        .counter(ItemsCount::new(cells))
        .bench_local(|| simulation.step(divan::black_box(0.01)).expect("a small step"));
}
