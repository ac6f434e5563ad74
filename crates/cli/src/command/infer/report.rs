//! The result of `infer` as its report.

use super::questions::Answers;
use super::verdict::verdict;
use super::{answers, kinds, spreads};
use crate::command::fit::flow::described;
use crate::command::fit::{Stated, implied, outcome, prospects};
use crate::problem::Problem;
use crate::run::Run;
use voronudge_infer::{FitParameter as What, Inference, NoiseSource, Prospects};
use voronudge_io::DataSet;
use voronudge_report::infer_report::{
    ActivityReport, InferReport, Measurement, NaiveParameters, Nmse, Quantity, TracksReport,
};

pub(super) fn report(
    (run, data, stated): (&Run, &DataSet, Stated),
    prepared: &Problem,
    result: &Inference,
    (answers, foreseen): (&Answers, Option<&Prospects>),
    tracks: Option<(TracksReport, Option<ActivityReport>)>,
) -> InferReport {
    let (tracks, activity) = tracks.map_or((None, None), |(tracks, activity)| (Some(tracks), activity));
    let units = outcome::units(data);
    let scale = &prepared.scale;
    let naive = &result.naive;
    let parameters = outcome::parameters(prepared, &result.parameters, &units);
    let nmse = nmse(prepared, result);
    let verdict = verdict(result, &nmse, &parameters);
    // Parameters of a model that explains nothing are not worth more.
    let foreseen = foreseen.filter(|_| verdict.kind.is_finding());
    InferReport {
        run: run.record(Some(data)),
        prospects: foreseen.map(|foreseen| prospects::report(prepared, result, foreseen, &[], &units)),
        verdict,
        length_scale: Quantity { value: scale.length, unit: units.length.clone() },
        time_scale: Quantity { value: scale.time, unit: units.time.clone() },
        cells: outcome::cell_counts(prepared, result),
        measurement: Measurement { tracks, ..outcome::measurement(stated, data, prepared) },
        flow: prepared.velocities.flow().map(described),
        constraints: outcome::given(&prepared.constraints),
        parameters,
        activity,
        spreads: spreads::report(result),
        by_label: kinds::report(prepared, result, data, &units),
        implied_moduli: implied::implied(prepared, result, &units),
        naive: NaiveParameters {
            K_A: naive.area_elasticity * scale.factor(What::AreaElasticity),
            K_P: naive.perimeter_elasticity * scale.factor(What::PerimeterElasticity),
            P_0: naive.preferred_perimeter * scale.factor(What::PreferredPerimeter),
            alpha: naive.chirality * scale.factor(What::Chirality),
            K_P_alpha: naive.perimeter_elasticity * naive.chirality * scale.factor(What::ChiralCoefficient),
            shape_index: naive.preferred_perimeter,
        },
        units,
        nmse,
        noise: outcome::noise(stated, prepared, result),
        nudge: outcome::nudge(prepared, result),
        identifiability: outcome::identifiability(result),
        profiles: answers.profiles.iter().map(|profile| answers::profile(profile, scale)).collect(),
        landscapes: answers.landscapes.iter().map(|slice| answers::landscape(slice, scale)).collect(),
        bootstrap: answers.bootstrap.as_ref().map(|all| answers::bootstrap(all, result, scale)),
        fit: outcome::fit(prepared, result, &answers.profiles),
    }
}

fn nmse(prepared: &Problem, result: &Inference) -> Nmse {
    Nmse {
        naive: result.nmse.naive,
        nudged: result.nmse.nudged,
        un_nudged: result.nmse.un_nudged,
        noise_floor: match result.noise_source {
            NoiseSource::Given => result.nmse.noise_floor,
            // Estimated noise contains whatever the model misses: it would always explain everything.
            NoiseSource::Estimated => f64::NAN,
        },
        cross_validated: result.nmse.cross_validated.map(|c| c[0]),
        cross_validated_standard_error: result.nmse.cross_validated.map(|c| c[1]),
        mean_removed: outcome::mean_removed(prepared),
        background: prepared.background,
    }
}
