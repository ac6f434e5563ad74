//! `equation-of-state`, and what `channel` predicts from it.

use crate::program::{assert_described, succeed};
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array1, Array2};
use std::fs;

const SHORT: &str = "equation-of-state --density 0.6 2.2 5 --cells 36 --replicas 2 --relaxation 3 --time 3 --P_0 4 --alpha 2.9 --K_A 0 --dt 0.02 \
                     --quiet";
const CHANNEL: &str = "channel --preset ht1080 --width 200 --length 150 --relaxation 2 --time 20 --dt 0.02 --samples 16 --quiet";

#[test]
fn it_is_written_as_arrays_and_as_a_report() {
    let out = Folder::new();
    succeed(SHORT, &[("--out", out.path())]);
    let names = [
        "bulk_modulus.npy",
        "density.npy",
        "mean_square_velocity.npy",
        "odd_bulk_modulus.npy",
        "pressure.npy",
        "report.html",
        "report.json",
        "shape_index.npy",
        "torque.npy",
    ];
    assert_eq!(out.names(), names);
    let report = report(out.path());
    assert_described(&report);
    let density: Array1<f64> = read(&out.file("density.npy"));
    assert_eq!(density.to_vec(), [0.6, 1.0, 1.4, 1.8, 2.2]);
    let [pressure, bulk, torque]: [Array2<f64>; 3] =
        ["pressure", "bulk_modulus", "torque"].map(|name| read(&out.file(&format!("{name}.npy"))));
    // The slope of a parabola in the middle of equal steps, and its error.
    let slope = (pressure[(3, 0)] - pressure[(1, 0)]) / 0.8;
    assert!((bulk[(2, 0)] - 1.4 * slope).abs() < 1e-9);
    let error = 1.4 * pressure[(3, 1)].hypot(pressure[(1, 1)]) / 0.8;
    assert!((bulk[(2, 1)] - error).abs() < 1e-12);
    assert_eq!(number(&report, "/points/2/torque/value"), torque[(2, 0)]);
    // Cells turn their surroundings to the left, by at least the torque of regular hexagons.
    assert!(torque.column(0).iter().all(|own| *own > 2.9 * 8.0 * 3f64.sqrt()));
}

#[test]
fn results_do_not_depend_on_threads() {
    let of = |threads: &str| {
        let out = Folder::new();
        succeed(&format!("{SHORT} --threads {threads}"), &[("--out", out.path())]);
        ["pressure.npy", "torque.npy"].map(|name| fs::read(out.file(name)).unwrap())
    };
    assert_eq!(of("1"), of("3"));
}

/// The unit of length is that of the channel; only ratios have to agree.
#[test]
fn a_channel_is_predicted_from_it() {
    let (equation, out) = (Folder::new(), Folder::new());
    succeed(SHORT, &[("--out", equation.path())]);
    succeed(CHANNEL, &[("--equation-of-state", equation.path()), ("--out", out.path())]);
    let report = report(out.path());
    assert_described(&report);
    assert!((number(&report, "/liquid/density_range/0") - 0.6 / 625.0).abs() < 1e-12);
    // Conservation alone fixes v_x, so that both theories agree with it alike.
    let [liquid, honeycomb] =
        ["liquid", "continuum"].map(|of| number(&report, &format!("/{of}/velocity_x_difference")));
    assert!(liquid < 2.0 * honeycomb + 0.1, "{liquid} {honeycomb}");
    assert!(number(&report, "/liquid/transport") > 0.0);
    assert!(fs::read_to_string(out.file("report.html")).unwrap().contains("With the equation of state"));
    let hash = report["inputs"][0]["sha256"].as_str().unwrap();
    assert_eq!(hash.len(), 64);
}

#[test]
fn an_equation_of_another_tissue_is_refused() {
    let equation = Folder::new();
    succeed(SHORT, &[("--out", equation.path())]);
    let path = equation.path().to_str().unwrap();
    let refused = |flags: &[&str], facts: &[&str]| {
        let words: Vec<&str> = CHANNEL.split(' ').chain(["--equation-of-state", path]).collect();
        assert_arguments_refused([words.as_slice(), flags].concat(), facts)
    };
    let hint = refused(&["--alpha", "1"], &["whose α is 2.9, but here it is 1"]);
    assert!(hint.contains("--P_0 4 --alpha 1 --K_A 0"), "{hint}");
    refused(&["--P_0", "90"], &["P_0/ℓ₀ is 4, but here it is 3.6"]);
    refused(&["--proliferation-rate", "1"], &["no steady state"]);
    let other = Folder::new();
    other.write("report.json", "{}");
    let words: Vec<&str> =
        CHANNEL.split(' ').chain(["--equation-of-state", other.path().to_str().unwrap()]).collect();
    assert_arguments_refused(&words, &["not a report of equation-of-state"]);
}

#[test]
fn what_cannot_be_meant_is_refused() {
    for (line, fact) in [
        ("--density 1 1.2 2", "three or more"),
        ("--density 0 1 5", "above zero"),
        ("--density 1 1.2 2.5", "has a count of 2.5"),
        ("--replicas 1", "2 is the least"),
        ("--relaxation -1", "must be a time"),
        ("--time 0", "--time is 0"),
        ("--K_P 0", "K_P is 0"),
        ("--cell-size -3", "--cell-size is -3"),
        ("--dt 1e-15", "time steps"),
    ] {
        let words: Vec<&str> = "equation-of-state".split(' ').chain(line.split(' ')).collect();
        assert_arguments_refused(&words, &[fact]);
    }
}
