//! One Runge–Kutta step (four repairs of the tessellation, four evaluations of the forces) of a chiral liquid that has
//! forgotten its start, per cell and force evaluation, against the number of cells.
//!
//! `cargo bench -p voronudge-simulate`; with `RAYON_NUM_THREADS=1` for one core.

#![allow(clippy::expect_used)]

use divan::{Bencher, counter::ItemsCount};
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{Direction, RandomPlacement, Simulation, generator, sort_in_space};

const PARAMETERS: Parameters<f64> = Parameters {
    area_elasticity: 0.1,
    perimeter_elasticity: 1.0,
    preferred_perimeter: 4.0,
    preferred_area: 1.0,
    chirality: 1.0,
};

fn main() {
    divan::main();
}

/// A liquid that has forgotten its start.
fn liquid(side: usize) -> Simulation {
    let cell_box = PeriodicBox::new([side as f64; 2]).expect("a positive box");
    let mut positions = RandomPlacement::new(side * side, cell_box).draw(&mut generator(7)).expect("cells");
    sort_in_space(&mut positions, &cell_box);
    let model = Model::chiral_voronoi(&PARAMETERS);
    let mut simulation =
        Simulation::new(positions, Domain::Periodic(cell_box), model).expect("distinct cells");
    for _ in 0..if side < 1000 { 400 } else { 40 } {
        simulation.step(0.01).expect("a small step");
    }
    simulation
}

/// A run with derivatives along D parameters, beside `step` of as many cells.
#[divan::bench(consts = [1, 2], sample_count = 12, sample_size = 100)]
fn differentiated_step<const D: usize>(bencher: Bencher) {
    let by = |name| Direction::parameter(name, &PARAMETERS).expect("a parameter");
    let directions: [Direction; D] = std::array::from_fn(|k| by(["alpha", "P_0"][k]));
    let mut simulation = liquid(10).along(&directions).expect("distinct cells");
    bencher
        .counter(ItemsCount::new(400_usize))
        .bench_local(|| simulation.step(divan::black_box(0.01)).expect("a small step"));
}

/// The items are force evaluations of one cell.
#[divan::bench(args = [10, 32, 100, 316, 1000], sample_count = 12, sample_size = 1)]
fn step(bencher: Bencher, side: usize) {
    let mut simulation = liquid(side);
    bencher
        .counter(ItemsCount::new(4 * side * side))
        .bench_local(|| simulation.step(divan::black_box(0.01)).expect("a small step"));
}
