//! Which noise levels and which memory of the polarities are likely, and how well they are known.

use super::driven::Drive;
use super::memory::{Memory, NONE};
use super::objective::MovieObjective;
use super::states::States;
use super::surface::{CLOSE, ENOUGH, Matrix, POINTS, Point, Surface};
use crate::noise::{
    LARGEST_POSITION_NOISE, Likelihood, Restricted, SMALLEST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE,
};
use crate::normal_equations::NormalEquations;
use crate::{Error, KnownNoise, NoiseLevels};
use voronudge_geometry::Vector;

/// x and log σ_v²/σ_p²: at least and at most.
pub(super) const TIMES: [f64; 2] = [1e-4, 20.0];
pub(super) const RATIO: [f64; 2] = [-9.0, 6.0];

/// The likelihood is a function of log (x + c): what lasts far longer than a movie is one and the same.
const LASTING: f64 = 0.01;

/// J T: at least and at most; the likelihood is a function of log (J T + c).
const ALIGNMENT: [f64; 2] = [0.0, 5.0];
const SLOW: f64 = 0.02;

/// Spacings of log k, log (x + c), the log of the ratio and log (J T + c) at which the likelihood is looked at.
const SPACINGS: [f64; 4] = [1.0, 0.5, 1.0, 0.5];

/// Quantile of the normal distribution for intervals of 95 %, and the square of it.
pub(super) const QUANTILE: f64 = 1.959_963_984_540_054;
pub(super) const LESS_LIKELY: f64 = QUANTILE * QUANTILE;

/// Half the width of an interval of log v₀ from which on its ends are looked for one by one; in how many steps.
const BROAD: f64 = 0.5;
const BISECTIONS: usize = 8;

/// Steps in log k towards the noise levels of cells that do not crawl, and how many are looked at.
const STEP_OF_K: f64 = 0.7;
const FURTHER: u32 = 11;

/// Steps towards the likeliest noise levels and memory of cells that do not align.
const ROUNDS_WITHOUT: usize = 5;

/// A step that leads to less likely levels is made shorter by this factor, so many times; then none is taken.
const SHORTER: f64 = 0.3;
const SHORTENINGS: usize = 4;

/// Step in log (x + c) for a derivative.
const STEP: f64 = 0.01;

/// Polarity of the cells of a movie, in the units of the movie.
#[derive(Debug, Clone, PartialEq)]
pub struct Polarity {
    /// Speed v₀: the root mean square of the polarity.
    pub speed: f64,
    /// Its 95 % interval.
    pub speed_interval: [f64; 2],
    /// Rate D_r = 1/τ at which the polarity is forgotten.
    pub rate: f64,
    /// Its 95 % interval; `None` if the data do not show that there is a polarity.
    pub rate_interval: Option<[f64; 2]>,
    /// Correlation of the mean polarity of an interval with that of the next.
    pub correlation: f64,
    /// How cells align, if that was asked for.
    pub alignment: Option<Alignment>,
    /// How they turn away from contacts, and towards the velocity that the model gives, if that was asked for.
    pub contact_inhibition: Option<Drive>,
    /// See there.
    pub velocity_alignment: Option<Drive>,
    /// By how much −2 log L, restricted, falls to this one from what is forgotten within an interval.
    pub evidence_of_memory: f64,
    /// By how much −2 log L, restricted, falls from none to this one: at most χ² with two degrees of freedom if there is none.
    pub evidence: f64,
}

/// How the polarities of neighbours align, in the units of the movie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// J, at which a cell with six neighbours takes on their mean polarity.
    pub rate: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
    /// By how much −2 log L, restricted, falls from none to this one.
    pub evidence: f64,
}

/// What stands for x in the likelihood.
fn of_times(x: f64) -> f64 {
    (x + LASTING).ln()
}

/// Levels and memory of greatest likelihood near the present ones, and how well they are known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Likely {
    pub levels: NoiseLevels,
    pub memory: Memory,
    /// −2 log L there.
    criterion: f64,
    /// Covariance of log k, log (x + c), the log of the ratio and log (J T + c).
    covariance: Matrix,
    /// Derivatives of log σ_v² by these, and its variance at given ones.
    of_variance: (Point, f64),
    /// For the next round.
    pub looked: Looked,
}

/// −2 log of the likelihood and log σ_v² about a point, in units of the spacings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Looked {
    at: Point,
    criterion: Surface,
    log_variance: Surface,
}

