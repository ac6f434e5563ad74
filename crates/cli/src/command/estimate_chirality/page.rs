//! The estimate as a page and as a summary.

use std::path::Path;
use voronudge_infer::LinePoint;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, GREY};
use voronudge_report::figure::{
    CurveSeries, ErrorPoint, PointSeries, PointsAndCurves, Stroke, points_and_curves,
};
use voronudge_report::markers::Marker;
use voronudge_report::numbers::significant;
use voronudge_report::page::{Block, Card, Figure, Page, Section};
use voronudge_report::{ChiralityReport, Units};

const GUIDE: [[&str; 2]; 2] = [
    [
        "The relation",
        "Where the density of a chiral tissue falls along x, it flows along x and across it, v_y/v_x = α/(3 − a P_0/ℓ_0) with \
         a = 1/(2√(2√3)), in the mean-field theory of a honeycomb without area elasticity. The paper prints a minus sign.",
    ],
    [
        "What it is worth",
        "In simulated channels the slope gives α within some ten per cent at large α, and too large an α, up to twofold, at small ones: see \
         the page of the command. The interval is the statistical error alone.",
    ],
];

pub(super) fn page(
    title: &str,
    points: &[(f64, LinePoint)],
    report: &ChiralityReport,
    units: Option<&Units>,
) -> Page {
    let line = &report.line;
    let [from, to] = line.range;
    let counts = |x: f64| from.is_none_or(|from| x >= from) && to.is_none_or(|to| x <= to);
    let pick = |inner: bool| {
        let chosen = points.iter().filter(|(x, _)| counts(*x) == inner);
        chosen
            .map(|(_, p)| ErrorPoint {
                at: [p.x, p.y],
                error: [p.errors.map(|e| e[0]), p.errors.map(|e| e[1])],
            })
            .collect()
    };
    let mut series =
        vec![PointSeries { label: "measured", colour: BLUE, marker: Marker::Circle, points: pick(true) }];
    let left_out: Vec<ErrorPoint> = pick(false);
    if !left_out.is_empty() {
        series.push(PointSeries {
            label: "left out",
            colour: GREY,
            marker: Marker::Square,
            points: left_out,
        });
    }
    let reach =
        points.iter().map(|(_, p)| p.x).fold([0.0_f64, 0.0_f64], |[low, high], x| [low.min(x), high.max(x)]);
    let along = |slope: f64, intercept: f64| reach.map(|x| [1.1 * x, intercept + 1.1 * slope * x]).to_vec();
    let curve = |label, stroke, points| CurveSeries { label, colour: BLUE, stroke, points };
    let curves = [
        curve("line", Stroke::Solid, along(line.slope, line.intercept)),
        curve("95 % interval of the slope", Stroke::Dotted, along(line.slope_ci95[0], line.intercept)),
        curve("", Stroke::Dotted, along(line.slope_ci95[1], line.intercept)),
    ];
    let unit = units.map_or_else(|| "unit of the table".to_owned(), Units::velocity_text);
    let label = |name: &str| format!("{name} ({unit})");
    let svg = points_and_curves(&PointsAndCurves {
        title: "v_y against v_x",
        labels: [&label("v_x"), &label("v_y")],
        scales: [AxisScale::Linear; 2],
        series: &series,
        curves: &curves,
    });
    let caption = "Velocity along the channel against velocity across it, one point for each place, with standard errors.";
    let slope = Section::new("Slope")
        .with(Block::facts(rows(report)))
        .with(Block::pairs([Figure::new(svg, caption)]));
    let [low, high] = line.slope_ci95.map(|end| significant(end, 3));
    let cards = vec![
        Card::new("α", best(report), alpha_note(report)),
        Card::new("v_y/v_x", significant(line.slope, 3), format!("{low} to {high}")),
    ];
    Page {
        summary: vec![Block::summary(sentence(report))],
        cards,
        guide: vec![Block::terms(&GUIDE)],
        sections: vec![slope],
        ..Page::new(title, format!("The flow implies α = {}.", best(report)), &report.run)
    }
}

/// α for the P₀ given, or by the rule of thumb.
fn best(report: &ChiralityReport) -> String {
    significant(report.line.alpha.unwrap_or(report.line.alpha_rule_of_thumb), 3)
}

fn alpha_note(report: &ChiralityReport) -> String {
    match report.line.alpha_ci95 {
        Some(ends) => {
            let [low, high] = ends.map(|end| significant(end, 3));
            format!("95 %: {low} to {high}")
        }
        None => "rule of thumb, P₀ is not known".into(),
    }
}

fn sentence(report: &ChiralityReport) -> String {
    let line = &report.line;
    let [low, high] = line.alpha_range.map(|end| significant(end, 3));
    match line.shape_index {
        Some(index) => format!(
            "For P_0/ℓ_0 = {}; any P_0/ℓ_0 between 3 and 5 leaves α between {low} and {high}.",
            significant(index, 3)
        ),
        None => format!(
            "P_0/ℓ_0 is not known: α is v_y/v_x over 0.5, and P_0/ℓ_0 between 3 and 5 leaves α between {low} and {high}."
        ),
    }
}

fn rows(report: &ChiralityReport) -> Vec<[String; 2]> {
    let line = &report.line;
    let [low, high] = line.alpha_range.map(|end| significant(end, 3));
    let mut rows = vec![
        ["places that count".into(), line.points.to_string()],
        ["α by the rule of thumb".into(), significant(line.alpha_rule_of_thumb, 3)],
        ["α for 3 < P_0/ℓ_0 < 5".into(), format!("{low} to {high}")],
    ];
    if report.intercept_kind == "free" {
        rows.push(["intercept".into(), significant(line.intercept, 3)]);
    }
    if let Some(chi_square) = line.reduced_chi_square {
        rows.push(["χ² per degree of freedom".into(), significant(chi_square, 2)]);
    }
    rows
}

pub(super) fn summary(report: &ChiralityReport, out: &Path) -> String {
    let line = &report.line;
    let [low, high] = line.slope_ci95.map(|end| significant(end, 3));
    let [least, largest] = line.alpha_range.map(|end| significant(end, 3));
    let alpha = match (line.alpha, line.alpha_ci95, line.shape_index) {
        (Some(alpha), Some(ends), Some(index)) => {
            let [low, high] = ends.map(|end| significant(end, 3));
            format!(
                "alpha        {} (95 %: {low} to {high}) for P_0/l_0 = {}\n",
                significant(alpha, 3),
                significant(index, 3)
            )
        }
        _ => String::new(),
    };
    format!(
        "v_y / v_x    {} (95 %: {low} to {high}) from {} places\n{alpha}rule of thumb alpha = {}; {least} to {largest} for P_0/l_0 from 3 to 5\n\nfigure in {}\n",
        significant(line.slope, 3),
        line.points,
        significant(line.alpha_rule_of_thumb, 3),
        out.join("report.html").display()
    )
}
