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
use crate::{Error, Observation};
use candidate::{Candidate, candidates};
use classes::Selection;
use evidence::Evidence;
use steps::{Model, Setting};
use voronudge_model::effect::Kind;

/// Least width of a block of cells that is held out, in units of ℓ₀.
const BLOCK: f64 = 3.0;

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
    let lineup = setting.lineup(&base)?;
    let mut ranking = ranking::rank(&setting, &lineup);
    let testable = lineup.left() >= lineup.number_of_columns() as f64;
    let (mut model, mut found) = (None, Vec::new());
    if testable {
        (model, found) = grow(&setting, &base, &mut watch)?;
    }
    let base_error = base.inference.nmse.un_nudged;
    let blocks = blocks(frames);
    let before_folds = folds(frames, &base, blocks, &mut watch)?;
    let mut after_folds = match &model {
        Some(model) => folds(frames, model, blocks, &mut watch)?,
        None => None,
    };
    let mut gain = before_folds.as_ref().zip(after_folds.as_ref()).map(|(before, after)| before.gain(after));
    let mut null_sets = NullSets::default();
    let mut refused = None;
    if model.is_some() {
        if gain.is_some_and(|[value, error]| value <= error) {
            refused = Some("the error on velocities held out does not fall by more than its standard error");
        } else {
            null_sets = null_data::searched(&setting, &base, &mut watch)?;
            let smallest = found.iter().map(|lacking: &steps::Lacking| lacking.p).fold(1.0, f64::min);
            if null_data::probability(&null_sets, smallest) >= search.level {
                refused = Some("synthetic data without any effect lead to one as often");
            }
        }
    }
    if let (Some(reason), Some(model)) = (refused, model.take_if(|_| refused.is_some())) {
        ranking::refuse(&mut ranking, &setting, &model.added, reason);
        found.clear();
        (after_folds, gain) = (None, None);
    }
    let identities = search.identities.as_deref();
    let evidence = Evidence { frames, request: &base.request, identities, base_error };
    let before = evidence.of(base.inference.clone(), before_folds.as_ref())?;
    let (after, selection) = match &model {
        None => (before.clone(), Selection::default()),
        Some(model) => {
            let evidence = Evidence { request: &model.request, ..evidence };
            let after = evidence.of(model.inference.clone(), after_folds.as_ref())?;
            (after, classes::selection(&setting, &base, model, &found, &mut watch)?)
        }
    };
    ranking::settle(&mut ranking, &selection);
    let description = describe(&setting, &base, blocks, &mut watch)?;
    let left = verdict::Left::new(&setting, model.as_ref().unwrap_or(&base), &after)?;
    let verdict = verdict::decide(testable, &selection, &left);
    let single_p = ranking::single_p(&setting, &lineup);
    Ok(Discovery {
        verdict,
        before,
        after,
        share_of_excess: selection.share,
        selected: selection.selected,
        ranking,
        description,
        gain,
        single_p,
        null_sets,
    })
}

/// Adds what the model lacks, one effect after another, and takes back what others make superfluous.
fn grow(
    setting: &Setting<'_>,
    base: &Model,
    watch: &mut Watch<'_>,
) -> Result<(Option<Model>, Vec<steps::Lacking>), Error> {
    let mut model: Option<Model> = None;
    let mut found: Vec<steps::Lacking> = Vec::new();
    while found.len() < setting.search.most_effects {
        let current = model.as_ref().unwrap_or(base);
        let Some(lacking) = setting.lacking(current, watch)? else { break };
        let mut added = current.added.clone();
        added.push(lacking.candidate);
        found.push(lacking);
        model = Some(setting.fit(added, watch)?);
    }
    while let Some(current) = &model {
        let Some(superfluous) = classes::superfluous(setting, current)? else { break };
        let added: Vec<usize> = current.added.iter().copied().filter(|own| *own != superfluous).collect();
        found.retain(|lacking| lacking.candidate != superfluous);
        model = if added.is_empty() { None } else { Some(setting.fit(added, watch)?) };
    }
    Ok((model, found))
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
    base: &Model,
    blocks: usize,
    watch: &mut Watch<'_>,
) -> Result<Option<Described>, Error> {
    let lineup = setting.lineup(base)?;
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
    Ok(Some(Described {
        effect: setting.candidates[candidate].effect,
        dimension: score.dimension,
        held_out: folds.as_ref().map(HeldOut::of),
        inference: model.inference,
    }))
}
