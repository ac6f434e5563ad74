//! What a residual looks like: is it white, and if not, what is its shape?
//!
//! Everything here is a pure function of plain data: places, residuals, who is next to whom. Lengths are in the unit of
//! the places (ℓ₀, if the mean area of a cell is one). The null hypothesis of every test is that each residual is as
//! likely as its opposite, independently of all others; it is simulated by random signs, so neither a normal
//! distribution nor equal variances are needed. A mean that is not zero counts as structure.
//!
//! Residuals are taken as given. Those of a fit should be whitened before, since nudges correlate neighbours; raw ones
//! answer whether there is structure at all, be it of the noise. A fit removes a little of everything, which makes the
//! tests slightly conservative.
//!
//! | file | question |
//! |---|---|
//! | `structure` | is there structure in space, or from frame to frame? |
//! | `correlation` | how far does it reach, along and across, and does it have a handedness? |
//! | `split` | does it diverge or turn? |
//! | `map` | where is it? |
//! | `outliers` | which cells are not to be believed? |
//! | `modes`, `pool`, `random_signs` | lowest modes; frames as one list; the null hypothesis |

mod correlation;
mod map;
mod modes;
mod outliers;
mod pool;
pub(crate) mod random_signs;
#[cfg(test)]
mod sample;
mod split;
mod structure;
#[cfg(test)]
mod tests;

pub use correlation::{Bin, Correlation, CorrelationLength, Correlations, correlations};
pub use map::{LocalResidual, maps};
pub(crate) use outliers::robust_variance;
pub use outliers::{Cause, Outlier, outliers};
pub use pool::{CellData, ResidualField};
pub use split::{Part, Shares, Split, split};
pub use structure::{Kind, Structure, Test, structure};

/// The level of every yes or no in here.
const LEVEL: f64 = 0.05;

/// All that can be said of the residual of one fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostics {
    /// Number of residuals in all frames.
    pub residuals: usize,
    /// `⟨|u|²⟩ / 2` over the square of the standard given: one, if only the expected noise is left.
    pub variance_ratio: f64,
    /// Tests for structure in space and time.
    pub structure: Structure,
    /// Correlation functions of the distance.
    pub correlations: Correlations,
    /// Divergence against curl.
    pub split: Split,
    /// One for each frame, one entry for each residual.
    pub maps: Vec<Vec<LocalResidual>>,
    /// Cells whose residual is too large.
    pub outliers: Vec<Outlier>,
}

/// Looks at the residuals of one fit in every way; frames are pooled.
///
/// `identities`: one list for each frame with the track of each residual, for the test across consecutive frames; no
/// such test without it. The same seed gives the same answer, whatever the number of threads.
pub fn diagnose(frames: &[ResidualField<'_>], identities: Option<&[Vec<i64>]>, seed: u64) -> Diagnostics {
    let pool = pool::Pool::new(frames);
    Diagnostics {
        residuals: pool.residuals.len(),
        variance_ratio: pool.mean_square() / 2.0,
        structure: structure(frames, identities, seed),
        correlations: correlations(frames, seed),
        split: split(frames, seed),
        maps: maps(frames),
        outliers: outliers(frames),
    }
}
