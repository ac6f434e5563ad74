//! Which noise levels and which memory of the polarities are likely, and how well they are known.

use super::look::{Look, Seen, Way};
use super::memory::Memory;
use super::place::{Place, SPACINGS, Spaced};
use super::surface::{FURTHEST, Matrix, Point};
use crate::noise::{LARGEST_POSITION_NOISE, SMALLEST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE};
use crate::restricted::Likelihood;
use crate::{Error, KnownNoise, NoiseLevels, NoiseSource};

/// Quantile of the normal distribution for intervals of 95 %, and the square of it.
pub(super) const QUANTILE: f64 = crate::NORMAL_95;
pub(super) const LESS_LIKELY: f64 = QUANTILE * QUANTILE;

/// How far beyond a parabola's least likelihood levels may go at most, in steps to there.
const FURTHER: f64 = 3.0;

/// A step that leads to less likely levels is made shorter by this factor, so many times; then none is taken.
const SHORTER: f64 = 0.3;
const SHORTENINGS: usize = 4;

/// A decrease of −2 log L that is none.
pub(super) const NO_GAIN: f64 = 0.01;

/// One so small that it needs no proof: a step well within a standard error.
const SMALL_GAIN: f64 = 0.3;

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
    pub fn at(&self, memory: Memory) -> Place {
        Place {
            log_k: self.objective.levels.spring().ln(),
            times: memory.times,
            ratio: (self.objective.levels.velocity / memory.speed).powi(2),
            alignment: memory.alignment,
        }
    }

    /// The surroundings of the present levels and some memory.
    pub fn about(&self, memory: Memory) -> Spaced {
        let Place { log_k, ratio, .. } = self.at(memory);
        Spaced::about(log_k, ratio.ln(), memory, self.objective.states.polarities.align())
    }

    /// The surroundings of some log k where cells do not crawl.
    pub fn about_spring(&self, log_k: f64) -> Spaced {
        let memory = Memory::FIRST;
        Spaced::about(log_k, self.at(memory).ratio.ln(), memory, false)
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
        let levels = self.levels(log_k, variance);
        let scales = Matrix::from_diagonal(&Point::from(SPACINGS));
        let slope = match known.velocity {
            Some(_) => Point::zeros(),
            None => Point::from_fn(|k, _| look.log_variance[k] / SPACINGS[k]),
        };
        Ok(Likely {
            levels,
            memory: Memory { times, speed: levels.velocity / ratio.sqrt(), alignment, ..memory },
            criterion,
            covariance: scales * look.criterion.covariance(held) * scales,
            of_variance: (slope, 2.0 / self.components),
        })
    }

    /// One step towards the most likely noise levels where cells do not crawl: to the least of the parabola that the likelihood is about the present
    /// log k. Towards stiff springs the likelihood can go on rising, ever more slowly, and each parabola ends as far on as the last: by the step
    /// before, which is replaced, the sum of those to come is foreseen (Aitken's process).
    pub fn towards(&self, way: Way, earlier: &mut Option<f64>) -> Result<NoiseLevels, Error> {
        if let KnownNoise { position: Some(position), velocity: Some(velocity) } = self.known {
            return Ok(NoiseLevels { position, velocity });
        }
        let spaced = self.about_spring(self.objective.levels.spring().ln());
        let look = self.look(&spaced, way)?;
        let (slope, bend) = (look.criterion.slope[0], look.criterion.bend[(0, 0)]);
        let step = match bend > 0.0 {
            true => (-slope / bend).clamp(-FURTHEST, FURTHEST),
            false => -FURTHEST.copysign(slope),
        };
        let step = if -0.5 * slope * step < NO_GAIN { 0.0 } else { step };
        let ratio = match earlier.replace(step) {
            Some(earlier) if earlier > 0.0 && step > 0.0 => step / earlier,
            _ => 0.0,
        };
        let step = step / (1.0 - ratio).max(1.0 / FURTHER);
        let variance = look.here.variance * (look.log_variance[0] * step).exp();
        Ok(self.levels(spaced.at(Point::x() * step).log_k, variance))
    }

    /// What levels belong to k and σ_v², where they are not known.
    fn levels(&self, log_k: f64, variance: f64) -> NoiseLevels {
        let KnownNoise { position, velocity } = self.known;
        let velocity = velocity.unwrap_or(variance.sqrt()).max(SMALLEST_VELOCITY_NOISE);
        let position = position.unwrap_or_else(|| {
            (velocity / (0.5 * log_k).exp()).clamp(SMALLEST_POSITION_NOISE, LARGEST_POSITION_NOISE)
        });
        NoiseLevels { position, velocity }
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
