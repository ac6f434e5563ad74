//! The result of `infer` as its report and as a summary on stdout.

use super::prepare::Prepared;
use crate::run::Run;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use voronudge_geometry::Visibility;
use voronudge_infer::{Estimate, Inference, NoiseSource as Source, Status};
use voronudge_io::DataSet;
use voronudge_report::Units;
use voronudge_report::infer_report::{
    CellCounts, EigenDirection, Fit, FitStatus, InferReport, NaiveParameters, Nmse, Noise, NoiseSource,
    Nudge, Parameter, Parameters, Quantity,
};
use voronudge_report::numbers::significant;

/// Half the width of a 95 % interval in standard errors.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Names of the coefficients along which directions are given.
const COEFFICIENTS: [&str; 4] = ["K_A", "K_P_P_0", "K_P", "K_P_alpha"];

pub(super) fn report(run: &Run, data: &DataSet, prepared: &Prepared, result: &Inference) -> InferReport {
    let (length, time) = (data.length_unit.clone(), data.time_unit.clone());
    let rate = format!("1/{time}");
    let area_rate = format!("1/({length}^2*{time})");
    let scale = &prepared.scale;
    let factor = scale.coefficients();
    let fixed = &prepared.request.fixed;
    let parameter = |estimate: Estimate, factor: f64, unit: &str, fixed: bool| {
        let (value, half) = (estimate.value * factor, NORMAL_95 * estimate.standard_error * factor);
        Parameter { value, ci95: (!fixed).then_some([value - half, value + half]), fixed, unit: unit.into() }
    };
    let p = &result.parameters;
    let fixed_product = fixed.perimeter_elasticity.is_some() && fixed.chirality.is_some();
    let naive = &result.naive;
    InferReport {
        run: run.record(Some(data)),
        units: Units { length: length.clone(), time },
        length_scale: Quantity { value: scale.length, unit: length.clone() },
        cells: cell_counts(prepared, result),
        parameters: Parameters {
            K_A: parameter(p.area_elasticity, factor[0], &area_rate, fixed.area_elasticity.is_some()),
            K_P: parameter(p.perimeter_elasticity, factor[2], &rate, fixed.perimeter_elasticity.is_some()),
            P_0: parameter(p.preferred_perimeter, scale.length, &length, fixed.preferred_perimeter.is_some()),
            A_0: Parameter {
                value: scale.length * scale.length,
                ci95: None,
                fixed: true,
                unit: format!("{length}^2"),
            },
            alpha: parameter(p.chirality, 1.0, "", fixed.chirality.is_some()),
            K_P_alpha: parameter(p.chiral_coefficient, factor[3], &rate, fixed_product),
            shape_index: parameter(p.preferred_perimeter, 1.0, "", fixed.preferred_perimeter.is_some()),
        },
        naive: NaiveParameters {
            K_A: naive.area_elasticity * factor[0],
            K_P: naive.perimeter_elasticity * factor[2],
            P_0: naive.preferred_perimeter * scale.length,
            alpha: naive.chirality,
            K_P_alpha: naive.perimeter_elasticity * naive.chirality * factor[3],
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
                Visibility::Counted if observation.velocities[cell].is_none() => "no_velocity",
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
        let interval = match parameter.ci95 {
            Some([low, high]) => format!("{} to {}", significant(low, 3), significant(high, 3)),
            None => "fixed".into(),
        };
        let (value, naive) = (significant(parameter.value, 4), significant(naive, 4));
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
