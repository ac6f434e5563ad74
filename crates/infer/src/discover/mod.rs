//! From the residual to an effect that the model lacks.
//!
//! 1. The base model is fitted, nudges and noise levels included.
//! 2. Every candidate is scored against what it leaves (`lineup`), and the best is compared with what chance makes of the
//!    best of so many (`chance`).
//! 3. The best is added and everything is fitted again, as long as something is better than chance and worth its
//!    coefficients (`steps`).
//! 4. What was added is put to the test: each effect against all others in its place (`classes`), the error on velocities
//!    held out (`evidence`), synthetic data without an effect that are searched like the data (`null_data`).
//! 5. What is left decides on the verdict (`verdict`).

mod candidate;
mod chance;
mod classes;
mod evidence;
mod lineup;
mod null_data;
mod ranking;
mod result;
mod steps;
#[cfg(test)]
mod tests;
mod verdict;
mod whitening;

pub use result::*;

use crate::cross_validation::{BLOCKS, Folds, cross_validate};
use crate::objective::Objective;
use crate::search::Watch;
use crate::{CrossValidation, Error, Observation};
use candidate::{Candidate, candidates};
use classes::Selection;
use evidence::Evidence;
use ranking::Ranking;
use steps::{Model, Setting};
use voronudge_model::effect::Kind;

/// Least width of a block of cells that is held out, in units of ℓ₀.
const BLOCK: f64 = 3.0;

/// Effects refused because of the held-out error before the search ends.
const MOST_REFUSED: usize = 3;

/// Blocks along each axis at most.
const MOST_BLOCKS: usize = 3;

/// Fits the base model to snapshots, finds what it leaves unexplained, and adds the effects that explain it.
///
/// Lengths in units of ℓ₀. `observe` is told of progress and may stop the search.
///
/// # Errors
/// [`Error`] if the base model cannot be fitted or the caller stops.
pub fn discover(frames: &[Observation], search: &Search, observe: Observer<'_>) -> Result<Discovery, Error> {
    let offered = candidates(frames, &search.candidates);
    let setting = Setting { frames, search, candidates: &offered };
    let mut watch = Watch { observe };
    let base = setting.fit(Vec::new(), &mut watch)?;
    let blocks = blocks(frames);
    let mut base = Tried { folds: None, model: base };
    if search.fit.cross_validation == CrossValidation::Done {
        base.hold_out(frames, blocks, &mut watch)?;
    }
    let lineup = setting.lineup(&base.model)?;
    let mut ranking = Ranking::new(&setting, &lineup);
    let testable = lineup.left() >= lineup.number_of_columns() as f64;
    let mut null_sets = NullSets::default();
    let mut grown = None;
    if testable {
        grown = grow(&setting, &mut base, blocks, &mut ranking, &mut watch)?;
        if grown.is_some() {
            null_sets = null_data::searched(&setting, &base.model, &mut watch)?;
            grown = confirm(&setting, &base.model, grown, &null_sets, blocks, &mut ranking, &mut watch)?;
        }
    }
    let base_error = base.model.inference.nmse.un_nudged;
    let identities = search.identities.as_deref();
    let evidence = Evidence { frames, request: &base.model.request, identities, base_error };
    let before = evidence.of(base.model.inference.clone(), base.folds.as_ref())?;
    let (after, selection, gain) = match &grown {
        None => (before.clone(), Selection::default(), None),
        Some(Tried { model, folds }) => {
            let evidence = Evidence { request: &model.request, ..evidence };
            let after = evidence.of(model.inference.clone(), folds.as_ref())?;
            let gain = base.folds.as_ref().zip(folds.as_ref()).map(|(before, after)| before.gain(after));
            (after, classes::selection(&setting, &base.model, model, &mut watch)?, gain)
        }
    };
    ranking.settle(&selection);
    let description = if testable { describe(&setting, &base, blocks, &mut watch)? } else { None };
    let last = grown.as_ref().map_or(&base.model, |tried| &tried.model);
    let verdict = verdict::decide(testable, &selection, &verdict::Left::new(&setting, last, &after)?);
    Ok(Discovery {
        verdict,
        before,
        after,
        share_of_excess: selection.share,
        selected: selection.selected,
        single_p: ranking.single_p,
        ranking: ranking.candidates,
        description,
        gain,
        null_sets,
    })
}

/// A model with its errors on velocities held out.
struct Tried {
    model: Model,
    folds: Option<Folds>,
}

impl Tried {
    /// Measures the errors, if they are not known.
    fn hold_out(
        &mut self,
        frames: &[Observation],
        blocks: usize,
        watch: &mut Watch<'_>,
    ) -> Result<(), Error> {
        if self.folds.is_none() {
            self.folds = folds(frames, &self.model, blocks, watch)?;
        }
        Ok(())
    }
}

