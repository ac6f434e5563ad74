//! `import`: tables of tracks become data sets.

use crate::program::succeed;
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, number, read, report};
use flate2::Compression;
use flate2::write::GzEncoder;
use ndarray::Array3;
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

const FRAMES: usize = 4;
const SIDE: usize = 9;

/// Place of a cell of a shaken, drifting grid, y down.
fn place(frame: usize, cell: usize) -> [f64; 2] {
    let (t, k) = (frame as f64, cell as f64);
    let shake = |phase: f64| 0.2 * (phase + 12.9 * k + 0.1 * t * (1.0 + (7.0 * k).sin())).sin();
    let (column, row) = ((cell % SIDE) as f64, (cell / SIDE) as f64);
    [column + 0.5 * (row % 2.0) + shake(0.0), 0.9 * row + shake(1.3)]
}

/// One row for each cell and frame.
fn rows(mut row: impl FnMut(usize, usize, [f64; 2]) -> String) -> String {
    let mut text = String::new();
    for frame in 0..FRAMES {
        for cell in 0..SIDE * SIDE {
            let _ = writeln!(text, "{}", row(frame, cell, place(frame, cell)));
        }
    }
    text
}

fn tracks() -> String {
    format!("track,frame,x,y\n{}", rows(|frame, cell, [x, y]| format!("{},{frame},{x},{y}", cell + 10)))
}

/// The layout of TrackMate 7, with a spot that belongs to no track.
fn trackmate() -> String {
    let spots = rows(|frame, cell, [x, y]| format!("ID{cell},{cell},{},1.0,{x},{y},{frame}", cell + 10));
    format!(
        "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,FRAME\n\
         Label,Spot ID,Track ID,Quality,X,Y,Frame\n\
         Label,Spot ID,Track ID,Quality,X,Y,Frame\n\
         ,,,(quality),(micron),(micron),\n\
         {spots}ID9,999,,1.0,3.3,3.3,0\n"
    )
}

fn gzip(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

/// Imports a table and asserts that other commands read the result.
#[track_caller]
fn assert_imported(kind: &str, name: &str, content: &[u8]) -> Folder {
    let (source, data) = (Folder::new(), Folder::new());
    let table = source.write(name, content);
    let flags = "--frame-interval 2 --length-unit um --time-unit min";
    succeed(&format!("import {kind} {flags}"), &[("", &table), ("--out", data.path())]);
    assert_eq!(data.names(), ["dataset.toml", "positions.npy", "report.json"]);
    let positions: Array3<f64> = read(&data.file("positions.npy"));
    assert_eq!(positions.dim(), (FRAMES, SIDE * SIDE, 2));
    for ((frame, cell, axis), &value) in positions.indexed_iter() {
        assert_eq!(value, place(frame, cell)[axis], "frame {frame}, cell {cell}");
    }
    let report = report(data.path());
    assert_eq!(number(&report, "/tracks"), (SIDE * SIDE) as f64);
    assert_eq!(number(&report, "/track_ids/0"), 10.0);
    assert_read_by_others(data.path());
    data
}

#[track_caller]
fn assert_read_by_others(data: &Path) {
    let (model, fit) = (Folder::new(), Folder::new());
    succeed("evaluate --quiet", &[("", data), ("--out", model.path())]);
    let noise = "--position-noise 20% --velocity-noise 50%";
    succeed(&format!("infer --fix K_A=0.1 --quiet {noise}"), &[("", data), ("--out", fit.path())]);
    let fit = report(fit.path());
    assert_eq!(fit["cells"]["frames"], serde_json::json!([0, 1, 2, 3]));
    assert_eq!(fit["units"], serde_json::json!({"length": "um", "time": "min"}));
}

#[test]
fn tables_of_tracks_become_data_sets() {
    assert_imported("tracks", "tracks.csv", tracks().as_bytes());
    assert_imported("tracks", "tracks.csv.gz", &gzip(&tracks()));
}

#[test]
fn tables_of_trackmate_become_data_sets() {
    for (name, content) in [("spots.csv", trackmate().into_bytes()), ("spots.csv.gz", gzip(&trackmate()))] {
        let data = assert_imported("trackmate", name, &content);
        assert_eq!(number(&report(data.path()), "/left_out_untracked"), 1.0);
    }
}

#[test]
fn lengths_are_scaled_by_the_pixel() {
    let (source, data) = (Folder::new(), Folder::new());
    let table = source.write("tracks.csv", tracks());
    succeed("import tracks --pixel-size 0.5", &[("", &table), ("--out", data.path())]);
    let positions: Array3<f64> = read(&data.file("positions.npy"));
    assert_eq!(positions[[2, 7, 0]], 0.5 * place(2, 7)[0]);
}

#[track_caller]
fn assert_table_refused(kind: &str, content: &[u8], flags: &[&str], facts: &[&str]) {
    let source = Folder::new();
    let table = source.write("cells.csv", content);
    let arguments = ["import".as_ref(), OsStr::new(kind), table.as_os_str()];
    assert_arguments_refused(arguments.into_iter().chain(flags.iter().map(OsStr::new)), facts);
}

#[test]
fn columns_that_are_missing_are_named() {
    let without = tracks().replacen("track,frame,x,y", "track,when,x,y", 1);
    let facts = ["cells.csv", "no column for the frame", "found track, when, x, y"];
    assert_table_refused("tracks", without.as_bytes(), &[], &facts);
    for (bytes, kind) in
        [(&b" {\"x\": [1, 2]}"[..], "JSON"), (b"PAR1\x15\x04\x00", "a Parquet file"), (b"<?xml ?>", "XML")]
    {
        assert_table_refused("tracks", bytes, &[], &["cells.csv", kind]);
    }
    let facts = ["cells.csv", "no column for the track", "number"];
    assert_table_refused("tracks", tracks().as_bytes(), &["--track-column", "number"], &facts);
    let without = trackmate().replace("TRACK_ID", "OTHER");
    assert_table_refused("trackmate", without.as_bytes(), &[], &["cells.csv", "no column for the track"]);
}

#[test]
fn faulty_tables_are_refused_with_their_line() {
    let table = "track,frame,x,y\n1,0,0.0,0.0\n2,0,east,0.0\n";
    assert_table_refused("tracks", table.as_bytes(), &[], &["cells.csv, line 3", "\"east\""]);
    let table = "track,frame,x,y\n1,0,0.0\n";
    assert_table_refused("tracks", table.as_bytes(), &[], &["cells.csv, line 2", "3 fields"]);
    assert_table_refused("tracks", b"", &[], &["cells.csv", "empty"]);
    assert_table_refused("tracks", b"track,frame,x,y\n", &[], &["cells.csv", "no data rows"]);
    let cut = gzip(&tracks());
    assert_table_refused("tracks", &cut[..cut.len() / 2], &[], &["cells.csv", "decompressed"]);
}
