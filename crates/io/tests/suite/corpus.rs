//! Files that once did harm, and mutations of good ones: whatever is in a file, reading it ends with a value or an error.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use ndarray::{Array2, Array3};
use voronudge_io::{
    Error, FieldOptions, FlowOptions, ImportOptions, Journal, LabelOptions, OutputFolder, Recording, Source,
    WantedExtrema, import_field, import_flow, import_labels, import_trackmate, import_tracks, read_integers,
    read_reals, read_vectors,
};

use crate::{Scratch, assert_told};

fn corpus(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(name)
}

fn labels(path: &Path) -> Result<(), Error> {
    import_labels(path, &LabelOptions { gap: 2, ..LabelOptions::default() }).map(|_| ())
}

fn field(path: &Path) -> Result<(), Error> {
    let options = FieldOptions { extrema: WantedExtrema::Both, smoothing: 1.0, ..FieldOptions::default() };
    import_field(path, &options).map(|_| ())
}

#[test]
fn images_whose_pixels_do_not_fit_in_memory_are_refused() {
    for name in ["pixels-beyond-memory.png", "pixels-beyond-memory.tif", "pixels-beyond-64-bits.tif"] {
        assert_told(labels(&corpus(name)), &[name, "pixels", "the limit is"], "cut the image");
        assert_told(field(&corpus(name)), &[name, "pixels", "the limit is"], "cut the image");
    }
    let name = "pixels-beyond-64-bits.png";
    assert_told(labels(&corpus(name)), &[name, "pixels", "the limit is"], "cut the image");
}

#[test]
fn arrays_whose_size_overflows_are_refused() {
    for name in ["rows-beyond-64-bits.npy", "size-beyond-64-bits.npy"] {
        for error in [read_reals(&corpus(name)).unwrap_err(), read_vectors(&corpus(name)).unwrap_err()] {
            assert!(error.to_string().contains(name), "{error}");
            assert!(error.hint().is_some());
        }
    }
}

#[test]
fn tables_whose_arrays_do_not_fit_in_memory_are_refused() {
    let name = "frames-beyond-limit.csv";
    let read = import_tracks(&corpus(name), &ImportOptions::default());
    assert_told(read, &[name, "frames"], "frame");
    // A thousand tracks of one spot each in a hundred thousand frames.
    let name = "tracks-times-frames.csv";
    let read = import_tracks(&corpus(name), &ImportOptions::default());
    assert_told(read, &[name, "1310 tracks"], "");
}

#[test]
fn a_table_of_few_spots_far_apart_makes_no_large_array() {
    let scratch = Scratch::new();
    let rows = (0..978).map(|spot| format!("{spot},{},1,{spot}\n", 100 * spot)).collect::<String>();
    let path = scratch.path("spots.csv");
    fs::write(&path, format!("TRACK_ID,FRAME,POSITION_X,POSITION_Y\n{rows}")).unwrap();
    assert_told(import_tracks(&path, &ImportOptions::default()), &["978 tracks", "the limit is"], "frames");
}

#[test]
fn what_a_header_says_is_told_in_one_line() {
    for name in ["shape-of-two-lines.npy", "type-of-two-lines.npy"] {
        let error = read_vectors(&corpus(name)).unwrap_err().to_string();
        assert!(error.contains(name) && !error.contains('\n') && error.len() < 300, "{error}");
    }
}

/// A generator of 64-bit numbers, the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % below.max(1)
    }
}

/// What may stand in the place of a few bytes.
const EXTREMES: [&[u8]; 10] = [
    b"18446744073709551615",
    b"-1",
    b"1e308",
    b"1e-320",
    b"nan",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"\x7f\xff\xff\xff",
    b"\n",
    b"(((((((((((((((((((((((((",
];

/// Changes a file in one to three places.
fn mutate(whole: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..=random.next(3) {
        let at = random.next(bytes.len());
        match random.next(5) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << random.next(8),
            1 => bytes.truncate(at),
            2 => {
                let end = (at + random.next(4)).min(bytes.len());
                let extreme = EXTREMES[random.next(EXTREMES.len())];
                bytes.splice(at..end, extreme.iter().copied());
            }
            3 => {
                let piece = bytes[at..(at + random.next(40)).min(bytes.len())].to_vec();
                let to = random.next(bytes.len());
                bytes.splice(to..to, piece);
            }
            // Headers matter most.
            _ => {
                let at = random.next(bytes.len().min(128));
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = random.next(256) as u8;
                }
            }
        }
    }
    bytes
}

