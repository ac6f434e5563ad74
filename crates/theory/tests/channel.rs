//! The continuum theory of a channel: conservation, the steady state known on paper, orders of convergence.

#![allow(clippy::unwrap_used, reason = "a test may fail anywhere")]

use voronudge_theory::{ChannelEvolution, ChannelMedium, ChannelTurnover, EquationOfState, Error};

fn turnover(extrusion_rate: f64) -> ChannelTurnover {
    ChannelTurnover { width: 12.0, extrusion_rate, extrusion_length: 1.4, proliferation_length: 0.5 }
}

fn settled(medium: ChannelMedium, rate: f64, cells: usize) -> ChannelEvolution {
    let mut flow = ChannelEvolution::new(medium, turnover(rate), cells).unwrap();
    assert!(flow.settle(1e-6 * rate, 400.0));
    flow
}

/// For slow turnover the density hardly varies and `v_x = ∫(k_prolif − k_extr)`. Sources are averaged over grid cells exactly, so that
/// velocities at the faces are exact but for the rest of the relaxation (1e-6) and the variation of the density (1e-5).
#[test]
fn the_steady_state_of_slow_turnover_is_the_one_in_closed_form() {
    let rate = 1e-5;
    let flow = settled(ChannelMedium::elastic(3.0, 4.5).unwrap(), rate, 24);
    let [v_x, v_y] = flow.velocities();
    for ((d, x), y) in flow.faces().iter().zip(&v_x).zip(&v_y) {
        assert!((x - turnover(rate).velocity(*d)).abs() < 1e-4 * rate, "{d}: {x}");
        assert!((y - 1.5 * x).abs() < 1e-12 * rate);
    }
}

/// Viscosity smooths the flow: against a grid four times finer the error falls by about four with the spacing.
#[test]
fn viscous_flow_converges_to_second_order() {
    let medium = ChannelMedium {
        longitudinal_viscosity: 0.5,
        shear_viscosity: 0.8,
        odd_shear_viscosity: 0.3,
        odd_bulk_viscosity: -0.1,
        ..ChannelMedium::elastic(3.0, 4.5).unwrap()
    };
    let at_three = |cells: usize| {
        let flow = settled(medium, 0.2, cells);
        let [v_x, v_y] = flow.velocities();
        [v_x[cells / 2], v_y[cells / 2]]
    };
    let [coarse, middle, fine] = [12, 24, 96].map(at_three);
    for axis in [0, 1] {
        let ratio = (coarse[axis] - fine[axis]) / (middle[axis] - fine[axis]);
        // (1 − 1/64)/(1/4 − 1/64) = 4.2 for second order.
        assert!((3.3..5.2).contains(&ratio), "{axis}: {ratio}");
    }
}

/// `v_y` obeys `v − η ∂_x² v = f` for a force that is known: cells at rest, pushed by a gradient alone. With odd viscosity only the
/// medium is rotated, without it `v_y` has the sign of `A − Kᵒ`.
#[test]
fn shear_viscosity_spreads_the_flow_along_the_channel() {
    let elastic = ChannelMedium::elastic(3.0, 4.5).unwrap();
    let viscous = ChannelMedium { shear_viscosity: 1.0, ..elastic };
    let [sharp, spread] = [elastic, viscous].map(|medium| settled(medium, 0.1, 48).velocities());
    // The same v_x, since cells are conserved; v_y smaller at its peak, larger far away. Both to far more than what the relaxation
    // leaves.
    let peak = |v: &[f64]| v.iter().copied().fold(0.0, f64::max);
    assert!((peak(&sharp[0]) - peak(&spread[0])).abs() < 1e-6);
    assert!(peak(&spread[1]) < 0.8 * peak(&sharp[1]));
    assert!(spread[1][40] > 1.2 * sharp[1][40]);
    let mirrored = ChannelMedium { transverse: -4.5, ..viscous };
    let opposite = settled(mirrored, 0.1, 48).velocities();
    assert!(spread[1].iter().zip(&opposite[1]).all(|(a, b)| (a + b).abs() < 1e-12));
}

/// Fluxes cancel and births replace extrusions: the number of cells stays to rounding at every moment, also of fast turnover.
#[test]
fn cells_are_conserved_on_the_way() {
    let medium = ChannelMedium { longitudinal_viscosity: 0.3, ..ChannelMedium::elastic(1.0, 2.0).unwrap() };
    let mut flow = ChannelEvolution::new(medium, turnover(0.8), 30).unwrap();
    for _ in 0..10 {
        flow.advance(0.5);
        let mean = flow.density().iter().sum::<f64>() / 30.0;
        assert!((mean - 1.0).abs() < 1e-12, "{mean}");
        assert!(flow.density().iter().all(|density| *density > 0.0));
    }
    assert_eq!(flow.time(), 5.0);
    // Denser at the edge, and flowing inwards.
    assert!(flow.density()[0] > 1.1 && flow.density()[29] < 1.0 && flow.velocities()[0][5] > 0.0);
}

