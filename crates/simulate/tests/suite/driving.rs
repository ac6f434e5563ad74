//! Shear, self-propulsion, noise, and steps of adaptive size.

use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_model::effect::away_from_contacts;
use voronudge_model::{Model, Parameters, stress, velocities};
use voronudge_observables::mean_square_displacement;
use voronudge_simulate::{Driving, Error, Method, RandomPlacement, Shear, Simulation, generator, honeycomb};

fn tissue(cells: usize, seed: u64, parameters: &Parameters<f64>) -> Simulation {
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2]).unwrap();
    let positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(seed)).unwrap();
    Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(parameters)).unwrap()
}

/// Cells without any force between them.
fn inert() -> Parameters<f64> {
    Parameters { area_elasticity: 0.0, perimeter_elasticity: 0.0, ..Parameters::default() }
}

fn advance(simulation: &mut Simulation, steps: usize, time_step: f64) {
    (0..steps).for_each(|_| simulation.step(time_step).unwrap());
}

#[test]
fn inert_cells_are_carried_by_the_shear() {
    for shear in [
        Shear::Step { strain: 0.3 },
        Shear::Steady { rate: 0.7 },
        Shear::Oscillatory { amplitude: 0.4, angular_frequency: 3.0 },
    ] {
        let before = tissue(100, 1, &inert());
        let driving = Driving { shear: Some(shear), ..Driving::default() };
        let mut simulation = before.clone().with_driving(driving).unwrap();
        advance(&mut simulation, 200, 0.01);
        let strain = shear.strain(simulation.time());
        for (r, from) in simulation.positions().iter().zip(before.positions()) {
            assert!((r - Vector::new(from.x + strain * from.y, from.y)).norm() < 1e-8, "{shear:?}");
        }
        let sheared = Domain::Periodic(PeriodicBox::sheared([10.0; 2], 10.0 * strain).unwrap());
        assert_eq!(*simulation.tessellation(), Tessellation::new(simulation.positions(), sheared).unwrap());
    }
}

/// A box that was sheared by thousands of its widths is one of a small offset, and cells flow in it as in that one.
#[test]
fn shear_goes_on_however_far_it_went() {
    let parameters = Parameters { chirality: 1.0, ..Parameters::default() };
    let start = tissue(36, 3, &parameters);
    let (positions, model) = (start.positions().to_vec(), start.model().clone());
    let driving = Driving { shear: Some(Shear::Steady { rate: 2.0 }), ..Driving::default() };
    // The second offset of a pair is that of the first less whole widths, so strains add to it alike.
    for (far, near) in [(2047.9, -0.1), (-4096.1, -0.1), (8191.75, -0.25), (4095.5, -0.5)] {
        let from = |widths: f64| {
            let domain = Domain::Periodic(PeriodicBox::sheared([6.0; 2], 6.0 * widths).unwrap());
            Simulation::new(positions.clone(), domain, model.clone()).unwrap().with_driving(driving).unwrap()
        };
        let (mut far, mut near) = (from(far), from(near));
        advance(&mut far, 100, 0.005);
        advance(&mut near, 100, 0.005);
        let Domain::Periodic(there) = near.tessellation().domain() else { panic!("the box is periodic") };
        let apart = far.positions().iter().zip(near.positions()).map(|(a, b)| there.shortest(a - b).norm());
        let worst = apart.fold(0.0, f64::max);
        assert!(worst < 1e-7, "{worst}");
        assert_eq!(
            *far.tessellation(),
            Tessellation::new(far.positions(), far.tessellation().domain()).unwrap()
        );
    }
    let strained =
        start.with_driving(Driving { shear: Some(Shear::Step { strain: 1e6 }), ..driving }).unwrap();
    let place = |r: &Vector<f64>| Vector::new(r.x + (1e6 * r.y).rem_euclid(6.0), r.y);
    let same = Simulation::new(
        positions.iter().map(place).collect(),
        Domain::Periodic(PeriodicBox::new([6.0; 2]).unwrap()),
        model,
    )
    .unwrap();
    for (v, of_same) in strained.velocities().iter().zip(same.velocities()) {
        assert!((v - of_same).norm() < 1e-6, "{v} {of_same}");
    }
}

