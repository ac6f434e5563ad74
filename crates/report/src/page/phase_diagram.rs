//! The page of the commands `phase-diagram` and `merge`.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Card, Figure, PageHead, Template, render};
use crate::error::ReportError;
use crate::numbers::{as_given, significant};
use crate::phase_report::PhaseReport;

const TEMPLATE: Template =
    Template { name: "phase-diagram.html", source: include_str!("../../templates/phase-diagram.html") };

/// Everything the page of `phase-diagram` shows.
#[derive(Debug, Clone, Copy)]
pub struct PhasePage<'a> {
    /// Title of the page.
    pub title: &'a str,
    /// The answer in one plain sentence.
    pub headline: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// What `report.json` holds.
    pub report: &'a PhaseReport,
    /// Maps of the quantities.
    pub maps: &'a [Figure],
    /// The collapse with given and with fitted exponents, if there is one.
    pub collapse: &'a [Figure],
}

#[derive(Serialize, JsonSchema)]
struct Context<'a> {
    head: PageHead<'a>,
    report: &'a PhaseReport,
    maps: &'a [Figure],
    collapse: &'a [Figure],
}

impl PhasePage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let report = self.report;
        let [columns, rows] = [report.preferred_perimeters.len(), report.chiralities.len()];
        let card = |label: &str, value: String, note: String| Card { label: label.into(), value, note };
        let mut cards = vec![
            card(
                "points",
                format!("{columns} × {rows}"),
                match report.replicas {
                    1 => "one run each".into(),
                    replicas => format!("{replicas} runs each"),
                },
            ),
            card("cells", report.cells.to_string(), "periodic square box".into()),
            card("duration of a run", format!("{} / K_P", as_given(report.time)).replace("K_P", "Kₚ"), {
                let [low, high] = report.steps.map(|step| as_given((step * 1e4).round() / 1e4));
                if low == high { format!("steps of {low}") } else { format!("steps of {low} to {high}") }
            }),
        ];
        if let Some(collapse) = &report.collapse {
            let fitted = collapse.fitted;
            cards.push(card(
                "scaling exponents",
                format!(
                    "β = {}, φ = {}",
                    significant(fitted.beta.value, 2),
                    significant(fitted.phi.value, 2)
                ),
                format!("fitted; scatter {} in ln ⟨v²⟩", significant(fitted.scatter, 2)),
            ));
        }
        let head = PageHead::sound([self.title, self.headline], self.summary, cards, &report.run);
        render(TEMPLATE, &Context { head, report, maps: self.maps, collapse: self.collapse })
    }
}