impl MovieObjective<'_> {
    /// Noise levels and memory of greatest restricted likelihood near the present ones: one step of Newton's method on points around them,
    /// with second derivatives as they were if these are given.
    pub(super) fn likely(
        &self,
        equations: &NormalEquations,
        components: f64,
        known: KnownNoise,
        earlier: Option<Looked>,
    ) -> Result<Likely, Error> {
        let memory = self.memory.unwrap_or(Memory::FIRST);
        let ratio = 2.0 * (self.levels.velocity / memory.speed).ln();
        let within =
            |value: f64, [least, most]: [f64; 2], spacing: f64| value.clamp(least + spacing, most - spacing);
        let centre = [
            self.levels.spring().ln(),
            within(of_times(memory.times), TIMES.map(of_times), SPACINGS[1]),
            within(ratio, RATIO, SPACINGS[2]),
            within(of_alignment(memory.alignment), ALIGNMENT.map(of_alignment), 0.0),
        ];
        let align = self.states.polarities.align();
        let at = |point: [f64; 4]| {
            let [log_k, times, ratio, alignment] = [0, 1, 2, 3].map(|k| centre[k] + point[k] * SPACINGS[k]);
            let alignment = if align { alignment_of(alignment) } else { 0.0 };
            [log_k, times_of(times), ratio.clamp(RATIO[0], RATIO[1]).exp(), alignment]
        };
        let points: Vec<Point> = match earlier {
            None => POINTS.iter().map(|point| (*point).into()).collect(),
            Some(_) => POINTS[..ENOUGH].iter().map(|point| Point::from(*point) * CLOSE).collect(),
        };
        // Points that differ in an alignment alone that is none are one.
        let own = |point: &Point| if align { *point } else { Point::new(point[0], point[1], point[2], 0.0) };
        let first = |point: &Point| points.iter().position(|other| *other == own(point)).unwrap_or(0);
        let needed: Vec<usize> = (0..points.len()).filter(|k| first(&points[*k]) == *k).collect();
        let found = equations
            .each(&needed, |k| self.likelihood(equations, components, known, at(points[*k].into())))?;
        let value = |point: &Point| found[needed.binary_search(&first(point)).unwrap_or(0)];
        let values: Vec<Likelihood> = points.iter().map(value).collect();
        let at_centre = Point::from_fn(|k, _| centre[k] / SPACINGS[k]);
        let criteria: Vec<f64> = values.iter().map(|own| own.criterion).collect();
        let variances: Vec<f64> = values.iter().map(|own| own.variance.ln()).collect();
        let (criterion, log_variance) = match earlier {
            None => (Surface::new(&criteria), Surface::new(&variances)),
            Some(Looked { at, criterion, log_variance }) => (
                Surface::again(&criteria, criterion.bend).updated(&criterion, at_centre - at),
                Surface::again(&variances, log_variance.bend),
            ),
        };
        let held = [known.position.is_some() && known.velocity.is_some(), false, false, !align];
        let mut step = criterion.newton(held);
        let mut reached = self.likelihood(equations, components, known, at(step.into()))?;
        for shorter in 1..=SHORTENINGS {
            if reached.criterion <= values[0].criterion {
                break;
            }
            step *= if shorter == SHORTENINGS { 0.0 } else { SHORTER };
            reached = self.likelihood(equations, components, known, at(step.into()))?;
        }
        let [log_k, times, ratio, alignment] = at(step.into());
        let velocity = known.velocity.unwrap_or(reached.variance.sqrt()).max(SMALLEST_VELOCITY_NOISE);
        let position = known.position.unwrap_or_else(|| {
            (velocity / (0.5 * log_k).exp()).clamp(SMALLEST_POSITION_NOISE, LARGEST_POSITION_NOISE)
        });
        let found = Memory { times, speed: velocity / ratio.sqrt(), alignment, ..memory };
        let scales = Matrix::from_diagonal(&Point::from(SPACINGS));
        let slope =
            Point::from_fn(
                |k, _| {
                    if known.velocity.is_some() { 0.0 } else { log_variance.slope[k] / SPACINGS[k] }
                },
            );
        let likely = Likely {
            levels: NoiseLevels { position, velocity },
            memory: found,
            criterion: reached.criterion,
            covariance: scales * criterion.covariance(held) * scales,
            of_variance: (slope, 2.0 / components),
            looked: Looked { at: at_centre, criterion, log_variance },
        };
        Ok(likely)
    }

    /// The likelihood at some log k, x, σ_v²/σ_p² and J T.
    pub(super) fn likelihood(
        &self,
        equations: &NormalEquations,
        components: f64,
        known: KnownNoise,
        [log_k, times, ratio, alignment]: [f64; 4],
    ) -> Result<Likelihood, Error> {
        let speed = self.levels.velocity / ratio.sqrt();
        let memory = Memory { times, speed, alignment, ..self.memory.unwrap_or(Memory::FIRST) };
        let objective = MovieObjective { memory: Some(memory), ..*self };
        let held = objective.held();
        let own = Restricted { equations, components, known, held: Some(&held) }.likelihood(log_k)?;
        let of_lengths = ratio / self.movie.interval().powi(2);
        let determinant = self.states.polarities.log_determinant(memory, of_lengths)?;
        Ok(Likelihood { criterion: own.criterion - determinant, ..own })
    }

    /// The polarities of the cells of each frame, as velocities; empty where cells do not crawl.
    pub(super) fn polarities(&self, displacements: &[f64]) -> Vec<Vec<Option<Vector<f64>>>> {
        let of_cell = |block: &u32| {
            (*block != NONE).then(|| States::vector(displacements, *block as usize) / self.movie.interval())
        };
        let of_frame = |frame: usize| {
            let blocks = self.states.polarities.block.get(frame);
            blocks.into_iter().flatten().map(of_cell).collect()
        };
        (0..self.movie.frames()).map(of_frame).collect()
    }

    /// The polarity of the cells at a fit, about which the problem is linearised.
    pub(super) fn polarity(
        &self,
        equations: &NormalEquations,
        components: f64,
        known: KnownNoise,
        displacements: &[f64],
    ) -> Result<Option<Polarity>, Error> {
        let Some(memory) = self.memory else { return Ok(None) };
        let Likely { covariance, of_variance: (of_variance, further), .. } =
            self.likely(equations, components, known, None)?;
        let interval = self.movie.interval();
        let root_mean_square = |memory: Memory| -> Result<f64, Error> {
            Ok(memory.root_mean_square() * self.states.polarities.mean_variance(memory)?.sqrt())
        };
        let own = root_mean_square(memory)?;
        let log_times = of_times(memory.times);
        let longer = Memory { times: times_of(log_times + STEP), ..memory };
        let mut slope = 0.5 * of_variance;
        slope[1] += (root_mean_square(longer)? / own).ln() / STEP;
        slope[2] -= 0.5;
        if self.states.polarities.align() {
            let aligned = Memory { alignment: alignment_of(of_alignment(memory.alignment) + STEP), ..memory };
            slope[3] += (root_mean_square(aligned)? / own).ln() / STEP;
        }
        let spread = QUANTILE * (slope.dot(&(covariance * slope)) + 0.25 * further).max(0.0).sqrt();
        let speed_interval = match spread < BROAD {
            true => [own * (-spread).exp(), own * spread.exp()],
            false => self.slowest_and_fastest(equations, components, known, memory)?.map(|share| own * share),
        };
        let evidence = self.evidence(equations, components, known, memory)?;
        let error = QUANTILE * covariance[(1, 1)].max(0.0).sqrt();
        let [contact_inhibition, velocity_alignment] =
            self.drives_found(equations, self.drives(displacements))?;
        let [slowest, fastest] = [-error, error].map(|aside| (log_times + aside).exp() - LASTING);
        Ok(Some(Polarity {
            speed: own,
            speed_interval,
            rate: memory.times / interval,
            rate_interval: (speed_interval[0] > 0.0)
                .then(|| [slowest.max(0.0) / interval, fastest.min(TIMES[1]) / interval]),
            correlation: memory.correlation(),
            alignment: self.alignment(equations, components, known, covariance[(3, 3)])?,
            contact_inhibition,
            velocity_alignment,
            evidence_of_memory: self.evidence_of_memory(equations, components, known, memory)?.min(evidence),
            evidence,
        }))
    }

    /// How the cells align at a fit, with the variance of log (J T + c).
    fn alignment(
        &self,
        equations: &NormalEquations,
        components: f64,
        known: KnownNoise,
        variance: f64,
    ) -> Result<Option<Alignment>, Error> {
        let Some(memory) = self.memory.filter(|_| self.states.polarities.align()) else { return Ok(None) };
        let interval = self.movie.interval();
        let point = [
            self.levels.spring().ln(),
            memory.times,
            (self.levels.velocity / memory.speed).powi(2),
            memory.alignment,
        ];
        let with = self.likelihood(equations, components, known, point)?.criterion;
        // The likeliest of cells that do not align.
        let apart = self.states.clone().apart();
        let mut without =
            MovieObjective { states: &apart, memory: Some(Memory { alignment: 0.0, ..memory }), ..*self };
        let (mut looked, mut least) = (None, f64::INFINITY);
        for _ in 0..ROUNDS_WITHOUT {
            let likely = without.likely(equations, components, known, looked)?;
            looked = Some(likely.looked);
            least = least.min(likely.criterion);
            without = MovieObjective { levels: likely.levels, memory: Some(likely.memory), ..without };
        }
        let error = QUANTILE * variance.max(0.0).sqrt();
        let log = of_alignment(memory.alignment);
        Ok(Some(Alignment {
            rate: memory.alignment / interval,
            interval: [-error, error].map(|aside| alignment_of(log + aside) / interval),
            evidence: (least - with).max(0.0),
        }))
    }

    /// By how much −2 log L falls from no polarity at all, with the noise levels that are then likeliest, to the present one.
    fn evidence(
        &self,
        equations: &NormalEquations,
        components: f64,
        known: KnownNoise,
        memory: Memory,
    ) -> Result<f64, Error> {
        let at = |log_k: f64, ratio: f64| -> Result<f64, Error> {
            Ok(self
                .likelihood(
                    equations,
                    components,
                    known,
                    [log_k, memory.times, ratio.exp(), memory.alignment],
                )?
                .criterion)
        };
        let own = self.levels.spring().ln();
        let with = at(own, 2.0 * (self.levels.velocity / memory.speed).ln())?;
        let given = known.position.is_some() && known.velocity.is_some();
        // What moved the cells by themselves is then an error of the dynamics: k grows.
        let further = if given { 0 } else { FURTHER };
        let points: Vec<f64> = (0..=further).map(|steps| own + f64::from(steps) * STEP_OF_K).collect();
        let values = equations.each(&points, |log_k| at(*log_k, RATIO[1]))?;
        let least = (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
        let mut without = values[least];
        let before = least.checked_sub(1).and_then(|k| values.get(k));
        if let Some((before, after)) = before.zip(values.get(least + 1))
            && before + after > 2.0 * without
        {
            let aside = 0.5 * (before - after) / (before + after - 2.0 * without);
            without = without.min(at(points[least] + aside * STEP_OF_K, RATIO[1])?);
        }
        Ok((without - with).max(0.0))
    }

    /// Between which multiples of v₀ the likelihood falls by less than an interval of 95 % allows, k and memory held.
    fn slowest_and_fastest(
        &self,
        equations: &NormalEquations,
        components: f64,
        known: KnownNoise,
        memory: Memory,
    ) -> Result<[f64; 2], Error> {
        let own = 2.0 * (self.levels.velocity / memory.speed).ln();
        // −2 log L and the multiple of v₀ at some log σ_v²/σ_p².
        let at = |ratio: f64| -> Result<(f64, f64), Error> {
            let point = [self.levels.spring().ln(), memory.times, ratio.exp(), memory.alignment];
            let Likelihood { criterion, variance } = self.likelihood(equations, components, known, point)?;
            Ok((criterion, (variance / ratio.exp()).sqrt() / memory.speed))
        };
        let least = at(own)?.0;
        let none = at(RATIO[1])?.0 - least < LESS_LIKELY;
        let mut ends = [1.0; 2];
        for (share, mut outside) in ends.iter_mut().zip([RATIO[1], RATIO[0]]) {
            let mut inside = own;
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (inside + outside);
                let (criterion, multiple) = at(middle)?;
                *share = multiple;
                if criterion - least < LESS_LIKELY { inside = middle } else { outside = middle }
            }
        }
        Ok([if none { 0.0 } else { ends[0].min(1.0) }, ends[1].max(1.0)])
    }
}

/// x for what stands for it.
fn times_of(log: f64) -> f64 {
    (log.exp() - LASTING).clamp(TIMES[0], TIMES[1])
}

/// What stands for J T in the likelihood.
fn of_alignment(alignment: f64) -> f64 {
    (alignment + SLOW).ln()
}

/// J T for what stands for it.
fn alignment_of(log: f64) -> f64 {
    (log.exp() - SLOW).clamp(ALIGNMENT[0], ALIGNMENT[1])
}