/// The flow of a sheared tissue does not depend on which image of a cell is followed.
#[test]
fn images_flow_alike_under_shear() {
    let driving = Driving { shear: Some(Shear::Steady { rate: 0.2 }), ..Driving::default() };
    let parameters = Parameters { chirality: 1.0, ..Parameters::default() };
    let one = tissue(64, 2, &parameters);
    let (domain, model) = (one.tessellation().domain(), one.model().clone());
    let shift = |i: usize| Vector::new(8.0 * (i % 3) as f64, 8.0 * (i % 2) as f64);
    let moved = one.positions().iter().enumerate().map(|(i, r)| r + shift(i)).collect();
    let mut one = one.with_driving(driving).unwrap();
    let mut other = Simulation::new(moved, domain, model).unwrap().with_driving(driving).unwrap();
    advance(&mut one, 100, 0.01);
    advance(&mut other, 100, 0.01);
    for (i, (r, s)) in one.positions().iter().zip(other.positions()).enumerate() {
        let image = shift(i) + Vector::new(0.2 * one.time() * shift(i).y, 0.0);
        assert!((s - r - image).norm() < 1e-8, "{i}: {}", s - r - image);
    }
}

/// The shear modulus of the honeycomb at P_0 = 3.0: K_P P_MF² s/4 per unit area, as in the mean-field theory.
#[test]
fn a_step_strain_of_the_honeycomb_gives_its_shear_modulus() {
    let parameters = Parameters { preferred_perimeter: 3.0, ..Parameters::default() };
    let (positions, cell_box) = honeycomb(64).unwrap();
    let strain = 1e-6;
    let driving = Driving { shear: Some(Shear::Step { strain }), ..Driving::default() };
    let domain = Domain::Periodic(cell_box);
    let simulation = Simulation::new(positions, domain, Model::chiral_voronoi(&parameters)).unwrap();
    let simulation = simulation.with_driving(driving).unwrap();
    let sigma = stress(simulation.tessellation(), simulation.positions(), simulation.model(), |_| true);
    let modulus = sigma[0][1] / strain;
    assert!((modulus - 1.00843).abs() < 1e-4, "{modulus}");
}

#[test]
fn a_steadily_sheared_solid_yields_and_keeps_its_momentum() {
    let parameters = Parameters { preferred_perimeter: 3.4, ..Parameters::default() };
    let driving = Driving { shear: Some(Shear::Steady { rate: 0.05 }), ..Driving::default() };
    let mut simulation = tissue(64, 3, &parameters).with_driving(driving).unwrap();
    let height = |s: &Simulation| s.positions().iter().map(|r| r.y).sum::<f64>();
    let before = height(&simulation);
    advance(&mut simulation, 4000, 0.01);
    assert!((height(&simulation) - before).abs() < 1e-10);
    let sigma = stress(simulation.tessellation(), simulation.positions(), simulation.model(), |_| true);
    assert!(sigma[0][1] > 0.0, "the tissue resists: {}", sigma[0][1]);
}

#[test]
fn noise_diffuses_and_propulsion_persists() {
    let diffusion = 0.05;
    let mut noisy =
        tissue(400, 4, &inert()).with_driving(Driving { diffusion, seed: 9, ..Driving::default() }).unwrap();
    let mut frames = vec![noisy.positions().to_vec()];
    for _ in 0..20 {
        advance(&mut noisy, 5, 0.02);
        frames.push(noisy.positions().to_vec());
    }
    let msd = mean_square_displacement(&frames).unwrap();
    assert!((msd[1] / (4.0 * diffusion * 0.1) - 1.0).abs() < 0.05, "{}", msd[1]);
    assert!((msd[10] / (4.0 * diffusion) - 1.0).abs() < 0.15, "{}", msd[10]);

    let (speed, rotational_diffusion) = (0.3, 2.0);
    let driving = Driving { speed, rotational_diffusion, seed: 9, ..Driving::default() };
    let mut active = tissue(400, 4, &inert()).with_driving(driving).unwrap();
    let begin = active.positions().to_vec();
    advance(&mut active, 1, 0.01);
    for (r, from) in active.positions().iter().zip(&begin) {
        assert!(((r - from).norm() - speed * 0.01).abs() < 1e-12);
    }
    advance(&mut active, 399, 0.01);
    // ⟨Δr²⟩ = 2 v₀² (t/D_r − (1 − exp(−D_r t))/D_r²)
    let time: f64 = 4.0;
    let expected = 2.0
        * speed
        * speed
        * (time / rotational_diffusion
            - (1.0 - (-rotational_diffusion * time).exp()) / rotational_diffusion.powi(2));
    let frames = [begin, active.positions().to_vec()];
    let found = mean_square_displacement(&frames).unwrap()[1];
    assert!((found / expected - 1.0).abs() < 0.15, "{found} {expected}");
}

