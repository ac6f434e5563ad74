//! `infer`: what it finds in tissues with a known truth, and the files it leaves.

use crate::program::{assert_described, fixture, succeed, voronudge};
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array2, Array3};
use std::ffi::OsStr;
use std::fs;
use std::path::Path;

const FILES: [&str; 6] = [
    "latent_cells.npy",
    "nudged_positions.npy",
    "predicted_velocities.npy",
    "report.html",
    "report.json",
    "residual_velocities.npy",
];

/// The chirality coefficient `K_P α` of the chiral liquid.
const TRUTH: f64 = 3.4;

/// The results of a fit.
pub fn infer(data: &Path, flags: &str) -> Folder {
    let out = Folder::new();
    succeed(&format!("infer {flags}"), &[("", data), ("--out", out.path())]);
    out
}

#[test]
fn the_chirality_of_a_noisy_liquid_is_found() {
    let out = infer(&fixture("chiral-liquid"), "--fix K_A=0.1");
    assert_eq!(out.names(), FILES);
    let report = report(out.path());
    assert_described(&report);
    let nudged = number(&report, "/parameters/K_P_alpha/value");
    let naive = number(&report, "/naive/K_P_alpha");
    assert!((nudged - TRUTH).abs() < 0.05 * TRUTH, "{nudged}");
    assert!((nudged - TRUTH).abs() < (naive - TRUTH).abs(), "nudged {nudged}, naive {naive}");
    let interval = |end: usize| number(&report, &format!("/parameters/K_P_alpha/ci95/{end}"));
    assert!(interval(0) < TRUTH && TRUTH < interval(1), "{} to {}", interval(0), interval(1));
    assert_eq!(number(&report, "/parameters/K_A/value"), 0.1);
    assert_eq!(report["parameters"]["K_A"]["fixed"], true);
}

#[test]
fn a_liquid_without_noise_is_found_exactly() {
    let flags = "--position-noise 0.1% --velocity-noise 0.1%";
    let report = report(infer(&fixture("chiral-liquid-clean"), flags).path());
    assert_described(&report);
    for (name, truth) in [("K_A", 0.1), ("K_P", 1.0), ("P_0", 4.0), ("alpha", 3.4), ("K_P_alpha", 3.4)] {
        let found = number(&report, &format!("/parameters/{name}/value"));
        assert!((found - truth).abs() < 0.02 * truth, "{name} is {found}");
    }
    assert!(number(&report, "/nmse/un_nudged") < 1e-4);
}

#[test]
fn arrays_belong_to_the_cells_of_the_data_set() {
    let data = Folder::copy_of("chiral-liquid");
    data.change("velocities.npy", |v| (v[[5, 0]], v[[5, 1]]) = (f64::NAN, f64::NAN));
    let out = infer(data.path(), "--fix K_A=0.1");
    let field = |folder: &Folder, name: &str| read::<f64, ndarray::Ix2>(&folder.file(name));
    let [nudged, predicted, residual]: [Array2<f64>; 3] =
        ["nudged_positions.npy", "predicted_velocities.npy", "residual_velocities.npy"]
            .map(|name| field(&out, name));
    let (positions, velocities) = (field(&data, "positions.npy"), field(&data, "velocities.npy"));
    for (place, &velocity) in velocities.indexed_iter() {
        assert!((nudged[place] - positions[place]).abs() < 0.5, "{place:?}");
        assert!(predicted[place].is_finite(), "{place:?}");
        let sum = predicted[place] + residual[place];
        assert!(if place.0 == 5 { sum.is_nan() } else { (sum - velocity).abs() < 1e-12 }, "{place:?}");
    }
    let report = report(out.path());
    assert_described(&report);
    assert_eq!((number(&report, "/cells/used"), number(&report, "/cells/left_out/no_velocity")), (99.0, 1.0));
}

