//! `import` of the files of other programs: `fixtures/imports` holds one movie in all of their formats.

use crate::program::{fixture, succeed};
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, read, report};
use ndarray::{Array2, Array3};
use std::path::PathBuf;

const FRAMES: usize = 4;
const CELLS: usize = 30;

fn sample(name: &str) -> PathBuf {
    fixture("imports").join(name)
}

/// Centroids in pixels, as napari has them: rows of track, frame, y, x.
fn truth() -> Array3<f64> {
    let rows: Array2<f64> = read(&sample("napari-tracks.npy"));
    let mut truth = Array3::zeros((FRAMES, CELLS, 2));
    for row in rows.rows() {
        let (cell, frame) = (row[0] as usize - 1, row[1] as usize);
        (truth[[frame, cell, 0]], truth[[frame, cell, 1]]) = (row[3], row[2]);
    }
    truth
}

/// Imports a sample and asserts that its cells are where they should be, to `tolerance`, and that the model can be evaluated there; what
/// was said on stdout and stderr.
#[track_caller]
fn assert_imported(kind: &str, name: &str, flags: &str, scale: f64, tolerance: f64) -> (Folder, String) {
    let (data, model) = (Folder::new(), Folder::new());
    let outcome = succeed(&format!("import {kind} {flags}"), &[("", &sample(name)), ("--out", data.path())]);
    let positions: Array3<f64> = read(&data.file("positions.npy"));
    assert_eq!(positions.dim(), (FRAMES, CELLS, 2), "{name}");
    for (place, expected) in truth().indexed_iter() {
        let error = (positions[place] - expected * scale).abs();
        assert!(
            error <= tolerance,
            "{name}, {place:?}: {} instead of {}",
            positions[place],
            expected * scale
        );
    }
    succeed("evaluate --quiet --frames 1", &[("", data.path()), ("--out", model.path())]);
    (data, outcome.stdout + &outcome.stderr)
}

#[track_caller]
fn assert_said(said: &str, facts: &[&str]) {
    for fact in facts {
        assert!(said.contains(fact), "\"{fact}\" is not in: {said}");
    }
}

#[test]
fn tracks_of_napari_are_read_and_the_order_of_axes_is_said() {
    let (data, said) = assert_imported("tracks", "napari-tracks.npy", "", 1.0, 0.0);
    assert_said(&said, &["guessed: columns of the array are track, frame, y, x", "y points down"]);
    let notes = report(data.path())["notes"].clone();
    assert!(notes.as_array().unwrap().iter().any(|note| note["kind"] == "guessed"), "{notes}");
    let (_, said) = assert_imported("tracks", "napari-tracks-3d.npy", "", 1.0, 1e-5);
    assert_said(&said, &["track, frame, z, y, x", "warning: z runs from 0.1"]);
    let (_, said) = assert_imported("tracks", "napari-tracks.csv", "", 1.0, 0.0);
    assert_said(&said, &["track is \"track_id\", frame is \"t\", x is \"x\", y is \"y\""]);
}

#[test]
fn tables_of_other_programs_are_read_and_their_columns_are_said() {
    let (_, said) = assert_imported("tracks", "regionprops.csv", "--pixel-size 0.5", 0.5, 0.0);
    assert_said(
        &said,
        &["x is \"centroid-1\", y is \"centroid-0\"", "warning: \"label\" is taken for the track"],
    );
    let (_, said) = assert_imported("tracks", "cellprofiler.csv", "", 1.0, 6e-4);
    assert_said(
        &said,
        &["track is \"TrackObjects_Label_50\", frame is \"ImageNumber\", x is \"Location_Center_X\""],
    );
    let (_, said) = assert_imported("tracks", "manual-tracking.xls", "", 1.0, 0.5);
    assert_said(&said, &["track is \"Track n°\", frame is \"Slice n°\"", "Latin-1"]);
    let (data, said) = assert_imported("trackmate", "trackmate-spots.csv", "--frame-interval 10", 0.5, 6e-4);
    assert_said(&said, &["lengths in micron"]);
    assert!(std::fs::read_to_string(data.file("dataset.toml")).unwrap().contains("length_unit = \"micron\""));
}

#[test]
fn tables_separated_and_encoded_in_other_ways_are_read() {
    let (_, said) = assert_imported("tracks", "savetxt.txt", "", 1.0, 6e-5);
    assert_said(&said, &["track is \"track\""]);
    let (data, said) = assert_imported("tracks", "spreadsheet.csv", "", 0.5, 6e-5);
    assert_said(&said, &["the text is in UTF-16", "lengths in µm", "x is \"x [µm]\""]);
    assert!(std::fs::read_to_string(data.file("dataset.toml")).unwrap().contains("length_unit = \"µm\""));
}

#[test]
fn coordinates_that_are_scaled_already_are_not_scaled_again_without_a_word() {
    let (_, said) = assert_imported("tracks", "spreadsheet.csv", "--pixel-size 0.5", 0.25, 6e-5);
    assert_said(&said, &["warning: the file is in µm already"]);
}

