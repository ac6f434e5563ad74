//! The page and the report file of `discover`, for three verdicts.

use crate::figures::{assert_has, units};
use crate::pages::schema_errors;
use crate::{discover_sample, figure_sample, sample};
use serde_json::Value;
use voronudge_report::discover_report::Verdict;
use voronudge_report::{BeforeAfter, DiscoverFigures, DiscoverPage, DiscoverReport, FrameView};

fn page(report: &DiscoverReport, frames: &[BeforeAfter<FrameView>], figures: &DiscoverFigures) -> String {
    let page = DiscoverPage { title: "embryo <3>", report, frames, flows: &[], figures };
    page.render().unwrap_or_else(|error| error.to_string())
}

fn figure_count(html: &str) -> usize {
    html.matches("<svg xmlns").count()
}

#[test]
fn an_attribution_is_told_from_verdict_to_seed() {
    let report = discover_sample::attributed();
    let frames = [discover_sample::frames("frame 6", 12), discover_sample::frames("frame 7", 12)];
    let html = page(&report, &frames, &discover_sample::figures());
    let without_namespaces = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for foreign in ["http:", "https:", " src=", "<link", "@import", "url("] {
        assert!(!without_namespaces.contains(foreign), "{foreign}");
    }
    let order = [
        ">Cells drift up the density gradient (density gradient)",
        "<dt>What is missing</dt><dd>density gradient, or p0 gradient or kp gradient: ",
        "<dt>How sure that is</dt><dd>error on data that no fit has seen: 0.530 ± 0.024 before, 0.310 ± 0.024 after",
        "<dt>What it does to forecasts</dt><dd>skill (1 is perfect, 0 as good as no motion): 1 frame ahead 0.310 ± 0.010 before, ",
        "class=\"caveat\">These data cannot tell it from a gradient of P<sub>0</sub>",
        "What to measure next:",
        "class=\"verdict\">attributed<",
        "<h2>Before and after",
        "0.530 ± 0.024</td><td>0.310 ± 0.024</td><td>0.320 ± 0.024",
        "noise alone: 0.29",
        "<h2>What the cells do next, said before",
        "gain by the effects</th><td>0.270 ± 0.010",
        "wrong by 1.12",
        "<h2>What the models make of the cells",
        "Mean square displacement: base model p ",
        "<th>all together</th>",
        "after adding density gradient, arrows on the same scale",
        "mis-tracked (1)",
        "<h2>The effect that was added",
        "µm⁴",
        "cannot tell density gradient from p0 gradient or kp gradient",
        "P<sub>0</sub> held by a measurement",
        "<h2>All candidates",
        "limit beyond ▸",
        "<tr class=\"main\"><th>density gradient",
        "<h2>What remains after that",
        "7.1 µm, 0.64 cell sizes",
        "neighbours correlate (Moran)",
        "chiral correlation",
        "<h2>Noise budget",
        "<h2>Parameters of the base model, before and after",
        "0.0651 to 0.0711",
        "<h2>How the search was checked",
        "the backward difference from frame 5",
        "<h2>What was left out",
        "sha256 0f0f",
    ];
    let mut rest = html.as_str();
    for text in order {
        let found = rest.find(text);
        assert!(found.is_some(), "{text}");
        rest = &rest[found.unwrap_or(0)..];
    }
    assert_eq!(figure_count(&html), 1 + 2 + 2 + (3 + 2) + 2 + 2 + 1 + 1 + 3 + 1);
}

#[test]
fn where_nothing_is_missing_nothing_is_after() {
    let frames = [discover_sample::frames("frame 6", 12)];
    let html = page(&discover_sample::nothing_missing(), &frames, &DiscoverFigures::default());
    let present =
        ["<h2>How well the base model fits", "Effects smaller than 4 to 11 %", "<h2>All candidates"];
    assert_has(&html, &present);
    for absent in ["after adding", "The effect that was added", "What to measure next", "before: ", "alias:"]
    {
        assert!(!html.contains(absent), "{absent}");
    }
    assert_eq!(figure_count(&html), 1 + 1 + 1 + 1);
}

