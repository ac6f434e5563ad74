//! The page of the command `infer`.

mod figures;

use super::parameter_table::{activity_rows, cells_of, parameter_rows, value_and_interval};
use super::spreads::SpreadView;
use super::uncertainty::{Uncertainty, known};
use super::words::{data, fit_status, left_out, mean_removed, noise_source};
use super::{Block, Card, Figure, Page, Section, Table, Text, kinds, prospects};
use crate::error::ReportError;
use crate::figure::{FlowMap, ParameterRow};
use crate::infer_report::InferReport;
use crate::movie::CellMovie;
use crate::numbers::{NO_VALUE, significant};
use crate::units::unit_text;
use crate::view::FrameView;

const INTRODUCTION: &str = "The model says that each cell resists changes of its area (K_A) and of the length of its outline (K_P, preferred length P_0), and that \
    the force of the outline has a part turned by a right angle (chirality α). From these forces follows a velocity for every cell. The fit looks for the parameters \
    whose velocities come closest to those measured.";

const GUIDE: [[&str; 2]; 5] = [
    [
        "NMSE, normalised mean square error",
        "The share of the squared velocities that the model does not explain: 0 is a perfect prediction, 1 is as good as predicting no motion at all, above 1 is worse \
         than that. Trust the cross-validated number most: it is for cells whose velocities the fit has not seen. The number after nudging is always too good, because \
         the nudges were chosen with these velocities.",
    ],
    [
        "Nudges",
        "Measured cell positions are a little wrong (segmentation, pixels, nuclei that are not in the middle of the cell), and forces depend sensitively on positions. \
         So the fit may shift every cell slightly, against a spring: large shifts cost more the more precise the positions are said to be. Nudges should look random and \
         be no larger than the position error you believe in. Nudges that line up over many cells hint at something that the model lacks.",
    ],
    ["Naive fit", "The same fit without nudges. Position errors bias it; it stands here for comparison."],
    [
        "95 % interval",
        "The values that the data cannot exclude, if the model is right. If the interval of K_Pα contains zero, these data neither show nor exclude chirality.",
    ],
    [
        "If the model explains little or nothing",
        "A cross-validated NMSE near or above 1 does not mean that the cells do nothing: it means that the motion measured here has other causes (drift, crawling, \
         divisions), or is hidden by noise. Then the parameters above describe nothing and should not be quoted.",
    ],
];

/// What the cells of all frames are.
const CELLS: &str = "Cells where they were seen, with what the fit makes of them. The residual is what the model leaves of the \
                     measured velocity.";

/// Everything the page of `infer` shows.
#[derive(Debug, Clone, Copy)]
pub struct InferPage<'a> {
    /// Title, for example the name of the data set.
    pub title: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// What `report.json` holds.
    pub report: &'a InferReport,
    /// The frames to draw; each adds about 0.5 kB per cell to the page.
    pub frames: &'a [FrameView],
    /// The cells of all frames, if there are any.
    pub movie: Option<&'a CellMovie>,
    /// Velocities of the frames to draw, one map for each frame, where these are on a grid; empty otherwise.
    pub flows: &'a [FlowMap<'a>],
    /// Deviations of the cells in each parameter in which they may differ; empty if they may not.
    pub spreads: &'a [SpreadView],
    /// What was asked beyond the fit.
    pub uncertainty: &'a Uncertainty,
}

