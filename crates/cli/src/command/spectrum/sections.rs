//! The sections of the page, and its key numbers.

use super::strip::{Bands, EndedLattice};
use voronudge_report::figure::{
    DispersionPart, DispersionPoint, SpectrumPoint, complex_spectrum, density_of_states, dispersion,
};
use voronudge_report::numbers::{NO_VALUE, significant};
use voronudge_report::page::{Block, Card, Figure, Section, Table};
use voronudge_report::spectrum_report::{
    FrameSpectrum, MeanFieldRecord, ModeRecord, SpectrumReport, StripRecord,
};
use voronudge_report::units::Units;

pub(super) const INTRODUCTION: &str = "Near a snapshot, small displacements u of the cells obey ∂_tu = J u, where the Jacobian J tells how the velocity of each cell \
    changes with the positions. Its eigenvectors are the modes of the tissue, its eigenvalues λ what becomes of them: the real part is the rate of growth, the \
    imaginary part the angular frequency.";

pub(super) const GUIDE: [[&str; 2]; 5] = [
    [
        "Growing and decaying modes",
        "In a solid at rest all modes decay, apart from two translations that do nothing. A mode that grows means that the snapshot is not at rest in a stable state: it \
         will move away from it.",
    ],
    [
        "Waves",
        "Without chirality forces have a potential and nothing oscillates. Chirality lets overdamped cells oscillate: odd elastic waves. ⟨ω²⟩ is the mean square \
         frequency over all modes.",
    ],
    [
        "Participation, longitudinal share",
        "The share of the cells that take part in a mode, and the share of compression, as against rotation, in its gradients: near 1 a mode is longitudinal, near 0 \
         transverse.",
    ],
    [
        "Condition number, overlap",
        "Where two modes coalesce into one (an exceptional point) the condition number becomes infinite and the overlap with the nearest mode 1. There frequencies set \
         in, and a small disturbance can be amplified before it decays.",
    ],
    [
        "What the modes do not tell",
        "They hold for displacements that change no neighbours. Each T1 transition makes new modes.",
    ],
];

/// The eigenvalues of the first frame, and what there is of all frames.
pub(super) fn eigenvalues(report: &SpectrumReport, points: &[SpectrumPoint]) -> Section {
    let unit = report.units.powers(0, -1);
    let figure = Figure::new(
        complex_spectrum(points, &unit),
        "Each point is a mode u exp(λt). Right of the upright line it grows, left of it it decays. Off the level line it \
         oscillates: these are odd elastic waves, which come in pairs.",
    );
    let frames = report.frames.iter().flat_map(|frame| frame_facts(frame, &report.units));
    let facts = Block::facts(frames.chain(report.mean_field.as_ref().map(honeycomb)));
    let whole = report.frames.first().is_some_and(|frame| frame.mean_square_frequency.is_some());
    Section::new("Eigenvalues")
        .with(Block::group("beside", [figure.into(), Block::group("stack", [facts])]))
        .with_all(whole.then(|| Block::pairs(densities(points, &unit))))
}

/// What becomes of the modes of a frame, in numbers.
pub(super) fn fates(frame: &FrameSpectrum) -> String {
    let FrameSpectrum { modes, decaying, growing, zero, .. } = frame;
    format!("{modes} modes: {decaying} decay, {growing} grow, {zero} rest")
}

fn frame_facts(frame: &FrameSpectrum, units: &Units) -> Vec<[String; 2]> {
    let neutral = match frame.neutral {
        0 => String::new(),
        count => format!(", {count} only oscillate"),
    };
    let modes = format!(
        "{} of {} cells move; {}{neutral}; {} oscillate",
        frame.counted,
        frame.present,
        fates(frame),
        frame.oscillating
    );
    let square = frame.mean_square_frequency.map(|square| format!("⟨ω²⟩ = {}", significant(square, 4)));
    let transition = frame.transition.as_ref().map(|own| {
        format!(
            "shortest side {} {}; {} of {} sides below a hundredth of the cell size",
            significant(own.shortest_side, 2),
            units.length_text(),
            own.short_sides,
            own.sides
        )
    });
    let reach = frame.reach.map(|reach| {
        let [re, im] = frame.shift.unwrap_or([f64::NAN; 2]).map(|part| significant(part, 4));
        format!(
            "searched up to {} {} from {re} + {im} i; residuals at most {}",
            significant(reach, 3),
            units.powers(0, -1),
            significant(frame.largest_residual.unwrap_or(f64::NAN), 2)
        )
    });
    let further = [square, transition, reach].into_iter().flatten().map(|text| [String::new(), text]);
    [[format!("frame {}", frame.frame), modes]].into_iter().chain(further).collect()
}

fn honeycomb(own: &MeanFieldRecord) -> [String; 2] {
    let text = format!(
        "{} at these parameters in mean-field theory: unstable beyond P_0 = {}, waves at q* beyond |α| = {}; ⟨ω²⟩ = {}",
        own.phase.replace('_', " "),
        significant(own.stability_limit, 4),
        significant(own.exceptional_chirality, 3),
        significant(own.mean_square_frequency, 4)
    );
    ["honeycomb".into(), text]
}

fn densities(points: &[SpectrumPoint], unit: &str) -> [Figure; 2] {
    let rates: Vec<f64> = points.iter().map(|point| point.rate).collect();
    let frequencies: Vec<f64> =
        points.iter().map(|point| point.frequency).filter(|frequency| *frequency > 0.0).collect();
    [
        Figure::new(
            density_of_states("density of rates", "rate of growth", unit, &rates),
            "How many modes grow or decay at which rate: a share of all modes per unit of the rate.",
        ),
        Figure::new(
            density_of_states("density of frequencies", "angular frequency", unit, &frequencies),
            "How many of the waves have which frequency, each pair counted once: a share of the waves per unit of \
             frequency. Modes that do not oscillate are not counted.",
        ),
    ]
}

