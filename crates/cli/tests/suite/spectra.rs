//! `spectrum`: eigenvalues against recorded answers, files, and what is refused.

use crate::program::{assert_described, fixture, succeed, voronudge};
use crate::refusal::{assert_arguments_refused, assert_refused};
use crate::scratch::{Folder, read, report};
use ndarray::{Array1, Array2, Array4, Axis};
use std::fs;

fn nearest(values: &Array2<f64>, [re, im]: [f64; 2]) -> f64 {
    values.rows().into_iter().map(|v| (v[0] - re).hypot(v[1] - im)).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_second_implementation_agrees() {
    let (data, out) = (fixture("reference-small"), Folder::new());
    let parameters = data.join("parameters.json");
    succeed("spectrum --modes", &[("", &data), ("--parameters", &parameters), ("--out", out.path())]);
    let found: Array2<f64> = read(&out.file("eigenvalues.npy"));
    let recorded: Array2<f64> = read(&data.join("eigenvalues.npy"));
    assert_eq!(found.dim(), (40, 2));
    let scale = recorded.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for value in recorded.rows() {
        assert!(nearest(&found, [value[0], value[1]]) < 1e-8 * scale);
    }
    let real: Vec<f64> = found.column(0).to_vec();
    assert!(real.windows(2).all(|pair| pair[0] >= pair[1]));
    let report = report(out.path());
    assert_described(&report);
    let names = [
        "condition.npy",
        "eigenvalues.npy",
        "longitudinal.npy",
        "modes.npy",
        "participation.npy",
        "report.html",
        "report.json",
    ];
    assert_eq!(out.names(), names);
    // J u = λ u with the recorded Jacobian.
    let jacobian: Array2<f64> = read(&data.join("jacobian.npy"));
    let modes: Array4<f64> = read(&out.file("modes.npy"));
    assert_eq!(modes.dim(), (40, 20, 2, 2));
    for (mode, value) in modes.axis_iter(Axis(0)).zip(found.rows()) {
        let part = |k: usize| Array1::from_iter((0..40).map(|i| mode[(i / 2, i % 2, k)]));
        let (u, w) = (part(0), part(1));
        let off = jacobian.dot(&u) - &u * value[0] + &w * value[1];
        assert!(off.iter().all(|x| x.abs() < 1e-8 * scale));
    }
    let counts = &report["frames"][0];
    let number = |name: &str| counts[name].as_u64().unwrap();
    assert_eq!(number("decaying") + number("growing") + number("zero") + number("neutral"), 40);
    assert_eq!(number("zero"), 2);
    let square: f64 = found.column(1).iter().map(|im| im * im).sum::<f64>() / 40.0;
    assert!((counts["mean_square_frequency"].as_f64().unwrap() / square - 1.0).abs() < 1e-9);
}

#[test]
fn parts_of_the_spectrum_are_rows_of_the_whole() {
    let data = fixture("chiral-liquid");
    let all = Folder::new();
    succeed("spectrum --alpha 3.4 --values-only", &[("", &data), ("--out", all.path())]);
    assert!(!all.names().contains(&"condition.npy".to_owned()));
    let all: Array2<f64> = read(&all.file("eigenvalues.npy"));
    let scale = all.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for flags in ["--largest 5", "--near 0 60 --count 4", "--band 20 40 --count 20"] {
        let out = Folder::new();
        succeed(&format!("spectrum --alpha 3.4 {flags}"), &[("", &data), ("--out", out.path())]);
        let found: Array2<f64> = read(&out.file("eigenvalues.npy"));
        assert!(found.nrows() > 3, "{flags}");
        for value in found.rows() {
            assert!(nearest(&all, [value[0], value[1]]) < 1e-8 * scale, "{flags} {value}");
        }
        let report = report(out.path());
        assert_described(&report);
        assert!(report["frames"][0]["mean_square_frequency"].is_null());
        assert!(report["frames"][0]["largest_residual"].as_f64().unwrap() < 1e-8);
        if flags.starts_with("--largest") {
            assert!((0..5).all(|row| (found[(row, 0)] - all[(row, 0)]).abs() < 1e-8 * scale));
        }
    }
}

#[test]
fn frames_and_effects_are_those_chosen() {
    let (data, out) = (fixture("open-field"), Folder::new());
    let line =
        "spectrum --frames 1,3 --K_A 5e-6 --K_P 0.02 --P_0 78 --A_0 400 --alpha 1 --effect drift=0.1,0";
    let outcome = succeed(line, &[("", &data), ("--out", out.path())]);
    assert!(outcome.stdout.contains("frame 1") && outcome.stdout.contains("frame 3"));
    let report = report(out.path());
    assert_described(&report);
    assert_eq!(report["effects"]["drift"][0].as_f64(), Some(0.1));
    assert!(report["mean_field"].is_null() && report["lattice"].is_null());
    let counted = |frame: usize| report["frames"][frame]["counted"].as_u64().unwrap();
    assert!(counted(0) > 50 && counted(0) < report["frames"][0]["present"].as_u64().unwrap());
    let values: ndarray::Array3<f64> = read(&out.file("eigenvalues.npy"));
    assert_eq!(values.dim(), (2, 2 * counted(0).max(counted(1)) as usize, 2));
    // The rim is held, so nothing is free to translate.
    assert_eq!(report["frames"][0]["zero"].as_u64(), Some(0));
}

/// Image data with y down show the mirror image: the same rates.
#[test]
fn the_axis_of_the_files_changes_no_rate() {
    let data = fixture("reference-small");
    let [up, down] = ["--alpha -0.8", "--alpha 0.8 --y-axis down"].map(|flags| {
        let out = Folder::new();
        let line = format!("spectrum --K_A 0.15 --K_P 1.2 --P_0 3.9 {flags}");
        succeed(&line, &[("", &data), ("--out", out.path())]);
        read::<f64, ndarray::Ix2>(&out.file("eigenvalues.npy"))
    });
    assert!(up.rows().into_iter().all(|value| nearest(&down, [value[0], value[1]]) < 1e-8));
}

#[test]
fn a_lattice_is_compared_with_the_theory() {
    let out = Folder::new();
    succeed("spectrum --lattice 8 10 --P_0 3.4 --alpha 0.3", &[("--out", out.path())]);
    let report = report(out.path());
    assert_described(&report);
    assert!(report["lattice"]["largest_difference"].as_f64().unwrap() < 1e-9);
    assert_eq!(report["mean_field"]["phase"], "odd_elastic_solid");
    let table: Array2<f64> = read(&out.file("dispersion.npy"));
    assert_eq!(table.ncols(), 11);
    for row in table.rows() {
        assert!((3..7).all(|k| (row[k] - row[k + 4]).abs() < 1e-6), "{row}");
    }
    let again = Folder::new();
    succeed("spectrum --P_0 3.4 --alpha 0.3", &[("", out.path()), ("--out", again.path())]);
    let page = fs::read_to_string(out.file("report.html")).unwrap();
    assert!(page.contains("Waves on the honeycomb") && page.contains("mean-field theory"));
    assert!(
        !page.contains("http://")
            || page.matches("http://").count() == page.matches("http://www.w3.org").count()
    );
}

#[test]
fn results_do_not_depend_on_threads() {
    let data = fixture("chiral-liquid");
    let [one, two] = ["1", "2"].map(|threads| {
        let out = Folder::new();
        let line =
            format!("spectrum --lattice 5 12 --ends held --wave-numbers 9 --P_0 3.2 --threads {threads}");
        succeed(&line, &[("--out", out.path())]);
        ["strip_eigenvalues.npy", "strip_localisation.npy"].map(|name| fs::read(out.file(name)).unwrap())
    });
    assert!(one == two);
    for flags in ["", "--largest 6"] {
        let [one, two] = ["1", "2"].map(|threads| {
            let out = Folder::new();
            let line = format!("spectrum --alpha 1 --modes {flags} --threads {threads}");
            succeed(&line, &[("", &data), ("--out", out.path())]);
            ["eigenvalues.npy", "modes.npy", "condition.npy"].map(|name| fs::read(out.file(name)).unwrap())
        });
        assert!(one == two, "{flags}");
    }
}

/// A tissue between walls that came to rest: all its modes decay but for what walls leave free, and without chirality none oscillates.
#[test]
fn cells_between_walls_have_modes() {
    for (walls, free) in [("x", 1), ("both", 0)] {
        let (run, out) = (Folder::new(), Folder::new());
        let line = format!(
            "simulate --cells 48 --box 8 6 --P_0 3.2 --alpha 0 --walls {walls} --time 60 --frames 1 --seed 4"
        );
        succeed(&line, &[("--out", run.path())]);
        succeed("spectrum --P_0 3.2 --alpha 0", &[("", run.path()), ("--out", out.path())]);
        let report = report(out.path());
        assert_described(&report);
        let frame = &report["frames"][0];
        assert_eq!(frame["counted"], 48);
        assert_eq!(frame["oscillating"], 0, "{walls}");
        assert_eq!(frame["growing"], 0, "{walls}");
        // Free to slide along a pair of walls.
        assert_eq!(frame["zero"], free, "{walls}");
        assert_eq!(frame["walls"]["sides"], walls);
        let (edge, place): (Array2<f64>, Array2<f64>) =
            (read(&out.file("edge.npy")), read(&out.file("localisation.npy")));
        assert!(edge.dim() == (96, 2) && place.dim() == (96, 2));
        // Modes of a symmetric matrix are orthogonal and complete: the mean share is that of the cells.
        let cells = frame["walls"]["cells"].as_f64().unwrap();
        assert!((edge.column(0).mean().unwrap() - cells).abs() < 1e-9);
        assert!(cells > 0.3 && cells < 1.0 + 1e-12);
        for row in edge.rows() {
            assert!(if walls == "x" { row[1].abs() <= row[0] + 1e-12 } else { row[1].is_nan() });
        }
        // Sides at the walls that have no length are no transitions.
        assert!(frame["transition"]["shortest_side"].as_f64().unwrap() > 1e-4);
        let page = fs::read_to_string(out.file("report.html")).unwrap();
        assert!(page.contains("ends at walls"));
        assert_refused("spectrum", run.path(), &["--effect", "drift=0.1,0"], &["--effect", "walls"]);
    }
}

#[test]
fn a_strip_has_its_modes_at_each_wave_number() {
    let out = Folder::new();
    let line = "spectrum --lattice 5 20 --ends held --P_0 3.2 --alpha 0.4 --wave-numbers 8 --wave-number 2.5";
    let outcome = succeed(line, &[("--out", out.path())]);
    assert!(outcome.stdout.contains("strip of 18 rows"), "{}", outcome.stdout);
    let report = report(out.path());
    assert_described(&report);
    let strip = &report["strip"];
    assert_eq!((strip["moving_rows"].as_u64(), strip["modes"].as_u64()), (Some(18), Some(36)));
    assert_eq!(report["frames"][0]["counted"], 90);
    // A wave with the conjugate value is the mirror image: as many pile up left as right.
    assert!(strip["left"] == strip["right"] && strip["left"].as_u64() > Some(3), "{strip}");
    assert!(strip["difference_from_zone"].as_f64().unwrap() < 0.3);
    let values: ndarray::Array3<f64> = read(&out.file("strip_eigenvalues.npy"));
    let edge: ndarray::Array3<f64> = read(&out.file("strip_edge.npy"));
    let place: ndarray::Array3<f64> = read(&out.file("strip_localisation.npy"));
    let q: Array1<f64> = read(&out.file("strip_wave_numbers.npy"));
    assert_eq!((values.dim(), edge.dim(), place.dim()), ((9, 36, 2), (9, 36, 2), (9, 36, 5)));
    assert!((q[0] + q[8]).abs() < 1e-12 && q[4].abs() < 1e-12);
    // Turned by half a circle, the strip has the modes of −q on the other side.
    let [ahead, behind] = [6, 2].map(|k| values.index_axis(Axis(0), k).to_owned());
    assert!(ahead.rows().into_iter().all(|value| nearest(&behind, [value[0], value[1]]) < 1e-8));
    let sum = |k: usize| place.index_axis(Axis(0), k).column(1).iter().map(|x| x.abs()).sum::<f64>();
    assert!((sum(6) - sum(2)).abs() < 1e-6 * sum(6) && sum(6) > 10.0 * sum(4));
    let profiles: Array2<f64> = read(&out.file("strip_profiles.npy"));
    assert!(profiles.rows().into_iter().all(|own| (own.sum() - 1.0).abs() < 1e-9));
    let winding: Array2<f64> = read(&out.file("winding.npy"));
    let [most, least] = [f64::max, f64::min].map(|of| winding.column(2).iter().fold(0.0, |a, b| of(a, *b)));
    assert!(most >= 1.0 && least <= -1.0);
    let page = fs::read_to_string(out.file("report.html")).unwrap();
    assert!(page.contains("A strip with ends") && page.contains("winds by"));
    // Between walls the honeycomb first comes to rest, where it can.
    let walls = Folder::new();
    let line = "spectrum --lattice 5 14 --ends walls --P_0 3 --alpha 0.05 --wave-numbers 4 --wave-number 2.2";
    succeed(line, &[("--out", walls.path())]);
    let record = crate::scratch::report(walls.path());
    assert_described(&record);
    assert!(record["strip"]["speed"].as_f64().unwrap() < 1e-9);
    assert_eq!(record["strip"]["wave_number"].as_f64(), Some(2.2));
    assert_eq!(record["frames"][0]["walls"]["sides"], "x");
    assert_eq!((&record["frames"][0]["growing"], &record["frames"][0]["zero"]), (&0.into(), &1.into()));
    assert!(fs::read_to_string(walls.file("dataset.toml")).unwrap().contains("walls = \"x\""));
    let refuse = |line: &str, facts: &[&str]| assert_arguments_refused(line.split_whitespace(), facts);
    refuse("spectrum --lattice 5 12 --ends walls --P_0 3.6 --alpha 1", &["come to rest"]);
    refuse("spectrum --lattice 5 6 --ends held", &["4 rows"]);
    refuse("spectrum --lattice 5 12 --ends held --wave-numbers 0", &["--wave-numbers 0"]);
    refuse("spectrum --lattice 5 12 --ends held --wave-number inf", &["--wave-number inf"]);
    refuse("spectrum --ends held", &["--lattice"]);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let data = fixture("reference-small");
    let refused = |flags: &[&str], facts: &[&str]| assert_refused("spectrum", &data, flags, facts);
    refused(&["--dense-limit", "10"], &["20 cells", "10 cells"]);
    refused(&["--largest", "0"], &["0 modes"]);
    refused(&["--near", "nan", "0"], &["shift"]);
    refused(&["--band", "3", "1"], &["band", "3", "1"]);
    refused(&["--count", "3"], &["--count", "--near"]);
    refused(&["--largest", "3", "--near", "0", "1"], &["--near"]);
    refused(&["--values-only", "--modes"], &["--modes", "--values-only"]);
    refused(&["--frames", "7"], &["7"]);
    refused(&["--K_P", "1e308"], &["K_P", "1e50"]);
    assert_arguments_refused(["spectrum", "--lattice", "3", "4"], &["3 × 4", "5 × 6"]);
    assert_arguments_refused(["spectrum", "--lattice", "99999", "4"], &["too large"]);
    assert_arguments_refused(["spectrum"], &["no data"]);
    assert_eq!(voronudge(["spectrum", "--help"]).code, Some(0));
    let few = Folder::data_set(
        &ndarray::arr2(&[[0.0, 0.0], [1.0, 0.1], [0.2, 1.0], [1.1, 1.2], [2.0, 0.7]]),
        "boundary = \"open\"\n",
    );
    assert_refused("spectrum", few.path(), &[], &["no cell counts"]);
}

#[test]
fn doubtful_snapshots_and_units_are_warned_of() {
    let out = Folder::new();
    let outcome = succeed("spectrum --largest 3", &[("", &fixture("open-field")), ("--out", out.path())]);
    for part in ["cell sizes", "only the first", "sides are shorter"] {
        assert!(outcome.stderr.contains(part), "{part}: {}", outcome.stderr);
    }
    assert_eq!(report(out.path())["warnings"].as_array().map(Vec::len), Some(3));
}
