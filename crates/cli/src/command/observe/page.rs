//! The result as a page and as a summary.

use super::avalanches::Found;
use super::curves::figure;
use super::nematic::Measured;
use crate::command::drawing::{borders, cells_view};
use std::fmt::Write as _;
use std::path::Path;
use voronudge_geometry::Vector;
use voronudge_observables::{Curve, Frame, Quantity, Recording};
use voronudge_report::arrows::ArrowScale;
use voronudge_report::figure::{CellScalar, configuration_map};
use voronudge_report::numbers::significant;
use voronudge_report::observe_report::{ObserveReport, ObservedNumber};
use voronudge_report::page::{Block, Card, Figure, Page, Section, Table, Text};
use voronudge_report::{FrameView, Units};

const GUIDE: &[[&str; 2]] = &[
    [
        "Cells that count",
        "In an open field of view a cell counts if its polygon and those of all its neighbours would be the same had cells beyond the border been seen. Only \
         these are measured; structure factors are of the cells in the largest upright rectangle in which every cell would have been seen.",
    ],
    [
        "Errors",
        "Bars are one standard error, by leaving out one sixteenth of the cells at a time, so cells that move together are taken together; of structure factors by \
         the scatter among wave vectors. Points next to each other are not independent.",
    ],
    [
        "Errors of localisation",
        "Positions are taken as they are. Errors of σ_r in each coordinate add 4σ_r² to every mean square displacement, make contacts flicker and make velocities \
         between frames forget each other.",
    ],
    [
        "Hexatic order",
        "ψ = (1/z) Σ exp(6iθ) over the directions to the z neighbours of a cell; Ψ_6 is the modulus of its mean.",
    ],
    [
        "Avalanches",
        "T1 transitions whose cells are the same or next to each other, at most the threshold apart in time, belong together; so do, in bursts of the whole field, all \
         that follow each other. Compare with the same transitions at random times: these have avalanches, too, the larger, the longer the threshold and the more \
         transitions there are.",
    ],
    [
        "Defects",
        "Shapes of cells, smoothed over a Gaussian, have a long axis everywhere but at defects, around which it turns by half a turn: one way (+½, a comet) or the other (−½, three arms). \
         Shapes that know nothing of each other have 1/(4πw²) of them to a unit area, w the width of the Gaussian; fewer are a sign of order.",
    ],
];

pub(super) fn page(
    title: &str,
    report: &ObserveReport,
    recording: &Recording,
    (curves, nematic, avalanches): (&[Curve], &Measured, Option<&Found>),
    units: &Units,
) -> Page {
    let figures = |all: &[Quantity]| -> Vec<Figure> {
        let found = all.iter().filter_map(|of| curves.iter().find(|curve| curve.of == *of));
        found.filter_map(|curve| figure(curve, units)).collect()
    };
    let motion = [
        Quantity::MeanSquareDisplacement,
        Quantity::VelocityAutocorrelation,
        Quantity::VelocityCorrelation,
        Quantity::Vortices,
        Quantity::Compression,
    ];
    let contacts = [
        Quantity::ContactSurvival,
        Quantity::ExchangeWaiting,
        Quantity::ExchangeCorrelation,
        Quantity::ExchangeDirection,
        Quantity::Neighbours,
    ];
    let shapes = [Quantity::ShapeIndex, Quantity::Area];
    let order = [Quantity::PairCorrelation, Quantity::HexaticCorrelation, Quantity::Density];
    let section = |heading: &str, all: &[Quantity]| Section::new(heading).with(Block::pairs(figures(all)));
    let first = recording.frames().first();
    let cells = first.map(|frame| cells(frame, report, units));
    let mut sections = vec![
        Section::new("The cells").with(Block::pairs(cells)),
        section("Motion", &motion),
        section("Neighbours", &contacts),
        section("Shapes", &shapes),
        section("Order", &order),
    ];
    sections.extend(avalanches.map(|found| found.section(units)));
    sections.extend(first.map(|frame| nematic.section(frame, label(report), units)));
    let rows = numbers(report).map(|(of, number)| {
        let [value, error] = [significant(number.value, 3), told(number.standard_error, 1)];
        [capital(of.words()).into(), value.into(), error.into(), Text::plain(&number.unit)]
    });
    let numbers = Table::new(["", "value", "standard error", "unit"]).rows(rows);
    sections.push(Section::new("Numbers").with(Block::table(numbers)));
    Page {
        summary: vec![Block::summary(said(report))],
        cards: cards(report),
        guide: vec![Block::terms(GUIDE)],
        sections,
        ..Page::new(title, headline(report), &report.run)
    }
}

