//! Errors of measurement as candidates beside a fit.

use super::candidate::offered;
use super::lineup::Lineup;
use crate::{Error, Inference, Observation, Request};
use voronudge_model::Effect;

/// Effects of one coefficient beside a fit that lacks them: id, p of the score test, estimated coefficient. Those that the data
/// do not allow to test are not among them.
///
/// # Errors
/// [`Error`] of the linearised problem.
pub(crate) fn measurement_scores(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
    ids: &[&str],
) -> Result<Vec<(&'static str, f64, f64)>, Error> {
    let effects: Vec<&'static Effect> = ids.iter().filter_map(|id| Effect::from_id(id)).collect();
    let mut tested = offered(frames, &effects);
    tested.retain(|candidate| candidate.columns.as_ref().is_ok_and(|columns| columns.len() == 1));
    if tested.is_empty() {
        return Ok(Vec::new());
    }
    let lineup = Lineup::new(frames, request, &tested, &[], result)?;
    let beyond = lineup.beyond(&[]);
    let scores = tested.iter().enumerate().map(|(k, candidate)| {
        let score = beyond.score(k);
        (candidate.effect.id, score.p, score.coefficients[0])
    });
    Ok(scores.collect())
}