/// Two directions among cells that do not move: what turns them is known in closed form where all neighbours are alike, and without noise
/// aligned cells end with one direction.
#[test]
fn directions_align_with_those_of_the_neighbours() {
    let driving = Driving { speed: 1e-9, alignment: 1.5, seed: 9, ..Driving::default() };
    let mut aligned = tissue(100, 4, &inert()).with_driving(driving).unwrap();
    let before = aligned.state().headings.clone();
    let rate = |cell: usize| -> f64 {
        let neighbours = aligned.tessellation().neighbours(cell).iter();
        1.5 / 6.0 * neighbours.map(|other| (before[*other as usize] - before[cell]).sin()).sum::<f64>()
    };
    let expected: Vec<f64> = (0..100).map(|cell| before[cell] + 0.01 * rate(cell)).collect();
    advance(&mut aligned, 1, 0.01);
    for (found, expected) in aligned.state().headings.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    // The sum of the turns is zero, and the order grows.
    let sum = |headings: &[f64]| headings.iter().sum::<f64>();
    assert!((sum(&aligned.state().headings) - sum(&before)).abs() < 1e-9);
    let order = |headings: &[f64]| {
        let (x, y) = headings.iter().fold((0.0, 0.0), |(x, y), angle| (x + angle.cos(), y + angle.sin()));
        f64::hypot(x, y) / headings.len() as f64
    };
    advance(&mut aligned, 4000, 0.02);
    assert!(order(&before) < 0.3 && order(&aligned.state().headings) > 0.8);
}

/// Polarities turn away from contacts and along the velocities of the model by as much as is said; where the speed is fixed, by what is across.
#[test]
fn polarities_are_driven() {
    let (b, kappa) = (0.7, 0.4);
    let parameters = Parameters { chirality: 1.0, ..Parameters::default() };
    for free_speed in [false, true] {
        let driving = Driving {
            speed: 0.5,
            contact_inhibition: b,
            velocity_alignment: kappa,
            free_speed,
            seed: 9,
            ..Driving::default()
        };
        let mut driven = tissue(100, 4, &parameters).with_driving(driving).unwrap();
        let (column, sign) = away_from_contacts();
        let environment = driven.model().environment.clone();
        let away = Model::with_coefficients(&[], &[]).with(column, sign).within(&environment);
        let of = |model: &Model<f64>| velocities(driven.tessellation(), driven.positions(), model);
        let (n, f) = (of(&away), of(driven.model()));
        assert!(n.iter().map(|n| n.norm()).sum::<f64>() > 5.0);
        let polarity = |simulation: &Simulation, cell: usize| {
            let state = simulation.state();
            let angle = state.headings[cell];
            Vector::new(angle.cos(), angle.sin()) * state.speeds.get(cell).copied().unwrap_or(1.0) * 0.5
        };
        let before: Vec<Vector<f64>> = (0..100).map(|cell| polarity(&driven, cell)).collect();
        let step = 1e-5;
        advance(&mut driven, 1, step);
        for cell in 0..100 {
            let mut expected = n[cell] * b + f[cell] * kappa;
            if !free_speed {
                expected -= before[cell] * (before[cell].dot(&expected) / before[cell].norm_squared());
            }
            let turned = (polarity(&driven, cell) - before[cell]) / step;
            assert!((turned - expected).norm() < 1e-3 * (1.0 + expected.norm()), "{turned:?} {expected:?}");
        }
    }
}

