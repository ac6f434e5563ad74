//! Cells that differ from each other.

use num_dual::Dual64;
use std::sync::Arc;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_model::{
    CellFactors, CellParameter, Environment, Model, Parameters, cell_derivatives, jacobian, velocities,
};

fn tissue() -> (Tessellation, Vec<Vector<f64>>) {
    let positions: Vec<Vector<f64>> = (0..36)
        .map(|i| {
            let x = f64::from(i);
            Vector::new(f64::from(i % 6) + 0.3 * x.sin(), f64::from(i / 6) + 0.3 * (2.0 * x).cos())
        })
        .collect();
    let domain = Domain::Periodic(PeriodicBox::new([6.0, 6.0]).unwrap());
    (Tessellation::new(&positions, domain).unwrap(), positions)
}

fn uneven() -> CellFactors {
    with_more_of(None)
}

/// The same with a half more of a parameter of a cell.
fn with_more_of(one: Option<(CellParameter, usize)>) -> CellFactors {
    CellParameter::ALL.into_iter().enumerate().fold(CellFactors::default(), |factors, (k, parameter)| {
        let own = (0..36).map(|i| 1.0 + 0.2 * (i as f64 + k as f64).sin());
        let more = |cell: usize| if one == Some((parameter, cell)) { 0.5 } else { 0.0 };
        factors.with(parameter, own.enumerate().map(|(cell, own)| own + more(cell)).collect()).unwrap()
    })
}

fn model(factors: CellFactors) -> Model<f64> {
    let model = Model::chiral_voronoi(&Parameters { chirality: 0.7, ..Parameters::default() });
    model.within(&Arc::new(Environment::default().with_cell_factors(factors).unwrap()))
}

/// Velocities are linear in a multiple: a finite difference is exact to rounding. Momentum is conserved.
#[test]
fn derivatives_are_finite_differences() {
    let (tessellation, positions) = tissue();
    let before = velocities(&tessellation, &positions, &model(uneven()));
    for parameter in CellParameter::ALL {
        let found = cell_derivatives(&tessellation, &positions, &model(uneven()), parameter);
        let cell = 17;
        let after = velocities(&tessellation, &positions, &model(with_more_of(Some((parameter, cell)))));
        let mut expected = vec![Vector::zeros(); 36];
        expected[cell] += found.on_cell[cell];
        for h in tessellation.ring(cell) {
            expected[tessellation.neighbour(h)] += found.on_neighbour[h];
        }
        let momentum: Vector<f64> = expected.iter().sum();
        let size = expected.iter().map(|v| v.norm()).fold(0.0, f64::max);
        assert!(momentum.norm() < 1e-12 && size > 1e-3, "{parameter:?} {size}");
        for ((a, b), slope) in after.iter().zip(&before).zip(&expected) {
            assert!(((a - b) * 2.0 - slope).norm() < 1e-12, "{parameter:?}");
        }
    }
}

/// The Jacobian of cells that differ is that of dual numbers through the velocities.
#[test]
fn the_jacobian_knows_that_cells_differ() {
    let (tessellation, positions) = tissue();
    let model = model(uneven());
    let found = jacobian(&tessellation, &positions, &model).to_dense();
    for column in 0..72 {
        let seed = |i: usize, axis: usize, x: f64| Dual64::new(x, f64::from(2 * i + axis == column));
        let moved: Vec<Vector<Dual64>> = positions
            .iter()
            .enumerate()
            .map(|(i, r)| Vector::new(seed(i, 0, r.x), seed(i, 1, r.y)))
            .collect();
        let v = velocities(&tessellation, &moved, &model.lift::<Dual64>());
        for (i, v) in v.iter().enumerate() {
            assert!((found[2 * i * 72 + column] - v.x.eps).abs() < 1e-10);
            assert!((found[(2 * i + 1) * 72 + column] - v.y.eps).abs() < 1e-10);
        }
    }
}

/// What is the same for all cells changes nothing if it is one, and nothing at all if it is a preferred area.
#[test]
fn one_preferred_area_for_all_is_a_gauge() {
    let (tessellation, positions) = tissue();
    let plain = velocities(&tessellation, &positions, &model(CellFactors::default()));
    let same = CellFactors::default().with(CellParameter::PreferredArea, vec![1.3; 36]).unwrap();
    let found = velocities(&tessellation, &positions, &model(same));
    assert!(plain.iter().zip(&found).all(|(a, b)| (a - b).norm() < 1e-12));
}

#[test]
fn factors_of_another_number_of_cells_are_refused() {
    let factors = CellFactors::default().with(CellParameter::Chirality, vec![1.0; 3]).unwrap();
    assert!(factors.clone().with(CellParameter::PreferredArea, vec![1.0; 4]).is_err());
    assert!(factors.clone().with(CellParameter::PreferredArea, vec![f64::NAN; 3]).is_err());
    let labelled = Environment::default().with_labels(vec![Some(1); 4]).unwrap();
    assert!(labelled.with_cell_factors(factors).is_err());
}