#[test]
fn where_nothing_can_be_told_sections_without_content_disappear() {
    let html = page(&discover_sample::not_testable(), &[], &DiscoverFigures::default());
    assert_has(
        &html,
        &[
            "cannot tell: &lt;9&gt; cells",
            "class=\"verdict\">not testable<",
            "class=\"caution\"",
            "embryo &lt;3&gt;",
        ],
    );
    for absent in ["What is left of the motion", "What remains", "Noise budget", "How the search was checked"]
    {
        assert!(!html.contains(absent), "{absent}");
    }
    for broken in ["NaN", ">inf", "no data", "class=\"caveat\"", "<9>"] {
        assert!(!html.contains(broken), "{broken}");
    }
    assert_eq!(figure_count(&html), 1);
}

#[test]
fn velocities_on_a_grid_are_drawn_on_it() {
    let mut report = discover_sample::attributed();
    report.flow = sample::degenerate_report().flow;
    let frames = [discover_sample::frames("frame 6", 16)];
    let flow = figure_sample::flow(&frames[0].before);
    let flows = [BeforeAfter { before: flow.clone(), after: flow }];
    let figures = DiscoverFigures::default();
    let page =
        DiscoverPage { title: "embryo", report: &report, frames: &frames, flows: &flows, figures: &figures };
    assert_has(
        &page.render().unwrap(),
        &["grid points were used", "no velocity (", &units().velocity_text()],
    );
}

#[test]
fn every_verdict_says_what_it_means() {
    let names = [
        (Verdict::NothingMissing, "nothing_missing"),
        (Verdict::Attributed, "attributed"),
        (Verdict::Partial, "partial"),
        (Verdict::UnexplainedStructured, "unexplained_structured"),
        (Verdict::UnexplainedWhite, "unexplained_white"),
        (Verdict::NotTestable, "not_testable"),
    ];
    for (verdict, name) in names {
        let mut report = discover_sample::nothing_missing();
        report.verdict = verdict;
        let value = serde_json::to_value(&report).unwrap();
        assert_eq!(value["verdict"], name);
        assert_eq!(schema_errors::<DiscoverReport>(&value), Vec::<String>::new());
        let html = page(&report, &[], &DiscoverFigures::default());
        assert_has(&html, &[verdict.name(), verdict.meaning()]);
    }
}

#[test]
fn reports_satisfy_their_schema() {
    for report in
        [discover_sample::attributed(), discover_sample::nothing_missing(), discover_sample::not_testable()]
    {
        let value = serde_json::to_value(report).unwrap();
        assert_eq!(schema_errors::<DiscoverReport>(&value), Vec::<String>::new());
    }
}

#[test]
fn the_names_of_the_file_are_those_of_the_interface() {
    let value = serde_json::to_value(discover_sample::attributed()).unwrap();
    for pointer in [
        "/before/parameters/K_P_alpha/ci95/1",
        "/after/nmse/cross_validated/standard_error",
        "/before/noise_floor_nmse",
        "/before/identifiability/0/eigenvalue",
        "/after/noise/sigma_v",
        "/selected/0/coefficients/0/value",
        "/selected/0/ci95/0/1",
        "/selected/0/p_adjusted",
        "/selected/0/share_of_excess",
        "/selected/0/class/1",
        "/ranking/3/detection_limit",
        "/ranking/3/statistic",
        "/unexplained/correlation_length",
        "/unexplained/curl_share",
        "/unexplained/divergence_share",
        "/noise_budget/after/effects",
    ] {
        assert!(value.pointer(pointer).is_some_and(|found| !found.is_null()), "{pointer}");
    }
    assert_eq!(value["verdict"], "attributed");
    assert_eq!(value["ranking"][3]["status"], "alias");
    assert!(value["selected"][0]["ci95"][1][1].is_null());
    assert!(value["after"]["nmse"]["held_out_frames"].is_null());
}

#[test]
fn the_schema_is_not_a_formality() {
    let good = serde_json::to_value(discover_sample::attributed()).unwrap();
    let refused = |change: fn(&mut Value)| {
        let mut value = good.clone();
        change(&mut value);
        !schema_errors::<DiscoverReport>(&value).is_empty()
    };
    assert!(refused(|value| value["verdict"] = "certain".into()));
    assert!(refused(|value| value["selected"][0]["ci95"] = 1.0.into()));
    assert!(refused(|value| value["after"]["parameters"]["K_P"]["ci95"] = serde_json::json!([1.0])));
    assert!(refused(|value| value["ranking"][0]["p"] = 1.5.into()));
    assert!(refused(|value| value["extra"] = 1.0.into()));
    assert!(refused(|value| {
        value.as_object_mut().unwrap().remove("after");
    }));
}
