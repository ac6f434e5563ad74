//! A channel as a page and as a summary.

use super::figures::{Disturbances, Figures};
use std::fmt::Write as _;
use std::path::Path;
use voronudge_report::channel_report::{ChannelReport, CycleRecord, DecayRecord, DisturbanceRecord};
use voronudge_report::numbers::significant;
use voronudge_report::page::{Block, Card, Page, Section};
use voronudge_simulate::measure::Estimate;

const PERIODIC: [&str; 2] = [
    "Edges",
    "The box is periodic: cells on both sides of an edge touch. Both velocities vanish there, since the channel is the same after half a turn \
     about a place on the edge.",
];

const WALLED: [&str; 2] = [
    "Walls",
    "Torque-free walls stand at both edges: cells there meet mirror images. v_x vanishes at a wall; v_y does not, as chirality drives an edge \
     current along it, births or not. The continuum does not contain it, and fits begin farther in. New cells appear on vertices in front of \
     the wall.",
];

const GUIDE: [[&str; 2]; 5] = [
    [
        "What is simulated",
        "Cells of the chiral Voronoi model. Cells are extruded and born at rates that fall with the distance from the \
         nearer edge; more are born at the edge, more are extruded farther in, so cells flow from the edges to the middle.",
    ],
    [
        "v_x, v_y",
        "Displacements of the cells of a strip in a step, over the time step, averaged over cells and time. Births and deaths move no cell \
         and enter by the density alone.",
    ],
    [
        "Continuum",
        "The steady state of conservation of cells and of ζ v_x = −(B + μ) ∂_x ρ/ρ_0, v_y/v_x = (A − Kᵒ)/(B + μ), with the moduli of the \
         honeycomb and no viscosity. Nothing is fitted.",
    ],
    [
        "Exponential decay",
        "A exp(−d/λ) from both edges (and a background for the density), fitted beyond the layer where cells are born, and beyond the \
         edge current of walls.",
    ],
    [
        "α from the flow",
        "The slope of v_y against v_x times 3 − a P_0/ℓ_0. The relation is that of a honeycomb at the first moment of a compression; in a \
         channel in its steady state it holds roughly.",
    ],
];

pub(super) fn page(figures: &Figures<'_>, disturbance: Option<Disturbances<'_>>) -> Page {
    let report = &figures.findings.report;
    let flow = [figures.velocities(), figures.ratio(), figures.edge_to_edge(), figures.density()];
    let mut sections = vec![
        Section::new("Flow").with(Block::facts(decay_rows(report))).with(Block::pairs(flow)),
        Section::new("What drives the flow along the channel")
            .with(Block::paragraph(momentum(report)))
            .with_all(liquid(report).map(Block::paragraph))
            .with(Block::pairs([figures.momentum()])),
        Section::new("Births, extrusions and conservation")
            .with(Block::paragraph(format!(
                "∂_x(ρ v_x)/ρ and the net proliferation counted differ by at most {} {}, {} standard errors, where the largest rate is {}.",
                significant(report.conservation.largest_difference, 2),
                rate_unit(report),
                significant(report.conservation.largest_in_errors, 2),
                significant(report.conservation.largest_rate, 3),
            )))
            .with(Block::pairs([figures.rates(), figures.conservation()])),
    ];
    if let (Some(all), Some(record)) = (disturbance, &report.birth_disturbance) {
        sections.push(Section::new("What a birth disturbs")
            .with(Block::paragraph(format!(
                "The largest change of a velocity is {} {} in the mean for births on vertices and {} for births beside a mother{}.",
                significant(record.vertex_mean, 3),
                report.units.velocity_text(),
                significant(record.division_mean, 3),
                in_two(record, ", and {} for divisions in two"),
            )))
            .with(Block::pairs([figures.disturbance(all)])));
    }
    let cycles = report.turnover.cycle.iter().map(|cycle| Block::paragraph(cycles(report, cycle)));
    sections
        .push(Section::new("Young and old cells").with_all(cycles).with(Block::pairs([figures.shapes()])));
    let mut guide = GUIDE.to_vec();
    guide.insert(1, if report.walls.is_some() { WALLED } else { PERIODIC });
    let headline = headline(report, figures.folded.velocity[1].first());
    Page {
        summary: [cells(report), setting(report)].map(Block::summary).into(),
        cards: cards(report),
        guide: vec![Block::terms(&guide)],
        sections,
        ..Page::new(&figures.request.title, headline, &report.run)
    }
}

