//! Landscapes, profiles, bootstraps, comparisons and flows: what they must contain, and that
//! unknown numbers do no harm.

use crate::figures::{assert_has, assert_sound, units};
use crate::{figure_sample, sample};
use voronudge_report::FrameView;
use voronudge_report::chart::AxisScale;
use voronudge_report::figure::{
    FlowMap, VelocityField, bootstrap_histogram, flow_map, landscape, method_comparison, profile,
};

#[test]
fn a_landscape_names_axes_contours_and_marks() {
    let mut sample = figure_sample::landscape();
    let svg = landscape(&sample);
    assert_sound("landscape", &svg);
    let marks = ["best fit", "truth", "no fit", ">95 %<", "rise of −2 log likelihood", "#440154"];
    assert_has(&svg, &marks);
    assert_has(&svg, &["(min⁻¹)", ">100<", "nudged</text>"]);
    assert!(svg.len() < 60_000, "{} bytes", svg.len());
    sample.truth = Some([9.0, 3.9]);
    assert_has(&landscape(&sample), &["truth (outside)"]);
}

#[test]
fn landscapes_without_a_grid_say_so() {
    let sample = figure_sample::landscape();
    let mut unknown = sample.clone();
    unknown.rise.fill(f64::NAN);
    let mut short = sample.clone();
    short.rise.pop();
    let mut falling = sample.clone();
    falling.x.values.reverse();
    let mut empty = sample.clone();
    empty.y.values.clear();
    for landscape in [unknown, short, falling, empty].iter().map(landscape) {
        assert_sound("landscape", &landscape);
        assert!(landscape.contains("no data"));
    }
    let mut strange = sample;
    strange.best = [f64::NAN, 0.0];
    strange.truth = Some([f64::INFINITY, 1.0]);
    strange.contours = vec![(f64::NAN, "unknown".into()), (-1.0, "below".into()), (1e9, "above".into())];
    strange.rise[40] = f64::INFINITY;
    let svg = landscape(&strange);
    assert_sound("landscape", &svg);
    assert!(!svg.contains(">unknown<") && !svg.contains("no data"));
}

#[test]
fn a_flat_landscape_still_has_a_scale() {
    let mut flat = figure_sample::landscape();
    flat.rise.fill(0.0);
    flat.contours.clear();
    let svg = landscape(&flat);
    assert_sound("landscape", &svg);
    assert!(!svg.contains("no data"));
}

#[test]
fn a_profile_states_its_interval_and_limit() {
    let mut sample = figure_sample::profile();
    let svg = profile(&sample);
    assert_sound("profile", &svg);
    let texts = [">95 %<", "95 %: above 0.15 µm⁻² min⁻¹", "quadratic approximation", "−2 log likelihood"];
    assert_has(&svg, &texts);
    sample.interval = [None, None];
    sample.quadratic = Some((0.4, f64::NAN));
    let svg = profile(&sample);
    assert_has(&svg, &["95 %: not bounded<"]);
    assert!(!svg.contains("quadratic"));
}

#[test]
fn profiles_without_points_say_so() {
    let mut sample = figure_sample::profile();
    sample.interval = [Some(f64::NAN), Some(f64::INFINITY)];
    sample.best = f64::NAN;
    assert_sound("profile", &profile(&sample));
    sample.points.truncate(1);
    assert!(profile(&sample).contains("no data"));
    sample.points.clear();
    assert!(profile(&sample).contains("no data"));
}

#[test]
fn a_bootstrap_shows_both_intervals_and_what_is_outside() {
    let mut sample = figure_sample::bootstrap();
    let svg = bootstrap_histogram(&sample);
    assert_sound("bootstrap", &svg);
    assert_has(&svg, &["fit 95 %: 0.059 to 0.082 min⁻¹", "percentile 95 %: 0.061 to 0.085 min⁻¹"]);
    assert_has(&svg, &["estimate<", "number of resamples", "outside ▸"]);
    sample.fitted = Some([f64::NAN, 1.0]);
    sample.percentile = None;
    sample.estimate = f64::NAN;
    let svg = bootstrap_histogram(&sample);
    assert_sound("bootstrap", &svg);
    assert!(!svg.contains("95 %:") && !svg.contains("estimate<"));
    sample.estimates = vec![0.3; 5];
    assert_sound("bootstrap", &bootstrap_histogram(&sample));
    sample.estimates = vec![f64::NAN];
    assert!(bootstrap_histogram(&sample).contains("no data"));
}

#[test]
fn a_comparison_tells_methods_apart_without_colour() {
    for scale in [AxisScale::Linear, AxisScale::Logarithmic] {
        let svg = method_comparison(&figure_sample::comparison(scale));
        assert_sound("comparison", &svg);
        assert_has(
            &svg,
            &["naive", "total least squares", "target 10 %", ">0.5<", "stroke-dasharray=\"7 4\""],
        );
    }
}

#[test]
fn comparisons_keep_the_look_of_a_method_and_skip_what_is_unknown() {
    let mut sample = figure_sample::comparison(AxisScale::Logarithmic);
    sample.methods[0].points.clear();
    sample.methods[2].points[1] = (0.5, -1.0, [f64::NAN, 0.1]);
    sample.methods[3].points[1].2 = [0.0, f64::INFINITY];
    sample.target = Some((f64::NAN, "nowhere".into()));
    let svg = method_comparison(&sample);
    assert_sound("comparison", &svg);
    assert!(!svg.contains("naive") && !svg.contains("nowhere"));
    assert_has(&svg, &["stroke-dasharray=\"7 4\""]);
    sample.methods.clear();
    assert!(method_comparison(&sample).contains("no data"));
}

#[test]
fn flows_share_their_arrow_and_mark_what_is_missing() {
    let frame = sample::frame("frame 6", 16);
    let flows = [figure_sample::flow(&frame)];
    let scale = FlowMap::scale(&flows);
    for (field, missing) in VelocityField::ALL.into_iter().zip([10, 4, 10]) {
        let svg = flow_map(&flows[0], field, scale.as_ref(), &units());
        assert_sound(field.caption(), &svg);
        assert_has(&svg, &[">50 µm<", ">2 µm min⁻¹<", "left out ("]);
        assert_has(&svg, &[&format!("no velocity ({missing})")]);
    }
}

#[test]
fn flows_need_neither_cells_nor_complete_lists() {
    let frame = FrameView::default();
    let mut flow = figure_sample::flow(&frame);
    flow.measured.truncate(30);
    flow.predicted[3] = Some([f64::NAN, 0.0]);
    flow.x[2] = f64::NAN;
    let scale = FlowMap::scale(std::slice::from_ref(&flow));
    let svg = flow_map(&flow, VelocityField::Residual, scale.as_ref(), &units());
    assert_sound("flow", &svg);
    assert!(!svg.contains("no data"));
    flow.measured.clear();
    assert!(flow_map(&flow, VelocityField::Measured, scale.as_ref(), &units()).contains("no data"));
    assert!(flow_map(&flow, VelocityField::Predicted, None, &units()).contains("no data"));
    flow.x.clear();
    assert!(flow_map(&flow, VelocityField::Predicted, scale.as_ref(), &units()).contains("no data"));
}
