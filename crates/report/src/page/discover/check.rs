//! Whether movies that the models make are like the measured one.

use super::super::words::probability;
use super::super::{Block, Figure, Row, Section, Table, Text};
use crate::chart::AxisScale;
use crate::colour::{BLUE, VERMILLION};
use crate::discover_report::{CheckReport, CheckedQuantity};
use crate::figure::{SimulatedBand, among_simulated};
use crate::units::label_with_unit;

/// Functions that are drawn where nothing differs: the others are in the table alone.
const ALWAYS: [&str; 3] = ["mean_square_displacement", "velocity_autocorrelation", "velocity_correlation"];

/// Below it a function is drawn.
const UNUSUAL: f64 = 0.05;

/// The section of the page; `trails` are where cells went.
pub(super) fn section(report: &CheckReport, trails: Option<&Figure>) -> Section {
    let row = |name: &str, p: Vec<f64>| -> Row {
        [name.to_owned()].into_iter().chain(p.into_iter().map(probability)).collect()
    };
    let together = row("all together", report.p.named().map(|(_, p)| *p).collect());
    let each = report.quantities.iter().map(|own| {
        let p = own.simulated.named().map(|(_, model)| model.p);
        row(own.words, p.collect())
    });
    let header = ["p"].into_iter().chain(report.p.named().map(|(name, _)| name));
    let table = Table::new(header).class("").row(together).rows(each);
    let unusual = |own: &&CheckedQuantity| {
        ALWAYS.contains(&own.name) || own.simulated.named().any(|(_, model)| model.p < UNUSUAL)
    };
    let curves = report.quantities.iter().filter(|own| !own.axis.is_empty()).filter(unusual);
    Section::new("What the models make of the cells")
        .with(Block::paragraph(Text::prose(&report.words)))
        .with(Block::remark(format!(
            "From a frame near the beginning each model goes on by itself for as long as the movie, {} times with other noise; cells come, go and are missed as they did, \
             and those at the rim are led as they went. Bands hold nine of ten simulated movies; p is the share of movies that are as unusual as the measured one: a small p \
             says that the model does not make such cells.",
            report.draws
        )))
        .with_all(trails.cloned())
        .with(Block::group("beside", curves.map(figure)))
        .with(Block::Fold {
            summary: "Everything that was compared".into(),
            blocks: vec![Block::table(table)],
        })
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
