//! Tissues with effects that nobody tells: what `discover` says of each, and only then the truth.

use crate::program::{fixture, voronudge};
use crate::scratch::{Folder, report};
use serde_json::Value;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;

fn names() -> Vec<String> {
    let folders = fs::read_dir(fixture("undeclared")).unwrap().map(|folder| folder.unwrap());
    let sets = folders.filter(|folder| folder.file_type().unwrap().is_dir());
    let mut names: Vec<String> = sets.map(|folder| folder.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn texts(list: &Value) -> BTreeSet<String> {
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// The truth of a set, which the program never reads.
fn truth(name: &str) -> Value {
    let text = fs::read_to_string(fixture(&format!("undeclared-truth/{name}.json"))).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// What is wrong with the answer to one set; nothing if it is right.
fn fault(name: &str) -> Option<String> {
    let out = Folder::new();
    let data = fixture(&format!("undeclared/{name}"));
    let outcome =
        voronudge([OsStr::new("discover"), data.as_os_str(), OsStr::new("--out"), out.path().as_os_str()]);
    if outcome.code == Some(2) {
        // Fewer velocities than a fit needs.
        let is_small = texts(&truth(name)["verdicts"]).contains("not_testable");
        let is_said = outcome.stderr.contains("but a fit needs at least");
        return (!is_small || !is_said).then(|| format!("{name}: {}", outcome.stderr));
    }
    let report = report(out.path());
    let verdict = report["verdict"].as_str().unwrap();
    let selected = report["selected"].as_array().unwrap();
    let truth = truth(name);
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

/// Every so many sets are one test, so that tests run side by side.
macro_rules! parts {
    ($($part:literal $name:ident)*) => {
        const TESTS: usize = [$($part),*].len();
        $(
            #[test]
            fn $name() {
                let names = names();
                let faults: Vec<String> =
                    names.iter().skip($part).step_by(TESTS).filter_map(|name| fault(name)).collect();
                assert!(faults.is_empty(), "{faults:#?}");
            }
        )*
    };
}

parts! {
    0 the_truth_is_found_in_the_first_part
    1 the_truth_is_found_in_the_second_part
    2 the_truth_is_found_in_the_third_part
    3 the_truth_is_found_in_the_fourth_part
    4 the_truth_is_found_in_the_fifth_part
    5 the_truth_is_found_in_the_sixth_part
    6 the_truth_is_found_in_the_seventh_part
    7 the_truth_is_found_in_the_eighth_part
    8 the_truth_is_found_in_the_ninth_part
    9 the_truth_is_found_in_the_tenth_part
    10 the_truth_is_found_in_the_eleventh_part
    11 the_truth_is_found_in_the_twelfth_part
    12 the_truth_is_found_in_the_thirteenth_part
    13 the_truth_is_found_in_the_fourteenth_part
    14 the_truth_is_found_in_the_fifteenth_part
    15 the_truth_is_found_in_the_sixteenth_part
}
