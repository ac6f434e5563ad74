//! A diagram as files, page and summary.

use super::diagram::{Diagram, Field};
use super::page::page;
use super::points::{FILE, Points};
use super::request::{Quantity, Request};
use super::scaling::{Collapse, Scaling};
use crate::arguments::Shard;
use crate::failure::Failure;
use crate::reporting::{Answer, Rendered};
use crate::run::Run;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use voronudge_io::OutputDirectory;
use voronudge_report::figure::{LineStyle, MapLine, PhaseMap, phase_map};
use voronudge_report::numbers::significant;
use voronudge_report::page::Figure;
use voronudge_report::phase_report::{Extreme, FailedRun, PhaseLines, PhaseReport, QuantityRecord};
use voronudge_simulate::collapse::critical_perimeter;
use voronudge_theory::{MeanField, hexagon_perimeter};

/// The |α| up to which the paper measured P_0*.
const MEASURED_TO: f64 = 0.2;
/// Points of a line on a map.
const LINE_POINTS: usize = 100;

/// Writes all results of runs that are complete, and prints the summary; the runs are in order. Returns the report as JSON.
pub(crate) fn finish(
    run: &mut Run,
    points: &Points,
    scaling: &Scaling,
    mut out: OutputDirectory,
) -> Result<Rendered<PhaseReport>, Failure> {
    let request = &points.header.request;
    let diagram = Diagram::new(points);
    out.write_text(FILE, &points.to_text()?)?;
    let failed = points.records.iter().filter(|record| record.error.is_some()).count();
    if failed > 0 {
        run.warn(format!("{failed} of {} runs failed; report.json says why", points.records.len()));
    }
    let whole = points.header.shard == Shard::WHOLE;
    let collapse = if whole {
        diagram.write(&mut out)?;
        Collapse::new(&diagram, scaling, request.seed)
    } else {
        Collapse { record: Err("This is a part of a diagram.".into()), figures: Vec::new() }
    };
    let report = report(run, points, &diagram, &collapse);
    let summary = summary(&report, points, &out);
    let rendered = if whole {
        let maps = maps(request, &diagram);
        let page = page(&headline(&diagram), &report, maps, collapse.figures);
        Rendered::with_page(out, &report, page, summary)
    } else {
        Rendered::new(out, &report, summary)
    };
    // No, if no run came to anything.
    let some_ended = points.records.is_empty() || points.records.iter().any(|record| record.error.is_none());
    Ok(rendered?.with_answer(Answer::of(some_ended)))
}

fn report(run: &Run, points: &Points, diagram: &Diagram, collapse: &Collapse) -> PhaseReport {
    let request = &points.header.request;
    let steps = (0..request.points()).map(|point| request.time_step(point));
    let place = |point: usize| {
        let columns = diagram.preferred_perimeters.len();
        (diagram.preferred_perimeters[point % columns], diagram.chiralities[point / columns])
    };
    let failed = points.records.iter().filter_map(|record| {
        let (preferred_perimeter, chirality) = place(record.point);
        let error = record.error.clone()?;
        Some(FailedRun { preferred_perimeter, chirality, replica: record.replica, error })
    });
    let quantities = diagram.fields.iter().map(|(quantity, field)| (quantity.name(), extremes(field, place)));
    PhaseReport {
        run: run.record(None),
        cells: request.cells,
        time: request.time,
        dt: request.dt,
        steps: steps.fold([f64::INFINITY, 0.0], |[low, high], step| [low.min(step), high.max(step)]),
        least_distance: request.least_distance,
        replicas: request.replicas,
        area_elasticity: request.area_elasticity,
        cell_spread: request.spreads.record(),
        preferred_perimeters: diagram.preferred_perimeters.clone(),
        chiralities: diagram.chiralities.clone(),
        shard: [points.header.shard.part, points.header.shard.of],
        runs: points.records.len(),
        quantities: quantities.collect::<BTreeMap<_, _>>(),
        failed: failed.collect(),
        lines: PhaseLines {
            disordered_transition: critical_perimeter(0.0),
            honeycomb_limit: hexagon_perimeter(),
        },
        collapse: collapse.record.as_ref().ok().cloned(),
        no_collapse: collapse.record.as_ref().err().cloned(),
    }
}

