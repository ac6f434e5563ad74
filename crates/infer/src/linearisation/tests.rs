use super::*;
use crate::Observation;
use crate::position_rows::PositionRows;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Tessellation, Vector};
use voronudge_model::{Model, Parameters, jacobian};

/// The eliminated step solves the full dense system. One position is measured better than the others, one not at all.
#[test]
fn the_step_agrees_with_the_dense_normal_equations() {
    let positions: Vec<Vector<f64>> = (0..25)
        .map(|i| {
            let x = f64::from(i);
            Vector::new(f64::from(i % 5) + 0.3 * x.sin(), f64::from(i / 5) + 0.3 * (2.0 * x).cos())
        })
        .collect();
    let domain = Domain::Periodic(PeriodicBox::new([5.0, 5.0]).unwrap());
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    let model = Model::chiral_voronoi(&Parameters { chirality: 0.7, ..Parameters::default() });
    let jacobian = jacobian(&tessellation, &positions, &model);
    let (cells, free, spring, damping) = (25, 2, 0.3, 0.05);
    // Some velocities are missing.
    let rows: Vec<(usize, Vector<f64>, DMatrix<f64>)> = (0..cells)
        .filter(|cell| cell % 4 != 0)
        .map(|cell| {
            let x = cell as f64;
            (
                cell,
                Vector::new(x.sin(), x.cos()),
                DMatrix::from_fn(2, free, |i, j| (x + i as f64 + 3.0 * j as f64).cos()),
            )
        })
        .collect();
    let nudges: Vec<f64> = (0..cells).flat_map(|i| [0.01 * i as f64, -0.02]).collect();
    let (unseen, floor) = (7, 0.04);
    // Two places, far from each other.
    let (coupled, coupling) = ((21, 3), 0.1);
    let stiffness =
        |cell: usize| [1.0_f64, 4.0, 0.0][usize::from(cell == 3) + 2 * usize::from(cell == unseen)];
    let errors: Vec<f64> = (0..cells).map(|cell| stiffness(cell).powf(-0.5)).collect();
    let frame =
        Observation::new(0, positions.clone(), vec![None; cells], domain, FieldOfView::default()).unwrap();
    let frame = frame.with_position_errors(&errors);
    let positions = PositionRows::new(&frame, &tessellation, &positions, &nudges, free, None);
    let local = Local {
        left_out: 0,
        velocities: Rows { jacobian: &jacobian, rows: &rows },
        positions: positions.rows(),
        known: Vec::new(),
        nudges: &nudges,
        stiffness: Stiffness {
            of_blocks: (0..cells).map(|cell| if cell == unseen { floor } else { 0.0 }).collect(),
            couplings: vec![(coupled.0 as u32, coupled.1 as u32, coupling)],
        },
        free,
        places: (0..cells).map(|i| Some([(i % 5) as f64, (i / 5) as f64, 0.0])).collect(),
        chains: Vec::new(),
        dissections: &Dissections::default(),
    };
    let springs = |spring: f64| {
        let of = |i: usize| if i / 2 == unseen { floor } else { spring * stiffness(i / 2) };
        let mut held = DMatrix::from_diagonal(&DVector::from_fn(2 * cells, |i, _| of(i)));
        for axis in 0..2 {
            let (later, earlier) = (2 * coupled.0 + axis, 2 * coupled.1 + axis);
            held[(later, earlier)] -= coupling;
            held[(earlier, later)] -= coupling;
        }
        held
    };
    let linearised = Linearisation::new(local);
    let dense = DMatrix::from_row_slice(2 * cells, 2 * cells, &jacobian.to_dense());
    let n = 2 * cells;
    let (mut full, mut right) = (DMatrix::<f64>::zeros(n + free, n + free), DVector::<f64>::zeros(n + free));
    for (cell, residual, x) in &rows {
        let mut wide = DMatrix::zeros(2, n + free);
        wide.view_mut((0, 0), (2, n)).copy_from(&dense.rows(2 * cell, 2));
        wide.view_mut((0, n), (2, free)).copy_from(x);
        full += wide.transpose() * &wide;
        right += wide.transpose() * residual;
    }
    let held = springs(spring);
    let mut corner = full.view_mut((0, 0), (n, n));
    corner += &held + DMatrix::identity(n, n) * damping;
    let mut pulled = right.rows_mut(0, n);
    pulled -= &held * DVector::from_column_slice(&nudges);
    let expected = full.lu().solve(&right).unwrap();
    let eliminated = linearised.eliminate(spring, &vec![damping; n], Accuracy::OfResults).unwrap();
    let free_step = eliminated.schur.clone().lu().solve(&eliminated.gradient).unwrap();
    let step = eliminated.nudge_step(&free_step);
    let scale = expected.amax();
    assert!((0..free).all(|i| (free_step[i] - expected[n + i]).abs() < 1e-10 * scale));
    assert!((0..n).all(|i| (step[i] - expected[i]).abs() < 1e-10 * scale));
    // What is left of n by the springs: n − k tr (JᵀJ + kHᵀH + floor)⁻¹ HᵀH, dense.
    let mut seen = DMatrix::zeros(2 * rows.len(), n);
    for (k, (cell, ..)) in rows.iter().enumerate() {
        seen.view_mut((2 * k, 0), (2, n)).copy_from(&dense.rows(2 * cell, 2));
    }
    let inverse = (seen.transpose() * &seen + &held).try_inverse().unwrap();
    let taken: f64 =
        (0..n).filter(|i| i / 2 != unseen).map(|i| spring * stiffness(i / 2) * inverse[(i, i)]).sum();
    let df = linearised.degrees_of_freedom(spring).unwrap();
    assert!((df - (n as f64 - taken)).abs() < 1e-6, "{df} {}", n as f64 - taken);
    // W = I + J D⁻¹ Jᵀ, dense, with the stiffness D of the springs.
    let m = 2 * rows.len();
    let of_springs = held.determinant().ln();
    let compliance = held.try_inverse().unwrap();
    let w = DMatrix::identity(m, m) + &seen * compliance * seen.transpose();
    let inverse = w.clone().try_inverse().unwrap();
    let x = DMatrix::from_fn(m, free, |i, j| rows[i / 2].2[(i % 2, j)]);
    let residual = DVector::from_fn(m, |i, _| rows[i / 2].1[i % 2]);
    let y = residual + &seen * DVector::from_column_slice(&nudges);
    let whitened = linearised.whiten(spring).unwrap();
    assert!((whitened.free - x.transpose() * &inverse * &x).amax() < 1e-9);
    assert!((whitened.mixed - x.transpose() * &inverse * &y).amax() < 1e-9);
    assert!((whitened.data - (y.transpose() * &inverse * &y)[0]).abs() < 1e-9);
    let determinant = w.cholesky().unwrap().l().diagonal().iter().map(|d| 2.0 * d.ln()).sum::<f64>();
    // det (JᵀJ + D) = det W det D, without the k of each measured coordinate.
    let constant = of_springs - (2 * (cells - 1)) as f64 * spring.ln();
    assert!((whitened.log_determinant - determinant - constant).abs() < 1e-9);
    assert!((linearised.stiffness() - (46.0 + 8.0)).abs() < 1e-12);
}
