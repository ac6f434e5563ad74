//! Scaling functions that are put in and found again.

use rand::Rng;
use voronudge_simulate::collapse::{
    AMPLITUDE_EXPONENT, CollapseError, Exponents, VelocityPoint, collapse_scatter, critical_perimeter,
    fit_collapse, scaled_velocities,
};
use voronudge_simulate::generator;

/// ⟨v²⟩ made from a scaling function, with a relative scatter.
fn made(exponents: Exponents, scatter: f64) -> Vec<VelocityPoint> {
    let mut rng = generator(4);
    let mut points = Vec::new();
    for row in 0..7 {
        let chirality = 0.05 + 0.025 * f64::from(row);
        for column in 0..14 {
            let preferred_perimeter = critical_perimeter(chirality) - 0.37 + 0.06 * f64::from(column);
            let distance = preferred_perimeter - critical_perimeter(chirality);
            let x = chirality / distance.abs().powf(exponents.phi);
            let scaling = if distance > 0.0 { 1.0 + x.sqrt() } else { 0.3 * x / (1.0 + 0.1 * x) };
            let noise: f64 = rng.random_range(-1.0..1.0);
            let mean_square_velocity = chirality.powf(AMPLITUDE_EXPONENT)
                * distance.abs().powf(exponents.beta)
                * scaling
                * (scatter * noise).exp();
            points.push(VelocityPoint { preferred_perimeter, chirality, mean_square_velocity });
        }
    }
    points
}

#[test]
fn exponents_are_found_again() {
    for exponents in [Exponents::PAPER, Exponents { beta: 2.4, phi: 3.0 }] {
        let points = made(exponents, 0.1);
        let fit = fit_collapse(&points, Exponents { beta: 2.7, phi: 3.5 }, 60, 1).unwrap();
        for (found, truth) in [(fit.beta, exponents.beta), (fit.phi, exponents.phi)] {
            assert!((found.value - truth).abs() < 0.25, "{fit:?}");
            let [low, high] = found.interval;
            assert!(low < high && low - 0.2 < truth && truth < high + 0.2, "{fit:?}");
        }
        // A uniform scatter of ±0.1 has a standard deviation of 0.058; interpolated neighbours scatter too.
        assert!((0.03..0.12).contains(&fit.scatter), "{fit:?}");
        let other = Exponents { beta: exponents.beta + 1.0, phi: exponents.phi };
        assert!(collapse_scatter(&points, other).unwrap() > 2.0 * fit.scatter);
    }
}

/// α^a is no exponent of its own: `|α|^a |ΔP|^β V(x) = |ΔP|^(β + φa) x^a V(x)`.
#[test]
fn the_power_of_chirality_can_be_moved_into_beta() {
    let points = made(Exponents::PAPER, 0.1);
    let scaled = scaled_velocities(&points, Exponents::PAPER);
    let beta = Exponents::PAPER.beta + Exponents::PAPER.phi * AMPLITUDE_EXPONENT;
    for (point, scaled) in points.iter().zip(scaled) {
        let moved = point.mean_square_velocity / scaled.distance.abs().powf(beta);
        let expected = scaled.argument.powf(AMPLITUDE_EXPONENT) * scaled.value;
        assert!((moved / expected - 1.0).abs() < 1e-9);
    }
}

#[test]
fn too_few_rows_are_refused() {
    let mut points = made(Exponents::PAPER, 0.0);
    points.truncate(28);
    assert_eq!(collapse_scatter(&points, Exponents::PAPER), Err(CollapseError::Rows { rows: 2 }));
    points.iter_mut().for_each(|point| point.chirality = 0.0);
    assert_eq!(collapse_scatter(&points, Exponents::PAPER), Err(CollapseError::Rows { rows: 0 }));
}
