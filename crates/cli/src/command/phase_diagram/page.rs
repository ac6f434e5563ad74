//! A diagram as a page.

use voronudge_report::PhaseReport;
use voronudge_report::numbers::{NO_VALUE, as_given, significant};
use voronudge_report::page::{Block, Card, Figure, Page, Section, Table, Text};
use voronudge_report::phase_report::{CollapseRecord, FailedRun, QuantityRecord};

const INTRODUCTION: &str = "Every rectangle stands for runs at one preferred perimeter P_0 and one cortical chirality α, from random positions. Lengths are in ℓ_0, \
    the root of the mean cell area, rates in K_P. Velocities and T1 transitions are means over the second half of the run.";

pub(super) fn page(headline: &str, report: &PhaseReport, maps: Vec<Figure>, collapse: Vec<Figure>) -> Page {
    let header = ["quantity", "least", "P_0", "α", "largest", "P_0", "α", "unknown"];
    let diagram = Section::new("Diagram")
        .with(Block::pairs(maps))
        .with(Block::table(Table::new(header).rows(report.quantities.iter().map(quantity_row))));
    Page {
        cards: cards(report),
        guide: vec![Block::paragraph(INTRODUCTION), guide(report)],
        sections: vec![
            diagram,
            scaling(report, collapse),
            Section::new("Runs that failed").with(Block::facts(report.failed.iter().map(failed_run))),
        ],
        ..Page::new("phase diagram", headline, &report.run)
    }
}

fn guide(report: &PhaseReport) -> Block {
    let lines = format!(
        "P_0* = 3.81 − |α| is the transition of disordered tissues that the paper found for |α| ≤ 0.2. P_{{MF}} = {} is where a honeycomb becomes unstable, and \
         the exceptional line is where its first unstable mode begins to oscillate; both are mean-field theory.",
        significant(report.lines.honeycomb_limit, 5)
    );
    Block::terms(&[
        ["Lines", &lines],
        [
            "Solid and liquid",
            "Cells of a solid come to rest; those of a chiral liquid move without end. A value of ⟨v²⟩ that is small but not zero can be a solid that has not yet come \
             to rest.",
        ],
        [
            "Order",
            "Ψ_6 is one on a triangular lattice. The mean modulus is blind to the orientation of grains.",
        ],
    ])
}

fn cards(report: &PhaseReport) -> Vec<Card> {
    let [columns, rows] = [report.preferred_perimeters.len(), report.chiralities.len()];
    let runs = match report.replicas {
        1 => "one run each".into(),
        replicas => format!("{replicas} runs each"),
    };
    let [low, high] = report.steps.map(|step| as_given((step * 1e4).round() / 1e4));
    let steps = if low == high { format!("steps of {low}") } else { format!("steps of {low} to {high}") };
    let mut cards = vec![
        Card::new("points", format!("{columns} × {rows}"), runs),
        Card::new("cells", report.cells.to_string(), "periodic square box"),
        Card::new("duration of a run", format!("{} / Kₚ", as_given(report.time)), steps),
    ];
    if let Some(collapse) = &report.collapse {
        let fitted = collapse.fitted;
        let [beta, phi] = [fitted.beta, fitted.phi].map(|own| significant(own.value, 2));
        let scatter = format!("fitted; scatter {} in ln ⟨v²⟩", significant(fitted.scatter, 2));
        cards.push(Card::new("scaling exponents", format!("β = {beta}, φ = {phi}"), scatter));
    }
    cards
}

fn quantity_row((name, quantity): (&&str, &QuantityRecord)) -> Vec<String> {
    let ends = [quantity.least, quantity.largest].map(|end| match end {
        Some(end) => [end.value, end.preferred_perimeter, end.chirality].map(|own| significant(own, 3)),
        None => [NO_VALUE.to_owned(), String::new(), String::new()],
    });
    let ends = ends.into_iter().flatten();
    [name.replace('_', " ")].into_iter().chain(ends).chain([quantity.unknown.to_string()]).collect()
}

fn scaling(report: &PhaseReport, figures: Vec<Figure>) -> Section {
    let section = Section::new("Scaling about the transition");
    let Some(collapse) = &report.collapse else {
        let why = report.no_collapse.as_deref().unwrap_or_default();
        return section.with(Block::paragraph(Text::plain(why)));
    };
    let header = ["", "β", "95 % interval", "φ", "95 % interval", "scatter in ln ⟨v²⟩"];
    section
        .with(Block::paragraph(law(collapse)))
        .with(Block::table(Table::new(header).rows(exponent_rows(collapse))))
        .with(Block::remark(format!(
            "Scatter is the root mean square distance from one curve: 0.7 is a factor of two. Intervals are from {} bootstrap samples of the points; they do not \
             know of errors of P_0*.",
            collapse.fitted.samples
        )))
        .with(Block::pairs(figures))
}

fn law(own: &CollapseRecord) -> Text {
    let [low, high] = own.alpha;
    Text::from("⟨v²⟩/|α|")
        + Text::superscript(format!("{:?}", own.amplitude_exponent))
        + " = |ΔP|"
        + Text::superscript("β")
        + " V_{±}(|α|/|ΔP|"
        + Text::superscript("φ")
        + format!(
            ") with ΔP = P_0 − P_0*(α). If it holds, points of all chiralities lie on one curve on each side of the transition. {} points with |α| from {low:?} to \
             {high:?} and ⟨v²⟩ above {} are compared; {} are at rest.",
            own.points,
            significant(own.least_velocity, 1),
            own.at_rest
        )
}

fn exponent_rows(own: &CollapseRecord) -> [[String; 6]; 2] {
    let (given, fitted) = (own.given, own.fitted);
    let number = |value: f64| significant(value, 3);
    let interval = |[low, high]: [f64; 2]| format!("{} to {}", number(low), number(high));
    [
        [
            "given".into(),
            number(given.beta),
            String::new(),
            number(given.phi),
            String::new(),
            given.scatter.map_or("curves apart".into(), number),
        ],
        [
            "fitted".into(),
            number(fitted.beta.value),
            interval(fitted.beta.interval),
            number(fitted.phi.value),
            interval(fitted.phi.interval),
            number(fitted.scatter),
        ],
    ]
}

fn failed_run(run: &FailedRun) -> [Text; 2] {
    let [perimeter, chirality] = [run.preferred_perimeter, run.chirality].map(|own| significant(own, 4));
    let place = format!("P_0 = {perimeter}, α = {chirality}, run {}", run.replica);
    [place.into(), Text::plain(&run.error)]
}
