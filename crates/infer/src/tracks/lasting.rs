//! Whether polarities last at all.
//!
//! What moves a cell at random in an interval also changes the forces on its way, which a polarity does and an error at the end of the interval
//! does not. So cells that are moved at random are explained better by polarities that are forgotten at once than by none, and a polarity
//! is one only if more speaks for its memory.

use super::likely::{RATIO, TIMES};
use super::memory::Memory;
use super::objective::MovieObjective;
use crate::normal_equations::NormalEquations;
use crate::{Error, KnownNoise};

/// By what the variance of displacements is divided where the memory is none, and by what k grows in its place.
const SHARES: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
const LOG_SPRINGS: [f64; 4] = [-0.7, 0.0, 0.7, 1.4];

impl MovieObjective<'_> {
    /// By how much −2 log L falls to the present polarities from those that are forgotten within an interval; at most as much as from none.
    pub(super) fn evidence_of_memory(
        &self,
        equations: &NormalEquations,
        components: f64,
        known: KnownNoise,
        memory: Memory,
    ) -> Result<f64, Error> {
        let own = self.levels.spring().ln();
        let ratio = (self.levels.velocity / memory.speed).powi(2);
        let at = |log_k: f64, times: f64, ratio: f64| -> Result<f64, Error> {
            let ratio = ratio.clamp(RATIO[0].exp(), RATIO[1].exp());
            Ok(self
                .likelihood(equations, components, known, [log_k, times, ratio, memory.alignment])?
                .criterion)
        };
        let with = at(own, memory.times, ratio)?;
        // The displacements of an interval, (u + u′)/2, are to vary as much.
        let alike = ratio / (1.0 + (-memory.times).exp());
        let given = known.position.is_some() && known.velocity.is_some();
        let tried: Vec<[f64; 2]> = SHARES
            .iter()
            .flat_map(|share| LOG_SPRINGS.map(|step| [if given { own } else { own + step }, alike * share]))
            .collect();
        let values = equations.each(&tried, |[log_k, ratio]| at(*log_k, TIMES[1], *ratio))?;
        let least = values.into_iter().fold(f64::INFINITY, f64::min);
        Ok((least - with).max(0.0))
    }
}