#[test]
fn a_fit_that_contradicts_its_noise_is_written_and_ends_with_1() {
    let out = Folder::new();
    let data = fixture("chiral-liquid");
    let noise =
        "--position-noise 0.1% --velocity-noise 0.1% --max-steps 5".split_whitespace().map(OsStr::new);
    let arguments = ["infer".as_ref(), data.as_os_str(), "--out".as_ref(), out.path().as_os_str()];
    let outcome = voronudge(arguments.into_iter().chain(noise));
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    assert_eq!(out.names(), FILES);
    let report = report(out.path());
    assert_described(&report);
    let warning = report["warnings"][0].as_str().unwrap();
    assert!(warning.contains("expected value") && outcome.stderr.contains(warning), "{}", outcome.stderr);
}

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let out = infer(&fixture("chiral-liquid"), "--fix K_A=0.1");
    let page = fs::read_to_string(out.file("report.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") || page.starts_with("<!doctype html>"));
    assert!(page.contains("<svg"));
    let without_namespaces = page.replace("http://www.w3.org/", "");
    for outside in ["http://", "https://", "src=\"//", "href=\"//", "url(", "@import"] {
        assert!(!without_namespaces.contains(outside), "the page refers to {outside}");
    }
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let results = ["1", "2", "2"].map(|threads| {
        let out = infer(&fixture("chiral-liquid"), &format!("--fix K_A=0.1 --seed 7 --threads {threads}"));
        let report = report(out.path());
        assert_eq!(
            (number(&report, "/seed"), number(&report, "/threads").to_string()),
            (7.0, threads.into())
        );
        let arrays = FILES.iter().filter(|name| name.ends_with(".npy"));
        (
            arrays.map(|name| fs::read(out.file(name)).unwrap()).collect::<Vec<_>>(),
            report["parameters"].clone(),
        )
    });
    assert!(results[0] == results[1] && results[1] == results[2]);
}

/// Five frames of an open field with a gap in one track, fitted without velocities.
#[test]
fn tracks_are_fitted_themselves() {
    let out = infer(&fixture("open-field"), "");
    let mut files = FILES.to_vec();
    files.push("trajectories.npy");
    assert_eq!(out.names(), files);
    let report = report(out.path());
    assert_described(&report);
    assert_eq!(report["cells"]["frames"], serde_json::json!([0, 1, 2, 3, 4]));
    let tracks = &report["measurement"]["tracks"];
    assert!(tracks["substeps"].as_u64() >= Some(1) && tracks["drifts"].as_array().unwrap().len() == 4);
    assert!(number(tracks, "/sigma_r") > 0.0 && number(tracks, "/sigma_d") > 0.0);
    for (name, truth, tolerance) in [("K_P_alpha", 0.02, 0.05), ("P_0", 78.0, 0.05)] {
        let found = number(&report, &format!("/parameters/{name}/value"));
        assert!((found - truth).abs() < tolerance * truth, "{name} is {found}");
    }
    let measured: Array3<f64> = read(&fixture("open-field/positions.npy"));
    let trajectories: Array3<f64> = read(&out.file("trajectories.npy"));
    let nudged: Array3<f64> = read(&out.file("nudged_positions.npy"));
    assert_eq!((trajectories.dim(), nudged.dim()), (measured.dim(), measured.dim()));
    // In the files y points down, in the results too.
    for ((place, seen), nudged) in trajectories.iter().zip(&measured).zip(&nudged) {
        assert!(seen.is_nan() || (place - seen).abs() < 10.0);
        assert!(place.to_bits() == nudged.to_bits() || place.is_nan() && nudged.is_nan());
    }
    // The last frame has no velocity up to a next one.
    let residual: Array3<f64> = read(&out.file("residual_velocities.npy"));
    assert!(residual.index_axis(ndarray::Axis(0), 4).iter().all(|r| r.is_nan()));
    assert!(residual.index_axis(ndarray::Axis(0), 0).iter().any(|r| r.is_finite()));
}

