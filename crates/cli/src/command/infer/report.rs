//! The result of `infer` as its report and as a summary on stdout.

use super::prepare::Prepared;
use super::scaling;
use crate::run::Run;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use voronudge_geometry::Visibility;
use voronudge_infer::{Inference, NoiseSource as Source, Quantity as What, Status};
use voronudge_io::DataSet;
use voronudge_report::Units;
use voronudge_report::infer_report::{
    CellCounts, EigenDirection, Fit, FitStatus, InferReport, NaiveParameters, Nmse, Noise, NoiseSource,
    Nudge, Parameter, Parameters, Quantity,
};
use voronudge_report::numbers::{interval_text, significant};

/// Names of the coefficients along which directions are given.
const COEFFICIENTS: [&str; 4] = ["K_A", "K_P_P_0", "K_P", "K_P_alpha"];

pub(super) fn report(run: &Run, data: &DataSet, prepared: &Prepared, result: &Inference) -> InferReport {
    let (length, time) = (data.length_unit.clone(), data.time_unit.clone());
    let rate = format!("1/{time}");
    let area_rate = format!("1/({length}^2*{time})");
    let scale = &prepared.scale;
    let factor = |quantity| scaling::factor(scale, quantity);
    let parameter = |quantity: What, factor: f64, unit: &str| {
        let estimate = result.parameters.get(quantity);
        let [low, high] = estimate.interval;
        let ends = [low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY)];
        // What does not vary is held, by itself or by others together.
        let fixed = estimate.standard_error == 0.0;
        let ci95 = (!fixed).then(|| ends.map(|end| end * factor));
        Parameter { value: estimate.value * factor, ci95, fixed, unit: unit.into() }
    };
    let in_units = |quantity: What, unit: &str| parameter(quantity, factor(quantity), unit);
    let naive = &result.naive;
    InferReport {
        run: run.record(Some(data)),
        units: Units { length: length.clone(), time },
        length_scale: Quantity { value: scale.length, unit: length.clone() },
        cells: cell_counts(prepared, result),
        parameters: Parameters {
            K_A: in_units(What::AreaElasticity, &area_rate),
            K_P: in_units(What::PerimeterElasticity, &rate),
            P_0: in_units(What::PreferredPerimeter, &length),
            A_0: Parameter {
                value: scale.length * scale.length,
                ci95: None,
                fixed: true,
                unit: format!("{length}^2"),
            },
            alpha: in_units(What::Chirality, ""),
            K_P_alpha: in_units(What::ChiralCoefficient, &rate),
            shape_index: parameter(What::PreferredPerimeter, 1.0, ""),
        },
        naive: NaiveParameters {
            K_A: naive.area_elasticity * factor(What::AreaElasticity),
            K_P: naive.perimeter_elasticity * factor(What::PerimeterElasticity),
            P_0: naive.preferred_perimeter * scale.length,
            alpha: naive.chirality,
            K_P_alpha: naive.perimeter_elasticity * naive.chirality * factor(What::ChiralCoefficient),
            shape_index: naive.preferred_perimeter,
        },
        nmse: Nmse {
            naive: result.nmse.naive,
            nudged: result.nmse.nudged,
            un_nudged: result.nmse.un_nudged,
            noise_floor: match result.noise_source {
                Source::Given => result.nmse.noise_floor,
                // Estimated noise contains whatever the model misses: it would always explain everything.
                Source::Estimated => f64::NAN,
            },
            cross_validated: result.nmse.cross_validated.map(|c| c[0]),
            cross_validated_standard_error: result.nmse.cross_validated.map(|c| c[1]),
            mean_removed: prepared.mean_removed,
        },
        noise: Noise {
            sigma_r: result.noise.position * scale.length,
            sigma_v: result.noise.velocity * scale.velocity(),
            source: match result.noise_source {
                Source::Given => prepared.stated_noise,
                Source::Estimated => NoiseSource::Estimated,
            },
        },
        nudge: Nudge {
            k: result.noise.spring() / (scale.time * scale.time),
            rms: result.nudge_rms * scale.length,
            degrees_of_freedom: result.degrees_of_freedom,
            edges_changed: result.frames.iter().map(|f| f.edges_lost.len() + f.edges_gained.len()).sum(),
        },
        identifiability: result
            .directions
            .iter()
            .map(|direction| EigenDirection {
                eigenvalue: direction.eigenvalue,
                direction: COEFFICIENTS
                    .iter()
                    .map(|name| name.to_string())
                    .zip(direction.components)
                    .collect(),
            })
            .collect(),
        fit: Fit {
            status: match result.status {
                Status::Converged => FitStatus::Converged,
                Status::StepLimit => FitStatus::IterationLimit,
                Status::Stalled => FitStatus::Stalled,
            },
            iterations: result.steps as usize,
            objective: result.objective,
            expected_objective: result.expected_objective,
            trace: result.trace.clone(),
        },
    }
}

