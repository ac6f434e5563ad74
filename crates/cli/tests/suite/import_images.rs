//! `import labels` and `import field` of images that say something of themselves, and of series of files.

use crate::program::{fixture, succeed};
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array2, Array3};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

fn sample(name: &str) -> PathBuf {
    fixture("imports").join(name)
}

/// Imports labels; the data set and what was said.
#[track_caller]
fn import(files: &[&Path], flags: &str) -> (Folder, String) {
    let data = Folder::new();
    let files = files.iter().map(|file| ("", *file));
    let paths: Vec<_> = files.chain([("--out", data.path())]).collect();
    let outcome = succeed(&format!("import labels --link labels {flags}"), &paths);
    (data, outcome.stdout + &outcome.stderr)
}

#[track_caller]
fn assert_said(said: &str, facts: &[&str]) {
    for fact in facts {
        assert!(said.contains(fact), "\"{fact}\" is not in: {said}");
    }
}

/// Centroids in pixels; those of images are half a pixel more than those of scikit-image. Cells near the border are at their sites, which are not far.
#[track_caller]
fn assert_places(data: &Folder, frames: usize, scale: f64) {
    let rows: Array2<f64> = read(&sample("napari-tracks.npy"));
    let positions: Array3<f64> = read(&data.file("positions.npy"));
    assert_eq!(positions.dim(), (frames, 30, 2));
    let (mut at_centroids, mut all) = (0, 0);
    for row in rows.rows().into_iter().filter(|row| row[1] < frames as f64) {
        let (cell, frame) = (row[0] as usize - 1, row[1] as usize);
        let off = |axis: usize| positions[[frame, cell, axis]] / scale - (row[3 - axis] + 0.5);
        let off = off(0).hypot(off(1));
        assert!(off < 3.0, "{frame}, {cell}: {off}");
        at_centroids += usize::from(off < 1e-9);
        all += 1;
    }
    assert!(3 * at_centroids > all, "{at_centroids} of {all}");
}

#[test]
fn pixels_and_intervals_of_imagej_and_ome_are_taken_and_told() {
    for (name, unit, interval, time, by) in
        [("labels-imagej.tif", "um", "10", "min", "ImageJ"), ("labels.ome.tif", "µm", "600", "s", "OME")]
    {
        let (data, said) = import(&[&sample(name)], "");
        let pixels = format!(
            "read: 4 frames ({by}); pixels of 0.5 {unit} ({by}); {interval} {time} between frames ({by})"
        );
        assert_said(&said, &[&pixels, "guessed: y points down"]);
        assert_places(&data, 4, 0.5);
        let settings = fs::read_to_string(data.file("dataset.toml")).unwrap();
        assert_said(
            &settings,
            &[
                &format!("frame_interval = {interval}"),
                &format!("length_unit = \"{unit}\""),
                &format!("time_unit = \"{time}\""),
                "field_of_view = [0.0, 0.0, 36.0, 30.0]",
            ],
        );
        let model = Folder::new();
        succeed("evaluate --quiet", &[("", data.path()), ("--out", model.path())]);
        assert_eq!(report(data.path())["notes"][0]["kind"], "read");
    }
    let (data, said) = import(&[&sample("labels-plain.tif")], "");
    assert_said(&said, &["guessed: no unit of length is stated; frames follow each other at a time of 1"]);
    assert_places(&data, 4, 1.0);
}

#[test]
fn options_that_contradict_an_image_are_told() {
    let (data, said) =
        import(&[&sample("labels.ome.tif")], "--pixel-size 0.65 --frame-interval 5 --time-unit min");
    assert_said(
        &said,
        &[
            "warning: --pixel-size 0.65 is taken, but the file says 0.5 µm (OME)",
            "warning: --frame-interval 5 is taken, but the file says 600 s (OME)",
        ],
    );
    assert_places(&data, 4, 0.65);
    assert_eq!(report(data.path())["warnings"].as_array().unwrap().len(), 2);
    // Ten minutes are 600 seconds, and micrometres have several names.
    let flags = "--pixel-size 0.5 --length-unit um --frame-interval 10 --time-unit min";
    let (_, said) = import(&[&sample("labels.ome.tif")], flags);
    assert!(!said.contains("warning"), "{said}");
    let (_, said) = import(&[&sample("labels-imagej.tif")], "--length-unit nm");
    assert_said(&said, &["warning: --length-unit nm is taken, but the file says um (ImageJ)"]);
}

#[test]
fn stacks_of_slices_are_warned_of_and_planes_of_colours_explained() {
    let (_, said) = import(&[&sample("labels-slices.tif")], "");
    assert_said(&said, &["warning: 2 slices along z (ImageJ) are taken for frames in time"]);
    let planes = sample("labels-planes.tif");
    let arguments = ["import".as_ref(), "labels".as_ref(), planes.as_os_str()];
    let hint = assert_arguments_refused(
        arguments,
        &["labels-planes.tif", "4 frames as the planes of a colour image"],
    );
    assert!(hint.contains("photometric"), "{hint}");
}