/// Times as many mutations as usual: `VORONUDGE_EXECUTIONS=10` makes some hundred thousand.
fn times() -> usize {
    std::env::var("VORONUDGE_EXECUTIONS").map_or(1, |count| count.parse().unwrap())
}

/// Longest that reading any file may take.
const LONGEST: Duration = Duration::from_secs(20);

/// Reads so many mutations of a file. A panic fails the test, and so does a file that takes very long; what is told must come with advice.
fn assert_survives(seed: u64, whole: &[u8], path: &Path, count: usize, read: impl Fn() -> Result<(), Error>) {
    fs::write(path, whole).unwrap();
    read().unwrap();
    let (mut random, mut refused, mut longest) = (Random(seed), 0, Duration::ZERO);
    let count = count * times();
    for _ in 0..count {
        fs::write(path, mutate(whole, &mut random)).unwrap();
        let begun = Instant::now();
        if let Err(error) = read() {
            refused += 1;
            assert!(error.hint().is_some(), "{error}");
        }
        longest = longest.max(begun.elapsed());
    }
    let name = path.file_name().unwrap_or_default().display();
    println!("{name}: {refused} of {count} refused, the longest took {longest:?}");
    assert!(longest < LONGEST, "{name}: {longest:?}");
    assert!(refused > count / 10, "{}: only {refused} of {count} refused", path.display());
}

#[test]
fn mutated_arrays_are_read_or_refused() {
    let scratch = Scratch::new();
    let path =
        scratch.write_array("a.npy", &Array3::from_shape_fn((2, 5, 2), |(f, i, k)| (f + i * k) as f64));
    let whole = fs::read(&path).unwrap();
    assert_survives(1, &whole, &path, 1500, || read_vectors(&path).map(|_| ()));
    assert_survives(2, &whole, &path, 500, || read_reals(&path).map(|_| ()));
    let path = scratch.write_array("i.npy", &Array2::from_shape_fn((4, 5), |(i, k)| (i * k) as i32));
    let whole = fs::read(&path).unwrap();
    assert_survives(3, &whole, &path, 1000, || read_integers(&path).map(|_| ()));
}

#[test]
fn mutated_settings_are_read_or_refused() {
    let scratch = Scratch::new();
    scratch
        .write_array("positions.npy", &Array2::from_shape_fn((9, 2), |(i, k)| (i * i + 3 * k) as f64 * 0.1));
    let path = scratch.path("dataset.toml");
    let whole = b"boundary = \"periodic\"\nbox = [12.0, 11.0]\nframe_interval = 0.5\nlength_unit = \"um\"\n\
                  time_unit = \"h\"\ny_axis = \"down\"\nposition_noise = \"2%\"\npositions_are = \"centroids\"\n";
    let source = Source { folder: Some(scratch.root().into()), ..Source::default() };
    assert_survives(4, whole, &path, 2000, || source.load().map(|_| ()));
}

#[test]
fn mutated_tables_are_read_or_refused() {
    let scratch = Scratch::new();
    let path = scratch.path("spots.csv");
    let rows = (0..12).map(|i| format!("{},{},{}.5,{}\n", i % 3, i / 3, i, 2 * i));
    let whole = String::from("TRACK_ID,FRAME,POSITION_X,POSITION_Y\n") + &rows.collect::<String>();
    for (seed, read) in [(5, import_tracks as fn(&_, &_) -> _), (6, import_trackmate)] {
        let options = ImportOptions::default();
        assert_survives(seed, whole.as_bytes(), &path, 1500, || read(&path, &options).map(|_| ()));
    }
}

