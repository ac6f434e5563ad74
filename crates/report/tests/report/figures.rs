//! What figures must contain, must not contain, and how large they may be.

use crate::{figure_sample, sample};
use voronudge_report::arrows::ArrowScale;
use voronudge_report::colour::Palette;
use voronudge_report::figure::{
    CellScalar, Emphasis, ErrorBar, NudgeHistogram, ObjectiveTrace, Prediction, VelocityField, cell_map,
    error_bars, nudge_histogram, nudge_map, objective_trace, parameter_intervals, predicted_against_measured,
    velocity_map,
};
use voronudge_report::{FrameView, Units};

pub fn units() -> Units {
    Units { length: "um".into(), time: "min".into() }
}

/// All figures of one frame.
fn figures(frame: FrameView) -> Vec<(&'static str, String)> {
    let frames = [frame];
    let frame = &frames[0];
    let units = units();
    let velocities = ArrowScale::velocities(&frames);
    let nudges = ArrowScale::nudges(&frames);
    let pairs = Prediction::Fitted.of_cells(&frames);
    let signed = CellScalar {
        values: frame.cells.iter().map(|cell| cell.nudge[0]).collect(),
        label: "nudge along x (µm)".into(),
        palette: Palette::Diverging { centre: 0.0 },
        limits: None,
    };
    let velocity = |field| velocity_map(frame, field, velocities.as_ref(), &units);
    vec![
        ("area", cell_map(frame, &CellScalar::area_ratio(frame), &units)),
        ("shape", cell_map(frame, &CellScalar::shape_index(frame), &units)),
        ("signed", cell_map(frame, &signed, &units)),
        ("measured", velocity(VelocityField::Measured)),
        ("predicted", velocity(VelocityField::Predicted)),
        ("residual", velocity(VelocityField::Residual)),
        ("nudges", nudge_map(frame, nudges.as_ref(), &units)),
        ("scatter", predicted_against_measured(&pairs, 0.12, &units)),
        ("histogram", nudge_histogram(&NudgeHistogram::new(&frames, 11.0, 0.013))),
    ]
}

/// What every figure must be.
pub fn assert_sound(name: &str, svg: &str) {
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{name}");
    assert!(svg.contains("viewBox"), "{name}");
    let drawn = svg.split(" d=\"").skip(1).filter_map(|rest| rest.split('"').next());
    for path in drawn.chain([svg]) {
        assert!(!path.contains("NaN") && !path.contains("inf"), "{name}: {path:.200}");
    }
    assert!(!svg.contains("<script") && !svg.contains("href"), "{name}");
}

/// What a figure or a page must contain.
pub fn assert_has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "lacks {part}");
    }
}

#[test]
fn maps_state_scale_and_unit() {
    for (name, svg) in figures(sample::frame("frame 6", 20)) {
        assert_sound(name, &svg);
        let wanted: &[&str] = match name {
            "area" => &["area / mean area", ">50 µm<", "left out (", "#440154"],
            "shape" => &["shape index P/√A", ">50 µm<"],
            "signed" => &["nudge along x (µm)", "#001261"],
            "measured" | "predicted" | "residual" => &[">50 µm<", ">2 µm min⁻¹<", "left out ("],
            "nudges" => &["drawn ×", ">0.2 µm, ", "contacts lost (2)", "gained (1)"],
            "scatter" => &["measured velocity (µm min⁻¹)", "predicted velocity (µm min⁻¹)", "NMSE = 0.12"],
            "histogram" => &["number of cells", "assumed noise"],
            _ => &[],
        };
        for text in wanted {
            assert!(svg.contains(text), "{name} lacks {text}");
        }
    }
}

#[test]
fn the_three_velocity_maps_share_their_reference_arrow() {
    let frames = [sample::frame("frame 6", 20)];
    let scale = ArrowScale::velocities(&frames);
    let reference = |field| {
        let svg = velocity_map(&frames[0], field, scale.as_ref(), &units());
        let place = svg.find(" µm min⁻¹</text>").unwrap();
        svg[..place].rsplit("<text ").next().unwrap().to_owned()
    };
    let [measured, predicted, residual] = VelocityField::ALL.map(reference);
    assert_eq!(measured, predicted);
    assert_eq!(measured, residual);
}

