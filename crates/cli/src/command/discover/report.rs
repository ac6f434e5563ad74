//! The result of `discover` as its report.

use super::checks::Compared;
use super::measured::{Findings, PositionNoise};
use super::phrases::probability;
use super::{effects, sentences};
use crate::command::fit::flow::described;
use crate::command::fit::{Stated, outcome, prospects};
use crate::problem::Problem;
use crate::run::Run;
use voronudge_infer::diagnostics::Kind;
use voronudge_infer::discover::{
    Budget, Described, Discovery, Fitted, HeldOut, HeldOutUnit, Search, Verdict as Answer,
};
use voronudge_infer::{Inference, NoiseSource};
use voronudge_io::DataSet;
use voronudge_report::discover_report::{
    Calibration, DescriptionFit, ForecastReport, Gain, HeldOutError, ModelFit, ModelNmse, NoiseBudget,
    NullSets, Prediction, Predictors, StructureTest, Unexplained, Verdict,
};
use voronudge_report::infer_report::{Measurement, Quantity, TracksReport};
use voronudge_report::{BeforeAfter, DiscoverReport, Units};

/// What was searched, and in which data.
pub(super) struct Found<'a> {
    pub data: &'a DataSet,
    pub prepared: &'a Problem,
    pub stated: Stated,
    pub tracks: Option<TracksReport>,
    pub search: &'a Search,
    pub predictors: Option<Predictors>,
    pub predictions: Vec<Prediction>,
    pub forecast: Option<ForecastReport>,
    pub compared: Option<Compared>,
}

pub(super) fn report(run: &Run, found: &Found<'_>, discovery: &Discovery) -> DiscoverReport {
    let Found { data, prepared, stated, tracks, search, predictors, predictions, forecast, compared } = found;
    let units = outcome::units(data);
    let measurement = Measurement { tracks: tracks.clone(), ..outcome::measurement(*stated, data, prepared) };
    let findings = Findings::new(prepared, &measurement);
    let ranking = discovery.ranking.iter().map(|one| effects::ranked(one, discovery)).collect();
    let fits = BeforeAfter {
        before: model_fit(*stated, prepared, &discovery.before, &units),
        after: model_fit(*stated, prepared, &discovery.after, &units),
    };
    let foreseen = discovery.prospects.as_ref().map(|foreseen| {
        let coefficients = effects::coefficients(discovery, prepared, &units);
        prospects::report(prepared, &discovery.after.inference, foreseen, &coefficients, &units)
    });
    let measure_next = sentences::measure_next(discovery, search, prepared, &findings);
    DiscoverReport {
        run: run.record(Some(data)),
        length_scale: Quantity { value: prepared.scale.length, unit: units.length.clone() },
        cells: outcome::cell_counts(prepared, &discovery.before.inference),
        flow: prepared.velocities.flow().map(described),
        constraints: outcome::given(&prepared.constraints),
        verdict: verdict(discovery.verdict),
        sentence: sentences::sentence(discovery, prepared, &findings),
        caveat: sentences::caveat(discovery, search),
        measure_next: [foreseen.as_ref().map_or("", |own| own.words.as_str()), &measure_next]
            .join(" ")
            .trim()
            .to_owned(),
        prospects: foreseen,
        models: fits,
        description: discovery.description.as_ref().map(|described| description(prepared, described)),
        selected: discovery.selected.iter().map(|one| effects::selected(one, prepared, &units)).collect(),
        ranking: findings.ahead_of(ranking, &PositionNoise::new(prepared, &discovery.after, &units)),
        measurement,
        unexplained: unexplained(prepared, &discovery.after),
        noise_budget: BeforeAfter {
            before: budget(prepared, &discovery.before.budget),
            after: budget(prepared, &discovery.after.budget),
        },
        predictors: predictors.clone(),
        predictions: predictions.clone(),
        forecast: forecast.clone(),
        check: compared.as_ref().map(|compared| compared.report.clone()),
        likelihood_gain: discovery.likelihood_gain.map(Gain::from),
        null_sets: NullSets {
            refitted: discovery.null_sets.smallest_p.len(),
            seeds: discovery.null_sets.seeds.clone(),
        },
        calibration: Some(calibration(discovery, search.level)),
        units,
    }
}

fn verdict(answer: Answer) -> Verdict {
    match answer {
        Answer::NothingMissing => Verdict::NothingMissing,
        Answer::Attributed => Verdict::Attributed,
        Answer::Partial => Verdict::Partial,
        Answer::UnexplainedStructured => Verdict::UnexplainedStructured,
        Answer::UnexplainedWhite => Verdict::UnexplainedWhite,
        Answer::NotTestable => Verdict::NotTestable,
    }
}

