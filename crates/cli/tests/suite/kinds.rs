//! Cells that differ: parameters by cell, by label and from distributions, in what is simulated, strained, and fitted.

use crate::program::succeed;
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array1, Array2, Array3};
use std::path::Path;

/// A relaxing tissue of two types in equal shares.
fn two_types(rest: &str) -> Folder {
    let out = Folder::new();
    let line = format!(
        "simulate --cells 64 --P_0 3.9 --alpha 1 --cell-spread P_0=0.02 --cell-spread alpha=0.4 --cell-distribution two-types \
         --seed 4 --dt 0.005 {rest}"
    );
    succeed(&line, &[("--out", out.path())]);
    out
}

fn fit(data: &Folder, rest: &str) -> serde_json::Value {
    let out = Folder::new();
    let line = format!("infer {} --fix K_A=0.1 --complete false --seed 1 {rest}", data.path().display());
    succeed(&line, &[("--out", out.path())]);
    report(out.path())
}

/// Without errors of measurement the parameters of both types come out as they went in, from velocities and from tracks.
#[test]
fn types_are_told_by_their_labels() {
    let data = two_types("--time 2 --frames 40");
    let labels: Array1<i64> = read(&data.path().join("labels.npy"));
    assert_eq!(labels.sum(), 32);
    let alpha: Array1<f64> = read(&data.path().join("cell_alpha.npy"));
    for (label, own) in labels.iter().zip(&alpha) {
        assert!((own - if *label == 1 { 1.4 } else { 0.6 }).abs() < 1e-12);
    }
    let velocities = "--frames 39 --position-noise 0.001 --velocity-noise 0.1%";
    for (rest, tolerance) in
        [(velocities, 0.002), ("--frames 38..40 --position-noise 0.002 --velocities TRACKS", 0.05)]
    {
        // Without velocities the tracks themselves are fitted.
        let rest = match rest.strip_suffix(" --velocities TRACKS") {
            Some(rest) => {
                std::fs::remove_file(data.file("velocities.npy")).unwrap();
                rest
            }
            None => rest,
        };
        let found = fit(&data, &format!("{rest} --by-label P_0,alpha"));
        for k in 0..2 {
            let at = |name: &str| number(&found, &format!("/by_label/{k}/{name}"));
            let high = at("label") > 0.5;
            let truth = if high { [3.978, 1.4] } else { [3.822, 0.6] };
            for (name, truth) in ["P_0", "alpha"].into_iter().zip(truth) {
                let error = at(&format!("parameters/{name}/value")) / truth - 1.0;
                assert!(error.abs() < tolerance, "{rest} {high} {name} {error}");
            }
        }
        assert_eq!(found["by_label"][1]["differs"], true);
        let difference = number(&found, "/by_label/1/differences/alpha/value").abs();
        assert!((difference / 0.8 - 1.0).abs() < 2.0 * tolerance, "{rest} {difference}");
        let same = &found["by_label"][0]["parameters"]["K_P"]["value"];
        assert_eq!(same, &found["by_label"][1]["parameters"]["K_P"]["value"]);
    }
}

/// Of labelled tracks it is found that the kinds differ, and by how much.
#[test]
#[ignore = "slow"]
fn a_search_in_tracks_knows_their_labels() {
    let (data, out) = (two_types("--time 2 --frames 40"), Folder::new());
    std::fs::remove_file(data.file("velocities.npy")).unwrap();
    let line = "discover --frames 36..40 --fix K_A=0.1 --complete false --effects label_parameter,alpha_area --seed 1";
    succeed(line, &[("", data.path()), ("--out", out.path())]);
    let found = report(out.path());
    assert_eq!(found["verdict"], "attributed");
    assert_eq!(found["selected"][0]["effect"], "label_parameter");
    let name = found["selected"][0]["coefficients"][2]["name"].as_str().unwrap();
    assert!(["chirality of label 0", "chirality of label 1"].contains(&name), "{name}");
    // α is 0.6 and 1.4.
    assert!((number(&found, "/selected/0/coefficients/2/value").abs() / 0.8 - 1.0).abs() < 0.02);
}

