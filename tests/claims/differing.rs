//! Cells that differ in a simulation are found to differ in a fit.

use claims::Noise;
use claims::differing::Differing;
use std::ops::ControlFlow;
use voronudge_infer::{Inference, infer};
use voronudge_model::CellParameter::Chirality;

const NOISE: Noise = Noise { position: 0.01, velocity: 0.05 };

fn fit(tissue: &Differing) -> Inference {
    let frames = tissue.measured(NOISE, 1).unwrap();
    infer(&frames, &tissue.request(&[Chirality]), &mut |_| ControlFlow::Continue(())).unwrap()
}

/// A spread of α of a quarter, and which cells have more of it.
#[test]
fn a_spread_put_into_a_simulation_comes_out_of_the_fit() {
    let tissue = Differing::new(144, 1, 2, &[(Chirality, 0.25)]).unwrap();
    let result = fit(&tissue);
    let (found, truth) = (&result.spreads[0], tissue.spread(Chirality));
    assert!(found.p < 1e-4, "{}", found.p);
    assert!((found.value / truth - 1.0).abs() < 0.25, "{} {truth}", found.value);
    let (own, true_own) = (&found.deviations[0], &tissue.deviations[0].1);
    let product: f64 = own.iter().zip(true_own).map(|(a, b)| a[0] * b).sum();
    let size = |squares: f64| squares.sqrt();
    let correlation =
        product / size(own.iter().map(|a| a[0] * a[0]).sum()) / size(true_own.iter().map(|b| b * b).sum());
    assert!(correlation > 0.7, "{correlation}");
    // A cell is the same in both frames.
    assert_eq!(found.deviations[0], found.deviations[1]);
}

#[test]
fn cells_that_are_alike_are_not_found_to_differ() {
    let tissue = Differing::new(144, 2, 2, &[]).unwrap();
    let found = &fit(&tissue).spreads[0];
    assert!(found.p > 0.01, "{}", found.p);
    assert_eq!(found.interval[0], Some(0.0));
}
