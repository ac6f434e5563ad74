//! `channel` and `estimate-chirality`: files, schemas, the chirality put in, and what is refused.

use crate::program::{assert_described, succeed, voronudge};
use crate::refusal::{assert_arguments_refused, assert_refused};
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array1, Array2, Array3, Axis};
use std::ffi::OsStr;
use std::fs;

const SHORT: &str = "channel --preset ht1080 --width 200 --length 150 --relaxation 2 --time 20 --dt 0.02 --samples 16 --seed 1 --quiet";

#[test]
fn a_channel_is_a_data_set_with_profiles_and_lives() {
    let out = Folder::new();
    succeed(&format!("{SHORT} --frames 3"), &[("--out", out.path())]);
    let names = [
        "age.npy",
        "birth_disturbance.npy",
        "birth_rate.npy",
        "dataset.toml",
        "density.npy",
        "distance.npy",
        "extrusion_rate.npy",
        "face.npy",
        "flux_rate.npy",
        "folded_profile.csv",
        "lineage.csv",
        "net_rate.npy",
        "positions.npy",
        "report.html",
        "report.json",
        "shape_by_age.npy",
        "stress_xx.npy",
        "stress_xy.npy",
        "stress_yx.npy",
        "stress_yy.npy",
        "torque.npy",
        "transport.npy",
        "velocities.npy",
        "velocity_x.npy",
        "velocity_y.npy",
        "x.npy",
    ];
    assert_eq!(out.names(), names);
    let report = report(out.path());
    assert_described(&report);
    for count in ["first", "last", "fewest", "most"] {
        assert_eq!(number(&report, &format!("/cells/{count}")), 48.0);
    }
    assert_eq!(number(&report, "/cells/births"), number(&report, "/cells/extrusions"));
    // 48 cells per 30 000 µm².
    let x: Array1<f64> = read(&out.file("x.npy"));
    let density: Array2<f64> = read(&out.file("density.npy"));
    assert_eq!((x.len(), density.dim()), (32, (32, 2)));
    let total: f64 = density.column(0).iter().sum::<f64>() * (200.0 / 32.0) * 150.0;
    assert!((total - 48.0).abs() < 1e-6, "{total}");
    // One column for each cell that is seen, NaN when it is not there; the lives tell where it is.
    let positions: Array3<f64> = read(&out.file("positions.npy"));
    let lineage = fs::read_to_string(out.file("lineage.csv")).unwrap();
    let mut lines = lineage.lines();
    assert_eq!(lines.next(), Some("life,origin,mother,born,extruded,cell,first_frame,last_frame"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len() as f64, 48.0 + number(&report, "/cells/births"));
    for frame in 0..3 {
        let present = (0..positions.dim().1).filter(|&cell| !positions[(frame, cell, 0)].is_nan()).count();
        assert_eq!(present, 48);
    }
    for row in rows.iter().filter(|row| !row[5].is_empty()) {
        let [cell, first, last] = [5, 6, 7].map(|column| row[column].parse::<usize>().unwrap());
        for frame in 0..3 {
            assert_eq!(positions[(frame, cell, 0)].is_nan(), !(first..=last).contains(&frame), "{row:?}");
        }
    }
    // `infer` reads it.
    let fit = Folder::new();
    succeed(
        "infer --frames 2 --fix K_A=0 --position-noise 0.01 --velocity-noise 0.1% --quiet",
        &[("", out.path()), ("--out", fit.path())],
    );
    let alpha = number(&crate::scratch::report(fit.path()), "/parameters/alpha/value");
    assert!((alpha - 2.9).abs() < 0.1, "{alpha}");
    // So does `estimate-chirality`, with the same line as in the report.
    let estimate = Folder::new();
    succeed("estimate-chirality --quiet", &[("", out.path()), ("--out", estimate.path())]);
    let found = crate::scratch::report(estimate.path());
    assert_described(&found);
    let [a, b] = [number(&found, "/slope"), number(&report, "/chirality_from_flow/slope")];
    assert!((a - b).abs() < 1e-9, "{a} {b}");
}

/// Between walls every cell stays in the channel, the number of cells too, and the data set and the report tell of the walls.
#[test]
fn a_channel_between_walls_says_so() {
    let (out, periodic) = (Folder::new(), Folder::new());
    succeed(&format!("{SHORT} --frames 3 --walls x"), &[("--out", out.path())]);
    succeed(SHORT, &[("--out", periodic.path())]);
    let (walled, periodic) = (report(out.path()), report(periodic.path()));
    for report in [&walled, &periodic] {
        assert_described(report);
    }
    assert!(walled["walls"] == "x" && periodic["walls"].is_null());
    for count in ["first", "last", "fewest", "most"] {
        assert_eq!(number(&walled, &format!("/cells/{count}")), 48.0);
    }
    assert_eq!(number(&walled, "/cells/births"), number(&walled, "/cells/extrusions"));
    let positions: Array3<f64> = read(&out.file("positions.npy"));
    let x: Vec<f64> = positions.index_axis(Axis(2), 0).iter().copied().collect();
    assert!(x.iter().all(|x| x.is_nan() || (0.0..=200.0).contains(x)), "{x:?}");
    assert_eq!(x.iter().filter(|x| !x.is_nan()).count(), 3 * 48);
    assert!(fs::read_to_string(out.file("dataset.toml")).unwrap().contains("walls = \"x\""));
    assert_refused("infer", out.path(), &[], &["walls"]);
    // Both walls are faces.
    let faces: Array1<f64> = read(&out.file("face.npy"));
    let flux: Array2<f64> = read(&out.file("flux_rate.npy"));
    assert_eq!((faces.len(), faces[32], flux.dim()), (33, 200.0, (33, 2)));
    // The fits begin beyond the edge current, which is far faster than the flow across.
    assert_eq!(number(&walled, "/chirality_from_flow/range/0"), 50.0);
    let [x, y]: [Array2<f64>; 2] = ["velocity_x.npy", "velocity_y.npy"].map(|name| read(&out.file(name)));
    assert!(
        y[(0, 0)] < -100.0 && y[(31, 0)] > 100.0 && x[(0, 0)].abs() < 10.0,
        "{} {}",
        x[(0, 0)],
        y[(0, 0)]
    );
    let page = fs::read_to_string(out.file("report.html")).unwrap();
    assert!(page.contains("torque-free walls at both edges") && page.contains("downwards at the left one"));
}

/// Cells that grow and divide: as many as at first, mothers that end where two daughters begin, and shapes by age of all that are seen.
#[test]
fn a_channel_whose_cells_grow_and_divide_says_so() {
    let out = Folder::new();
    succeed(&format!("{SHORT} --injection cycle --frames 3"), &[("--out", out.path())]);
    let report = report(out.path());
    assert_described(&report);
    assert!(report["turnover"]["injection"] == "cycle" && report["turnover"]["cycle"]["axis"] == "long");
    assert_eq!(number(&report, "/cells/births"), number(&report, "/cells/extrusions"));
    assert_eq!((number(&report, "/cells/fewest"), number(&report, "/cells/most")), (48.0, 48.0));
    let size = number(&report, "/turnover/cycle/mean_size");
    assert!((0.7..1.386).contains(&size), "{size}");
    let lineage = fs::read_to_string(out.file("lineage.csv")).unwrap();
    assert!(lineage.starts_with("life,origin,mother,born,extruded,divided,cell,first_frame,last_frame\n"));
    let rows: Vec<Vec<&str>> = lineage.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let divided: Vec<usize> = (0..rows.len()).filter(|&life| !rows[life][5].is_empty()).collect();
    assert_eq!(divided.len() as f64, number(&report, "/cells/births"));
    for mother in divided {
        let daughters = rows.iter().filter(|row| row[2] == mother.to_string() && row[3] == rows[mother][5]);
        assert_eq!(daughters.count(), 2);
    }
    let shapes: Array3<f64> = read(&out.file("shape_by_age.npy"));
    assert_eq!(shapes.dim(), (6, 10, 3));
    assert!(shapes.index_axis(Axis(2), 0).iter().all(|p| p.is_nan() || (3.54..8.0).contains(p)), "{shapes}");
    // 48 cells every 0.1/K_P of 20 h, less founders that are not old enough.
    let seen = shapes.index_axis(Axis(2), 2).sum();
    assert!(seen <= 48.0 * 86.0 && seen > 48.0 * 40.0, "{seen}");
    let disturbance: Array2<f64> = read(&out.file("birth_disturbance.npy"));
    assert_eq!(disturbance.dim(), (200, 3));
    assert!(fs::read_to_string(out.file("report.html")).unwrap().contains("divide in two"));
}

#[test]
fn results_do_not_depend_on_threads() {
    let profile = |threads: &str, walls: &str| {
        let out = Folder::new();
        succeed(
            &format!(
                "channel --width 6 --length 6 --relaxation 0 --time 2 --alpha 1 --threads {threads} {walls} --quiet"
            ),
            &[("--out", out.path())],
        );
        fs::read_to_string(out.file("folded_profile.csv")).unwrap()
    };
    for walls in ["", "--walls x", "--injection cycle", "--injection cycle --walls x"] {
        assert_eq!(profile("1", walls), profile("2", walls));
    }
    assert_ne!(profile("1", ""), profile("1", "--walls x"));
}

#[test]
fn a_population_that_explodes_keeps_what_there_was_and_answers_no() {
    let out = Folder::new();
    let line = "channel --width 6 --length 6 --proliferation-rate 1 --proliferation-length 3 --relaxation 0 --time 20 \
                --most-cells 60 --samples 64 --frames 400 --quiet --out";
    let words = line.split_whitespace().map(OsStr::new).chain([out.path().as_os_str()]);
    let outcome = voronudge(words);
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    let report = report(out.path());
    assert_described(&report);
    assert!(report["ended"].as_str().unwrap().contains("limit 60"));
    assert!(number(&report, "/samples") < 64.0 && number(&report, "/cells/most") <= 60.0);
    assert!(out.names().contains(&"positions.npy".to_owned()));
}

#[test]
fn a_table_gives_a_chirality() {
    let (folder, out) = (Folder::new(), Folder::new());
    let table = folder.write("profile.csv", "x,v_x,v_y\n10,-2,-3\n20,1,1.5\n30,4,6.1\n40,2,2.9\n");
    let arguments = [("", table.as_path()), ("--out", out.path())];
    succeed("estimate-chirality --quiet", &arguments);
    let without = report(out.path());
    assert!((number(&without, "/slope") - 1.5).abs() < 0.05 && without["alpha"].is_null());
    assert!((number(&without, "/alpha_rule_of_thumb") - 3.0).abs() < 0.1);
    // The paper: 0.46 < v_y/(α v_x) < 0.61 for 3 < P₀/ℓ₀ < 5.
    assert!((number(&without, "/alpha_range/0") / number(&without, "/slope") - 1.0 / 0.604).abs() < 0.01);
    assert!((number(&without, "/alpha_range/1") / number(&without, "/slope") - 1.0 / 0.456).abs() < 0.01);
    succeed("estimate-chirality --shape-index 4 --intercept free --to 35 --quiet", &arguments);
    let with = report(out.path());
    assert_described(&with);
    assert_eq!(number(&with, "/points"), 3.0);
    // 3 − 4/(2√(2√3)) = 1.925.
    assert!((number(&with, "/alpha") / number(&with, "/slope") - 1.9254).abs() < 1e-3);
}

#[test]
fn senseless_channels_are_refused() {
    for (arguments, part) in [
        ("channel --extrusion-rate -1", "rate of extrusion is -1"),
        ("channel --proliferation-length 0", "decay length of proliferation is 0"),
        ("channel --width -5", "--width is -5"),
        ("channel --cell-size 0", "--cell-size is 0"),
        ("channel --width 0.5 --length 1", "holds 1 cells"),
        ("channel --bins 7", "7 bins"),
        ("channel --K_P 0", "K_P is 0"),
        ("channel --samples 0", "--samples is 0"),
        ("channel --injection division --division-distance -1", "distance of a daughter"),
        ("channel --injection cycle --cycle-variation 2", "variation of cell cycles is 2"),
        ("channel --injection cycle --division-size 0", "size of a cell at its division is 0"),
        ("channel --injection cycle --division-distance 0", "distance of two daughters is 0"),
        ("channel --division-axis random", "--division-axis is given, but cells have no cycles"),
        ("channel --time -1", "duration is -1"),
        ("channel --walls both", "possible values: x"),
        ("channel --walls", "a value is required"),
        ("estimate-chirality nowhere.csv", "nowhere.csv"),
        ("estimate-chirality nowhere.csv --from -1", "--from is -1"),
    ] {
        assert_arguments_refused(arguments.split(' '), &[part]);
    }
}
