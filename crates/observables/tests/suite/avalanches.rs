//! Avalanches that are constructed, and transitions at random.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Vector};
use voronudge_observables::{
    Avalanche, Avalanches, Curve, Exchange, Images, Plan, Quantity, Recording, avalanches, drops,
};

const SIDE: usize = 24;

/// A square lattice that rests, a little out of line so that its topology is certain.
fn resting(frames: usize) -> Recording {
    let mut rng = Pcg64::seed_from_u64(1);
    let mut jitter = || 0.2 * (rng.random::<f64>() - 0.5);
    let cells: Vec<_> = (0..SIDE * SIDE)
        .map(|k| Some(Vector::new((k % SIDE) as f64 + jitter(), (k / SIDE) as f64 + jitter())))
        .collect();
    let times: Vec<f64> = (0..frames).map(|frame| 0.5 * frame as f64).collect();
    let domain = Domain::Periodic(PeriodicBox::new([SIDE as f64; 2]).unwrap());
    let places = vec![cells; frames];
    Recording::new(&times, places, &vec![domain; frames], &FieldOfView::default(), Images::Nearest).unwrap()
}

/// A transition of the four cells of a square of the lattice.
fn transition(frame: usize, column: usize, row: usize) -> Exchange {
    let cell = |x: usize, y: usize| (row + y) % SIDE * SIDE + (column + x) % SIDE;
    Exchange {
        frame,
        lost: [cell(0, 0), cell(1, 1)],
        made: [cell(1, 0), cell(0, 1)],
        position: Vector::new(column as f64 + 0.5, row as f64 + 0.5),
        lost_direction: 0.0,
        made_direction: 0.0,
    }
}

fn of(all: &Avalanches, quantity: Quantity) -> &Curve {
    all.curves.iter().find(|curve| curve.of == quantity).unwrap()
}

/// A chain that creeps on, a transition that is too late to belong to it and one too far away: three in space, and two in time, with their sizes, durations and extents.
#[test]
fn constructed_avalanches_are_found() {
    let recording = resting(20);
    let plan = Plan::of(&recording).unwrap();
    let all = [
        transition(2, 3, 3),
        transition(3, 5, 3),
        transition(4, 7, 3),
        transition(4, 15, 15),
        transition(12, 7, 3),
    ];
    let found = avalanches(&recording, &plan, &all, 0.5, 1);
    let sizes = |all: &[Avalanche]| all.iter().map(|own| own.size).collect::<Vec<_>>();
    assert_eq!((sizes(&found.local), sizes(&found.whole)), (vec![3, 1, 1], vec![4, 1]));
    let first = &found.local[0];
    assert_eq!((first.frames, first.cells, first.duration), ([2, 4], 12, 1.0));
    assert!((first.position - Vector::new(5.5, 3.5)).norm() < 1e-12);
    assert!((first.extent - (8f64 / 3.0).sqrt()).abs() < 1e-12);
    assert!((of(&found, Quantity::AvalancheSize).value[0] - 11.0 / 5.0).abs() < 1e-12);
    let sizes = of(&found, Quantity::AvalancheSizes);
    assert_eq!(sizes.at[..3], [1.0, 2.0, 3.0]);
    assert!((sizes.value[0] - 2.0 / 3.0).abs() < 1e-12 && sizes.count[..3] == [2, 0, 1]);
    // With a threshold of one frame the chain is whole; with one that reaches to the last it has that, too.
    let by_time = of(&found, Quantity::AvalancheThreshold);
    assert!((by_time.value[0] - 11.0 / 5.0).abs() < 1e-12);
    let long = by_time.at.iter().position(|time| (*time - 4.0).abs() < 1e-9).unwrap();
    assert!((by_time.value[long] - 17.0 / 5.0).abs() < 1e-12);
    let stress: Vec<f64> = (0..20).map(|frame| if frame < 3 { 1.0 } else { 0.25 }).collect();
    let (fallen, mean) = drops(&recording, &found.whole, &stress);
    assert_eq!((fallen, mean.value[0]), (vec![0.75, 0.0], 0.375));
    let back = Exchange { frame: 5, lost: all[3].made, made: all[3].lost, ..all[3] };
    let undone = [all[0], all[1], all[2], all[3], back];
    let found = avalanches(&recording, &plan, &undone, 0.5, 1);
    assert!((of(&found, Quantity::ExchangeReversal).value[0] - 0.2).abs() < 1e-12);
}

