//! What measurements cost per cell, on a chiral liquid: one state each, at 100 and 10⁴ cells.
//!
//! `cargo bench -p voronudge-simulate --bench measurements`; with `RAYON_NUM_THREADS=1` for one core. The wave vectors of the
//! structure factor are those up to 4π/ℓ₀ at 100 cells and up to π/ℓ₀ at 10⁴; displacements are those of ten frames.

#![allow(clippy::expect_used)]

use divan::{Bencher, black_box, counter::ItemsCount};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_observables::{
    TransitionCounter, hexatic, mean_square_displacement, shape_indices, structure_factor,
};
use voronudge_simulate::measure::{LyapunovSchedule, largest_lyapunov_exponent};
use voronudge_simulate::{RandomPlacement, Simulation, generator, sort_in_space};

fn main() {
    divan::main();
}

const SIDES: [usize; 2] = [10, 100];

fn liquid(side: usize) -> Simulation {
    let cell_box = PeriodicBox::new([side as f64; 2]).expect("a positive box");
    let mut positions = RandomPlacement::new(side * side, cell_box).draw(&mut generator(7)).expect("cells");
    sort_in_space(&mut positions, &cell_box);
    let model = Model::chiral_voronoi(&Parameters { chirality: 1.0, ..Parameters::default() });
    let mut simulation =
        Simulation::new(positions, Domain::Periodic(cell_box), model).expect("distinct cells");
    (0..200).for_each(|_| simulation.step(0.01).expect("a small step"));
    simulation
}

/// Items are cells.
fn per_cell(bencher: Bencher, side: usize, measure: impl Fn(&Simulation) -> f64) {
    let simulation = liquid(side);
    let count = ItemsCount::new(side * side);
    bencher.counter(count).bench_local(|| measure(black_box(&simulation)));
}

#[divan::bench(args = SIDES)]
fn hexatic_order(bencher: Bencher, side: usize) {
    per_cell(bencher, side, |now| hexatic(now.tessellation(), now.positions()).mean_modulus);
}

#[divan::bench(args = SIDES)]
fn shapes(bencher: Bencher, side: usize) {
    per_cell(bencher, side, |now| shape_indices(now.tessellation(), now.positions())[0]);
}

#[divan::bench(args = SIDES, sample_count = 10)]
fn structure_factors(bencher: Bencher, side: usize) {
    let cell_box = PeriodicBox::new([side as f64; 2]).expect("a positive box");
    let largest = if side > 10 { PI } else { 4.0 * PI };
    per_cell(bencher, side, |now| {
        structure_factor(now.positions(), now.velocities(), &cell_box, largest)[0].density
    });
}

#[divan::bench(args = SIDES)]
fn displacements_of_ten_frames(bencher: Bencher, side: usize) {
    let frames = vec![liquid(side).positions().to_vec(); 10];
    bencher
        .counter(ItemsCount::new(side * side))
        .bench_local(|| mean_square_displacement(black_box(&frames)).expect("frames of the same cells"));
}

/// From a state to that a step later and back.
#[divan::bench(args = SIDES)]
fn transitions_of_two_steps(bencher: Bencher, side: usize) {
    let mut simulation = liquid(side);
    let before = simulation.tessellation().clone();
    simulation.step(0.01).expect("a small step");
    let mut counter = TransitionCounter::default();
    bencher.counter(ItemsCount::new(side * side)).bench_local(|| {
        counter.count(black_box(&before)) + counter.count(black_box(simulation.tessellation()))
    });
}

/// Fifty steps of tangent dynamics with what they begin with; items are steps of cells.
#[divan::bench(args = SIDES, sample_count = 5, sample_size = 1)]
fn lyapunov_step(bencher: Bencher, side: usize) {
    let simulation = liquid(side);
    let schedule = LyapunovSchedule { time_step: 0.01, transient: 10, steps: 40, renormalisation: 10 };
    let domain = simulation.tessellation().domain();
    bencher.counter(ItemsCount::new(50 * side * side)).bench_local(|| {
        largest_lyapunov_exponent(simulation.positions(), domain, simulation.model(), &schedule, 1, |_| {
            ControlFlow::Continue(())
        })
        .expect("a liquid")
        .value
    });
}
