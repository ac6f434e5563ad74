//! `rheology`: moduli of fitted tissues, with the errors of the fit.

use crate::program::{assert_described, succeed, voronudge};
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, number, report};
use serde_json::{Value, json};
use std::fs;

/// What of a report of `infer` is read: cells of 20 µm, K_P = 0.02 per minute, and two axes.
pub fn fit(shape_index: f64, chirality: f64, frame: usize) -> Value {
    let parameter = |value: f64| json!({"value": value});
    json!({
        "command": "infer",
        "units": {"length": "um", "time": "min"},
        "length_scale": {"value": 20.0, "unit": "um"},
        "time_scale": {"value": 30.0, "unit": "min"},
        "cells": {"frames": [frame, frame + 2]},
        "parameters": {
            "K_A": parameter(0.1 * 0.02 / 400.0),
            "K_P": parameter(0.02),
            "P_0": parameter(20.0 * shape_index),
            "K_P_alpha": parameter(0.02 * chirality),
        },
        "identifiability": [
            {"eigenvalue": 1e4, "direction": {"K_A": 0.0, "K_P_P_0": 0.0, "K_P": 0.0, "K_P_alpha": 1.0}, "words": ""},
            {"eigenvalue": 1e6, "direction": {"K_A": 0.0, "K_P_P_0": 0.6, "K_P": 0.8, "K_P_alpha": 0.0}, "words": ""},
        ],
    })
}

fn write(folder: &Folder, name: &str, fit: &Value) -> String {
    let path = folder.path().join(name);
    fs::write(&path, fit.to_string()).unwrap();
    path.display().to_string()
}

/// Moduli are those that `moduli` measures, in units of the data.
#[test]
fn a_solid_has_the_moduli_of_its_parameters() {
    let (data, out, plain) = (Folder::new(), Folder::new(), Folder::new());
    let file = write(&data, "report.json", &fit(3.0, 0.5, 3));
    let rest = "--cells 16 --replicas 3 --seed 5";
    let frequencies = "--frequencies 0.0002 200";
    let text = succeed(&format!("rheology {file} {rest} {frequencies}"), &[("--out", out.path())]).stdout;
    assert!(text.contains("is a solid"), "{text}");
    let found = report(out.path());
    assert_described(&found);
    assert_eq!(found["against"], "frame");
    assert_eq!(number(&found, "/fits/0/at"), 4.0);
    succeed(
        &format!("moduli --K_A 0.1 --P_0 3 --alpha 0.5 {rest} --frequencies 0.01 10000"),
        &[("--out", plain.path())],
    );
    let plain = report(plain.path());
    for k in 0..4 {
        let own = number(&found, &format!("/fits/0/moduli/{k}/value"));
        let expected = 0.02 * number(&plain, &format!("/moduli/{k}/value"));
        assert!((own - expected).abs() < 1e-6 * expected.abs().max(1e-3), "{k}: {own} {expected}");
    }
    // Two degrees of freedom.
    let at = |name: &str| number(&found, &format!("/fits/0/moduli/3/{name}"));
    let reach = (1.959_964 * at("inference_error")).hypot(4.302_653 * at("simulation_error"));
    assert!((at("ci95/1") - at("value") - reach).abs() < 1e-5 * reach, "{}", found["fits"][0]["moduli"][3]);
    let dynamic = found["fits"][0]["dynamic"][0]["moduli"].as_array().unwrap();
    let storage = dynamic.iter().find(|own| own["name"] == "shear_storage").unwrap();
    let shear = number(&plain, "/dynamic/0/moduli/2/storage/value");
    assert!((storage["value"].as_f64().unwrap() - 0.02 * shear).abs() < 1e-7);
    let page = fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("Storage and loss moduli") && page.contains("mean field"));
}

/// One standard error of K_P α, 1/√10⁴ in units of 1/30 min beside K_P α = 0.01, makes of Kᵒ what `moduli` finds at α = 0.5 ± 1/60.
#[test]
fn the_error_of_a_modulus_is_what_one_standard_error_of_the_parameters_makes() {
    let (data, out) = (Folder::new(), Folder::new());
    let mut one_axis = fit(3.0, 0.5, 0);
    one_axis["identifiability"].as_array_mut().unwrap().truncate(1);
    let file = write(&data, "report.json", &one_axis);
    let rest = "--cells 16 --replicas 3 --seed 5 --quiet";
    succeed(&format!("rheology {file} {rest}"), &[("--out", out.path())]);
    let found = number(&report(out.path()), "/fits/0/moduli/3/inference_error");
    let [above, below] = [1.0, -1.0].map(|side| {
        let plain = Folder::new();
        let alpha = 0.5 + side / 60.0;
        succeed(&format!("moduli --K_A 0.1 --P_0 3 --alpha {alpha} {rest}"), &[("--out", plain.path())]);
        let report = report(plain.path());
        let replicas = report["moduli"][3]["replicas"].as_array().unwrap().iter();
        replicas.map(|own| 0.02 * own.as_f64().unwrap()).collect::<Vec<_>>()
    });
    let halves: Vec<f64> = above.iter().zip(&below).map(|(a, b)| 0.5 * (a - b)).collect();
    let mean = halves.iter().sum::<f64>() / 3.0;
    let variance = halves.iter().map(|half| (half - mean).powi(2)).sum::<f64>() / 2.0;
    let expected = (mean * mean + variance / 3.0).sqrt();
    assert!((found - expected).abs() < 1e-3 * expected, "{found} {expected}");
}

