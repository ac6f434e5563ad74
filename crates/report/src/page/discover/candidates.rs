//! The ranking of all candidates.

use serde::Serialize;

use super::super::Figure;
use super::super::words::{effect_name, probability, with_error};
use crate::discover_report::{CandidateStatus, DiscoverReport, RankedEffect};
use crate::figure::effect_ranking;
use crate::numbers::{NO_VALUE, significant};

/// One row of the table.
#[derive(Serialize)]
pub(super) struct CandidateRow {
    name: String,
    family: &'static str,
    dimension: usize,
    statistic: String,
    p: String,
    p_adjusted: String,
    size: String,
    detection_limit: String,
    gain: String,
    status: &'static str,
    is_selected: bool,
    reason: String,
}

/// All candidates in the order of the report.
pub(super) fn rows(report: &DiscoverReport) -> Vec<CandidateRow> {
    let row = |candidate: &RankedEffect| CandidateRow {
        name: effect_name(&candidate.effect),
        family: candidate.kind.name(),
        dimension: candidate.dimension,
        statistic: significant(candidate.statistic, 3),
        p: probability(candidate.p),
        p_adjusted: probability(candidate.p_adjusted),
        size: significant(candidate.size, 2),
        detection_limit: significant(candidate.detection_limit, 2),
        gain: candidate
            .gain
            .map_or_else(|| NO_VALUE.to_owned(), |gain| with_error(gain.value, gain.standard_error)),
        status: candidate.status.name(),
        is_selected: candidate.status == CandidateStatus::Selected,
        reason: candidate.reason.clone(),
    };
    report.ranking.iter().map(row).collect()
}

/// The chart of sizes and limits.
pub(super) fn ranking_figure(report: &DiscoverReport) -> Option<Figure> {
    let figure = || {
        Figure::new(
            effect_ranking(&report.ranking),
            "Estimated size of each effect when it is added alone. An effect smaller than its detection limit \
             would usually be missed: its absence from the model is no evidence against it.",
        )
    };
    let mut numbers = report.ranking.iter().flat_map(|effect| [effect.size, effect.detection_limit]);
    numbers.any(|number| number.is_finite() && number > 0.0).then(figure)
}
