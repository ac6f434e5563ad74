//! What remains after the last fit.

use serde::Serialize;

use super::super::Figure;
use super::super::words::{percent, probability};
use crate::discover_report::DiscoverReport;
use crate::figure::{CorrelationFunction, correlation_function};
use crate::numbers::significant;

/// Numbers, tests and correlation functions of the rest.
#[derive(Serialize)]
pub(super) struct Remainder {
    facts: Vec<(&'static str, String)>,
    tests: Vec<TestRow>,
    correlations: Vec<Figure>,
}

#[derive(Serialize)]
struct TestRow {
    name: String,
    statistic: String,
    p: String,
}

/// The share left; noise is known with an error, so it may explain a little too much.
fn left(share: f64) -> String {
    if share > 0.0 { percent(share) + " of the squared velocities" } else { "nothing".into() }
}

impl Remainder {
    pub(super) fn new(report: &DiscoverReport, correlations: &[CorrelationFunction]) -> Self {
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
        let test = |test: &crate::discover_report::StructureTest| TestRow {
            name: test.name.clone(),
            statistic: significant(test.statistic, 3),
            p: probability(test.p),
        };
        let figure = |function: &CorrelationFunction| {
            Figure::new(correlation_function(function), function.correlation.meaning())
        };
        Self {
            facts: known.map(|(label, _, text)| (label, text)).collect(),
            tests: rest.tests.iter().map(test).collect(),
            correlations: correlations.iter().map(figure).collect(),
        }
    }
}