#[test]
fn senseless_channels_are_refused() {
    let medium = ChannelMedium::elastic(3.0, 0.0).unwrap();
    assert!(matches!(ChannelMedium::elastic(0.0, 1.0), Err(Error::Channel { name: "modulus B + μ", .. })));
    let narrow = ChannelTurnover { width: -1.0, ..turnover(1.0) };
    assert!(matches!(ChannelEvolution::new(medium, narrow, 10), Err(Error::Channel { value: -1.0, .. })));
    assert!(matches!(ChannelEvolution::new(medium, turnover(-0.1), 10), Err(Error::Channel { .. })));
    assert_eq!(ChannelEvolution::new(medium, turnover(1.0), 1), Err(Error::Grid { cells: 1 }));
    let backwards = ChannelMedium { shear_viscosity: -1.0, ..medium };
    assert!(backwards.checked().is_err());
}

/// Pressure and torques that grow as the square of the density are the elastic medium.
#[test]
fn an_equation_of_state_of_parabolas_is_the_elastic_medium() {
    let turnover = turnover(0.3);
    let points: Vec<[f64; 3]> = (0..8)
        .map(|k| 0.7 + 0.17 * f64::from(k))
        .map(|rho| [rho, 0.5 * 3.0 * rho * rho, 4.5 * rho * rho])
        .collect();
    let equation = EquationOfState::new(&points).unwrap();
    let [mut liquid, mut elastic] = [
        ChannelEvolution::of_liquid(equation, turnover, 40).unwrap(),
        ChannelEvolution::new(ChannelMedium::elastic(3.0, 4.5).unwrap(), turnover, 40).unwrap(),
    ];
    liquid.advance(5.0);
    elastic.advance(5.0);
    let [edge, middle] = [elastic.density()[0], elastic.density()[39]];
    assert!(edge > 1.02 && middle < 0.99, "{edge} {middle}");
    for (a, b) in liquid.density().iter().zip(elastic.density()) {
        assert!((a - b).abs() < 1e-9, "{a} for {b}");
    }
    for (a, b) in liquid.velocities().iter().flatten().zip(elastic.velocities().iter().flatten()) {
        assert!((a - b).abs() < 1e-9, "{a} for {b}");
    }
}

/// In the steady state the pressure makes up for the flow of cells, and transport along the channel is half the difference of torques.
#[test]
fn a_liquid_comes_to_the_state_that_its_pressure_implies() {
    // Stiff where it is dense; torques that rise and fall.
    let (p, tau) = (|rho: f64| rho.powi(3), |rho: f64| 5.0 * rho - 2.0 * rho * rho);
    let points: Vec<[f64; 3]> =
        (0..60).map(|k| 0.5 + 0.03 * f64::from(k)).map(|rho| [rho, p(rho), tau(rho)]).collect();
    let equation = EquationOfState::new(&points).unwrap();
    let mut flow = ChannelEvolution::of_liquid(equation, turnover(0.3), 60).unwrap();
    assert!(flow.settle(1e-8, 400.0));
    let (density, [v_x, v_y], width) = (flow.density(), flow.velocities(), flow.faces()[1]);
    let (mut along, mut across) = (0.0, 0.0);
    for face in 1..density.len() {
        let mean = 0.5 * (density[face - 1] + density[face]);
        across += mean * v_x[face] * width;
        along += mean * v_y[face] * width;
    }
    let last = density.len() - 1;
    assert!((across - (p(density[0]) - p(density[last]))).abs() < 1e-4, "{across}");
    assert!((along - 0.5 * (tau(density[0]) - tau(density[last]))).abs() < 1e-4, "{along}");
    assert!((density.iter().sum::<f64>() / density.len() as f64 - 1.0).abs() < 1e-12);
}

#[test]
fn what_is_no_equation_of_state_is_refused() {
    let refused = |points: &[[f64; 3]]| EquationOfState::new(points).unwrap_err().to_string();
    assert!(refused(&[[1.0; 3], [2.0; 3]]).contains("fewer than three"));
    assert!(refused(&[[1.0; 3], [3.0; 3], [2.0; 3]]).contains("do not rise"));
    assert!(refused(&[[1.0; 3], [2.0, f64::NAN, 0.0], [3.0; 3]]).contains("not finite"));
    let falling = EquationOfState::new(&[[1.0, 3.0, 0.0], [2.0, 2.0, 0.0], [3.0, 1.0, 0.0]]).unwrap();
    assert!(ChannelEvolution::of_liquid(falling, turnover(0.3), 40).is_err());
}

/// Where the edge becomes far stiffer than the uniform channel was, steps stay stable.
#[test]
fn a_channel_that_stiffens_settles() {
    let p = |rho: f64| (6.0 * (rho - 1.0)).exp();
    let points: Vec<[f64; 3]> =
        (0..30).map(|k| 0.8 + 0.03 * f64::from(k)).map(|rho| [rho, p(rho), rho]).collect();
    let turnover = ChannelTurnover { extrusion_rate: 4.0, ..turnover(0.3) };
    let mut flow = ChannelEvolution::of_liquid(EquationOfState::new(&points).unwrap(), turnover, 40).unwrap();
    assert!(flow.settle(1e-6, 200.0));
    let density = flow.density();
    assert!(density[0] > 1.2 && density.windows(2).all(|pair| pair[1] < pair[0] + 1e-6), "{density:?}");
}
