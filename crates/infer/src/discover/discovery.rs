//! The search for what a model lacks, from the fit of the base model to the verdict.

use super::candidate::{candidates, candidates_of_tracks};
use super::classes::{Selection, selection};
use super::evidence::Evidence;
use super::growth::{Grown, Growth};
use super::ranking::{NOTHING_TO_TELL, TURNING};
use super::result::{Described, Discovery, HeldOut, NullSets, predicts_better};
use super::scatter::RandomMotion;
use super::search::{Observer, Search};
use super::steps::{Model, Setting};
use super::{evidence, heterogeneity, null_data, prospects, verdict};
use crate::cross_validation::{BLOCKS, Folds, Split, cross_validate};
use crate::replicates::Keeper;
use crate::search::Watch;
use crate::tracks::Movie;
use crate::{CrossValidation, Error, Observation, Unkept};

/// Least width of a block of cells that is held out, in units of ℓ₀.
const BLOCK: f64 = 3.0;

/// Blocks along each axis at most.
const MOST_BLOCKS: usize = 3;

/// Fits the base model to snapshots, finds what it leaves unexplained, and adds the effects that explain it.
///
/// Lengths in units of ℓ₀. `keeper` keeps what fits to synthetic data come to. `observe` is told of progress and may stop the search.
///
/// # Errors
/// [`Error`] if the base model cannot be fitted, the caller stops, or some of the synthetic data are fitted elsewhere.
pub fn discover(
    frames: &[Observation],
    search: &Search,
    keeper: &mut dyn Keeper,
    observe: Observer<'_>,
) -> Result<Discovery, Error> {
    let offered = candidates(frames, search);
    let setting = Setting { frames, movie: None, search, candidates: &offered };
    searched(setting, keeper, &mut Watch { observe })
}

/// The same for cells followed through time: their tracks are fitted themselves, and the polarity of cells that crawl is a candidate, an
/// unknown state of each.
///
/// # Errors
/// [`Error`] if the base model cannot be fitted or the caller stops.
pub fn discover_in_tracks(movie: &Movie, search: &Search, observe: Observer<'_>) -> Result<Discovery, Error> {
    let frames = movie.observations()?;
    let offered = candidates_of_tracks(&frames, &search.candidates);
    let setting = Setting { frames: &frames, movie: Some(movie), search, candidates: &offered };
    searched(setting, &mut Unkept, &mut Watch { observe })
}

