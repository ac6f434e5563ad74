//! Figures of phase diagrams and of simulated tissues.

use crate::figures::{assert_has, units};
use crate::sample;
use voronudge_report::arrows::ArrowScale;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::Palette;
use voronudge_report::figure::{
    CellScalar, CollapseRow, CurveSeries, Landmark, LineStyle, MapLine, PhaseMap, PointsAndCurves, Stroke,
    collapse, configuration_map, distribution, phase_map, points_and_curves,
};

const ACROSS: [f64; 3] = [3.0, 3.5, 4.0];
const UP: [f64; 2] = [0.0, 1.0];

fn map<'a>(values: &'a [f64], lines: &'a [MapLine]) -> PhaseMap<'a> {
    PhaseMap {
        title: "velocity",
        label: "⟨v²⟩",
        x: ("P_0", &ACROSS),
        y: ("α", &UP),
        values,
        scale: AxisScale::Logarithmic,
        palette: Palette::Sequential,
        lines,
    }
}

#[test]
fn a_logarithmic_map_spans_six_decades_and_hatches_what_is_unknown() {
    let line = |label: &str, x: f64| MapLine {
        label: label.into(),
        points: vec![[x, -5.0], [x, 5.0]],
        style: LineStyle::Dashed,
    };
    let lines = [line("within", 3.6), line("without", 9.0)];
    let svg = phase_map(&map(&[1e-28, 0.0, 1.0, 1e-3, f64::NAN, 30.0], &lines));
    assert_has(&svg, &["⟨v²⟩", "within", ">10<", ">10⁻⁴<"]);
    // Lines that do not cross the map have no entry, and nothing is said of 1e-28.
    assert!(!svg.contains("without") && !svg.contains("10⁻⁸") && !svg.contains("NaN"));
    assert!(phase_map(&map(&[], &[])).contains("no data"));
    assert!(phase_map(&map(&[f64::NAN; 6], &[])).contains("no data"));
}

#[test]
fn scaled_points_have_a_colour_for_each_chirality() {
    let row = |label: &str| CollapseRow {
        label: label.into(),
        liquid: vec![[1.0, 2.0], [10.0, 5.0]],
        solid: vec![[3.0, 0.1], [f64::INFINITY, 1.0]],
    };
    let svg = collapse("collapse", ["argument", "value"], &[row("α = 0.1"), row("α = 0.2")]);
    assert_has(&svg, &["α = 0.1", "α = 0.2", "argument", "value"]);
    assert!(collapse("collapse", ["", ""], &[]).contains("no data"));
}

#[test]
fn curves_leave_out_what_a_logarithm_cannot_show() {
    let curve = CurveSeries {
        label: "course",
        colour: "#000",
        stroke: Stroke::Solid,
        points: vec![[1.0, 1.0], [2.0, 0.0], [3.0, 0.01]],
    };
    let chart = |curves: &[CurveSeries<'_>]| {
        points_and_curves(&PointsAndCurves {
            title: "course",
            labels: ["time", "⟨v²⟩"],
            scales: [AxisScale::Linear, AxisScale::Logarithmic],
            series: &[],
            curves,
        })
    };
    let svg = chart(&[curve]);
    assert_has(&svg, &["course", "time", "0.01"]);
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert!(chart(&[]).contains("no data"));
}

#[test]
fn distributions_show_what_they_are_compared_with() {
    let values: Vec<f64> = (0..400).map(|k| 3.8 + 0.1 * sample::noise(k, 3)).chain([99.0]).collect();
    let hexagon = Landmark { label: "regular hexagon".into(), value: 3.722 };
    let svg = distribution("shape", "P/√A", &values, Some(&hexagon));
    assert_has(&svg, &["regular hexagon", "probability density", "outside the axis"]);
    assert!(distribution("shape", "P/√A", &[], None).contains("no data"));
    // A lattice has one value only.
    assert_has(&distribution("shape", "P/√A", &[3.722; 50], None), &["probability density"]);
}

#[test]
fn a_configuration_states_its_scales() {
    let frame = sample::frame("end", 8);
    let arrows = ArrowScale::velocities(std::slice::from_ref(&frame));
    let svg = configuration_map(&frame, &CellScalar::shape_index(&frame), arrows.as_ref(), &units());
    assert_has(&svg, &["µm min⁻¹", "shape index", "µm"]);
    let rest = configuration_map(&frame, &CellScalar::shape_index(&frame), None, &units());
    assert!(!rest.contains("µm min⁻¹"));
}
