//! The polarity of cells at a fit, its intervals and what speaks for it.

use super::driven::Drive;
use super::likely::{LESS_LIKELY, Likely, NO_GAIN, QUANTILE};
use super::look::{Seen, Way};
use super::memory::Memory;
use super::objective::MovieObjective;
use super::place::{LASTING, Place, RATIO, TIMES, alignment_of, of_alignment, of_times, times_of};
use super::polarities::NONE;
use super::states::States;
use crate::Error;
use voronudge_geometry::Vector;

/// Half the width of an interval of log v₀ from which on its ends are looked for one by one; in how many steps.
const BROAD: f64 = 0.5;
const BISECTIONS: usize = 8;

/// Steps in log k towards the noise levels of cells that do not crawl, and how many are looked at.
const STEP_OF_K: f64 = 0.7;
const FURTHER: u32 = 11;

/// As many at once, until the likeliest is among them.
const AT_ONCE: usize = 4;

/// Steps towards the likeliest noise levels and memory of cells that do not align, at most.
const ROUNDS_WITHOUT: usize = 5;

/// Draws for these steps.
const DRAWS: usize = 32;

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
    /// What v₀ would be without it, the noise being the same.
    pub speed_apart: f64,
    /// By how much −2 log L, restricted, falls from none to this one.
    pub evidence: f64,
}

impl MovieObjective<'_> {
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
}

impl Seen<'_> {
    /// The polarity of the cells at a fit, about which the problem is linearised.
    pub fn polarity(&self, displacements: &[f64]) -> Result<Option<Polarity>, Error> {
        let objective = &self.objective;
        let Some(memory) = objective.memory else { return Ok(None) };
        let Likely { covariance, of_variance: (of_variance, further), .. } = self.likely(Way::Points)?;
        let interval = objective.movie.interval();
        let root_mean_square = |memory: Memory| -> Result<f64, Error> {
            Ok(memory.root_mean_square() * objective.states.polarities.mean_variance(memory)?.sqrt())
        };
        let own = root_mean_square(memory)?;
        let log_times = of_times(memory.times);
        let longer = Memory { times: times_of(log_times + STEP), ..memory };
        let mut slope = 0.5 * of_variance;
        slope[1] += (root_mean_square(longer)? / own).ln() / STEP;
        slope[2] -= 0.5;
        if objective.states.polarities.align() {
            let aligned = Memory { alignment: alignment_of(of_alignment(memory.alignment) + STEP), ..memory };
            slope[3] += (root_mean_square(aligned)? / own).ln() / STEP;
        }
        let fitted = Fitted { seen: self, memory, criterion: self.likelihood(self.at(memory))?.criterion };
        let spread = QUANTILE * (slope.dot(&(covariance * slope)) + 0.25 * further).max(0.0).sqrt();
        let speed_interval = match spread < BROAD {
            true => [own * (-spread).exp(), own * spread.exp()],
            false => fitted.slowest_and_fastest()?.map(|share| own * share),
        };
        let evidence = fitted.evidence()?;
        let error = QUANTILE * covariance[(1, 1)].max(0.0).sqrt();
        let [contact_inhibition, velocity_alignment] =
            objective.drives_found(self.equations, objective.drives(displacements))?;
        let [slowest, fastest] = [-error, error].map(|aside| (log_times + aside).exp() - LASTING);
        let polarity = Polarity {
            speed: own,
            speed_interval,
            rate: memory.times / interval,
            rate_interval: (speed_interval[0] > 0.0)
                .then(|| [slowest.max(0.0) / interval, fastest.min(TIMES[1]) / interval]),
            correlation: memory.correlation(),
            alignment: fitted.alignment(covariance[(3, 3)])?,
            contact_inhibition,
            velocity_alignment,
            evidence_of_memory: fitted.evidence_of_memory()?.min(evidence),
            evidence,
        };
        Ok(Some(polarity))
    }
}

/// A fit of cells that crawl, to be compared with others of which the problem is linearised at the same point.
pub(super) struct Fitted<'a> {
    pub seen: &'a Seen<'a>,
    pub memory: Memory,
    /// −2 log L
    pub criterion: f64,
}