impl InferPage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`] if the movie cannot be written, [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        self.page()?.render()
    }

    /// The page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`] if the movie cannot be written.
    pub fn page(&self) -> Result<Page, ReportError> {
        let report = self.report;
        let rows = parameter_rows(&report.parameters, Some(&report.naive));
        let player = self.movie.map(|movie| Block::player(movie, &Figure::new(movie.still(), CELLS)));
        Ok(Page {
            summary: self.summary.iter().map(Block::summary).collect(),
            doubts: report.fit.doubts.clone(),
            cards: cards(report, &rows),
            guide: vec![Block::paragraph(INTRODUCTION), Block::terms(&GUIDE)],
            sections: vec![
                parameters(report, &rows),
                kinds::section(&report.by_label),
                self.goodness(),
                known(report, &rows, self.uncertainty),
                what_to_measure(report),
                Section::new("The cells").with_all(player.transpose()?),
                self.frame_by_frame(),
                self.cells_that_differ(),
                self.noise(),
                left_out(&report.cells, data(report.flow.as_ref())),
            ],
            ..Page::new(self.title, &report.verdict.sentence, &report.run)
        })
    }

    fn goodness(&self) -> Section {
        let fits = Block::group("stack", [self.error_figure(), self.trace_figure()]);
        Section::new("How well it fits")
            .with(Block::paragraph(course(self.report)))
            .with(Block::group("beside", [fits, self.scatter_figure().into()]))
    }

    fn frame_by_frame(&self) -> Section {
        let panels = self.panels();
        Section::new("Frame by frame").with(match panels.is_empty() {
            true => Block::paragraph("No frame was drawn."),
            false => Block::Tabs { panels },
        })
    }

    fn cells_that_differ(&self) -> Section {
        let section = Section::new("Cells that differ");
        if self.spreads.is_empty() {
            return section;
        }
        let words = self.report.spreads.iter().map(|spread| [Text::plain(&spread.words)]);
        section
            .with(Block::Table(Table::plain(words).without_names()))
            .with(Block::group("beside", self.spreads.iter().map(SpreadView::histogram)))
    }

    fn noise(&self) -> Section {
        let InferReport { noise, nudge, units, .. } = self.report;
        let source = noise_source(noise.source);
        let [length, velocity, square_rate] = [(1, 0), (1, -1), (0, -2)].map(|(l, t)| units.powers(l, t));
        let number = |value: f64| significant(value, 3);
        let facts = [
            ("position noise σ_r", format!("{} {length} per component, {source}", number(noise.sigma_r))),
            ("velocity noise σ_v", format!("{} {velocity} per component, {source}", number(noise.sigma_v))),
            ("spring constant k = σ_v²/σ_r²", format!("{} {square_rate}", number(nudge.k))),
            ("root mean square nudge", format!("{} {length}", number(nudge.rms))),
            ("degrees of freedom used by nudges", number(nudge.degrees_of_freedom)),
            (
                "contribution of nudges over that of velocities",
                format!(
                    "{}; {} is expected",
                    number(nudge.contribution_ratio),
                    number(nudge.expected_contribution_ratio)
                ),
            ),
            ("contacts changed by nudges", nudge.edges_changed.to_string()),
        ];
        let facts = Block::facts(facts.map(|(name, text)| [Text::from(name), Text::plain(&text)]));
        Section::new("Noise and nudges").with(Block::group("beside", [facts, self.nudge_figure().into()]))
    }
}

/// The table of parameters, grey where they say nothing.
fn parameters(report: &InferReport, rows: &[ParameterRow]) -> Section {
    let header = [
        ("", ""),
        ("value", ""),
        ("95 % interval", "interval"),
        ("unit", "unit"),
        ("naive fit", "quiet"),
        ("meaning", "text"),
    ];
    let activity = report.activity.as_ref().map(activity_rows).unwrap_or_default();
    let cells = |row: &ParameterRow| {
        let [symbol, value, interval, unit] = cells_of(row);
        let naive = row.naive.map_or_else(|| NO_VALUE.to_owned(), |naive| significant(naive, 3));
        [symbol, value, interval, unit, naive.into(), Text::plain(&row.meaning)]
    };
    let table = Table::new(header).class("parameters fitted").rows(rows.iter().chain(&activity).map(cells));
    let (is_finding, section) = (report.verdict.kind.is_finding(), Section::new("Parameters"));
    let grey = "Grey, because the model explains nothing of this motion: these numbers are no findings.";
    section
        .with_all((!is_finding).then(|| Block::paragraph(grey)))
        .with(Block::group(if is_finding { "scroll" } else { "scroll void" }, [Block::Table(table)]))
        .with(Block::remark(format!(
            "{} The preferred area A_0 is not listed: no velocity depends on it.",
            cell_size(report)
        )))
}

