//! A run as a page.

use super::measurements::Measurements;
use super::report::{Report, Request};
use crate::command::drawing::cell_view;
use crate::failure::Failure;
use voronudge_geometry::{CellPolygon, Domain, PeriodicBox, areas};
use voronudge_report::arrows::ArrowScale;
use voronudge_report::chart::AxisScale;
use voronudge_report::figure::{
    CellScalar, Curve, CurveAxes, CurveRole, Landmark, configuration_map, curves, distribution,
};
use voronudge_report::numbers::{label_with_unit, significant, unit_text};
use voronudge_report::page::{Card, Figure};
use voronudge_report::{ChangedEdges, FrameView, SimulatePage, Units};
use voronudge_simulate::Simulation;
use voronudge_simulate::measure::shape_indices;
use voronudge_theory::hexagon_perimeter;

/// Cells up to which all are drawn; of more, those in a corner of the box.
const MOST_DRAWN: usize = 2500;
/// Mean speeds below this share of K_P ℓ₀ are rest.
const AT_REST: f64 = 1e-4;

pub(super) fn page(
    report: &Report,
    measurements: &Measurements,
    simulation: &Simulation,
    units: &Units,
) -> Result<String, Failure> {
    let page = SimulatePage {
        title: &format!("{} cells", report.request.cells),
        headline: &headline(report, units),
        summary: &paragraphs(report, measurements),
        cards: &cards(report, units),
        configuration: &configuration(simulation, &cell_box(simulation, &report.request)?, units),
        course: &course(report, measurements, units),
        structure: &structure(measurements, simulation, units),
        run: &report.run,
    };
    Ok(page.render()?)
}

fn headline(report: &Report, units: &Units) -> String {
    let Some(square) = report.mean_square_velocity else {
        return "The run was too short to be measured.".into();
    };
    let rest = AT_REST * report.request.parameters.perimeter_elasticity().abs() * report.spacing();
    if square.sqrt() < rest {
        return "The cells have come to rest: a solid.".into();
    }
    let speed = format!("{} {}", significant(square.sqrt(), 3), units.velocity_text());
    match report.t1_rate {
        Some(rate) if rate > 0.0 => format!(
            "The cells move at {speed} (root mean square), with {} T1 transitions per cell and unit of time.",
            significant(rate, 2)
        ),
        _ => format!("The cells move at {speed} (root mean square) without changing neighbours."),
    }
}

fn paragraphs(report: &Report, measurements: &Measurements) -> Vec<String> {
    let mut text = Vec::new();
    if let Some(exponent) = &report.lyapunov {
        let meaning = match exponent.standard_error {
            Some(error) if exponent.value > 2.0 * error => "the motion is chaotic",
            Some(error) if exponent.value < -2.0 * error => "small displacements die out",
            _ => "not distinct from zero",
        };
        text.push(format!("The largest Lyapunov exponent is {}: {meaning}.", significant(exponent.value, 3)));
    }
    if report.request.frames > measurements.displacement_frames {
        text.push(format!(
            "Displacements are those of {} of the {} frames.",
            measurements.displacement_frames, report.request.frames
        ));
    }
    text
}

fn cards(report: &Report, units: &Units) -> Vec<Card> {
    let card =
        |label: &str, value: String, note: &str| Card { label: label.into(), value, note: note.into() };
    let known = |value: Option<f64>| value.map_or("none".into(), |value| significant(value, 3));
    let error = report
        .mean_square_velocity_error
        .map_or(String::new(), |error| format!("± {} over the second half", significant(error, 1)));
    let mut cards = vec![
        card("⟨v²⟩", format!("{} ({})²", known(report.mean_square_velocity), units.velocity_text()), &error),
        card("T1 transitions", known(report.t1_rate), "per cell and time"),
        card(
            "hexatic order Ψ_6",
            significant(report.hexatic_order, 2),
            &format!("⟨|ψ|⟩ = {}", significant(report.hexatic_mean_modulus, 2)),
        ),
        card(
            "shape index",
            significant(report.shape_index.mean, 4),
            &format!("± {} over cells", significant(report.shape_index.standard_deviation, 2)),
        ),
    ];
    if let Some(exponent) = &report.lyapunov {
        let unit = unit_text(&format!("1/{}", units.time));
        let error =
            exponent.standard_error.map_or(String::new(), |error| format!("± {}", significant(error, 1)));
        cards.push(card("Lyapunov exponent", format!("{} {unit}", significant(exponent.value, 3)), &error));
    }
    cards
}

fn configuration(simulation: &Simulation, cell_box: &PeriodicBox, units: &Units) -> Figure {
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions_with_images());
    let share = (MOST_DRAWN as f64 / simulation.positions().len() as f64).min(1.0).sqrt();
    let [width, height] = cell_box.lengths();
    let mut polygon = CellPolygon::default();
    let mut cells = Vec::new();
    for (cell, v) in simulation.velocities().iter().enumerate() {
        let centre = cell_box.wrap(positions[cell]);
        if centre.x <= share * width && centre.y <= share * height {
            let mut view = cell_view(tessellation, positions, cell, &mut polygon);
            view.measured = Some([v.x, v.y]);
            cells.push(view);
        }
    }
    let whole = share == 1.0;
    let frame = FrameView {
        label: "the end of the run".into(),
        cells,
        changed_edges: ChangedEdges::default(),
        outline: whole.then_some([[0.0; 2], [width, height]]),
    };
    let arrows = ArrowScale::velocities(std::slice::from_ref(&frame));
    let scalar = CellScalar::shape_index(&frame);
    let caption = format!(
        "Cells at the end of the run, coloured by shape index, with their velocities.{}{}",
        if whole { "" } else { " A corner of the box." },
        if arrows.is_none() { " Nothing moves." } else { "" }
    );
    Figure::new(configuration_map(&frame, &scalar, arrows.as_ref(), units), &caption)
}

