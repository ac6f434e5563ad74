//! Synthetic data without an effect, searched like the data.

use super::result::NullSets;
use super::search::Observer;
use super::steps::{Model, Setting};
use super::tested::Tested;
use crate::replicates::{Keeper, Series};
use crate::search::Watch;
use crate::uncertainty::synthetic;
use crate::{Error, infer};

/// Sets refitted if nothing else is asked for: a result that none of 20 reaches has p = 1/21.
const SETS: usize = 20;

/// Velocities of all frames above which no set is refitted if nothing else is asked for.
const LARGE: usize = 1000;

/// Adjusted p of every effect below which no set is refitted if nothing else is asked for: so few sets could not tell.
const CLEAR: f64 = 1e-4;

/// Fits and screens data that the base model could have made.
pub(super) fn searched(
    setting: &Setting<'_>,
    base: &Model,
    tested: &[Tested],
    keeper: &mut dyn Keeper,
    watch: &mut Watch<'_>,
) -> Result<NullSets, Error> {
    let in_doubt = tested.iter().any(|own| own.adjusted_p >= CLEAR);
    let count = match setting.search.null_sets {
        // Tracks are not made up.
        _ if setting.movie.is_some() => 0,
        Some(count) => count,
        None if in_doubt && base.inference.used <= LARGE => SETS,
        None => 0,
    };
    let series = Series { stage: "null data", count, made_from: &base.inference };
    let smallest = series.make(
        |index, observe| Ok([smallest_p(setting, base, number(index), observe)?]),
        keeper,
        watch,
    )?;
    let known = smallest.into_iter().enumerate().filter_map(|(index, p)| Some((number(index), p?[0])));
    let (seeds, mut smallest_p): (Vec<u64>, Vec<f64>) = known.unzip();
    smallest_p.sort_unstable_by(f64::total_cmp);
    Ok(NullSets { smallest_p, seeds })
}

/// The number of a set, apart from those of the replicates of a bootstrap with the same seed.
fn number(index: usize) -> u64 {
    1_000_001 + index as u64
}

fn smallest_p(setting: &Setting<'_>, base: &Model, number: u64, observe: Observer<'_>) -> Result<f64, Error> {
    let (frames, request) =
        synthetic(setting.frames, &base.request, &base.inference, base.inference.noise.velocity, number)?;
    let inference = infer(&frames, &request, observe)?;
    let setting = Setting { frames: &frames, ..*setting };
    let model = setting.model(Vec::new(), request, inference)?;
    let projected = model.lineup.beyond(&[]);
    Ok(setting.named(&[]).into_iter().map(|k| projected.score(k).p).fold(1.0, f64::min))
}

/// Probability of so small a p of any candidate, from the sets. It is zero where no set has reached it, since a few sets
/// cannot say more.
pub(super) fn probability(sets: &NullSets, p: f64) -> f64 {
    match sets.smallest_p.partition_point(|own| *own <= p) {
        0 => 0.0,
        reached => (reached + 1) as f64 / (sets.smallest_p.len() + 1) as f64,
    }
}
