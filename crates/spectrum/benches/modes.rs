//! All modes of a disordered chiral tissue, and the eight that grow fastest.
//!
//! `cargo bench -p voronudge-spectrum`; with `RAYON_NUM_THREADS=1` for one core.

#![allow(clippy::expect_used)]

use divan::Bencher;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_spectrum::{Character, Honeycomb, LinearProblem, Request, Selection, modes};

fn main() {
    divan::main();
}

/// A honeycomb with every cell moved at random, in the solid.
fn problem(side: usize) -> LinearProblem {
    let lattice =
        Honeycomb::new(side, side, voronudge_spectrum::Arrangement::RowsAlongX).expect("large enough");
    let mut rng = Pcg64::seed_from_u64(5);
    let positions: Vec<_> = lattice
        .positions()
        .iter()
        .map(|r| r + Vector::new(rng.random_range(-0.1..0.1), rng.random_range(-0.1..0.1)))
        .collect();
    let domain = Domain::Periodic(PeriodicBox::new(lattice.lengths()).expect("a box"));
    let tessellation = Tessellation::new(&positions, domain).expect("cells");
    let parameters = Parameters { preferred_perimeter: 3.2, chirality: 0.3, ..Parameters::default() };
    LinearProblem::new(&tessellation, &positions, &Model::chiral_voronoi(&parameters), |_| true)
        .expect("modes")
}

#[divan::bench(args = [10, 32], sample_count = 3)]
fn all(bencher: Bencher, side: usize) {
    let problem = problem(side);
    let request = Request { character: Character::Shape, ..Request::new(Selection::All) };
    bencher.bench_local(|| modes(&problem, &request, &mut |_, _, _| {}).expect("modes"));
}

#[divan::bench(args = [32, 100, 316], sample_count = 1)]
fn largest_8(bencher: Bencher, side: usize) {
    let problem = problem(side);
    let request = Request { character: Character::Shape, ..Request::new(Selection::Largest(8)) };
    bencher.bench_local(|| modes(&problem, &request, &mut |_, _, _| {}).expect("modes"));
}
