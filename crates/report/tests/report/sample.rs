//! Synthetic frames and reports, for the tests and the example.

use crate::parameters_sample::{fitted, held, kind, parameters};
use std::collections::BTreeMap;

use voronudge_report::infer_report::{
    ActivityReport, AmbiguityReport, BootstrapResult, CellCounts, EigenDirection, Fit, FitMethod, FitStatus,
    FlowGrid, FlowWindow, GivenConstraints, GivenPrior, InferReport, InputFile, LandscapeResult, LatentCells,
    MeanRemoved, MeasuredPositions, MeasuredWindow, Measurement, MeasurementSource, NaiveParameters, Nmse,
    Noise, NoiseSource, Nudge, Parameter, PositionKind, ProfileResult, ProspectOf, ProspectsReport, Quantity,
    RegionSource, RunRecord, SeenRegion, SpreadReport, Transitions, TriedWindow, Verdict, VerdictKind,
};
use voronudge_report::{CellStatus, CellView, ChangedEdges, FrameView, InferPage, Uncertainty, Units};

/// Distance between neighbouring cells in µm.
const SPACING: f64 = 12.0;

/// Uniform numbers in −1..1 that depend on their index only.
pub fn noise(index: usize, stream: u64) -> f64 {
    let mut state = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (stream << 17);
    for _ in 0..3 {
        state ^= state >> 30;
        state = state.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state ^= state >> 27;
    }
    (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A honeycomb with jittered vertices, `side` × `side` cells, the rim left out.
pub fn frame(label: &str, side: usize) -> FrameView {
    let row_height = SPACING * 0.75f64.sqrt();
    let cells = (0..side * side).map(|index| {
        let (row, column) = (index / side, index % side);
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        let centre = [(column as f64 + shift) * SPACING, row as f64 * row_height];
        let polygon: Vec<[f64; 2]> = (0..6)
            .map(|corner| {
                let angle = (corner as f64 + 0.5) * std::f64::consts::FRAC_PI_3;
                let reach = SPACING / 3f64.sqrt();
                jitter([centre[0] + reach * angle.cos(), centre[1] + reach * angle.sin()])
            })
            .collect();
        let rim = row == 0 || column == 0 || row + 1 == side || column + 1 == side;
        let middle = side as f64 * SPACING / 2.0;
        let swirl = [-(centre[1] - middle) / 90.0, (centre[0] - middle) / 90.0];
        let predicted = [swirl[0] + 0.5 * noise(index, 3), swirl[1] + 0.5 * noise(index, 4)];
        let measured = [predicted[0] + 0.35 * noise(index, 5), predicted[1] + 0.35 * noise(index, 6)];
        let centre = [centre[0] + noise(index, 1), centre[1] + noise(index, 2)];
        CellView {
            number: Some(index),
            centre,
            area: area(&polygon),
            perimeter: perimeter(&polygon),
            polygon: if rim && index % 3 == 0 { Vec::new() } else { polygon },
            status: match (rim, index % 57) {
                (true, _) => CellStatus::Uncertain,
                (false, 20) => CellStatus::LeftOut,
                (false, _) => CellStatus::Used,
            },
            measured: (index % 41 != 7).then_some(measured),
            vorticity: (!rim).then_some(2.0 / 90.0),
            predicted: (!rim).then_some(predicted),
            polarity: Some([0.2, -0.1]),
            held_out: (!rim).then_some([0.9 * predicted[0], 0.9 * predicted[1]]),
            nudge: if rim { [0.0; 2] } else { [0.2 * noise(index, 7), 0.2 * noise(index, 8)] },
        }
    });
    let cells: Vec<CellView> = cells.collect();
    let edge = |from: usize, to: usize| [cells[from].centre, cells[to].centre];
    let middle = cells.len() / 2 + side / 3;
    let changed_edges = ChangedEdges {
        lost: vec![edge(middle, middle + 1), edge(middle + 3 * side, middle + 3 * side + 1)],
        gained: vec![edge(middle - side, middle + side)],
    };
    let end = side as f64 * SPACING;
    let region = vec![vec![[-4.0, -6.0], [end, -6.0], [end, 0.88 * end], [-4.0, 0.88 * end]]];
    FrameView { label: label.to_owned(), time: None, cells, changed_edges, outline: None, region }
}

/// A few cells with everything that can be unknown unknown.
pub fn degenerate_frame() -> FrameView {
    let cell = |x: f64, nudge: f64| CellView {
        number: None,
        centre: [x, 0.5 * x],
        polygon: vec![[x, 0.0], [f64::NAN, 1.0], [x + 1.0, f64::INFINITY]],
        area: f64::NAN,
        perimeter: 4.0,
        status: CellStatus::Used,
        measured: Some([f64::NAN, 0.1]),
        vorticity: Some(f64::NAN),
        predicted: Some([0.1, f64::INFINITY]),
        polarity: None,
        held_out: Some([f64::NAN, 0.1]),
        nudge: [nudge, 0.0],
    };
    FrameView {
        label: "frame <0>".to_owned(),
        cells: vec![cell(0.0, f64::NAN), cell(2.0, 0.0), cell(f64::NAN, 1.0)],
        changed_edges: ChangedEdges { lost: vec![[[0.0, f64::NAN], [1.0, 1.0]]], gained: vec![] },
        region: vec![vec![[0.0, f64::NAN], [1.0, 0.0], [0.0, 1.0]]],
        ..FrameView::default()
    }
}

/// A page around a report, frames and what was asked beyond the fit.
pub fn page<'a>(
    report: &'a InferReport,
    frames: &'a [FrameView],
    uncertainty: &'a Uncertainty,
) -> InferPage<'a> {
    InferPage {
        title: "embryo <3>",
        summary: &[],
        report,
        frames,
        movie: None,
        flows: &[],
        spreads: &[],
        uncertainty,
    }
}

