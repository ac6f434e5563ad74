//! How cells move: how far they get, and how long they remember their velocity.

use crate::curve::Sums;
use crate::{Curve, Plan, Quantity, Recording};
use rayon::prelude::*;

/// Mean square displacements of cells that count at both ends.
pub(crate) fn displacement(recording: &Recording, plan: &Plan) -> Curve {
    let frames = recording.frames();
    let sums = at_lags(plan, frames.len(), |sums, (point, from, to)| {
        let (from, to) = (&frames[from], &frames[to]);
        for cell in from.in_view() {
            let track = from.tracks[cell];
            if let Some(place) = to.position_of_track(track) {
                let moved = place - from.positions[cell] + from.stage;
                sums.add(point, plan.parts[track], moved.norm_squared(), 1.0);
            }
        }
    });
    sums.curve(Quantity::MeanSquareDisplacement, plan.times())
}

/// Autocorrelation of the velocities of cells that count at both times.
pub(crate) fn memory(recording: &Recording, plan: &Plan) -> Curve {
    let frames = recording.frames();
    let sums = at_lags(plan, frames.len(), |sums, (point, from, to)| {
        let (from, to) = (&frames[from], &frames[to]);
        for cell in from.in_view() {
            let track = from.tracks[cell];
            let later = to.cell(track).filter(|cell| to.counted[*cell]).and_then(|cell| to.velocities[cell]);
            if let (Some(now), Some(later)) = (from.velocities[cell], later) {
                let squares = 0.5 * (now.norm_squared() + later.norm_squared());
                sums.add(point, plan.parts[track], now.dot(&later), squares);
            }
        }
    });
    sums.curve(Quantity::VelocityAutocorrelation, plan.times())
}

/// Mean square velocity of the cells that count.
pub(crate) fn speed(recording: &Recording, plan: &Plan) -> Curve {
    let mut sums = Sums::new(1);
    for frame in recording.frames() {
        for cell in frame.in_view() {
            if let Some(v) = frame.velocities[cell] {
                sums.add(0, plan.parts[frame.tracks[cell]], v.norm_squared(), 1.0);
            }
        }
    }
    sums.curve(Quantity::MeanSquareVelocity, vec![0.0])
}

/// Sums over all pairs of frames that are the lags of the plan apart: given the number of the lag and both frames.
pub(crate) fn at_lags(
    plan: &Plan,
    frames: usize,
    add: impl Fn(&mut Sums, (usize, usize, usize)) + Sync,
) -> Sums {
    let points = plan.lags.len();
    let of_lag = |point: usize| {
        let mut sums = Sums::new(points);
        (0..frames - plan.lags[point])
            .for_each(|from| add(&mut sums, (point, from, from + plan.lags[point])));
        sums
    };
    let all: Vec<Sums> = (0..points).into_par_iter().map(of_lag).collect();
    all.iter().fold(Sums::new(points), Sums::merge)
}
