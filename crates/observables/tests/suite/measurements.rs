//! Measurements against what is known of the cells.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Region, Seen, Tessellation, Vector, honeycomb};
use voronudge_observables::{
    Curve, Images, Plan, Quantity, Recording, TransitionCounter, mean_square_velocity, observe,
};

type Places = Vec<Vec<Option<Vector<f64>>>>;

/// Standard normal to the precision that matters here.
fn normal(rng: &mut Pcg64) -> Vector<f64> {
    let mut one = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
    Vector::new(one(), one())
}

/// Independent walkers at random places of a square, of which a margin is not seen.
fn walkers(seed: u64, side: f64, step: f64) -> (Places, FieldOfView) {
    const FRAMES: usize = 8;
    let mut rng = Pcg64::seed_from_u64(seed);
    let count = (side * side) as usize;
    let mut cells: Vec<Vector<f64>> =
        (0..count).map(|_| Vector::new(rng.random::<f64>(), rng.random::<f64>()) * side).collect();
    let margin = 1.0;
    let seen =
        |r: &Vector<f64>| (margin..side - margin).contains(&r.x) && (margin..side - margin).contains(&r.y);
    let mut places = Vec::new();
    for _ in 0..FRAMES {
        places.push(cells.iter().map(|r| seen(r).then_some(*r)).collect());
        cells.iter_mut().for_each(|r| *r += normal(&mut rng) * step);
    }
    let region = Region::rectangle([margin, margin, side - margin, side - margin]).unwrap();
    (places, FieldOfView { seen: Seen::Within(region), largest_area: 100.0, ..FieldOfView::default() })
}

fn times(frames: usize) -> Vec<f64> {
    (0..frames).map(|frame| 0.5 * frame as f64).collect()
}

fn open(places: Places, view: &FieldOfView) -> Recording {
    let frames = places.len();
    Recording::new(&times(frames), places, &vec![Domain::Open; frames], view, Images::Nearest).unwrap()
}

fn of(all: &[Curve], quantity: Quantity) -> &Curve {
    all.iter().find(|curve| curve.of == quantity).unwrap()
}

/// Deviation of each value from a truth, in standard errors.
fn pulls(curve: &Curve, truth: impl Fn(f64) -> f64) -> Vec<f64> {
    let all = curve.at.iter().zip(&curve.value).zip(&curve.standard_error);
    all.map(|((at, value), error)| (value - truth(*at)) / error).filter(|pull| pull.is_finite()).collect()
}

fn spread(pulls: &[f64]) -> f64 {
    (pulls.iter().map(|pull| pull * pull).sum::<f64>() / pulls.len() as f64).sqrt()
}

#[test]
fn walkers_in_an_open_field_are_measured_without_bias_and_errors_are_right() {
    const STEP: f64 = 0.05;
    let mut all: Vec<(Quantity, Vec<f64>)> = Vec::new();
    for seed in 0..40 {
        let (places, view) = walkers(seed, 16.0, STEP);
        let recording = open(places, &view).with_mean_velocities();
        let plan = Plan::of(&recording).unwrap();
        let measured = observe(&recording, &plan);
        let mut push = |quantity: Quantity, truth: &dyn Fn(f64) -> f64| {
            let own = pulls(of(&measured, quantity), truth);
            match all.iter_mut().find(|(other, _)| *other == quantity) {
                Some((_, pulls)) => pulls.extend(own),
                None => all.push((quantity, own)),
            }
        };
        // A frame every half unit of time, and two coordinates.
        let square = 2.0 * STEP * STEP / 0.25;
        push(Quantity::MeanSquareDisplacement, &|lag| 2.0 * STEP * STEP * lag / 0.5);
        push(Quantity::MeanSquareVelocity, &|_| square);
        push(Quantity::VelocityAutocorrelation, &|_| 0.0);
        push(Quantity::VelocityCorrelation, &|_| 0.0);
        push(Quantity::Compression, &|_| 0.5 * square);
        push(Quantity::Vortices, &|_| 0.5 * square);
    }
    for (quantity, pulls) in &all {
        let (spread, mean) = (spread(pulls), pulls.iter().sum::<f64>() / pulls.len() as f64);
        assert!((0.7..1.45).contains(&spread), "{quantity:?}: pulls spread by {spread}");
        assert!(mean.abs() < 0.35, "{quantity:?}: mean pull {mean}");
    }
}

#[test]
fn random_places_neither_attract_nor_scatter_but_as_they_must() {
    let (mut near, mut power, mut count) = (0.0, 0.0, 0.0);
    for seed in 0..10 {
        let (places, view) = walkers(seed, 20.0, 0.5);
        let recording = open(places, &view);
        // The mean area of cells that count is less than that of all: small polygons are certain more often.
        let plan = Plan::of(&recording).unwrap();
        let measured = observe(&recording, &plan);
        let pair = of(&measured, Quantity::PairCorrelation);
        let scale = plan.spacing().powi(2);
        near += pair.value.iter().sum::<f64>() / pair.value.len() as f64 * (1.0 / scale);
        let density = of(&measured, Quantity::Density);
        let waves: usize = density.count.iter().sum();
        power +=
            density.value.iter().zip(&density.count).map(|(s, n)| s * *n as f64).sum::<f64>() / waves as f64;
        count += 1.0;
    }
    assert!((near / count - 1.0).abs() < 0.05, "g = {}", near / count);
    assert!((power / count - 1.0).abs() < 0.05, "S = {}", power / count);
}

