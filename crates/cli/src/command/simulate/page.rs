//! A run as a page.

use super::measurements::Measurements;
use super::report::{Report, Request};
use super::sensitivity::Differentiated;
use crate::command::drawing::cell_view;
use crate::failure::Failure;
use voronudge_geometry::{CellPolygon, Domain, PeriodicBox, areas};
use voronudge_observables::{StructureFactor, shape_indices};
use voronudge_report::arrows::ArrowScale;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, GREEN, GREY, INK, VERMILLION};
use voronudge_report::figure::{
    CellScalar, CurveSeries, ErrorPoint, Landmark, PointSeries, PointsAndCurves, Stroke, configuration_map,
    distribution, points_and_curves,
};
use voronudge_report::markers::Marker;
use voronudge_report::movie::{CellMovie, MOST_IN_FRAME};
use voronudge_report::numbers::significant;
use voronudge_report::page::{Block, Card, Figure, Page, Section};
use voronudge_report::units::label_with_unit;
use voronudge_report::{ChangedEdges, FrameView, Units};
use voronudge_simulate::{Derivatives, Simulation};
use voronudge_theory::hexagon_perimeter;

/// Points of a curve up to which they are marked.
const MOST_MARKS: usize = 60;
/// Mean speeds below this share of K_P ℓ₀ are rest.
const AT_REST: f64 = 1e-4;

const GUIDE: [[&str; 2]; 3] = [
    [
        "Solid and liquid",
        "Cells of a solid come to rest, and their mean square displacement stays bounded. Cells of a liquid change neighbours and get ever further: at long times the \
         mean square displacement grows in proportion to time.",
    ],
    [
        "Shape index",
        "Perimeter over the root of the area: 3.722 for a regular hexagon, more for longer cells.",
    ],
    [
        "Structure factors",
        "How strongly density and velocity vary over a length 2π/q. S(q) of the density is 1 for random positions; the peak is the distance between neighbours. The \
         velocity is split into compression (longitudinal) and shear (transverse).",
    ],
];

pub(super) fn page(
    report: &Report,
    measurements: &Measurements,
    (simulation, differentiated, movie): (&Simulation, Option<&Differentiated>, Option<&CellMovie>),
    units: &Units,
) -> Result<Page, Failure> {
    let cell_box = cell_box(simulation, &report.request)?;
    let cells = configuration(simulation, &cell_box, movie.is_some(), units);
    let cells = movie.map_or(Ok(cells.clone().into()), |movie| Block::player(movie, &cells))?;
    let mut structure = structure(measurements, simulation, units).into_iter();
    let first = Block::group("stack", structure.next());
    let in_time = course(report, measurements, units).into_iter();
    let derivatives = differentiated.map(|own| derivatives(own, report.spacing(), units));
    Ok(Page {
        summary: paragraphs(report, measurements).into_iter().map(Block::summary).collect(),
        cards: cards(report, units),
        guide: vec![Block::terms(&GUIDE)],
        sections: vec![
            Section::new("The tissue").with(Block::group("beside", [cells, first])),
            Section::new("In time").with(Block::pairs(in_time.chain(derivatives))),
            Section::new("Structure").with(Block::pairs(structure)),
        ],
        ..Page::new(format!("{} cells", report.request.cells), headline(report, units), &report.run)
    })
}

