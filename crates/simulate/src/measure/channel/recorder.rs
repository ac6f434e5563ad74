//! Counting cells, their displacements, births and deaths in bins across a channel.

use super::ChannelProfile;
use crate::walls::fold;
use crate::{Bond, Channel, Error, LastStep};

/// Sums over equal strips ("bins") of a channel and over equal pieces of time ("samples").
///
/// A cell that moves from one bin to another in a step counts in both, by the share of its path. So the displacements in a bin are,
/// without any error of the step, the number of cells that pass through each `x`, averaged over the bin, and the books balance:
/// what flows in, plus births, minus deaths, is what is there more. A cell that was put in front of a wall counts as having gone there.
///
/// ```
/// use voronudge_geometry::{PeriodicBox, Vector};
/// use voronudge_simulate::{Channel, LastStep, measure::ChannelRecorder};
/// let channel = Channel::new(&PeriodicBox::new([4.0, 2.0])?)?;
/// let mut recorder = ChannelRecorder::new(channel, 4)?;
/// // One cell that goes from x = 0.5 to 1.5 in a step of 0.1.
/// let (from, to) = (vec![Vector::new(0.5, 0.0)], vec![Vector::new(1.5, 0.0)]);
/// recorder.add(&LastStep { time_step: 0.1, from, to, ..LastStep::default() });
/// recorder.end_sample();
/// let profile = recorder.profile();
/// assert_eq!(profile.density[0].value, 0.5 / 2.0); // half the time in a bin of area 2
/// assert!((profile.velocity[0][1].value - 10.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ChannelRecorder {
    channel: Channel,
    bins: usize,
    current: Sample,
    samples: Vec<Sample>,
}

/// Sums over a piece of time. Vectors over bins, except those over the faces of bins, where a place counts by its distance
/// from the face, falling to zero over the width of a bin on either side.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Sample {
    pub duration: f64,
    /// Cells times time.
    pub residence: Vec<f64>,
    /// Displacements along x and y.
    pub displacement: [Vec<f64>; 2],
    /// Virials `−f ⊗ d` of bonds times time, row = component of the force, by the share of the bond in the bin (Irving and Kirkwood).
    pub virial: Vec<[[f64; 2]; 2]>,
    pub births: Vec<f64>,
    pub deaths: Vec<f64>,
    /// Births minus deaths. While counting, at all faces from edge to edge; then as [`Sample::between_walls`] and the others say.
    pub net_at_face: Vec<f64>,
}

impl ChannelRecorder {
    /// A recorder with a number of bins, which is even, so that the bins are symmetric about the middle.
    ///
    /// # Errors
    /// [`Error::Bins`] if it is odd or zero.
    pub fn new(channel: Channel, bins: usize) -> Result<Self, Error> {
        if bins == 0 || !bins.is_multiple_of(2) {
            return Err(Error::Bins { bins });
        }
        Ok(Self { channel, bins, current: Sample::new(bins), samples: Vec::new() })
    }

    /// Takes in a step.
    pub fn add(&mut self, step: &LastStep) {
        let (bins, walled, width) =
            (self.bins, self.channel.is_walled(), self.channel.width() / self.bins as f64);
        let number = |bin: f64| match bin as i64 {
            bin if (0..bins as i64).contains(&bin) => bin as usize,
            bin if walled => bin.clamp(0, bins as i64 - 1) as usize,
            bin => bin.rem_euclid(bins as i64) as usize,
        };
        // What a cell does behind a wall, its mirror image does in front of it.
        let mirrored = |bin: f64| {
            if !walled {
                return (number(bin), 1.0);
            }
            let (middle, sign) = fold(bin + 0.5, bins as f64);
            (number(middle.floor()), sign)
        };
        let sample = &mut self.current;
        sample.duration += step.time_step;
        for (from, to) in step.from.iter().zip(&step.to) {
            let moved = to - from;
            along(from.x / width, to.x / width, |bin, share| {
                let bin = number(bin);
                sample.residence[bin] += share * step.time_step;
                sample.displacement[0][bin] += share * moved.x;
                sample.displacement[1][bin] += share * moved.y;
            });
        }
        for Bond { from, to, force } in &step.bonds {
            let virial = force * to.transpose() * -step.time_step;
            along(from.x / width, (from.x + to.x) / width, |bin, share| {
                let (bin, sign) = mirrored(bin);
                for (row, sums) in sample.virial[bin].iter_mut().enumerate() {
                    for (column, sum) in sums.iter_mut().enumerate() {
                        *sum += if row == column { share } else { sign * share } * virial[(row, column)];
                    }
                }
            });
        }
        // Of a division each of the two daughters counts as half a birth, but both are there and the mother is not.
        let births = if step.divisions.is_empty() { 1.0 } else { 0.5 };
        for (places, sign, count) in
            [(&step.births, 1.0, births), (&step.extrusions, -1.0, 1.0), (&step.divisions, -1.0, 0.0)]
        {
            for place in places {
                let at = place.x / width;
                let (bin, beyond) = (number(at.floor()), at - at.floor());
                let counts = if sign > 0.0 { &mut sample.births } else { &mut sample.deaths };
                counts[bin] += count;
                sample.net_at_face[bin] += sign * (1.0 - beyond);
                sample.net_at_face[bin + 1] += sign * beyond;
            }
        }
    }