/// How the fit went.
fn course(report: &InferReport) -> String {
    let fit = &report.fit;
    let number = |value: f64| significant(value, 4);
    let flips = match fit.transitions.tried {
        0 => String::new(),
        tried => format!(" Of {tried} flips of contacts tried, {} were kept.", fit.transitions.made),
    };
    let starts = match fit.starts.len() {
        0 | 1 => String::new(),
        count => {
            let ends = [f64::min, f64::max].map(|of| fit.starts.iter().copied().fold(f64::NAN, of));
            let [low, high] = ends.map(number);
            format!(" {count} starts ended at objectives from {low} to {high}.")
        }
    };
    format!(
        "The fit {} after {} iterations with an objective of {}; about {} is expected of a model that is right.{flips}{starts} For the errors, {}.",
        fit_status(fit.status),
        fit.iterations,
        number(fit.objective),
        number(fit.expected_objective),
        mean_removed(report.nmse.mean_removed)
    )
}

fn what_to_measure(report: &InferReport) -> Section {
    let section = Section::new("What to measure next");
    match &report.prospects {
        Some(own) if !own.quantities.is_empty() => {
            section.with(Block::paragraph(&own.words)).with_all(prospects::blocks(own))
        }
        _ => section,
    }
}

/// What ℓ₀ is in the units of the data, unless that is the unit of length itself.
fn cell_size(report: &InferReport) -> String {
    let scale = &report.length_scale;
    let size = significant(scale.value, 3);
    match (scale.unit.as_str(), size.as_str()) {
        ("ℓ₀" | "l_0", "1.00") => {
            "Lengths are in units of the cell size ℓ_0: ℓ_0² is the mean area of the cells.".into()
        }
        ("ℓ₀" | "l_0", _) => format!(
            "Lengths are in units of the ℓ_0 of the data set; the square root of the mean area of the cells used is {size} of it."
        ),
        (unit, _) => {
            let unit = unit_text(unit);
            format!("The cell size is ℓ_0 = {size} {unit} (ℓ_0² is the mean area of the cells used).")
        }
    }
}

fn cards(report: &InferReport, rows: &[ParameterRow]) -> Vec<Card> {
    let parameter = |row: &ParameterRow| {
        let [value, interval] = value_and_interval(row);
        let value = match row.value.is_finite() {
            true => format!("{value} {}", unit_text(&row.unit)),
            false => NO_VALUE.to_owned(),
        };
        let note = match row.interval() {
            Some(_) => format!("95 %: {interval}"),
            None => interval,
        };
        Card::new(&row.symbol, value.trim_end(), note)
    };
    // What explains nothing has no key parameters.
    let shown = if report.verdict.kind.is_finding() { 3 } else { 0 };
    let mut cards: Vec<Card> = rows.iter().take(shown).map(parameter).collect();
    let (nmse, note) = match report.nmse.cross_validated {
        Some(nmse) => (nmse, "cross-validated; 1 predicts nothing"),
        None => (report.nmse.un_nudged, "at measured positions; 1 predicts nothing"),
    };
    cards.push(Card::new("NMSE", significant(nmse, 2), note));
    let frames = match report.cells.frames.len() {
        1 => "1 frame".to_owned(),
        count => format!("{count} frames"),
    };
    let note = format!("used in {frames}; {} left out", report.cells.left_out.values().sum::<usize>());
    cards.push(Card::new(data(report.flow.as_ref()), report.cells.used.to_string(), note));
    cards
}
