//! The examples run, as `cargo test` and `cargo build --examples` build them.

use std::env::{consts::EXE_SUFFIX, current_exe};
use std::process::Command;

#[track_caller]
fn assert_runs(name: &str) {
    // This test is in `deps`.
    let built = current_exe().unwrap().ancestors().nth(2).unwrap().join("examples");
    let program = built.join(format!("{name}{EXE_SUFFIX}"));
    let output = Command::new(&program).output();
    let output =
        output.unwrap_or_else(|error| panic!("{}: {error}; cargo build --examples", program.display()));
    assert!(output.status.success(), "{output:?}");
    assert!(!output.stdout.is_empty());
}

#[test]
fn simulate_runs() {
    assert_runs("simulate");
}

#[test]
fn differentiate_runs() {
    assert_runs("differentiate");
}

#[test]
fn infer_runs() {
    assert_runs("infer");
}

#[test]
fn discover_runs() {
    assert_runs("discover");
}

#[test]
fn custom_effect_runs() {
    assert_runs("custom_effect");
}
