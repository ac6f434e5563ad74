//! Files that other programs and libraries wrote, in `fixtures/imports`.

use std::fs;
use std::path::{Path, PathBuf};

use voronudge_io::{
    FieldOptions, FlowColumnNames, FlowOptions, ImportOptions, InputKind, LabelLinking, LabelOptions,
    PlaceLinking, import_field, import_flow, import_labels, import_points, import_tracks, inspect,
};

use crate::{Scratch, assert_told};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/imports").join(name)
}

fn labels() -> LabelOptions {
    LabelOptions { gap: 2, linking: LabelLinking::SameLabel, ..LabelOptions::default() }
}

#[test]
fn images_compressed_with_zstandard_are_those_of_other_compressions() {
    let expected = import_labels(&sample("labels-plain.tif"), &labels()).unwrap().dataset.positions;
    let tiles = import_labels(&sample("labels-zstd-tiles.tif"), &labels()).unwrap().dataset.positions;
    assert_eq!(tiles.dim(), (4, 30, 2));
    assert_eq!(tiles, expected);
    let strip = import_labels(&sample("labels-zstd.tif"), &labels()).unwrap().dataset.positions;
    assert_eq!(strip.index_axis(ndarray::Axis(0), 0), expected.index_axis(ndarray::Axis(0), 0));
}

#[test]
fn damaged_zstandard_is_told() {
    let scratch = Scratch::new();
    let mut bytes = fs::read(sample("labels-zstd.tif")).unwrap();
    let begin = bytes.windows(4).position(|own| own == [0x28, 0xb5, 0x2f, 0xfd]).unwrap();
    bytes[begin..begin + 4].fill(0);
    let path = scratch.write("labels.tif", &bytes);
    assert_told(
        import_labels(&path, &labels()),
        &["labels.tif: ", "TIFF", "Zstandard"],
        "without compression",
    );
}

/// The flow of a file of PIVlab, u and v (frames, rows, columns).
fn flow(name: &str, columns: FlowColumnNames) -> voronudge_io::FlowImport {
    import_flow(&[sample(name)], &FlowOptions { columns, ..FlowOptions::default() }).unwrap()
}

#[test]
fn files_that_pivlab_saves_for_matlab_are_read() {
    let import = flow("pivlab.mat", FlowColumnNames::default());
    let field = import.dataset.flow.unwrap();
    assert_eq!(field.velocities.dim(), (2, 4, 5, 2));
    assert_eq!((field.x[0], field.x[4]), (16.0, 80.0));
    // A masked corner in both frames, and a vector that was not found in the second; y points down in the file.
    assert_eq!(import.summary.missing, 3);
    for (row, column) in [(0, 1), (2, 0), (3, 4)] {
        let y = 16.0 + 16.0 * row as f64;
        let own = [0, 1].map(|axis| field.velocities[[0, row, column, axis]]);
        let expected = [0.01 * (40.0 - y), -0.01 * (field.x[column] - 48.0)];
        assert!(
            (own[0] - expected[0]).abs() < 1e-12 && (own[1] - expected[1]).abs() < 1e-12,
            "{own:?}, {expected:?}"
        );
    }
    let said: Vec<&str> = import.notes.iter().map(|note| note.text.as_str()).collect();
    assert_eq!(said[0], "of the variables x is x, y is y, u is u_filtered, v is v_filtered (PIVlab)");
    assert!(said[1].starts_with("lengths in px, velocities in px/frame"), "{said:?}");
}

#[test]
fn one_frame_of_pivlab_has_its_units_and_variables_may_be_chosen() {
    let filtered = flow("pivlab-frame.mat", FlowColumnNames::default());
    assert_eq!((filtered.dataset.length_unit.as_str(), filtered.dataset.time_unit.as_str()), ("m", "s"));
    let name = |name: &str| Some(name.to_owned());
    let names =
        FlowColumnNames { u: name("u_original"), v: name("v_original"), ..FlowColumnNames::default() };
    let original = flow("pivlab-frame.mat", names).dataset.flow.unwrap();
    let filtered = filtered.dataset.flow.unwrap();
    assert_eq!(filtered.velocities.dim(), (1, 4, 5, 2));
    let [one, two] = [&filtered, &original].map(|field| field.velocities[[0, 2, 3, 0]]);
    assert!((two - 2.0 * one).abs() < 1e-6 && one != 0.0);
    let names = FlowColumnNames { u: name("speed"), ..FlowColumnNames::default() };
    let options = FlowOptions { columns: names, ..FlowOptions::default() };
    let found = import_flow(&[sample("pivlab-frame.mat")], &options);
    assert_told(found, &["looked for speed, found", "typevector_filtered"], "--u-column u_original");
}

