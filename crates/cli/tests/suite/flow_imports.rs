//! `import flow`: displacements on a grid become data sets, and other commands read them.

use crate::program::succeed;
use crate::refusal::{assert_arguments_refused, assert_unreadable};
use crate::scratch::{Folder, number, read, report};
use flate2::Compression;
use flate2::write::GzEncoder;
use ndarray::{Array1, Array2, Array3, Array4, Axis};
use std::ffi::{OsStr, OsString};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

const PIXELS: usize = 40;
const SCALE: &str = "--pixel-size 0.5 --frame-interval 2 --length-unit um --time-unit min";

/// A vortex in each of two frames, the second twice as fast, in pixels per frame.
///
/// On the screen, y down, it turns clockwise about the middle of the image.
fn vortices() -> Array4<f32> {
    Array4::from_shape_fn((2, PIXELS, PIXELS, 2), |(frame, row, column, axis)| {
        let middle = PIXELS as f32 / 2.0 - 0.5;
        let (x, y) = (column as f32 - middle, row as f32 - middle);
        (frame + 1) as f32 * if axis == 0 { -y } else { x }
    })
}

/// The same vortex as a table of points 8 pixels apart, each row from this function.
fn vectors(row: impl Fn(usize, [f64; 4]) -> String) -> String {
    let mut text = String::new();
    for index in 0..16 {
        let [x, y] = [index % 4, index / 4].map(|step| 8.0 * step as f64 + 8.0);
        let _ = writeln!(text, "{}", row(index, [x, y, -(y - 20.0), x - 20.0]));
    }
    text
}

/// Cells of two frames on a shaken grid within the image, in units of 0.5 per pixel, y down.
fn cells() -> Array3<f64> {
    Array3::from_shape_fn((2, 36, 2), |(frame, cell, axis)| {
        let shake = (12.9 * (cell + 40 * axis) as f64).sin() + 0.1 * frame as f64;
        let place = [cell % 6, cell / 6][axis] as f64;
        1.5 + 3.2 * place + 0.4 * shake
    })
}

/// ∑ r × v about the middle of the grid with y up: negative where the flow turns clockwise.
fn sense(folder: &Path) -> f64 {
    let flow: Array4<f64> = read(&folder.join("flow.npy"));
    let [x, y] = ["flow_x.npy", "flow_y.npy"].map(|name| {
        let coordinates: Array1<f64> = read(&folder.join(name));
        coordinates - 10.0
    });
    let mut sum = 0.0;
    for ((_, row, column), vx) in flow.index_axis(Axis(3), 0).indexed_iter() {
        let vy = flow.index_axis(Axis(3), 1)[[0, row, column]];
        // What is stored points down.
        sum += x[column] * -vy - -y[row] * vx;
    }
    sum
}