#[test]
fn a_map_of_1700_cells_stays_small() {
    for (name, svg) in figures(sample::frame("frame 6", 41)) {
        assert!(svg.len() < 300_000, "{name}: {} bytes", svg.len());
    }
}

#[test]
fn unknown_numbers_and_empty_frames_do_no_harm() {
    let mut infinite = sample::frame("frame 6", 8);
    for cell in &mut infinite.cells {
        cell.area = f64::INFINITY;
        cell.nudge = [f64::NAN; 2];
    }
    for frame in [sample::degenerate_frame(), FrameView::default(), infinite] {
        for (name, svg) in figures(frame) {
            assert_sound(name, &svg);
        }
    }
    for (name, svg) in figures(FrameView::default()) {
        assert!(svg.contains("no data"), "{name}");
    }
    let empty = ObjectiveTrace { values: &[], expected: Some(3.0) };
    for svg in [error_bars(&[]), parameter_intervals(&[]), objective_trace(&empty)] {
        assert!(svg.contains("no data"));
    }
}

#[test]
fn bars_mark_one_and_print_their_numbers() {
    let bar = |label: &str, nmse: f64| ErrorBar {
        label: label.into(),
        nmse,
        standard_error: Some(0.02),
        emphasis: Emphasis::Quiet,
    };
    let svg = error_bars(&[bar("naive fit", 41.0), bar("nudged", 0.31), bar("lost", f64::NAN)]);
    assert_sound("bars", &svg);
    for text in ["naive fit", "41 ± 0.02 ▸", "0.31 ± 0.02", "1: predicts nothing"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains("lost") && !svg.contains("logarithmic"));
}

#[test]
fn errors_too_small_for_bars_are_points_on_a_logarithmic_axis() {
    let bar = |label: &str, nmse: f64| ErrorBar {
        label: label.into(),
        nmse,
        standard_error: Some(2e-4),
        emphasis: Emphasis::Main,
    };
    let bars = [bar("before", 0.98), bar("after", 2.5e-3), bar("lost", 0.0)];
    let svg = error_bars(&bars);
    assert_sound("logarithmic", &svg);
    // What nobody is to quote has no say in the axis.
    let quiet = bars.clone().map(|bar| ErrorBar { emphasis: Emphasis::Quiet, ..bar });
    assert!(!error_bars(&quiet).contains("logarithmic"));
    for text in ["NMSE (1: predicts nothing), logarithmic", "0.0025 ± 0.0002", "before", "after"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(svg.matches("stroke-linecap=\"round\"").count() >= 3);
}

#[test]
fn intervals_have_symbols_units_bounds_and_naive_values() {
    let svg = parameter_intervals(&figure_sample::parameter_rows());
    assert_sound("intervals", &svg);
    let texts =
        ["0.0710 µm⁻²", "−5.00", "(fixed)", "95 % interval", "below 3.1", "above 0.20", "not bounded"];
    for text in texts.into_iter().chain([">P</tspan>", "at a bound"]) {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains("lost"));
}

#[test]
fn the_trace_names_its_axes_and_expectation() {
    let values = [30_000.0, f64::NAN, 900.0, 870.0];
    let svg = objective_trace(&ObjectiveTrace { values: &values, expected: Some(856.0) });
    assert_sound("trace", &svg);
    for text in ["iteration", "penalised objective", "expected 856", "1000"] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn charts_carry_the_numbers_that_they_show() {
    let bar = |label: &str, nmse, standard_error| ErrorBar {
        label: label.into(),
        nmse,
        standard_error,
        emphasis: Emphasis::Main,
    };
    let svg = error_bars(&[bar("naive <fit>", 0.5, None), bar("held out, twice", 1.0 / 3.0, Some(0.025))]);
    let table = svg.split_once("<metadata>").and_then(|(_, rest)| rest.split_once("</metadata>")).unwrap().0;
    let axis = "NMSE (0: perfect, 1: predicts nothing)";
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines[0], format!("series,&quot;{axis}&quot;,&quot;standard error of {axis}&quot;"));
    assert_eq!(lines[1..], ["naive &lt;fit&gt;,0.5,", "&quot;held out, twice&quot;,0.333333,0.025"]);
}
