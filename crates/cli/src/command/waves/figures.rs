//! Figures of the page.

use super::beside::Beside;
use voronudge_observables::{
    DynamicStructure, Fluctuations, RateMatrix, Relaxation, StructurePart, WaveField,
};
use voronudge_report::Units;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, Palette, VERMILLION};
use voronudge_report::figure::{
    CurveSeries, ErrorPoint, LineStyle, MapLine, PhaseMap, PointSeries, PointsAndCurves, Stroke, phase_map,
    points_and_curves,
};
use voronudge_report::markers::Marker;
use voronudge_report::page::Figure;
use voronudge_report::units::label_with_unit;
use voronudge_report::waves_report::Rates;

/// Colours of two entries or eigenvalues.
const COLOURS: [&str; 2] = [BLUE, VERMILLION];

/// Frequencies are shown up to so many times the fastest rate that was found.
const SHOWN: f64 = 3.0;
/// So many are shown at least.
const FEWEST: usize = 12;

/// Points with their errors, for two quantities of a shell, beside what a model has for them.
struct Pair<'a> {
    title: &'a str,
    label: &'a str,
    names: [&'a str; 2],
    measured: fn(&Relaxation, usize) -> (f64, [f64; 2]),
    model: fn(&Rates, usize) -> f64,
    caption: &'a str,
}

/// What relaxes how fast.
pub(super) fn relaxation(found: &Fluctuations, beside: &Beside, units: &Units) -> Vec<Figure> {
    let pairs = [
        Pair {
            title: "D(q) on the diagonal",
            label: "rate",
            names: ["along q", "across q"],
            measured: |own, k| (own.matrix[k][k], [own.standard_errors[k][k]; 2]),
            model: |rates, k| rates[k][k],
            caption: "Entries of D(q) on the diagonal with one standard error: how fast compression and shear relax.",
        },
        Pair {
            title: "D(q) off the diagonal",
            label: "rate",
            names: ["force along, displaced across", "force across, displaced along"],
            measured: |own, k| (own.matrix[k][1 - k], [own.standard_errors[k][1 - k]; 2]),
            model: |rates, k| rates[k][1 - k],
            caption: "Entries off the diagonal with one standard error. They change sign in a mirror: without chirality they are zero.",
        },
        Pair {
            title: "decay rates",
            label: "decay rate",
            names: ["slower", "faster"],
            measured: |own, k| (own.decay_rates[k], [own.decay_errors[k]; 2]),
            model: |rates, k| RateMatrix(*rates).decay_rates()[k],
            caption: "Real parts of the eigenvalues of D(q), with one standard error. Where waves oscillate the two are one.",
        },
        Pair {
            title: "frequency of odd waves",
            label: "angular frequency",
            names: ["", ""],
            measured: |own, _| {
                let [low, high] = own.frequency_interval;
                (own.frequency, [own.frequency - low, high - own.frequency])
            },
            model: |rates, _| RateMatrix(*rates).frequency(),
            caption: "Imaginary part of the eigenvalues of D(q). Bars are the half of the 95 % interval that is larger; zero where waves only decay.",
        },
    ];
    pairs.iter().map(|pair| drawn(pair, found, beside, units)).collect()
}

fn drawn(pair: &Pair<'_>, found: &Fluctuations, beside: &Beside, units: &Units) -> Figure {
    let both = if pair.names[1].is_empty() { 1 } else { 2 };
    let measured = |k: usize| PointSeries {
        label: pair.names[k],
        colour: COLOURS[k],
        marker: if k == 0 { Marker::Circle } else { Marker::Square },
        points: found
            .shells
            .iter()
            .filter_map(|shell| {
                let (value, [low, high]) = (pair.measured)(shell.relaxation.as_ref()?, k);
                Some(ErrorPoint { at: [shell.wave_number, value], error: [None, Some(low.max(high))] })
            })
            .collect(),
    };
    let of_shells = |of: fn(&super::beside::OfShell) -> Option<Rates>, k: usize| -> Vec<[f64; 2]> {
        let shells = found.shells.iter().zip(&beside.shells);
        shells.filter_map(|(shell, own)| Some([shell.wave_number, (pair.model)(&of(own)?, k)])).collect()
    };
    let mut curves = Vec::new();
    for (k, colour) in COLOURS.into_iter().enumerate().take(both) {
        let line: Vec<[f64; 2]> = beside.line.iter().map(|(q, rates)| [*q, (pair.model)(rates, k)]).collect();
        let named = |label: &'static str| if k == 0 { label } else { "" };
        let sorts = [
            (named("mean field"), Stroke::Solid, line),
            (named("Jacobian"), Stroke::Dashed, of_shells(|own| own.projected, k)),
            (named("Jacobian, relaxed"), Stroke::Dotted, of_shells(|own| own.relaxed, k)),
        ];
        for (label, stroke, points) in sorts {
            if !points.is_empty() {
                curves.push(CurveSeries { label, colour, stroke, points });
            }
        }
    }
    let series: Vec<PointSeries<'_>> = (0..both).map(measured).collect();
    let labels = [wave_number(units), label_with_unit(pair.label, &units.powers(0, -1))];
    let svg = points_and_curves(&PointsAndCurves {
        title: pair.title,
        labels: [&labels[0], &labels[1]],
        scales: [AxisScale::Linear; 2],
        series: &series,
        curves: &curves,
    });
    Figure::new(svg, pair.caption)
}

