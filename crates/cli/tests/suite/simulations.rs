//! `simulate`: its output is a data set, and a seed is a run.

use crate::program::{fixture, succeed};
use crate::scratch::{Folder, number, read, report};
use ndarray::Array3;
use std::fs;

const LINE: &str = "simulate --cells 60 --box 10 6 --time 2 --dt 0.01 --frames 4 --P_0 4 --quiet";

fn simulate(flags: &str) -> Folder {
    let out = Folder::new();
    succeed(&format!("{LINE} {flags}"), &[("--out", out.path())]);
    out
}

#[test]
fn the_output_is_a_data_set_that_other_commands_read() {
    let run = simulate("--alpha 2");
    assert_eq!(run.names(), ["dataset.toml", "positions.npy", "report.json", "velocities.npy"]);
    let positions: Array3<f64> = read(&run.file("positions.npy"));
    assert_eq!(positions.dim(), (4, 60, 2));
    let report_of_run = report(run.path());
    assert!(number(&report_of_run, "/mean_square_velocity") > 0.0);
    assert!(number(&report_of_run, "/steps_per_second") > 0.0);
    assert_eq!(number(&report_of_run, "/steps"), 200.0);

    let (fit, model) = (Folder::new(), Folder::new());
    let noise = "--position-noise 0.1% --velocity-noise 0.1%";
    succeed(&format!("infer --frames 3 {noise}"), &[("", run.path()), ("--out", fit.path())]);
    let found = number(&report(fit.path()), "/parameters/K_P_alpha/value");
    assert!((found - 2.0).abs() < 0.04, "{found}");

    let parameters = run.file("report.json");
    let paths = [("", run.path()), ("--parameters", &parameters), ("--out", model.path())];
    succeed("evaluate", &paths);
    let (simulated, evaluated) = (run.file("velocities.npy"), model.file("velocities.npy"));
    crate::scratch::assert_close(&read(&evaluated), &read(&simulated), 1e-9);
}

#[test]
fn a_seed_gives_the_same_bytes_and_another_seed_others() {
    let bytes = |flags: &str| {
        let out = simulate(flags);
        ["positions.npy", "velocities.npy", "dataset.toml"].map(|name| fs::read(out.file(name)).unwrap())
    };
    let first = bytes("--alpha 1 --seed 3 --threads 1");
    assert!(first == bytes("--alpha 1 --seed 3 --threads 2"));
    assert!(first[0] != bytes("--alpha 1 --seed 4")[0]);
}

#[test]
fn chirality_can_be_negative() {
    let alpha = |flags: &str| number(&report(simulate(flags).path()), "/parameters/alpha");
    assert_eq!(alpha("--alpha -1"), -1.0);
    assert_eq!(alpha("--alpha=-0.5"), -0.5);
}

#[test]
fn parameters_can_come_from_a_file() {
    let out = Folder::new();
    let parameters = fixture("reference-small/parameters.json");
    succeed(
        "simulate --cells 20 --time 0.1 --frames 1",
        &[("--parameters", &parameters), ("--out", out.path())],
    );
    assert_eq!(number(&report(out.path()), "/parameters/P_0"), 3.9);
}

#[test]
fn a_time_step_too_large_is_told() {
    crate::refusal::assert_arguments_refused(
        "simulate --cells 20 --time 100 --dt 10 --K_P 50 --quiet".split_whitespace(),
        &["at time", "time step"],
    );
}
