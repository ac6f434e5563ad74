//! Forces, columns and the sparse Jacobian at a given tessellation.
//!
//! `RAYON_NUM_THREADS=1 cargo bench -p voronudge-model` for figures per cell on one core.

#![allow(clippy::expect_used, reason = "a benchmark of fixed input")]

use divan::{Bencher, counter::ItemsCount};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_model::{BlockMatrix, Effect, HalfEdgeForces, JacobianBuilder, Model, Parameters, jvp, vjp};

fn main() {
    divan::main();
}

/// A jittered square lattice of `side²` cells at unit density, and the base model.
fn tissue(side: usize) -> (Vec<Vector<f64>>, Tessellation, Model<f64>) {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let positions: Vec<_> = (0..side * side)
        .map(|i| {
            let mut at = |k: usize| k as f64 + rng.random_range(0.2..0.8);
            Vector::new(at(i % side), at(i / side))
        })
        .collect();
    let cell_box = PeriodicBox::new([side as f64; 2]).expect("a positive box");
    let tessellation = Tessellation::new(&positions, Domain::Periodic(cell_box)).expect("distinct cells");
    let parameters = Parameters { chirality: 1.0, ..Parameters::default() };
    (positions, tessellation, Model::chiral_voronoi(&parameters))
}

#[divan::bench(args = [10, 100, 1000])]
fn velocities(bencher: Bencher, side: usize) {
    let (positions, tessellation, model) = tissue(side);
    let (mut forces, mut v) = (HalfEdgeForces::default(), Vec::new());
    bencher.counter(ItemsCount::new(positions.len())).bench_local(|| {
        forces.evaluate(&tessellation, divan::black_box(&positions), &model, &mut v);
    });
}

#[divan::bench(args = [10, 100, 1000], max_time = 20)]
fn sparse_jacobian(bencher: Bencher, side: usize) {
    let (positions, tessellation, model) = tissue(side);
    let (mut builder, mut matrix) = (JacobianBuilder::default(), BlockMatrix::default());
    bencher.counter(ItemsCount::new(positions.len())).bench_local(|| {
        builder.build(&tessellation, divan::black_box(&positions), &model, &mut matrix);
    });
}

/// `J u`, beside `velocities`.
#[divan::bench(args = [10, 100, 1000])]
fn jacobian_times_vector(bencher: Bencher, side: usize) {
    let (positions, tessellation, model) = tissue(side);
    bencher
        .counter(ItemsCount::new(positions.len()))
        .bench_local(|| jvp(&tessellation, divan::black_box(&positions), &model, &positions));
}

/// `Jᵀ w`, beside `velocities`.
#[divan::bench(args = [10, 100, 1000])]
fn transposed_jacobian_times_vector(bencher: Bencher, side: usize) {
    let (positions, tessellation, model) = tissue(side);
    bencher
        .counter(ItemsCount::new(positions.len()))
        .bench_local(|| vjp(&tessellation, divan::black_box(&positions), &model, &positions));
}

/// The base model and one further effect.
const EFFECTS: [&str; 4] = ["alpha_area", "nematic_stress", "p0_gradient", "internal_drag"];

fn with(id: &str) -> (Vec<Vector<f64>>, Tessellation, Model<f64>) {
    let (positions, tessellation, model) = tissue(30);
    let effect = Effect::from_id(id).expect("an effect of the catalogue");
    let columns = effect.columns(&model.environment, tessellation.domain()).expect("an effect that applies");
    let model = columns.into_iter().fold(model, |model, column| model.with(column, 0.1));
    (positions, tessellation, model)
}

#[divan::bench(args = EFFECTS)]
fn velocities_with(bencher: Bencher, id: &str) {
    let (positions, tessellation, model) = with(id);
    let (mut forces, mut v) = (HalfEdgeForces::default(), Vec::new());
    bencher.counter(ItemsCount::new(positions.len())).bench_local(|| {
        forces.evaluate(&tessellation, divan::black_box(&positions), &model, &mut v);
    });
}

#[divan::bench(args = EFFECTS, max_time = 5)]
fn sparse_jacobian_with(bencher: Bencher, id: &str) {
    let (positions, tessellation, model) = with(id);
    let (mut builder, mut matrix) = (JacobianBuilder::default(), BlockMatrix::default());
    bencher.counter(ItemsCount::new(positions.len())).bench_local(|| {
        builder.build(&tessellation, divan::black_box(&positions), &model, &mut matrix);
    });
}
