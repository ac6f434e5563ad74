//! The page is one file, escapes its text, and the report fits its schema.

use crate::{figure_sample, sample};
use schemars::JsonSchema;
use serde_json::Value;
use voronudge_report::figure::FlowMap;
use voronudge_report::{InferReport, Uncertainty, schema_of};

/// What a schema has to say against a report.
pub fn schema_errors<R: JsonSchema>(report: &Value) -> Vec<String> {
    match jsonschema::validator_for(schema_of::<R>().as_value()) {
        Ok(validator) => validator.iter_errors(report).map(|error| error.to_string()).collect(),
        Err(error) => vec![error.to_string()],
    }
}

fn errors(report: &InferReport) -> Vec<String> {
    let written = serde_json::to_value(report);
    written.map_or_else(|error| vec![error.to_string()], |report| schema_errors::<InferReport>(&report))
}

/// A picture has an arrow for each cell as long as one can tell them apart.
#[test]
fn very_many_cells_are_averaged_over_squares() {
    let report = sample::report();
    let page = |side: usize| {
        let frames = [sample::frame("frame 6", side)];
        sample::page(&report, &frames, &Uncertainty::default()).render().unwrap()
    };
    let [few, many] = [page(100), page(150)];
    assert!(!few.contains("squares of") && few.contains("Every cell used") && few.len() > 3_500_000);
    for text in [
        "measured velocities, means over squares of about 13 cells",
        "cell areas, means over squares of about 13 cells",
        "nudges, magnified as stated, of cells in the middle",
        "One in 2 cells used",
    ] {
        assert!(many.contains(text), "{text}");
    }
    assert!(many.len() < 2_500_000, "{}", many.len());
}

#[test]
fn the_page_is_self_contained() {
    let report = sample::report();
    let frames = [sample::frame("frame 6", 12), sample::frame("frame 7", 12)];
    let html = sample::page(&report, &frames, &Uncertainty::default()).render().unwrap();
    let without_namespaces = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for foreign in ["http:", "https:", " src=", "<link", "@import", "url("] {
        assert!(!without_namespaces.contains(foreign), "{foreign}");
    }
    for text in [
        "K<sub>P</sub> α",
        "P<sub>0</sub>/ℓ<sub>0</sub>",
        "How to read this page",
        "µm⁻² min⁻¹",
        "held fixed",
        "frame 7",
        "sha256 0f0f",
        "open polygon",
        "estimated from these data",
        "<li>K<sub>P</sub> α is known to 2 %.</li>",
        "2 starts ended at objectives from 871.0 to 873.5",
        "v<sub>0</sub>",
        "polarities: what the cells move by of themselves",
        "Kinds of cells",
        "cells of label 3",
        "What to measure next",
        "<b>0.0016</b> <span class=\"quiet\">(× 0.55)</span>",
    ] {
        let found = html.contains(text);
        assert!(found, "{text}");
    }
    assert_eq!(html.matches("<svg xmlns").count(), 1 + 1 + 3 + 2 * 7 + 1);
}

#[test]
fn text_is_escaped_and_unknown_numbers_do_not_show() {
    let report = sample::degenerate_report();
    let frames = [sample::degenerate_frame()];
    let html = sample::page(&report, &frames, &Uncertainty::default()).render().unwrap();
    assert!(html.contains("embryo &lt;3&gt;"));
    assert!(html.contains("frame &lt;0&gt;"));
    assert!(!html.contains("<script>alert"));
    assert!(!html.contains("NaN") && !html.contains(">inf"));
    for text in ["not determined", "below 3.1", "above 0.20", "not bounded", ", at a bound"] {
        assert!(html.contains(text), "{text}");
    }
}

#[test]
fn what_was_asked_beyond_the_fit_is_drawn() {
    let mut report = sample::report();
    report.bootstrap = sample::degenerate_report().bootstrap;
    let frames = [sample::frame("frame 6", 12)];
    let slice = figure_sample::landscape();
    let uncertainty = Uncertainty {
        profiles: vec![figure_sample::profile()],
        bootstrap: vec![figure_sample::bootstrap()],
        landscapes: vec![[slice.clone(), slice]],
    };
    let plain = sample::page(&report, &frames, &Uncertainty::default()).render().unwrap();
    let html = sample::page(&report, &frames, &uncertainty).render().unwrap();
    let figures = |html: &str| html.matches("<svg xmlns").count();
    assert_eq!(figures(&html), figures(&plain) + 4);
    for text in ["<h3>Profiles", "<h3>Landscapes", "<h3>Bootstrap", "3 synthetic data sets", "37 more"] {
        assert!(html.contains(text) && !plain.contains(text), "{text}");
    }
}

#[test]
fn velocities_on_a_grid_are_drawn_on_it() {
    let mut report = sample::report();
    report.flow = sample::degenerate_report().flow;
    let frames = [sample::frame("frame 6", 20)];
    let flows: Vec<FlowMap<'_>> = frames.iter().map(figure_sample::flow).collect();
    let uncertainty = Uncertainty::default();
    let page = sample::page(&report, &frames, &uncertainty);
    let html = voronudge_report::InferPage { flows: &flows, ..page }.render().unwrap();
    for text in ["grid points used", "Every grid point used", "no velocity ("] {
        assert!(html.contains(text), "{text}");
    }
}

#[test]
fn doubts_stand_in_a_box_of_their_own() {
    let frames = [sample::frame("frame 6", 12)];
    let html =
        |report: &InferReport| sample::page(report, &frames, &Uncertainty::default()).render().unwrap();
    assert!(!html(&sample::report()).contains("class=\"caution\""));
    let doubtful = html(&sample::degenerate_report());
    assert!(doubtful.contains("class=\"caution\""));
    assert_eq!(doubtful.matches("the fit &lt;used up&gt; its steps").count(), 1);
}

#[test]
fn reports_satisfy_their_schema() {
    assert_eq!(errors(&sample::report()), Vec::<String>::new());
    assert_eq!(errors(&sample::degenerate_report()), Vec::<String>::new());
}

#[test]
fn the_schema_is_not_a_formality() {
    let mut value = serde_json::to_value(sample::report()).unwrap();
    value["parameters"]["K_P"]["ci95"] = serde_json::json!([1.0]);
    assert!(!schema_errors::<InferReport>(&value).is_empty());
    let mut report = sample::report();
    report.run.inputs[0].sha256 = "short".into();
    assert_eq!(errors(&report).len(), 1);
    let mut report = sample::report();
    report.fit.doubtful = vec!["weather".into()];
    assert_eq!(errors(&report).len(), 1);
}

#[test]
fn numbers_that_are_not_finite_are_null() {
    let value = serde_json::to_value(sample::report()).unwrap();
    assert!(value["naive"]["K_A"].is_null());
    assert!(value["parameters"]["K_A"]["ci95"].is_null());
    let value = serde_json::to_value(sample::degenerate_report()).unwrap();
    assert!(value["parameters"]["P_0"]["ci95"][0].is_null());
    assert_eq!(value["parameters"]["P_0"]["ci95"][1], 3.1);
    assert_eq!(value["command"], "infer");
    assert_eq!(value["nmse"]["mean_removed"], "per_frame");
}
