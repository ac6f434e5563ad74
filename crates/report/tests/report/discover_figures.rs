//! The figures of `discover`: what they must contain, and that unknown numbers do no harm.

use crate::figures::{assert_has, assert_sound, units};
use crate::{discover_sample, figure_sample, sample};
use voronudge_report::arrows::ArrowScale;
use voronudge_report::discover_report::NoiseBudget;
use voronudge_report::figure::{
    Emphasis, ErrorBar, FlowMap, Outlier, Suspicion, correlation_function, effect_ranking,
    error_bars_with_floor, noise_budget, outlier_map, partial_regression, residual_flow_maps, residual_maps,
};
use voronudge_report::{BeforeAfter, FrameView};

/// The reference arrow of a map with its label.
fn reference(svg: &str) -> Option<&str> {
    svg[..svg.find(" µm min⁻¹</text>")?].rsplit("<text ").next()
}

#[test]
fn residuals_before_and_after_share_their_arrow_and_their_section() {
    let frames = discover_sample::frames("frame 6", 16);
    let scale = ArrowScale::residuals(std::slice::from_ref(&frames.before));
    let maps = residual_maps(&frames, scale.as_ref(), &units());
    for (name, svg) in maps.named() {
        assert_sound(name, svg);
        assert_has(svg, &[">50 µm<", "left out ("]);
    }
    assert!(reference(&maps.before).is_some());
    assert_eq!(reference(&maps.before), reference(&maps.after));
    assert_ne!(maps.before, maps.after);
    let unknown = residual_maps(&BeforeAfter::<FrameView>::default(), scale.as_ref(), &units());
    assert!(unknown.before.contains("no data") && unknown.after.contains("no data"));
    assert!(residual_maps(&frames, None, &units()).after.contains("no data"));
}

#[test]
fn residual_flows_share_their_arrow_and_their_section() {
    let frame = sample::frame("frame 6", 16);
    let before = figure_sample::flow(&frame);
    let mut after = before.clone();
    after.predicted = after.measured.clone();
    after.predicted[7] = Some([3.0, f64::NAN]);
    let flows = BeforeAfter { before, after };
    let scale = FlowMap::residual_scale(flows.named().into_iter().map(|(_, flow)| flow));
    let maps = residual_flow_maps(&flows, scale.as_ref(), &units());
    for (name, svg) in maps.named() {
        assert_sound(name, svg);
        assert_has(svg, &["no velocity (", ">50 µm<"]);
    }
    assert_eq!(reference(&maps.before), reference(&maps.after));
    let view_box = |svg: &str| svg.split('"').nth(3).map(str::to_owned);
    assert_eq!(view_box(&maps.before), view_box(&maps.after));
    assert!(residual_flow_maps(&flows, None, &units()).before.contains("no data"));
}

#[test]
fn the_budget_names_its_parts_and_skips_what_is_not_there() {
    let known = discover_sample::attributed().noise_budget;
    let svg = noise_budget(&[("base model", known.before), ("with effects", known.after)]);
    assert_sound("budget", &svg);
    assert_has(
        &svg,
        &["base model", "added effects", "noise of positions", "unexplained", ">45 %<", ">22 %<"],
    );
    let svg = noise_budget(&[("base model", known.before)]);
    assert!(!svg.contains("added effects"));
    let odd = NoiseBudget { base: 1.3, effects: f64::NAN, unexplained: -0.3, ..NoiseBudget::default() };
    let svg = noise_budget(&[("base model", odd)]);
    assert_sound("odd budget", &svg);
    assert_has(&svg, &[">130 %<"]);
    assert!(!svg.contains("unexplained"));
    assert!(noise_budget(&[]).contains("no data"));
    assert!(noise_budget(&[("base model", NoiseBudget::default())]).contains("no data"));
}

#[test]
fn the_ranking_marks_limits_aliases_and_what_cannot_be_tested() {
    let svg = effect_ranking(&discover_sample::attributed().ranking);
    assert_sound("ranking", &svg);
    assert_has(
        &svg,
        &[
            "density gradient",
            "detection limit",
            "95 % interval",
            ">alias<",
            ">not testable<",
            "limit beyond ▸",
            "size of the effect (rms, % of the velocity)",
            "no mechanism",
        ],
    );
    assert!(effect_ranking(&discover_sample::not_testable().ranking).contains("no data"));
    assert!(effect_ranking(&[]).contains("no data"));
}

#[test]
fn the_floor_is_drawn_where_it_is_known() {
    let bar =
        ErrorBar { label: "base".into(), nmse: 0.53, standard_error: Some(0.02), emphasis: Emphasis::Main };
    let svg = error_bars_with_floor(std::slice::from_ref(&bar), Some(0.29));
    assert_sound("floor", &svg);
    assert_has(&svg, &["noise alone: 0.29", "0.53 ± 0.02"]);
    let svg = error_bars_with_floor(&[bar], Some(f64::NAN));
    assert_sound("no floor", &svg);
    assert!(!svg.contains("noise alone"));
}

#[test]
fn correlations_name_their_kind_and_keep_to_what_is_known() {
    for mut function in discover_sample::figures().correlations {
        let svg = correlation_function(&function);
        assert_sound("correlation", &svg);
        let label = format!("{} correlation", function.correlation.name());
        assert_has(&svg, &[&label, "before<", "after<", "distance / ℓ", "opacity=\".18\""]);
        function.points.before[2].value = f64::NAN;
        function.points.before[3].standard_error = f64::INFINITY;
        function.points.after.clear();
        let svg = correlation_function(&function);
        assert_sound("partly known correlation", &svg);
        assert!(!svg.contains("after<"));
        function.points.before.clear();
        assert!(correlation_function(&function).contains("no data"));
    }
}

#[test]
fn a_partial_regression_states_its_slope() {
    let mut plot = discover_sample::figures().regressions.remove(0);
    let svg = partial_regression(&plot, &units());
    assert_sound("regression", &svg);
    assert_has(
        &svg,
        &[
            "slope 0.97 (95 %: 0.83 to 1.11)",
            "density gradient, predicted (µm min⁻¹)",
            "means of equal groups",
        ],
    );
    plot.slope_ci95 = Some([f64::NAN, 1.0]);
    plot.points.truncate(9);
    plot.points[1].residual[0] = f64::INFINITY;
    let svg = partial_regression(&plot, &units());
    assert_sound("small regression", &svg);
    assert_has(&svg, &["slope 0.97<"]);
    assert!(!svg.contains("means of equal groups"));
    plot.slope = f64::NAN;
    assert!(!partial_regression(&plot, &units()).contains("slope 0"));
    plot.points.clear();
    assert!(partial_regression(&plot, &units()).contains("no data"));
}

#[test]
fn suspicious_cells_are_counted_by_kind() {
    let frame = sample::frame("frame 6", 16);
    let mut outliers = discover_sample::figures().outliers.remove(0);
    outliers.push(Outlier { cell: 1_000_000, suspicion: Suspicion::Merged });
    let svg = outlier_map(&frame, &outliers, &units());
    assert_sound("outliers", &svg);
    assert_has(&svg, &["merged (1)", "split (2)", "mis-tracked (1)", ">50 µm<"]);
    assert_sound("unknown", &outlier_map(&sample::degenerate_frame(), &outliers, &units()));
    assert!(outlier_map(&FrameView::default(), &outliers, &units()).contains("no data"));
}
