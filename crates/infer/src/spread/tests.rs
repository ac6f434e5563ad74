use super::columns::columns;
use super::gram::Gram;
use super::levels::{Held, Likelihood};
use super::*;
use crate::CoefficientSpace;
use crate::Constraints;
use crate::noise::SMALLEST_VELOCITY_NOISE;
use crate::residuals::residuals;
use voronudge_model::Structure;

/// −2 log L with dense matrices, from the definition, for cells that differ in two parameters.
#[test]
fn the_criterion_is_that_of_the_dense_form() {
    let frames = [crate::sample::observation(0.03, 0.05, 1)];
    let space = CoefficientSpace::new(&Constraints::default()).unwrap();
    let structure = Structure::base(1.0);
    let levels = NoiseLevels { position: 0.03, velocity: 0.05 };
    let objective = Objective::new(&frames, &structure, &space, levels);
    let parameters = [CellParameter::PreferredPerimeter, CellParameter::Chirality];
    let layout = Layout::new(&frames, &parameters).unwrap();
    let u = DVector::from_fn(72, |i, _| 0.05 * (i as f64).sin());
    let mut at = vec![0.1, 3.9, 1.0, 1.6];
    let reference = space.coefficients(&at);
    let own = OwnParts { layout: &layout, deviations: &u, reference: &reference };
    let objective = Objective { own: Some(&own), ..objective };
    at.extend((0..72).map(|k| 0.01 * f64::from(k).sin()));
    let equations = objective.linearise(&at).unwrap();
    let of_cells = columns(&objective, &at, &layout).unwrap();
    let log_k = 0.7;
    let gram = Gram::new(&equations, &of_cells, log_k, &u).unwrap();
    let likelihood = Likelihood { layout: &layout, products: &gram.reduced, left: 68.0 };
    let variances = Variances { velocity: -5.0, of_cells: vec![Some(-6.0), Some(-4.0)] };

    let (free, nudges) = objective.split(&at);
    // Columns of the coefficients are those of cells that are alike.
    let alike = objective.displaced(0, nudges[0]).unwrap();
    let c = space.coefficients(free);
    let columns = alike.evaluate(c.as_slice()).by_coefficient;
    let differing = own.frames(&frames).unwrap();
    let differing = Objective { frames: &differing, own: None, ..objective };
    let nudged = differing.displaced(0, nudges[0]).unwrap();
    let evaluated = nudged.evaluate(c.as_slice());
    let j = DMatrix::from_row_slice(72, 72, &nudged.jacobian(c.as_slice(), &evaluated.of_cells).to_dense());
    let x = DMatrix::from_fn(72, 4, |row, term| columns[term][row / 2][row % 2]);
    let rest: Vec<f64> =
        residuals(&frames[0], &evaluated.predicted).iter().flat_map(|(_, rest)| [rest.x, rest.y]).collect();
    // Deviations by finite differences: velocities are linear in them.
    let z = DMatrix::from_columns(
        &(0..72)
            .map(|i| {
                let mut other = u.clone();
                other[i] += 1.0;
                let moved = OwnParts { deviations: &other, ..own }.frames(&frames).unwrap();
                let moved = Objective { frames: &moved, ..differing }.displaced(0, nudges[0]).unwrap();
                let moved = moved.evaluate(c.as_slice()).predicted;
                DVector::from_fn(72, |row, _| (moved[row / 2] - evaluated.predicted[row / 2])[row % 2])
            })
            .collect::<Vec<_>>(),
    );
    let y = DVector::from_vec(rest) + &j * DVector::from_column_slice(nudges[0]) + &z * &u;
    let dense = |at: &Variances| {
        let variance = at.velocity.exp();
        let spread = |i: usize| at.of_cells[i / 36].map_or(0.0, f64::exp);
        let prior = DMatrix::from_diagonal(&DVector::from_fn(72, |i, _| spread(i)));
        let v = (DMatrix::identity(72, 72) + &j * j.transpose() / log_k.exp()) * variance
            + &z * prior * z.transpose();
        let inverse = v.clone().try_inverse().unwrap();
        let information = x.transpose() * &inverse * &x;
        let beta = information.clone().try_inverse().unwrap() * x.transpose() * &inverse * &y;
        let left = &y - &x * beta;
        let log_det = |m: &DMatrix<f64>| m.clone().symmetric_eigen().eigenvalues.map(|e| e.ln()).sum();
        log_det(&v) + log_det(&information) + (left.transpose() * inverse * &left).sum()
    };
    let (found, least) = likelihood.most_likely(&variances, Held::default()).unwrap();
    assert!((least - dense(&found)).abs() < 1e-7 * least.abs().max(1.0), "{least} {}", dense(&found));
    // It is a minimum.
    for (which, change) in [(0, 0.2), (0, -0.2), (1, 0.5), (1, -0.5), (2, 0.5), (2, -0.5)] {
        let mut aside = found.clone();
        match which {
            0 => aside.velocity += change,
            q => aside.of_cells[q - 1] = aside.of_cells[q - 1].map(|own| own + change),
        }
        assert!(dense(&aside) > least - 0.01, "{which} {change}: {} {least}", dense(&aside));
    }
}

#[test]
fn data_without_errors_have_variances_too() {
    let frames = [crate::sample::observation(0.0, 0.0, 1)];
    let space = CoefficientSpace::new(&Constraints::default()).unwrap();
    let structure = Structure::base(1.0);
    let levels = NoiseLevels { position: 0.001, velocity: 0.001 };
    let objective = Objective::new(&frames, &structure, &space, levels);
    let layout = Layout::new(&frames, &[CellParameter::PreferredPerimeter]).unwrap();
    let nothing = DVector::zeros(36);
    let mut at = crate::sample::COEFFICIENTS.to_vec();
    at.extend([0.0; 72]);
    let equations = objective.linearise(&at).unwrap();
    let of_cells = columns(&objective, &at, &layout).unwrap();
    let gram = Gram::new(&equations, &of_cells, 0.0, &nothing).unwrap();
    let likelihood = Likelihood { layout: &layout, products: &gram.reduced, left: 68.0 };
    let start = Variances { velocity: -50.0, of_cells: vec![Some(-6.0)] };
    let (found, _) = likelihood.most_likely(&start, Held::default()).unwrap();
    assert!((found.velocity - 2.0 * SMALLEST_VELOCITY_NOISE.ln()).abs() < 1e-12, "{found:?}");
}
