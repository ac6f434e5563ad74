//! An equation of state that was measured before, for a tissue in units of its own.

use crate::failure::Failure;
use serde::Deserialize;
use std::path::Path;
use voronudge_model::Parameters;
use voronudge_theory::EquationOfState;

/// What is read of a report.
#[derive(Debug, Deserialize)]
struct Report {
    command: String,
    cell_size: f64,
    parameters: Named,
    points: Vec<Point>,
}

#[derive(Debug, Deserialize)]
#[allow(non_snake_case, reason = "the names of the interface")]
struct Named {
    K_A: f64,
    K_P: f64,
    P_0: f64,
    alpha: f64,
}

#[derive(Debug, Deserialize)]
struct Point {
    relative_density: f64,
    pressure: Value,
    torque: Value,
}

#[derive(Debug, Deserialize)]
struct Value {
    /// Null where it was not finite.
    value: Option<f64>,
}

/// An equation of state in units of ℓ₀ and 1/K_P, and the report that it is from.
#[derive(Debug, Clone)]
pub(crate) struct MeasuredEquation {
    pub equation: EquationOfState,
    pub input: voronudge_io::InputFile,
}

/// Parameters of one tissue that were written and read again.
const SAME: f64 = 1e-9;

/// Reads the report of `equation-of-state`, or the one in its folder, for a tissue of these parameters and this cell size.
pub(crate) fn read(
    path: &Path,
    parameters: &Parameters<f64>,
    cell_size: f64,
) -> Result<MeasuredEquation, Failure> {
    let file = if path.is_dir() { path.join("report.json") } else { path.to_path_buf() };
    let fault = |text: String| {
        Failure::new(text)
            .at(file.display())
            .with_hint("give a folder written by voronudge equation-of-state")
    };
    let (text, input) = voronudge_io::read_text(&file)?;
    let report: Report = serde_json::from_str(&text)
        .map_err(|error| fault(format!("not a report of equation-of-state: {error}")))?;
    if report.command != "equation-of-state" {
        return Err(fault("a report of another command".into()));
    }
    let own = [
        ("P_0/ℓ₀", parameters.preferred_perimeter / cell_size, report.parameters.P_0 / report.cell_size),
        ("α", parameters.chirality, report.parameters.alpha),
        (
            "K_A ℓ₀²/K_P",
            parameters.area_elasticity * cell_size * cell_size / parameters.perimeter_elasticity,
            report.parameters.K_A * report.cell_size * report.cell_size / report.parameters.K_P,
        ),
    ];
    if let Some((name, here, there)) =
        own.into_iter().find(|(_, here, there)| (here - there).abs() > SAME * here.abs().max(1.0))
    {
        return Err(Failure::new(format!("of a tissue whose {name} is {there}, but here it is {here}"))
            .at(file.display())
            .with_hint(format!(
                "measure it at these parameters: voronudge equation-of-state --P_0 {} --alpha {} --K_A {}",
                own[0].1, own[1].1, own[2].1
            )));
    }
    let rate = report.parameters.K_P;
    let points: Vec<[f64; 3]> = (report.points.iter())
        .map(|point| {
            let [pressure, torque] =
                [&point.pressure, &point.torque].map(|own| own.value.unwrap_or(f64::NAN) / rate);
            [point.relative_density, pressure, torque]
        })
        .collect();
    let equation = EquationOfState::new(&points).map_err(|error| fault(error.to_string()))?;
    Ok(MeasuredEquation { equation, input })
}