fn extremes(field: &Field, place: impl Fn(usize) -> (f64, f64)) -> QuantityRecord {
    let known = || field.mean.iter().copied().enumerate().filter(|(_, value)| value.is_finite());
    let extreme = |(point, value): (usize, f64)| {
        let (preferred_perimeter, chirality) = place(point);
        Extreme { value, preferred_perimeter, chirality }
    };
    QuantityRecord {
        least: known().min_by(|a, b| a.1.total_cmp(&b.1)).map(extreme),
        largest: known().max_by(|a, b| a.1.total_cmp(&b.1)).map(extreme),
        unknown: field.mean.len() - known().count(),
    }
}

/// One map for each quantity that varies over both parameters.
fn maps(request: &Request, diagram: &Diagram) -> Vec<Figure> {
    let lines = lines(request, diagram);
    let figure = |(&quantity, field): (&Quantity, &Field)| {
        let [title, label] = quantity.labels();
        let (scale, palette) = quantity.colours();
        let values: Vec<f64> = field.mean.iter().copied().collect();
        let svg = phase_map(&PhaseMap {
            title,
            label,
            x: ("P_0 / ℓ_0", &diagram.preferred_perimeters),
            y: ("α", &diagram.chiralities),
            values: &values,
            scale,
            palette,
            lines: &lines,
        });
        Figure::new(svg, caption(quantity))
    };
    diagram.fields.iter().map(figure).collect()
}

fn caption(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::MeanSquareVelocity => {
            "Mean square velocity over the second half of the run. Dark: cells at rest, a solid."
        }
        Quantity::HexaticOrder => {
            "Order of the directions of neighbours over the whole box: one on a triangular lattice, low for many grains."
        }
        Quantity::HexaticModulus => "How hexagonal the neighbourhoods are, whatever their orientation.",
        Quantity::T1Rate => "Exchanges of neighbours, per cell and time.",
        Quantity::ShapeIndex => "Mean shape index: 3.722 for a regular hexagon.",
        Quantity::Lyapunov => {
            "Growth rate of the distance between neighbouring trajectories: positive (brown) in a chaotic liquid, negative (blue) in \
             a solid."
        }
        Quantity::MeanSquareFrequency => {
            "Mean square frequency of the modes of the Jacobian. In a liquid it is dominated by few modes on short sides."
        }
        Quantity::ShearModulus => "Shear modulus of the state at the end of the run: zero in a liquid.",
        Quantity::OddShearModulus => {
            "Odd shear modulus: the shear stress at 45° to the strain. On the honeycomb it is −√3 α."
        }
        Quantity::BulkModulus => "Bulk modulus of the state at the end of the run.",
        Quantity::OddBulkModulus => {
            "Odd bulk modulus: the torque of a dilation, over the dilation. On the honeycomb it is zero."
        }
    }
}