/// Values by label are those by cell.
#[test]
fn labels_and_arrays_say_the_same() {
    let data = two_types("--time 1 --frames 2");
    let evaluate = |rest: &str| -> Array3<f64> {
        let out = Folder::new();
        succeed(&format!("evaluate {} {rest}", data.path().display()), &[("--out", out.path())]);
        read(&out.path().join("velocities.npy"))
    };
    let by_cell =
        evaluate(&format!("--P_0 3.9 --cell-parameter alpha={}", data.file("cell_alpha.npy").display()));
    let by_label = evaluate("--P_0 3.9 --label-parameter alpha=0:0.6,1:1.4");
    let apart = |a: &Array3<f64>, b: &Array3<f64>| (a - b).iter().fold(0.0, |most: f64, d| most.max(d.abs()));
    assert!(apart(&by_cell, &by_label) < 1e-12);
    assert!(apart(&by_cell, &evaluate("--P_0 3.9 --alpha 1")) > 0.01);
    let of_all = format!("--cell-parameter P_0={}", data.file("cell_P_0.npy").display());
    let simulated: Array3<f64> = read(&data.path().join("velocities.npy"));
    assert!(apart(&evaluate(&format!("{of_all} --label-parameter alpha=0:0.6,1:1.4")), &simulated) < 1e-10);
}

/// A run that goes on from labelled cells keeps the labels, and effects may refer to them.
#[test]
fn labels_go_on_with_the_cells() {
    let data = two_types("--time 0.5 --frames 1");
    let on = |rest: &str| {
        let out = Folder::new();
        let start = data.path().display();
        succeed(&format!("simulate --start {start} --time 0.5 --frames 1 {rest}"), &[("--out", out.path())]);
        out
    };
    let positions = |own: &Folder| -> Array3<f64> { read(&own.path().join("positions.npy")) };
    let (by_label, by_effect) = (
        on("--P_0 3.9 --label-parameter alpha=0:0.6,1:1.4"),
        on("--P_0 3.9 --alpha 1.4 --effect label_parameter=0,0,-0.8"),
    );
    let labels = |own: &Folder| -> Array1<i64> { read(&own.path().join("labels.npy")) };
    assert_eq!(labels(&by_label), labels(&data));
    // Of equally frequent labels the lower one is the reference of the effect, so that it acts on the other.
    let lower = on("--P_0 3.9 --alpha 0.6 --effect label_parameter=0,0,0.8");
    let apart = |a: &Folder, b: &Folder| {
        (&positions(a) - &positions(b)).iter().fold(0.0, |most: f64, d| most.max(d.abs()))
    };
    assert!(apart(&by_label, &lower) < 1e-9 && apart(&by_label, &by_effect) > 1e-3);
}

/// The trace of the Jacobian of a honeycomb is linear in the parameter of each cell, so that it knows their mean alone; its eigenvalues know more.
#[test]
fn eigenvalues_of_a_honeycomb_of_unlike_cells_have_the_sum_of_like_ones() {
    let given = Folder::new();
    let own: Vec<f64> = (0..36).map(|i| 0.7 + 0.5 * f64::from(i * i % 7 - 3)).collect();
    let mean = own.iter().sum::<f64>() / 36.0;
    given.write_array("alpha.npy", &Array1::from_vec(own));
    let values = |rest: &str| -> Array2<f64> {
        let out = Folder::new();
        succeed(&format!("spectrum --lattice 6 6 --P_0 3.4 {rest}"), &[("--out", out.path())]);
        read(&out.path().join("eigenvalues.npy"))
    };
    let (unlike, like) = (
        values(&format!("--cell-parameter alpha={}", given.file("alpha.npy").display())),
        values(&format!("--alpha {mean}")),
    );
    let sum = |all: &Array2<f64>| all.column(0).sum();
    assert!((sum(&unlike) - sum(&like)).abs() < 1e-9 * sum(&like).abs(), "{} {}", sum(&unlike), sum(&like));
    assert!((&unlike - &like).iter().any(|d| d.abs() > 1e-3));
}

/// Cells that differ come to rest between walls where they are stable with their own parameters.
#[test]
fn unlike_cells_at_rest_between_walls_are_stable() {
    let (run, out) = (Folder::new(), Folder::new());
    let line = "simulate --cells 48 --box 8 6 --P_0 3.2 --alpha 0 --cell-spread P_0=0.05 --walls x --time 60 --frames 1 --seed 4";
    succeed(line, &[("--out", run.path())]);
    let own = format!("P_0={}", run.file("cell_P_0.npy").display());
    let line = format!("spectrum --P_0 3.2 --alpha 0 --cell-parameter {own}");
    succeed(&line, &[("", run.path()), ("--out", out.path())]);
    let frame = &report(out.path())["frames"][0];
    // Free to slide along the walls.
    let counts = ["zero", "growing", "oscillating"].map(|name| frame[name].as_u64().unwrap());
    assert_eq!(counts, [1, 0, 0]);
}

