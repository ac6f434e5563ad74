//! Counting cells, their displacements, births and deaths in bins across a channel.

use super::ChannelProfile;
use crate::{Bond, Channel, Error, LastStep};

/// Sums over equal strips ("bins") of a channel and over equal pieces of time ("samples").
///
/// A cell that moves from one bin to another in a step counts in both, by the share of its path. So the displacements in a bin are,
/// without any error of the step, the number of cells that pass through each `x`, averaged over the bin, and the books balance:
/// what flows in, plus births, minus deaths, is what is there more.
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

/// Sums over a piece of time. Vectors over bins, except those over the faces between them, where a place counts by its distance
/// from the face, falling to zero over the width of a bin on either side.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Sample {
    pub duration: f64,
    /// Cells times time.
    pub residence: Vec<f64>,
    /// Displacements along x and y.
    pub displacement: [Vec<f64>; 2],
    /// Virials `−f ⊗ d` of bonds times time, row = component of the force, by the share of the bond in the bin (Irving and Kirkwood).
    pub virial: [[Vec<f64>; 2]; 2],
    pub births: Vec<f64>,
    pub deaths: Vec<f64>,
    /// Births minus deaths.
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
        let (bins, width) = (self.bins, self.channel.width() / self.bins as f64);
        let sample = &mut self.current;
        sample.duration += step.time_step;
        for (from, to) in step.from.iter().zip(&step.to) {
            let moved = to - from;
            along(from.x / width, to.x / width, |bin, share| {
                let bin = number(bin, bins);
                sample.residence[bin] += share * step.time_step;
                sample.displacement[0][bin] += share * moved.x;
                sample.displacement[1][bin] += share * moved.y;
            });
        }
        for Bond { from, to, force } in &step.bonds {
            let virial = force * to.transpose() * -step.time_step;
            along(from.x / width, (from.x + to.x) / width, |bin, share| {
                let bin = number(bin, bins);
                for (row, sums) in sample.virial.iter_mut().enumerate() {
                    for (column, sum) in sums.iter_mut().enumerate() {
                        sum[bin] += share * virial[(row, column)];
                    }
                }
            });
        }
        for (places, sign) in [(&step.births, 1.0), (&step.extrusions, -1.0)] {
            for place in places {
                let at = place.x / width;
                let (bin, beyond) = (number(at.floor(), bins), at - at.floor());
                let counts = if sign > 0.0 { &mut sample.births } else { &mut sample.deaths };
                counts[bin] += 1.0;
                sample.net_at_face[bin] += sign * (1.0 - beyond);
                sample.net_at_face[(bin + 1) % bins] += sign * beyond;
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
        ChannelProfile::over_bins(self.channel, &self.samples)
    }

    /// Averages over the samples and over both halves of the channel, from an edge to the middle.
    ///
    /// The channel is the same after a rotation by π about any point of its middle, α included: densities and rates and stresses are the same
    /// at `x` and `W − x`, and both components of the velocity are opposite. (A mirror would turn α into −α.)
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
            virial: [[zeros(), zeros()], [zeros(), zeros()]],
            births: zeros(),
            deaths: zeros(),
            net_at_face: zeros(),
        }
    }

    /// The sum over both halves, seen from the left edge.
    fn folded(&self) -> Self {
        let bins = self.residence.len();
        let fold = |values: &[f64], sign: f64| -> Vec<f64> {
            (0..bins / 2).map(|bin| values[bin] + sign * values[bins - 1 - bin]).collect()
        };
        let faces =
            (0..=bins / 2).map(|face| self.net_at_face[face] + self.net_at_face[(bins - face) % bins]);
        Self {
            duration: self.duration,
            residence: fold(&self.residence, 1.0),
            displacement: [0, 1].map(|axis| fold(&self.displacement[axis], -1.0)),
            virial: self.virial.each_ref().map(|row| row.each_ref().map(|entry| fold(entry, 1.0))),
            births: fold(&self.births, 1.0),
            deaths: fold(&self.deaths, 1.0),
            net_at_face: faces.collect(),
        }
    }
}

/// The bins between two places, in widths of a bin, and the share of the path in each.
fn along(start: f64, end: f64, mut enter: impl FnMut(f64, f64)) {
    let [low, high] = if start <= end { [start, end] } else { [end, start] };
    let (first, last) = (low.floor(), high.floor());
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

fn number(bin: f64, bins: usize) -> usize {
    (bin as i64).rem_euclid(bins as i64) as usize
}