/// The transition of disordered tissues, dotted beyond where it was measured; the honeycomb's limit; its exceptional line.
fn lines(request: &Request, diagram: &Diagram) -> Vec<MapLine> {
    let [low, high] = ends(&diagram.chiralities);
    let along = |from: f64, to: f64| {
        (0..=LINE_POINTS).map(move |k| from + (to - from) * k as f64 / LINE_POINTS as f64)
    };
    let transition = |from: f64, to: f64| -> Vec<[f64; 2]> {
        along(from, to).map(|alpha| [critical_perimeter(alpha), alpha]).collect()
    };
    let line =
        |label: &str, style: LineStyle, points: Vec<[f64; 2]>| MapLine { label: label.into(), points, style };
    let (inner, outer) = (low.max(-MEASURED_TO), high.min(MEASURED_TO));
    let mut lines = Vec::new();
    if inner <= outer {
        lines.push(line("P_0* = 3.81 − |α|", LineStyle::Solid, transition(inner, outer)));
    }
    // Beyond what was measured, in parts so that both signs of α are drawn.
    let mut beyond = transition(MEASURED_TO.max(low), high.max(MEASURED_TO.max(low)));
    if low < -MEASURED_TO {
        beyond.push([f64::NAN; 2]);
        beyond.extend(transition(low, (-MEASURED_TO).min(high)));
    }
    lines.push(line("the same, extended", LineStyle::Dotted, beyond));
    let limit = hexagon_perimeter();
    let margin = 1.0 + (high - low);
    lines.push(line(
        "P_{MF}, honeycomb",
        LineStyle::Dashed,
        vec![[limit, low - margin], [limit, high + margin]],
    ));
    lines.push(line("exceptional line", LineStyle::DashDotted, exceptional(request, diagram)));
    lines
}

/// |α| at which the critical mode of the honeycomb begins to oscillate, in the solid.
fn exceptional(request: &Request, diagram: &Diagram) -> Vec<[f64; 2]> {
    let [first, last] = ends(&diagram.preferred_perimeters);
    let [first, last] = [first - 0.5 * (last - first) - 0.1, last.min(hexagon_perimeter())];
    let at = |k: usize| {
        let preferred_perimeter = first + (last - first) * k as f64 / LINE_POINTS as f64;
        let parameters = voronudge_theory::Parameters {
            area_elasticity: request.area_elasticity,
            preferred_perimeter,
            ..voronudge_theory::Parameters::default()
        };
        let theory = MeanField::new(parameters).ok().filter(|_| first < last);
        [preferred_perimeter, theory.map_or(f64::NAN, |theory| theory.exceptional_chirality())]
    };
    let upper: Vec<[f64; 2]> = (0..=LINE_POINTS).map(at).collect();
    let lower = upper.iter().rev().map(|[x, y]| [*x, -y]);
    upper.iter().copied().chain(lower).collect()
}

fn ends(values: &[f64]) -> [f64; 2] {
    [values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0)]
}

fn headline(diagram: &Diagram) -> String {
    let shape = format!(
        "{} preferred perimeters and {} chiralities",
        diagram.preferred_perimeters.len(),
        diagram.chiralities.len()
    );
    match diagram.fields.get(&Quantity::MeanSquareVelocity) {
        Some(field) => {
            let known = field.mean.iter().filter(|value| value.is_finite()).count();
            let moving = field.mean.iter().filter(|&&value| value > 1e-3).count();
            format!("Cells move at {moving} of {known} points of {shape}.")
        }
        None => format!("A diagram of {shape}."),
    }
}

fn summary(report: &PhaseReport, points: &Points, out: &OutputDirectory) -> String {
    let mut text =
        format!("{} runs of {} cells, {} failed\n", report.runs, report.cells, report.failed.len());
    for (name, record) in &report.quantities {
        if let (Some(least), Some(largest)) = (record.least, record.largest) {
            let ends = [least.value, largest.value].map(|value| significant(value, 3));
            let _ = writeln!(text, "  {name:22} {} to {}", ends[0], ends[1]);
        }
    }
    if let Some(collapse) = &report.collapse {
        let fitted = collapse.fitted;
        let _ = writeln!(
            text,
            "  scaling of ⟨v²⟩        β = {}, φ = {}, scatter {} (given: {}, {}, {})",
            significant(fitted.beta.value, 3),
            significant(fitted.phi.value, 3),
            significant(fitted.scatter, 2),
            collapse.given.beta,
            collapse.given.phi,
            collapse.given.scatter.map_or("apart".into(), |scatter| significant(scatter, 2)),
        );
    }
    let place = if points.header.shard == Shard::WHOLE { "report.html" } else { FILE };
    let _ = writeln!(text, "written to {}", out.path().join(place).display());
    text
}