#[test]
fn a_crystal_in_an_open_field_does_not_scatter_long_waves() {
    let (cells, _) = honeycomb(24, 24);
    let recording = open(vec![cells.into_iter().map(Some).collect()], &FieldOfView::default());
    let plan = Plan::of(&recording).unwrap();
    let measured = observe(&recording, &plan);
    let density = of(&measured, Quantity::Density);
    let long = density.at.iter().zip(&density.value).filter(|(q, _)| (1.0..5.0).contains(*q));
    assert!(long.clone().count() > 5);
    for (q, power) in long {
        assert!(*power < 1e-3, "S({q}) = {power}");
    }
    assert!((of(&measured, Quantity::HexaticOrder).value[0] - 1.0).abs() < 1e-9);
    assert!(
        of(&measured, Quantity::HexaticCorrelation)
            .value
            .iter()
            .flatten_finite()
            .all(|g| (g - 1.0).abs() < 1e-9)
    );
    let six = of(&measured, Quantity::Neighbours);
    assert_eq!(six.value[six.at.iter().position(|z| *z == 6.0).unwrap()], 1.0);
    // Nothing moves: what needs velocities or a second frame is not there.
    assert!(!measured.iter().any(|curve| curve.of == Quantity::MeanSquareDisplacement));
    assert!(!measured.iter().any(|curve| curve.of == Quantity::Vortices));
}

trait Finite<'a> {
    fn flatten_finite(self) -> impl Iterator<Item = &'a f64>;
}

impl<'a, I: Iterator<Item = &'a f64>> Finite<'a> for I {
    fn flatten_finite(self) -> impl Iterator<Item = &'a f64> {
        self.filter(|value| value.is_finite())
    }
}

#[test]
fn transitions_are_those_that_are_counted_in_a_box_and_contacts_come_back() {
    let cell_box = PeriodicBox::new([6.0, 6.0]).unwrap();
    let rows = |shift: f64| -> Vec<Vector<f64>> {
        (0..36).map(|i| Vector::new((i % 6) as f64 + shift * (i / 6 % 2) as f64, (i / 6) as f64)).collect()
    };
    let shifts = [0.1, -0.1, 0.1, 0.1];
    let mut counter = TransitionCounter::default();
    let counted: usize = shifts
        .iter()
        .map(|shift| counter.count(&Tessellation::new(&rows(*shift), Domain::Periodic(cell_box)).unwrap()))
        .sum();
    let places = shifts.iter().map(|shift| rows(*shift).into_iter().map(Some).collect()).collect();
    let domains = [Domain::Periodic(cell_box); 4];
    let recording =
        Recording::new(&times(4), places, &domains, &FieldOfView::default(), Images::Nearest).unwrap();
    let measured = observe(&recording, &Plan::of(&recording).unwrap());
    let rate = of(&measured, Quantity::TransitionRate).value[0];
    // 36 cells over three intervals of one half.
    assert_eq!(rate * 36.0 * 1.5, counted as f64);
    let lasting = of(&measured, Quantity::ContactSurvival);
    // Of 108 contacts 36 are exchanged in the first and in the second interval, and in none of the third; after two intervals the first frame is back.
    assert!((lasting.value[0] - (72.0 + 72.0 + 108.0) / 324.0).abs() < 1e-12);
    assert!((lasting.value[1] - (108.0 + 72.0) / 216.0).abs() < 1e-12);
    assert_eq!(lasting.value[2], 1.0);
}

#[test]
fn the_stage_is_no_motion_of_the_cells_and_images_are_followed() {
    let cell_box = PeriodicBox::new([8.0, 8.0]).unwrap();
    let mut rng = Pcg64::seed_from_u64(5);
    let (cells, _) = honeycomb(8, 8);
    let start: Vec<Vector<f64>> = cells.iter().map(|r| r + normal(&mut rng) * 0.05).collect();
    let speed = Vector::new(1.1, -0.7);
    let place = |frame: usize, r: &Vector<f64>| Some(cell_box.wrap(r + speed * (0.5 * frame as f64)));
    let places: Places = (0..9).map(|frame| start.iter().map(|r| place(frame, r)).collect()).collect();
    let domains = [Domain::Periodic(cell_box); 9];
    let view = FieldOfView::default();
    let moving = Recording::new(&times(9), places, &domains, &view, Images::Nearest).unwrap();
    let velocities: Vec<Vector<f64>> =
        moving.clone().with_mean_velocities().frames()[3].velocities.iter().flatten().copied().collect();
    assert!((mean_square_velocity(&velocities) - speed.norm_squared()).abs() < 1e-12);
    let still = moving.without_common_motion().with_mean_velocities();
    let measured = observe(&still, &Plan::of(&still).unwrap());
    assert!(of(&measured, Quantity::MeanSquareDisplacement).value.iter().all(|square| *square < 1e-20));
    assert!(of(&measured, Quantity::MeanSquareVelocity).value[0] < 1e-20);
}
