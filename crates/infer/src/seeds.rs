//! Seeds made from a seed.

use rand::Rng;
use rand_pcg::Pcg64;

/// What a seed is made for. Purposes share no random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// A further start of a search.
    Start,
    /// The refit of a set of synthetic data.
    Refit,
    /// What happens after a frame.
    After(usize),
    /// The movies that one of the models makes.
    Model(usize),
}

/// A seed of its own for every number: seeds made from neighbouring ones share none.
pub(crate) fn seed_of(seed: u64, purpose: Purpose, number: u64) -> u64 {
    let kind = match purpose {
        Purpose::Start => [1, 0],
        Purpose::Refit => [2, 0],
        Purpose::After(frame) => [3, frame as u64],
        Purpose::Model(model) => [4, model as u64],
    };
    let stream = u128::from(kind[0]) << 120 | u128::from(kind[1]) << 64 | u128::from(number);
    Pcg64::new(u128::from(seed) << 64 | 0x9E37_79B9_7F4A_7C15, stream).random()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_seeds_share_nothing() {
        let mut seen = std::collections::BTreeSet::new();
        let frames = (0..4).flat_map(|k| [Purpose::After(k), Purpose::Model(k)]);
        let purposes: Vec<Purpose> = [Purpose::Start, Purpose::Refit].into_iter().chain(frames).collect();
        for seed in 0..30 {
            for &purpose in &purposes {
                assert!(
                    (0..60).all(|number| seen.insert(seed_of(seed, purpose, number))),
                    "{seed} {purpose:?}"
                );
            }
        }
    }
}