fn wave_number(units: &Units) -> String {
    label_with_unit("wave number", &units.powers(-1, 0))
}

/// Dynamic structure factors as maps over wave number and frequency, with the dispersion of D(q) over them.
pub(super) fn spectra(found: &Fluctuations, beside: &Beside, units: &Units) -> Vec<Figure> {
    let Some(structure) = &found.structure else { return Vec::new() };
    let shown = shown(found, structure);
    let of_field = match found.field {
        WaveField::Displacements => units.powers(2, 1),
        WaveField::Velocities => units.powers(2, -1),
    };
    let q: Vec<f64> = found.shells.iter().map(|shell| shell.wave_number).collect();
    let lines = lines(found, beside);
    let axes = [wave_number(units), label_with_unit("angular frequency", &units.powers(0, -1))];
    let map = |title: &str, label: &str, caption: &str, scale, palette, of: &dyn Fn(usize, usize) -> f64| {
        let values: Vec<f64> = (0..shown)
            .flat_map(|frequency| (0..q.len()).map(move |shell| (shell, frequency)))
            .map(|(s, f)| of(s, f))
            .collect();
        let svg = phase_map(&PhaseMap {
            title,
            label,
            x: (&axes[0], &q),
            y: (&axes[1], &structure.frequencies[..shown]),
            values: &values,
            scale,
            palette,
            lines: &lines,
        });
        Figure::new(svg, caption)
    };
    let value = |part: StructurePart, shell: usize, frequency: usize| {
        structure.parts[part as usize][shell][frequency][0]
    };
    let power = |part: StructurePart| move |shell: usize, frequency: usize| value(part, shell, frequency);
    let share = |part: StructurePart| {
        move |shell: usize, frequency: usize| {
            let both = value(StructurePart::Longitudinal, shell, frequency)
                + value(StructurePart::Transverse, shell, frequency);
            2.0 * value(part, shell, frequency) / both
        }
    };
    let logarithmic = |title: &str, unit: &str, caption: &str, part| {
        map(
            title,
            &label_with_unit(title, unit),
            caption,
            AxisScale::Logarithmic,
            Palette::Sequential,
            &power(part),
        )
    };
    let signed = |title: &str, caption: &str, part| {
        map(title, title, caption, AxisScale::Linear, Palette::Diverging { centre: 0.0 }, &share(part))
    };
    vec![
        logarithmic(
            "C∥(q, ω)",
            &of_field,
            "Power of what moves along the wave vector: compression.",
            StructurePart::Longitudinal,
        ),
        logarithmic(
            "C⊥(q, ω)",
            &of_field,
            "Power of what moves across the wave vector: shear.",
            StructurePart::Transverse,
        ),
        signed(
            "2 Im C∥⊥/(C∥ + C⊥)",
            "Sense of rotation: +1 where all waves turn clockwise with time, from across to along q, −1 where they turn anticlockwise. Without chirality it is zero.",
            StructurePart::OddImaginary,
        ),
        signed(
            "2 Re C∥⊥/(C∥ + C⊥)",
            "What moves along q and across it at the same time. Without chirality it is zero.",
            StructurePart::OddReal,
        ),
        logarithmic("S(q, ω)", &units.powers(0, 1), "Power of the density.", StructurePart::Density),
    ]
}

/// How many frequencies are shown: up to a few times the fastest rate.
fn shown(found: &Fluctuations, structure: &DynamicStructure) -> usize {
    let told = found.shells.iter().filter_map(|shell| shell.relaxation.as_ref());
    let fastest = told.map(|own| own.decay_rates[1].max(own.frequency)).filter(|rate| rate.is_finite());
    let limit = SHOWN * fastest.fold(0.0, f64::max);
    let within = structure.frequencies.iter().take_while(|omega| **omega <= limit).count();
    within.max(FEWEST).min(structure.frequencies.len())
}

/// Frequencies of the fit and of the model against wave number.
fn lines(found: &Fluctuations, beside: &Beside) -> Vec<MapLine> {
    let fitted = found
        .shells
        .iter()
        .filter_map(|shell| Some([shell.wave_number, shell.relaxation.as_ref()?.frequency]));
    let of_model = |rates: &Rates| RateMatrix(*rates).frequency();
    let jacobian = found.shells.iter().zip(&beside.shells);
    let jacobian =
        jacobian.filter_map(|(shell, own)| Some([shell.wave_number, of_model(own.projected.as_ref()?)]));
    let theory = beside.line.iter().map(|(q, rates)| [*q, of_model(rates)]);
    [
        ("frequency of D(q) as fitted", LineStyle::Solid, fitted.collect::<Vec<_>>()),
        ("Jacobian", LineStyle::Dashed, jacobian.collect()),
        ("mean field", LineStyle::Dotted, theory.collect()),
    ]
    .into_iter()
    .filter(|(_, _, points)| points.iter().any(|at| at[1] > 0.0))
    .map(|(label, style, points)| MapLine { label: label.into(), points, style })
    .collect()
}
