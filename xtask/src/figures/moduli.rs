//! Elastic moduli over preferred perimeter and chirality.

use super::phases::{Field, over_perimeter};
use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size, command};
use std::error::Error;
use voronudge_report::figure::ErrorPoint;
use voronudge_simulate::collapse::critical_perimeter;
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
        name: "moduli-ghi",
        title: "viscosities of the liquid",
        stated: "the chiral liquid has a shear viscosity η and an odd viscosity ηᵒ, −0.1 and −0.09 γ for HT1080 (P₀ = 4.0, α = 2.9)",
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
    let last = shear.preferred_perimeters.last().copied().unwrap_or(f64::NAN);
    found.push(format!(
        "So A is not that of the honeycomb, which has A = 0, wherever there is chirality: in solids by displacements that do not follow \
         the strain (see [moduli](commands/moduli.md#what-was-measured)), in liquids because perimeters grow less than lengths do. If they \
         did not grow at all, A/K_P would be α P₀²/2, that is {:.1} α at P₀ = {last}.",
        0.5 * last.powi(2)
    ));
    Ok(Made { settings: output.typed.clone(), found, panels })
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

fn viscous(size: Size) -> Result<Made, Box<dyn Error>> {
    let (chiralities, rest): (&[f64], _) = size.pick(
        (&[0.0, 1.0], "--cells 16 --replicas 2 --time 1 --transient 0.2 --average 0.5 --viscosity --period 2 --periods 1 --dt 0.02"),
        (
            &[0.0, 0.5, 1.0, 2.0],
            "--cells 100 --replicas 2 --time 20 --transient 10 --average 20 --viscosity --periods 2 --dt 0.01",
        ),
    );
    let mut series =
        ["η", "ηᵒ"].map(|name| Series { name: name.into(), drawn: Drawn::JoinedMarks, points: Vec::new() });
    let mut found = Vec::new();
    for &alpha in chiralities {
        let report = command::run(&format!("moduli --P_0 4 --alpha {alpha} {rest}"))?.report()?;
        let own = |k: usize| {
            let number = |name: &str| report["viscosities"][k][name].as_f64().unwrap_or(f64::NAN);
            (number("value"), number("error"))
        };
        for (k, series) in series.iter_mut().enumerate() {
            let (value, error) = own(k);
            series.points.push(ErrorPoint { at: [alpha, value], error: [None, Some(error)] });
        }
        let ((eta, eta_error), (odd, odd_error)) = (own(0), own(1));
        found.push(format!("{eta:.3} ± {eta_error:.3} and {odd:.3} ± {odd_error:.3} at α = {alpha}"));
    }
    let svg = super::chart("viscosities", ["α", "η, ηᵒ (friction of a cell)"], EVEN, &series);
    Ok(Made {
        settings: format!("`voronudge moduli --P_0 4 --alpha … {rest}`: square wave of rate ±0.01"),
        found: vec![format!("η and ηᵒ are {}.", found.join("; "))],
        panels: vec![Panel { name: "", caption: "Viscosities against chirality at P₀ = 4".into(), svg }],
    })
}
