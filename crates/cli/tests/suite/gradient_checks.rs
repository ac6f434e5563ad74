//! `check-gradients`: every derivative of every term, on built-in and on given positions.

use crate::program::{fixture, voronudge};
use crate::scratch::names;
use serde_json::Value;
use std::collections::BTreeSet;

const TERMS: [&str; 6] = [
    "adhesion",
    "area_elasticity",
    "chiral Voronoi model",
    "contractility",
    "cortical_chirality",
    "geometry",
];

/// The built-in positions and every fixture that is a data set by itself.
fn subjects() -> Vec<Vec<String>> {
    let folders = names(&fixture(""))
        .into_iter()
        .map(|name| fixture(&name))
        .filter(|path| path.join("positions.npy").is_file());
    let subjects: Vec<Vec<String>> =
        std::iter::once(vec![]).chain(folders.map(|path| vec![path.to_str().unwrap().to_owned()])).collect();
    assert!(subjects.len() >= 6, "fixtures are missing");
    subjects
}

#[test]
fn all_checks_pass_everywhere_and_are_listed_by_term() {
    for subject in subjects() {
        let outcome = voronudge([vec!["check-gradients".to_owned()], subject.clone()].concat());
        assert_eq!(outcome.code, Some(0), "{subject:?}: {}{}", outcome.stdout, outcome.stderr);
        for term in TERMS {
            assert!(outcome.stdout.lines().any(|line| line.starts_with(term)), "{subject:?} lacks {term}");
        }
        assert!(outcome.stdout.contains("checks passed") && !outcome.stdout.contains("FAILED"));
    }
}

#[test]
fn the_errors_are_given_as_json() {
    for subject in subjects() {
        let arguments =
            ["check-gradients", "--format", "json", "--alpha", "-1.5"].map(str::to_owned).to_vec();
        let outcome = voronudge([arguments, subject.clone()].concat());
        let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
        assert_eq!(report["passed"], true);
        let checks = report["checks"].as_array().unwrap();
        let terms: BTreeSet<&str> = checks.iter().map(|check| check["term"].as_str().unwrap()).collect();
        assert!(TERMS.iter().all(|term| terms.contains(term)), "{subject:?}: {terms:?}");
        assert!(terms.contains("internal_drag") && terms.contains("nematic_stress"));
        for check in checks {
            let (worst, tolerance) = (check["worst"].as_f64().unwrap(), check["tolerance"].as_f64().unwrap());
            assert!((0.0..=tolerance).contains(&worst) && tolerance <= 1e-6, "{subject:?}: {check}");
            assert_eq!(check["passed"], true);
        }
    }
}
