//! Whether it is worth while to fit polarities, or their alignment: likelihoods of a few, about a fit without.

use super::look::Seen;
use super::place::{Place, RATIO, TIMES};
use crate::Error;

/// x and log σ_v²/σ_p² of polarities that are tried before any is fitted.
const HINTS_OF_TIMES: [f64; 2] = [0.05, 0.5];
const HINTS_OF_RATIO: [f64; 3] = [4.0, 2.0, 0.5];

/// J T that is tried before any is fitted, and by what x and what is new in an interval are multiplied there: what aligns is more noisy than what
/// it leaves.
const HINTS_OF_ALIGNMENT: [f64; 3] = [0.03, 0.1, 0.3];
const MORE_TIMES: [f64; 2] = [1.0, 3.0];
const MORE_NEWS: [f64; 3] = [1.0, 3.0, 9.0];

impl Seen<'_> {
    /// By how much −2 log L falls at most from no polarity to one of a few, or from none that aligns, at the present k.
    pub fn hint(&self) -> Result<f64, Error> {
        let (objective, equations) = (&self.objective, self.equations);
        if let Some(memory) = objective.memory.filter(|_| objective.states.polarities.align()) {
            let own = self.at(memory);
            // x and what is new in an interval, as multiples of those of polarities that do not align.
            let at = |(alignment, x, news): &(f64, f64, f64)| -> Result<f64, Error> {
                let times = (memory.times * x).clamp(TIMES[0], TIMES[1]);
                let place = Place { times, ratio: own.ratio * x / news, alignment: *alignment, ..own };
                Ok(self.likelihood(place)?.criterion)
            };
            let first = HINTS_OF_ALIGNMENT.map(|alignment| (alignment, 1.0, MORE_NEWS[1]));
            let mut values = equations.each(&[&[(0.0, 1.0, 1.0)], &first[..]].concat(), at)?;
            let best = (0..first.len()).min_by(|a, b| values[a + 1].total_cmp(&values[b + 1])).unwrap_or(0);
            let others = MORE_TIMES.iter().flat_map(|x| MORE_NEWS.map(|news| (first[best].0, *x, news)));
            let others: Vec<_> = others.filter(|own| *own != first[best]).collect();
            values.extend(equations.each(&others, at)?);
            return Ok(values[0] - values.iter().copied().fold(f64::INFINITY, f64::min));
        }
        let log_k = objective.levels.spring().ln();
        let at = |times: f64, ratio: f64| -> Result<f64, Error> {
            Ok(self.likelihood(Place { log_k, times, ratio: ratio.exp(), alignment: 0.0 })?.criterion)
        };
        let none = at(HINTS_OF_TIMES[0], RATIO[1])?;
        // The slower polarities are, the larger the ratio. Where faster ones are no likelier, still faster ones are less so.
        let falls = equations.each(&HINTS_OF_TIMES, |times| {
            let mut least = none;
            for ratio in HINTS_OF_RATIO {
                let next = at(*times, ratio)?;
                if next >= least {
                    break;
                }
                least = next;
            }
            Ok(none - least)
        })?;
        Ok(falls.into_iter().fold(0.0, f64::max))
    }
}