fn gzip(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

/// Asserts that a command reads the flow of a data set.
#[track_caller]
fn assert_read_by_others(data: &Path) {
    let model = Folder::new();
    succeed("evaluate --frames 0 --quiet", &[("", data), ("--out", model.path())]);
    let model = report(model.path());
    let inputs = model["inputs"].as_array().unwrap();
    for name in ["flow.npy", "flow_x.npy", "flow_y.npy"] {
        assert!(
            inputs.iter().any(|input| input["path"].as_str().unwrap().ends_with(name)),
            "{name}: {inputs:?}"
        );
    }
}

#[test]
fn dense_flows_become_data_sets() {
    let (source, data) = (Folder::new(), Folder::new());
    source.write_array("flow.npy", &vortices());
    source.write_array("cells.npy", &cells());
    let paths: [(&str, &Path); 3] =
        [("", &source.file("flow.npy")), ("--positions", &source.file("cells.npy")), ("--out", data.path())];
    let outcome = succeed(&format!("import flow {SCALE} --grid-spacing 2.5"), &paths);
    assert!(outcome.stdout.contains("2 frames of 8 × 8 grid points, 2.5 × 2.5 um apart"), "{outcome:?}");
    assert!(!outcome.stdout.contains("positions.npy"), "{outcome:?}");
    let names = ["dataset.toml", "flow.npy", "flow_x.npy", "flow_y.npy", "positions.npy", "report.json"];
    assert_eq!(data.names(), names);
    let flow: Array4<f64> = read(&data.file("flow.npy"));
    let y: Array1<f64> = read(&data.file("flow_y.npy"));
    assert_eq!((flow.dim(), y[0], y[7]), ((2, 8, 8, 2), 1.25, 18.75));
    // The mean over rows 0 to 4 is that of row 2, 17.5 pixels above the middle.
    assert_eq!((flow[[0, 0, 3, 0]], flow[[1, 0, 3, 0]]), (17.5 * 0.25, 17.5 * 0.5));
    let settings = std::fs::read_to_string(data.file("dataset.toml")).unwrap();
    assert!(settings.contains("y_axis = \"down\"") && settings.contains("boundary = \"open\""), "{settings}");
    let positions: Array3<f64> = read(&data.file("positions.npy"));
    assert_eq!(positions, cells());
    let report = report(data.path());
    assert_eq!(report["spacing"], serde_json::json!([2.5, 2.5]));
    for (name, value) in
        [("frames", 2.0), ("rows", 8.0), ("columns", 8.0), ("missing_points", 0.0), ("cells", 36.0)]
    {
        assert_eq!(number(&report, &format!("/{name}")), value, "{name}");
    }
    assert_eq!(report["inputs"].as_array().unwrap().len(), 2);
    assert_read_by_others(data.path());
}

#[test]
fn a_vortex_keeps_its_sense() {
    let (source, array, table) = (Folder::new(), Folder::new(), Folder::new());
    source.write_array("flow.npy", &vortices().index_axis_move(Axis(0), 0));
    succeed("import flow --pixel-size 0.5", &[("", &source.file("flow.npy")), ("--out", array.path())]);
    assert!(sense(array.path()) < -1000.0, "{}", sense(array.path()));
    let text = vectors(|_, [x, y, u, v]| format!("{x} {y} {u} {v}"));
    let file = source.write("piv.txt", text);
    succeed("import flow --pixel-size 0.5", &[("", &file), ("--out", table.path())]);
    assert!(sense(table.path()) < -100.0, "{}", sense(table.path()));
}

#[test]
fn tables_of_vectors_become_data_sets() {
    let header = "# x\ty\tu\tv\tflags\tmask\n".to_owned();
    let masked = |index| u8::from(index == 5);
    let openpiv =
        header + &vectors(|index, [x, y, u, v]| format!("{x}\t{y}\t{u}\t{v}\t0\t{}", masked(index)));
    let pivlab = "x [px],y [px],u [px/frame],v [px/frame]\n".to_owned()
        + &vectors(|index, [x, y, u, v]| match masked(index) {
            1 => format!("{x},{y},NaN,NaN"),
            _ => format!("{x},{y},{u},{v}"),
        });
    let mut shuffled: Vec<&str> = openpiv.lines().skip(1).collect();
    shuffled.sort_unstable();
    let shuffled = format!("x\ty\tu\tv\tflags\tmask\n{}\n", shuffled.join("\n"));
    for (name, content) in [
        ("a.txt", openpiv.clone().into_bytes()),
        ("b.csv", pivlab.into_bytes()),
        ("c.dat", shuffled.into_bytes()),
        ("d.txt.gz", gzip(&openpiv)),
    ] {
        let (source, data) = (Folder::new(), Folder::new());
        let table = source.write(name, content);
        let outcome = succeed(&format!("import flow {SCALE}"), &[("", &table), ("--out", data.path())]);
        assert_eq!(outcome.stderr, "", "{name}");
        let flow: Array4<f64> = read(&data.file("flow.npy"));
        assert_eq!(
            (flow.dim(), flow[[0, 3, 0, 0]], flow[[0, 3, 0, 1]]),
            ((1, 4, 4, 2), -3.0, -3.0),
            "{name}"
        );
        assert!(flow[[0, 1, 1, 0]].is_nan(), "{name}");
        let x: Array1<f64> = read(&data.file("flow_x.npy"));
        assert_eq!(x.to_vec(), [4.0, 8.0, 12.0, 16.0], "{name}");
        assert_eq!(number(&report(data.path()), "/missing_points"), 1.0, "{name}");
    }
}

#[test]
fn several_files_are_frames_and_what_is_missing_is_said() {
    let (source, data) = (Folder::new(), Folder::new());
    for (frame, name) in ["first.npy", "second.npy"].into_iter().enumerate() {
        source.write_array(name, &vortices().index_axis_move(Axis(0), frame));
    }
    let files = [("", source.file("first.npy")), ("", source.file("second.npy"))];
    let mut paths: Vec<(&str, &Path)> = files.iter().map(|(name, path)| (*name, path.as_path())).collect();
    paths.push(("--out", data.path()));
    let outcome = succeed(&format!("import flow {SCALE} --grid-spacing 5"), &paths);
    let told = "still missing: positions.npy of shape (2, cells, 2), in um with y down";
    assert!(outcome.stdout.contains(told), "{outcome:?}");
    assert_eq!(data.names(), ["dataset.toml", "flow.npy", "flow_x.npy", "flow_y.npy", "report.json"]);
    assert_eq!(report(data.path())["cells"], serde_json::Value::Null);
    assert_unreadable(data.path(), &[], &["positions.npy", "no such file"]);
    data.write_array("positions.npy", &cells());
    assert_read_by_others(data.path());
    // Once the positions are there, they stay.
    let outcome = succeed(&format!("import flow {SCALE} --grid-spacing 4"), &paths);
    assert!(outcome.stdout.contains("positions.npy stays as it was"), "{outcome:?}");
    assert_read_by_others(data.path());
}

#[test]
fn what_should_be_known_is_warned_of() {
    let (source, data) = (Folder::new(), Folder::new());
    source.write_array("flow.npy", &Array3::<f32>::zeros((400, 300, 2)));
    let outcome = succeed("import flow", &[("", &source.file("flow.npy")), ("--out", data.path())]);
    assert!(outcome.stderr.contains("warning: 120000 grid points"), "{outcome:?}");
    let table =
        "x [m],y [m],u [m/s],v [m/s]\n".to_owned() + &vectors(|_, [x, y, u, v]| format!("{x},{y},{u},{v}"));
    let table = source.write("calibrated.csv", table);
    for (flags, warnings) in [("", 0), ("--frame-interval 2", 1)] {
        succeed(&format!("import flow {flags}"), &[("", &table), ("--out", data.path())]);
        let report = report(data.path());
        let told = report["warnings"].as_array().unwrap();
        assert_eq!(told.len(), warnings, "{told:?}");
        assert!(told.iter().all(|text| text.as_str().unwrap().contains("displacements in m/s")), "{told:?}");
    }
}

#[test]
fn units_of_pivlab_are_taken_and_told() {
    let (source, data) = (Folder::new(), Folder::new());
    let preface = "PIVlab by W.Th. & E.J.S., ASCII chart output - 26-Nov-2026 12:00:00\n\
                   FRAME: 1, filenames: A & B, conversion factor xy (px -> m): 0.001, conversion factor uv (px/frame -> m/s): 0.01\n";
    let rows = vectors(|_, [x, y, u, v]| format!("{x},{y},{u},{v},1"));
    for (header, length, time, told) in [
        ("x [m],y [m],u [m/s],v [m/s],Vector type [-]", "m", "s", "read: lengths in m, velocities in m/s"),
        ("x [px],y [px],u [px/frame],v [px/frame],Vector type [-]", "px", "frame", "u is \"u [px/frame]\""),
        (
            "x [mm],y [mm],u [m/s],v [m/s],Vector type [-]",
            "mm",
            "s",
            "warning: places are in mm, but displacements in m",
        ),
    ] {
        let table = source.write("piv.txt", format!("{preface}{header}\n{rows}"));
        let outcome = succeed("import flow", &[("", &table), ("--out", data.path())]);
        let said = outcome.stdout + &outcome.stderr;
        assert!(said.contains(told), "{told}: {said}");
        let settings = std::fs::read_to_string(data.file("dataset.toml")).unwrap();
        for line in [format!("length_unit = \"{length}\""), format!("time_unit = \"{time}\"")] {
            assert!(settings.contains(&line), "{line}: {settings}");
        }
    }
    let table = source.file("piv.txt");
    succeed(&format!("import flow {SCALE}"), &[("", &table), ("--out", data.path())]);
    assert!(std::fs::read_to_string(data.file("dataset.toml")).unwrap().contains("length_unit = \"um\""));
}

#[track_caller]
fn assert_flow_refused(paths: &[(&str, &Path)], flags: &[&str], facts: &[&str]) {
    let paths = paths.iter().flat_map(|(name, path)| [OsStr::new(name), path.as_os_str()]);
    let words = ["import", "flow"].into_iter().chain(flags.iter().copied()).map(OsString::from);
    let arguments = words.chain(paths.filter(|word| !word.is_empty()).map(OsString::from));
    assert_arguments_refused(arguments, facts);
}

#[test]
fn bad_flows_are_refused() {
    let source = Folder::new();
    source.write_array("flow.npy", &vortices());
    source.write_array("cells.npy", &cells());
    source.write_array("flat.npy", &Array2::<f64>::zeros((4, 4)));
    let [flow, positions, flat] = ["flow.npy", "cells.npy", "flat.npy"].map(|name| source.file(name));
    let table = source.write("piv.txt", vectors(|_, [x, y, u, v]| format!("{x} {y} {u} {v}")));
    let off = vectors(|index, [x, y, u, v]| match index {
        6 => format!("{x} {} {u} {v}", y + 3.0),
        _ => format!("{x} {y} {u} {v}"),
    });
    let off = source.write("off.txt", off);
    let text = source.write("note.txt", "nothing of use\n");
    let cut = std::fs::read(&flow).unwrap();
    let cut = source.write("cut.npy", &cut[..cut.len() - 4]);
    let gone = source.file("gone.npy");
    assert_flow_refused(&[], &[], &["<FILE>"]);
    assert_flow_refused(&[("", &gone)], &[], &["gone.npy", "no such file"]);
    assert_flow_refused(&[("", &flat)], &[], &["flat.npy", "shape (4, 4)"]);
    assert_flow_refused(&[("", &cut)], &[], &["cut.npy", "truncated"]);
    assert_flow_refused(&[("", &text)], &[], &["note.txt, line 1", "no column for the x coordinate"]);
    assert_flow_refused(&[("", &off)], &[], &["off.txt, line 7", "y is 19"]);
    assert_flow_refused(&[("", &table), ("", &flow)], &[], &["flow.npy", "is an array after tables"]);
    assert_flow_refused(&[("", &flow), ("", &flow)], &[], &["flow.npy", "2 frames"]);
    assert_flow_refused(&[("", &flow)], &["--grid-spacing", "-1"], &["grid_spacing is -1"]);
    assert_flow_refused(&[("", &flow)], &["--grid-spacing", "30"], &["40 pixels of 1"]);
    assert_flow_refused(&[("", &flow)], &["--x-column", "x"], &["flow.npy", "columns"]);
    assert_flow_refused(&[("", &flow)], &["--box", "20", "40"], &["flow.npy", "extends over 39 along x"]);
    assert_flow_refused(&[("", &table)], &["--grid-spacing", "8"], &["piv.txt", "grid spacing"]);
    assert_flow_refused(&[("", &table)], &["--u-column", "dx"], &["piv.txt, line 1", "no header"]);
    let facts = ["piv.txt", "number of frames is 1", "positions is 2"];
    assert_flow_refused(&[("", &table), ("--positions", &positions)], &[], &facts);
}

#[test]
fn flow_files_of_data_sets_are_checked_by_every_command() {
    let data = Folder::copy_of("chiral-liquid");
    let field = |ny, nx| Array3::<f64>::from_elem((ny, nx, 2), 0.5);
    data.write_array("flow.npy", &field(3, 4));
    assert_unreadable(data.path(), &[], &["flow.npy", "x coordinates", "flow_x.npy"]);
    data.write_array("flow_x.npy", &Array1::from_iter([0.0, 1.0, 2.0, 3.0]));
    data.write_array("flow_y.npy", &Array1::from_iter([0.0, 1.0, 2.5]));
    assert_unreadable(data.path(), &[], &["flow_y.npy", "y coordinate 1 is 1, on an even grid it is 1.25"]);
    data.write_array("flow_y.npy", &Array1::from_iter([0.0, 1.0, 2.0]));
    assert_read_by_others(data.path());
    data.write_array("other.npy", &field(4, 3));
    let other = data.file("other.npy").display().to_string();
    assert_unreadable(
        data.path(),
        &["--flow", &other],
        &["flow_x.npy", "4 x coordinates", "3 points along x"],
    );
    assert_unreadable(data.path(), &["--flow-y", &other], &["other.npy", "shape (4, 3, 2)", "(ny,)"]);
    let flow_x = data.file("flow_x.npy").display().to_string();
    assert_unreadable(data.path(), &["--flow-y", &flow_x], &["flow_x.npy", "4 y coordinates"]);
    let mut half = field(3, 4);
    half[[2, 1, 0]] = f64::NAN;
    data.write_array("flow.npy", &half);
    assert_unreadable(data.path(), &[], &["flow.npy: frame 0, row 2, column 1: half missing"]);
    half[[2, 1, 0]] = f64::INFINITY;
    data.write_array("flow.npy", &half);
    assert_unreadable(data.path(), &[], &["flow.npy: frame 0, row 2, column 1: infinite value"]);
    data.write_array("flow.npy", &Array4::<f64>::zeros((2, 3, 4, 2)));
    assert_unreadable(data.path(), &[], &["flow.npy", "number of frames is 2"]);
    data.write_array("flow.npy", &field(3, 4));
    data.write_array("flow_x.npy", &Array1::from_iter([0.0, 10.0, 20.0, 30.0]));
    assert_unreadable(data.path(), &[], &["flow_x.npy", "extends over 30 along x"]);
    data.remove("flow.npy");
    assert_unreadable(data.path(), &[], &["flow_x.npy", "no flow field"]);
}
