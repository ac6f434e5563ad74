//! Avalanches of T1 transitions: those that touch within a time, in space or in the whole field.

use crate::curve::{PARTS, Sums};
use crate::{Curve, Exchange, Plan, Quantity, Recording};
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::BTreeSet;
use voronudge_geometry::Vector;

/// Transitions that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Avalanche {
    /// The frames after the first and after the last of them.
    pub frames: [usize; 2],
    /// How many they are.
    pub size: usize,
    /// How many cells take part.
    pub cells: usize,
    /// Time between the first and the last.
    pub duration: f64,
    /// Their mean position.
    pub position: Vector<f64>,
    /// Root mean square distance from it.
    pub extent: f64,
}

/// The avalanches of a recording, and what is to be said of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Avalanches {
    /// Transitions of which each touches another, in space and, within the threshold, in time.
    pub local: Vec<Avalanche>,
    /// Transitions anywhere, of which each follows another within the threshold.
    pub whole: Vec<Avalanche>,
    /// Distributions and means, of transitions at random times beside them.
    pub curves: Vec<Curve>,
}

/// Transitions by frame, each the frame after it and which it is of all.
type Sequence = Vec<[usize; 2]>;

/// How transitions belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Local,
    Whole,
}

/// Roundings of times, in units of the threshold.
const ROUNDING: f64 = 1e-9;

/// The avalanches of transitions: chains of which each touches the next, as cells of both are the same or next to each other when the later one happens, at most
/// `threshold` later; and chains of which each follows the next at most so much later, wherever it is. Beside them are those of the same transitions at
/// times drawn at random, sixteen times over: local ones exchange their times, those of the whole field have any.
pub fn avalanches(
    recording: &Recording,
    plan: &Plan,
    exchanges: &[Exchange],
    threshold: f64,
    seed: u64,
) -> Avalanches {
    let own: Sequence = exchanges.iter().enumerate().map(|(event, own)| [own.frame, event]).collect();
    let groups = |kind, sequence: &Sequence, threshold| match kind {
        Kind::Local => touching(recording, exchanges, sequence, threshold),
        Kind::Whole => following(recording, sequence, threshold),
    };
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut curves = Vec::new();
    let mut found = [Kind::Local, Kind::Whole].map(|kind| {
        let random: Vec<Sequence> = (0..PARTS)
            .map(|_| match kind {
                Kind::Local => times_exchanged(&own, &mut rng),
                Kind::Whole => anywhen(recording, &own, &mut rng),
            })
            .collect();
        let all = groups(kind, &own, threshold);
        let described: Vec<Avalanche> = all.iter().map(|own| describe(recording, exchanges, own)).collect();
        let with_parts = |all: Vec<Sequence>| -> Vec<(usize, usize)> {
            let part = |own: &Sequence| own[0][0] * PARTS / recording.frames().len();
            all.iter().map(|own| (part(own), own.len())).collect()
        };
        let at_random = |threshold: f64| -> Vec<(usize, usize)> {
            let of = |(part, own): (usize, &Sequence)| {
                let sizes = groups(kind, own, threshold).into_iter().map(move |group| (part, group.len()));
                sizes.collect::<Vec<_>>()
            };
            random.iter().enumerate().flat_map(of).collect()
        };
        let [sizes, sizes_random, mean, mean_random, by_time, by_time_random] = quantities(kind);
        let (seen, chance) = (with_parts(all), at_random(threshold));
        curves.extend([distribution(sizes, &seen), distribution(sizes_random, &chance)]);
        curves.extend([means(mean, &[(0.0, seen)]), means(mean_random, &[(0.0, chance)])]);
        let scan = |of: &dyn Fn(f64) -> Vec<(usize, usize)>| -> Vec<(f64, Vec<(usize, usize)>)> {
            plan.times().into_iter().map(|time| (time, of(time))).collect()
        };
        curves.push(means(by_time, &scan(&|time| with_parts(groups(kind, &own, time)))));
        curves.push(means(by_time_random, &scan(&at_random)));
        described
    });
    let [local, whole] = &mut found;
    curves.extend(of_each(recording, local));
    curves.push(reversals(recording, exchanges, threshold));
    curves.retain(|curve| curve.value.iter().any(|value| value.is_finite()));
    Avalanches { local: std::mem::take(local), whole: std::mem::take(whole), curves }
}

