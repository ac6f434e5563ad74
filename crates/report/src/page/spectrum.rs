//! The page of the command `spectrum`.

use schemars::JsonSchema;
use serde::Serialize;

use super::strip::StripFigures;
use super::{Card, Figure, PageHead, Template, render};
use crate::error::ReportError;
use crate::figure::{
    DispersionPart, DispersionPoint, DrawnMode, SpectrumPoint, complex_spectrum, density_of_states,
    dispersion, mode_map,
};
use crate::numbers::{NO_VALUE, significant};
use crate::spectrum_report::{FrameSpectrum, ModeRecord, SpectrumReport};
use crate::units::Units;
use crate::view::FrameView;

const TEMPLATE: Template =
    Template { name: "spectrum.html", source: include_str!("../../templates/spectrum.html") };

/// Everything the page of `spectrum` shows, of the first frame.
#[derive(Debug, Clone)]
pub struct SpectrumPage<'a> {
    /// Title, for example the name of the data set.
    pub title: &'a str,
    /// The answer in one plain sentence.
    pub headline: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// What `report.json` holds.
    pub report: &'a SpectrumReport,
    /// The eigenvalues of the first frame.
    pub points: &'a [SpectrumPoint],
    /// The first frame.
    pub frame: &'a FrameView,
    /// Modes to draw, with captions.
    pub modes: &'a [(DrawnMode, String)],
    /// Waves on the lattice, where asked for.
    pub dispersion: &'a [DispersionPoint],
    /// The strip, where there is one.
    pub strip: Option<StripFigures>,
}

#[derive(Serialize, JsonSchema)]
struct Context<'a> {
    head: PageHead<'a>,
    report: &'a SpectrumReport,
    spectrum: Figure,
    densities: Vec<Figure>,
    modes: Vec<Figure>,
    rows: Vec<Row>,
    dispersion: Vec<Figure>,
    strip: Vec<Figure>,
    rate_unit: String,
}

/// A mode as a line of the table.
#[derive(Serialize, JsonSchema)]
struct Row {
    name: &'static str,
    cells: Vec<String>,
}

impl SpectrumPage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let report = self.report;
        let unit = report.units.powers(0, -1);
        let head = PageHead::sound(
            [self.title, self.headline],
            self.summary,
            report.frames.first().map(|frame| cards(frame, &report.units)).unwrap_or_default(),
            &report.run,
        );
        let context = Context {
            head,
            report,
            spectrum: Figure::new(
                complex_spectrum(self.points, &unit),
                "Each point is a mode u exp(λt). Right of the upright line it grows, left of it it decays. Off the level line it \
                 oscillates: these are odd elastic waves, which come in pairs.",
            ),
            densities: self.densities(&unit),
            modes: self
                .modes
                .iter()
                .map(|(mode, caption)| Figure::new(mode_map(self.frame, mode, &report.units), caption))
                .collect(),
            rows: report.frames.first().map(rows).unwrap_or_default(),
            dispersion: self.dispersion_figures(&unit),
            strip: self.strip.as_ref().map(|own| own.figures(&report.units)).unwrap_or_default(),
            rate_unit: unit,
        };
        render(TEMPLATE, &context)
    }

    fn densities(&self, unit: &str) -> Vec<Figure> {
        let all = self.report.frames.first().is_some_and(|frame| frame.mean_square_frequency.is_some());
        if !all {
            return Vec::new();
        }
        let rates: Vec<f64> = self.points.iter().map(|point| point.rate).collect();
        let frequencies: Vec<f64> =
            self.points.iter().map(|point| point.frequency).filter(|frequency| *frequency > 0.0).collect();
        vec![
            Figure::new(
                density_of_states("density of rates", "rate of growth", unit, &rates),
                "How many modes grow or decay at which rate: a share of all modes per unit of the rate.",
            ),
            Figure::new(
                density_of_states("density of frequencies", "angular frequency", unit, &frequencies),
                "How many of the waves have which frequency, each pair counted once: a share of the waves per unit of \
                 frequency. Modes that do not oscillate are not counted.",
            ),
        ]
    }

    fn dispersion_figures(&self, unit: &str) -> Vec<Figure> {
        if self.dispersion.is_empty() {
            return Vec::new();
        }
        vec![
            Figure::new(
                dispersion(self.dispersion, DispersionPart::Decay, unit),
                "Decay rates of the two waves at each wave vector along the path Γ–K–M–Γ. Below zero a wave grows.",
            ),
            Figure::new(
                dispersion(self.dispersion, DispersionPart::Frequency, unit),
                "Their frequencies. Where both branches leave zero, two modes coalesce: an exceptional point.",
            ),
        ]
    }
}

fn cards(frame: &FrameSpectrum, units: &Units) -> Vec<Card> {
    let [unit, square_unit] = [-1, -2].map(|power| units.powers(0, power));
    let mode = |record: &Option<ModeRecord>, of: fn(&ModeRecord) -> f64| {
        record.as_ref().map_or(NO_VALUE.into(), |mode| format!("{} {unit}", significant(of(mode), 3)))
    };
    let time = |rate: f64| format!("a factor e in {}", significant(1.0 / rate.abs(), 2));
    let growth = frame.largest_growth.as_ref().map_or(String::new(), |mode| time(mode.rate));
    let period = frame.fastest_oscillation.as_ref().map_or("nothing oscillates".into(), |mode| {
        format!("period {}", significant(std::f64::consts::TAU / mode.frequency.abs(), 2))
    });
    let mut cards = vec![
        Card {
            label: "growing modes".into(),
            value: frame.growing.to_string(),
            note: format!("of {}", frame.modes),
        },
        Card {
            label: "waves".into(),
            value: frame.oscillating.to_string(),
            note: "modes that oscillate".into(),
        },
        Card {
            label: "largest rate of growth".into(),
            value: mode(&frame.largest_growth, |m| m.rate),
            note: growth,
        },
        Card {
            label: "highest frequency".into(),
            value: mode(&frame.fastest_oscillation, |mode| mode.frequency),
            note: period,
        },
    ];
    if let Some(square) = frame.mean_square_frequency {
        let scaled = frame.mean_square_frequency_over_k_p;
        cards.push(Card {
            label: "⟨ω²⟩".into(),
            value: format!("{} {}", significant(square, 3), square_unit),
            note: scaled.map_or(String::new(), |scaled| {
                format!("{} K_P²", significant(scaled, 3)).replace("K_P", "Kₚ")
            }),
        });
    }
    cards
}

fn rows(frame: &FrameSpectrum) -> Vec<Row> {
    let text = |value: Option<f64>| value.map_or(NO_VALUE.into(), |value| significant(value, 3));
    let row = |name: &'static str, record: &Option<ModeRecord>| {
        record.as_ref().map(|mode| Row {
            name,
            cells: vec![
                significant(mode.rate, 4),
                significant(mode.frequency, 4),
                text(mode.participation),
                text(mode.longitudinal),
                text(mode.condition),
                text(mode.overlap),
                mode.index.to_string(),
            ],
        })
    };
    [
        row("grows fastest, or decays slowest", &frame.largest_growth),
        row("oscillates fastest", &frame.fastest_oscillation),
        row("nearest to an exceptional point", &frame.exceptional),
    ]
    .into_iter()
    .flatten()
    .collect()
}