#[test]
fn files_of_matlab_that_are_cut_are_told() {
    let scratch = Scratch::new();
    for (name, end) in [("pivlab.mat", 700), ("pivlab-frame.mat", 900), ("pivlab.mat", 130)] {
        let whole = fs::read(sample(name)).unwrap();
        let path = scratch.write("cut.mat", &whole[..end]);
        let read = import_flow(&[path], &FlowOptions::default());
        assert_told(read, &["cut.mat: cannot be read as a file of MATLAB"], "PIVlab");
    }
}

#[test]
fn decimal_commas_are_read_where_they_can_be_nothing_else() {
    let options = ImportOptions::default();
    let points = import_tracks(&sample("spreadsheet.csv"), &options).unwrap();
    let commas = import_tracks(&sample("decimal-comma.csv"), &options).unwrap();
    assert_eq!(commas.dataset.positions, points.dataset.positions);
    assert!(commas.notes.iter().any(|note| note.text.contains("decimal commas")), "{:?}", commas.notes);
    assert!(!points.notes.iter().any(|note| note.text.contains("decimal commas")));
    let scratch = Scratch::new();
    let read = |text: &str| import_tracks(&scratch.write("t.csv", text), &options);
    let tabs = read("track\tframe\tx\ty\n1\t0\t-1,5e-1\t2\n2\t0\t\"3,25\"\t,5\n").unwrap();
    assert_eq!(tabs.dataset.positions[[0, 0, 0]], -0.15);
    assert_eq!([0, 1].map(|axis| tabs.dataset.positions[[0, 1, axis]].abs()), [3.25, 0.5]);
    // Thousands, perhaps.
    let mixed = read("track;frame;x;y\n1;0;1,234;2.5\n");
    assert_told(mixed, &["line 2: column \"x\" holds \"1,234\""], "decimal points");
    assert_told(read("track;frame;x;y\n1;0;1,2,3;2\n"), &["holds \"1,2,3\""], "decimal points");
    let flow = scratch.write("f.txt", "x;y;u;v\n1,5;1;0,5;1\n2,5;1;0,5;1\n1,5;2;0,5;1\n2,5;2;0,25;1\n");
    let found = import_flow(std::slice::from_ref(&flow), &FlowOptions::default()).unwrap();
    assert_eq!(found.dataset.flow.unwrap().velocities[[0, 1, 1, 0]], 0.25);
    assert_eq!(inspect(&flow).unwrap().kind, InputKind::FlowTable);
}

#[test]
fn images_of_ome_zarr_are_those_of_tiff() {
    let expected = import_labels(&sample("labels-plain.tif"), &labels()).unwrap().dataset.positions;
    let ome = import_labels(&sample("labels.ome.zarr"), &labels()).unwrap();
    assert_eq!((ome.dataset.length_unit.as_str(), ome.dataset.time_unit.as_str()), ("µm", "min"));
    assert_eq!(ome.dataset.frame_interval, 10.0);
    let off = (&ome.dataset.positions - &expected * 0.5).mapv(f64::abs);
    assert!(off.iter().all(|own| *own < 1e-12));
    assert_eq!(ome.dataset.inputs.len(), 1);
    // Shards of several chunks, beyond whose edges the image ends; an image of other numbers with these labels.
    let shards = import_labels(&sample("labels-shards.zarr"), &labels()).unwrap();
    assert_eq!(shards.dataset.positions, expected);
    assert!(
        shards.notes.iter().any(|note| note.text.contains("the labels cells (OME-Zarr)")),
        "{:?}",
        shards.notes
    );
    assert_eq!(inspect(&sample("labels-shards.zarr")).unwrap().kind, InputKind::Labels);
    let options = FieldOptions::default();
    let image = import_field(&sample("labels-shards.zarr"), &options).unwrap();
    assert_eq!(image.first.dim(), (60, 72));
    let expected = (3.0_f64 / 3.0).cos() * (5.0_f64 / 4.0).cos();
    assert!((image.first[[3, 5]] - expected).abs() < 1e-6);
}