/// Transitions of squares that do not touch, each square with a probability p in each frame: sizes are geometric. A chain goes on if one of the next m frames has one:
/// q = 1 − (1 − p)^m, ⟨s⟩ = 1/(1 − q), ⟨s²⟩/⟨s⟩ = (1 + q)/(1 − q). Of the whole field, with N squares, the same with 1 − (1 − p)^N for p, and as many to a frame.
#[test]
fn random_transitions_have_the_sizes_of_their_theory() {
    let frames = 400;
    let recording = resting(frames);
    let plan = Plan::of(&recording).unwrap();
    for (p, steps, seed) in [(0.02f64, 3, 1), (0.08, 3, 2), (0.2, 1, 3)] {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut all = Vec::new();
        for frame in 1..frames {
            for square in (0..36).filter(|_| rng.random::<f64>() < p) {
                all.push(transition(frame, square % 6 * 4, square / 6 * 4));
            }
        }
        let found = avalanches(&recording, &plan, &all, 0.5 * f64::from(steps), seed);
        let q = 1.0 - (1.0 - p).powi(steps);
        // At each other's times several may be in one frame: of a Poisson distribution, so that frames with some have a mean c and a variance.
        let rest = (-p).exp();
        let (c, square) = (p / (1.0 - rest), (p + p * p) / (1.0 - rest));
        let other = 1.0 - rest.powi(steps);
        let shuffled = (square - c * c) / c + c * (1.0 + other) / (1.0 - other);
        for (quantity, expected) in
            [(Quantity::AvalancheSize, (1.0 + q) / (1.0 - q)), (Quantity::AvalancheSizeShuffled, shuffled)]
        {
            let own = of(&found, quantity);
            let error = own.standard_error[0].max(0.005 * expected);
            assert!((own.value[0] - expected).abs() < 4.5 * error, "{p}: {own:?}, {expected}");
        }
        let sizes = of(&found, Quantity::AvalancheSizes);
        for k in (0..sizes.at.len()).filter(|k| sizes.count[*k] > 20 && sizes.at[*k] < 4.0) {
            let share = q.powf(sizes.at[k] - 1.0) * (1.0 - q);
            assert!((sizes.value[k] - share).abs() < 4.5 * sizes.standard_error[k].max(0.002), "{sizes:?}");
        }
        // Of the whole field bursts begin where so many frames before are empty: their number is that of frames times P (1 − P)^m.
        let occupied: f64 = 1.0 - (1.0 - p).powi(36);
        let expected = 36.0 * p / (occupied * (1.0 - occupied).powi(steps));
        let mean = all.len() as f64 / found.whole.len() as f64;
        let error = mean / (found.whole.len() as f64).sqrt();
        assert!((mean - expected).abs() < 4.5 * error || found.whole.len() < 5, "{p}: {mean} {expected}");
    }
}

/// Transitions that set off others nearby make avalanches that are larger than those of the same transitions at other times; the number of transitions stays.
#[test]
fn transitions_that_set_off_others_are_told_from_such_at_random() {
    let recording = resting(300);
    let plan = Plan::of(&recording).unwrap();
    let mut rng = Pcg64::seed_from_u64(4);
    let mut all = Vec::new();
    for frame in 1..290 {
        if rng.random::<f64>() < 0.2 {
            let [x, y] = [(); 2].map(|()| rng.random_range(0..SIDE));
            (0..4).for_each(|k| all.push(transition(frame + k, x + 2 * k, y)));
        }
    }
    all.sort_by_key(|own| own.frame);
    let found = avalanches(&recording, &plan, &all, 0.5, 4);
    assert_eq!(found.local.iter().map(|own| own.size).sum::<usize>(), all.len());
    let [own, random] =
        [Quantity::AvalancheSize, Quantity::AvalancheSizeShuffled].map(|quantity| of(&found, quantity));
    let apart = own.value[0] - random.value[0];
    assert!(apart > 5.0 * own.standard_error[0] && own.value[0] >= 4.0, "{own:?} {random:?}");
    assert!(random.value[0] < 2.0, "{random:?}");
}
