//! Which noise levels and which memory of the polarities are likely, and how well they are known.

use super::look::{Look, Seen, Way};
use super::memory::Memory;
use super::surface::{CLOSE, Matrix, Point};
use crate::noise::{LARGEST_POSITION_NOISE, Likelihood, SMALLEST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE};
use crate::{Error, KnownNoise, NoiseLevels, NoiseSource};

/// x and log σ_v²/σ_p²: at least and at most.
pub(super) const TIMES: [f64; 2] = [1e-4, 20.0];
pub(super) const RATIO: [f64; 2] = [-9.0, 6.0];

/// The likelihood is a function of log (x + c): what lasts far longer than a movie is one and the same.
pub(super) const LASTING: f64 = 0.01;

/// J T: at least and at most; the likelihood is a function of log (J T + c).
const ALIGNMENT: [f64; 2] = [0.0, 5.0];
const SLOW: f64 = 0.02;

/// Spacings of log k, log (x + c), the log of the ratio and log (J T + c) at which the likelihood is looked at.
const SPACINGS: [f64; 4] = [1.0, 0.5, 1.0, 0.5];

/// Quantile of the normal distribution for intervals of 95 %, and the square of it.
pub(super) const QUANTILE: f64 = crate::NORMAL_95;
pub(super) const LESS_LIKELY: f64 = QUANTILE * QUANTILE;

/// A step that leads to less likely levels is made shorter by this factor, so many times; then none is taken.
const SHORTER: f64 = 0.3;
const SHORTENINGS: usize = 4;

/// A decrease of −2 log L that is none.
pub(super) const NO_GAIN: f64 = 0.01;

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

/// One so small that it needs no proof: a step well within a standard error.
const SMALL_GAIN: f64 = 0.3;

/// The surroundings of levels and memory, in units of the spacings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spaced {
    centre: [f64; 4],
    align: bool,
}

impl Spaced {
    fn about(log_k: f64, ratio: f64, memory: Memory, align: bool) -> Self {
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

/// Levels and memory of greatest likelihood near the present ones, and how well they are known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Likely {
    pub levels: NoiseLevels,
    pub memory: Memory,
    /// −2 log L there.
    pub criterion: f64,
    /// Covariance of log k, log (x + c), the log of the ratio and log (J T + c).
    pub covariance: Matrix,
    /// Derivatives of log σ_v² by these, and its variance at given ones.
    pub of_variance: (Point, f64),
}

/// Which of the unknowns are not to be found.
pub(super) fn held(known: &KnownNoise, align: bool) -> [bool; 4] {
    [known.source() == NoiseSource::Given, false, false, !align]
}

impl Seen<'_> {
    /// The present levels and memory.
    pub fn place(&self, memory: Memory) -> Place {
        Place {
            log_k: self.objective.levels.spring().ln(),
            times: memory.times,
            ratio: (self.objective.levels.velocity / memory.speed).powi(2),
            alignment: memory.alignment,
        }
    }

    /// The surroundings of the present levels and some memory.
    pub fn about(&self, memory: Memory) -> Spaced {
        let Place { log_k, ratio, .. } = self.place(memory);
        Spaced::about(log_k, ratio.ln(), memory, self.objective.states.polarities.align())
    }

    /// Whether both noise levels were given.
    pub fn is_given(&self) -> bool {
        self.known.source() == NoiseSource::Given
    }

    /// Noise levels and memory of greatest restricted likelihood near the present ones: one step of Newton's method.
    pub fn likely(&self, way: Way) -> Result<Likely, Error> {
        let known = self.known;
        let memory = self.objective.memory.unwrap_or(Memory::FIRST);
        let align = self.objective.states.polarities.align();
        let spaced = self.about(memory);
        let look = self.look(&spaced, way)?;
        let held = held(&known, align);
        let step = look.criterion.newton(held);
        let (step, Likelihood { criterion, variance }) = self.stepped(&spaced, &look, step)?;
        let Place { log_k, times, ratio, alignment } = spaced.at(step);
        let velocity = known.velocity.unwrap_or(variance.sqrt()).max(SMALLEST_VELOCITY_NOISE);
        let position = known.position.unwrap_or_else(|| {
            (velocity / (0.5 * log_k).exp()).clamp(SMALLEST_POSITION_NOISE, LARGEST_POSITION_NOISE)
        });
        let scales = Matrix::from_diagonal(&Point::from(SPACINGS));
        let slope = match known.velocity {
            Some(_) => Point::zeros(),
            None => Point::from_fn(|k, _| look.log_variance[k] / SPACINGS[k]),
        };
        Ok(Likely {
            levels: NoiseLevels { position, velocity },
            memory: Memory { times, speed: velocity / ratio.sqrt(), alignment, ..memory },
            criterion,
            covariance: scales * look.criterion.covariance(held) * scales,
            of_variance: (slope, 2.0 / self.components),
        })
    }

    /// A step, made shorter as long as it leads to less likely levels, with the likelihood at its end; none where it would hardly
    /// lead to likelier ones.
    fn stepped(&self, spaced: &Spaced, look: &Look, mut step: Point) -> Result<(Point, Likelihood), Error> {
        let gain = -0.5 * look.criterion.slope.dot(&step);
        if gain < NO_GAIN {
            return Ok((Point::zeros(), look.here));
        }
        if gain < SMALL_GAIN {
            let log_variance = look.here.variance.ln() + look.log_variance.dot(&step);
            let there = Likelihood { criterion: look.here.criterion - gain, variance: log_variance.exp() };
            return Ok((step, there));
        }
        let mut reached = self.likelihood(spaced.at(step))?;
        for shorter in 1..=SHORTENINGS {
            if reached.criterion <= look.here.criterion {
                break;
            }
            step *= if shorter == SHORTENINGS { 0.0 } else { SHORTER };
            reached = self.likelihood(spaced.at(step))?;
        }
        Ok((step, reached))
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
