//! Whether polarities last at all.
//!
//! What moves a cell at random in an interval also changes the forces on its way, which a polarity does and an error at the end of the interval
//! does not. So cells that are moved at random are explained better by polarities that are forgotten at once than by none, and a polarity
//! is one only if more speaks for its memory.

use super::place::{Place, RATIO, TIMES};
use super::polarity::Fitted;
use crate::Error;

/// By what the variance of displacements is divided where the memory is none, and by what k grows in its place.
const SHARES: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
const LOG_SPRINGS: [f64; 4] = [0.0, 0.7, 1.4, -0.7];

impl Fitted<'_> {
    /// By how much −2 log L falls to the present polarities from those that are forgotten within an interval; at most as much as from none.
    /// Their share is looked for first, then k, then the share once more.
    pub fn evidence_of_memory(&self) -> Result<f64, Error> {
        let Self { seen, memory, .. } = self;
        let own = seen.at(*memory);
        // The displacements of an interval, (u + u′)/2, are to vary as much.
        let alike = own.ratio / (1.0 + (-memory.times).exp());
        let at = |(share, spring): &(usize, usize)| -> Result<f64, Error> {
            let ratio = (alike * SHARES[*share]).clamp(RATIO[0].exp(), RATIO[1].exp());
            let log_k = own.log_k + LOG_SPRINGS[*spring];
            Ok(seen.likelihood(Place { log_k, times: TIMES[1], ratio, ..own })?.criterion)
        };
        let mut least = (f64::INFINITY, (0, 0));
        let mut look = |points: Vec<(usize, usize)>| -> Result<(usize, usize), Error> {
            let values = seen.equations.each(&points, at)?;
            let found = values.into_iter().zip(points);
            least = found.fold(least, |least, own| if own.0 < least.0 { own } else { least });
            Ok(least.1)
        };
        let (share, _) = look((0..SHARES.len()).map(|share| (share, 0)).collect())?;
        if !seen.is_given() {
            let (_, spring) = look((1..LOG_SPRINGS.len()).map(|spring| (share, spring)).collect())?;
            if spring > 0 {
                let beside = [share.wrapping_sub(1), share + 1].into_iter().filter(|own| *own < SHARES.len());
                look(beside.map(|own| (own, spring)).collect())?;
            }
        }
        Ok((least.0 - self.criterion).max(0.0))
    }
}
