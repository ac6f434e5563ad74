//! `info`: what is in a data set or a file of another program.

use crate::program::{fixture, succeed};
use crate::refusal::{assert_arguments_refused, assert_told};
use crate::scratch::Folder;
use ndarray::{Array2, Array3, Array4};
use serde_json::{Value, json};
use std::ffi::OsStr;
use std::path::Path;

#[track_caller]
fn info(path: &Path) -> Value {
    let outcome = succeed("info --json", &[("", path)]);
    assert_eq!(outcome.stderr, "");
    serde_json::from_str(&outcome.stdout).unwrap()
}

#[track_caller]
fn assert_is(path: &Path, kind: &str, command: &str) -> Value {
    let found = info(path);
    assert_eq!(found["kind"], kind, "{found}");
    assert!(found["command"].as_str().unwrap().starts_with(&format!("voronudge {command} ")), "{found}");
    found
}

#[test]
fn every_sample_is_what_it_is() {
    let sample = |name: &str| fixture("imports").join(name);
    for name in [
        "napari-tracks.npy",
        "napari-tracks-3d.npy",
        "napari-tracks.csv",
        "savetxt.txt",
        "spreadsheet.csv",
        "cellprofiler.csv",
        "regionprops.csv",
        "manual-tracking.xls",
        "decimal-comma.csv",
    ] {
        let found = assert_is(&sample(name), "tracks of cells", "import tracks");
        assert_eq!((&found["frames"], &found["cells"]), (&json!(4), &json!(30)), "{name}");
    }
    for name in ["trackmate-spots.csv", "trackmate-model.xml", "trackmate-tracks.xml"] {
        let found = assert_is(&sample(name), "tracks of cells, from TrackMate", "import trackmate");
        assert_eq!((&found["cells"], &found["length_unit"]), (&json!(30), &json!("micron")), "{name}");
    }
    for name in ["napari-points.csv", "imagej-results.csv"] {
        let found = assert_is(&sample(name), "places of cells without tracks", "import points");
        assert_eq!((&found["frames"], &found["cells"]), (&json!(4), &Value::Null), "{name}");
    }
    for name in [
        "labels-imagej.tif",
        "labels.ome.tif",
        "labels-plain.tif",
        "series",
        "masks_seg.npy",
        "labels-slices.tif",
        "labels-zstd-tiles.tif",
    ] {
        assert_is(&sample(name), "label images", "import labels");
    }
    for name in ["pivlab.mat", "pivlab-frame.mat"] {
        assert_is(&sample(name), "table of vectors on a grid", "import flow");
    }
    let found = info(&sample("labels.ome.tif"));
    assert_eq!(found["shape"], json!([4, 60, 72]));
    assert_eq!((&found["pixel_size"], &found["length_unit"]), (&json!(0.5), &json!("µm")));
    assert_eq!((&found["frame_interval"], &found["time_unit"]), (&json!(600.0), &json!("s")));
    assert_eq!(found["present"], json!([30, 30, 30, 30]));
    assert_eq!(found["notes"][0]["kind"], "read");
    assert_eq!(info(&sample("series"))["files"].as_array().unwrap().len(), 4);
}