#[test]
fn tracks_of_geff_are_read_and_end_where_the_graph_branches() {
    let options = ImportOptions::default();
    let expected = import_tracks(&sample("napari-tracks.npy"), &options).unwrap();
    for name in ["tracks.geff", "tracks-3.geff"] {
        let found = import_tracks(&sample(name), &options).unwrap();
        assert_eq!(found.dataset.positions, expected.dataset.positions, "{name}");
        assert_eq!(inspect(&sample(name)).unwrap().kind, InputKind::Tracks);
    }
    let found = import_tracks(&sample("divisions.geff"), &options).unwrap();
    // A cell that divides after two frames, and the two after it.
    assert_eq!(found.dataset.positions.dim(), (4, 3, 2));
    let present =
        |cell: usize| (0..4).filter(|frame| found.dataset.positions[[*frame, cell, 0]].is_finite()).count();
    assert_eq!([0, 1, 2].map(present), [2, 2, 2]);
    assert_eq!(found.dataset.length_unit, "micrometer");
    let said: Vec<&str> = found.notes.iter().map(|note| note.text.as_str()).collect();
    assert!(said.contains(&"at 1 branches of the graph other tracks begin"), "{said:?}");
    assert!(said.iter().any(|text| text.starts_with("z runs from")), "{said:?}");
}

/// Copies a store.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        match entry.file_type().unwrap().is_dir() {
            true => copy(&entry.path(), &target),
            false => drop(fs::copy(entry.path(), target).unwrap()),
        }
    }
}

#[test]
fn stores_that_are_damaged_or_of_another_kind_are_told() {
    let scratch = Scratch::new();
    let options = ImportOptions::default();
    let store = scratch.path("x.zarr");
    copy(&sample("labels.ome.zarr"), &store);
    let read = || import_labels(&store, &labels());
    read().unwrap();
    let metadata = store.join("s0/zarr.json");
    let whole = fs::read_to_string(&metadata).unwrap();
    for (from, to, fact) in [
        ("\"zstd\"", "\"snappy\"", "compressed by snappy"),
        ("\"uint16\"", "\"complex64\"", "numbers are of the kind complex64"),
        ("72", "7200000", "the limit is"),
        ("\"shape\"", "\"form\"", "shape or its chunks are not stated"),
        ("{", "(", "is no JSON"),
    ] {
        fs::write(&metadata, whole.replace(from, to)).unwrap();
        assert_told(
            read(),
            &["x.zarr: is a Zarr store (OME-Zarr or GEFF), and ", fact],
            "import tracks reads GEFF",
        );
    }
    fs::write(&metadata, whole.replace("\"fill_value\": 0", "\"fill_value\": 7")).unwrap();
    fs::remove_dir_all(store.join("s0/c")).unwrap();
    assert_told(read(), &["chunks of s0 are missing that are full of 7"], "tifffile");
    fs::write(&metadata, &whole).unwrap();
    // Chunks that are not there are background.
    assert_told(read(), &["frame 0 is all background"], "");
    assert_told(import_tracks(&store, &options), &["it has no graph of GEFF"], "import labels");
    let graph = sample("tracks.geff");
    assert_told(import_labels(&graph, &labels()), &["neither an image nor an array"], "GEFF");
    assert_told(
        import_points(&graph, &options, PlaceLinking::Separate),
        &["a file is needed here"],
        "import tracks",
    );
}

#[test]
fn what_is_recognised_and_not_read_is_told_how_to_become_a_table() {
    let options = ImportOptions::default();
    assert_told(import_tracks(&sample("tracks.parquet"), &options), &["is a Parquet file"], "read_parquet");
    let scratch = Scratch::new();
    for (begin, fact, advice) in [
        ("ARROW1\0\0", "is a Feather file", "read_feather"),
        ("MATLAB 7.3 MAT-file", "of version 7.3 (HDF5)", "-v7"),
        ("MATLAB 5.0 MAT-file", "is a MATLAB file", "import flow"),
        ("\u{89}HDF", "is not text", "as text"),
        ("PK\u{3}\u{4}", "a spreadsheet", "save the sheet"),
    ] {
        let path = scratch.write("a", begin.to_owned() + "\0\0");
        assert_told(import_tracks(&path, &options), &[fact], advice);
    }
    let path = scratch.write("a.h5", b"\x89HDF\r\n\x1a\n");
    assert_told(import_tracks(&path, &options), &["is an HDF5 file"], "ilastik");
}
