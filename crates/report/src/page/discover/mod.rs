//! The page of the command `discover`.

mod answer;
mod before_after;
mod candidates;
mod check;
mod effects;
mod forecast;
mod remainder;

use serde::Serialize;

use self::answer::{Answer, answers};
use self::before_after::{Comparison, NoiseRow, ParameterComparison, PredictionRow};
use self::candidates::{CandidateRow, ranking_figure};
use self::check::CheckView;
use self::effects::{EffectView, coefficient_figure};
use self::forecast::ForecastView;
use self::remainder::Remainder;
use super::directions::{Directions, directions};
use super::player::Player;
use super::prospects::ProspectsView;
use super::spreads::SpreadView;
use super::words::{self, listed, percent};
use super::{Columns, Figure, PageHead, Panel, Template, render};
use crate::arrows::ArrowScale;
use crate::before_after::BeforeAfter;
use crate::discover_report::DiscoverReport;
use crate::error::ReportError;
use crate::figure::{
    CorrelationFunction, FlowMap, Outlier, PartialRegression, noise_budget, outlier_map, polarity_map,
    residual_flow_maps, residual_maps,
};
use crate::many_cells::Squares;
use crate::movie::CellMovie;
use crate::numbers::significant;
use crate::view::FrameView;

const TEMPLATE: Template =
    Template { name: "discover.html", source: include_str!("../../../templates/discover.html") };

/// Everything the page of `discover` shows.
#[derive(Debug, Clone, Copy)]
pub struct DiscoverPage<'a> {
    /// Title, for example the name of the data set.
    pub title: &'a str,
    /// What `report.json` holds.
    pub report: &'a DiscoverReport,
    /// The frames to draw, with the velocities that the two models predict.
    pub frames: &'a [BeforeAfter<FrameView>],
    /// Their velocities, one entry for each frame, where these are on a grid; empty otherwise.
    pub flows: &'a [BeforeAfter<FlowMap<'a>>],
    /// What the figures show beyond the report.
    pub figures: &'a DiscoverFigures,
}

/// What the figures of the page show beyond the report. What is empty is not drawn.
#[derive(Debug, Clone, Default)]
pub struct DiscoverFigures {
    /// The cells of all frames, with their residuals before and after, if there are any.
    pub movie: Option<CellMovie>,
    /// Correlation functions of the residual.
    pub correlations: Vec<CorrelationFunction>,
    /// Partial regression plots of selected effects.
    pub regressions: Vec<PartialRegression>,
    /// Deviations of the cells in each parameter in which they differ.
    pub spreads: Vec<SpreadView>,
    /// Where cells went, measured and in movies of the models, if there are such.
    pub trails: Option<Figure>,
    /// Suspicious cells, one list for each frame drawn; shorter if the last frames have none.
    pub outliers: Vec<Vec<Outlier>>,
}

#[derive(Serialize)]
struct Context<'a> {
    head: PageHead<'a>,
    report: &'a DiscoverReport,
    verdict: &'static str,
    meaning: &'static str,
    data: &'static str,
    mean_removed: &'static str,
    answers: Vec<Answer>,
    is_extended: bool,
    added: String,
    comparison: Comparison,
    forecast: Option<ForecastView>,
    check: Option<CheckView>,
    player: Option<Player>,
    panels: Vec<Panel>,
    effects: Vec<EffectView>,
    spreads: Vec<Figure>,
    coefficients: Option<Figure>,
    ranking_figure: Option<Figure>,
    candidates: Vec<CandidateRow>,
    remainder: Remainder,
    budget: Option<Figure>,
    budget_total: String,
    noise: Vec<NoiseRow>,
    parameters: Vec<ParameterComparison>,
    directions: Directions,
    prospects: Option<ProspectsView>,
    predictions: Vec<PredictionRow>,
    likelihood_gain: Option<String>,
    single_p: String,
    false_positives: String,
}