/// A filled report.
pub fn report() -> InferReport {
    let direction = |eigenvalue: f64, components: [f64; 4]| EigenDirection {
        eigenvalue,
        direction: ["K_A", "K_P", "K_P_P_0", "K_P_alpha"]
            .into_iter()
            .map(String::from)
            .zip(components)
            .collect(),
        words: "The stiffest combination is K_P alpha.".into(),
    };
    InferReport {
        run: RunRecord {
            command: "infer".into(),
            command_line: "voronudge infer embryo3 --frames 6,7 --fix K_A=0.1 --out <fit>".into(),
            version: "0.1.0".into(),
            seed: 1,
            threads: 2,
            inputs: vec![InputFile { path: "embryo3/positions.npy".into(), sha256: "0f".repeat(32) }],
            wall_seconds: 12.43,
            warnings: vec![
                "The position noise was estimated from these data; if you know it, say so with \
                 --position-noise."
                    .into(),
            ],
        },
        verdict: Verdict {
            kind: VerdictKind::Explained,
            sentence: "The chiral Voronoi model explains 69 % of the motion; chirality is part of it.".into(),
        },
        units: Units { length: "um".into(), time: "min".into() },
        length_scale: Quantity { value: 11.17, unit: "um".into() },
        time_scale: Quantity { value: 12.5, unit: "min".into() },
        cells: CellCounts {
            frames: vec![6, 7],
            used: 636,
            left_out: BTreeMap::from([("open_polygon".into(), 152), ("no_velocity".into(), 12)]),
        },
        measurement: Measurement {
            field_of_view: Some(SeenRegion { source: RegionSource::Hull, corners: None, margin: 0.5 }),
            certain: 648,
            uncertain: 141,
            outside: 11,
            latent: Some(LatentCells { inserted: 3, deleted: 1, split: 1, merged: 0, missed_rate: 0.02 }),
            tracks: None,
            positions: MeasuredPositions {
                are: PositionKind::Sites,
                share: 0.0,
                ci95: Some([0.0, 0.2]),
                source: MeasurementSource::Estimated,
                own_errors: false,
            },
            window: None,
        },
        flow: None,
        constraints: GivenConstraints {
            fixed: BTreeMap::from([("K_A".into(), 0.0008)]),
            bounds: BTreeMap::from([("K_P".into(), [0.0, f64::INFINITY])]),
            priors: BTreeMap::from([("P_0".into(), GivenPrior { mean: 44.0, standard_deviation: 4.0 })]),
        },
        parameters: parameters(),
        activity: Some(ActivityReport {
            v_0: fitted(0.31, 0.04, "um min⁻¹"),
            D_r: held(0.02, "min⁻¹"),
            J: Some(fitted(0.15, 0.03, "min⁻¹")),
            evidence_of_alignment: Some(31.0),
            b: Some(fitted(0.004, 0.001, "um min⁻²")),
            evidence_of_contact_inhibition: Some(16.0),
            kappa: None,
            evidence_of_velocity_alignment: None,
            correlation: 0.93,
        }),
        spreads: vec![SpreadReport {
            parameter: "alpha".into(),
            relative: 0.11,
            ci95: [0.07, 0.15],
            p: 3e-9,
            p_adjusted: 3e-9,
            named: true,
            words: "cells differ in alpha by 11 %".into(),
        }],
        by_label: [0, 3].map(kind).into(),
        implied_moduli: None,
        naive: NaiveParameters {
            K_A: f64::NAN,
            K_P: 0.012,
            P_0: 37.9,
            alpha: -0.5,
            K_P_alpha: -0.006,
            shape_index: 3.4,
        },
        nmse: Nmse {
            naive: 0.87,
            nudged: 0.12,
            un_nudged: 0.36,
            noise_floor: 0.29,
            cross_validated: Some(0.31),
            cross_validated_standard_error: Some(0.02),
            mean_removed: MeanRemoved::PerFrame,
            background: None,
        },
        noise: Noise { sigma_r: 0.14, sigma_v: 0.09, source: NoiseSource::Estimated },
        nudge: Nudge {
            k: 0.41,
            rms: 0.16,
            degrees_of_freedom: 412.0,
            contribution_ratio: 0.91,
            expected_contribution_ratio: 0.94,
            edges_changed: 3,
        },
        identifiability: vec![
            direction(8.1e4, [0.01, -0.05, 0.12, 0.99]),
            direction(310.0, [0.02, 0.26, -0.95, 0.13]),
            direction(12.0, [0.15, -0.95, -0.26, -0.02]),
            direction(0.04, [0.99, 0.15, 0.05, 0.0]),
        ],
        prospects: Some(prospects()),
        profiles: Vec::new(),
        landscapes: Vec::new(),
        bootstrap: None,
        fit: Fit {
            method: FitMethod::Search,
            status: FitStatus::Converged,
            trustworthy: true,
            doubtful: Vec::new(),
            doubts: Vec::new(),
            iterations: 17,
            downweighted: 2,
            objective: 871.0,
            expected_objective: 856.0,
            trace: (0..18).map(|step| 870.0 + 29_000.0 * (-0.7 * f64::from(step)).exp()).collect(),
            starts: vec![871.0, 873.5],
            transitions: Transitions { tried: 41, made: 3 },
        },
    }
}

