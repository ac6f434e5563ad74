//! Is the residual white in space and from frame to frame?

use super::modes::low_modes;
use super::pool::Pool;
use super::random_signs::{Stream, upper_tail};
use super::{LEVEL, ResidualField};
use std::collections::BTreeMap;

/// Fewer pairs than this are not tested.
const FEWEST_PAIRS: usize = 10;

/// What a test looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Moran's index of the vector field about zero over pairs of neighbours, `⟨u_i·u_j⟩ / ⟨|u|²⟩`; two-sided.
    Neighbours,
    /// Power of the smoothest fields (constant and longest waves in a periodic box, polynomials up to degree two in an
    /// open field) over that of white noise: `Σ_m |Σ_i f_m(r_i) u_i|² / (M ⟨|u|²⟩)` with M orthonormal functions f_m, one
    /// if white; large values count.
    LowModes,
    /// Correlation of a cell's residuals in consecutive frames, `Σ u_i(t)·u_i(t+1) / (Σ|u_i(t)|² Σ|u_i(t+1)|²)^½`;
    /// two-sided. Velocities of consecutive frames that share a measured position correlate negatively by its noise.
    Successive,
}

impl Kind {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Neighbours => "neighbours",
            Self::LowModes => "low modes",
            Self::Successive => "successive frames",
        }
    }
}

/// One test of whiteness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Test {
    /// What it looks at.
    pub kind: Kind,
    /// See [`Kind`].
    pub statistic: f64,
    /// Probability of the like under the null hypothesis, by random signs; not less than 0.001.
    pub p: f64,
    /// The same after Holm for all tests made.
    pub adjusted_p: f64,
}

/// All tests of whiteness that the data allow.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// The tests.
    pub tests: Vec<Test>,
    /// Probability under the null hypothesis that any test is as significant as the best: the least adjusted one.
    pub p: f64,
}

impl Structure {
    /// Nothing was tested.
    pub(crate) fn untested() -> Self {
        Self { tests: Vec::new(), p: 1.0 }
    }

    /// Whether the residual has structure at the level of 5 % for all tests together.
    pub fn is_significant(&self) -> bool {
        self.p < LEVEL
    }

    /// The test of a kind, if it was made.
    pub fn test(&self, kind: Kind) -> Option<&Test> {
        self.tests.iter().find(|test| test.kind == kind)
    }
}

/// Tests whether residuals are white; frames are pooled. For `identities` and `seed` see
/// [`diagnose`](super::diagnose).
pub fn structure(frames: &[ResidualField<'_>], identities: Option<&[Vec<i64>]>, seed: u64) -> Structure {
    let pool = Pool::new(frames);
    let moran = neighbours(&pool, seed).map(|result| (Kind::Neighbours, result));
    let modes = modes(frames, &pool, seed).map(|result| (Kind::LowModes, result));
    let successive = identities
        .and_then(|identities| successive(&pool, identities, seed))
        .map(|result| (Kind::Successive, result));
    let mut tests: Vec<Test> = [moran, modes, successive]
        .into_iter()
        .flatten()
        .map(|(kind, (statistic, p))| Test { kind, statistic, p, adjusted_p: p })
        .collect();
    holm(&mut tests);
    let p = tests.iter().map(|test| test.adjusted_p).fold(1.0, f64::min);
    Structure { tests, p }
}

/// Moran's index and its p-value. `None` with too few pairs, or if all residuals are zero.
pub(super) fn neighbours(pool: &Pool, seed: u64) -> Option<(f64, f64)> {
    let products: Vec<f64> =
        pool.edges.iter().map(|&[i, j]| pool.residuals[i].dot(&pool.residuals[j])).collect();
    let scale = pool.mean_square() * pool.edges.len() as f64;
    if products.len() < FEWEST_PAIRS || scale <= 0.0 {
        return None;
    }
    Some(two_sided(&pool.edges, &products, scale, pool, seed, Stream::Neighbours))
}

/// A sum over pairs that changes sign with either of the pair, over a scale.
pub(super) fn two_sided(
    pairs: &[[usize; 2]],
    products: &[f64],
    scale: f64,
    pool: &Pool,
    seed: u64,
    stream: Stream,
) -> (f64, f64) {
    let sum = |signs: &[f64]| -> f64 {
        pairs.iter().zip(products).map(|(&[i, j], product)| signs[i] * signs[j] * product).sum()
    };
    let [(_, p)] = upper_tail(pool.residuals.len(), seed, stream, |signs| [sum(signs).abs()]);
    (products.iter().sum::<f64>() / scale, p)
}

fn modes(frames: &[ResidualField<'_>], pool: &Pool, seed: u64) -> Option<(f64, f64)> {
    // One row for each component of each mode of each frame: the first residual, and its terms.
    let mut rows: Vec<(usize, Vec<f64>)> = Vec::new();
    for (frame, &start) in frames.iter().zip(&pool.starts) {
        let here = &pool.residuals[start..start + frame.places.len()];
        for mode in low_modes(frame) {
            for axis in 0..2 {
                rows.push((start, mode.iter().zip(here).map(|(f, u)| f * u[axis]).collect()));
            }
        }
    }
    let scale = 0.5 * rows.len() as f64 * pool.mean_square();
    let power = |signs: &[f64]| -> f64 {
        let amplitude = |(start, terms): &(usize, Vec<f64>)| -> f64 {
            terms.iter().zip(&signs[*start..]).map(|(term, sign)| term * sign).sum()
        };
        rows.iter().map(|row| amplitude(row).powi(2)).sum::<f64>() / scale
    };
    let [result] = (scale > 0.0)
        .then(|| upper_tail(pool.residuals.len(), seed, Stream::LowModes, |signs| [power(signs)]))?;
    Some(result)
}

fn successive(pool: &Pool, identities: &[Vec<i64>], seed: u64) -> Option<(f64, f64)> {
    let mut pairs = Vec::new();
    for (frames, starts) in identities.windows(2).zip(pool.starts.windows(2)) {
        // What has no name is nowhere else.
        let named = frames[0].iter().copied().zip(starts[0]..starts[1]).filter(|(track, _)| *track >= 0);
        let before: BTreeMap<i64, usize> = named.collect();
        let later = frames[1].iter().zip(starts[1]..pool.residuals.len());
        pairs.extend(later.filter_map(|(track, j)| Some([*before.get(track)?, j])));
    }
    let square = |side: usize| -> f64 {
        pairs.iter().map(|pair: &[usize; 2]| pool.residuals[pair[side]].norm_squared()).sum()
    };
    let scale = (square(0) * square(1)).sqrt();
    if pairs.len() < FEWEST_PAIRS || scale <= 0.0 {
        return None;
    }
    let products: Vec<f64> = pairs.iter().map(|&[i, j]| pool.residuals[i].dot(&pool.residuals[j])).collect();
    Some(two_sided(&pairs, &products, scale, pool, seed, Stream::Successive))
}

/// Holm: the m-th smallest of n p-values times `n + 1 − m`, and no smaller than those before it.
fn holm(tests: &mut [Test]) {
    let mut order: Vec<usize> = (0..tests.len()).collect();
    order.sort_by(|&a, &b| tests[a].p.total_cmp(&tests[b].p));
    let mut least = 0.0f64;
    for (rank, &index) in order.iter().enumerate() {
        least = least.max((order.len() - rank) as f64 * tests[index].p).min(1.0);
        tests[index].adjusted_p = least;
    }
}
