//! The result as a page and as a summary.

use std::fmt::Write as _;
use std::path::Path;
use voronudge_infer::phase_diffusion::PhaseDiffusion;
use voronudge_report::figure::{GrowthCurve, GrowthPoint, growth_matrix};
use voronudge_report::numbers::{significant, with_interval};
use voronudge_report::page::{Block, Card, Figure, Page, Section, Table};
use voronudge_report::phase_diffusion_report::{Diffusivity, PhaseDiffusionReport};
use voronudge_report::units::unit_text;

/// Cross diffusivities beyond so many standard errors, of both together, are told from none: 95 % of χ² with two degrees of freedom.
const SIGNIFICANT: f64 = 2.448;
/// Points of the fitted lines.
const CURVE: usize = 60;

const GUIDE: &[[&str; 2]] = &[
    [
        "The equation",
        "∂_t u = D∥ ∇(∇·u) + D⊥ Δu + D∥ˣ ε·∇(∇·u) + D⊥ˣ ε·Δu, where u is the displacement of the pattern and ε the clockwise \
         quarter turn, ε_xy = 1.",
    ],
    [
        "The matrix D(q)",
        "A plane wave of the displacement obeys ∂_t u = −D(q) u. In components along the wave vector (∥) and a quarter turn ahead (⊥), \
         D(q) = q² [[D∥ + D⊥, D⊥ˣ], [−D∥ˣ − D⊥ˣ, D⊥]].",
    ],
    [
        "Cross diffusivities",
        "They turn: a compressed stripe also slides along itself. Only a chiral pattern has them, and a mirror changes their sign.",
    ],
    [
        "Moduli",
        "D∥ = B/ζ, D⊥ = μ/ζ, D⊥ˣ = Kᵒ/ζ and D∥ˣ = −A/ζ, with the moduli as voronudge defines them and ζ = γ/ℓ₀².",
    ],
];

pub(super) fn page(title: &str, report: &PhaseDiffusionReport, found: &PhaseDiffusion) -> Page {
    let d = &report.diffusivities;
    let rows = named(report).map(|(name, estimate)| {
        let [value, low, high] = with_interval(estimate.value, estimate.ci95);
        [name.to_owned(), value, format!("{low} … {high}"), unit_text(&estimate.unit)]
    });
    let moduli = [
        ("B", &report.moduli.B),
        ("μ", &report.moduli.mu),
        ("Kᵒ", &report.moduli.K_o),
        ("A", &report.moduli.A),
    ];
    let modulus_rows = moduli
        .map(|(name, modulus)| [name.to_owned(), significant(modulus.value, 3), unit_text(&modulus.unit)]);
    let points: Vec<GrowthPoint> = found
        .waves
        .iter()
        .zip(&found.own)
        .filter_map(|(wave, own)| {
            let own = (*own)?;
            Some(GrowthPoint { square: wave.square(), matrix: own.matrix, errors: own.standard_errors })
        })
        .collect();
    let end = found.waves.last().map_or(0.0, |wave| wave.square());
    let curve: Vec<GrowthCurve> = (0..=CURVE)
        .map(|k| end * k as f64 / CURVE as f64)
        .map(|square| GrowthCurve { square, matrix: found.matrix(square) })
        .collect();
    let card = |label: &str, estimate: &Diffusivity| {
        let [value, low, high] = with_interval(estimate.value, estimate.ci95);
        Card::new(label, format!("{value} {}", unit_text(&estimate.unit)), format!("{low} … {high}"))
    };
    let summary = format!(
        "{} cells in {} frames; {} wave vectors, rates up to {} order in q. {} The equation explains {} % of the changes of the \
         amplitudes; residuals of consecutive frames correlate by {}.",
        report.cells,
        report.frames.len(),
        report.wave_vectors.len(),
        report.order,
        match report.reference {
            "given" => "The places of rest were given.",
            _ => "The places of rest were fitted along.",
        },
        significant(100.0 * report.explained, 4),
        significant(report.residual_correlation, 2)
    );
    let growth = Figure::new(
        growth_matrix(&points, &curve, &report.units),
        "Entries of D(q), fitted to each wave vector alone (marks, with one standard error) and to all together (lines). Without \
         chirality those off the diagonal are zero.",
    );
    Page {
        summary: vec![Block::summary(summary)],
        cards: vec![
            card("D∥", &d.D_parallel),
            card("D⊥", &d.D_perp),
            card("D∥ˣ", &d.D_parallel_cross),
            card("D⊥ˣ", &d.D_perp_cross),
        ],
        guide: vec![Block::terms(GUIDE)],
        sections: vec![
            Section::new("Growth matrix").with(Block::pairs([growth])),
            Section::new("Phase diffusivities")
                .with(Block::table(Table::new(["", "value", "95 % interval", "unit"]).rows(rows))),
            Section::new("Moduli they imply, over the friction of a cell")
                .with(Block::table(Table::new(["", "value", "unit"]).rows(modulus_rows))),
        ],
        ..Page::new(title, headline(report), &report.run)
    }
}

fn named(report: &PhaseDiffusionReport) -> [(&'static str, &Diffusivity); 4] {
    let d = &report.diffusivities;
    [("D∥", &d.D_parallel), ("D⊥", &d.D_perp), ("D∥ˣ", &d.D_parallel_cross), ("D⊥ˣ", &d.D_perp_cross)]
}

fn headline(report: &PhaseDiffusionReport) -> String {
    let sigma = significant(report.chirality_significance, 2);
    let chirality = if report.chirality_significance > SIGNIFICANT {
        format!("The pattern is chiral: its cross diffusivities are {sigma} standard errors from none")
    } else {
        format!("No chirality is seen: the cross diffusivities are {sigma} standard errors from none")
    };
    let d = &report.diffusivities;
    let unstable = d.D_perp.ci95[1] < 0.0 || d.D_parallel.ci95[1] + d.D_perp.ci95[1] < 0.0;
    let rest = if unstable { "; long waves grow, so the pattern is not stable." } else { "." };
    format!("{chirality}{rest}")
}

/// What is printed.
pub(super) fn summary(report: &PhaseDiffusionReport, out: &Path) -> String {
    let mut text = format!(
        "{} cells in {} frames, {} wave vectors; {} % of the changes explained\n",
        report.cells,
        report.frames.len(),
        report.wave_vectors.len(),
        significant(100.0 * report.explained, 4)
    );
    for (name, estimate) in named(report) {
        let [value, low, high] = with_interval(estimate.value, estimate.ci95);
        let _ = writeln!(text, "  {name:8} {value}  [{low}, {high}]  {}", unit_text(&estimate.unit));
    }
    let _ = writeln!(text, "{}", headline(report));
    let _ = writeln!(text, "figures in {}", out.join("report.html").display());
    text
}