fn numbers(report: &ObserveReport) -> impl Iterator<Item = (Quantity, &ObservedNumber)> {
    Quantity::ALL.into_iter().filter_map(|of| Some((of, report.numbers.get(of.name())?)))
}

fn told(value: f64, digits: usize) -> String {
    if value.is_finite() { significant(value, digits) } else { "–".into() }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn headline(report: &ObserveReport) -> String {
    let value = |of: Quantity| report.numbers.get(of.name()).map(|number| number.value);
    let shape = value(Quantity::MeanShapeIndex)
        .map_or_else(String::new, |value| format!("Cells have a shape index of {}", significant(value, 4)));
    match (value(Quantity::MeanSquareVelocity), value(Quantity::TransitionRate)) {
        (Some(square), Some(rate)) => format!(
            "{shape}, move at {} (root mean square) and exchange {} contacts per cell and {}.",
            format_args!("{} {}", significant(square.sqrt(), 3), report.units.velocity_text()),
            significant(rate, 2),
            if report.units.time.is_empty() { "unit of time".into() } else { report.units.time_text() }
        ),
        (Some(square), None) => format!(
            "{shape} and move at {} {} (root mean square).",
            significant(square.sqrt(), 3),
            report.units.velocity_text()
        ),
        _ => format!("{shape}."),
    }
}

fn said(report: &ObserveReport) -> String {
    let range = |all: &[usize]| match (all.iter().min(), all.iter().max()) {
        (Some(low), Some(high)) if low != high => format!("{low} to {high}"),
        (Some(one), _) => one.to_string(),
        _ => "no".into(),
    };
    let frames = match report.frames.len() {
        1 => "one frame".to_owned(),
        more => format!("{more} frames"),
    };
    let velocities = match report.velocities {
        "given" => " Velocities are those given.",
        "from_positions" => " Velocities are displacements until the next frame.",
        _ => "",
    };
    let stage = if report.common_motion_removed {
        " The median motion of the cells is taken for one of the stage."
    } else {
        ""
    };
    format!(
        "{} cells in {frames}, of which {} count.{velocities}{stage}",
        range(&report.seen),
        range(&report.counted)
    )
}

fn cards(report: &ObserveReport) -> Vec<Card> {
    let of = [
        (Quantity::MeanSquareVelocity, "⟨v²⟩"),
        (Quantity::TransitionRate, "T1 transitions"),
        (Quantity::MeanShapeIndex, "shape index"),
        (Quantity::HexaticOrder, "hexatic order Ψ_6"),
    ];
    let card = |(of, label): (Quantity, &str)| {
        let number = report.numbers.get(of.name())?;
        let note = if number.standard_error.is_finite() {
            format!("± {}", significant(number.standard_error, 1))
        } else {
            "mean over frames".into()
        };
        let value = format!("{} {}", significant(number.value, 3), number.unit);
        Some(Card::new(label, value.trim_end(), note))
    };
    of.into_iter().filter_map(card).collect()
}

fn label(report: &ObserveReport) -> String {
    format!("frame {}", report.frames.first().copied().unwrap_or(0))
}

/// The cells of a frame, with their velocities.
fn cells(frame: &Frame, report: &ObserveReport, units: &Units) -> Figure {
    let mut view: FrameView =
        cells_view(label(report), &frame.tessellation, &frame.positions, |cell| frame.counted[cell]);
    for (cell, v) in view.cells.iter_mut().zip(&frame.velocities) {
        cell.measured = v.map(|v: Vector<f64>| [v.x, v.y]);
    }
    view.region = borders(frame.region.as_ref(), 1.0);
    let arrows = ArrowScale::velocities(std::slice::from_ref(&view));
    let shape = CellScalar::shape_index(&view);
    let caption =
        "The cells of the first frame, those that count coloured by shape index, with their velocities.";
    Figure::new(configuration_map(&view, &shape, arrows.as_ref(), units), caption)
}

/// What is printed.
pub(super) fn summary(report: &ObserveReport, out: &Path) -> String {
    let mut text = format!("{}\n\n", said(report));
    for (of, number) in numbers(report) {
        let error = if number.standard_error.is_finite() {
            format!("± {}", significant(number.standard_error, 1))
        } else {
            String::new()
        };
        let line =
            format!("  {:38}{:>10} {error:10} {}", of.words(), significant(number.value, 3), number.unit);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    let _ = writeln!(text, "\n{}", headline(report));
    let _ = writeln!(text, "figures in {}", out.join("report.html").display());
    text
}