fn headline(report: &Report, units: &Units) -> String {
    let Some(square) = report.mean_square_velocity else {
        return "The run was too short to be measured.".into();
    };
    let rest = AT_REST * report.request.parameters.K_P.abs() * report.spacing();
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
    for own in &report.sensitivity {
        text.push(format!(
            "Derivatives of the positions by {}: {}.",
            own.by,
            own.agreement(report.request.time)
        ));
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
    let known = |value: Option<f64>| value.map_or("none".into(), |value| significant(value, 3));
    let error = report
        .mean_square_velocity_error
        .map_or(String::new(), |error| format!("± {} over the second half", significant(error, 1)));
    let mut cards = vec![
        Card::new("⟨v²⟩", format!("{} {}", known(report.mean_square_velocity), units.powers(2, -2)), error),
        Card::new("T1 transitions", known(report.t1_rate), "per cell and time"),
        Card::new(
            "hexatic order Ψ_6",
            significant(report.hexatic_order, 2),
            format!("⟨|ψ|⟩ = {}", significant(report.hexatic_mean_modulus, 2)),
        ),
        Card::new(
            "shape index",
            significant(report.shape_index.mean, 4),
            format!("± {} over cells", significant(report.shape_index.standard_deviation, 2)),
        ),
    ];
    if let Some(exponent) = &report.lyapunov {
        let unit = units.powers(0, -1);
        let error =
            exponent.standard_error.map_or(String::new(), |error| format!("± {}", significant(error, 1)));
        cards.push(Card::new(
            "Lyapunov exponent",
            format!("{} {unit}", significant(exponent.value, 3)),
            error,
        ));
    }
    cards
}

/// The cells at the end, or of many those in the middle of the box; as the still of a movie, which says so itself.
fn configuration(simulation: &Simulation, cell_box: &PeriodicBox, is_still: bool, units: &Units) -> Figure {
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions_with_images());
    let share = (MOST_IN_FRAME as f64 / simulation.positions().len() as f64).min(1.0).sqrt();
    let [width, height] = cell_box.lengths();
    let mut polygon = CellPolygon::default();
    let mut cells = Vec::new();
    for (cell, v) in simulation.velocities().iter().enumerate() {
        let centre = cell_box.wrap(positions[cell]);
        if (centre.x - 0.5 * width).abs() <= 0.5 * share * width
            && (centre.y - 0.5 * height).abs() <= 0.5 * share * height
        {
            let mut view = cell_view(tessellation, positions, cell, &mut polygon);
            view.measured = Some([v.x, v.y]);
            cells.push(view);
        }
    }
    let whole = share == 1.0;
    let frame = FrameView {
        label: "the end of the run".into(),
        time: None,
        cells,
        changed_edges: ChangedEdges::default(),
        outline: whole.then_some([[0.0; 2], [width, height]]),
        region: Vec::new(),
    };
    let arrows = ArrowScale::velocities(std::slice::from_ref(&frame));
    let scalar = CellScalar::shape_index(&frame);
    let caption = format!(
        "Cells at the end of the run, coloured by shape index, with their velocities.{}{}",
        if whole || is_still { "" } else { " Shown is the middle of the box." },
        if arrows.is_none() { " Nothing moves." } else { "" }
    );
    Figure::new(configuration_map(&frame, &scalar, arrows.as_ref(), units), &caption)
}

fn course(report: &Report, measurements: &Measurements, units: &Units) -> Vec<Figure> {
    if measurements.velocities.len() < 2 {
        return Vec::new();
    }
    let velocity = label_with_unit("⟨v²⟩", &units.powers(2, -2));
    let squares = || measurements.velocities.iter().map(|point| point[1]).filter(|&square| square > 0.0);
    let (low, high) = (squares().fold(f64::INFINITY, f64::min), squares().fold(0.0, f64::max));
    let scale = if high > 30.0 * low { AxisScale::Logarithmic } else { AxisScale::Linear };
    let mut series = vec![curve("⟨v²⟩", BLUE, Stroke::Solid, measurements.velocities.clone())];
    if let Some(mean) = report.mean_square_velocity {
        let time = report.request.time;
        let level = vec![[0.5 * time, mean], [time, mean]];
        series.push(curve("mean over the second half", VERMILLION, Stroke::Dashed, level));
    }
    let velocities = chart(
        "mean square velocity",
        [(&label_with_unit("time", &units.time), AxisScale::Linear), (&velocity, scale)],
        &series,
    );
    let mut moved = vec![curve("MSD", BLUE, Stroke::Solid, measurements.displacements.clone())];
    if let Some(&[lag, square]) = measurements.displacements.last() {
        let from = measurements.displacements[0][0];
        let guide = [from, lag].map(|t| [t, square * t / lag]).to_vec();
        moved.push(curve("in proportion to time", GREY, Stroke::Dashed, guide));
    }
    let lag = label_with_unit("lag", &units.time);
    let square = label_with_unit("MSD", &units.powers(2, 0));
    let logarithmic = AxisScale::Logarithmic;
    let displacements =
        chart("mean square displacement", [(&lag, logarithmic), (&square, logarithmic)], &moved);
    let velocities = Figure::new(
        velocities,
        "Mean square velocity of the cells at each frame. It falls to zero in a solid and goes on in a liquid.",
    );
    let displacements = Figure::new(
        displacements,
        "Mean square displacement against the time between two frames. Large lags rest on few pairs of frames.",
    );
    vec![velocities, displacements]
}

