//! The result as a page and as a summary.

use super::beside::Beside;
use super::figures;
use std::fmt::Write as _;
use std::path::Path;
use voronudge_observables::Fluctuations;
use voronudge_report::numbers::{significant, with_interval};
use voronudge_report::page::{Block, Card, Page, Section, Table};
use voronudge_report::units::unit_text;
use voronudge_report::waves_report::{Measured, WaveShellRecord, WavesReport};

/// Probability below which chirality is told.
const CHIRAL: f64 = 0.01;

const GUIDE: &[[&str; 2]] = &[
    [
        "The matrix D(q)",
        "A plane wave of small displacements obeys ∂_t u = −D(q) u, but for noise. In components along the wave vector and a quarter turn ahead (anticlockwise), for long waves, \
         D(q) = q² [[B + μ, Kᵒ], [A − Kᵒ, μ]]/ζ. Eigenvalues that are not real are odd waves: their real part is the decay rate, their imaginary part the angular frequency.",
    ],
    [
        "How it is found",
        "Covariances of the amplitudes of waves fall as C(τ₀ + τ) = exp(−Dτ) C(τ₀), whatever the noise is like, if it has no memory. Errors of localisation without memory are in C(0) alone, and τ₀ > 0 is free of them.",
    ],
    [
        "Errors",
        "Bars are one standard error, by leaving out one stretch of time of one wave at a time. Shells of wave numbers are independent in a periodic box, and share power with the next in an open field.",
    ],
    [
        "Whether waves relax linearly",
        "What waves do over 2τ is twice what they do over τ where they relax linearly and without memory. Where it is not, D(q) is a rate at this lag and no property of the tissue.",
    ],
    [
        "Jacobian",
        "Forces that the model answers a wave with that is put on all cells alike. In disordered tissues cells then go on to move otherwise; the relaxed Jacobian is what remains for forces that last. Fluctuations see what is between the two.",
    ],
    [
        "Mean field",
        "The honeycomb in closed form, averaged over directions. Beyond its limit of stability it is no tissue.",
    ],
];

pub(super) fn page(title: &str, report: &WavesReport, (found, beside): (&Fluctuations, &Beside)) -> Page {
    let relaxation = figures::relaxation(found, beside, &report.units);
    let mut sections = vec![Section::new("How waves relax").with(Block::pairs(relaxation))];
    let spectra = figures::spectra(found, beside, &report.units);
    if !spectra.is_empty() {
        let section = Section::new("Dynamic structure factor");
        sections.push(section.with(Block::paragraph(segments(report))).with(Block::pairs(spectra)));
    }
    sections.push(Section::new("Shells of wave numbers").with(Block::table(table(report))));
    Page {
        summary: said(report).into_iter().map(Block::summary).collect(),
        cards: cards(report),
        guide: vec![Block::terms(GUIDE)],
        sections,
        ..Page::new(title, headline(report), &report.run)
    }
}

fn segments(report: &WavesReport) -> String {
    report.spectra.as_ref().map_or_else(String::new, |own| {
        format!(
            "Means over {} segments of {} frames that overlap by half; slower waves than {} lie below the lowest frequency.",
            own.segments,
            own.segment,
            own.frequencies
                .first()
                .map_or_else(String::new, |omega| with_unit(*omega, 2, &report.units.powers(0, -1)))
        )
    })
}

fn with_unit(value: f64, digits: usize, unit: &str) -> String {
    format!("{} {}", significant(value, digits), unit_text(unit)).trim_end().to_owned()
}

fn plus_minus(value: f64, error: f64) -> String {
    if error.is_finite() {
        format!("{} ± {}", significant(value, 3), significant(error, 1))
    } else if value.is_finite() {
        significant(value, 3)
    } else {
        "–".into()
    }
}

/// A probability, none below a ten-thousandth in full.
fn probability(p: f64) -> String {
    match p {
        p if !p.is_finite() => "–".into(),
        p if p < 1e-4 => "< 10⁻⁴".into(),
        p => significant(p, 2),
    }
}

fn table(report: &WavesReport) -> Table {
    let rate = unit_text(&report.units.powers(0, -1));
    let header = [
        format!("q ({})", unit_text(&report.units.powers(-1, 0))),
        "waves".into(),
        "τ (frames)".into(),
        format!("D∥∥ ({rate})"),
        format!("D⊥⊥ ({rate})"),
        format!("D∥⊥ ({rate})"),
        format!("D⊥∥ ({rate})"),
        format!("frequency, 95 % ({rate})"),
        "linear, p".into(),
        "achiral, p".into(),
    ];
    let row =
        |shell: &WaveShellRecord| {
            let mut row = vec![significant(shell.wave_number, 3), shell.wave_vectors.to_string()];
            match &shell.relaxation {
                Some(own) => {
                    row.push(own.lag.to_string());
                    row.extend([(0, 0), (1, 1), (0, 1), (1, 0)].map(|(i, j): (usize, usize)| {
                        plus_minus(own.matrix[i][j], own.standard_errors[i][j])
                    }));
                    let [_, low, high] = with_interval(own.frequency, own.frequency_ci95);
                    row.push(format!("{low} … {high}"));
                    row.extend([own.linear, own.achiral].map(probability));
                }
                None => row.extend(std::iter::repeat_n("–".to_owned(), 8)),
            }
            row
        };
    Table::new(header).rows(report.shells.iter().map(row))
}

