//! Equations of state: what is known of them on paper.

use std::ops::ControlFlow;
use voronudge_model::Parameters;
use voronudge_simulate::moduli::{UniformState, UniformTissue};

fn measured(tissue: &UniformTissue, seed: u64) -> UniformState {
    tissue.measure(seed, &|| ControlFlow::Continue(())).unwrap()
}

/// Cells that reach their preferred perimeter at the area that there is have no tension: what is left is `p = K_A (A_0 − 1/ρ)`, and no torque.
#[test]
fn a_floppy_tissue_without_chirality_has_the_pressure_of_its_areas() {
    let parameters = Parameters {
        area_elasticity: 0.5,
        preferred_perimeter: 4.2,
        chirality: 0.0,
        ..Parameters::default()
    };
    for density in [0.9, 1.0, 1.1] {
        let tissue = UniformTissue { parameters, density, cells: 64, times: [150.0, 10.0], time_step: None };
        let state = measured(&tissue, 3);
        let expected = 0.5 * (1.0 - 1.0 / density);
        assert!((state.pressure - expected).abs() < 1e-3, "{density}: {} for {expected}", state.pressure);
        assert!(state.torque.abs() < 1e-9, "{}", state.torque);
        assert!((state.shape_index - 4.2 * density.sqrt()).abs() < 1e-2, "{}", state.shape_index);
    }
}

/// What matters is P_0 √ρ, K_A/ρ and α: stresses in units of K_P are the same in any unit of length.
#[test]
fn stresses_are_the_same_in_any_unit_of_length() {
    let scale = 2.5_f64;
    let parameters = Parameters {
        area_elasticity: 0.1,
        preferred_perimeter: 4.0,
        chirality: 1.0,
        ..Parameters::default()
    };
    let tissue =
        UniformTissue { parameters, density: 1.2, cells: 50, times: [0.5, 0.5], time_step: Some(0.01) };
    let scaled = UniformTissue {
        parameters: Parameters {
            area_elasticity: 0.1 / (scale * scale),
            preferred_perimeter: 4.0 * scale,
            preferred_area: scale * scale,
            ..parameters
        },
        density: 1.2 / (scale * scale),
        ..tissue
    };
    let [a, b] = [measured(&tissue, 7), measured(&scaled, 7)];
    // Roundings differ, and chaos makes more of them: 1e-7 after this time.
    assert!((a.pressure - b.pressure).abs() < 1e-5, "{} for {}", b.pressure, a.pressure);
    assert!((a.torque - b.torque).abs() < 1e-5);
    assert!((a.shape_index - b.shape_index).abs() < 1e-6);
    assert!(
        (a.mean_square_velocity * scale * scale - b.mean_square_velocity).abs()
            < 1e-4 * b.mean_square_velocity
    );
}

/// The mirror image has the opposite torque and the same pressure, on average.
#[test]
fn a_mirror_image_turns_the_torque_round() {
    let at = |chirality: f64| {
        let parameters =
            Parameters { area_elasticity: 0.1, preferred_perimeter: 4.0, chirality, ..Parameters::default() };
        measured(
            &UniformTissue { parameters, density: 1.0, cells: 100, times: [10.0, 20.0], time_step: None },
            11,
        )
    };
    let [left, right] = [at(-1.0), at(1.0)];
    assert!((left.torque + right.torque).abs() < 0.05 * right.torque, "{} {}", left.torque, right.torque);
    // Perimeters cannot be less than those of regular hexagons.
    assert!(right.torque > 8.0 * 3f64.sqrt());
    assert!((left.pressure - right.pressure).abs() < 0.1 * right.pressure.abs());
}