#[test]
fn data_sets_and_arrays_are_described() {
    let found = assert_is(&fixture("chiral-liquid"), "data set", "infer");
    assert_eq!((&found["box"], &found["cells"]), (&json!([10.0, 10.0]), &json!(100)));
    let found = assert_is(&fixture("open-field"), "data set", "infer");
    assert_eq!((&found["box"], &found["frames"]), (&Value::Null, &json!(5)));
    let folder = Folder::new();
    folder.write_array("r.npy", &Array2::from_shape_fn((9, 2), |(i, k)| (i * i + k) as f64 + 0.5));
    assert_is(&folder.file("r.npy"), "array of positions", "infer --open --positions");
    folder.write_array("v.npy", &Array4::<f64>::zeros((2, 8, 8, 2)));
    assert_is(&folder.file("v.npy"), "array of displacements or velocities on a grid", "import flow");
    folder.write_array("f.npy", &Array3::from_shape_fn((2, 8, 9), |(t, i, k)| (t + i * k) as f64 + 0.5));
    assert_is(&folder.file("f.npy"), "images that are no labels", "import field");
    folder.write("uv.txt", "x [px] y [px] u [px/frame] v [px/frame]\n0 0 1 1\n8 0 1 1\n0 8 1 1\n8 8 1 1\n");
    assert_is(&folder.file("uv.txt"), "table of vectors on a grid", "import flow");
    folder.write("corners.csv", "cell,x,y\n1,0,0\n1,1,0\n1,1,1\n2,1,0\n2,2,0\n2,2,1\n3,0,1\n3,1,1\n3,1,2\n");
    assert_is(&folder.file("corners.csv"), "outlines of cells", "import outlines");
}

#[test]
fn people_are_told_in_lines() {
    let said = succeed("info", &[("", &fixture("imports").join("labels-imagej.tif"))]).stdout;
    for line in [
        "labels-imagej.tif: label images\n",
        "  shape       4 × 60 × 72\n",
        "  cells       30, 30 in each frame\n",
        "  pixels      0.5 um\n",
        "  interval    10 min\n",
        "read: 4 frames (ImageJ); pixels of 0.5 um (ImageJ)",
        "next: voronudge import labels --link overlap ",
    ] {
        assert!(said.contains(line), "\"{line}\" is not in: {said}");
    }
    let said = succeed("info", &[("", &fixture("chiral-liquid"))]).stdout;
    assert!(said.contains("a periodic box of 10 × 10"), "{said}");
}

#[test]
fn what_is_not_read_is_answered_with_a_hint() {
    let folder = Folder::new();
    let refused = |name: &str, fact: &str, advice: &str| {
        let path = folder.file(name);
        let hint = assert_told(&[OsStr::new("info"), path.as_os_str()], &[name, fact]);
        assert!(hint.contains(advice), "{hint}");
    };
    for (name, bytes, fact) in [
        ("a.parquet", &b"PAR1\x15\x04\x00"[..], "a Parquet file"),
        ("a.mat", b"MATLAB 5.0 MAT-file\0", "a MATLAB file"),
        ("a.h5", b"\x89HDF\r\n\x1a\n", "an HDF5 file"),
        ("a.xlsx", b"PK\x03\x04", "a spreadsheet"),
    ] {
        folder.write(name, bytes);
        refused(name, fact, "comma-separated values");
    }
    refused("none.csv", "no such file", "spelling");
    // The tag of compression, of one number of two bytes, that stands for LZMA in place of Zstandard.
    let mut image = std::fs::read(fixture("imports").join("labels-zstd.tif")).unwrap();
    let tag = [3, 1, 3, 0, 1, 0, 0, 0];
    let at = tag.len() + image.windows(tag.len()).position(|own| own == tag).unwrap();
    image[at..at + 2].copy_from_slice(&34925_u16.to_le_bytes());
    folder.write("lzma.tif", image);
    refused(
        "lzma.tif",
        "is compressed by a method that is not read (Unknown(34925), page 0)",
        "compression=\"zlib\"",
    );
    std::fs::create_dir(folder.file("x.zarr")).unwrap();
    refused("x.zarr", "is a folder without .tif, .png or .npy files", "name the folder");
    folder.write("x.zarr/.zgroup", "{}");
    refused("x.zarr", "is a Zarr store (OME-Zarr or GEFF)", "tifffile.imwrite");
    for kind in ["tracks", "labels", "field", "points"] {
        let store = folder.file("x.zarr");
        assert_arguments_refused(
            [OsStr::new("import"), kind.as_ref(), store.as_os_str()],
            &["is a Zarr store"],
        );
    }
}