fn searched(
    setting: Setting<'_>,
    keeper: &mut dyn Keeper,
    watch: &mut Watch<'_>,
) -> Result<Discovery, Error> {
    let Setting { frames, search, .. } = setting;
    let base = setting.fit(Vec::new(), None, watch)?;
    let split = Split::new(frames, blocks(frames));
    let are_few = base.lineup.left() < base.lineup.number_of_columns() as f64;
    let turning = base.inference.cells_turn();
    let untestable = are_few.then_some(NOTHING_TO_TELL).or(turning.then_some(TURNING));
    let testable = untestable.is_none();
    let mut growth = Growth::new(setting, &base, &split, watch)?;
    let mut null_sets = NullSets::default();
    let mut grown = None;
    if testable {
        grown = growth.grow(watch)?;
        if let Some(unconfirmed) = grown {
            null_sets = null_data::searched(&setting, &base, &unconfirmed.tested, keeper, watch)?;
            grown = growth.confirm(unconfirmed, &null_sets, watch)?;
        }
    }
    let mut differing = None;
    if testable && setting.movie.is_none() {
        (grown, differing) = heterogeneity::beside(&mut growth, grown, watch)?;
    }
    let base_folds = folds(&setting, &base, &split, watch)?;
    let base_error = evidence::error(&base, base_folds.as_ref());
    let evidence = Evidence { frames, identities: search.identities.as_deref(), base_error };
    let before = evidence.of(&base, base_folds.as_ref())?;
    let mut own_folds = None;
    let (mut gain, mut likelihood_gain) = (None, None);
    if let Some(Grown { model, .. }) = &grown {
        own_folds = folds(&setting, model, &split, watch)?;
        gain = base_folds.as_ref().zip(own_folds.as_ref()).map(|(base, own)| base.gain(own));
        likelihood_gain = growth.likelihood_gain(model, watch)?;
    }
    let (extended, tested) = grown.as_ref().map_or((&base, &[][..]), |own| (&own.model, &own.tested));
    let after = match (&differing, &grown) {
        // Velocities held out are predicted with what all cells share.
        (Some(own), _) => {
            let evidence = Evidence { frames: own.model.frames(frames), ..evidence };
            evidence.of(&own.model, own_folds.as_ref().or(base_folds.as_ref()))?
        }
        (None, Some(grown)) => evidence.of(&grown.model, own_folds.as_ref())?,
        (None, None) => before.clone(),
    };
    let mut selected = Selection::default();
    if grown.is_some() || differing.is_some() {
        selected = selection(&setting, &base, (extended, tested), differing.as_ref(), watch)?;
    }
    // Where something goes on in time, what describes it in space alone says little.
    let describes = testable && (setting.movie.is_none() || grown.is_none());
    let description = if describes { describe(&growth, &split, watch)? } else { None };
    let last = differing.as_ref().map_or(extended, |own| &own.model);
    let explains = !selected.selected.is_empty();
    let mut ranking = growth.ranking;
    if let Some(reason) = untestable {
        ranking.leave(reason);
    }
    if testable && let Some(random) = RandomMotion::of(&setting, last)? {
        ranking.put(random.ranked);
        selected.selected.extend(random.selected);
    }
    ranking.settle(&selected.selected);
    // What single cells have of their own predicts no other cell, and what moves them at random predicts nothing.
    let only_scatters = !explains && !selected.selected.is_empty();
    let proven = match search.fit.cross_validation {
        _ if differing.is_some() || only_scatters => false,
        CrossValidation::Done => gain.is_some_and(predicts_better),
        CrossValidation::Skipped => true,
    };
    let left = verdict::Left::new(&setting, last, &after);
    let explained = explains.then_some(selected.largest_share).or(only_scatters.then_some(1.0));
    let verdict = verdict::decide(testable, explained, &left, proven);
    // Of paths that need not be those of the cells nothing follows for others.
    let prospects = match turning {
        true => None,
        false => prospects::of(&setting, last, &selected.selected).ok().flatten(),
    };
    Ok(Discovery {
        verdict,
        before,
        after,
        rest_is_structured: left.structured,
        share_of_excess: selected.share,
        selected: selected.selected,
        single_p: ranking.single_p,
        ranking: ranking.candidates,
        description,
        gain,
        likelihood_gain,
        null_sets,
        prospects,
    })
}

/// Blocks along each axis for data of this extent.
fn blocks(frames: &[Observation]) -> usize {
    let cells: usize = frames.iter().map(|frame| frame.targets().count()).sum();
    let width = (cells as f64 / frames.len() as f64).sqrt();
    ((width / BLOCK) as usize).clamp(BLOCKS, MOST_BLOCKS)
}

/// Errors of a model fitted without some velocities on those.
fn folds(
    setting: &Setting<'_>,
    model: &Model,
    split: &Split,
    watch: &mut Watch<'_>,
) -> Result<Option<Folds>, Error> {
    if let Some(followed) = &model.followed {
        return Ok(followed.held_out.clone());
    }
    match setting.search.fit.cross_validation {
        CrossValidation::Done => {
            let frames = setting.frames;
            cross_validate(&model.objective(frames), &model.point(frames), split, watch)
        }
        CrossValidation::Skipped => Ok(None),
    }
}

/// The generic description that says most beyond chance, fitted.
fn describe(growth: &Growth<'_>, split: &Split, watch: &mut Watch<'_>) -> Result<Option<Described>, Error> {
    let Growth { setting, base, .. } = growth;
    let projected = base.lineup.beyond(&[]);
    let best = (setting.descriptions().into_iter())
        .map(|k| (k, projected.score(k)))
        .filter(|(_, score)| score.p < setting.search.level)
        .min_by(|a, b| a.1.p.total_cmp(&b.1.p).then(b.1.statistic.total_cmp(&a.1.statistic)));
    let Some((candidate, score)) = best else { return Ok(None) };
    let model = setting.fit(vec![candidate], Some(base), watch)?;
    // One that predicts worse than the base model describes nothing.
    if growth.likelihood_gain(&model, watch)?.is_some_and(|gain| gain[0] <= 0.0) {
        return Ok(None);
    }
    Ok(Some(Described {
        effect: setting.candidates[candidate].effect,
        dimension: score.dimension,
        held_out: folds(setting, &model, split, watch)?.as_ref().map(HeldOut::of),
        inference: model.inference,
    }))
}
