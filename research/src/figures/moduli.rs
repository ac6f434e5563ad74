//! Elastic moduli over preferred perimeter and chirality.

use super::phases::{Field, over_perimeter};
use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size, command};
use crate::study::{Replicas, mean, parameters, random};
use std::error::Error;
use std::ops::ControlFlow;
use voronudge_report::chart::AxisScale;
use voronudge_report::figure::ErrorPoint;
use voronudge_simulate::collapse::critical_perimeter;
use voronudge_simulate::moduli::{self, Relaxation};
use voronudge_theory::{MeanField, Moduli, Parameters};

pub(super) const FIGURES: &[Figure] = &[
    Figure {
        name: "2c-m1b-moduli",
        title: "elastic moduli of disordered tissues",
        stated: "μ falls with P₀ and vanishes at P₀* = 3.81 − |α|, as one function of the distance from it; in solids B, μ and Kᵒ follow the \
             mean field, in which A = 0",
        make: elastic,
    },
    Figure {
        name: "moduli-abc",
        title: "the odd shear modulus of disordered solids after a step strain",
        stated: "μ and Kᵒ of solids are those of the mean field",
        make: after_a_step,
    },
    Figure {
        name: "moduli-ghi",
        title: "viscosities of the liquid",
        stated: "the chiral liquid has a shear viscosity η, negative for large |α|, and an odd viscosity ηᵒ that saturates and is opposite for \
                 opposite α; −0.1 and −0.09 γ for HT1080 (P₀ = 4.0, α = 2.9)",
        make: viscous,
    },
];

fn elastic(size: Size) -> Result<Made, Box<dyn Error>> {
    let output = command::run(size.pick(
        "phase-diagram --P_0 3 3.2 2 --alpha 0 0.2 2 --cells 36 --time 4 --quantities shear_modulus,odd_shear_modulus,bulk_modulus,odd_bulk_modulus",
        "phase-diagram --P_0 3 4 11 --alpha 0 0.3 4 --cells 64 --replicas 4 --time 50 --dt 0.02 --quantities shear_modulus,odd_shear_modulus,bulk_modulus,odd_bulk_modulus",
    ))?;
    let shear = Field::read(&output, "shear_modulus")?;
    let theory = |of: fn(&Moduli) -> f64, field: &Field| -> Result<Vec<Series>, Box<dyn Error>> {
        let row = |&chirality: &f64| -> Result<Series, Box<dyn Error>> {
            let point = |&preferred_perimeter: &f64| -> Result<ErrorPoint, Box<dyn Error>> {
                let parameters = Parameters {
                    area_elasticity: 0.1,
                    preferred_perimeter,
                    chirality,
                    ..Parameters::default()
                };
                Ok([preferred_perimeter, of(&MeanField::new(parameters)?.moduli())].into())
            };
            let points = field.preferred_perimeters.iter().map(point).collect::<Result<_, _>>()?;
            Ok(Series { name: String::new(), drawn: Drawn::BrokenLine, points })
        };
        field.chiralities.iter().map(row).collect()
    };
    let mut panels = Vec::new();
    for (name, quantity, label, of) in [
        ("mu", "shear_modulus", "μ / K_P", (|m| m.shear) as fn(&Moduli) -> f64),
        ("ko", "odd_shear_modulus", "Kᵒ / K_P", |m| m.odd_shear),
        ("b", "bulk_modulus", "B / K_P", |m| m.bulk),
        ("a", "odd_bulk_modulus", "A / K_P", |m| m.odd_bulk),
    ] {
        let field = Field::read(&output, quantity)?;
        let errors = Field::read(&output, &format!("{quantity}_error"))?;
        let svg = over_perimeter(label, label, &field, Some(&errors), theory(of, &field)?);
        panels.push(Panel {
            name,
            caption: format!(
                "{label}; broken lines are the mean field of the honeycomb, within the range of the values"
            ),
            svg,
        });
    }
    let distance: Vec<Series> = shear
        .rows()
        .map(|(alpha, row)| Series {
            name: format!("α = {alpha}"),
            drawn: Drawn::JoinedMarks,
            points: row.into_iter().map(|[p, mu]| [p - critical_perimeter(alpha), mu].into()).collect(),
        })
        .collect();
    panels.push(Panel {
        name: "distance",
        caption: "μ against the distance from the transition, P₀ − 3.81 + |α|".into(),
        svg: super::chart(
            "μ against the distance from the transition",
            ["ΔP_0 / ℓ_0", "μ / K_P"],
            EVEN,
            &distance,
        ),
    });
    let mut found = Vec::new();
    for (symbol, quantity) in [("μ", "shear_modulus"), ("A", "odd_bulk_modulus")] {
        let ends =
            ends(&Field::read(&output, quantity)?, &Field::read(&output, &format!("{quantity}_error"))?);
        found.push(format!("{symbol}/K_P is {}.", ends.join("; ")));
    }
    let shear_errors = Field::read(&output, "shear_modulus_error")?;
    let distance = -0.3;
    let alike: Vec<String> = (shear.rows().zip(shear_errors.rows()))
        .filter_map(|((alpha, row), (_, errors))| {
            let value = at(&row, critical_perimeter(alpha) + distance)?;
            let error = at(&errors, critical_perimeter(alpha) + distance)?;
            Some(format!("{value:.3} ± {error:.3} at α = {alpha}"))
        })
        .collect();
    found.push(format!(
        "At the same distance {distance} from the transition μ/K_P is {}: it is not one function of the distance.",
        alike.join(", ")
    ));
    let last = shear.preferred_perimeters.last().copied().unwrap_or(f64::NAN);
    found.push(format!(
        "So A is not that of the honeycomb, which has A = 0, wherever there is chirality: in solids by displacements that do not follow \
         the strain (see [moduli](commands/moduli.md#what-was-measured)), in liquids because perimeters grow less than lengths do. If they \
         did not grow at all, A/K_P would be α P₀²/2, that is {:.1} α at P₀ = {last}.",
        0.5 * last.powi(2)
    ));
    Ok(Made { settings: output.typed.clone(), found, panels })
}

