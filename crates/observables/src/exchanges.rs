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
            .filter(|track| frames[frame].position_of_track(*track).is_none())
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
