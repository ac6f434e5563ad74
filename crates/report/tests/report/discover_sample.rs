//! Synthetic reports, frames and figures of `discover`, for the tests and the example.

use std::collections::BTreeMap;

use voronudge_report::discover_report::{
    Calibration, CandidateStatus, DescriptionFit, EffectCoefficient, EffectKind, Gain, HeldOutError,
    ModelFit, ModelNmse, NoiseBudget, NullSets, Prediction, Predictors, RankedEffect, SelectedEffect,
    StructureTest, Unexplained, Verdict,
};
use voronudge_report::figure::{
    Correlation, CorrelationFunction, CorrelationPoint, Outlier, PartialPoint, PartialRegression, Suspicion,
};
use voronudge_report::infer_report::{CellCounts, InferReport, MeanRemoved};
use voronudge_report::{BeforeAfter, DiscoverFigures, DiscoverReport, FrameView, SpreadView};

use crate::onward_sample;
use crate::sample::{self, noise};

/// A frame in which the base model misses a flow to the right that grows upwards; the added effect
/// explains most of it.
pub fn frames(label: &str, side: usize) -> BeforeAfter<FrameView> {
    let frame = sample::frame(label, side);
    let with_missing = |left: f64| {
        let mut frame = frame.clone();
        let height = frame.cells.iter().map(|cell| cell.centre[1]).fold(1.0, f64::max);
        for cell in &mut frame.cells {
            let missing = 0.9 * left * (cell.centre[1] / height - 0.3);
            if let (Some(measured), Some(predicted)) = (cell.measured, &mut cell.predicted) {
                let rest = [measured[0] - predicted[0], measured[1] - predicted[1]];
                *predicted = [measured[0] - 0.5 * rest[0] - missing, measured[1] - 0.5 * rest[1]];
            }
        }
        frame
    };
    BeforeAfter { before: with_missing(1.0), after: with_missing(0.08) }
}

/// Correlation functions, a partial regression and suspicious cells.
pub fn figures() -> DiscoverFigures {
    let points = |height: f64, turn: f64, stream: u64| -> Vec<CorrelationPoint> {
        let point = |index: usize| {
            let distance = 0.75 + 0.5 * index as f64;
            let value = height * (-distance / 2.5).exp() * (turn * distance).cos();
            let standard_error = 0.02 + 0.002 * index as f64;
            CorrelationPoint { distance, value: value + 0.03 * noise(index, stream), standard_error }
        };
        (0..14).map(point).collect()
    };
    let function = |correlation, height: f64, turn: f64, stream: u64| CorrelationFunction {
        correlation,
        points: BeforeAfter { before: points(height, turn, stream), after: points(0.05, 1.0, stream + 1) },
    };
    let point = |index: usize| {
        let predicted = [0.3 * noise(index, 31), 0.2 * noise(index, 32)];
        let residual = [0, 1].map(|axis| 0.97 * predicted[axis] + 0.25 * noise(index, 33 + axis as u64));
        PartialPoint { predicted, residual }
    };
    let deviation = |cell: usize| 0.04 * noise(cell, 61);
    DiscoverFigures {
        movie: None,
        spreads: vec![SpreadView { symbol: "P_0".into(), drawn: vec![(0..400).map(deviation).collect(); 2] }],
        correlations: vec![
            function(Correlation::Longitudinal, 0.7, 0.2, 40),
            function(Correlation::Transverse, 0.6, 0.5, 42),
            function(Correlation::Chiral, 0.12, 0.1, 44),
        ],
        regressions: vec![PartialRegression {
            effect: "density_gradient".into(),
            points: (0..318).map(point).collect(),
            slope: 0.97,
            slope_ci95: Some([0.83, 1.11]),
        }],
        trails: Some(onward_sample::ways()),
        outliers: vec![vec![
            Outlier { cell: 45, suspicion: Suspicion::Merged },
            Outlier { cell: 88, suspicion: Suspicion::Split },
            Outlier { cell: 89, suspicion: Suspicion::Split },
            Outlier { cell: 66, suspicion: Suspicion::MisTracked },
        ]],
    }
}

