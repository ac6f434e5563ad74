//! Cells that differ in a simulation are found to differ in a fit.

use claims::Noise;
use claims::differing::Differing;
use std::ops::ControlFlow;
use voronudge_geometry::Vector;
use voronudge_infer::discover::{Discovery, Search, Verdict, discover};
use voronudge_infer::{FitParameter, Inference, Observation, Unkept, infer};
use voronudge_model::CellParameter::{self, Chirality, PreferredArea, PreferredPerimeter};

const NOISE: Noise = Noise { position: 0.01, velocity: 0.05 };

fn fit(tissue: &Differing, varied: CellParameter) -> Inference {
    let frames = tissue.measured(NOISE, 1).unwrap();
    infer(&frames, &tissue.request(&[varied]), &mut |_| ControlFlow::Continue(())).unwrap()
}

/// A spread of α of a quarter, and which cells have more of it.
#[test]
fn a_spread_put_into_a_simulation_comes_out_of_the_fit() {
    let tissue = Differing::new(144, 1, 2, &[(Chirality, 0.25)]).unwrap();
    let result = fit(&tissue, Chirality);
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

/// Were what a cell has of its own to follow the coefficients, these would come out too large and the spread too small by the same factor.
#[test]
#[ignore = "slow"]
fn spreads_do_not_grow_at_the_cost_of_what_all_cells_share() {
    for (parameter, size, shared) in [
        (PreferredArea, 0.2, FitParameter::AreaElasticity),
        (PreferredPerimeter, 0.04, FitParameter::PerimeterElasticity),
    ] {
        let tissue = Differing::new(196, 3, 2, &[(parameter, size)]).unwrap();
        let result = fit(&tissue, parameter);
        let (found, truth) = (&result.spreads[0], tissue.spread(parameter));
        assert!(found.p < 1e-3, "{}", found.p);
        // The share hangs on what is known of the coefficient that it is a share of.
        assert!((found.value / truth - 1.0).abs() < 0.4, "{} {truth}", found.value);
        let [low, high] = found.interval;
        assert!(low.unwrap() < truth && high.is_none_or(|high| truth < high), "{:?} {truth}", found.interval);
        let (estimate, truth) = (result.parameters.get(shared), tissue.truth(shared));
        assert!(estimate.covers(truth), "{estimate:?} {truth}");
    }
}

#[test]
fn cells_that_are_alike_are_not_found_to_differ() {
    let tissue = Differing::new(144, 2, 2, &[]).unwrap();
    let found = &fit(&tissue, Chirality).spreads[0];
    assert!(found.p > 0.01, "{}", found.p);
    assert_eq!(found.interval[0], Some(0.0));
}

/// The search for what is missing, without being told that cells may differ.
fn searched(tissue: &Differing, frames: &[Observation]) -> Discovery {
    discover(frames, &Search::new(tissue.request(&[])), &mut Unkept, &mut |_| ControlFlow::Continue(()))
        .unwrap()
}

#[test]
fn the_search_finds_that_cells_differ_and_says_that_this_predicts_no_other_cell() {
    let tissue = Differing::new(144, 1, 1, &[(Chirality, 0.2)]).unwrap();
    let found = searched(&tissue, &tissue.measured(NOISE, 1).unwrap());
    let named: Vec<&str> = found.selected.iter().map(|own| own.effect.id).collect();
    assert_eq!(named, ["alpha_heterogeneity"]);
    assert_eq!(found.verdict, Verdict::Partial);
    let (own, truth) = (&found.selected[0], tissue.spread(Chirality));
    assert!(own.coefficients[0].covers(truth), "{:?} {truth}", own.coefficients);
    assert!(own.size > 0.05 && own.share_of_excess > 0.8, "{} {}", own.size, own.share_of_excess);
    assert!(found.after.budget.unexplained < found.before.budget.unexplained + 0.01);
    let alike = Differing::new(144, 1, 1, &[]).unwrap();
    let nothing = searched(&alike, &alike.measured(NOISE, 1).unwrap());
    assert!(nothing.selected.is_empty());
}

/// Motion of its own of every cell, and a smooth flow, are no differences between cells: neither goes with the forces on a cell and its neighbours.
#[test]
#[ignore = "slow"]
fn what_cells_do_of_themselves_does_not_pose_as_cells_that_differ() {
    let tissue = Differing::new(144, 2, 1, &[]).unwrap();
    let frame = &tissue.measured(NOISE, 2).unwrap()[0];
    let pointing = |k: usize| 0.3 * Vector::new((2.4 * k as f64).cos(), (2.4 * k as f64).sin());
    let wave = |r: Vector<f64>| Vector::new(0.3, 0.2) * (1.047 * r.x + 0.524 * r.y).sin();
    for what in 0..2 {
        let mut frame = frame.clone();
        let added: Vec<Vector<f64>> = match what {
            0 => (0..frame.positions.len()).map(pointing).collect(),
            _ => frame.positions.iter().map(|r| wave(*r)).collect(),
        };
        let velocities = frame.velocities.values_mut().iter_mut().flatten();
        velocities.zip(added).for_each(|(v, own)| *v += own);
        let found = searched(&tissue, &[frame]);
        assert!(!found.cells_differ(), "{what}: {:?}", found.selected);
    }
}
