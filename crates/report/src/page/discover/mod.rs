//! The page of the command `discover`.

mod answer;
mod before_after;
mod candidates;
mod check;
mod effects;
mod forecast;
mod remainder;
mod search;

use super::spreads::SpreadView;
use super::words::{self, listed};
use super::{Block, Figure, Page, Panel, Section, Text, prospects};
use crate::arrows::ArrowScale;
use crate::before_after::BeforeAfter;
use crate::discover_report::DiscoverReport;
use crate::error::ReportError;
use crate::figure::{
    CorrelationFunction, FlowMap, Outlier, PartialRegression, outlier_map, polarity_map, residual_flow_maps,
    residual_maps,
};
use crate::many_cells::Squares;
use crate::movie::CellMovie;
use crate::view::FrameView;

const INTRODUCTION: &str = "The base model says that each cell resists changes of its area and of the length of its outline, and that the force of the outline has a part \
    turned by a right angle (chirality α). The program fits it, looks at the velocities that it does not explain, and asks of each candidate effect in a list whether it \
    explains them. An effect is added only if it stands out against all other candidates and against made-up data in which nothing is missing. Then everything is fitted \
    again and compared on data that the fit has not seen.";

const GUIDE: [[&str; 2]; 6] = [
    [
        "NMSE, the error",
        "The share of the squared velocities that a model does not explain: 0 is a perfect prediction, 1 is as good as predicting no motion at all. Only the error on data \
         held out says whether an added effect helps; the error of the fit itself falls with every effect, needed or not.",
    ],
    [
        "What noise alone leaves",
        "Positions and velocities are measured with errors. Even the true model could not bring the error below this line.",
    ],
    [
        "Detection limit",
        "How large an effect has to be to be found in these data. An effect below its limit may well be there.",
    ],
    [
        "Alias",
        "Two effects are aliases if they push the cells measured here in nearly the same way. The data cannot tell which of them it is, whatever the size; another \
         measurement can.",
    ],
    [
        "Adjusted p",
        "How often the best of all candidates would look at least as good by chance if nothing were missing. It accounts for the number of candidates tried.",
    ],
    [
        "Description",
        "A smooth field that follows the residual wherever it goes. It says how much could be explained, not by what; it is never named as a mechanism.",
    ],
];

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

impl DiscoverPage<'_> {
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
        let Self { report, figures, .. } = *self;
        let forecast = report.forecast.as_ref().map(forecast::section);
        let check = report.check.as_ref().map(|own| check::section(own, figures.trails.as_ref()));
        let prospects = report.prospects.iter().filter(|own| !own.quantities.is_empty());
        Ok(Page {
            summary: self.lead(),
            doubts: report.doubts(),
            guide: vec![Block::paragraph(INTRODUCTION), Block::terms(&GUIDE)],
            sections: vec![
                before_after::errors(report),
                forecast.unwrap_or_default(),
                check.unwrap_or_default(),
                before_after::predictions(report),
                self.what_is_left(),
                Section::new("The cells").with_all(self.player()?),
                effects::section(report, &figures.regressions, &figures.spreads),
                candidates::section(report),
                remainder::section(report, &figures.correlations),
                before_after::noise(report),
                before_after::parameters(report),
                Section::new("What another measurement would tell")
                    .with_all(prospects.flat_map(prospects::blocks)),
                search::section(report),
                words::left_out(&report.cells, words::data(report.flow.as_ref())),
            ],
            ..Page::new(self.title, &report.sentence, &report.run)
        })
    }

    /// The answer at a glance.
    fn lead(&self) -> Vec<Block> {
        let DiscoverReport { caveat, measure_next, verdict, .. } = self.report;
        let mut blocks = vec![answer::answers(self.report)];
        if !caveat.is_empty() {
            blocks.push(Block::of_class("caveat", Text::prose(caveat)));
        }
        if !measure_next.is_empty() {
            let next = Text::bold("What to measure next:") + " " + Text::prose(measure_next);
            blocks.push(Block::of_class("next", next));
        }
        blocks.push(Block::remark(Text::marked("verdict", verdict.name()) + " " + verdict.meaning()));
        blocks
    }

    /// The selected effects in words.
    fn added(&self) -> String {
        listed(self.report.selected.iter().map(|effect| &effect.effect), "and")
    }

    fn player(&self) -> Result<Option<Block>, ReportError> {
        let and_after = match self.report.is_extended() {
            true => format!(", before and after adding {}", self.added()),
            false => String::new(),
        };
        let caption = format!(
            "Cells where they were seen, and what the base model leaves of their velocities{and_after}."
        );
        let player = |movie: &CellMovie| Block::player(movie, &Figure::new(movie.still(), &caption));
        self.figures.movie.as_ref().map(player).transpose()
    }

    fn what_is_left(&self) -> Section {
        let panels = self.panels();
        let and_after = if self.report.is_extended() { ", before and after" } else { "" };
        let section = Section::new(format!("What is left of the motion{and_after}"));
        if panels.is_empty() {
            return section;
        }
        section
            .with(Block::paragraph(
                "Measured velocity minus what the model predicts. Arrows that look random are what noise leaves; arrows that line up over several cells are something that \
                 the model lacks.",
            ))
            .with(Block::Tabs { panels })
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
            Panel::new(&whole.before.label, whole.before.cells.len(), figures)
        };
        self.frames.iter().enumerate().map(panel).collect()
    }
}
