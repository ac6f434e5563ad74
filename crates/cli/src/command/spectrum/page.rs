//! The modes as a page and as a summary.

use super::frame::Solved;
use super::lattice::Waves;
use super::sections;
use super::strip::{Bands, EndedLattice};
use super::strip_page;
use super::view::{drawn, frame_view, points};
use crate::failure::Failure;
use std::fmt::Write as _;
use std::path::Path;
use voronudge_io::{Boundary, DataSet};
use voronudge_report::figure::{DrawnMode, mode_map};
use voronudge_report::numbers::significant;
use voronudge_report::page::{Block, Figure, Page};
use voronudge_report::spectrum_report::{FrameSpectrum, ModeRecord, SpectrumReport};
use voronudge_report::units::unit_text;

/// Velocities below this share of K_P ℓ₀ are those of a tissue at rest.
const AT_REST: f64 = 1e-4;

pub(super) fn page(
    title: &str,
    data: &DataSet,
    solved: &[Solved],
    report: &SpectrumReport,
    (waves, strip): (Option<&Waves>, Option<(&EndedLattice, &Bands)>),
) -> Result<Page, Failure> {
    let (Some(first), Some(frame)) = (solved.first(), report.frames.first()) else {
        return Err(Failure::new("no frame was looked at").with_hint("choose one by --frames"));
    };
    let (units, points, view) = (&report.units, points(first), frame_view(first));
    let maps = drawn_modes(first, frame).into_iter();
    let maps = maps.map(|(mode, caption)| Figure::new(mode_map(&view, &mode, units), &caption));
    Ok(Page {
        summary: paragraphs(data, first, report).into_iter().map(Block::summary).collect(),
        cards: sections::cards(frame, units),
        guide: vec![Block::paragraph(sections::INTRODUCTION), Block::terms(&sections::GUIDE)],
        sections: [
            sections::eigenvalues(report, &points),
            sections::modes(frame, units, maps.collect()),
            sections::waves(report, waves.map_or(&[], |waves| &waves.points)),
        ]
        .into_iter()
        .chain(report.strip.as_ref().zip(strip).map(|(record, strip)| sections::strip(record, strip, units)))
        .collect(),
        ..Page::new(title, headline(frame, &units.time), &report.run)
    })
}

/// The answer in a sentence or two.
fn headline(frame: &FrameSpectrum, time_unit: &str) -> String {
    let unit = unit_text(time_unit);
    let partial = frame.mean_square_frequency.is_none();
    let growth = match &frame.largest_growth {
        Some(mode) if mode.rate > frame.tolerance => format!(
            "{} of {} modes grow, the fastest by a factor e in {} {unit}",
            frame.growing,
            if partial { format!("the {} found", frame.modes) } else { frame.modes.to_string() },
            significant(1.0 / mode.rate, 2)
        ),
        Some(_) if partial => format!("None of the {} modes found grows", frame.modes),
        Some(mode) => format!(
            "No mode grows: small displacements of the cells die out, the slowest by a factor e in {} {unit}",
            significant(-1.0 / mode.rate, 2)
        ),
        None => "Nothing but translations was found".into(),
    };
    let waves = match &frame.fastest_oscillation {
        Some(mode) => format!(
            "{} oscillate, with periods down to {} {unit}",
            frame.oscillating,
            significant(std::f64::consts::TAU / mode.frequency.abs(), 2)
        ),
        None => "none oscillates".into(),
    };
    format!("{growth}; {waves}.")
}

fn paragraphs(data: &DataSet, first: &Solved, report: &SpectrumReport) -> Vec<String> {
    let mut paragraphs = Vec::new();
    let k_p = report.parameters.K_P.abs();
    if first.speed > AT_REST * k_p * first.length {
        paragraphs.push(format!(
            "The model does not leave this snapshot at rest: its root mean square velocity is {} {}. The modes tell what \
             becomes of small differences from the motion, for a time in which the cells hardly move.",
            significant(first.speed, 2),
            report.units.velocity_text()
        ));
    }
    if data.boundary == Boundary::Open {
        let (moving, all) = (first.problem.cells().len(), first.snapshot.cells.len());
        paragraphs.push(format!(
            "The field of view is open: {} of {all} cells at its rim are held where they are, the other {moving} move. This \
             stiffens the modes near the rim, and there are no translations that cost nothing.",
            all - moving
        ));
    }
    if let Some(walls) = report.frames.first().and_then(|frame| frame.walls.as_ref()) {
        paragraphs.push(format!(
            "The tissue ends at walls, and the modes are those of the cells with their mirror images. Within two rows of a wall are {} % of the \
             cells and, in the mean over all modes, {} % of |u|²; {} of {} modes have more than half of it there.",
            significant(100.0 * walls.cells, 2),
            significant(100.0 * walls.mean_share, 2),
            walls.mostly,
            first.modes.modes.len()
        ));
    }
    if let Some(strip) = &report.strip {
        paragraphs.push(strip_page::paragraph(strip));
    }
    if first.is_partial() {
        paragraphs.push(
            "Only some modes were searched for, so their numbers are not those of all modes, and ⟨ω²⟩ is not known.".into(),
        );
    }
    if report.frames.len() > 1 {
        paragraphs.push(format!("Figures and key numbers are those of frame {}.", first.frame));
    }
    paragraphs
}