/// A polarity whose speed is free keeps its mean square and is forgotten at the rate of rotational diffusion.
#[test]
fn speeds_that_are_free_keep_their_mean_square() {
    let driving =
        Driving { speed: 1e-3, rotational_diffusion: 2.0, free_speed: true, seed: 9, ..Driving::default() };
    let mut simulation = tissue(1600, 4, &inert()).with_driving(driving).unwrap();
    let polarities = |simulation: &Simulation| -> Vec<Vector<f64>> {
        let state = simulation.state();
        let all = state.headings.iter().zip(&state.speeds);
        all.map(|(angle, speed)| Vector::new(angle.cos(), angle.sin()) * *speed).collect()
    };
    let product = |one: &[Vector<f64>], other: &[Vector<f64>]| {
        one.iter().zip(other).map(|(p, q)| p.dot(q)).sum::<f64>() / one.len() as f64
    };
    let begin = polarities(&simulation);
    assert!((product(&begin, &begin) - 1.0).abs() < 0.08);
    advance(&mut simulation, 50, 0.01);
    let end = polarities(&simulation);
    assert!((product(&end, &end) - 1.0).abs() < 0.08);
    assert!((product(&begin, &end) - (-1.0_f64).exp()).abs() < 0.08);
    let replaced = simulation.replace_cells(simulation.positions().to_vec(), Vec::new());
    assert!(replaced.is_err());
}

#[test]
fn noise_does_not_depend_on_threads_but_on_its_seed() {
    let end = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let driving =
            Driving { diffusion: 0.01, speed: 0.2, rotational_diffusion: 1.0, seed, ..Driving::default() };
        pool.install(|| {
            let mut simulation = tissue(5000, 5, &Parameters::default()).with_driving(driving).unwrap();
            advance(&mut simulation, 4, 0.01);
            simulation.state().clone()
        })
    };
    assert_eq!(end(1, 1), end(2, 1));
    assert_ne!(end(1, 1), end(1, 2));
}

#[test]
fn adaptive_steps_keep_their_tolerance() {
    let parameters = Parameters { chirality: 1.0, ..Parameters::default() };
    let mut begin = tissue(64, 6, &parameters);
    advance(&mut begin, 300, 0.01);
    let mut exact = begin.clone();
    advance(&mut exact, 2000, 0.0001);
    let errors = [1e-3, 1e-5, 1e-7].map(|tolerance| {
        let mut adaptive = begin.clone().with_method(Method::BogackiShampine { tolerance }).unwrap();
        advance(&mut adaptive, 2, 0.1);
        assert!((adaptive.time() - exact.time()).abs() < 1e-9);
        let gaps = adaptive.positions().iter().zip(exact.positions()).map(|(a, b)| (a - b).norm());
        gaps.fold(0.0, f64::max)
    });
    // Errors of many parts add up and grow in the chaotic liquid.
    assert!(errors[0] < 0.2 && errors[1] < 5e-3 && errors[2] < 1e-4, "{errors:?}");
    assert!(errors[2] < errors[0] / 50.0, "{errors:?}");
}

#[test]
fn impossible_driving_and_states_are_refused() {
    let simulation = tissue(16, 7, &inert());
    for driving in [
        Driving { diffusion: -1.0, ..Driving::default() },
        Driving { speed: f64::NAN, ..Driving::default() },
        Driving { rotational_diffusion: f64::INFINITY, ..Driving::default() },
    ] {
        assert!(matches!(simulation.clone().with_driving(driving), Err(Error::Driving { .. })));
    }
    let shear = Driving { shear: Some(Shear::Step { strain: f64::NAN }), ..Driving::default() };
    assert!(matches!(simulation.clone().with_driving(shear), Err(Error::Tessellation { .. })));
    for tolerance in [0.0, -1.0, f64::NAN] {
        let refused = simulation.clone().with_method(Method::BogackiShampine { tolerance });
        assert!(matches!(refused, Err(Error::Tolerance { .. })));
    }
    let state = tissue(9, 7, &inert()).state().clone();
    assert!(matches!(simulation.in_state(state), Err(Error::State { cells: 16, positions: 9, .. })));
}
