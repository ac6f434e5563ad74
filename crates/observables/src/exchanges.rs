//! T1 transitions one by one: where they happen, which way they turn contacts, and whether they set off each other.

use crate::contacts::{Changes, contacts};
use crate::curve::Sums;
use crate::motion::at_lags;
use crate::pairs::wrapped;
use crate::shape::distribute;
use crate::{Curve, Frame, Plan, Quantity, Recording};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use voronudge_geometry::{Vector, areas};

/// Bins of directions from −π/2 to π/2.
const DIRECTIONS: usize = 12;

/// Four cells of which two lose their contact and the other two make one, from one frame to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exchange {
    /// The frame after it.
    pub frame: usize,
    /// Tracks of the cells that lose their contact, the smaller first.
    pub lost: [usize; 2],
    /// Tracks of those that make one.
    pub made: [usize; 2],
    /// The middle between those that make one, in the box.
    pub position: Vector<f64>,
    /// Direction of the contact lost, before, from −π/2 to π/2.
    pub lost_direction: f64,
    /// Direction of the contact made, after.
    pub made_direction: f64,
}

/// The transitions between frames that follow each other, of cells that count before and after. Contacts that change as part of several transitions, of which no single one can
/// be told, are left out.
pub fn exchanges(recording: &Recording) -> Vec<Exchange> {
    let frames = recording.frames();
    let all: Vec<Vec<[usize; 2]>> = frames.par_iter().map(contacts).collect();
    let between = |frame: usize| {
        let [before, after] = [&frames[frame - 1], &frames[frame]];
        let changes = Changes::between((before, &all[frame - 1]), (after, &all[frame]));
        let exchange = |made: &[usize; 2]| {
            let lost = changes.lost_for(before, *made)?;
            let lost_direction = direction(before, lost)?;
            let made_direction = direction(after, *made)?;
            let [first, second] = [after.cell(made[0])?, after.cell(made[1])?];
            let domain = after.tessellation.domain();
            let first = wrapped(after, first);
            let way = domain.shortest(wrapped(after, second) - first);
            Some(Exchange {
                frame,
                lost,
                made: *made,
                position: domain.wrap(first + way * 0.5),
                lost_direction,
                made_direction,
            })
        };
        changes.made.iter().filter_map(exchange).collect::<Vec<_>>()
    };
    (1..frames.len()).into_par_iter().flat_map_iter(between).collect()
}

impl Changes {
    /// The one lost contact between cells that both were next to both of those that make one.
    fn lost_for(&self, before: &Frame, made: [usize; 2]) -> Option<[usize; 2]> {
        let around = |track: usize| {
            let cell = before.cell(track)?;
            let of = |other: &u32| before.tracks[*other as usize];
            Some(before.tessellation.neighbours(cell).iter().map(of).collect::<Vec<_>>())
        };
        let [first, second] = [around(made[0])?, around(made[1])?];
        let common: Vec<usize> = first.into_iter().filter(|track| second.contains(track)).collect();
        let pairs = common.iter().flat_map(|one| common.iter().map(move |other| [*one, *other]));
        let mut found = pairs.filter(|pair| pair[0] < pair[1] && self.lost.binary_search(pair).is_ok());
        let one = found.next()?;
        found.next().is_none().then_some(one)
    }
}

/// The direction from one cell to another, from −π/2 to π/2.
fn direction(frame: &Frame, pair: [usize; 2]) -> Option<f64> {
    let [first, second] = [frame.cell(pair[0])?, frame.cell(pair[1])?];
    let way = frame.tessellation.domain().shortest(frame.positions[second] - frame.positions[first]);
    Some(to_half_turn(way.y.atan2(way.x)))
}

/// An angle between axes, from −π/2 to π/2.
fn to_half_turn(angle: f64) -> f64 {
    angle - PI * (angle / PI).round()
}

impl Exchange {
    /// The tracks of its four cells.
    pub fn cells(&self) -> [usize; 4] {
        [self.lost[0], self.lost[1], self.made[0], self.made[1]]
    }

    /// By which angle the four cells have turned anticlockwise, from −π/2 to π/2: from the contact lost to the one made it is a quarter turn and this.
    pub fn turn(&self) -> f64 {
        to_half_turn(self.made_direction - self.lost_direction - FRAC_PI_2)
    }
}

