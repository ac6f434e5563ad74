//! Transitions that are made, and such by chance.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Vector};
use voronudge_observables::{
    Curve, Exchange, Images, Plan, Quantity, Recording, exchange_statistics, exchanges, observe,
};

fn film(side: usize, frames: &[Vec<Vector<f64>>]) -> (Recording, Plan) {
    let domain = Domain::Periodic(PeriodicBox::new([side as f64; 2]).unwrap());
    let times: Vec<f64> = (0..frames.len()).map(|frame| frame as f64).collect();
    let places = frames.iter().map(|frame| frame.iter().copied().map(Some).collect()).collect();
    let domains = vec![domain; frames.len()];
    let recording =
        Recording::new(&times, places, &domains, &FieldOfView::default(), Images::Nearest).unwrap();
    let plan = Plan::of(&recording).unwrap();
    (recording, plan)
}

fn of(all: &[Curve], quantity: Quantity) -> &Curve {
    all.iter().find(|curve| curve.of == quantity).unwrap()
}

/// Every other row of a square lattice slides past the next: all squares exchange their diagonal, half of them each way.
#[test]
fn rows_that_slide_exchange_diagonals() {
    const SIDE: usize = 8;
    let rows = |shift: f64| {
        let place =
            |k: usize| Vector::new((k % SIDE) as f64 + shift * (k / SIDE % 2) as f64, (k / SIDE) as f64);
        (0..SIDE * SIDE).map(place).collect::<Vec<_>>()
    };
    let (recording, plan) = film(SIDE, &[rows(0.1), rows(0.1), rows(-0.1)]);
    let all = exchanges(&recording);
    assert_eq!(all.len(), SIDE * SIDE);
    let angle = (1.0f64).atan2(0.9);
    let forward = all.iter().filter(|own| own.made_direction > 0.0).count();
    assert_eq!(forward, SIDE * SIDE / 2);
    for own in &all {
        assert_eq!(own.frame, 2);
        assert!(
            (own.made_direction.abs() - angle).abs() < 1e-12
                && (own.lost_direction + own.made_direction).abs() < 1e-12
        );
        assert!((own.position.y - own.position.y.floor() - 0.5).abs() < 1e-9);
    }
    let measured = exchange_statistics(&recording, &plan, &all);
    // Nobody changes neighbours until the second frame, and everybody does then.
    let waiting = of(&measured, Quantity::ExchangeWaiting);
    assert_eq!(waiting.value, [0.5, 0.0]);
    let rate = observe(&recording, &plan).into_iter().find(|own| own.of == Quantity::TransitionRate).unwrap();
    assert!((rate.value[0] - 0.5).abs() < 1e-12);
    assert!(of(&measured, Quantity::ExchangeTurn).value[0].abs() < 1e-12);
}

/// Cells that diffuse independently exchange neighbours without regard to far ones, whichever way; in the mirror left is right.
#[test]
fn transitions_of_walkers_know_nothing_of_far_ones() {
    const SIDE: usize = 24;
    let (mut pull, mut far) = (0.0, Vec::new());
    for seed in 0..4 {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut jitter = |size: f64| Vector::new(rng.random::<f64>() - 0.5, rng.random::<f64>() - 0.5) * size;
        let mut cells: Vec<_> = (0..SIDE * SIDE)
            .map(|k| Vector::new((k % SIDE) as f64, (k / SIDE) as f64) + jitter(0.9))
            .collect();
        let mut frames = Vec::new();
        for _ in 0..8 {
            frames.push(cells.clone());
            cells.iter_mut().for_each(|r| *r += jitter(0.05));
        }
        let (recording, plan) = film(SIDE, &frames);
        let all = exchanges(&recording);
        assert!(all.len() > 100, "{}", all.len());
        let measured = exchange_statistics(&recording, &plan, &all);
        let together = of(&measured, Quantity::ExchangeCorrelation);
        for ((distance, value), error) in
            together.at.iter().zip(&together.value).zip(&together.standard_error)
        {
            if *distance > 3.0 {
                far.push((value - 1.0) / error);
            }
        }
        let mirrored: Vec<Vec<_>> =
            frames.iter().map(|frame| frame.iter().map(|r| Vector::new(-r.x, r.y)).collect()).collect();
        let (recording, plan) = film(SIDE, &mirrored);
        let other = exchange_statistics(&recording, &plan, &exchanges(&recording));
        let [own, mirror] = [&measured, &other].map(|all| of(all, Quantity::ExchangeTurn));
        assert!((own.value[0] + mirror.value[0]).abs() < 1e-9);
        pull += own.value[0] / own.standard_error[0];
    }
    let mean = far.iter().sum::<f64>() / far.len() as f64;
    assert!(mean.abs() < 0.5, "far transitions: mean pull {mean}");
    assert!(pull.abs() < 5.0, "walkers are not chiral: {pull}");
}

/// A field that is stretched along one axis and narrowed along the other loses contacts along the first and makes them along the second.
#[test]
fn a_stretched_field_makes_contacts_across() {
    const SIDE: usize = 24;
    let mut rng = Pcg64::seed_from_u64(2);
    let mut jitter = || 0.8 * (rng.random::<f64>() - 0.5);
    let cells: Vec<_> = (0..SIDE * SIDE)
        .map(|k| Vector::new((k % SIDE) as f64 + jitter(), (k / SIDE) as f64 + jitter()))
        .collect();
    let stretched = |frame: usize| {
        let stretch = 1.05f64.powi(frame as i32);
        cells.iter().map(|r| Some(Vector::new(r.x * stretch, r.y / stretch))).collect()
    };
    let times: Vec<f64> = (0..8).map(f64::from).collect();
    let places = (0..8).map(stretched).collect();
    let recording =
        Recording::new(&times, places, &[Domain::Open; 8], &FieldOfView::default(), Images::Nearest).unwrap();
    let all = exchanges(&recording);
    let mean = |of: &dyn Fn(&Exchange) -> f64| {
        all.iter().map(|own| (2.0 * of(own)).cos()).sum::<f64>() / all.len() as f64
    };
    assert!(all.len() > 100, "{}", all.len());
    let (lost, made) = (mean(&|own| own.lost_direction), mean(&|own| own.made_direction));
    assert!(lost > 0.5 && made < -0.5, "{lost} {made}");
    let measured = exchange_statistics(&recording, &Plan::of(&recording).unwrap(), &all);
    let value = of(&measured, Quantity::ExchangeAlignment).value[0];
    assert!((value - made).abs() < 1e-12, "{value} {made}");
}