/// What is to be said of divisions in two, if there are any.
fn in_two(record: &DisturbanceRecord, said: &str) -> String {
    record.cycle_mean.map_or(String::new(), |mean| said.replace("{}", &significant(mean, 3)))
}

/// What came of the cycles of cells.
fn cycles(report: &ChannelReport, cycle: &CycleRecord) -> String {
    format!(
        "Cells grow to {} times the preferred area of the model and divide in two; over all it is {} times that. {} cycles ended in the run, which took {} ± {} {} \
         (mean and standard deviation).",
        significant(cycle.size_at_division, 3),
        significant(cycle.mean_size, 3),
        cycle.cycles,
        significant(cycle.mean_time, 3),
        significant(cycle.time_deviation, 2),
        report.units.time_text(),
    )
}

fn headline(report: &ChannelReport, at_edge: Option<&Estimate>) -> String {
    if let Some(why) = &report.ended {
        return format!("The run ended before its time: {why}.");
    }
    if let (Some(_), Some(edge)) = (report.walls, at_edge) {
        return format!(
            "Cells flow towards the middle, and along the walls at {} {}, {} at the left one.",
            significant(edge.value.abs(), 3),
            report.units.velocity_text(),
            if edge.value > 0.0 { "upwards" } else { "downwards" }
        );
    }
    match &report.chirality_from_flow {
        Some(flow) if flow.slope_ci95[0] > 0.0 || flow.slope_ci95[1] < 0.0 => format!(
            "Cells flow towards the middle and {} at {} times that speed along the edges; the slope alone says α = {}, put in was {}.",
            if flow.slope > 0.0 { "upwards at the left edge" } else { "downwards at the left edge" },
            significant(flow.slope.abs(), 2),
            flow.alpha.map_or("unknown".into(), |alpha| significant(alpha, 2)),
            report.parameters.alpha
        ),
        _ => "Cells flow across the channel, and no flow along it is found.".into(),
    }
}

fn cells(report: &ChannelReport) -> String {
    let cells = report.cells;
    let number = if cells.fewest == cells.most {
        format!("{} cells throughout", cells.first)
    } else {
        format!(
            "{} cells at first, {} at the end, {} to {} on the way",
            cells.first, cells.last, cells.fewest, cells.most
        )
    };
    format!(
        "{number}; {} births and {} extrusions in {} steps.",
        cells.births, cells.extrusions, report.steps
    )
}

fn setting(report: &ChannelReport) -> String {
    let unit = report.units.length_text();
    format!(
        "A channel of {} × {} {unit}, {}; averages over {} {} in {} samples, after {} {}.",
        significant(report.width, 3),
        significant(report.length, 3),
        boundary(report),
        significant(report.time, 3),
        report.units.time_text(),
        report.samples,
        significant(report.relaxation, 3),
        report.units.time_text()
    )
}

fn boundary(report: &ChannelReport) -> &'static str {
    if report.walls.is_some() {
        "with torque-free walls at both edges"
    } else {
        "periodic in both directions"
    }
}

fn cards(report: &ChannelReport) -> Vec<Card> {
    let length = |(name, label): (&str, &str)| {
        let decay = report.decays.get(name)?;
        let value = format!("{} {}", significant(decay.length, 3), report.units.length_text());
        Some(Card::new(label, value, interval(decay)))
    };
    let slope = report.chirality_from_flow.as_ref().map(|flow| {
        let [low, high] = flow.slope_ci95.map(|end| significant(end, 3));
        Card::new("v_y/v_x", significant(flow.slope, 3), format!("{low} to {high}"))
    });
    let lengths = [
        ("velocity_x", "decay length of v_x"),
        ("velocity_y", "decay length of v_y"),
        ("density", "decay length of the density"),
    ];
    lengths.into_iter().filter_map(length).chain(slope).collect()
}