#[test]
fn mutated_images_are_read_or_refused() {
    let scratch = Scratch::new();
    let image = Array2::from_shape_fn((24, 24), |(row, column)| (1 + row / 6 * 4 + column / 6) as u8);
    let path = scratch.path("labels.png");
    let mut whole = Vec::new();
    let mut encoder = png::Encoder::new(&mut whole, 24, 24);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(image.as_slice().unwrap()).unwrap();
    assert_survives(7, &whole, &path, 600, || labels(&path));
    let path = scratch.path("labels.tif");
    let mut whole = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut whole).unwrap();
    encoder.write_image::<tiff::encoder::colortype::Gray8>(24, 24, image.as_slice().unwrap()).unwrap();
    assert_survives(8, &whole.into_inner(), &path, 600, || labels(&path));
    let waves = Array2::from_shape_fn((24, 24), |(row, column)| (row as f64).sin() * (column as f64).sin());
    let path = scratch.write_array("field.npy", &waves);
    let whole = fs::read(&path).unwrap();
    assert_survives(9, &whole, &path, 600, || field(&path));
}

#[test]
fn mutated_files_of_other_programs_are_read_or_refused() {
    let scratch = Scratch::new();
    let sample = |name: &str| {
        fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/imports").join(name)).unwrap()
    };
    let path = scratch.path("masks.npy");
    assert_survives(13, &sample("masks_seg.npy"), &path, 600, || labels(&path));
    let path = scratch.path("labels.tif");
    for (seed, name) in [(14, "labels-slices.tif"), (15, "labels.ome.tif"), (19, "labels-zstd-tiles.tif")] {
        assert_survives(seed, &sample(name), &path, 100, || labels(&path));
    }
    let path = scratch.path("flow.mat");
    for (seed, name) in [(20, "pivlab.mat"), (21, "pivlab-frame.mat")] {
        let flow = || import_flow(std::slice::from_ref(&path), &FlowOptions::default());
        assert_survives(seed, &sample(name), &path, 300, || flow().map(|_| ()));
    }
    let path = scratch.path("tracks.xml");
    for (seed, name) in
        [(16, "trackmate-model.xml"), (17, "trackmate-tracks.xml"), (18, "napari-tracks-3d.npy")]
    {
        let options = ImportOptions::default();
        assert_survives(seed, &sample(name), &path, 300, || import_tracks(&path, &options).map(|_| ()));
    }
}

#[test]
fn mutated_stores_of_chunks_are_read_or_refused() {
    let scratch = Scratch::new();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/imports");
    for (seed, store, file) in [
        (22, "labels-shards.zarr", "labels/cells/0/zarr.json"),
        (23, "labels-shards.zarr", "labels/cells/0/c/0/0/0/0"),
        (24, "labels-shards.zarr", "labels/cells/zarr.json"),
        (25, "tracks.geff", "nodes/props/x/values/0"),
        (26, "tracks.geff", "nodes/ids/.zarray"),
        (27, "tracks.geff", ".zattrs"),
    ] {
        let own = scratch.path(&format!("{seed}-{store}"));
        crate::other_programs::copy(&fixtures.join(store), &own);
        let path = own.join(file);
        let whole = fs::read(&path).unwrap();
        let read = || match store.ends_with("geff") {
            true => import_tracks(&own, &ImportOptions::default()).map(|_| ()),
            false => labels(&own),
        };
        assert_survives(seed, &whole, &path, 100, read);
    }
}

#[test]
fn mutated_checkpoints_and_journals_are_refused_or_shorter() {
    let scratch = Scratch::new();
    let folder = OutputFolder::claim(scratch.root()).unwrap();
    let mut recording = Recording::begin(&folder, &[("positions.npy", [2, 3, 2])]).unwrap();
    recording.append(0, &[0.5; 6]).unwrap();
    recording.checkpoint(b"{\"cells\": 3}\n").unwrap();
    let path = scratch.path(".voronudge-run/checkpoint");
    let whole = fs::read(&path).unwrap();
    assert_survives(10, &whole, &path, 1000, || Recording::find(scratch.root()).map(|_| ()));
    drop(recording);
    let mut journal = Journal::begin(&folder, "{\"request\": 1}").unwrap();
    (0..5).for_each(|line| journal.append(&format!("{{\"point\": {line}}}")).unwrap());
    let path = scratch.path(".voronudge-run/journal");
    let whole = fs::read(&path).unwrap();
    assert_survives(11, &whole, &path, 1000, || {
        let lines = Journal::find(scratch.root())?.unwrap_or_default();
        let expected = (0..5).map(|line| format!("{{\"point\": {line}}}"));
        let expected: Vec<String> = std::iter::once("{\"request\": 1}".into()).chain(expected).collect();
        assert!(expected.starts_with(&lines), "{lines:?}");
        Ok(())
    });
}