#[test]
fn files_of_a_folder_are_frames_in_the_order_of_their_numbers() {
    let (data, said) = import(&[&sample("series")], "--pixel-size 0.5 --length-unit um");
    assert_said(
        &said,
        &[
            "guessed: 4 files are frames in the order of their numbers, from t1_cp_masks.tif to t10_cp_masks.tif",
            "warning: files are not evenly numbered (after 2 comes 9)",
        ],
    );
    assert_places(&data, 4, 0.5);
    assert_eq!(report(data.path())["inputs"].as_array().unwrap().len(), 4);
    // A shell puts t10 before t2.
    let files = ["t10", "t1", "t2", "t9"].map(|name| sample(&format!("series/{name}_cp_masks.tif")));
    let (data, _) = import(&files.iter().map(PathBuf::as_path).collect::<Vec<_>>(), "");
    assert_places(&data, 4, 1.0);
}

#[test]
fn masks_are_told_from_images_in_one_folder() {
    let folder = Folder::new();
    for name in ["t1", "t2"] {
        let mask = fs::read(sample(&format!("series/{name}_cp_masks.tif"))).unwrap();
        folder.write(&format!("{name}_cp_masks.tif"), &mask);
        let bumps = |(row, column): (usize, usize)| (row as f64 / 2.0).sin() * (column as f64 / 2.0).sin();
        folder.write_array(&format!("{name}.npy"), &Array2::from_shape_fn((60, 72), bumps));
    }
    folder.write("notes.txt", "");
    let (data, said) = import(&[folder.path()], "");
    assert_said(&said, &["of the folder *_cp_masks.tif; 3 other files are left out"]);
    assert_places(&data, 2, 1.0);
    let field = Folder::new();
    let said = succeed("import field", &[("", folder.path()), ("--out", field.path())]).stdout;
    assert_said(&said, &["of the folder *.npy; 3 other files are left out", "from t1.npy to t2.npy"]);
    assert_eq!(number(&report(field.path()), "/size/0"), 72.0);
}

#[test]
fn series_that_cannot_be_meant_are_refused() {
    let folder = Folder::new();
    let refused = |facts: &[&str]| {
        assert_arguments_refused([OsStr::new("import"), "labels".as_ref(), folder.path().as_os_str()], facts)
    };
    refused(&["is a folder without .tif, .png or .npy files"]);
    let label = |side: usize| {
        Array2::from_shape_fn((side, side), |(row, column)| (1 + row / 4 * 9 + column / 4) as i32)
    };
    folder.write_array("a1.npy", &label(12));
    folder.write_array("a2.npy", &label(16));
    refused(&["a2.npy", "16 × 16 pixels, but the first has 12 × 12"]);
    folder.write_array("a2.npy", &Array2::<i32>::zeros((12, 12)));
    refused(&["a2.npy", "frame 0 is all background"]);
    folder.write("a3.png", "");
    refused(&["images of several kinds: 2 of *.npy, 1 of *.png"]);
}

#[test]
fn masks_that_cellpose_saved_are_read() {
    let (data, said) = import(&[&sample("masks_seg.npy")], "--pixel-size 0.5 --length-unit um");
    assert_said(&said, &["12 outlines in 1 frames, 12 cells", "read: the masks of Cellpose"]);
    let numbers: Array2<i64> = read(&data.file("cell_numbers.npy"));
    assert_eq!(numbers.iter().copied().collect::<Vec<_>>(), (1..=12).collect::<Vec<_>>());
    // The masks are 13 rows of 36 pixels, in cells about 6 pixels wide.
    let areas: Array2<f64> = read(&data.file("true_areas.npy"));
    assert_eq!(areas.sum(), 0.25 * 13.0 * 36.0);
    let settings = fs::read_to_string(data.file("dataset.toml")).unwrap();
    assert_said(&settings, &["field_of_view = [0.0, 0.0, 18.0, 6.5]"]);
    let model = Folder::new();
    succeed("evaluate --quiet", &[("", data.path()), ("--out", model.path())]);
}

#[test]
fn other_objects_than_those_of_cellpose_are_refused() {
    let whole = fs::read(sample("masks_seg.npy")).unwrap();
    let at = whole.windows(5).position(|part| part == b"masks").unwrap();
    let mut renamed = whole.clone();
    renamed[at..at + 5].copy_from_slice(b"skams");
    let folder = Folder::new();
    for (content, facts) in [
        (&renamed[..], ["x_seg.npy", "without masks: its entries are outlines, skams, chan_choose"]),
        (&whole[..whole.len() / 2], ["x_seg.npy", "no masks can be found: it ends too early"]),
    ] {
        folder.write("x_seg.npy", content);
        let file = folder.file("x_seg.npy");
        assert_arguments_refused(["import".as_ref(), "labels".as_ref(), file.as_os_str()], &facts);
    }
}
