//! Tissues with effects that nobody tells: what `discover` says of each, and only then the truth.

use crate::program::{fixture, succeed};
use crate::scratch::{Folder, report};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;

/// Every so many sets are one test, so that tests run side by side.
const TESTS: usize = 4;

fn names() -> Vec<String> {
    let folders = fs::read_dir(fixture("undeclared")).unwrap();
    let mut names: Vec<String> =
        folders.map(|folder| folder.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn texts(list: &Value) -> BTreeSet<String> {
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// What is wrong with the answer to one set; nothing if it is right.
fn fault(name: &str) -> Option<String> {
    let out = Folder::new();
    let data = fixture(&format!("undeclared/{name}"));
    succeed("discover --null-sets 0", &[("", &data), ("--out", out.path())]);
    let report = report(out.path());
    let verdict = report["verdict"].as_str().unwrap();
    let selected = report["selected"].as_array().unwrap();
    let truth = fs::read_to_string(fixture(&format!("undeclared-truth/{name}.json"))).unwrap();
    let truth: Value = serde_json::from_str(&truth).unwrap();
    let effects = truth["effects"].as_array().unwrap();
    let found = selected.iter().map(|own| own["effect"].as_str().unwrap()).collect::<Vec<_>>();
    if !texts(&truth["verdicts"]).contains(verdict) {
        return Some(format!(
            "{name}: {verdict} ({found:?}), but {}: {:?}",
            truth["expected"], truth["verdicts"]
        ));
    }
    // Where causes are to be named, each is, or stands in the class of one that is.
    if verdict == "attributed" {
        for effect in effects {
            let id = effect["id"].as_str().unwrap();
            let is_named =
                selected.iter().any(|own| own["effect"] == id || texts(&own["class"]).contains(id));
            if !is_named {
                return Some(format!("{name}: {found:?}, but {id}"));
            }
        }
        // No cause is named without need.
        if selected.len() > effects.len() {
            return Some(format!("{name}: {found:?}, but {} effects", effects.len()));
        }
    }
    None
}

fn check(part: usize) {
    let faults: Vec<String> =
        names().iter().skip(part).step_by(TESTS).filter_map(|name| fault(name)).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn the_truth_is_found_in_the_first_part() {
    check(0);
}

#[test]
fn the_truth_is_found_in_the_second_part() {
    check(1);
}

#[test]
fn the_truth_is_found_in_the_third_part() {
    check(2);
}

#[test]
fn the_truth_is_found_in_the_fourth_part() {
    check(3);
}