/// A value of a row, by linear interpolation.
fn at(row: &[[f64; 2]], place: f64) -> Option<f64> {
    let pair = row.windows(2).find(|pair| pair[0][0] <= place && place <= pair[1][0])?;
    let [[a, low], [b, high]] = [pair[0], pair[1]];
    Some(low + (high - low) * (place - a) / (b - a))
}

/// The first and the last value of each row, with errors.
fn ends(field: &Field, errors: &Field) -> Vec<String> {
    let both = field.rows().zip(errors.rows());
    let words = both.filter_map(|((alpha, values), (_, errors))| {
        let end = |value: &[f64; 2], error: &[f64; 2]| {
            // Minus zero is zero.
            format!("{:.3} ± {:.3} at P₀ = {}", (1e3 * value[1]).round() / 1e3 + 0.0, error[1], value[0])
        };
        let [first, last] = [end(values.first()?, errors.first()?), end(values.last()?, errors.last()?)];
        Some(format!("{first} and {last} for α = {alpha}"))
    });
    words.collect()
}

/// Kᵒ and μ in time after a step strain of solids at rest, P₀ = 3, over those of the honeycomb.
fn after_a_step(size: Size) -> Result<Made, Box<dyn Error>> {
    let (cells, count, chiralities): (_, _, &[f64]) = size.pick((25, 2, &[1.0]), (100, 20, &[0.3, 1.0]));
    let times: Vec<f64> = [0.0].into_iter().chain((0..13).map(|k| 0.01 * 2f64.powi(k))).collect();
    let relaxation = Relaxation { longest: 300.0, ..Relaxation::default() };
    let (mut series, mut found) = (Vec::new(), Vec::new());
    for &chirality in chiralities {
        let at = parameters(3.0, chirality);
        let theory = MeanField::new(Parameters {
            area_elasticity: at.area_elasticity,
            preferred_perimeter: at.preferred_perimeter,
            chirality,
            ..Parameters::default()
        })?;
        let expected = theory.moduli();
        let runs = Replicas { seed: 1, count }
            .seeds()
            .map(|seed| -> Result<_, Box<dyn Error>> {
                let go_on = || ControlFlow::Continue(());
                Ok(moduli::after_a_step(&random(cells, &at, seed)?, &relaxation, 1e-6, &times, &go_on)?)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let runs: Vec<_> = runs.into_iter().flatten().collect();
        let share = |k: usize, of: fn(&moduli::Moduli) -> f64, whole: f64| {
            mean(&runs.iter().map(|run| of(&run[k]) / whole).collect::<Vec<_>>())
        };
        let odd = |k: usize| share(k, |m| m.odd_shear, expected.odd_shear);
        let words = |time: f64| {
            let k = times.iter().position(|own| *own >= time).unwrap_or(times.len() - 1);
            let (value, error) = odd(k);
            format!("{value:.3} ± {error:.3} at t = {}", times[k])
        };
        found.push(format!(
            "α = {chirality} ({} of {count} solids came to rest): {}, {}, {}, {}",
            runs.len(),
            words(0.0),
            words(0.04),
            words(1.28),
            words(f64::INFINITY)
        ));
        for (symbol, of, whole) in [
            ("Kᵒ", (|m| m.odd_shear) as fn(&moduli::Moduli) -> f64, expected.odd_shear),
            ("μ", |m| m.shear, expected.shear),
        ] {
            let points = times.iter().enumerate().skip(1).map(|(k, &time)| {
                let (value, error) = share(k, of, whole);
                ErrorPoint { at: [time, value], error: [None, Some(error)] }
            });
            series.push(Series {
                name: format!("{symbol}, α = {chirality}"),
                drawn: Drawn::JoinedMarks,
                points: points.collect(),
            });
        }
    }
    let labels = ["time after the strain (1/K_P)", "modulus / that of the honeycomb"];
    let svg =
        super::chart("after a step strain", labels, [AxisScale::Logarithmic, AxisScale::Linear], &series);
    Ok(Made {
        settings: format!(
            "{cells} cells, P₀ = 3, K_A = 0.1, {count} solids at rest, all strains of ±10⁻⁶; mean and standard error over solids"
        ),
        found: vec![format!("Kᵒ over that of the honeycomb is, for {}.", found.join("; for "))],
        panels: vec![Panel {
            name: "",
            caption: "Kᵒ and μ over those of the honeycomb, against the time after the strain".into(),
            svg,
        }],
    })
}

/// Viscosities of a liquid and of its mirror image, whose ηᵒ is the opposite: two measurements of each number that share no data.
fn viscous(size: Size) -> Result<Made, Box<dyn Error>> {
    let (sizes, rest): (&[f64], _) = size.pick(
        (&[1.0], "--cells 16 --replicas 2 --time 1 --transient 0.2 --average 0.5 --viscosity --period 2 --periods 1 --dt 0.02"),
        (
            &[0.5, 1.0, 2.0],
            "--cells 100 --replicas 8 --time 1 --transient 0.1 --average 0.1 --viscosity --periods 6",
        ),
    );
    let mirrored = sizes.iter().rev().map(|alpha| -alpha);
    let chiralities: Vec<f64> = mirrored.chain([0.0]).chain(sizes.iter().copied()).collect();
    let mut series =
        ["η", "ηᵒ"].map(|name| Series { name: name.into(), drawn: Drawn::JoinedMarks, points: Vec::new() });
    let (mut found, mut all) = (Vec::new(), Vec::new());
    for &alpha in &chiralities {
        let report = command::run(&format!("moduli --P_0 4 --alpha {alpha} {rest}"))?.report()?;
        let own = [0, 1].map(|k| {
            ["value", "error"].map(|name| report["viscosities"][k][name].as_f64().unwrap_or(f64::NAN))
        });
        for ([value, error], series) in own.into_iter().zip(&mut series) {
            series.points.push(ErrorPoint { at: [alpha, value], error: [None, Some(error)] });
        }
        let [[eta, eta_error], [odd, odd_error]] = own;
        found.push(format!("{eta:.3} ± {eta_error:.3} and {odd:.3} ± {odd_error:.3} at α = {alpha}"));
        all.push(own);
    }
    let pulls: Vec<String> = (0..sizes.len())
        .map(|k| {
            let (left, right) = (all[k], all[all.len() - 1 - k]);
            let pull = |which: usize, sign: f64| {
                let [[a, b], [c, d]] = [left[which], right[which]];
                format!("{:+.1}", (c - sign * a) / b.hypot(d))
            };
            format!("{} and {} at α = {}", pull(0, 1.0), pull(1, -1.0), -chiralities[k])
        })
        .collect();
    let svg = super::chart("viscosities", ["α", "η, ηᵒ (friction of a cell)"], EVEN, &series);
    Ok(Made {
        settings: format!("`voronudge moduli --P_0 4 --alpha … {rest}`: square wave of rate ±0.01"),
        found: vec![
            format!("η and ηᵒ are {}.", found.join("; ")),
            format!(
                "A mirror image has the same η and the opposite ηᵒ; η(α) − η(−α) and ηᵒ(α) + ηᵒ(−α) in units of their errors are {}.",
                pulls.join("; ")
            ),
        ],
        panels: vec![Panel { name: "", caption: "Viscosities against chirality at P₀ = 4".into(), svg }],
    })
}