fn momentum(report: &ChannelReport) -> String {
    let momentum = report.momentum;
    let value = |(value, error): (f64, Option<f64>)| match error {
        Some(error) => format!("{} ± {}", significant(value, 3), significant(error, 1)),
        None => significant(value, 3),
    };
    format!(
        "Between {} {} from the edge and the middle ∫ρ v_y dx is {} {}; the shear stress over that stretch gives {}, the torques of the \
         cells alone {}.",
        significant(momentum.distance, 3),
        report.units.length_text(),
        value(momentum.transport),
        rate_unit(report),
        value(momentum.shear_stress),
        value(momentum.torque),
    )
}

/// What an equation of state predicts.
fn liquid(report: &ChannelReport) -> Option<String> {
    let liquid = report.liquid?;
    let percent = |share: f64| format!("{} %", significant(100.0 * share, 2));
    Some(format!(
        "With the equation of state and the rates alone, the density comes out with a root mean square difference of {} of its range, v_x of {} and v_y of {} of \
         their peaks. Uniform tissues of the simulated density there would make the transport {} {}.",
        percent(liquid.density_difference),
        percent(liquid.velocity_x_difference),
        percent(liquid.velocity_y_difference),
        significant(liquid.transport, 3),
        rate_unit(report)
    ))
}

fn interval(decay: &DecayRecord) -> String {
    let end = |end: Option<f64>| end.map_or("?".into(), |end| significant(end, 3));
    format!("{} to {}", end(decay.length_ci95[0]), end(decay.length_ci95[1]))
}

fn decay_rows(report: &ChannelReport) -> Vec<[String; 2]> {
    let unit = report.units.length_text();
    let row = |(name, decay): (&&str, &DecayRecord)| {
        [
            name.replace("velocity", "v"),
            format!(
                "decays over {} {unit} (95 %: {}), amplitude {} ± {}; χ² per degree of freedom {}",
                significant(decay.length, 3),
                interval(decay),
                significant(decay.amplitude, 3),
                significant(decay.amplitude_error, 1),
                significant(decay.reduced_chi_square, 2)
            ),
        ]
    };
    report.decays.iter().map(row).collect()
}

fn rate_unit(report: &ChannelReport) -> String {
    report.units.powers(0, -1)
}

pub(super) fn summary(report: &ChannelReport, out: &Path) -> String {
    let mut text = format!("{}\n", cells(report));
    if report.walls.is_some() {
        let _ = writeln!(text, "{}", boundary(report));
    }
    let unit = report.units.length_text();
    for (name, decay) in &report.decays {
        let _ = writeln!(
            text,
            "{:<12} decays over {} {unit} (95 %: {}), amplitude {} ± {}",
            name.replace("velocity", "v"),
            significant(decay.length, 3),
            interval(decay),
            significant(decay.amplitude, 3),
            significant(decay.amplitude_error, 1)
        );
    }
    if let Some(flow) = &report.chirality_from_flow {
        let [low, high] = flow.slope_ci95.map(|end| significant(end, 3));
        let alpha = flow.alpha.map_or(String::new(), |alpha| {
            format!(", which implies alpha {} (put in: {})", significant(alpha, 3), report.parameters.alpha)
        });
        let _ = writeln!(text, "v_y / v_x    {} (95 %: {low} to {high}){alpha}", significant(flow.slope, 3));
    }
    let _ = writeln!(
        text,
        "conservation flux and counted rates differ by at most {} {} ({} standard errors)",
        significant(report.conservation.largest_difference, 2),
        rate_unit(report),
        significant(report.conservation.largest_in_errors, 2)
    );
    if let Some(cycle) = &report.turnover.cycle {
        let _ = writeln!(text, "cycles       {}", cycles(report, cycle));
    }
    if let Some(text_of_liquid) = liquid(report) {
        let _ = writeln!(text, "{text_of_liquid}");
    }
    if let Some(record) = &report.birth_disturbance {
        let _ = writeln!(
            text,
            "a birth      changes velocities by up to {} on a vertex, {} beside a mother{} (means, {})",
            significant(record.vertex_mean, 3),
            significant(record.division_mean, 3),
            in_two(record, ", {} in two"),
            report.units.velocity_text()
        );
    }
    let _ = writeln!(text, "\nfigures in {}", out.join("report.html").display());
    text
}