/// The same, of which two neighbours go on under each other's name from the third frame on.
#[test]
#[ignore = "slow"]
fn tracks_that_jump_are_cut() {
    let source = fixture("open-field");
    let mut positions: Array3<f64> = read(&source.join("positions.npy"));
    let [frames, cells] = [positions.dim().0, positions.dim().1];
    let seen: Vec<usize> =
        (0..cells).filter(|cell| (0..frames).all(|k| positions[[k, *cell, 0]].is_finite())).collect();
    let distance = |a: usize, b: usize| {
        (positions[[2, a, 0]] - positions[[2, b, 0]]).hypot(positions[[2, a, 1]] - positions[[2, b, 1]])
    };
    let one = seen[seen.len() / 2];
    let others = seen.iter().copied().filter(|cell| *cell != one);
    let other = others.min_by(|a, b| distance(one, *a).total_cmp(&distance(one, *b))).unwrap();
    for k in 2..frames {
        (0..2).for_each(|axis| positions.swap([k, one, axis], [k, other, axis]));
    }
    let folder = Folder::new();
    ndarray_npy::write_npy(folder.file("positions.npy"), &positions).unwrap();
    fs::copy(source.join("dataset.toml"), folder.file("dataset.toml")).unwrap();
    let told = [source.as_path(), folder.path()].map(|data| report(infer(data, "").path()));
    let tracks = |told: &serde_json::Value, what: &str| told["measurement"]["tracks"][what].as_u64().unwrap();
    assert_eq!(told.each_ref().map(|told| tracks(told, "cut")), [0, 2]);
    assert_eq!(tracks(&told[1], "joined"), tracks(&told[0], "joined") + 2);
    assert_eq!(tracks(&told[1], "tracks"), tracks(&told[0], "tracks"));
    let [right, mixed] = told.map(|told| number(&told, "/parameters/K_P_alpha/value"));
    assert!((mixed / right - 1.0).abs() < 1e-3, "{right} and {mixed}");
}

/// The same tissue, which does not crawl, asked for its polarity, and whether that aligns.
#[test]
#[ignore = "slow"]
fn of_cells_that_do_not_crawl_no_polarity_is_found() {
    let out = infer(&fixture("open-field"), "--align --fix K_A=0");
    assert!(out.names().contains(&"polarities.npy".into()));
    let report = report(out.path());
    assert_described(&report);
    let v_0 = &report["activity"]["v_0"];
    assert!(number(v_0, "/ci95/0") == 0.0 && number(v_0, "/ci95/1") < 0.01, "{v_0}");
    assert!(report["activity"]["D_r"]["ci95"].is_null() && report["activity"]["J"]["ci95"].is_null());
    assert!(number(&report, "/activity/evidence_of_alignment") < 4.0);
    assert!(!report["warnings"].to_string().contains("cells that crawl"), "{}", report["warnings"]);
    let found = number(&report, "/parameters/K_P_alpha/value");
    assert!((found - 0.02).abs() < 0.001, "K_P_alpha is {found}");
    let measured: Array3<f64> = read(&fixture("open-field/positions.npy"));
    let polarities: Array3<f64> = read(&out.file("polarities.npy"));
    assert_eq!(polarities.dim(), measured.dim());
    assert!(polarities.iter().any(|p| p.is_finite()) && polarities.iter().any(|p| p.is_nan()));
    assert!(polarities.iter().all(|p| p.is_nan() || p.abs() < 0.01));
}

