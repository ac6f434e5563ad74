//! The moduli as a report and as a summary.

use super::Arguments;
use super::measure::Measured;
use super::names::{NAMES, VISCOSITY_NAMES};
use super::protocol::Protocol;
use super::replicas::over_replicas;
use crate::arguments::{Spreads, named};
use crate::command::drawing::units_of_model;
use crate::command::simulate::Start;
use crate::command::spectrum::mean_field;
use crate::run::Run;
use std::fmt::Write as _;
use std::path::Path;
use voronudge_model::Parameters;
use voronudge_report::Units;
use voronudge_report::moduli_report::{ModuliReport, ModulusRecord, ReplicaRecord};
use voronudge_report::numbers::significant;
use voronudge_simulate::moduli::{Moduli, Motion, Viscosity};

/// A nonlinearity above this share of the largest modulus means that contacts changed.
const LINEAR: f64 = 0.02;

pub(super) fn report(
    run: &Run,
    starts: &[(u64, Start)],
    (parameters, spreads, length): (&Parameters<f64>, &Spreads, f64),
    protocol: &Protocol,
    measured: &[Measured],
) -> ModuliReport {
    let theory = mean_field(parameters, length);
    let expected = theory.map(|theory| {
        let m = theory.moduli();
        [m.bulk, m.odd_bulk, m.shear, m.odd_shear]
    });
    let count = measured.len() as f64;
    let moduli = NAMES.iter().enumerate().map(|(k, &(name, symbol))| {
        let each =
            |of: fn(&Measured) -> Moduli| measured.iter().map(|m| of(m).to_array()[k]).collect::<Vec<_>>();
        let nonlinearity = each(|m| m.elastic.nonlinearity);
        ModulusRecord {
            affine: Some(each(|m| m.elastic.affine).iter().sum::<f64>() / count),
            nonlinearity: nonlinearity.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs())),
            mean_field: expected.map(|expected| expected[k]),
            ..record(name, symbol, each(|m| m.elastic.moduli), each(|m| m.elastic.errors))
        }
    });
    let moduli = moduli.collect();
    let viscosity = |k: usize| {
        let (name, symbol) = VISCOSITY_NAMES[k];
        let of = |own: &Viscosity| [(own.shear, own.shear_error), (own.odd_shear, own.odd_shear_error)][k];
        let (values, errors) = measured.iter().filter_map(|m| m.viscosity.as_ref().map(of)).unzip();
        record(name, symbol, values, errors)
    };
    let dynamic = super::dynamic::records(&measured.iter().map(|m| m.dynamic.as_slice()).collect::<Vec<_>>());
    let first = &starts[0].1;
    ModuliReport {
        run: run.record(None),
        units: units_of_model(
            &Units { length: first.length_unit.clone(), time: first.time_unit.clone() },
            length,
            parameters.perimeter_elasticity,
        ),
        cells: first.positions.len(),
        parameters: named(parameters),
        cell_spread: spreads.record(),
        settings: settings(protocol),
        moduli,
        prestress: std::array::from_fn(|i| {
            std::array::from_fn(|j| measured.iter().map(|m| m.elastic.prestress[i][j]).sum::<f64>() / count)
        }),
        mean_field_prestress: theory.map(|theory| {
            let mut prestress = theory.prestress();
            let pressure = parameters.area_elasticity * (length * length - parameters.preferred_area);
            (0..2).for_each(|k| prestress[k][k] += pressure);
            prestress
        }),
        viscosities: if protocol.viscosity.is_some() { vec![viscosity(0), viscosity(1)] } else { Vec::new() },
        media: super::dynamic::media(&dynamic),
        dynamic,
        replicas: (starts.iter().zip(measured))
            .map(|((seed, _), Measured { elastic, .. })| ReplicaRecord {
                seed: *seed,
                motion: match elastic.motion {
                    Motion::AtRest => "at_rest",
                    Motion::Flowing => "flowing",
                },
                speed: elastic.speed,
                restless: elastic.restless,
                prestress: elastic.prestress,
                response: elastic.response,
            })
            .collect(),
    }
}

fn record(name: &'static str, symbol: &'static str, values: Vec<f64>, errors: Vec<f64>) -> ModulusRecord {
    let (value, error) = over_replicas(&values, &errors);
    let (affine, nonlinearity, mean_field) = (None, None, None);
    ModulusRecord {
        name,
        symbol,
        value,
        error,
        affine,
        nonlinearity,
        mean_field,
        replicas: values,
        replica_errors: errors,
    }
}

