//! The result as a page and as a summary.

use std::fmt::Write as _;
use std::path::Path;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, VERMILLION};
use voronudge_report::figure::{ErrorPoint, PointSeries, PointsAndCurves, points_and_curves};
use voronudge_report::markers::Marker;
use voronudge_report::numbers::{significant, with_interval};
use voronudge_report::page::{Block, Card, Figure, Page, Section, Table};
use voronudge_report::rheology_report::{FittedRheology, RheologyQuantity, RheologyReport};
use voronudge_report::units::label_with_unit;

const GUIDE: &[[&str; 2]] = &[
    [
        "What was done",
        "Tissues are simulated at the fitted parameters, and from where they came to at parameters that are one standard error off, to either side, \
         along each principal axis of the covariance. Their moduli are measured as by voronudge moduli.",
    ],
    [
        "95 % interval",
        "Of the mean over tissues of this size: from the errors of the parameters (to first order) and from the number of tissues. It knows nothing of what \
         the model lacks.",
    ],
    [
        "Scatter",
        "Standard deviation from one disordered tissue of this size to another at the same parameters.",
    ],
    [
        "Moduli",
        "B: tension of a dilation, A: torque of a dilation, μ: shear stress along a shear, Kᵒ: shear stress at 45° to it, over the friction of a cell and \
         therefore rates; η and ηᵒ the same of rates of shear, in units of that friction.",
    ],
];

pub(super) fn page(report: &RheologyReport) -> Page {
    let unit = report.units.powers(0, -1);
    let last = &report.fits[report.fits.len() - 1];
    let card = |own: &RheologyQuantity| {
        let [value, low, high] = with_interval(own.value, own.ci95);
        Card::new(&own.symbol, value, format!("{low} … {high}"))
    };
    let mut sections = Vec::new();
    if report.fits.len() > 1 {
        let figures = last.moduli.iter().map(|own| against(report, own, &unit));
        sections.push(Section::new("In the course of the movie").with(Block::pairs(figures)));
    }
    for fit in &report.fits {
        let heading = if report.fits.len() > 1 {
            format!("{} {}", report.against, significant(fit.at, 4))
        } else {
            "Moduli".into()
        };
        let parameters =
            fit.parameters.iter().map(|(name, value)| format!("{name} {}", significant(*value, 3)));
        let text = format!(
            "{}: {}; {} of {} tissues came to rest; {} axes of the covariance.",
            fit.path,
            parameters.collect::<Vec<_>>().join(", "),
            fit.at_rest,
            fit.at_rest + fit.flowing,
            fit.axes
        );
        let moduli =
            Section::new(heading).with(Block::paragraph(text)).with(Block::table(table(&fit.moduli)));
        sections.push(moduli);
        if !fit.dynamic.is_empty() {
            let figures = [("shear", "μ"), ("odd_shear", "Kᵒ")]
                .map(|(name, symbol)| over_frequency(fit, name, symbol, &unit));
            sections.push(Section::new("Storage and loss moduli").with(Block::pairs(figures)));
        }
    }
    Page {
        summary: vec![Block::summary(format!(
            "{} cells in each of {} tissues; moduli in {unit}, over the friction of a cell; viscosities in units of it.",
            report.cells,
            report.seeds.len()
        ))],
        cards: last.moduli.iter().map(card).collect(),
        guide: vec![Block::terms(GUIDE)],
        sections,
        ..Page::new("Rheology of a fitted tissue", headline(report), &report.run)
    }
}

fn table(quantities: &[RheologyQuantity]) -> Table {
    let header =
        ["", "value", "95 % interval", "from the fit", "from the simulation", "scatter", "mean field"];
    let row = |own: &RheologyQuantity| {
        let [value, low, high] = with_interval(own.value, own.ci95);
        vec![
            own.symbol.clone(),
            value,
            format!("{low} … {high}"),
            significant(own.inference_error, 2),
            significant(own.simulation_error, 2),
            significant(own.scatter, 2),
            own.mean_field.map_or("–".into(), |value| significant(value, 3)),
        ]
    };
    Table::new(header).rows(quantities.iter().map(row))
}