/// The shell whose frequency is furthest above zero at the lower end of its interval.
fn fastest(report: &WavesReport) -> Option<(&WaveShellRecord, f64, [f64; 2])> {
    let told = report.shells.iter().filter_map(|shell| {
        let own = shell.relaxation.as_ref().filter(|own| own.reliable)?;
        Some((shell, own.frequency, own.frequency_ci95))
    });
    told.filter(|(_, _, [low, high])| *low > 0.0 && high.is_finite()).max_by(|a, b| a.2[0].total_cmp(&b.2[0]))
}

fn headline(report: &WavesReport) -> String {
    let chiral = match report.achiral {
        Some(p) if p < CHIRAL => format!(
            "The tissue is chiral: entries of D(q) off the diagonal as large have a probability of {} without chirality",
            probability(p)
        ),
        Some(p) => format!(
            "No chirality is seen: entries of D(q) off the diagonal as large have a probability of {} without any",
            probability(p)
        ),
        None => "Whether the tissue is chiral cannot be told from its waves".into(),
    };
    let rate = report.units.powers(0, -1);
    let odd = match fastest(report) {
        Some((shell, frequency, interval)) if report.verdict != "not_linear" => {
            let [value, low, high] = with_interval(frequency, interval);
            format!(
                "; odd waves have a frequency of {value} {} ({low} … {high}) at q = {}",
                unit_text(&rate),
                with_unit(shell.wave_number, 2, &report.units.powers(-1, 0))
            )
        }
        _ => String::new(),
    };
    format!("{chiral}{odd}.")
}

fn said(report: &WavesReport) -> Vec<String> {
    let range = match (report.seen.iter().min(), report.seen.iter().max()) {
        (Some(low), Some(high)) if low != high => format!("{low} to {high}"),
        (Some(one), _) => one.to_string(),
        _ => "no".into(),
    };
    let field = match report.field {
        "displacements" => "displacements from the mean places of the cells",
        _ if report.velocities == "given" => "the velocities given",
        _ => "displacements until the next frame, as velocities",
    };
    let linear = match (report.verdict, report.linear) {
        ("not_linear", Some(p)) => format!(
            "This is not a linear relaxation without memory: D(q) from τ and from 2τ differ by more than chance has it (p {}). Rates and frequencies are those at the lags stated.",
            relation(p)
        ),
        (_, Some(p)) => format!(
            "D(q) from τ and from 2τ agree (p {}), as they do where waves relax linearly and without memory.",
            relation(p)
        ),
        _ => "Whether waves relax linearly cannot be told.".into(),
    };
    vec![
        format!(
            "{range} cells in {} frames. Waves are those of {field}; covariances are used from a lag of {} on.",
            report.frames.len(),
            match report.first_lag {
                1 => "one frame".into(),
                more => format!("{more} frames"),
            }
        ),
        linear,
    ]
}

fn relation(p: f64) -> String {
    if p < 1e-4 { probability(p) } else { format!("= {}", probability(p)) }
}

/// Moduli over friction by name.
fn moduli(report: &WavesReport) -> Vec<(&'static str, &Measured)> {
    report
        .long_waves
        .iter()
        .flat_map(|own| {
            [
                ("(B + μ)/ζ", &own.B_plus_mu),
                ("μ/ζ", &own.mu),
                ("Kᵒ/ζ", &own.K_o),
                ("(A − Kᵒ)/ζ", &own.A_minus_K_o),
            ]
        })
        .collect()
}

fn cards(report: &WavesReport) -> Vec<Card> {
    let which = if report.verdict == "not_linear" { "at this lag only" } else { "long waves" };
    let card = |label: &str, own: &Measured, digits, which: &str| {
        let note = format!("± {}, {which}", significant(own.standard_error, 1));
        Card::new(label, with_unit(own.value, digits, &own.unit), note)
    };
    let moduli = moduli(report).into_iter().map(|(label, own)| card(label, own, 3, which));
    let localisation = report.localisation.as_ref();
    let localisation = localisation.map(|own| card("error of localisation", own, 2, "in each coordinate"));
    moduli.chain(localisation).collect()
}

/// What is printed.
pub(super) fn summary(report: &WavesReport, out: &Path) -> String {
    let mut text = said(report).join("\n");
    text.push_str("\n\n");
    let _ = writeln!(
        text,
        "  {:>8} {:>18} {:>18} {:>18} {:>18} {:>9} {:>8}",
        "q", "D∥∥", "D⊥⊥", "D∥⊥", "D⊥∥", "frequency", "linear"
    );
    for shell in &report.shells {
        let Some(own) = &shell.relaxation else { continue };
        let entry = |i: usize, j: usize| plus_minus(own.matrix[i][j], own.standard_errors[i][j]);
        let _ = writeln!(
            text,
            "  {:>8} {:>18} {:>18} {:>18} {:>18} {:>9} {:>8}",
            significant(shell.wave_number, 3),
            entry(0, 0),
            entry(1, 1),
            entry(0, 1),
            entry(1, 0),
            significant(own.frequency, 2),
            probability(own.linear)
        );
    }
    text.push('\n');
    for (name, own) in moduli(report) {
        let _ = writeln!(
            text,
            "  {name:14} {} {}",
            plus_minus(own.value, own.standard_error),
            unit_text(&own.unit)
        );
    }
    let _ = writeln!(text, "\n{}", headline(report));
    let _ = writeln!(text, "figures in {}", out.join("report.html").display());
    text
}
