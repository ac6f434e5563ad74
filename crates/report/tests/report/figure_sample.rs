//! Synthetic input of the figures that are not about single cells, for the tests and the example.

use voronudge_report::FrameView;
use voronudge_report::chart::AxisScale;
use voronudge_report::figure::{
    BootstrapHistogram, Estimate, FlowMap, Landscape, LandscapeAxis, MethodComparison, MethodSeries,
    ParameterRow, ProfileCurve,
};

use crate::sample::noise;

/// A curved valley over a logarithmic and a linear axis, without a fit in one corner.
pub fn landscape() -> Landscape {
    let x: Vec<f64> = (0..31).map(|column| 0.01 * 10f64.powf(f64::from(column) / 15.0)).collect();
    let y: Vec<f64> = (0..25).map(|row| 3.0 + 0.06 * f64::from(row)).collect();
    let rise = |x: f64, y: f64| {
        let [u, v] = [(x / 0.12).log10(), y - 3.8];
        if x > 0.5 && y < 3.3 { f64::NAN } else { 30.0 * (v + u * u + 0.3 * u).powi(2) * 20.0 + 14.0 * u * u }
    };
    let rises = y.iter().flat_map(|&y| x.iter().map(move |&x| rise(x, y))).collect();
    Landscape {
        title: "nudged".into(),
        x: LandscapeAxis { label: "K_P".into(), unit: "1/min".into(), values: x },
        y: LandscapeAxis { label: "P_0/ℓ_0".into(), unit: String::new(), values: y },
        rise: rises,
        best: [0.12, 3.8],
        truth: Some([0.1, 3.9]),
        contours: vec![(5.99, "95 %".into())],
    }
}

/// A profile that rises steeply on one side and levels off on the other.
pub fn profile() -> ProfileCurve {
    let rise = |value: f64| {
        let u = value - 0.4;
        if u < 0.0 { 60.0 * u * u } else { 3.1 * (1.0 - (-4.0 * u * u).exp()) }
    };
    let mut points: Vec<(f64, f64)> =
        (0..26).map(|step| 0.04 * f64::from(step)).map(|value| (value, rise(value))).collect();
    points[7].1 = f64::NAN;
    ProfileCurve {
        parameter: "K_A".into(),
        unit: "1/(um^2*min)".into(),
        points,
        quadratic: Some((0.4, 0.15)),
        interval: [Some(0.147), None],
        best: 0.4,
    }
}

/// Skewed estimates, some failed, a few far out.
pub fn bootstrap() -> BootstrapHistogram {
    let value = |index: usize| {
        let sum: f64 = (0..6).map(|stream| noise(index, 20 + stream)).sum();
        0.07 + 0.004 * sum + 0.0006 * sum * sum
    };
    let mut estimates: Vec<f64> = (0..400).map(value).collect();
    estimates.extend([f64::NAN, 0.4]);
    BootstrapHistogram {
        parameter: "K_P α".into(),
        unit: "1/min".into(),
        estimates,
        estimate: 0.0705,
        fitted: Some([0.0592, 0.0818]),
        percentile: Some([0.0614, 0.0851]),
    }
}

/// Five methods over four levels of noise.
pub fn comparison(y_scale: AxisScale) -> MethodComparison {
    let names = ["naive", "nudged", "nudged, bootstrap", "total least squares", "oracle"];
    let method = |(index, name): (usize, &str)| MethodSeries {
        name: name.into(),
        points: [0.0, 0.5, 1.0, 2.0]
            .map(|noise| {
                let median = 0.02 * (1.0 + noise * 6.0 / (1.0 + 2.0 * index as f64));
                (noise, median, [0.8 * median, 1.3 * median])
            })
            .into(),
    };
    MethodComparison {
        title: "error of α".into(),
        x_label: "position noise (% of ℓ_0)".into(),
        y_label: "relative error of K_P α".into(),
        y_scale,
        target: Some((0.1, "target 10 %".into())),
        methods: names.into_iter().enumerate().map(method).collect(),
    }
}

/// A swirl on a grid over a frame, without values in one corner and at some points.
pub fn flow(frame: &FrameView) -> FlowMap<'_> {
    let x: Vec<f64> = (0..12).map(|column| 10.0 + 20.0 * f64::from(column)).collect();
    let y: Vec<f64> = (0..9).map(|row| 10.0 + 20.0 * f64::from(row)).collect();
    let predicted: Vec<Option<[f64; 2]>> = y
        .iter()
        .flat_map(|&y| x.iter().map(move |&x| (x < 200.0 || y < 150.0).then_some([x, y])))
        .map(|place| place.map(|[x, y]| [-(y - 100.0) / 90.0, (x - 110.0) / 90.0]))
        .collect();
    let noisy = |(index, velocity): (usize, &Option<[f64; 2]>)| {
        let velocity = velocity.filter(|_| index % 17 != 5)?;
        Some([velocity[0] + 0.3 * noise(index, 11), velocity[1] + 0.3 * noise(index, 12)])
    };
    let measured = predicted.iter().enumerate().map(noisy).collect();
    FlowMap { frame, x, y, measured, held_out: predicted.clone(), predicted }
}

/// Parameters in every state there is.
pub fn parameter_rows() -> Vec<ParameterRow> {
    let row = |symbol: &str, value: f64, ci95: Option<[Option<f64>; 2]>, naive: f64| ParameterRow {
        symbol: symbol.into(),
        unit: "1/um^2".into(),
        value,
        ci95,
        naive: Some(naive),
        estimate: if ci95.is_some() { Estimate::Fitted } else { Estimate::Fixed },
        meaning: String::new(),
    };
    vec![
        row("K_P α", 0.071, Some([Some(0.068), Some(0.074)]), -5.0),
        row("P_0", 3.9, Some([Some(f64::NAN), Some(f64::INFINITY)]), f64::NAN),
        row("K_A", 0.1, None, 0.1),
        row("α", 1.3, Some([None, Some(3.1)]), -40.0),
        row("K_P", 0.9, Some([Some(0.2), None]), 0.8),
        row("P_0", 0.0, Some([None, None]), f64::NAN),
        ParameterRow { estimate: Estimate::AtBound, ..row("K_A", 0.0, Some([Some(0.0), Some(3.1)]), 0.1) },
        row("lost", f64::NAN, None, 0.1),
    ]
}
