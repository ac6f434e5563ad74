//! Noise levels and memory of the polarities as unknowns of a likelihood, and how far apart it is looked at.

use super::memory::Memory;
use super::surface::{CLOSE, Point};

/// x and log σ_v²/σ_p²: at least and at most.
pub(super) const TIMES: [f64; 2] = [1e-4, 20.0];
pub(super) const RATIO: [f64; 2] = [-9.0, 6.0];

/// The likelihood is a function of log (x + c): what lasts far longer than a movie is one and the same.
pub(super) const LASTING: f64 = 0.01;

/// J T: at least and at most; the likelihood is a function of log (J T + c).
const ALIGNMENT: [f64; 2] = [0.0, 5.0];
const SLOW: f64 = 0.02;

/// Spacings of log k, log (x + c), the log of the ratio and log (J T + c) at which the likelihood is looked at.
pub(super) const SPACINGS: [f64; 4] = [1.0, 0.5, 1.0, 0.5];

/// Noise levels and memory, as the likelihood is a function of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub log_k: f64,
    /// x
    pub times: f64,
    /// σ_v²/σ_p²
    pub ratio: f64,
    /// J T
    pub alignment: f64,
}

/// The surroundings of levels and memory, in units of the spacings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spaced {
    centre: [f64; 4],
    align: bool,
}

impl Spaced {
    pub(super) fn about(log_k: f64, ratio: f64, memory: Memory, align: bool) -> Self {
        let within =
            |value: f64, [least, most]: [f64; 2], spacing: f64| value.clamp(least + spacing, most - spacing);
        let centre = [
            log_k,
            within(of_times(memory.times), TIMES.map(of_times), SPACINGS[1]),
            within(ratio, RATIO, SPACINGS[2]),
            within(of_alignment(memory.alignment), ALIGNMENT.map(of_alignment), CLOSE * SPACINGS[3]),
        ];
        Self { centre, align }
    }

    /// The derivative of log k by the unknowns.
    pub fn of_log_k() -> Point {
        Point::new(SPACINGS[0], 0.0, 0.0, 0.0)
    }

    /// So far from there.
    pub fn at(&self, point: Point) -> Place {
        let [log_k, times, ratio, alignment] = [0, 1, 2, 3].map(|k| self.centre[k] + point[k] * SPACINGS[k]);
        Place {
            log_k,
            times: times_of(times),
            ratio: ratio.clamp(RATIO[0], RATIO[1]).exp(),
            alignment: if self.align { alignment_of(alignment) } else { 0.0 },
        }
    }
}

/// What stands for x in the likelihood.
pub(super) fn of_times(x: f64) -> f64 {
    (x + LASTING).ln()
}

/// x for what stands for it.
pub(super) fn times_of(log: f64) -> f64 {
    (log.exp() - LASTING).clamp(TIMES[0], TIMES[1])
}

/// What stands for J T in the likelihood.
pub(super) fn of_alignment(alignment: f64) -> f64 {
    (alignment + SLOW).ln()
}

/// J T for what stands for it.
pub(super) fn alignment_of(log: f64) -> f64 {
    (log.exp() - SLOW).clamp(ALIGNMENT[0], ALIGNMENT[1])
}