/// A movie is several fits, drawn against their times.
#[test]
fn several_fits_are_told_against_time() {
    let (data, out) = (Folder::new(), Folder::new());
    let mut files = [fit(3.0, 0.5, 0), fit(3.2, 0.3, 4)];
    files[1]["by_label"] = json!([{"label": 7}]);
    files[0]["verdict"] =
        json!({"kind": "measurement_misfit", "sentence": "Do not quote these numbers yet."});
    let files: Vec<String> =
        files.iter().enumerate().map(|(k, fit)| write(&data, &format!("{k}.json"), fit)).collect();
    let line = format!("rheology {} --times 10 20.5 --cells 16 --replicas 2 --quiet", files.join(" "));
    succeed(&line, &[("--out", out.path())]);
    let found = report(out.path());
    assert_described(&found);
    assert_eq!(found["against"], "time");
    let warnings = found["warnings"].as_array().unwrap();
    for (warning, words) in warnings.iter().zip(["label 7", "0.json: the fit says of itself: Do not quote"]) {
        assert!(warning.as_str().unwrap().contains(words), "{warnings:?}");
    }
    assert_eq!(warnings.len(), 2);
    let shear = [0, 1].map(|k| number(&found, &format!("/fits/{k}/moduli/2/value")));
    assert!(shear[1] < shear[0] && shear[1] > 0.0, "{shear:?}");
    let page = fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("In the course of the movie") && page.contains("time (min)"));
}

#[test]
fn what_is_no_fit_is_refused() {
    let data = Folder::new();
    // What is refused after some work is told after the progress of that.
    let refuse = |line: &str, facts: &[&str]| {
        assert_arguments_refused(line.split_whitespace().chain(["--quiet"]), facts)
    };
    let good = write(&data, "good.json", &fit(3.0, 0.5, 0));
    let mut other = fit(3.0, 0.5, 0);
    other["command"] = json!("moduli");
    refuse(
        &format!("rheology {}", write(&data, "other.json", &other)),
        &["no report of infer", "other.json"],
    );
    let mut unbounded = fit(3.0, 0.5, 0);
    unbounded["identifiability"][0]["eigenvalue"] = json!(0.0);
    refuse(&format!("rheology {}", write(&data, "free.json", &unbounded)), &["not bounded", "free.json"]);
    let mut vague = fit(3.0, 0.5, 0);
    vague["identifiability"][1]["eigenvalue"] = json!(1e-3);
    refuse(&format!("rheology {}", write(&data, "vague.json", &vague)), &["K_P", "vague.json"]);
    let mut nothing = fit(3.0, 0.5, 0);
    nothing["verdict"] =
        json!({"kind": "explains_nothing", "sentence": "The model explains almost nothing."});
    let nothing = write(&data, "nothing.json", &nothing);
    refuse(&format!("rheology {good} {nothing}"), &["explains almost nothing", "nothing.json"]);
    let mut nan = fit(3.0, 0.5, 0);
    nan["parameters"]["K_P"]["value"] = Value::Null;
    refuse(&format!("rheology {}", write(&data, "nan.json", &nan)), &["K_P", "nan.json"]);
    let mut hours = fit(3.0, 0.5, 0);
    hours["units"]["time"] = json!("h");
    let hours = write(&data, "hours.json", &hours);
    refuse(&format!("rheology {good} {hours}"), &["units", "hours.json"]);
    fs::write(data.path().join("text.json"), "no JSON").unwrap();
    refuse(&format!("rheology {}", data.path().join("text.json").display()), &["not JSON", "text.json"]);
    refuse(&format!("rheology {good} --replicas 1"), &["--replicas is 1"]);
    refuse(&format!("rheology {good} --times 1 2"), &["2 times for 1 reports"]);
    refuse(&format!("rheology {good} --start honeycomb"), &["--start honeycomb"]);
    refuse("rheology nowhere.json", &["nowhere.json", "no such file"]);
    assert_eq!(voronudge(["rheology"]).code, Some(2));
}