/// A density gradient was found, which has two aliases.
pub fn attributed() -> DiscoverReport {
    let infer = sample::report();
    let mut before = model(&infer, [0.87, 0.19, 0.58, 0.53], 2.31);
    let mut after = model(&infer, [0.62, 0.12, 0.37, 0.31], 1.04);
    before.noise.sigma_v = 0.131;
    after.parameters.K_P.value = 0.0232;
    for (fit, value) in [(&mut before, 0.0681), (&mut after, 0.0714)] {
        fit.parameters.K_P_alpha.value = value;
        fit.parameters.K_P_alpha.ci95 = Some([value - 0.003, value + 0.003]);
    }
    after.identifiability[1].direction.insert("density_gradient".into(), 0.21);
    let budget = |base: f64, effects: f64| NoiseBudget {
        total: 842.0,
        position_noise: 0.19,
        velocity_noise: 0.1,
        base,
        effects,
        unexplained: 1.0 - 0.29 - base - effects,
    };
    DiscoverReport {
        run: voronudge_report::infer_report::RunRecord {
            command: "discover".into(),
            command_line: "voronudge discover embryo3 --frames 6,7 --out found".into(),
            ..infer.run
        },
        units: infer.units,
        length_scale: infer.length_scale,
        cells: infer.cells,
        measurement: infer.measurement,
        flow: None,
        constraints: infer.constraints,
        verdict: Verdict::Attributed,
        sentence: "Cells drift up the density gradient (density_gradient): this explains 92 % of what the base \
                   model lacks and lowers the held-out error from 0.53 to 0.31, where noise alone leaves 0.29."
            .into(),
        caveat: "These data cannot tell it from a gradient of P_0 along y (p0_gradient) or of K_P (kp_gradient): \
                 read it as one of the three."
            .into(),
        measure_next: "A density that changes without a change of place: the same tissue after some hours of \
                       proliferation."
            .into(),
        prospects: infer.prospects,
        models: BeforeAfter { before, after },
        description: Some(DescriptionFit {
            effect: "smooth_field".into(),
            dimension: 14.2,
            nmse: nmse([0.6, 0.11, 0.36, 0.32]),
            noise_floor_nmse: 0.29,
            chi_square_per_dof: 1.02,
        }),
        selected: vec![selected()],
        ranking: ranking(),
        unexplained: Unexplained {
            share: 0.018,
            correlation_length: 7.1,
            divergence_share: 0.55,
            curl_share: 0.45,
            tests: vec![
                StructureTest { name: "neighbours correlate (Moran)".into(), statistic: 0.031, p: 0.24 },
                StructureTest { name: "χ² of the residual".into(), statistic: 1.04, p: 0.31 },
            ],
        },
        noise_budget: BeforeAfter { before: budget(0.45, 0.0), after: budget(0.47, 0.222) },
        predictors: Some(Predictors {
            interval: "the backward difference from frame 5 to frame 6".into(),
            overlap: "shares one position with the forward difference that is explained, no interval".into(),
        }),
        predictions: vec![Prediction {
            dataset: "movies/before".into(),
            velocities: 4817,
            before: HeldOutError { value: 0.998, standard_error: 0.002, folds: 6 },
            after: HeldOutError { value: 0.771, standard_error: 0.012, folds: 6 },
            gain: Gain { value: 0.227, standard_error: 0.011 },
        }],
        forecast: Some(onward_sample::forecast()),
        check: Some(onward_sample::check()),
        likelihood_gain: Some(Gain { value: 61.0, standard_error: 9.5 }),
        null_sets: NullSets { refitted: 200, seeds: (1..=200).collect() },
        calibration: Some(Calibration {
            level: 0.05,
            single_p: 0.0021,
            unadjusted_false_positives: 0.43,
            words: "With the adjustment, 9 of 200 null sets named an effect.".into(),
        }),
    }
}

/// The base model leaves nothing but noise.
pub fn nothing_missing() -> DiscoverReport {
    let mut report = unextended(attributed());
    report.verdict = Verdict::NothingMissing;
    report.sentence = "Nothing is missing: the base model leaves no more than the noise.".into();
    report.caveat = "Effects smaller than 4 to 11 % of the velocity would have been missed.".into();
    report.measure_next = String::new();
    report.unexplained.share = 0.004;
    report.predictors = None;
    report
}