impl DiscoverPage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let report = self.report;
        let doubts = report.doubts();
        let head = PageHead {
            title: self.title,
            headline: &report.sentence,
            summary: &[],
            doubts: &doubts,
            warnings: words::warnings(&report.run, &doubts),
            cards: Vec::new(),
            run: &report.run,
        };
        let calibration = report.calibration.as_ref();
        let context = Context {
            head,
            report,
            verdict: report.verdict.name(),
            meaning: report.verdict.meaning(),
            data: words::data(report.flow.as_ref()),
            mean_removed: words::mean_removed(report.models.before.nmse.mean_removed),
            answers: answers(report),
            is_extended: report.is_extended(),
            added: self.added(),
            comparison: Comparison::new(report),
            forecast: report.forecast.as_ref().map(ForecastView::new),
            check: report.check.as_ref().map(|check| CheckView::new(check, self.figures.trails.as_ref())),
            player: self.player()?,
            panels: self.panels(),
            effects: effects::views(report, &self.figures.regressions),
            spreads: self.figures.spreads.iter().map(SpreadView::histogram).collect(),
            coefficients: coefficient_figure(report),
            ranking_figure: ranking_figure(report),
            candidates: candidates::rows(report),
            remainder: Remainder::new(report, &self.figures.correlations),
            budget: self.budget(),
            budget_total: self.budget_total(),
            noise: before_after::noise_rows(report),
            parameters: before_after::parameters(report),
            directions: directions(&report.models.after.identifiability),
            prospects: ProspectsView::new(report.prospects.as_ref()),
            predictions: before_after::predictions(report),
            likelihood_gain: report
                .likelihood_gain
                .filter(|gain| gain.value.is_finite())
                .map(|gain| words::with_error(gain.value, gain.standard_error)),
            single_p: calibration.map_or_else(String::new, |found| words::probability(found.single_p)),
            false_positives: calibration
                .map_or_else(String::new, |found| percent(found.unadjusted_false_positives)),
        };
        render(TEMPLATE, &context)
    }

    /// The selected effects in words.
    fn added(&self) -> String {
        listed(self.report.selected.iter().map(|effect| &effect.effect), "and")
    }

    fn player(&self) -> Result<Option<Player>, ReportError> {
        let caption = match self.report.is_extended() {
            true => format!(
                "Cells where they were seen, and what the base model leaves of their velocities, before and after adding {}.",
                self.added()
            ),
            false => "Cells where they were seen, and what the base model leaves of their velocities.".into(),
        };
        let player = |movie: &CellMovie| Player::new(movie, &Figure::new(movie.still(), &caption));
        self.figures.movie.as_ref().map(player).transpose()
    }

    /// One panel of maps for each frame: residuals before and after, and suspicious cells.
    fn panels(&self) -> Vec<Panel> {
        let units = &self.report.units;
        let (frames, squares): (Vec<FrameView>, Vec<Squares>) =
            self.frames.iter().map(|frames| Squares::of(&frames.before)).unzip();
        let cells = ArrowScale::residuals(&frames);
        let polarities = ArrowScale::velocities(&frames);
        let grid = FlowMap::residual_scale(self.flows.iter().map(|flows| &flows.before));
        let panel = |(index, whole): (usize, &BeforeAfter<FrameView>)| {
            let (before, squares) = (&frames[index], &squares[index]);
            let drawn = BeforeAfter { before: before.clone(), after: Squares::of(&whole.after).0 };
            let on_grid = self.flows.get(index);
            let maps = match on_grid {
                Some(flows) => residual_flow_maps(flows, grid.as_ref(), units),
                None => residual_maps(&drawn, cells.as_ref(), units),
            };
            let averaged =
                |caption: &str| if on_grid.is_some() { caption.to_owned() } else { squares.caption(caption) };
            let which = if self.report.is_extended() { "before: " } else { "" };
            let caption = format!("{which}what the base model leaves unexplained");
            let mut figures = vec![Figure::new(maps.before, &averaged(&caption))];
            if self.report.is_extended() {
                let caption = format!("after adding {}, arrows on the same scale", self.added());
                figures.push(Figure::new(maps.after, &averaged(&caption)));
            }
            if self.report.selected.iter().any(|own| own.effect == "polarity") {
                let map = polarity_map(&drawn.after, polarities.as_ref(), units);
                figures.push(Figure::new(map, &squares.caption(words::POLARITIES)));
            }
            let spreads = self.figures.spreads.iter();
            figures.extend(spreads.map(|spread| spread.drawn_on((before, squares), index, units)));
            if let Some(outliers) = self.figures.outliers.get(index).filter(|found| !found.is_empty()) {
                figures.push(Figure::new(
                    outlier_map(&whole.before, outliers, units),
                    "cells that may be merged, split or mis-tracked; look at them in the images",
                ));
            }
            let cells = whole.before.cells.len();
            Panel { label: whole.before.label.clone(), figures, columns: Columns::for_cells(cells) }
        };
        self.frames.iter().enumerate().map(panel).collect()
    }

    fn budget(&self) -> Option<Figure> {
        let budget = &self.report.noise_budget;
        if !budget.before.is_known() {
            return None;
        }
        let mut bars = vec![("base model", budget.before)];
        if self.report.is_extended() {
            bars.push(("with effects", budget.after));
        }
        Some(Figure::new(
            noise_budget(&bars),
            "Where the squared velocities go. Noise of positions counts because the forces of the model depend \
             sensitively on positions.",
        ))
    }

    fn budget_total(&self) -> String {
        let units = &self.report.units;
        let unit = units.powers(2, -2);
        format!("{} {unit}", significant(self.report.noise_budget.before.total, 3))
    }
}