/// Adds what the model lacks, one effect after another, as long as the error on velocities held out falls, and takes back
/// what others make superfluous.
fn grow(
    setting: &Setting<'_>,
    base: &mut Tried,
    blocks: usize,
    ranking: &mut Ranking,
    watch: &mut Watch<'_>,
) -> Result<Option<Tried>, Error> {
    let mut grown: Option<Tried> = None;
    let mut refused: Vec<usize> = Vec::new();
    while refused.len() < MOST_REFUSED
        && grown.as_ref().map_or(0, |tried| tried.model.added.len()) < setting.search.most_effects
    {
        let current = grown.as_mut().unwrap_or(base);
        let Some(candidate) = setting.lacking(&current.model, &refused, watch)? else { break };
        current.hold_out(setting.frames, blocks, watch)?;
        let mut added = current.model.added.clone();
        added.push(candidate);
        let model = setting.fit(added, watch)?;
        let folds = folds(setting.frames, &model, blocks, watch)?;
        let gain = current.folds.as_ref().zip(folds.as_ref()).map(|(before, after)| before.gain(after));
        if gain.is_some_and(|[value, error]| value <= error) {
            ranking.refuse(
                setting.candidates[candidate].effect,
                "the error on velocities held out does not fall by more than its standard error",
            );
            refused.push(candidate);
            continue;
        }
        grown = Some(Tried { model, folds });
    }
    while let Some(current) = &grown {
        let Some(superfluous) = classes::superfluous(setting, &base.model, &current.model, watch)? else {
            break;
        };
        ranking.refuse(
            setting.candidates[superfluous].effect,
            "with all else in the model it is no more than chance",
        );
        grown = without(setting, current, superfluous, blocks, watch)?;
    }
    Ok(grown)
}

/// Takes back effects as improbable as which synthetic data without an effect have them too.
fn confirm(
    setting: &Setting<'_>,
    base: &Model,
    mut grown: Option<Tried>,
    null_sets: &NullSets,
    blocks: usize,
    ranking: &mut Ranking,
    watch: &mut Watch<'_>,
) -> Result<Option<Tried>, Error> {
    while let Some(current) = &grown {
        let Some((candidate, p)) = classes::weakest(setting, base, &current.model, watch)? else { break };
        if null_data::probability(null_sets, p) < setting.search.level {
            break;
        }
        ranking.refuse(
            setting.candidates[candidate].effect,
            "synthetic data without any effect, searched in the same way, lead to one as often",
        );
        grown = without(setting, current, candidate, blocks, watch)?;
    }
    Ok(grown)
}

/// A model without one of its effects; `None` if none is left.
fn without(
    setting: &Setting<'_>,
    current: &Tried,
    candidate: usize,
    blocks: usize,
    watch: &mut Watch<'_>,
) -> Result<Option<Tried>, Error> {
    let added: Vec<usize> = current.model.added.iter().copied().filter(|own| *own != candidate).collect();
    if added.is_empty() {
        return Ok(None);
    }
    let model = setting.fit(added, watch)?;
    let folds = folds(setting.frames, &model, blocks, watch)?;
    Ok(Some(Tried { model, folds }))
}

/// Blocks along each axis for data of this extent.
fn blocks(frames: &[Observation]) -> usize {
    let cells: usize = frames.iter().map(|frame| frame.targets().count()).sum();
    let width = (cells as f64 / frames.len() as f64).sqrt();
    ((width / BLOCK) as usize).clamp(BLOCKS, MOST_BLOCKS)
}

/// Errors of a fitted model on velocities held out.
fn folds(
    frames: &[Observation],
    model: &Model,
    blocks: usize,
    watch: &mut Watch<'_>,
) -> Result<Option<Folds>, Error> {
    let space = model.request.space()?;
    let levels = model.inference.noise;
    let objective = Objective { frames, structure: &model.request.structure, space: &space, levels };
    cross_validate(&objective, blocks, watch)
}

/// The generic description that says most beyond chance, fitted.
fn describe(
    setting: &Setting<'_>,
    base: &Tried,
    blocks: usize,
    watch: &mut Watch<'_>,
) -> Result<Option<Described>, Error> {
    let lineup = setting.lineup(&base.model)?;
    let projected = lineup.beyond(&[]);
    let is_description = |c: &Candidate| c.effect.kind == Kind::Description && c.columns.is_ok();
    let best = (0..setting.candidates.len())
        .filter(|k| is_description(&setting.candidates[*k]))
        .map(|k| (k, projected.score(k)))
        .filter(|(_, score)| score.p < setting.search.level)
        .min_by(|a, b| a.1.p.total_cmp(&b.1.p).then(b.1.statistic.total_cmp(&a.1.statistic)));
    let Some((candidate, score)) = best else { return Ok(None) };
    let model = setting.fit(vec![candidate], watch)?;
    let folds = folds(setting.frames, &model, blocks, watch)?;
    // One that predicts worse than the base model describes nothing.
    if base.folds.as_ref().zip(folds.as_ref()).is_some_and(|(base, own)| base.gain(own)[0] <= 0.0) {
        return Ok(None);
    }
    Ok(Some(Described {
        effect: setting.candidates[candidate].effect,
        dimension: score.dimension,
        held_out: folds.as_ref().map(HeldOut::of),
        inference: model.inference,
    }))
}