/// What unlike cells do to the moduli of a honeycomb is of second order in their spread: of first order the mean alone counts.
#[test]
fn moduli_of_a_honeycomb_know_of_a_small_spread_to_second_order() {
    let moduli = |rest: &str| {
        let out = Folder::new();
        let line = "moduli --start honeycomb --cells 16 --P_0 3 --alpha 0.3 --strain 1e-6";
        succeed(&format!("{line} {rest}"), &[("--out", out.path())]);
        let found = report(out.path());
        (0..4).map(|k| number(&found, &format!("/moduli/{k}/value"))).collect::<Vec<_>>()
    };
    let like = moduli("");
    let off = |share: f64| -> Vec<f64> {
        let unlike = moduli(&format!("--cell-spread alpha={share}"));
        like.iter().zip(unlike).map(|(a, b)| b - a).collect()
    };
    let (small, large) = (off(0.05), off(0.1));
    for (k, (a, b)) in small.iter().zip(&large).enumerate() {
        assert!(a.abs() < 0.02 && (b - 4.0 * a).abs() < 0.4 * b.abs() + 1e-4, "{k} {a} {b}");
    }
    assert!(large.iter().any(|d| d.abs() > 1e-3), "{large:?}");
}

/// Where α is nought a share of it is, too; elsewhere it matters. What was cut off goes on to the same bytes with the spread alone.
#[test]
fn diagrams_have_cells_that_differ() {
    let diagram = |rest: &str| {
        let out = Folder::new();
        let line = "phase-diagram --P_0 3.9 3.9 1 --alpha 0 1 2 --cells 36 --time 2 --quantities mean_square_velocity";
        succeed(&format!("{line} {rest}"), &[("--out", out.path())]);
        out
    };
    let of = |own: &Folder| -> Array2<f64> { read(&own.path().join("mean_square_velocity.npy")) };
    let (like, unlike) = (diagram(""), diagram("--cell-spread alpha=0.5"));
    let (a, b) = (of(&like), of(&unlike));
    assert_eq!(a[(0, 0)], b[(0, 0)]);
    assert!((a[(1, 0)] - b[(1, 0)]).abs() > 1e-3 * a[(1, 0)]);
    assert_eq!(number(&report(unlike.path()), "/cell_spread/shares/alpha"), 0.5);
    assert!(report(like.path())["cell_spread"].is_null());
}

#[test]
fn what_cells_cannot_have_of_their_own_is_refused() {
    let data = two_types("--time 0.5 --frames 1");
    let plain = Folder::new();
    succeed("simulate --cells 60 --time 1 --frames 2 --alpha 1", &[("--out", plain.path())]);
    let refused = |line: String, parts: &[&str]| assert_arguments_refused(line.split_whitespace(), parts);
    let at = |folder: &Folder| -> String { Path::display(folder.path()).to_string() };
    refused("simulate --cells 60 --cell-spread P_0=0.9".into(), &["--cell-spread P_0=0.9", "none of it"]);
    refused("simulate --cells 60 --cell-spread beta=0.9".into(), &["beta", "no such parameter"]);
    refused("simulate --cells 60 --label-parameter alpha=0:1".into(), &["--label-parameter", "no labels"]);
    let start = format!("simulate --start {}", at(&data));
    refused(format!("{start} --label-parameter alpha=7:1"), &["label 7"]);
    refused(format!("{start} --label-parameter alpha=1"), &["no label with a finite value"]);
    refused(
        format!("{start} --alpha 1 --label-parameter alpha=0:1 --cell-spread alpha=0.1"),
        &["alpha", "twice"],
    );
    refused(format!("infer {} --by-label alpha", at(&plain)), &["--by-label", "labels"]);
    refused(format!("infer {} --by-label K_P", at(&data)), &["another K_P"]);
    refused(format!("infer {} --by-label alpha --vary alpha", at(&data)), &["--by-label", "--vary"]);
    refused(format!("infer {} --by-label A_0", at(&data)), &["--by-label", "alpha"]);
}
