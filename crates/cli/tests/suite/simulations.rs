//! `simulate`: its output is a data set, and a seed is a run.

use crate::program::{assert_described, fixture, succeed};
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array1, Array2, Array3};
use std::fs;

const LINE: &str = "simulate --cells 60 --box 10 6 --dt 0.01 --P_0 4 --quiet";

/// Everything that a run leaves.
pub const FILES: [&str; 8] = [
    "dataset.toml",
    "mean_square_displacement.npy",
    "mean_square_velocity.npy",
    "positions.npy",
    "report.html",
    "report.json",
    "structure_factor.npy",
    "velocities.npy",
];

fn simulate(flags: &str) -> Folder {
    simulate_for("--time 2 --frames 4", flags)
}

fn simulate_for(time: &str, flags: &str) -> Folder {
    let out = Folder::new();
    succeed(&format!("{LINE} {time} {flags}"), &[("--out", out.path())]);
    out
}

#[test]
fn the_output_is_a_data_set_that_other_commands_read() {
    let run = simulate("--alpha 2");
    assert_eq!(run.names(), FILES);
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

#[test]
fn reports_are_as_the_schema_says() {
    for (time, flags) in [
        ("--time 2 --frames 4", "--alpha 1 --lyapunov --sensitivity alpha,x3"),
        ("--time 1 --frames 1", "--method adaptive --effect drift=0.1,0"),
        ("--time 1 --frames 3", "--self-propulsion 0.3 --rotational-diffusion 1 --diffusion 0.01"),
    ] {
        assert_described(&report(simulate_for(time, flags).path()));
    }
    let out = Folder::new();
    succeed("simulate --start honeycomb --cells 64 --time 1 --frames 2", &[("--out", out.path())]);
    assert_described(&report(out.path()));
}

#[test]
fn series_are_those_of_the_frames() {
    let run = simulate_for("--time 2 --frames 8", "--alpha 2");
    let positions: Array3<f64> = read(&run.file("positions.npy"));
    let velocities: Array3<f64> = read(&run.file("velocities.npy"));
    let course: Array2<f64> = read(&run.file("mean_square_velocity.npy"));
    assert_eq!(course.dim(), (8, 2));
    for (frame, row) in course.rows().into_iter().enumerate() {
        assert!((row[0] - 0.25 * (frame + 1) as f64).abs() < 1e-12);
        let square: f64 = velocities.index_axis(ndarray::Axis(0), frame).iter().map(|v| v * v).sum();
        assert!((row[1] * 60.0 / square - 1.0).abs() < 1e-12);
    }
    // The longest lag: from the first frame to the last.
    let moved: Array2<f64> = read(&run.file("mean_square_displacement.npy"));
    assert_eq!(moved.dim(), (7, 2));
    let [first, last] = [0, 7].map(|frame| positions.index_axis(ndarray::Axis(0), frame));
    let square: f64 = (&last - &first).iter().map(|d| d * d).sum();
    assert!((moved[(6, 0)] - 1.75).abs() < 1e-12 && (moved[(6, 1)] * 60.0 / square - 1.0).abs() < 1e-12);
    let report = report(run.path());
    let counts: f64 =
        report["area"]["histogram"]["counts"].as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).sum();
    assert_eq!(counts, 60.0);
    // Neighbours at a distance of about one: the density scatters most at q near 2π.
    assert!((5.0..8.5).contains(&number(&report, "/structure/peak/wave_number")));
}

#[test]
fn a_liquid_has_a_positive_lyapunov_exponent_and_noise_has_none() {
    let liquid = report(simulate_for("--time 6 --frames 4", "--alpha 2 --lyapunov").path());
    let error = number(&liquid, "/lyapunov/standard_error");
    assert!(number(&liquid, "/lyapunov/value") > 3.0 * error);
    crate::refusal::assert_arguments_refused(
        "simulate --cells 20 --time 1 --lyapunov --diffusion 0.1".split_whitespace(),
        &["--lyapunov", "noise"],
    );
}

/// Cells that are all alike move as the model does whose parameters they have; others do not. The values are in the report.
#[test]
fn cells_have_parameters_of_their_own() {
    let given = Folder::new();
    let write = |name: &str, values: Vec<f64>| {
        given.write_array(name, &Array1::from_vec(values));
        given.file(name).display().to_string()
    };
    let same = write("same.npy", vec![4.0; 60]);
    let uneven = write("uneven.npy", (0..60).map(|i| 4.0 + 0.2 * f64::from(i % 3 - 1)).collect());
    let plain = simulate("");
    let alike = simulate(&format!("--cell-parameter P_0={same}"));
    let differ = simulate(&format!("--cell-parameter P_0={uneven}"));
    let positions = |out: &Folder| -> Array3<f64> { read(&out.path().join("positions.npy")) };
    assert_eq!(positions(&plain), positions(&alike));
    let moved = (&positions(&plain) - &positions(&differ)).iter().fold(0.0, |most: f64, d| most.max(d.abs()));
    assert!(moved > 1e-2, "{moved}");
    let told = report(differ.path());
    assert_eq!(told["cell_parameters"]["P_0"].as_array().unwrap().len(), 60);
    assert!((told["parameters"]["P_0"].as_f64().unwrap() - 4.0).abs() < 1e-12);
}

/// Effects of the catalogue that are no terms of the model are what the options of their name say.
#[test]
fn driving_may_be_given_as_effects() {
    let options = simulate(
        "--self-propulsion 0.5 --rotational-diffusion 1 --alignment 0.4 --contact-inhibition 2 --velocity-alignment 0.2 --diffusion 0.01",
    );
    let effects = simulate(
        "--effect polarity=0.5,1 --effect polarity_alignment=0.4 --effect contact_inhibition=2 --effect velocity_alignment=0.2 \
         --effect random_motion=0.01",
    );
    let plain = simulate("");
    let bytes = |run: &Folder| std::fs::read(run.file("positions.npy")).unwrap();
    assert!(bytes(&options) == bytes(&effects) && bytes(&options) != bytes(&plain));
    assert_eq!(report(options.path())["driving"], report(effects.path())["driving"]);
    assert!(report(effects.path())["effects"].is_null());
}
