//! `phase-diagram` and `merge`: physics over the grid, parts put together, and what is refused.

use crate::program::{assert_described, succeed, voronudge};
use crate::refusal::{assert_arguments_refused, assert_told};
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array1, Array2};
use serde_json::Value;
use std::ffi::OsString;
use std::fs;

const SMALL: &str =
    "phase-diagram --P_0 3.5 4 3 --alpha 0.1 0.3 2 --replicas 2 --cells 36 --time 2 --seed 5 --quiet";

fn diagram(line: &str) -> Folder {
    let out = Folder::new();
    succeed(line, &[("--out", out.path())]);
    out
}

/// Asserts that two diagrams have the same files with the same bytes, but for the reports, whose record of the run differs.
#[track_caller]
fn assert_same(found: &Folder, expected: &Folder) {
    assert_eq!(found.names(), expected.names());
    for name in expected.names().into_iter().filter(|name| !name.starts_with("report")) {
        let bytes = |folder: &Folder| fs::read(folder.file(&name)).unwrap();
        assert!(bytes(found) == bytes(expected), "{name}");
    }
    let measured = |folder: &Folder| report(folder.path())["quantities"].clone();
    assert_eq!(measured(found), measured(expected));
}

/// A diagram that ended is taken as it is by `--resume`, unless another is asked for.
#[test]
fn a_complete_diagram_is_not_made_again() {
    let line = format!("{SMALL} --shard 1/2");
    let out = diagram(&line);
    let made = fs::read_to_string(out.file("points.jsonl")).unwrap();
    // A number that nothing computes shows where it comes from.
    let (head, rest) = made.split_once("\"mean_square_velocity\":[").unwrap();
    let (_, tail) = rest.split_once(',').unwrap();
    let marked = format!("{head}\"mean_square_velocity\":[0.125,{tail}");
    assert_ne!(marked, made);
    out.write("points.jsonl", &marked);
    succeed(&format!("{line} --resume"), &[("--out", out.path())]);
    assert_eq!(fs::read_to_string(out.file("points.jsonl")).unwrap(), marked);
    succeed(&line, &[("--out", out.path())]);
    assert_eq!(fs::read_to_string(out.file("points.jsonl")).unwrap(), made);
    out.write("points.jsonl", &marked);
    succeed(&format!("{line} --resume --seed 6").replacen("--seed 5 ", "", 1), &[("--out", out.path())]);
    assert!(!fs::read_to_string(out.file("points.jsonl")).unwrap().contains("[0.125,"));
}

#[test]
fn solids_rest_and_liquids_flow() {
    let out = diagram(
        "phase-diagram --P_0 3 4.2 2 --alpha 0 1 2 --cells 64 --time 20 --quiet \
         --quantities mean_square_velocity,hexatic_order,hexatic_modulus,t1_rate,shape_index,lyapunov,mean_square_frequency",
    );
    let field = |name: &str| -> Array2<f64> { read(&out.file(&format!("{name}.npy"))) };
    assert_eq!(read::<f64, _>(&out.file("P_0.npy")), Array1::from(vec![3.0, 4.2]));
    assert_eq!(read::<f64, _>(&out.file("alpha.npy")), Array1::from(vec![0.0, 1.0]));
    // Rows are chiralities, columns preferred perimeters: only (α, P_0) = (1, 4.2) goes on moving.
    let velocities = field("mean_square_velocity");
    assert!(
        velocities[(1, 1)] > 5.0 && velocities[(1, 0)] < 1e-2 && velocities[(0, 0)] < 1e-2,
        "{velocities}"
    );
    assert!(field("t1_rate")[(1, 1)] > 1.0 && field("lyapunov")[(1, 1)] > 1.0);
    assert!(field("lyapunov")[(0, 0)] < 0.0);
    // Without chirality forces have a potential, and nothing oscillates.
    let frequencies = field("mean_square_frequency");
    assert!(frequencies[(0, 0)] < 1e-12 && frequencies[(1, 0)] > 1.0, "{frequencies}");
    let shapes = field("shape_index");
    assert!(
        shapes.iter().all(|shape| (3.72..4.5).contains(shape)) && shapes[(0, 1)] > shapes[(0, 0)],
        "{shapes}"
    );
    assert!(field("mean_square_velocity_error")[(1, 1)] > 0.0);
    let report = report(out.path());
    assert_described(&report);
    assert_eq!(number(&report, "/quantities/mean_square_velocity/largest/P_0"), 4.2);
    assert!(report["collapse"].is_null() && report["no_collapse"].is_string());
}

/// A disordered solid deep below the transition has nearly the honeycomb's μ = 1.008 and B = 2.792. Four runs of 100 cells give
/// Kᵒ = −0.35 ± 0.02, two thirds of the honeycomb's −√3 α, and an odd bulk modulus, which the honeycomb lacks.
#[test]
fn moduli_of_a_solid_are_near_those_of_the_honeycomb() {
    let out = diagram(
        "phase-diagram --P_0 3 3 1 --alpha 0.3 0.3 1 --cells 64 --time 40 --quiet \
         --quantities shear_modulus,odd_shear_modulus,bulk_modulus,odd_bulk_modulus",
    );
    let modulus = |name: &str| read::<f64, ndarray::Ix2>(&out.file(&format!("{name}.npy")))[(0, 0)];
    assert!((modulus("shear_modulus") / 1.008 - 1.0).abs() < 0.15, "{}", modulus("shear_modulus"));
    assert!((modulus("bulk_modulus") / 2.792 - 1.0).abs() < 0.15, "{}", modulus("bulk_modulus"));
    assert!((-0.55..-0.2).contains(&modulus("odd_shear_modulus")), "{}", modulus("odd_shear_modulus"));
    assert!((0.02..0.3).contains(&modulus("odd_bulk_modulus")), "{}", modulus("odd_bulk_modulus"));
}