/// A quantity against time or frame, with half its interval as bars.
fn against(report: &RheologyReport, of: &RheologyQuantity, unit: &str) -> Figure {
    let points = report.fits.iter().filter_map(|fit| {
        let own = fit.moduli.iter().find(|own| own.name == of.name)?;
        Some(ErrorPoint { at: [fit.at, own.value], error: [None, Some(own.ci95[1] - own.value)] })
    });
    let label = if of.name.ends_with("viscosity") {
        format!("{} (friction of a cell)", of.symbol)
    } else {
        label_with_unit(&of.symbol, unit)
    };
    let place = match report.against {
        "time" => label_with_unit("time", &report.units.time),
        other => other.to_owned(),
    };
    let series = [PointSeries { label: "", colour: BLUE, marker: Marker::Circle, points: points.collect() }];
    let svg = points_and_curves(&PointsAndCurves {
        title: &format!("{} in the course of the movie", of.symbol),
        labels: [&place, &label],
        scales: [AxisScale::Linear; 2],
        series: &series,
        curves: &[],
    });
    Figure::new(svg, &format!("{}; bars are 95 % intervals", of.name.replace('_', " ")))
}

fn over_frequency(fit: &FittedRheology, name: &str, symbol: &str, unit: &str) -> Figure {
    let points = |part: &str| -> Vec<ErrorPoint> {
        let wanted = format!("{name}_{part}");
        let at = fit.dynamic.iter().filter_map(|record| {
            let own = record.moduli.iter().find(|own| own.name == wanted)?;
            Some(ErrorPoint {
                at: [record.frequency, own.value],
                error: [None, Some(own.ci95[1] - own.value)],
            })
        });
        at.collect()
    };
    let labels = [format!("{symbol}′, in phase"), format!("{symbol}″, out of phase")];
    let series = [
        PointSeries { label: &labels[0], colour: BLUE, marker: Marker::Circle, points: points("storage") },
        PointSeries {
            label: &labels[1],
            colour: VERMILLION,
            marker: Marker::Diamond,
            points: points("loss"),
        },
    ];
    let svg = points_and_curves(&PointsAndCurves {
        title: &format!("{symbol} against frequency"),
        labels: [
            &label_with_unit("angular frequency ω", unit),
            &label_with_unit(&format!("{symbol}*"), unit),
        ],
        scales: [AxisScale::Logarithmic, AxisScale::Linear],
        series: &series,
        curves: &[],
    });
    Figure::new(
        svg,
        &format!(
            "{} modulus against the frequency of the strain; bars are 95 % intervals",
            name.replace('_', " ")
        ),
    )
}

/// The answer in a sentence: of the last fit.
fn headline(report: &RheologyReport) -> String {
    let last = &report.fits[report.fits.len() - 1];
    let state = match (last.at_rest, last.flowing) {
        (_, 0) => "A tissue of the fitted parameters is a solid",
        (0, _) => "A tissue of the fitted parameters flows",
        _ => "Of tissues of the fitted parameters some are solid and some flow",
    };
    let text = |name: &str| {
        let own = last.moduli.iter().find(|own| own.name == name);
        own.map_or(String::new(), |own| {
            let [value, low, high] = with_interval(own.value, own.ci95);
            format!("{} = {value} ({low} to {high})", own.symbol)
        })
    };
    let at = if report.fits.len() > 1 {
        format!(" at {} {}", report.against, significant(last.at, 4))
    } else {
        String::new()
    };
    format!("{state}{at}: {}, {}.", text("shear"), text("odd_bulk"))
}

/// What is printed.
pub(super) fn summary(report: &RheologyReport, out: &Path) -> String {
    let mut text = String::new();
    for fit in &report.fits {
        let _ = writeln!(
            text,
            "{} ({} {}): {} tissues at rest, {} flowing",
            fit.path,
            report.against,
            significant(fit.at, 4),
            fit.at_rest,
            fit.flowing
        );
        for own in &fit.moduli {
            let [value, low, high] = with_interval(own.value, own.ci95);
            let _ = writeln!(text, "  {:4}{value:>12}  [{low}, {high}]", own.symbol);
        }
        for record in &fit.dynamic {
            let shears = record.moduli.iter().filter(|own| own.name.contains("shear"));
            let cells = shears.map(|own| format!("{} {}", own.symbol, significant(own.value, 3)));
            let _ = writeln!(
                text,
                "  ω {}: {}",
                significant(record.frequency, 3),
                cells.collect::<Vec<_>>().join(", ")
            );
        }
    }
    let _ = writeln!(text, "{}\nfigures in {}", headline(report), out.join("report.html").display());
    text
}
