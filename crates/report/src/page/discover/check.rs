//! Whether movies that the models make are like the measured one.

use serde::Serialize;

use super::super::Figure;
use super::super::words::probability;
use crate::chart::AxisScale;
use crate::colour::{BLUE, VERMILLION};
use crate::discover_report::{CheckReport, CheckedQuantity};
use crate::figure::{SimulatedBand, among_simulated};
use crate::units::label_with_unit;

/// Functions that are drawn where nothing differs: the others are in the table alone.
const ALWAYS: [&str; 3] = ["mean_square_displacement", "velocity_autocorrelation", "velocity_correlation"];

/// Below it a function is drawn.
const UNUSUAL: f64 = 0.05;

/// The section of the page.
#[derive(Serialize)]
pub(super) struct CheckView {
    trails: Option<Figure>,
    figures: Vec<Figure>,
    columns: Vec<&'static str>,
    rows: Vec<(String, Vec<String>)>,
}

impl CheckView {
    pub fn new(report: &CheckReport, trails: Option<&Figure>) -> Self {
        let mut rows: Vec<(String, Vec<String>)> =
            vec![("all together".into(), report.p.named().map(|(_, p)| probability(*p)).collect())];
        rows.extend(report.quantities.iter().map(|own| {
            (own.words.to_owned(), own.simulated.named().map(|(_, model)| probability(model.p)).collect())
        }));
        let unusual = |own: &&CheckedQuantity| {
            ALWAYS.contains(&own.name) || own.simulated.named().any(|(_, model)| model.p < UNUSUAL)
        };
        let curves = report.quantities.iter().filter(|own| !own.axis.is_empty()).filter(unusual);
        Self {
            trails: trails.cloned(),
            figures: curves.map(figure).collect(),
            columns: report.p.named().map(|(name, _)| name).collect(),
            rows,
        }
    }
}

fn figure(own: &CheckedQuantity) -> Figure {
    let bands: Vec<SimulatedBand<'_>> = own
        .simulated
        .named()
        .map(|(label, model)| SimulatedBand {
            label,
            colour: if label == "base model" { BLUE } else { VERMILLION },
            at: &own.at,
            low: &model.low,
            median: &model.median,
            high: &model.high,
        })
        .collect();
    let measured: Vec<[f64; 2]> = own.at.iter().zip(&own.measured).map(|(x, y)| [*x, *y]).collect();
    let scales = match own.name {
        "mean_square_displacement" => [AxisScale::Logarithmic; 2],
        "longitudinal_structure_factor" | "transverse_structure_factor" => {
            [AxisScale::Linear, AxisScale::Logarithmic]
        }
        _ => [AxisScale::Linear; 2],
    };
    let labels = [label_with_unit(own.axis, &own.axis_unit), label_with_unit(own.words, &own.unit)];
    let svg = among_simulated(own.words, [&labels[0], &labels[1]], scales, &measured, &bands);
    let told: Vec<String> =
        own.simulated.named().map(|(name, model)| format!("{name} p {}", probability(model.p))).collect();
    let words = own.words;
    Figure::new(svg, &format!("{}{}: {}.", words[..1].to_uppercase(), &words[1..], told.join(", ")))
}