fn settings(protocol: &Protocol) -> std::collections::BTreeMap<&'static str, f64> {
    let voronudge_simulate::moduli::Settings { relaxation, strain, flowing } = protocol.settings;
    let mut settings = std::collections::BTreeMap::from([
        ("dt", relaxation.time_step),
        ("time", relaxation.longest),
        ("strain", strain),
        ("flowing_strain", flowing.strain),
        ("transient", flowing.transient),
        ("average", flowing.time),
    ]);
    if let Some(viscosity) = protocol.viscosity {
        settings.extend([
            ("rate", viscosity.rate),
            ("period", viscosity.period),
            ("periods", viscosity.periods as f64),
        ]);
    }
    settings
}

/// What should be known before using the numbers.
pub(super) fn doubts(measured: &[Measured]) -> Vec<String> {
    let mut doubts = Vec::new();
    let restless: usize = measured.iter().map(|m| m.elastic.restless).sum();
    if restless > 0 {
        doubts.push(format!(
            "{restless} strained states did not come to rest in time: their stress is that of the end; a longer --time helps"
        ));
    }
    let largest = |moduli: Moduli| moduli.to_array().into_iter().map(f64::abs).fold(0.0, f64::max);
    let crooked = |m: &&Measured| {
        m.elastic.motion == Motion::AtRest
            && largest(m.elastic.nonlinearity) > LINEAR * largest(m.elastic.affine)
    };
    let count = measured.iter().filter(crooked).count();
    if count > 0 {
        doubts.push(format!(
            "in {count} of {} replicas the response is not linear: cells change their neighbours under the strain, and the moduli \
             of those replicas mean little; a smaller --strain helps",
            measured.len()
        ));
    }
    doubts
}

pub(super) fn title(arguments: &Arguments) -> String {
    let start = arguments.start.name();
    if arguments.replicas > 1 {
        format!("{start} start, {} replicas", arguments.replicas)
    } else {
        format!("{start} start")
    }
}

/// The answer in a sentence.
pub(super) fn headline(report: &ModuliReport) -> String {
    let at_rest = report.replicas.iter().filter(|replica| replica.motion == "at_rest").count();
    let state = match (at_rest, report.replicas.len()) {
        (0, _) => "The tissue does not come to rest".to_owned(),
        (rest, all) if rest == all => "The tissue is a solid at rest".to_owned(),
        (rest, all) => format!("{rest} of {all} replicas came to rest"),
    };
    let text = |k: usize| {
        let record = &report.moduli[k];
        format!("{} = {} ± {}", record.symbol, significant(record.value, 3), significant(record.error, 1))
    };
    format!("{state}; {}, {}.", text(2), text(3))
}

/// What is printed.
pub(super) fn summary(report: &ModuliReport, out: &Path) -> String {
    let flowing = report.replicas.iter().filter(|replica| replica.motion == "flowing").count();
    let mut text = format!(
        "{} cells, {} replicas, {flowing} of them flowing\n\n{:10}{:>12}{:>10}{:>14}{:>16}\n",
        report.cells,
        report.replicas.len(),
        "",
        "value",
        "error",
        "mean field",
        "no relaxation"
    );
    let number = |value: Option<f64>| value.map_or("–".into(), |value| significant(value, 4));
    for record in report.moduli.iter().chain(&report.viscosities) {
        let _ = writeln!(
            text,
            "{:10}{:>12}{:>10}{:>14}{:>16}",
            record.symbol,
            significant(record.value, 4),
            significant(record.error, 1),
            number(record.mean_field),
            number(record.affine)
        );
    }
    if !report.dynamic.is_empty() {
        let _ = writeln!(text, "\n{:12}{:>12}{:>12}{:>12}{:>12}", "ω", "μ′", "μ″", "Kᵒ′", "Kᵒ″");
    }
    for own in &report.dynamic {
        let shears = own.moduli.iter().filter(|modulus| modulus.name.ends_with("shear"));
        let numbers = shears.flat_map(|modulus| [modulus.storage.value, modulus.loss.value]);
        let cells = numbers.fold(String::new(), |mut row, value| {
            let _ = write!(row, "{:>12}", significant(value, 4));
            row
        });
        let _ = writeln!(text, "{:12}{cells}", significant(own.frequency, 4));
    }
    for own in &report.media {
        let [[mu, odd], [eta, odd_eta]] =
            [own.elasticity, own.viscosity].map(|pair| pair.map(|x| significant(x, 3)));
        let _ = writeln!(
            text,
            "{:12} μ {mu}, Kᵒ {odd}, η {eta}, ηᵒ {odd_eta}; misses the moduli by {}",
            own.arrangement.replace('_', "–"),
            significant(own.missed, 2)
        );
    }
    let _ = writeln!(text, "\nfigures in {}", out.join("report.html").display());
    text
}