/// Which way contacts are made, by how much the cells turn, whether transitions come together, and how long cells wait for one.
pub fn exchange_statistics(recording: &Recording, plan: &Plan, exchanges: &[Exchange]) -> Vec<Curve> {
    let (mut along, mut turn, mut angles) = (Sums::new(1), Sums::new(1), Sums::new(DIRECTIONS));
    let width = PI / DIRECTIONS as f64;
    for own in exchanges {
        let part = plan.parts[own.made[0]];
        along.add(0, part, (2.0 * own.made_direction).cos(), 1.0);
        turn.add(0, part, own.turn(), 1.0);
        distribute(&mut angles, (-FRAC_PI_2, width, DIRECTIONS), part, own.made_direction);
    }
    let middles = (0..DIRECTIONS).map(|bin| (bin as f64 + 0.5) * width - FRAC_PI_2).collect();
    let mut all = vec![
        along.curve(Quantity::ExchangeAlignment, vec![0.0]),
        turn.curve(Quantity::ExchangeTurn, vec![0.0]),
        angles.curve(Quantity::ExchangeDirection, middles),
        together(recording, plan, exchanges),
        waiting(recording, plan),
    ];
    all.retain(|curve| curve.value.iter().any(|value| value.is_finite()));
    all
}

/// Transitions at a distance from another one of the same interval, over as many as there would be if they knew nothing of each other.
fn together(recording: &Recording, plan: &Plan, exchanges: &[Exchange]) -> Curve {
    let mut sums = Sums::new(plan.bins);
    let bin = plan.bin();
    for group in exchanges.chunk_by(|a, b| a.frame == b.frame) {
        let frame = &recording.frames()[group[0].frame];
        let areas = areas(&frame.tessellation, &frame.positions);
        let area: f64 = frame.in_view().map(|cell| areas[cell]).sum();
        let others = (group.len() - 1) as f64;
        let domain = frame.tessellation.domain();
        for (k, own) in group.iter().enumerate() {
            let part = plan.parts[own.made[0]];
            let rings = plan.rings_in_view(frame, own.position);
            for ring in 0..rings {
                sums.add(ring, part, 0.0, others * plan.ring_area(ring) / area);
            }
            for other in group.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, other)| other) {
                let ring = (domain.shortest(other.position - own.position).norm() / bin) as usize;
                if ring < rings {
                    sums.add_pair(ring, [part, plan.parts[other.made[0]]], 1.0, 0.0);
                }
            }
        }
    }
    sums.curve(Quantity::ExchangeCorrelation, plan.distances())
}

/// The share of cells that have kept all their neighbours for a lag, of those that count all the while.
fn waiting(recording: &Recording, plan: &Plan) -> Curve {
    let frames = recording.frames();
    let all: Vec<Vec<[usize; 2]>> = frames.par_iter().map(contacts).collect();
    // Until each frame: how often a cell has changed neighbours, and in how many frames it did not count.
    let mut changes = vec![vec![[0u32; 2]; recording.tracks()]];
    for frame in 0..frames.len() {
        let mut sums = changes[frame].clone();
        (0..recording.tracks())
            .filter(|track| frames[frame].place(*track).is_none())
            .for_each(|track| sums[track][1] += 1);
        if let Some(before) = frame.checked_sub(1) {
            let own = Changes::between((&frames[before], &all[before]), (&frames[frame], &all[frame]));
            own.made.iter().chain(&own.lost).flatten().for_each(|track| sums[*track][0] += 1);
        }
        changes.push(sums);
    }
    let sums = at_lags(plan, frames.len(), |sums, (point, from, to)| {
        for cell in frames[from].in_view() {
            let track = frames[from].tracks[cell];
            let [start, end, until] =
                [changes[from][track], changes[to + 1][track], changes[from + 1][track]];
            if end[1] == start[1] {
                sums.add(point, plan.parts[track], f64::from(u8::from(end[0] == until[0])), 1.0);
            }
        }
    });
    sums.curve(Quantity::ExchangeWaiting, plan.times())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Images, observe};
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;
    use voronudge_geometry::{Domain, FieldOfView, PeriodicBox};

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
        let rate =
            observe(&recording, &plan).into_iter().find(|own| own.of == Quantity::TransitionRate).unwrap();
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
            let mut jitter =
                |size: f64| Vector::new(rng.random::<f64>() - 0.5, rng.random::<f64>() - 0.5) * size;
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
            Recording::new(&times, places, &[Domain::Open; 8], &FieldOfView::default(), Images::Nearest)
                .unwrap();
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
}
