//! The page is one file, escapes its text, and the report fits its schema.

use crate::sample;
use serde_json::Value;
use voronudge_report::{INFER_SCHEMA, InferReport};

/// What the schema has to say against a report.
fn errors(report: &InferReport) -> Result<Vec<String>, Box<dyn std::error::Error>> {
    let schema: Value = serde_json::from_str(INFER_SCHEMA)?;
    let value: Value = serde_json::from_str(&report.to_json()?)?;
    let validator = jsonschema::validator_for(&schema).map_err(|error| error.to_string())?;
    let errors = validator.iter_errors(&value);
    Ok(errors.map(|error| error.to_string()).collect())
}

#[test]
fn the_page_is_self_contained() {
    let report = sample::report();
    let frames = [sample::frame("frame 6", 12), sample::frame("frame 7", 12)];
    let html = sample::page(&report, &frames).render().unwrap();
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
    ] {
        let found = html.contains(text);
        assert!(found, "{text}");
    }
    assert_eq!(html.matches("<svg xmlns").count(), 1 + 3 + 2 * 6 + 1);
}

#[test]
fn text_is_escaped_and_unknown_numbers_do_not_show() {
    let report = sample::degenerate_report();
    let frames = [sample::degenerate_frame()];
    let html = sample::page(&report, &frames).render().unwrap();
    assert!(html.contains("embryo &lt;3&gt;"));
    assert!(html.contains("frame &lt;0&gt;"));
    assert!(!html.contains("<script>alert"));
    assert!(!html.contains("NaN") && !html.contains(">inf"));
    for text in ["not determined", "below 3.1", "above 0.20", "not bounded", ", at a bound"] {
        assert!(html.contains(text), "{text}");
    }
}

#[test]
fn reports_satisfy_their_schema() {
    assert_eq!(errors(&sample::report()).unwrap(), Vec::<String>::new());
    assert_eq!(errors(&sample::degenerate_report()).unwrap(), Vec::<String>::new());
}

#[test]
fn the_schema_is_not_a_formality() {
    let schema: Value = serde_json::from_str(INFER_SCHEMA).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let mut value: Value = serde_json::from_str(&sample::report().to_json().unwrap()).unwrap();
    value["parameters"]["K_P"]["ci95"] = serde_json::json!([1.0]);
    assert!(!validator.is_valid(&value));
    let mut report = sample::report();
    report.run.inputs[0].sha256 = "short".into();
    assert_eq!(errors(&report).unwrap().len(), 1);
}

#[test]
fn numbers_that_are_not_finite_are_null() {
    let value: Value = serde_json::from_str(&sample::report().to_json().unwrap()).unwrap();
    assert!(value["naive"]["K_A"].is_null());
    assert!(value["parameters"]["K_A"]["ci95"].is_null());
    let value: Value = serde_json::from_str(&sample::degenerate_report().to_json().unwrap()).unwrap();
    assert!(value["parameters"]["P_0"]["ci95"][0].is_null());
    assert_eq!(value["parameters"]["P_0"]["ci95"][1], 3.1);
    assert_eq!(value["command"], "infer");
    assert_eq!(value["nmse"]["mean_removed"], "per_frame");
}