fn model_fit(stated: Stated, prepared: &Problem, fitted: &Fitted, units: &Units) -> ModelFit {
    let result = &fitted.inference;
    ModelFit {
        parameters: outcome::parameters(prepared, &result.parameters, units),
        nmse: nmse(prepared, result, fitted.held_out),
        noise_floor_nmse: result.nmse.noise_floor,
        noise: outcome::noise(stated, prepared, result),
        nudge: outcome::nudge(prepared, result),
        identifiability: outcome::identifiability(result),
        chi_square_per_dof: result.objective / result.expected_objective,
        fit: Some(outcome::fit(prepared, result, &[])),
    }
}

/// An error on data that the fit has not seen.
pub(super) fn held_out_error(error: HeldOut) -> HeldOutError {
    HeldOutError { value: error.value, standard_error: error.standard_error, folds: error.folds }
}

fn nmse(prepared: &Problem, result: &Inference, held_out: Option<HeldOut>) -> ModelNmse {
    let of = |unit: HeldOutUnit| held_out.filter(|error| error.unit == unit).map(held_out_error);
    ModelNmse {
        naive: result.nmse.naive,
        nudged: result.nmse.nudged,
        un_nudged: result.nmse.un_nudged,
        cross_validated: of(HeldOutUnit::Blocks),
        held_out_frames: of(HeldOutUnit::Frames),
        mean_removed: outcome::mean_removed(prepared),
        background: prepared.background,
    }
}

fn description(prepared: &Problem, described: &Described) -> DescriptionFit {
    let result = &described.inference;
    DescriptionFit {
        effect: described.effect.id.into(),
        dimension: described.dimension as f64,
        nmse: nmse(prepared, result, described.held_out),
        noise_floor_nmse: result.nmse.noise_floor,
        chi_square_per_dof: result.objective / result.expected_objective,
    }
}

fn unexplained(prepared: &Problem, fitted: &Fitted) -> Unexplained {
    let diagnostics = &fitted.diagnostics;
    let shares = diagnostics.split.shares;
    Unexplained {
        share: fitted.budget.unexplained,
        correlation_length: diagnostics
            .correlations
            .length
            .value()
            .map_or(f64::NAN, |length| length * prepared.scale.length),
        divergence_share: shares.map_or(f64::NAN, |shares| shares.divergence),
        curl_share: shares.map_or(f64::NAN, |shares| shares.curl),
        tests: diagnostics
            .structure
            .tests
            .iter()
            .map(|test| StructureTest {
                name: tested(test.kind).into(),
                statistic: test.statistic,
                p: test.p,
            })
            .collect(),
    }
}

/// What a test for structure looks at.
fn tested(kind: Kind) -> &'static str {
    match kind {
        Kind::Neighbours => "neighbours are alike",
        Kind::LowModes => "a smooth pattern across the field",
        Kind::Successive => "the same cell in successive frames",
    }
}

fn budget(prepared: &Problem, shares: &Budget) -> NoiseBudget {
    let squares = |v: &voronudge_geometry::Vector<f64>| v.norm_squared();
    let of_frame =
        |frame: &voronudge_infer::Observation| frame.explainable().iter().map(squares).sum::<f64>();
    let total: f64 = prepared.observations.iter().map(of_frame).sum();
    NoiseBudget {
        total: total * prepared.scale.velocity().powi(2),
        position_noise: shares.position_noise,
        velocity_noise: shares.velocity_noise,
        base: shares.base,
        effects: shares.effects,
        unexplained: shares.unexplained,
    }
}

fn calibration(discovery: &Discovery, level: f64) -> Calibration {
    let smallest = &discovery.null_sets.smallest_p;
    let share = |limit: f64| match smallest.len() {
        0 => f64::NAN,
        count => smallest.iter().filter(|p| **p < limit).count() as f64 / count as f64,
    };
    let noise = match discovery.before.inference.noise_source {
        NoiseSource::Given => "the noise given",
        NoiseSource::Estimated => "the noise estimated",
    };
    Calibration {
        level,
        single_p: discovery.single_p,
        unadjusted_false_positives: share(level),
        words: match smallest.as_slice() {
            [] => "No made-up data were fitted: the level rests on the number of candidates alone.".into(),
            [least, ..] => format!(
                "{} made-up data sets of the base model with {noise} were fitted and searched; their smallest p of any candidate is {}.",
                smallest.len(),
                probability(*least)
            ),
        },
    }
}
