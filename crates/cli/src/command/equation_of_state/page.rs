//! The equation of state as a page and as a summary.

use super::measure::Request;
use std::fmt::Write as _;
use std::path::Path;
use voronudge_report::EquationOfStateReport;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, GREY};
use voronudge_report::equation_of_state_report::{Honeycomb, Measured, UniformRecord};
use voronudge_report::figure::{
    CurveSeries, ErrorPoint, PointSeries, PointsAndCurves, Stroke, points_and_curves,
};
use voronudge_report::markers::Marker;
use voronudge_report::numbers::{significant, with_interval};
use voronudge_report::page::{Block, Card, Figure, Page, Row, Section, Table};
use voronudge_report::units::label_with_unit;

const GUIDE: &[[&str; 2]] = &[
    [
        "What was done",
        "Random cells in periodic boxes of several densities were followed; the stress of the forces between them was averaged over the box, over \
         time and over runs.",
    ],
    [
        "Pressure p, torques τ",
        "p = −(σ_xx + σ_yy)/2, and τ = σ_xy − σ_yx: the density of the torques with which cells turn their surroundings. Over the friction \
         of a cell both are rates.",
    ],
    [
        "B, A",
        "Bulk modulus ρ dp/dρ and odd bulk modulus ½ ρ dτ/dρ of a tissue that has forgotten its strain: slopes of the parabola through neighbouring \
         densities.",
    ],
    [
        "What follows",
        "A gradient of the density along x drives ρ v_x = −dp/dx and, across it, ρ v_y = −½ dτ/dx. voronudge channel --equation-of-state predicts flows from that.",
    ],
    ["Errors", "Standard errors of means over independent runs."],
];

/// Points of a curve that is a formula.
const STEPS: usize = 100;

pub(super) fn page(report: &EquationOfStateReport, request: &Request) -> Page {
    let rate = report.units.powers(0, -1);
    let figure = |symbol: &str,
                  unit: &str,
                  caption: &str,
                  of: fn(&UniformRecord) -> Measured,
                  theory: Option<fn(&Honeycomb) -> f64>| {
        let label = if unit.is_empty() { symbol.to_owned() } else { label_with_unit(symbol, unit) };
        let points = report.points.iter().map(|point| ErrorPoint {
            at: [point.relative_density, of(point).value],
            error: [None, Some(of(point).error)],
        });
        let series = [PointSeries {
            label: "simulated",
            colour: BLUE,
            marker: Marker::Circle,
            points: points.collect(),
        }];
        let curves: Vec<CurveSeries> = theory
            .map(|of| honeycomb(request, of))
            .filter(|points| !points.is_empty())
            .map(|points| CurveSeries {
                label: "honeycomb, mean field",
                colour: GREY,
                stroke: Stroke::Dashed,
                points,
            })
            .into_iter()
            .collect();
        let svg = points_and_curves(&PointsAndCurves {
            title: caption,
            labels: ["density ρ ℓ₀²", &label],
            scales: [AxisScale::Linear; 2],
            series: &series,
            curves: &curves,
        });
        Figure::new(svg, &format!("{caption} against density; bars are standard errors over runs"))
    };
    let figures = vec![
        figure("pressure p", &rate, "Pressure", |own| own.pressure, Some(|own| own.pressure)),
        figure("torques τ", &rate, "Density of torques", |own| own.torque, Some(|own| own.torque)),
        figure("bulk modulus B", &rate, "Bulk modulus", |own| own.bulk_modulus, Some(|own| own.bulk_modulus)),
        figure(
            "odd bulk modulus A",
            &rate,
            "Odd bulk modulus",
            |own| own.odd_bulk_modulus,
            Some(|own| own.odd_bulk_modulus),
        ),
        figure("⟨P/√A⟩", "", "Shape index", |own| own.shape_index, None),
    ];
    let cards = quantities(nearest_to_one(report)).map(|(label, own)| {
        let [value, low, high] = with_interval(own.value, interval(own));
        Card::new(label, value, format!("{low} … {high}"))
    });
    Page {
        summary: vec![Block::summary(format!(
            "{} cells in each of {} runs for a density; averages over {} {} after {}; p, τ, B and A in {rate}.",
            report.cells,
            report.replicas,
            significant(report.time, 3),
            report.units.time_text(),
            significant(report.relaxation, 3)
        ))],
        cards: cards.into(),
        guide: vec![Block::terms(GUIDE)],
        sections: vec![
            Section::new("Against density").with(Block::pairs(figures)),
            Section::new("Numbers").with(Block::table(table(report))),
        ],
        ..Page::new("Equation of state", headline(report), &report.run)
    }
}

fn honeycomb(request: &Request, of: fn(&Honeycomb) -> f64) -> Vec<[f64; 2]> {
    let (from, to) = (request.densities[0], request.densities[request.densities.len() - 1]);
    let densities = (0..=STEPS).map(|k| from + (to - from) * k as f64 / STEPS as f64);
    densities.filter_map(|density| Some([density, of(&request.honeycomb(density)?)])).collect()
}

/// Within which the true mean is 19 times out of 20, for many runs.
fn interval(own: Measured) -> [f64; 2] {
    let reach = voronudge_infer::NORMAL_95 * own.error;
    [own.value - reach, own.value + reach]
}

fn nearest_to_one(report: &EquationOfStateReport) -> &UniformRecord {
    let off = |point: &&UniformRecord| (point.relative_density - 1.0).abs();
    report.points.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(&report.points[0])
}

fn quantities(point: &UniformRecord) -> [(&'static str, Measured); 5] {
    [
        ("p", point.pressure),
        ("τ", point.torque),
        ("B", point.bulk_modulus),
        ("A", point.odd_bulk_modulus),
        ("P/√A", point.shape_index),
    ]
}

fn with_error(own: Measured) -> String {
    format!("{} ± {}", significant(own.value, 4), significant(own.error, 1))
}

fn table(report: &EquationOfStateReport) -> Table {
    let header = ["ρ ℓ₀²", "p", "τ", "B", "A", "P/√A"];
    let row = |point: &UniformRecord| {
        let numbers = quantities(point).map(|(_, own)| with_error(own));
        std::iter::once(significant(point.relative_density, 4)).chain(numbers).collect::<Row>()
    };
    Table::new(header).rows(report.points.iter().map(row))
}

/// The answer in a sentence.
fn headline(report: &EquationOfStateReport) -> String {
    let point = nearest_to_one(report);
    let [bulk, odd] = [point.bulk_modulus, point.odd_bulk_modulus];
    format!(
        "At ρ ℓ₀² = {} a gradient of the density drives a flow across it of {} times that along it (A/B = {} / {}).",
        significant(point.relative_density, 3),
        significant(odd.value / bulk.value, 3),
        with_error(odd),
        with_error(bulk)
    )
}

pub(super) fn summary(report: &EquationOfStateReport, out: &Path) -> String {
    let mut text = format!(
        "{} cells, {} runs for each density\n\n{:8}{:>20}{:>20}{:>20}{:>20}{:>20}\n",
        report.cells, report.replicas, "ρ ℓ₀²", "p", "τ", "B", "A", "P/√A"
    );
    for point in &report.points {
        let numbers = quantities(point).map(|(_, own)| format!("{:>20}", with_error(own)));
        let _ = writeln!(text, "{:8}{}", significant(point.relative_density, 4), numbers.concat());
    }
    let _ = writeln!(text, "\n{}\nfigures in {}", headline(report), out.join("report.html").display());
    text
}
