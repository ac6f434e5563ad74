//! What is printed, and what is not.

use crate::program::{fixture, succeed, voronudge};
use crate::scratch::Folder;
use std::fs;
use std::path::PathBuf;

/// A command line for each command that writes results.
fn lines() -> Vec<(&'static str, Vec<(&'static str, PathBuf)>)> {
    vec![
        ("infer --fix K_A=0.1", vec![("", fixture("chiral-liquid"))]),
        ("evaluate", vec![("", fixture("reference-small"))]),
        ("simulate --cells 20 --time 0.1 --frames 2", vec![]),
        ("check-gradients", vec![("", fixture("reference-small"))]),
    ]
}

#[test]
fn json_on_stdout_is_the_report() {
    for (line, mut paths) in lines() {
        let out = Folder::new();
        paths.push(("--out", out.path().to_owned()));
        let paths: Vec<_> = paths.iter().map(|(name, path)| (*name, path.as_path())).collect();
        for verbosity in ["", "--quiet"] {
            let outcome = succeed(&format!("{line} --format json {verbosity}"), &paths);
            let report = fs::read_to_string(out.file("report.json")).unwrap();
            assert_eq!(outcome.stdout.trim_end(), report.trim_end(), "{line}");
            // A busy machine takes so long that progress is told.
            let tells = |own: &str| verbosity.is_empty() && own.contains(" elapsed");
            assert!(outcome.stderr.lines().all(tells), "{line}: {}", outcome.stderr);
            serde_json::from_str::<serde_json::Value>(&outcome.stdout).unwrap();
        }
    }
}

#[test]
fn text_on_stdout_says_where_the_results_are() {
    for (line, mut paths) in lines() {
        let out = Folder::new();
        paths.push(("--out", out.path().to_owned()));
        let paths: Vec<_> = paths.iter().map(|(name, path)| (*name, path.as_path())).collect();
        let outcome = succeed(line, &paths);
        let told = outcome.stdout.contains(out.path().to_str().unwrap());
        assert!(told || line.starts_with("check-gradients"), "{line}: {}", outcome.stdout);
    }
}

#[test]
fn a_quiet_command_says_nothing() {
    for (line, mut paths) in lines() {
        let out = Folder::new();
        paths.push(("--out", out.path().to_owned()));
        let paths: Vec<_> = paths.iter().map(|(name, path)| (*name, path.as_path())).collect();
        let outcome = succeed(&format!("{line} --quiet"), &paths);
        assert_eq!((outcome.stdout.as_str(), outcome.stderr.as_str()), ("", ""), "{line}");
    }
}

#[test]
fn a_quiet_command_that_warns_does_so_in_its_report_only() {
    let out = Folder::new();
    let data = fixture("open-field");
    let (data, out_path) = (data.to_str().unwrap(), out.path().to_str().unwrap());
    let line = ["evaluate", data, "--jacobian", "--frames", "0,1", "--quiet", "--out", out_path];
    let outcome = voronudge(line);
    assert_eq!((outcome.code, outcome.stdout.as_str(), outcome.stderr.as_str()), (Some(0), "", ""));
    let report = crate::scratch::report(out.path());
    assert!(report["warnings"][0].as_str().unwrap().contains("frame 0 only"));
}
