//! The mean of a correlated series and its standard error.

use serde::{Deserialize, Serialize};

/// The mean of a correlated series with a standard error by blocking (Flyvbjerg and Petersen 1989).
///
/// Averages of blocks of 1, 2, 4, 8 … values are followed at once. The naive standard error `√(s²/n)` of the blocks grows
/// with their length until they are longer than the correlation, and then stays. [`BlockAverage::standard_error`] is the
/// largest over lengths with at least 16 blocks. The memory is logarithmic in the length of the series.
///
/// ```
/// use voronudge_observables::BlockAverage;
/// let mut average = BlockAverage::default();
/// // A slow oscillation about 3, and a fast one.
/// for i in 0..4096 {
///     average.add(3.0 + (i as f64 * 0.01).sin() + (i as f64 * 1.7).cos());
/// }
/// assert!((average.mean().unwrap() - 3.0).abs() < 3.0 * average.standard_error().unwrap());
/// assert!(average.standard_error().unwrap() > 4.0 / 4096f64.sqrt());
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BlockAverage {
    levels: Vec<Level>,
}

/// Averages over blocks of one length.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Level {
    blocks: u64,
    mean: f64,
    /// Sum of squared deviations from the mean.
    deviations: f64,
    /// A block that waits for the next to make one of twice its length.
    waiting: Option<f64>,
}

/// Fewest blocks that tell a standard error.
const FEWEST: u64 = 16;

impl BlockAverage {
    /// Takes in the next value of the series, in its unit.
    pub fn add(&mut self, value: f64) {
        let mut block = value;
        for depth in 0.. {
            if self.levels.len() == depth {
                self.levels.push(Level::default());
            }
            let level = &mut self.levels[depth];
            level.blocks += 1;
            let from = block - level.mean;
            level.mean += from / level.blocks as f64;
            level.deviations += from * (block - level.mean);
            match level.waiting.take() {
                None => {
                    level.waiting = Some(block);
                    return;
                }
                Some(before) => block = 0.5 * (before + block),
            }
        }
    }

    /// Number of values.
    pub fn count(&self) -> u64 {
        self.levels.first().map_or(0, |level| level.blocks)
    }

    /// The mean, in the unit of the values; `None` without values.
    pub fn mean(&self) -> Option<f64> {
        self.levels.first().map(|level| level.mean)
    }

    /// The standard error of the mean, in the unit of the values; `None` for fewer than 16 values. A lower bound if the
    /// series is not much longer than its correlation.
    pub fn standard_error(&self) -> Option<f64> {
        self.levels
            .iter()
            .filter(|level| level.blocks >= FEWEST)
            .map(|level| (level.deviations / (level.blocks - 1) as f64 / level.blocks as f64).sqrt())
            .reduce(f64::max)
    }
}