#[test]
fn a_point_is_that_of_simulate_and_chirality_can_be_negative() {
    let out = diagram("phase-diagram --P_0 4 4 1 --alpha -1 -1 1 --cells 36 --time 4 --dt 0.01 --quiet");
    let line = fs::read_to_string(out.file("points.jsonl")).unwrap().lines().nth(1).unwrap().to_owned();
    let seed = serde_json::from_str::<Value>(&line).unwrap()["seed"].as_u64().unwrap();
    let run = diagram(&format!(
        "simulate --P_0 4 --alpha -1 --cells 36 --time 4 --dt 0.01 --frames 100 --seed {seed} --quiet"
    ));
    let found: Array2<f64> = read(&out.file("mean_square_velocity.npy"));
    assert_eq!(found[(0, 0)], number(&report(run.path()), "/mean_square_velocity"));
}

#[test]
fn threads_do_not_matter() {
    assert_same(&diagram(&format!("{SMALL} --threads 1")), &diagram(&format!("{SMALL} --threads 2")));
}

#[test]
fn parts_make_the_whole() {
    let whole = diagram(SMALL);
    let parts = [1, 2, 3].map(|part| diagram(&format!("{SMALL} --shard {part}/3")));
    let merged = Folder::new();
    let paths =
        [("", parts[2].path()), ("", parts[0].path()), ("", parts[1].path()), ("--out", merged.path())];
    succeed("merge --quiet", &paths);
    assert_same(&merged, &whole);
    assert_described(&report(merged.path()));
    assert_described(&report(parts[0].path()));
    assert_eq!(number(&report(merged.path()), "/seed"), 5.0);

    let other = diagram(&format!("{} --shard 3/3", SMALL.replace("--time 2", "--time 3")));
    let refused = |parts: &[&Folder], facts: &[&str]| {
        let parts = parts.iter().map(|part| part.path().into());
        let arguments: Vec<OsString> = ["merge".into()]
            .into_iter()
            .chain(parts)
            .chain(["--out".into(), Folder::new().path().into()])
            .collect();
        assert_told(&arguments, facts);
    };
    refused(&[&parts[0], &parts[2]], &["part 2 of 3 is missing"]);
    refused(&[&parts[0], &parts[1], &parts[1]], &["both part 2"]);
    refused(&[&parts[0], &parts[1], &other], &["\"time\""]);
    refused(&[&whole, &parts[1]], &["part 2 of 3"]);
    refused(&[&Folder::new()], &["points.jsonl"]);
}

#[test]
fn velocities_are_collapsed_where_there_are_points_for_it() {
    let out = diagram(
        "phase-diagram --P_0 3.9 4.2 4 --alpha 0.1 0.2 3 --cells 36 --time 10 --quiet --exponents 3 4",
    );
    let report = report(out.path());
    assert_described(&report);
    assert_eq!(number(&report, "/collapse/points"), 12.0);
    assert!(number(&report, "/collapse/fitted/scatter") <= number(&report, "/collapse/given/scatter") + 1e-9);
    assert!(fs::read_to_string(out.file("report.html")).unwrap().contains("collapse with given exponents"));
}

#[test]
fn a_run_that_fails_is_told_and_leaves_the_others() {
    let out = Folder::new();
    let line = "phase-diagram --P_0 4 4 1 --alpha 0 40 2 --cells 25 --time 1 --dt 0.04 --out";
    let outcome = voronudge(line.split_whitespace().map(OsString::from).chain([out.path().into()]));
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("1 of 2 runs failed") && outcome.stderr.contains("above the one advised")
    );
    let velocities: Array2<f64> = read(&out.file("mean_square_velocity.npy"));
    assert!(velocities[(0, 0)].is_finite() && velocities[(1, 0)].is_nan());
    let report = report(out.path());
    assert_described(&report);
    assert!(report["failed"][0]["error"].as_str().unwrap().contains("time step"));
}

#[test]
fn impossible_diagrams_are_refused() {
    for (flags, fact) in [
        ("--P_0 4 3 5", "must rise"),
        ("--P_0 3 4 1", "must rise"),
        ("--alpha 0 1 2.5", "count of 2.5"),
        ("--alpha 0 1 0", "count of 0"),
        ("--time -1", "--time is -1"),
        ("--dt 0", "--dt is 0"),
        ("--cells 0", "--cells is 0"),
        ("--replicas 0", "--replicas is 0"),
        ("--shard 3/2", "1/4"),
        ("--cells 5000 --quantities mean_square_frequency", "5000 cells"),
        ("--collapse-alpha 0.2 0.1", "no range"),
        ("--exponents 3 0", "φ positive"),
    ] {
        assert_arguments_refused(format!("phase-diagram {flags}").split_whitespace(), &[fact]);
    }
}
