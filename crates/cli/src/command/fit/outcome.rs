//! A fitted model as reports tell it.

use super::Stated;
use super::units::unit;
use super::words;
use crate::problem::Problem;
use std::collections::BTreeMap;
use voronudge_geometry::{Certainty, Visibility};
use voronudge_infer::{
    Constraints, Estimate, FitParameter as What, Inference, Method, NoiseSource as Source, Observation,
    ParameterEstimates, Prior, Profile, Status, Velocities,
};
use voronudge_io::DataSet;
use voronudge_report::Units;
use voronudge_report::infer_report::{
    CellCounts, EigenDirection, Fit, FitMethod, FitStatus, GivenConstraints, GivenPrior, MeanRemoved,
    Measurement, Noise, NoiseSource, Nudge, Parameter, Parameters, SeenRegion, Transitions,
};

/// Names of the coefficients along which directions are given.
const COEFFICIENTS: [&str; 4] = ["K_A", "K_P_P_0", "K_P", "K_P_alpha"];

/// The units of the data.
pub(crate) fn units(data: &DataSet) -> Units {
    Units { length: data.length_unit.clone(), time: data.time_unit.clone() }
}

/// The noise levels of a fit, and where they come from.
pub(crate) fn noise(stated: Stated, prepared: &Problem, result: &Inference) -> Noise {
    Noise {
        sigma_r: result.noise.position * prepared.scale.length,
        sigma_v: result.noise.velocity * prepared.scale.velocity(),
        source: match result.noise_source {
            Source::Given => stated.noise,
            Source::Estimated => NoiseSource::Estimated,
        },
    }
}

/// Which mean velocity was removed.
pub(crate) fn mean_removed(prepared: &Problem) -> MeanRemoved {
    if prepared.mean_removed { MeanRemoved::PerFrame } else { MeanRemoved::None }
}

/// The parameters in the units of the data.
pub(crate) fn parameters(prepared: &Problem, estimates: &ParameterEstimates, units: &Units) -> Parameters {
    let parameter = |quantity: What, estimate: &Estimate, unit: String| {
        let [low, high] = estimate.interval;
        // What does not vary is held, by itself or by others together.
        let fixed = estimate.standard_error == 0.0;
        Parameter {
            value: estimate.value,
            ci95: (!fixed).then(|| [low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY)]),
            fixed,
            unit,
            words: words::parameter(quantity, estimates.get(quantity)),
        }
    };
    let in_units =
        |quantity: What| parameter(quantity, &prepared.in_units(estimates, quantity), unit(quantity, units));
    Parameters {
        K_A: in_units(What::AreaElasticity),
        K_P: in_units(What::PerimeterElasticity),
        P_0: in_units(What::PreferredPerimeter),
        A_0: Parameter {
            value: prepared.scale.length * prepared.scale.length,
            ci95: None,
            fixed: true,
            unit: units.powers(2, 0),
            words: "A_0 is never fitted: no velocity depends on it".into(),
        },
        alpha: in_units(What::Chirality),
        K_P_alpha: in_units(What::ChiralCoefficient),
        shape_index: parameter(What::PreferredPerimeter, &estimates.preferred_perimeter, String::new()),
    }
}

/// Constraints by name.
pub(crate) fn given(constraints: &Constraints) -> GivenConstraints {
    let name = |quantity: &What| quantity.name().to_owned();
    let prior = |prior: &Prior| GivenPrior { mean: prior.mean, standard_deviation: prior.standard_deviation };
    GivenConstraints {
        fixed: constraints.fixed.iter().map(|(q, value)| (name(q), *value)).collect(),
        bounds: constraints.bounds.iter().map(|(q, ends)| (name(q), *ends)).collect(),
        priors: constraints.priors.iter().map(|(q, known)| (name(q), prior(known))).collect(),
    }
}

/// The nudges.
pub(crate) fn nudge(prepared: &Problem, result: &Inference) -> Nudge {
    let scale = &prepared.scale;
    let effects = result.coefficients.len().saturating_sub(COEFFICIENTS.len());
    let fitted = (result.directions.len() + effects) as f64;
    let left = 2.0 * result.used as f64 - result.degrees_of_freedom - fitted;
    Nudge {
        k: result.noise.spring() / (scale.time * scale.time),
        rms: result.nudge_rms * scale.length,
        degrees_of_freedom: result.degrees_of_freedom,
        contribution_ratio: result.contribution_ratio,
        expected_contribution_ratio: if left > 0.0 { result.degrees_of_freedom / left } else { f64::NAN },
        edges_changed: result.frames.iter().map(|f| f.edges_lost.len() + f.edges_gained.len()).sum(),
    }
}