impl Fitted<'_> {
    /// How the cells align, with the variance of log (J T + c).
    fn alignment(&self, variance: f64) -> Result<Option<Alignment>, Error> {
        let Self { seen, memory, criterion } = *self;
        let objective = &seen.objective;
        if !objective.states.polarities.align() {
            return Ok(None);
        }
        let interval = objective.movie.interval();
        // The likeliest of cells that do not align.
        let apart = objective.states.clone().apart();
        let mut without = MovieObjective {
            states: &apart,
            memory: Some(Memory { alignment: 0.0, ..memory }),
            ..*objective
        };
        let mut least = f64::INFINITY;
        for _ in 0..ROUNDS_WITHOUT {
            let likely = Seen { objective: without, ..*seen }.likely(Way::Draws(DRAWS))?;
            let before = least;
            least = least.min(likely.criterion);
            if before - least < NO_GAIN {
                break;
            }
            without = MovieObjective { levels: likely.levels, memory: Some(likely.memory), ..without };
        }
        let error = QUANTILE * variance.max(0.0).sqrt();
        let log = of_alignment(memory.alignment);
        Ok(Some(Alignment {
            rate: memory.alignment / interval,
            interval: [-error, error].map(|aside| alignment_of(log + aside) / interval),
            speed_apart: memory.root_mean_square(),
            evidence: (least - criterion).max(0.0),
        }))
    }

    /// By how much −2 log L falls from no polarity at all, with the noise levels that are then likeliest, to the present one.
    fn evidence(&self) -> Result<f64, Error> {
        let own = self.seen.at(self.memory);
        let at = |log_k: f64| -> Result<f64, Error> {
            Ok(self.seen.likelihood(Place { log_k, ratio: RATIO[1].exp(), ..own })?.criterion)
        };
        // What moved the cells by themselves is then an error of the dynamics: k grows.
        let further = if self.seen.is_given() { 0 } else { FURTHER };
        let points: Vec<f64> = (0..=further).map(|steps| own.log_k + f64::from(steps) * STEP_OF_K).collect();
        let (mut values, mut least) = (Vec::new(), 0);
        for some in points.chunks(AT_ONCE) {
            values.extend(self.seen.equations.each(some, |log_k| at(*log_k))?);
            least = (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
            if least + 1 < values.len() {
                break;
            }
        }
        let mut without = values[least];
        let before = least.checked_sub(1).and_then(|k| values.get(k));
        if let Some((before, after)) = before.zip(values.get(least + 1))
            && before + after > 2.0 * without
        {
            let aside = 0.5 * (before - after) / (before + after - 2.0 * without);
            without = without.min(at(points[least] + aside * STEP_OF_K)?);
        }
        let evidence = without - self.criterion;
        Ok(if evidence < NO_GAIN { 0.0 } else { evidence })
    }

    /// Between which multiples of v₀ the likelihood falls by less than an interval of 95 % allows, k and memory held.
    fn slowest_and_fastest(&self) -> Result<[f64; 2], Error> {
        let place = self.seen.at(self.memory);
        let own = place.ratio.ln();
        // −2 log L and the multiple of v₀ at some log σ_v²/σ_p².
        let at = |ratio: f64| -> Result<(f64, f64), Error> {
            let own = self.seen.likelihood(Place { ratio: ratio.exp(), ..place })?;
            Ok((own.criterion, (own.variance / ratio.exp()).sqrt() / self.memory.speed))
        };
        let none = at(RATIO[1])?.0 - self.criterion < LESS_LIKELY;
        let mut ends = [1.0; 2];
        for (share, mut outside) in ends.iter_mut().zip([RATIO[1], RATIO[0]]) {
            let mut inside = own;
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (inside + outside);
                let (criterion, multiple) = at(middle)?;
                *share = multiple;
                if criterion - self.criterion < LESS_LIKELY { inside = middle } else { outside = middle }
            }
        }
        Ok([if none { 0.0 } else { ends[0].min(1.0) }, ends[1].max(1.0)])
    }
}