/// What changes of parameters and starting positions do to the cells, and what of that their derivatives miss.
fn derivatives(own: &Differentiated, spacing: f64, units: &Units) -> Figure {
    let colours = [BLUE, VERMILLION, GREEN, GREY, INK];
    let mut curves = Vec::new();
    for ((name, found), colour) in own.names.iter().zip(&own.found).zip(colours.into_iter().cycle()) {
        let moved = |factor: &dyn Fn(&Derivatives) -> Option<f64>| -> Vec<[f64; 2]> {
            let at = |(time, frame): (&f64, &Derivatives)| {
                Some([*time, factor(frame)? * frame.root_mean_square() * found.aside / spacing])
            };
            own.times.iter().zip(&found.frames).filter_map(at).filter(|point| point[1] > 0.0).collect()
        };
        curves.push(curve(name, colour, Stroke::Solid, moved(&|_| Some(1.0))));
        curves.push(curve("", colour, Stroke::Dashed, moved(&|frame| frame.missed)));
    }
    let time = label_with_unit("time", &units.time);
    let axes = [(&*time, AxisScale::Linear), ("displacement by a small change, ℓ₀", AxisScale::Logarithmic)];
    let chart = plot("derivatives of the positions", axes, &[], &curves);
    let changes: Vec<String> = (own.names.iter().zip(&own.found))
        .map(|(name, found)| format!("{name} by {}", significant(found.aside, 2)))
        .collect();
    let caption = format!(
        "How far a small change moves the cells (root mean square) by the derivatives of the run, and dashed, what these miss of two runs with that change to either side: {}. \
         Where both meet, a derivative says nothing any more.",
        changes.join(", ")
    );
    Figure::new(chart, &caption)
}

fn structure(measurements: &Measurements, simulation: &Simulation, units: &Units) -> Vec<Figure> {
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions_with_images());
    let hexagon = Landmark { label: "regular hexagon".into(), value: hexagon_perimeter() };
    let cells = simulation.positions().len();
    let shapes = &shape_indices(tessellation, positions)[..cells];
    let shape = distribution("shape index", "shape index P/√A", shapes, Some(&hexagon));
    let area_label = label_with_unit("area", &units.powers(2, 0));
    let area = distribution("area", &area_label, &areas(tessellation, positions)[..cells], None);
    let q = label_with_unit("q", &units.powers(-1, 0));
    let shells = |of: fn(&StructureFactor) -> f64| -> Vec<[f64; 2]> {
        measurements.structure.iter().map(|shell| [shell.wave_number, of(shell)]).collect()
    };
    let linear = AxisScale::Linear;
    let density = chart(
        "structure factor",
        [(&q, linear), ("S(q) of density", linear)],
        &[curve("", BLUE, Stroke::Solid, shells(|shell| shell.density))],
    );
    let velocity_label = label_with_unit("S(q) of velocity", &units.powers(2, -2));
    let velocity = chart(
        "structure factors of velocity",
        [(&q, linear), (&velocity_label, linear)],
        &[
            curve("longitudinal", BLUE, Stroke::Solid, shells(|shell| shell.longitudinal)),
            curve("transverse", VERMILLION, Stroke::Solid, shells(|shell| shell.transverse)),
        ],
    );
    vec![
        Figure::new(shape, "Shape index of the cells at the end of the run."),
        Figure::new(
            density,
            &format!(
                "Structure factor of the density, {}. Random positions have 1.",
                match measurements.structure_frames {
                    1 => "of the last frame".to_owned(),
                    frames => format!("mean over {frames} frames of the second half"),
                }
            ),
        ),
        Figure::new(
            velocity,
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

fn curve<'a>(label: &'a str, colour: &'a str, stroke: Stroke, points: Vec<[f64; 2]>) -> CurveSeries<'a> {
    CurveSeries { label, colour, stroke, points }
}

/// Curves; the points of unbroken ones are marked where they are few.
fn chart(title: &str, axes: [(&str, AxisScale); 2], curves: &[CurveSeries<'_>]) -> String {
    let few = |curve: &&CurveSeries<'_>| curve.stroke == Stroke::Solid && curve.points.len() <= MOST_MARKS;
    let shapes = [Marker::Circle, Marker::Square].into_iter().cycle();
    let marked = curves.iter().filter(few).zip(shapes).map(|(curve, marker)| PointSeries {
        label: "",
        colour: curve.colour,
        marker,
        points: curve.points.iter().map(|&at| ErrorPoint::from(at)).collect(),
    });
    plot(title, axes, &marked.collect::<Vec<_>>(), curves)
}

fn plot(
    title: &str,
    [x, y]: [(&str, AxisScale); 2],
    series: &[PointSeries<'_>],
    curves: &[CurveSeries<'_>],
) -> String {
    let (labels, scales) = ([x.0, y.0], [x.1, y.1]);
    points_and_curves(&PointsAndCurves { title, labels, scales, series, curves })
}
