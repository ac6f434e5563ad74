//! The examples run, as `cargo test` and `cargo build --examples` build them.

use std::env::{consts::EXE_SUFFIX, current_exe};
use std::error::Error;
use std::process::Command;

/// How a test ends.
type Outcome = Result<(), Box<dyn Error>>;

fn run(name: &str) -> Outcome {
    // This test is in `deps`, beside `examples`.
    let test = current_exe()?;
    let folder = test.ancestors().nth(2).ok_or("a program in no folder")?.join("examples");
    let program = folder.join(format!("{name}{EXE_SUFFIX}"));
    let output = Command::new(&program).output();
    let output = output.map_err(|error| format!("{}: {error}; cargo build --examples", program.display()))?;
    assert!(output.status.success(), "{output:?}");
    assert!(!output.stdout.is_empty());
    Ok(())
}

#[test]
fn simulate_runs() -> Outcome {
    run("simulate")
}

#[test]
fn differentiate_runs() -> Outcome {
    run("differentiate")
}

#[test]
fn infer_runs() -> Outcome {
    run("infer")
}

#[test]
fn discover_runs() -> Outcome {
    run("discover")
}

#[test]
fn custom_effect_runs() -> Outcome {
    run("custom_effect")
}
