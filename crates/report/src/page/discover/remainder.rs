//! What remains after the last fit.

use super::super::words::{percent, probability};
use super::super::{Block, Figure, Section, Table};
use crate::discover_report::{DiscoverReport, StructureTest};
use crate::figure::{CorrelationFunction, correlation_function};
use crate::numbers::significant;

/// The share left; noise is known with an error, so it may explain a little too much.
fn left(share: f64) -> String {
    if share > 0.0 { percent(share) + " of the squared velocities" } else { "nothing".into() }
}

/// Numbers, tests and correlation functions of the rest.
pub(super) fn section(report: &DiscoverReport, correlations: &[CorrelationFunction]) -> Section {
    let rest = &report.unexplained;
    let lengths = || {
        let cells = significant(rest.correlation_length / report.length_scale.value, 2);
        let length = significant(rest.correlation_length, 2);
        format!("{length} {}, {cells} cell sizes ℓ_0", report.units.length_text())
    };
    let facts = [
        ("unexplained by model and noise", rest.share, left(rest.share)),
        ("it stays correlated over", rest.correlation_length, lengths()),
        (
            "of its smooth part, sources and sinks (free of curl)",
            rest.divergence_share,
            percent(rest.divergence_share),
        ),
        ("of its smooth part, swirls (free of divergence)", rest.curl_share, percent(rest.curl_share)),
    ];
    let known = facts.into_iter().filter(|fact| fact.1.is_finite());
    let test = |own: &StructureTest| [own.name.clone(), significant(own.statistic, 3), probability(own.p)];
    let tests = Table::new(["test", "statistic", "p"]).class("").rows(rest.tests.iter().map(test));
    let figure = |function: &CorrelationFunction| {
        Figure::new(correlation_function(function), function.correlation.meaning())
    };
    Section::new(if report.is_extended() { "What remains after that" } else { "What remains" })
        .with(Block::facts(known.map(|(label, _, text)| [label.to_owned(), text])))
        .with_part("Is there structure in it?", "", Block::Table(tests))
        .with_part(
            "How the residuals of two cells correlate",
            "Against their distance. Noise gives curves that stay near zero; the bands are one standard error.",
            Block::group("figures three", correlations.iter().map(figure)),
        )
}
