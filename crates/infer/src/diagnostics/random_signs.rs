//! The null hypothesis: each residual is as likely as its opposite, independently of all others.

use rand::{RngCore, SeedableRng};
use rand_pcg::Pcg64;

/// Draws under the null hypothesis; the smallest p-value is one over their number plus one.
const DRAWS: usize = 999;

/// Tests of the same seed use different random numbers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stream {
    Neighbours = 1,
    LowModes = 2,
    Successive = 3,
    Handedness = 4,
    Split = 5,
}

/// Draws random signs.
pub(crate) fn draw(generator: &mut Pcg64, signs: &mut [f64]) {
    for chunk in signs.chunks_mut(64) {
        let mut bits = generator.next_u64();
        for sign in chunk {
            *sign = if bits & 1 == 0 { -1.0 } else { 1.0 };
            bits >>= 1;
        }
    }
}

/// Statistics of the residuals as they are, and the probability under random signs of values at least as large.
///
/// `statistics` is given the sign of each of `count` residuals. `p = (1 + number of draws not below) / (1 + draws)`, which
/// is exact for any number of draws.
pub(super) fn upper_tail<const K: usize>(
    count: usize,
    seed: u64,
    stream: Stream,
    mut statistics: impl FnMut(&[f64]) -> [f64; K],
) -> [(f64, f64); K] {
    // In the upper bits, so that neighbouring seeds stay apart.
    let mut generator = Pcg64::seed_from_u64(seed ^ ((stream as u64) << 56));
    let mut signs = vec![1.0; count];
    let observed = statistics(&signs);
    let mut reached = [1usize; K];
    for _ in 0..DRAWS {
        draw(&mut generator, &mut signs);
        for ((value, observed), reached) in statistics(&signs).iter().zip(&observed).zip(&mut reached) {
            // Equal but for rounding is equal.
            *reached += usize::from(*value >= observed - 1e-12 * observed.abs());
        }
    }
    std::array::from_fn(|k| (observed[k], reached[k] as f64 / (DRAWS + 1) as f64))
}