    /// Ends a sample: what comes next counts for the next.
    pub fn end_sample(&mut self) {
        if self.current.duration > 0.0 {
            self.samples.push(std::mem::replace(&mut self.current, Sample::new(self.bins)));
        }
    }

    /// Number of samples ended.
    pub fn samples(&self) -> usize {
        self.samples.len()
    }

    /// Averages over the samples, from edge to edge.
    pub fn profile(&self) -> ChannelProfile {
        let unfold = if self.channel.is_walled() { Sample::between_walls } else { Sample::periodic };
        let samples: Vec<Sample> = self.samples.iter().map(unfold).collect();
        ChannelProfile::over_bins(self.channel, &samples)
    }

    /// Averages over the samples and over both halves of the channel, from an edge to the middle.
    ///
    /// The channel is the same after a rotation by π about any point of its middle, α included, between walls too: densities,
    /// stresses and rates are the same at `x` and `W − x`, and both components of the velocity are opposite. (A mirror would turn α into −α.)
    pub fn folded_profile(&self) -> ChannelProfile {
        let folded: Vec<Sample> = self.samples.iter().map(Sample::folded).collect();
        ChannelProfile::over_half(self.channel, &folded)
    }
}

impl Sample {
    fn new(bins: usize) -> Self {
        let zeros = || vec![0.0; bins];
        Self {
            duration: 0.0,
            residence: zeros(),
            displacement: [zeros(), zeros()],
            virial: vec![[[0.0; 2]; 2]; bins],
            births: zeros(),
            deaths: zeros(),
            net_at_face: vec![0.0; bins + 1],
        }
    }

    /// The same with both edges as one face, the first.
    fn periodic(&self) -> Self {
        let mut net_at_face = self.net_at_face.clone();
        let last = net_at_face.pop();
        net_at_face.iter_mut().zip(last).for_each(|(first, last)| *first += last);
        Self { net_at_face, ..self.clone() }
    }

    /// The same with the walls as faces between the bins beside them and their mirror images.
    fn between_walls(&self) -> Self {
        let mut net_at_face = self.net_at_face.clone();
        let last = net_at_face.len() - 1;
        [0, last].into_iter().for_each(|wall| net_at_face[wall] *= 2.0);
        Self { net_at_face, ..self.clone() }
    }

    /// The sum over both halves, seen from the left edge. Edge and middle are faces between a half and the other.
    fn folded(&self) -> Self {
        let bins = self.residence.len();
        let fold = |values: &[f64], sign: f64| -> Vec<f64> {
            (0..bins / 2).map(|bin| values[bin] + sign * values[bins - 1 - bin]).collect()
        };
        let twice = |face: usize| if face == 0 { 2.0 } else { 1.0 };
        let faces =
            (0..=bins / 2).map(|face| twice(face) * (self.net_at_face[face] + self.net_at_face[bins - face]));
        Self {
            duration: self.duration,
            residence: fold(&self.residence, 1.0),
            displacement: [0, 1].map(|axis| fold(&self.displacement[axis], -1.0)),
            virial: (0..bins / 2)
                .map(|bin| {
                    let [left, right] = [bin, bins - 1 - bin].map(|bin| self.virial[bin]);
                    [0, 1].map(|row| [0, 1].map(|column| left[row][column] + right[row][column]))
                })
                .collect(),
            births: fold(&self.births, 1.0),
            deaths: fold(&self.deaths, 1.0),
            net_at_face: faces.collect(),
        }
    }
}

/// The largest whole number below, of one that is far smaller than 2⁶³: without a call, where the processor's own instruction may not be used.
fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}

/// The bins between two places, in widths of a bin, and the share of the path in each.
fn along(start: f64, end: f64, mut enter: impl FnMut(f64, f64)) {
    let [low, high] = if start <= end { [start, end] } else { [end, start] };
    let (first, last) = (floor(low), floor(high));
    if first == last {
        enter(first, 1.0);
        return;
    }
    let mut bin = first;
    while bin <= last {
        enter(bin, ((bin + 1.0).min(high) - bin.max(low)) / (high - low));
        bin += 1.0;
    }
}