/// Distributions, mean sizes and these against the threshold, each followed by that of transitions at random times.
fn quantities(kind: Kind) -> [Quantity; 6] {
    use Quantity::*;
    match kind {
        Kind::Local => [
            AvalancheSizes,
            AvalancheSizesShuffled,
            AvalancheSize,
            AvalancheSizeShuffled,
            AvalancheThreshold,
            AvalancheThresholdShuffled,
        ],
        Kind::Whole => [
            BurstSizes,
            BurstSizesShuffled,
            BurstSize,
            BurstSizeShuffled,
            BurstThreshold,
            BurstThresholdShuffled,
        ],
    }
}

/// Chains of transitions that touch.
fn touching(
    recording: &Recording,
    exchanges: &[Exchange],
    sequence: &Sequence,
    threshold: f64,
) -> Vec<Sequence> {
    let frames = recording.frames();
    let mut roots: Vec<usize> = (0..sequence.len()).collect();
    // Of those before that a cell took part in the last one is enough: it is in one chain with the others that are not too long ago.
    let mut last: Vec<Option<usize>> = vec![None; recording.tracks()];
    for (k, &[frame, event]) in sequence.iter().enumerate() {
        let (at, own) = (&frames[frame], exchanges[event].cells());
        let around = own
            .iter()
            .filter_map(|track| at.cell(*track))
            .flat_map(|cell| at.tessellation.neighbours(cell).iter().map(|other| at.tracks[*other as usize]));
        for before in around.chain(own).filter_map(|track| last[track]) {
            if at.time - frames[sequence[before][0]].time <= threshold * (1.0 + ROUNDING) {
                let [a, b] = [root(&mut roots, k), root(&mut roots, before)];
                roots[a.max(b)] = a.min(b);
            }
        }
        own.into_iter().for_each(|track| last[track] = Some(k));
    }
    let mut groups: Vec<Sequence> = vec![Vec::new(); sequence.len()];
    for (k, own) in sequence.iter().enumerate() {
        groups[root(&mut roots, k)].push(*own);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

fn root(roots: &mut [usize], mut k: usize) -> usize {
    while roots[k] != k {
        roots[k] = roots[roots[k]];
        k = roots[k];
    }
    k
}

/// Chains of transitions that follow each other, wherever they are.
fn following(recording: &Recording, sequence: &Sequence, threshold: f64) -> Vec<Sequence> {
    let time = |own: &[usize; 2]| recording.frames()[own[0]].time;
    let near = |a: &[usize; 2], b: &[usize; 2]| time(b) - time(a) <= threshold * (1.0 + ROUNDING);
    sequence.chunk_by(near).map(<[_]>::to_vec).collect()
}

/// The same transitions, each at the time of another.
fn times_exchanged(sequence: &Sequence, rng: &mut Pcg64) -> Sequence {
    let mut events: Vec<usize> = sequence.iter().map(|own| own[1]).collect();
    events.shuffle(rng);
    sequence.iter().zip(events).map(|(own, event)| [own[0], event]).collect()
}

/// The same transitions at any time.
fn anywhen(recording: &Recording, sequence: &Sequence, rng: &mut Pcg64) -> Sequence {
    let frames = recording.frames();
    let (first, last) = (frames[0].time, frames[frames.len() - 1].time);
    let mut any = || {
        let time = first + (last - first) * rng.random::<f64>();
        frames.partition_point(|frame| frame.time < time).clamp(1, frames.len() - 1)
    };
    let mut all: Sequence = sequence.iter().map(|own| [any(), own[1]]).collect();
    all.sort_unstable();
    all
}

fn describe(recording: &Recording, exchanges: &[Exchange], group: &Sequence) -> Avalanche {
    let frames = recording.frames();
    let [first, last] = [group[0][0], group[group.len() - 1][0]];
    let domain = frames[first].tessellation.domain();
    let start = exchanges[group[0][1]].position;
    let size = group.len() as f64;
    let ways: Vec<Vector<f64>> =
        group.iter().map(|[_, event]| domain.shortest(exchanges[*event].position - start)).collect();
    let mean = ways.iter().sum::<Vector<f64>>() / size;
    let cells: BTreeSet<usize> = group.iter().flat_map(|[_, event]| exchanges[*event].cells()).collect();
    Avalanche {
        frames: [first, last],
        size: group.len(),
        cells: cells.len(),
        duration: frames[last].time - frames[first].time,
        position: domain.wrap(start + mean),
        extent: (ways.iter().map(|way| (way - mean).norm_squared()).sum::<f64>() / size).sqrt(),
    }
}

/// Share of avalanches of a size, to one transition more, in bins that become longer by about the root of two. Each is (part, size).
fn distribution(of: Quantity, all: &[(usize, usize)]) -> Curve {
    let largest = all.iter().map(|(_, size)| *size).max().unwrap_or(0);
    let mut starts = vec![1];
    while let Some(&start) = starts.last().filter(|start| **start <= largest) {
        starts.push((start as f64 * 2f64.sqrt()).round().max(start as f64 + 1.0) as usize);
    }
    let bins: Vec<&[usize]> = starts.windows(2).collect();
    let mut sums = Sums::new(bins.len());
    for (part, size) in all {
        for (bin, own) in bins.iter().enumerate() {
            let within = (own[0]..own[1]).contains(size);
            sums.add(bin, *part, f64::from(u8::from(within)), (own[1] - own[0]) as f64);
        }
    }
    let middle = |own: &&[usize]| (own[0] as f64 * (own[1] - 1) as f64).sqrt();
    let at = bins.iter().map(middle).collect();
    let mut curve = sums.curve(of, at);
    // What a point rests on are the avalanches of its sizes.
    curve.count = (bins.iter())
        .map(|own| all.iter().filter(|(_, size)| (own[0]..own[1]).contains(size)).count())
        .collect();
    curve
}

/// `⟨s²⟩/⟨s⟩`: the mean size of the avalanche that a transition belongs to, of each set.
fn means(of: Quantity, sets: &[(f64, Vec<(usize, usize)>)]) -> Curve {
    let mut sums = Sums::new(sets.len());
    for (point, (_, all)) in sets.iter().enumerate() {
        for (part, size) in all {
            let size = *size as f64;
            sums.add(point, *part, size * size, size);
        }
    }
    sums.curve(of, sets.iter().map(|(at, _)| *at).collect())
}

/// Mean duration and extent of the avalanche that a transition belongs to.
fn of_each(recording: &Recording, all: &[Avalanche]) -> [Curve; 2] {
    let [mut duration, mut extent] = [(); 2].map(|()| Sums::new(1));
    for own in all {
        let (part, size) = (own.frames[0] * PARTS / recording.frames().len(), own.size as f64);
        duration.add(0, part, own.duration * size, size);
        extent.add(0, part, own.extent * size, size);
    }
    [
        duration.curve(Quantity::AvalancheDuration, vec![0.0]),
        extent.curve(Quantity::AvalancheExtent, vec![0.0]),
    ]
}

/// By how much a quantity of each frame, such as the shear stress, falls from the frame before each avalanche to its last.
pub fn drops(recording: &Recording, all: &[Avalanche], values: &[f64]) -> (Vec<f64>, Curve) {
    let mut sums = Sums::new(1);
    let drops = (all.iter())
        .map(|own| {
            let [first, last] = own.frames;
            let drop = values[first - 1] - values[last];
            sums.add(0, first * PARTS / recording.frames().len(), drop, 1.0);
            drop
        })
        .collect();
    (drops, sums.curve(Quantity::BurstStressDrop, vec![0.0]))
}

/// The share of transitions that the same four cells undo within the threshold.
fn reversals(recording: &Recording, exchanges: &[Exchange], threshold: f64) -> Curve {
    let frames = recording.frames();
    let mut sums = Sums::new(1);
    for (k, own) in exchanges.iter().enumerate() {
        let later = exchanges[k + 1..].iter().take_while(|other| {
            frames[other.frame].time - frames[own.frame].time <= threshold * (1.0 + ROUNDING)
        });
        let undone = later.into_iter().any(|other| other.lost == own.made && other.made == own.lost);
        sums.add(0, own.frame * PARTS / frames.len(), f64::from(u8::from(undone)), 1.0);
    }
    sums.curve(Quantity::ExchangeReversal, vec![0.0])
}