fn course(report: &Report, measurements: &Measurements, units: &Units) -> Vec<Figure> {
    let one = |points: &[[f64; 2]], label: &str, role: CurveRole| Curve {
        label: label.into(),
        points: points.to_vec(),
        role,
    };
    let velocity = label_with_unit("⟨v²⟩", &format!("({})^2", units.velocity_text()));
    let mut series = vec![one(&measurements.velocities, "⟨v²⟩", CurveRole::First)];
    if let Some(mean) = report.mean_square_velocity {
        let time = report.request.time;
        let level = [[0.5 * time, mean], [time, mean]];
        series.push(one(&level, "mean over the second half", CurveRole::Second));
    }
    let squares = || measurements.velocities.iter().map(|point| point[1]).filter(|&square| square > 0.0);
    let (low, high) = (squares().fold(f64::INFINITY, f64::min), squares().fold(0.0, f64::max));
    let scale = if high > 30.0 * low { AxisScale::Logarithmic } else { AxisScale::Linear };
    let time = label_with_unit("time", &units.time);
    let axes =
        CurveAxes { title: "mean square velocity", x: (&time, AxisScale::Linear), y: (&velocity, scale) };
    let velocities = Figure::new(
        curves(&axes, &series),
        "Mean square velocity of the cells at each frame. It falls to zero in a solid and goes on in a liquid.",
    );
    let mut moved = vec![one(&measurements.displacements, "MSD", CurveRole::First)];
    if let Some(&[lag, square]) = measurements.displacements.last() {
        let from = measurements.displacements[0][0];
        let guide: Vec<[f64; 2]> = [from, lag].iter().map(|t| [*t, square * t / lag]).collect();
        moved.push(one(&guide, "in proportion to time", CurveRole::Guide));
    }
    let lag = label_with_unit("lag", &units.time);
    let square = label_with_unit("MSD", &format!("{}^2", units.length));
    let logarithmic = AxisScale::Logarithmic;
    let axes =
        CurveAxes { title: "mean square displacement", x: (&lag, logarithmic), y: (&square, logarithmic) };
    let displacements = Figure::new(
        curves(&axes, &moved),
        "Mean square displacement against the time between two frames. Large lags rest on few pairs of frames.",
    );
    vec![velocities, displacements]
}

fn structure(measurements: &Measurements, simulation: &Simulation, units: &Units) -> Vec<Figure> {
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions_with_images());
    let hexagon = Landmark { label: "regular hexagon".into(), value: hexagon_perimeter() };
    let cells = simulation.positions().len();
    let shapes = &shape_indices(tessellation, positions)[..cells];
    let shape = distribution("shape index", "shape index P/√A", shapes, Some(&hexagon));
    let area_label = label_with_unit("area", &format!("{}^2", units.length));
    let area = distribution("area", &area_label, &areas(tessellation, positions)[..cells], None);
    let curve =
        |label: &str, role: CurveRole, of: fn(&voronudge_simulate::measure::StructureFactor) -> f64| Curve {
            label: label.into(),
            points: measurements.structure.iter().map(|shell| [shell.wave_number, of(shell)]).collect(),
            role,
        };
    let q = label_with_unit("q", &format!("1/{}", units.length));
    let axes = |title, y| CurveAxes { title, x: (&q, AxisScale::Linear), y: (y, AxisScale::Linear) };
    let density = [curve("", CurveRole::First, |shell| shell.density)];
    let velocity_label = label_with_unit("S(q) of velocity", &format!("({})^2", units.velocity_text()));
    let velocity = [
        curve("longitudinal", CurveRole::First, |shell| shell.longitudinal),
        curve("transverse", CurveRole::Second, |shell| shell.transverse),
    ];
    let frames = measurements.structure_frames;
    vec![
        Figure::new(shape, "Shape index of the cells at the end of the run."),
        Figure::new(
            curves(&axes("structure factor", "S(q) of density"), &density),
            &format!(
                "Structure factor of the density, mean over {frames} frames of the second half. Random positions have 1."
            ),
        ),
        Figure::new(
            curves(&axes("structure factors of velocity", &velocity_label), &velocity),
            "The same of the velocity, along the wave vector (compression) and across it (shear).",
        ),
        Figure::new(area, "Areas of the cells at the end of the run."),
    ]
}

/// The box of a simulation, between walls that of the cells without their images.
pub(super) fn cell_box(simulation: &Simulation, request: &Request) -> Result<PeriodicBox, Failure> {
    match simulation.tessellation().domain() {
        Domain::Periodic(_) if request.walls.is_some() => Ok(PeriodicBox::new(request.box_lengths)?),
        Domain::Periodic(cell_box) => Ok(cell_box),
        Domain::Open => Err(voronudge_simulate::Error::OpenDomain.into()),
    }
}