fn cell_counts(prepared: &Prepared, result: &Inference) -> CellCounts {
    let mut left_out = BTreeMap::new();
    for observation in &prepared.observations {
        for (cell, visibility) in observation.visibility.iter().enumerate() {
            let reason = match visibility {
                Visibility::OnHull => "polygon_not_closed",
                Visibility::TooLarge => "polygon_too_large",
                Visibility::NextToRim => "next_to_rim",
                Visibility::Counted if observation.velocities.values()[cell].is_none() => "no_velocity",
                Visibility::Counted => continue,
            };
            *left_out.entry(reason.to_owned()).or_insert(0) += 1;
        }
    }
    CellCounts { frames: prepared.frames.clone(), used: result.used, left_out }
}

/// What the terminal shows.
pub(super) fn summary(report: &InferReport, folder: &Path) -> String {
    let mut text = String::new();
    let left_out: usize = report.cells.left_out.values().sum();
    let frames = report.cells.frames.len();
    let _ = writeln!(
        text,
        "{} velocities in {frames} frame{}, {left_out} cells left out\n",
        report.cells.used,
        if frames == 1 { "" } else { "s" }
    );
    let p = &report.parameters;
    let n = &report.naive;
    let _ = writeln!(text, "{:<13} {:>12}  {:<26} {:>12}", "parameter", "nudged", "95 % interval", "naive");
    for (name, parameter, naive) in [
        ("K_P alpha", &p.K_P_alpha, n.K_P_alpha),
        ("P_0 / l_0", &p.shape_index, n.shape_index),
        ("alpha", &p.alpha, n.alpha),
        ("K_A", &p.K_A, n.K_A),
        ("K_P", &p.K_P, n.K_P),
        ("P_0", &p.P_0, n.P_0),
    ] {
        let [value, interval] = match parameter.interval() {
            Some(ends) => interval_text(parameter.value, ends),
            None => [significant(parameter.value, 4), "fixed".into()],
        };
        let naive = significant(naive, 4);
        let row = format!("{name:<13} {value:>12}  {interval:<26} {naive:>12}  {}", parameter.unit);
        let _ = writeln!(text, "{}", row.trim_end());
    }
    let e = &report.nmse;
    let held_out = match (e.cross_validated, e.cross_validated_standard_error) {
        (Some(error), Some(spread)) => format!("{} ± {}", significant(error, 3), significant(spread, 1)),
        _ => "–".into(),
    };
    let floor = match e.noise_floor.is_finite() {
        true => format!("; noise alone {}", significant(e.noise_floor, 3)),
        false => String::new(),
    };
    let _ = writeln!(
        text,
        "\nerror (NMSE)  naive {}, nudged {}, same parameters un-nudged {}, held out {held_out}{floor}",
        significant(e.naive, 3),
        significant(e.nudged, 3),
        significant(e.un_nudged, 3)
    );
    let _ = writeln!(
        text,
        "noise         sigma_r {}, sigma_v {}; {} degrees of freedom in the nudges, {} contacts changed",
        significant(report.noise.sigma_r, 3),
        significant(report.noise.sigma_v, 3),
        significant(report.nudge.degrees_of_freedom, 3),
        report.nudge.edges_changed
    );
    let _ = writeln!(text, "\nfigures in {}", folder.join("report.html").display());
    text
}