/// What the data determine, in words too.
pub(crate) fn identifiability(result: &Inference) -> Vec<EigenDirection> {
    let words = words::directions(&result.directions, &result.parameters);
    let named = |components: [f64; 4]| {
        COEFFICIENTS.iter().map(|name| name.to_string()).zip(components).collect::<BTreeMap<_, _>>()
    };
    let directions = result.directions.iter().zip(words);
    directions
        .map(|(direction, words)| EigenDirection {
            eigenvalue: direction.eigenvalue,
            direction: named(direction.components),
            words,
        })
        .collect()
}

/// Course of a fit.
pub(crate) fn fit(prepared: &Problem, result: &Inference, profiles: &[Profile]) -> Fit {
    let doubts = words::doubts(result, profiles, prepared.request.method);
    let [tried, made] = result.transitions;
    Fit {
        method: match prepared.request.method {
            Method::Search { .. } => FitMethod::Search,
            Method::Descent { .. } => FitMethod::Descent,
        },
        status: match result.status {
            Status::Converged => FitStatus::Converged,
            Status::StepLimit => FitStatus::IterationLimit,
            Status::Stalled => FitStatus::Stalled,
        },
        trustworthy: doubts.is_empty(),
        doubtful: doubts.iter().map(|(part, _)| (*part).to_owned()).collect(),
        doubts: doubts.into_iter().map(|(_, text)| text).collect(),
        iterations: result.steps as usize,
        downweighted: result.frames.iter().flat_map(|frame| &frame.weights).filter(|w| **w < 0.5).count(),
        objective: result.objective,
        expected_objective: result.expected_objective,
        trace: result.trace.clone(),
        starts: result.starts.clone(),
        transitions: Transitions { tried, made },
    }
}

/// Which velocities were used, and why others were not.
pub(crate) fn cell_counts(prepared: &Problem, result: &Inference) -> CellCounts {
    let mut left_out = BTreeMap::new();
    for observation in &prepared.observations {
        for datum in 0..observation.velocities.values().len() {
            if let Some(reason) =
                reason_to_leave_out(observation, datum).filter(|_| counts(observation, datum))
            {
                *left_out.entry(reason.to_owned()).or_insert(0) += 1;
            }
        }
    }
    CellCounts { frames: prepared.frames.clone(), used: result.used, left_out }
}

/// What was seen of the tissue.
pub(crate) fn measurement(stated: Stated, data: &DataSet, prepared: &Problem) -> Measurement {
    let judged = prepared.observations.iter().flat_map(|observation| {
        let seen = |(cell, own): (usize, _)| observation.is_seen(cell).then_some(own);
        observation.visibility.iter().enumerate().filter_map(seen)
    });
    let count = |class: Certainty| judged.clone().filter(|own| own.certainty() == class).count();
    let view = |first: &Observation| SeenRegion {
        source: stated.region,
        corners: data.field_of_view.as_ref().map(|area| area.corners_in_file(data.y_axis)),
        margin: first.field_of_view.margin_for(1.0) * prepared.scale.length,
    };
    Measurement {
        field_of_view: prepared.observations.first().filter(|first| first.region.is_some()).map(view),
        certain: count(Certainty::Certain),
        uncertain: count(Certainty::Uncertain),
        outside: count(Certainty::Outside),
        latent: super::latent::found(prepared),
        tracks: None,
        positions: super::measurement::positions(prepared),
        window: super::measurement::window(prepared),
    }
}

/// Whether something was detected where a velocity would be.
fn counts(observation: &Observation, datum: usize) -> bool {
    matches!(observation.velocities, Velocities::OnGrid(_)) || observation.is_seen(datum)
}

/// Why the velocity of a cell or at a grid point was not used, if it was not.
fn reason_to_leave_out(observation: &Observation, datum: usize) -> Option<&'static str> {
    let missing = observation.velocities.values()[datum].is_none();
    match &observation.velocities {
        Velocities::OfCells(_) => match observation.visibility[datum] {
            Visibility::Outside => Some("outside_field_of_view"),
            Visibility::NotClosed => Some("polygon_not_closed"),
            Visibility::Unseen => Some("polygon_uncertain"),
            Visibility::TooLarge => Some("polygon_too_large"),
            Visibility::NextToUncertain => Some("next_to_uncertain"),
            Visibility::Counted => missing.then_some("no_velocity"),
        },
        Velocities::OnGrid(_) if missing => Some("missing"),
        Velocities::OnGrid(_) => (!observation.is_in_reach(datum)).then_some("window_not_filled"),
    }
}