#[test]
fn positions_alone_tell_the_sense_of_chirality() {
    let out = infer(&fixture("open-field"), "--difference central");
    assert_eq!(out.names(), FILES);
    let report = report(out.path());
    assert_described(&report);
    // Central differences exist for all frames but the first and the last.
    assert_eq!(report["cells"]["frames"], serde_json::json!([1, 2, 3]));
    assert_eq!(report["nmse"]["mean_removed"], "per_frame");
    assert!(number(&report, "/cells/left_out/polygon_not_closed") > 0.0);
    // Differences over a finite time bias the rest more than its intervals tell.
    assert!(number(&report, "/parameters/K_P_alpha/ci95/0") > 0.0);
    assert!(number(&report, "/parameters/alpha/ci95/0") > 0.0);
    for (name, truth, tolerance) in [("K_P_alpha", 0.02, 0.05), ("P_0", 78.0, 0.05), ("alpha", 1.0, 0.3)] {
        let found = number(&report, &format!("/parameters/{name}/value"));
        assert!((found - truth).abs() < tolerance * truth, "{name} is {found}");
    }
    // In the files y points down, in the results too; absent cells stay absent.
    let measured: Array3<f64> = read(&fixture("open-field/positions.npy"));
    let nudged: Array3<f64> = read(&out.file("nudged_positions.npy"));
    let predicted: Array3<f64> = read(&out.file("predicted_velocities.npy"));
    assert_eq!(nudged.dim(), (3, measured.dim().1, 2));
    assert_eq!(predicted.dim(), nudged.dim());
    for ((frame, cell, axis), &moved) in nudged.indexed_iter() {
        let nudge = moved - measured[[frame + 1, cell, axis]];
        assert_eq!(nudge.is_nan(), measured[[frame + 1, cell, axis]].is_nan());
        assert!(nudge.is_nan() || nudge.abs() < 10.0, "frame {frame}, cell {cell}: {nudge}");
    }
}

#[test]
fn the_parameters_of_a_report_can_be_used_again() {
    let data = fixture("chiral-liquid");
    let (fit, model) = (infer(&data, "--fix K_A=0.1"), Folder::new());
    let found = fit.file("report.json");
    succeed("evaluate", &[("", &data), ("--parameters", &found), ("--out", model.path())]);
    let (fit, model) = (report(fit.path()), report(model.path()));
    for name in ["K_A", "K_P", "P_0", "A_0", "alpha"] {
        let used = number(&model, &format!("/parameters/{name}"));
        assert_eq!(used, number(&fit, &format!("/parameters/{name}/value")), "{name}");
    }
}

/// Cells may differ: the report says by how much, files say which cell by how much.
#[test]
fn cells_may_differ() {
    let data = fixture("chiral-liquid");
    let out = infer(&data, "--fix K_A=0.1 --vary alpha");
    let told = report(out.path());
    assert_described(&told);
    let spreads = told["spreads"].as_array().unwrap();
    assert_eq!((spreads.len(), &spreads[0]["parameter"]), (1, &serde_json::json!("alpha")));
    let [low, value] = ["ci95/0", "relative"].map(|name| number(&told, &format!("/spreads/0/{name}")));
    assert!(0.0 <= low && low <= value + 1e-9 && value < 0.5, "{low} {value}");
    let own = |name: &str| -> Vec<f64> {
        let array: ndarray::ArrayD<f64> = read(&out.file(name));
        array.iter().copied().filter(|own| own.is_finite()).collect()
    };
    let (deviations, errors) = (own("deviation_alpha.npy"), own("deviation_error_alpha.npy"));
    assert_eq!(deviations.len(), errors.len());
    assert!(errors.iter().all(|error| *error <= value + 1e-9));
    assert_eq!(told["warnings"], serde_json::json!([]));
}

/// Where cells differ in P_0 it is said what that does to K_P.
#[test]
fn elasticities_are_not_to_be_quoted_where_shapes_may_have_followed() {
    let data = Folder::new();
    let line = "simulate --cells 144 --P_0 4 --alpha 1 --cell-spread P_0=0.05 --time 5 --frames 1 --seed 1";
    succeed(line, &[("--out", data.path())]);
    let told = report(infer(data.path(), "--fix K_A=0.1 --vary P_0 --position-noise 0.005").path());
    assert_eq!(told["spreads"][0]["named"], serde_json::json!(true));
    assert!(told["warnings"].to_string().contains("K_P comes out too small"), "{}", told["warnings"]);
}
