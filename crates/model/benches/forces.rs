//! Forces, columns and the sparse Jacobian at a given tessellation.
//!
//! `RAYON_NUM_THREADS=1 cargo bench -p voronudge-model` for figures per cell on one core.

#![allow(clippy::expect_used, reason = "a benchmark of fixed input")]

use divan::{Bencher, counter::ItemsCount};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;
use voronudge_geometry::{Domain, Grid, PeriodicBox, Tessellation, Vector};
use voronudge_model::{
    BlockMatrix, Effect, Environment, JacobianBuilder, Model, Parameters, VectorMap, VelocityAssembly, jvp,
    vjp,
};

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
    let (mut assembly, mut v) = (VelocityAssembly::default(), Vec::new());
    bencher.counter(ItemsCount::new(positions.len())).bench_local(|| {
        assembly.evaluate(&tessellation, divan::black_box(&positions), &model, &mut v);
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

/// The base model and one further effect; in open fields those that periodic boxes do not have.
fn effects() -> impl Iterator<Item = &'static str> {
    std::iter::once(BASE).chain(Effect::all().iter().map(|effect| effect.id).filter(|id| with(id).is_some()))
}

/// Nothing else.
const BASE: &str = "(base)";

fn with(id: &str) -> Option<(Vec<Vector<f64>>, Tessellation, Model<f64>)> {
    let (positions, tessellation, model) = tissue(30);
    let Some(effect) = Effect::from_id(id) else { return Some((positions, tessellation, model)) };
    let open = Tessellation::new(&positions, Domain::Open).expect("distinct cells");
    let grid = Grid::new([-1.0; 2], [1.0; 2], [32; 2]).expect("a grid");
    let surroundings = || {
        let map = VectorMap::new(grid, (0..grid.len()).map(|k| grid.centre(k)).collect())?;
        Environment::default()
            .with_map(map)
            .with_labels((0..positions.len()).map(|cell| Some((cell % 3) as i64)).collect())?
            .with_earlier(positions.iter().map(|r| Some(*r)).collect())?
            .with_beyond_edge((0..positions.len()).map(|cell| !open.is_closed(cell)).collect())
    };
    let environment = Arc::new(surroundings().expect("what effects refer to"));
    [tessellation, open].into_iter().find_map(|tessellation| {
        let columns = effect.columns(&environment, tessellation.domain()).ok()?;
        let model = columns.iter().fold(model.clone(), |model, column| model.with(*column, 0.1));
        (!columns.is_empty()).then(|| (positions.clone(), tessellation, model.within(&environment)))
    })
}

#[divan::bench(args = effects())]
fn velocities_with(bencher: Bencher, id: &str) {
    let (positions, tessellation, model) = with(id).expect("an effect that applies");
    let (mut assembly, mut v) = (VelocityAssembly::default(), Vec::new());
    bencher.counter(ItemsCount::new(positions.len())).bench_local(|| {
        assembly.evaluate(&tessellation, divan::black_box(&positions), &model, &mut v);
    });
}

#[divan::bench(args = effects(), max_time = 5)]
fn sparse_jacobian_with(bencher: Bencher, id: &str) {
    let (positions, tessellation, model) = with(id).expect("an effect that applies");
    let (mut builder, mut matrix) = (JacobianBuilder::default(), BlockMatrix::default());
    bencher.counter(ItemsCount::new(positions.len())).bench_local(|| {
        builder.build(&tessellation, divan::black_box(&positions), &model, &mut matrix);
    });
}