/// Modes that stand out, with maps of some of them.
pub(super) fn modes(frame: &FrameSpectrum, units: &Units, maps: Vec<Figure>) -> Section {
    let section = Section::new("Modes that stand out");
    let rows: Vec<Vec<String>> = [
        ("grows fastest, or decays slowest", &frame.largest_growth),
        ("oscillates fastest", &frame.fastest_oscillation),
        ("nearest to an exceptional point", &frame.exceptional),
    ]
    .into_iter()
    .filter_map(|(name, mode)| Some(mode_row(name, mode.as_ref()?)))
    .collect();
    if rows.is_empty() {
        return section;
    }
    let header = [
        "",
        "rate",
        "frequency",
        "participation",
        "longitudinal",
        "condition",
        "overlap",
        "row in eigenvalues.npy",
    ];
    section
        .with(Block::table(Table::new(header).rows(rows)))
        .with(Block::remark(format!("Rates and frequencies in {}.", units.powers(0, -1))))
        .with(Block::pairs(maps))
}

fn mode_row(name: &str, mode: &ModeRecord) -> Vec<String> {
    let text = |value: Option<f64>| value.map_or(NO_VALUE.into(), |value| significant(value, 3));
    vec![
        name.into(),
        significant(mode.rate, 4),
        significant(mode.frequency, 4),
        text(mode.participation),
        text(mode.longitudinal),
        text(mode.condition),
        text(mode.overlap),
        mode.index.to_string(),
    ]
}

/// Waves on a honeycomb beside the theory, where they were asked for.
pub(super) fn waves(report: &SpectrumReport, points: &[DispersionPoint]) -> Section {
    let section = Section::new("Waves on the honeycomb");
    if points.is_empty() {
        return section;
    }
    let unit = report.units.powers(0, -1);
    let text = match report.lattice.as_ref().and_then(|lattice| lattice.largest_difference) {
        Some(difference) => format!(
            "The dynamical matrix from the Jacobian of the simulated model and that of the mean-field theory, which was derived without it, differ by at most {} of \
             its largest entry.",
            significant(difference, 2)
        ),
        None => "The theory is that of the base model, so it is not drawn here.".into(),
    };
    section.with(Block::paragraph(text)).with(Block::pairs([
        Figure::new(
            dispersion(points, DispersionPart::Decay, &unit),
            "Decay rates of the two waves at each wave vector along the path Γ–K–M–Γ. Below zero a wave grows.",
        ),
        Figure::new(
            dispersion(points, DispersionPart::Frequency, &unit),
            "Their frequencies. Where both branches leave zero, two modes coalesce: an exceptional point.",
        ),
    ]))
}

/// The strip, where there is one.
pub(super) fn strip(record: &StripRecord, (ended, bands): (&EndedLattice, &Bands), units: &Units) -> Section {
    let difference = record.difference_from_zone.map_or(String::new(), |difference| {
        format!(
            " How the modes grow from one end to the other differs by {} of it (root mean square) from the generalised Brillouin zone; this difference is that of a \
             finite strip and goes down with its width.",
            significant(difference, 2)
        )
    });
    Section::new("A strip with ends")
        .with(Block::paragraph(format!(
            "{} rows of cells move, each {} ℓ₀ from the next; along them displacements are waves exp(iqy). The figures of single modes are at q = {} ℓ₀⁻¹.{difference}",
            record.moving_rows,
            significant(record.spacing, 3),
            significant(record.wave_number, 4)
        )))
        .with(Block::pairs(bands.figures(ended, units)))
}

/// Key numbers of a frame.
pub(super) fn cards(frame: &FrameSpectrum, units: &Units) -> Vec<Card> {
    let [unit, square_unit] = [-1, -2].map(|power| units.powers(0, power));
    let mode = |record: &Option<ModeRecord>, of: fn(&ModeRecord) -> f64| {
        record.as_ref().map_or(NO_VALUE.into(), |mode| format!("{} {unit}", significant(of(mode), 3)))
    };
    let time = |rate: f64| format!("a factor e in {}", significant(1.0 / rate.abs(), 2));
    let growth = frame.largest_growth.as_ref().map_or(String::new(), |mode| time(mode.rate));
    let period = frame.fastest_oscillation.as_ref().map_or("nothing oscillates".into(), |mode| {
        format!("period {}", significant(std::f64::consts::TAU / mode.frequency.abs(), 2))
    });
    let mut cards = vec![
        Card::new("growing modes", frame.growing.to_string(), format!("of {}", frame.modes)),
        Card::new("waves", frame.oscillating.to_string(), "modes that oscillate"),
        Card::new("largest rate of growth", mode(&frame.largest_growth, |mode| mode.rate), growth),
        Card::new("highest frequency", mode(&frame.fastest_oscillation, |mode| mode.frequency), period),
    ];
    cards.extend(frame.mean_square_frequency.map(|square| {
        let scaled = frame.mean_square_frequency_over_k_p;
        let note = scaled.map_or(String::new(), |scaled| format!("{} Kₚ²", significant(scaled, 3)));
        Card::new("⟨ω²⟩", format!("{} {square_unit}", significant(square, 3)), note)
    }));
    cards
}