/// Too few cells to tell anything, and hardly a number known.
pub fn not_testable() -> DiscoverReport {
    let mut report = unextended(attributed());
    report.verdict = Verdict::NotTestable;
    report.sentence = "These data cannot tell: <9> cells are too few.".into();
    report.caveat = String::new();
    report.measure_next = "At least 100 cells, or ten frames of these.".into();
    report.cells = CellCounts { frames: vec![0], used: 9, left_out: BTreeMap::new() };
    for fit in [&mut report.models.before, &mut report.models.after] {
        fit.nmse.cross_validated = None;
        fit.nmse.nudged = f64::NAN;
        fit.noise_floor_nmse = f64::NAN;
        fit.chi_square_per_dof = f64::INFINITY;
        fit.identifiability.clear();
        fit.fit = Some(sample::degenerate_report().fit);
    }
    for candidate in &mut report.ranking {
        candidate.status = CandidateStatus::NotTestable;
        candidate.reason = "9 cells do not determine it beside the base model".into();
        candidate.detection_limit = f64::INFINITY;
        candidate.size = f64::NAN;
        candidate.statistic = f64::NAN;
        candidate.p = f64::NAN;
        candidate.p_adjusted = f64::NAN;
        candidate.size_ci95 = Some([0.0, f64::NAN]);
        candidate.gain = Some(Gain { value: f64::NAN, standard_error: f64::NAN });
    }
    report.unexplained = Unexplained {
        share: f64::NAN,
        correlation_length: f64::NAN,
        divergence_share: f64::NAN,
        curl_share: f64::NAN,
        tests: Vec::new(),
    };
    let unknown = NoiseBudget { total: 3.0, base: f64::NAN, unexplained: -0.02, ..NoiseBudget::default() };
    report.noise_budget = BeforeAfter { before: unknown, after: unknown };
    report.predictions.iter_mut().for_each(|own| own.gain.standard_error = f64::NAN);
    report.likelihood_gain = Some(Gain { value: f64::NAN, standard_error: f64::NAN });
    report.null_sets = NullSets::default();
    report.calibration = None;
    report.predictors = None;
    report
}

/// The report without an effect, so that after equals before.
fn unextended(mut report: DiscoverReport) -> DiscoverReport {
    report.models.before = report.models.after;
    report.models.after = report.models.before.clone();
    report.noise_budget.before = NoiseBudget { base: 0.7, unexplained: 0.01, ..report.noise_budget.before };
    report.noise_budget.after = report.noise_budget.before;
    report.description = None;
    report.likelihood_gain = None;
    report.forecast = None;
    report.check = None;
    report.selected.clear();
    report.prospects = None;
    for candidate in &mut report.ranking {
        if candidate.statistic > 6.0 {
            if candidate.status != CandidateStatus::Description {
                candidate.status = CandidateStatus::BelowThreshold;
            }
            candidate.statistic = 2.2;
            candidate.p = 0.14;
            candidate.size = 1.2;
            candidate.size_ci95 = Some([0.0, 3.1]);
            candidate.p_adjusted = 0.74;
            candidate.gain = Some(Gain { value: -0.003, standard_error: 0.004 });
            candidate.reason = "adjusted p above 0.05".into();
        }
    }
    report
}

fn nmse([naive, nudged, un_nudged, held_out]: [f64; 4]) -> ModelNmse {
    ModelNmse {
        naive,
        nudged,
        un_nudged,
        cross_validated: Some(HeldOutError { value: held_out, standard_error: 0.024, folds: 12 }),
        held_out_frames: None,
        mean_removed: MeanRemoved::PerFrame,
        background: None,
    }
}

fn model(infer: &InferReport, errors: [f64; 4], chi_square_per_dof: f64) -> ModelFit {
    ModelFit {
        parameters: infer.parameters.clone(),
        nmse: nmse(errors),
        noise_floor_nmse: 0.29,
        noise: infer.noise.clone(),
        nudge: infer.nudge.clone(),
        identifiability: infer.identifiability.clone(),
        chi_square_per_dof,
        fit: None,
    }
}