/// The mode that grows fastest, and the one that oscillates fastest, with captions.
fn drawn_modes(first: &Solved, frame: &FrameSpectrum) -> Vec<(DrawnMode, String)> {
    let mut modes = Vec::new();
    let mut add = |mode: &Option<ModeRecord>, title: &str, what: &str| {
        let Some(mode) = mode else { return };
        let Some(drawn) = drawn(first, mode.index, title) else { return };
        let motion = if drawn.frequency == 0.0 {
            "Each arrow is the displacement of a cell."
        } else {
            "Each cell runs through its ellipse; the dots move in a browser."
        };
        let share = mode.participation.map_or(String::new(), |share| {
            format!(" {} % of the cells take part.", significant(100.0 * share, 2))
        });
        modes.push((drawn, format!("{what}, λ = {}. {motion}{share}", value(mode))));
    };
    let grows = frame.largest_growth.as_ref().is_some_and(|mode| mode.rate > frame.tolerance);
    let what = if grows { "The mode that grows fastest" } else { "The mode that decays slowest" };
    add(&frame.largest_growth, "mode that grows fastest", what);
    let same = frame.largest_growth.as_ref().map(|mode| mode.index);
    if frame.fastest_oscillation.as_ref().map(|mode| mode.index) != same {
        add(&frame.fastest_oscillation, "mode that oscillates fastest", "The mode that oscillates fastest");
    }
    modes
}

fn value(mode: &ModeRecord) -> String {
    let rate = significant(mode.rate, 3);
    match mode.frequency {
        f if f > 0.0 => format!("{rate} + {} i", significant(f, 3)),
        f if f < 0.0 => format!("{rate} − {} i", significant(-f, 3)),
        _ => rate,
    }
}

/// What is printed.
pub(super) fn summary(report: &SpectrumReport, out: &Path) -> String {
    let mut text = String::new();
    let unit = report.units.powers(0, -1);
    for frame in &report.frames {
        let _ = writeln!(
            text,
            "frame {}: {} of {} cells move, {}; {} oscillate",
            frame.frame,
            frame.counted,
            frame.present,
            sections::fates(frame),
            frame.oscillating
        );
        for (name, mode) in
            [("largest growth", &frame.largest_growth), ("fastest oscillation", &frame.fastest_oscillation)]
        {
            if let Some(mode) = mode {
                let _ = writeln!(text, "  {name:20} λ = {} {unit}", value(mode));
            }
        }
        if let Some(square) = frame.mean_square_frequency {
            let _ = writeln!(text, "  {:20} {} ({unit})²", "⟨ω²⟩", significant(square, 4));
        }
        if let Some((mode, condition)) = frame.exceptional.as_ref().and_then(|m| Some((m, m.condition?))) {
            let _ = writeln!(
                text,
                "  {:20} condition {} at λ = {}",
                "exceptional point",
                significant(condition, 3),
                value(mode)
            );
        }
        if let Some(residual) = frame.largest_residual {
            let _ = writeln!(text, "  {:20} {}", "largest residual", significant(residual, 2));
        }
    }
    if let Some(difference) = report.lattice.as_ref().and_then(|lattice| lattice.largest_difference) {
        let _ = writeln!(text, "waves on the honeycomb: largest difference from the theory {difference:.1e}");
    }
    if let Some(walls) = report.frames.first().and_then(|frame| frame.walls.as_ref()) {
        let shares = [walls.cells, walls.mean_share].map(|share| significant(100.0 * share, 3));
        let [cells, square] = shares;
        let _ = writeln!(
            text,
            "within two rows of a wall: {cells} % of the cells, {square} % of |u|² in the mean"
        );
    }
    if let Some(strip) = &report.strip {
        text.push_str(&strip_page::lines(strip));
    }
    let _ = writeln!(text, "figures in {}", out.join("report.html").display());
    text
}
