//! The number of threads does not change a bit of any result.

use crate::samples::{jittered, parameters, periodic, random};
use std::error::Error;
use voronudge_geometry::{Domain, Tessellation};
use voronudge_model::{Model, jacobian, parameter_derivatives, stress, velocities};

/// Every bit of every result, as text of the exact kind.
fn results(cells: usize, domain: Domain) -> Result<Vec<u64>, voronudge_geometry::Error> {
    let positions = match domain {
        Domain::Open => jittered(cells / 50, 50, 0.35, 1),
        Domain::Periodic(b) => random(cells, b.lengths(), 2),
    };
    let tessellation = Tessellation::new(&positions, domain)?;
    let model = Model::chiral_voronoi(&parameters());
    let mut bits: Vec<u64> = Vec::new();
    for (a, b, image) in tessellation.edges() {
        bits.extend([u64::from(a), u64::from(b), u64::from(image[0] as u16), u64::from(image[1] as u16)]);
    }
    bits.extend(tessellation.triangles().iter().flat_map(|t| t.cells).map(u64::from));
    let mut numbers = |x: f64| bits.push(x.to_bits());
    velocities(&tessellation, &positions, &model).iter().flatten().copied().for_each(&mut numbers);
    let matrix = jacobian(&tessellation, &positions, &model);
    matrix.block.iter().flatten().copied().for_each(&mut numbers);
    stress(&tessellation, &positions, &model, |_| true).iter().flatten().copied().for_each(&mut numbers);
    let derivatives = parameter_derivatives(&tessellation, &positions, &parameters());
    derivatives.iter().flatten().flatten().copied().for_each(&mut numbers);
    bits.extend(matrix.column.iter().map(|&column| u64::from(column)));
    Ok(bits)
}

#[test]
fn results_are_the_same_for_any_number_of_threads() -> Result<(), Box<dyn Error>> {
    for domain in [periodic([80.0, 62.5])?, Domain::Open] {
        let with = |threads| -> Result<Vec<u64>, Box<dyn Error>> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            Ok(pool.install(|| results(5000, domain))?)
        };
        let one = with(1)?;
        assert!(one.len() > 100_000);
        for threads in [2, 4] {
            assert!(with(threads)? == one, "{threads} threads");
        }
    }
    Ok(())
}
