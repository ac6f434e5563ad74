//! The ranking of all candidates.

use super::super::words::{effect_name, probability, with_error};
use super::super::{Block, Figure, Row, Section, Table, Text};
use crate::discover_report::{CandidateStatus, DiscoverReport, Gain, RankedEffect};
use crate::figure::effect_ranking;
use crate::numbers::{NO_VALUE, significant};

/// All candidates in the order of the report.
pub(super) fn section(report: &DiscoverReport) -> Section {
    let section = Section::new("All candidates");
    if report.ranking.is_empty() {
        return section;
    }
    let header = [
        ("effect", ""),
        ("status", "text"),
        ("size, % of v", ""),
        ("detection limit, %", ""),
        ("adjusted p", ""),
        ("p", ""),
        ("statistic", ""),
        ("dimension", ""),
        ("gain in held-out error", ""),
        ("family", "text"),
        ("why it was taken or not", "text why"),
    ];
    section
        .with(Block::group("single", ranking_figure(report)))
        .with(Block::table(Table::new(header).class("ranking").rows(report.ranking.iter().map(row))))
        .with(Block::remark(
            "Sizes are root mean square, in percent of the velocity. The statistic is that of a score test against the base model at its nudged fit.",
        ))
}

fn row(candidate: &RankedEffect) -> Row {
    let gain = |own: Gain| with_error(own.value, own.standard_error);
    let cells = [
        effect_name(&candidate.effect),
        candidate.status.name().into(),
        significant(candidate.size, 2),
        significant(candidate.detection_limit, 2),
        probability(candidate.p_adjusted),
        probability(candidate.p),
        significant(candidate.statistic, 3),
        candidate.dimension.to_string(),
        candidate.gain.map_or_else(|| NO_VALUE.to_owned(), gain),
        candidate.kind.name().into(),
    ];
    let cells = cells.map(Text::from).into_iter().chain([Text::prose(&candidate.reason)]);
    cells.collect::<Row>().main(candidate.status == CandidateStatus::Selected)
}

/// The chart of sizes and limits.
fn ranking_figure(report: &DiscoverReport) -> Option<Figure> {
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