#[test]
fn arrays_that_are_no_tracks_are_refused() {
    let folder = Folder::new();
    folder.write_array("a.npy", &Array3::<f64>::zeros((2, 3, 2)));
    folder.write_array("b.npy", &ndarray::array![[1.0, 0.0, 2.0, 3.0], [1.0, 0.5, 2.0, 3.0]]);
    folder.write_array("c.npy", &ndarray::array![[1.0, 0.0, 2.0, f64::NAN]]);
    for (name, facts) in [
        ("a.npy", ["(2, 3, 2)", "track, frame, (z,) y, x"]),
        ("b.npy", ["row 1, column 1 (from zero) is 0.5", "a whole number"]),
        ("c.npy", ["row 0, column 3 (from zero) is NaN", "a finite number"]),
    ] {
        assert_arguments_refused(
            ["import".as_ref(), "tracks".as_ref(), folder.file(name).as_os_str()],
            &facts,
        );
    }
}

#[test]
fn files_of_trackmate_bring_their_units() {
    for kind in ["trackmate", "tracks"] {
        for name in ["trackmate-model.xml", "trackmate-tracks.xml"] {
            let (data, said) = assert_imported(kind, name, "", 0.5, 6e-4);
            assert_said(
                &said,
                &["read: ", "lengths in micron (TrackMate); 10 min between frames (TrackMate)"],
            );
            let settings = std::fs::read_to_string(data.file("dataset.toml")).unwrap();
            for line in ["frame_interval = 10", "length_unit = \"micron\"", "time_unit = \"min\""] {
                assert!(settings.contains(line), "{settings}");
            }
        }
    }
    let (data, said) = assert_imported("trackmate", "trackmate-model.xml", "--image-size 36 30", 0.5, 6e-4);
    assert_said(
        &said,
        &["3 without a track left out", "1 tracks that its filters hide", "the image is 36 × 30 micron"],
    );
    assert!(std::fs::read_to_string(data.file("dataset.toml")).unwrap().contains("field_of_view"));
    let (_, said) = assert_imported("trackmate", "trackmate-tracks.xml", "--frame-interval 5", 0.5, 6e-4);
    assert_said(&said, &["warning: --frame-interval 5 is taken, but the file says 10 min (TrackMate)"]);
}

#[test]
fn points_without_tracks_are_followed() {
    let (data, said) = assert_imported("points", "napari-points.csv", "", 1.0, 0.0);
    assert_said(
        &said,
        &[
            "120 points in 4 frames, 30 cells (90 followed from the frame before)",
            "frame is \"axis-0\", x is \"axis-2\", y is \"axis-1\"",
            "cells move by no more than 5.",
        ],
    );
    assert_eq!(report(data.path())["linked"], 90);
    let (_, said) = assert_imported("points", "imagej-results.csv", "--length-unit um", 0.5, 6e-4);
    assert_said(&said, &["frame is \"Slice\", x is \"X\", y is \"Y\""]);
    assert_imported("points", "regionprops.csv", "--link-limit 3", 1.0, 0.0);
    assert_imported("points", "cellprofiler.csv", "", 1.0, 6e-4);
    // Nearer than cells move: they begin anew.
    let data = Folder::new();
    let paths = [("", &*sample("napari-points.csv")), ("--out", data.path())];
    let said = succeed("import points --link-limit 0.001", &paths).stderr;
    assert_said(&said, &["points after the first frame continue none of the frame before"]);
}

#[test]
fn arrays_of_points_are_those_of_napari() {
    let tracks: Array2<f64> = read(&sample("napari-tracks.npy"));
    let folder = Folder::new();
    let still: Vec<_> =
        tracks.rows().into_iter().filter(|row| row[1] == 0.0).flat_map(|row| [row[2], row[3]]).collect();
    folder.write_array("still.npy", &Array2::from_shape_vec((CELLS, 2), still).unwrap());
    folder.write_array("film.npy", &tracks.select(ndarray::Axis(1), &[1, 2, 3]));
    for (name, frames, order) in [("still.npy", 1, "y, x"), ("film.npy", FRAMES, "frame, y, x")] {
        let data = Folder::new();
        let said = succeed("import points", &[("", &folder.file(name)), ("--out", data.path())]).stdout;
        assert_said(&said, &[&format!("columns of the array are {order}, as in a points layer of napari")]);
        let positions: Array3<f64> = read(&data.file("positions.npy"));
        assert_eq!(positions.dim(), (frames, CELLS, 2));
        assert_eq!(positions[[0, 7, 0]], truth()[[0, 7, 0]]);
        assert_eq!(said.contains("at a time of 1"), frames > 1);
    }
}

#[test]
fn tables_without_tracks_are_shown_the_way() {
    let table = sample("imagej-results.csv");
    let hint = assert_arguments_refused(
        ["import".as_ref(), "tracks".as_ref(), table.as_os_str()],
        &["line 2: column \"Label\" holds \"cells.tif:1/4\", which is no number of a track"],
    );
    assert!(hint.contains("import points"), "{hint}");
    let table = sample("napari-points.csv");
    let hint = assert_arguments_refused(
        ["import".as_ref(), "tracks".as_ref(), table.as_os_str()],
        &["no column for the track"],
    );
    assert!(hint.contains("import points"), "{hint}");
    let folder = Folder::new();
    folder.write("points.csv", "x,y\n1,2\n1,2\n3,4\n");
    let table = folder.file("points.csv");
    assert_arguments_refused(
        ["import".as_ref(), "points".as_ref(), table.as_os_str()],
        &["points.csv", "both at (1, 2)"],
    );
}