/// What would be known with other measurements.
pub fn prospects() -> ProspectsReport {
    let expected = |now: f64, shares: [f64; 3]| {
        let names = ["twice_the_frames", "half_the_position_noise", "twice_the_field"];
        names.into_iter().zip(shares).map(|(name, share)| (name.to_owned(), share * now)).collect()
    };
    let quantity = |name: &str, value: f64, error: f64, unit: &str| ProspectOf {
        name: name.into(),
        value,
        standard_error: error,
        unit: unit.into(),
        expected: expected(error, [0.71, 0.55, 0.66]),
    };
    ProspectsReport {
        words: "Half the error of positions would bring the standard error of K_P, known to 14 %, to 0.55 of what it is.".into(),
        least_certain: Some("K_P".into()),
        recommended: Some("half_the_position_noise".into()),
        share: Some(0.55),
        quantities: vec![quantity("K_P", 0.021, 0.0029, "1/min"), quantity("K_P_alpha", 0.0714, 0.0016, "1/min")],
        ambiguities: vec![AmbiguityReport {
            effect: "density_gradient".into(),
            other: "p0_gradient".into(),
            separation: 1.1,
            expected: expected(1.1, [1.4, 1.9, 1.5]),
        }],
    }
}

/// A report in which nothing is known.
pub fn degenerate_report() -> InferReport {
    let mut report = report();
    report.prospects = None;
    report.run.warnings = vec!["only 2 cells <script>alert(1)</script> were usable".into()];
    report.cells = CellCounts { frames: vec![0], used: 2, left_out: BTreeMap::new() };
    for parameter in
        [&mut report.parameters.K_P, &mut report.parameters.alpha, &mut report.parameters.K_P_alpha]
    {
        parameter.value = f64::NAN;
        parameter.ci95 = Some([f64::NAN, f64::INFINITY]);
    }
    report.parameters.alpha.ci95 = Some([f64::NEG_INFINITY, f64::INFINITY]);
    let parameters = &mut report.parameters;
    for (parameter, value, ci95) in [
        (&mut parameters.P_0, 1.0, [f64::NEG_INFINITY, 3.1]),
        (&mut parameters.shape_index, 1.0, [0.2, f64::INFINITY]),
        (&mut parameters.K_A, 0.0, [0.0, 3.1]),
    ] {
        *parameter = Parameter { value, ci95: Some(ci95), fixed: false, ..parameter.clone() };
    }
    report.verdict.kind = VerdictKind::ExplainsNothing;
    report.nmse.naive = 41.0;
    report.nmse.nudged = f64::NAN;
    report.nmse.un_nudged = 1.03;
    report.nmse.cross_validated = None;
    report.noise.sigma_r = f64::NAN;
    report.identifiability.clear();
    report.measurement.window = Some(MeasuredWindow {
        kind: FlowWindow::Gaussian,
        width: 6.0,
        ci95: Some([5.1, f64::INFINITY]),
        declared: false,
        tried: vec![TriedWindow {
            kind: FlowWindow::Gaussian,
            width: 6.0,
            rise: 0.0,
            chiral_coefficient: f64::NAN,
        }],
    });
    report.flow = Some(FlowGrid {
        grid_points: [4, 3],
        spacing: [12.0, f64::NAN],
        window: FlowWindow::Gaussian,
        width: 6.0,
    });
    report.profiles = vec![ProfileResult {
        parameter: "alpha".into(),
        values: vec![1.0, 2.0],
        rise: vec![f64::NAN, 0.0],
        interval: [None, Some(2.0)],
    }];
    report.landscapes = vec![LandscapeResult {
        parameters: ["K_P".into(), "alpha".into()],
        values: [vec![1.0, 2.0], vec![1.0]],
        fixed: vec![vec![f64::NAN, 0.0]],
        refitted: vec![vec![0.0, f64::INFINITY]],
    }];
    report.bootstrap = Some(BootstrapResult {
        replicates: 3,
        failed: 37,
        intervals: BTreeMap::from([("alpha".into(), None)]),
        standard_deviations: BTreeMap::from([("alpha".into(), f64::NAN)]),
    });
    report.fit.trustworthy = false;
    report.fit.doubtful = vec!["optimiser".into()];
    report.fit.doubts = vec!["the fit <used up> its steps: raise --max-steps".into()];
    report.run.warnings.push(report.fit.doubts[0].clone());
    report.fit.status = FitStatus::Stalled;
    report.fit.starts = vec![f64::NAN];
    report.fit.trace = vec![f64::NAN, -1.0];
    report
}

/// Moves a vertex by an amount that depends on its place only, so that neighbours agree.
fn jitter(vertex: [f64; 2]) -> [f64; 2] {
    let key = ((vertex[0] * 2.0).round() as i64 * 7919 + (vertex[1] * 2.0).round() as i64) as usize;
    [vertex[0] + 1.7 * noise(key, 9), vertex[1] + 1.7 * noise(key, 10)]
}

fn area(polygon: &[[f64; 2]]) -> f64 {
    let twice: f64 = sides(polygon).map(|[a, b]| a[0] * b[1] - b[0] * a[1]).sum();
    twice / 2.0
}

fn perimeter(polygon: &[[f64; 2]]) -> f64 {
    sides(polygon).map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum()
}

fn sides(polygon: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    (0..polygon.len()).map(|index| [polygon[index], polygon[(index + 1) % polygon.len()]])
}
