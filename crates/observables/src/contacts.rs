//! Who is next to whom, and for how long.

use crate::curve::Sums;
use crate::motion::at_lags;
use crate::{Curve, Frame, Plan, Quantity, Recording};

/// The pairs of cells of a frame that are in contact, both of which count, by the numbers of their tracks, the smaller first.
pub(crate) fn contacts(frame: &Frame) -> Vec<[usize; 2]> {
    let mut all: Vec<[usize; 2]> = frame
        .in_view()
        .flat_map(|cell| {
            let own = frame.tracks[cell];
            let of = move |other: &u32| [own, frame.tracks[*other as usize]];
            frame.tessellation.neighbours(cell).iter().map(of)
        })
        .filter(|[own, other]| own < other)
        .filter(|[_, other]| frame.position_of_track(*other).is_some())
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Whether both cells of a contact count in a frame.
fn seen(frame: &Frame, pair: &[usize; 2]) -> bool {
    pair.iter().all(|track| frame.position_of_track(*track).is_some())
}

/// Contacts of two frames that are in one of them only, though all their cells count in both; ascending.
pub(crate) struct Changes {
    pub made: Vec<[usize; 2]>,
    pub lost: Vec<[usize; 2]>,
}

impl Changes {
    /// Given the frames with their [`contacts`].
    pub fn between((before, own): (&Frame, &[[usize; 2]]), (after, next): (&Frame, &[[usize; 2]])) -> Self {
        let only = |all: &[[usize; 2]], others: &[[usize; 2]], frame: &Frame| {
            let is_new = |pair: &&[usize; 2]| others.binary_search(pair).is_err() && seen(frame, pair);
            all.iter().filter(is_new).copied().collect()
        };
        Self { made: only(next, own, before), lost: only(own, next, after) }
    }
}

/// The T1 transitions per cell and time from frame to frame, and the share of contacts that last, by lag.
pub(crate) fn exchange(recording: &Recording, plan: &Plan) -> [Curve; 2] {
    let frames = recording.frames();
    let all: Vec<Vec<[usize; 2]>> = frames.iter().map(contacts).collect();
    let has = |frame: usize, pair: &[usize; 2]| all[frame].binary_search(pair).is_ok();
    let lasting = at_lags(plan, frames.len(), |sums, (point, from, to)| {
        for pair in all[from].iter().filter(|pair| seen(&frames[to], pair)) {
            let parts = pair.map(|track| plan.parts[track]);
            sums.add_pair(point, parts, f64::from(u8::from(has(to, pair))), 1.0);
        }
    });
    let mut made = Sums::new(1);
    for to in 1..frames.len() {
        let [from, own] = [&frames[to - 1], &frames[to]];
        let time = own.time - from.time;
        for track in own.in_view().map(|cell| own.tracks[cell]) {
            if from.position_of_track(track).is_some() {
                made.add(0, plan.parts[track], 0.0, time);
            }
        }
        for pair in Changes::between((from, &all[to - 1]), (own, &all[to])).made {
            made.add_pair(0, pair.map(|track| plan.parts[track]), 1.0, 0.0);
        }
    }
    let rate = made.curve(Quantity::TransitionRate, vec![0.0]);
    [rate, lasting.curve(Quantity::ContactSurvival, plan.times())]
}