fn selected() -> SelectedEffect {
    let coefficient =
        |name: &str, value| EffectCoefficient { name: name.into(), value, unit: "um^4/min".into() };
    SelectedEffect {
        effect: "density_gradient".into(),
        formula: "v_i = … + c ∇ρ_s(r_i), ρ_s the density of cells, smoothed over 3 ℓ_0".into(),
        meaning:
            "Cells move towards where they are denser, as in chemotaxis towards a signal that they secrete, \
                  or away from there, as by pressure, if c is negative."
                .into(),
        kind: EffectKind::Force,
        coefficients: vec![coefficient("along", 412.0), coefficient("across", -31.0)],
        ci95: vec![[351.0, 473.0], [-88.0, f64::INFINITY]],
        p_adjusted: 0.005,
        share_of_excess: 0.92,
        class: vec!["p0_gradient".into(), "kp_gradient".into()],
        told_apart_by: BTreeMap::from([
            ("p0_gradient".into(), "A field of view in which density and y are not correlated.".into()),
            ("kp_gradient".into(), "The same; and P_0 held by a measurement of cell shapes at rest.".into()),
        ]),
    }
}

fn ranking() -> Vec<RankedEffect> {
    use CandidateStatus::{Alias, BelowThreshold, Description, Measurement, NotTestable, Selected};
    use EffectKind::{Boundary, Force, Gradient, History, Motion, Observation};
    let candidate = |effect: &str, kind, status, [statistic, size, limit]: [f64; 3]| RankedEffect {
        effect: effect.into(),
        kind,
        dimension: 1 + effect.len() % 2,
        statistic,
        p: (-statistic / 2.0).exp(),
        p_adjusted: (40.0 * (-statistic / 2.0).exp()).clamp(0.005, 1.0),
        detection_limit: limit,
        size,
        size_ci95: (statistic > 6.0).then_some([0.8 * size, 1.2 * size]),
        gain: (statistic > 6.0).then_some(Gain { value: 0.002 * statistic, standard_error: 0.021 }),
        status,
        reason: match status {
            Selected => "largest statistic, adjusted p 0.005, held-out error falls by 0.22 ± 0.02".into(),
            Alias => "cannot be told from density_gradient (correlation 0.97 of the columns)".into(),
            BelowThreshold if statistic > 6.0 => "not needed any more once density_gradient is in".into(),
            BelowThreshold => "adjusted p above 0.05".into(),
            NotTestable => "the base model absorbs it: a change of all parameters does the same".into(),
            Description => "a description, never named as a mechanism".into(),
            Measurement => "5 cells that were not detected, which all fits take into account".into(),
        },
    };
    vec![
        candidate("missed_cells", Observation, Measurement, [84.0, f64::NAN, f64::NAN]),
        candidate("smooth_field", EffectKind::Description, Description, [118.0, 51.0, 14.0]),
        candidate("density_gradient", Force, Selected, [109.0, 47.0, 6.1]),
        candidate("p0_gradient", Gradient, Alias, [105.0, 46.0, 7.4]),
        candidate("kp_gradient", Gradient, Alias, [103.0, 45.0, 7.6]),
        candidate("shear", Motion, BelowThreshold, [19.0, 17.0, 5.2]),
        candidate("odd_diffusion", Force, BelowThreshold, [4.1, 4.4, 6.0]),
        candidate("persistence", History, BelowThreshold, [3.2, 9.1, 16.0]),
        candidate("nonlinear_contractility", Force, BelowThreshold, [2.9, 3.8, 7.9]),
        candidate("alignment", History, BelowThreshold, [1.7, 2.2, 5.5]),
        candidate("odd_nematic_stress", Force, BelowThreshold, [0.4, 1.0, 5.9]),
        candidate("alpha_adhesion", Force, BelowThreshold, [0.2, 3.0, 210.0]),
        candidate("drift", Motion, BelowThreshold, [0.1, 0.4, 2.1]),
        candidate("flow_gain", Observation, NotTestable, [f64::NAN, f64::NAN, f64::INFINITY]),
        candidate("boundary_torque", Boundary, NotTestable, [f64::NAN, f64::NAN, f64::INFINITY]),
    ]
}
