//! `import labels` and `import outlines`: true shapes beside Voronoi polygons.

use crate::program::{assert_described, succeed};
use crate::refusal::{assert_arguments_refused, assert_told};
use crate::scratch::{Folder, npy, number, read, report};
use ndarray::{Array2, Array3, Axis};
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::fs;
use std::io::Cursor;
use std::path::Path;
use tiff::encoder::{TiffEncoder, colortype};

const COLUMNS: usize = 130;
const ROWS: usize = 112;

/// Centres of a shaken honeycomb of spacing 14, moved along x.
fn centres(shift: f64) -> Vec<[f64; 2]> {
    let place = |k: usize| {
        let (column, row) = ((k % 10) as f64, (k / 10) as f64);
        let shake = [(3.7 * k as f64).sin(), (5.3 * k as f64).cos()];
        [14.0 * (column + 0.5 * (row % 2.0)) + 1.6 * shake[0] + shift, 12.1 * row + 1.6 * shake[1]]
    };
    (0..100).map(place).collect()
}

/// The Voronoi polygons of the centres as labels from 1, with lines of background between them.
fn mask(centres: &[[f64; 2]], label: impl Fn(usize) -> u16) -> Array2<u16> {
    Array2::from_shape_fn((ROWS, COLUMNS), |(row, column)| {
        let r = [column as f64 + 0.5, row as f64 + 0.5];
        let mut nearest = [(f64::INFINITY, 0); 2];
        for (k, c) in centres.iter().enumerate() {
            let distance = (r[0] - c[0]).hypot(r[1] - c[1]);
            if distance < nearest[0].0 {
                nearest = [(distance, k), nearest[0]];
            } else if distance < nearest[1].0 {
                nearest[1] = (distance, k);
            }
        }
        if nearest[1].0 - nearest[0].0 < 1.0 { 0 } else { label(nearest[0].1) }
    })
}

fn tiff_bytes(frames: &[Array2<u16>]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for frame in frames {
        let pixels: Vec<u16> = frame.iter().copied().collect();
        encoder.write_image::<colortype::Gray16>(COLUMNS as u32, ROWS as u32, &pixels).unwrap();
    }
    bytes.into_inner()
}

/// A mask that is a Voronoi diagram agrees with Voronoi polygons, but for the background and the pixels.
#[test]
fn a_voronoi_diagram_agrees_with_itself() {
    let (source, data) = (Folder::new(), Folder::new());
    let labels = mask(&centres(0.0), |k| k as u16 + 1);
    source.write_array("labels.npy", &labels);
    let flags = "--pixel-size 0.5 --length-unit um";
    succeed(
        &format!("import labels {flags} --positions sites"),
        &[("", &source.file("labels.npy")), ("--out", data.path())],
    );
    let found = report(data.path());
    assert_described(&found);
    assert_eq!(
        data.names().join(" "),
        "cell_numbers.npy dataset.toml position_errors.npy positions.npy report.html report.json true_areas.npy true_perimeters.npy"
    );
    assert!(number(&found, "/all/precision") > 0.97 && number(&found, "/all/recall") > 0.97, "{found}");
    assert!(number(&found, "/all/area_correlation") > 0.97, "{found}");
    // Centroids are not the points that the polygons are made of, and all cells are of nearly one size.
    assert!(number(&found, "/of_centroids/area_correlation") < 0.95, "{found}");
    assert!(number(&found, "/sites/misfit") < 0.25 * number(&found, "/sites/misfit_of_centroids"), "{found}");
    // A line of background a pixel wide takes about a seventh of the area.
    assert!((1.05..1.25).contains(&number(&found, "/all/area_ratio")), "{found}");
    assert!((1.03..1.2).contains(&number(&found, "/all/perimeter_ratio")), "{found}");
    assert!(number(&found, "/at_border") > 20.0 && number(&found, "/in_pieces") == 0.0);
    // Pixels of half a micrometre, y as in the image.
    let positions: Array3<f64> = read(&data.file("positions.npy"));
    let numbers: Array2<i64> = read(&data.file("cell_numbers.npy"));
    let errors: Array2<f64> = read(&data.file("position_errors.npy"));
    let mut sum = [0.0; 2];
    for (cell, &number) in numbers.row(0).indexed_iter() {
        let place = centres(0.0)[number as usize - 1];
        let inside = (15.0..115.0).contains(&place[0]) && (15.0..97.0).contains(&place[1]);
        if inside {
            for axis in 0..2 {
                let off = (positions[[0, cell, axis]] - 0.5 * place[axis]) / errors[[0, cell]];
                sum = [sum[0] + off * off, sum[1] + 1.0];
            }
            assert!(errors[[0, cell]] < 0.25, "{cell} {}", errors[[0, cell]]);
        }
    }
    let ratio = (sum[0] / sum[1]).sqrt();
    assert!(sum[1] > 60.0 && (0.5..2.0).contains(&ratio), "{sum:?} {ratio}");
    let settings = fs::read_to_string(data.file("dataset.toml")).unwrap();
    for line in ["y_axis = \"down\"", "length_unit = \"um\"", "positions_are = \"sites\""] {
        assert!(settings.contains(line), "{settings}");
    }
    let centroids = Folder::new();
    succeed(
        &format!("import labels {flags}"),
        &[("", &source.file("labels.npy")), ("--out", centroids.path())],
    );
    let other = report(centroids.path());
    assert_described(&other);
    for part in ["sites", "all", "of_centroids"] {
        assert_eq!(other[part], found[part]);
    }
    let settings = fs::read_to_string(centroids.file("dataset.toml")).unwrap();
    assert!(settings.contains("positions_are = \"centroids\""), "{settings}");
    // Errors of centroids are those of sides averaged. Cells at the border and those whose polygon depends on them stay at their sites.
    let (at_border, cells) = (number(&other, "/at_border") as usize, errors.len());
    let smaller: Array2<f64> = read(&centroids.file("position_errors.npy"));
    let kept = smaller.iter().zip(&errors).filter(|(own, of_site)| own == of_site).count();
    assert!(kept > at_border && kept < cells / 2 + at_border, "{kept} {at_border} {cells}");
    assert!(smaller.iter().zip(&errors).all(|(own, of_site)| own <= of_site), "{smaller} {errors}");
}

/// TIFF pages are frames; cells are followed by overlap though their labels change.
#[test]
fn cells_are_followed_over_the_pages_of_a_tiff() {
    let source = Folder::new();
    let frames = [
        mask(&centres(0.0), |k| k as u16 + 1),
        mask(&centres(1.5), |k| 500 - k as u16),
        mask(&centres(3.0), |k| k as u16 + 1),
    ];
    let file = source.write("labels.tif", tiff_bytes(&frames));
    let imported = |flags: &str| {
        let data = Folder::new();
        succeed(&format!("import labels {flags}"), &[("", &file), ("--out", data.path())]);
        let positions: Array3<f64> = read(&data.file("positions.npy"));
        (positions, report(data.path()))
    };
    let (followed, found) = imported("--link overlap");
    assert_described(&found);
    let cells = number(&found, "/frames/0/present") as usize;
    assert!(followed.dim().1 < cells + 8, "{:?}", followed.dim());
    let mut errors = Vec::new();
    for cell in followed.axis_iter(Axis(1)) {
        let step = cell[[1, 0]] - cell[[0, 0]];
        let inside =
            cell[[0, 0]] > 15.0 && cell[[1, 0]] < 115.0 && cell[[0, 1]] > 15.0 && cell[[0, 1]] < 97.0;
        if inside {
            errors.push(step - 1.5);
        }
    }
    assert!(errors.len() > 30);
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!(rms < 0.35 && errors.iter().all(|e| e.abs() < 4.0 * rms), "{rms} {errors:?}");
    // The same labels mean other cells in the second frame, and the same again in the third.
    let (same, _) = imported("--link labels");
    let moved =
        same.axis_iter(Axis(1)).filter(|cell| (cell[[2, 0]] - cell[[0, 0]] - 3.0).abs() < 0.5).count();
    assert!(moved > 60, "{moved}");
    let (separate, found) = imported("--border leave-out");
    assert!(separate.dim().1 as f64 == number(&found, "/tracks") && separate.dim().1 > 150);
    assert!(found["warnings"][0].as_str().unwrap().contains("--link"));
}

#[test]
fn outlines_of_hexagons_are_measured() {
    let (source, data) = (Folder::new(), Folder::new());
    let mut table = String::from("cell,x,y\n");
    let side = 2.0;
    for k in 0..36 {
        let (column, row) = ((k % 6) as f64, (k / 6) as f64);
        let centre = [side * 3f64.sqrt() * (column + 0.5 * (row % 2.0)), 1.5 * side * row];
        for corner in 0..6 {
            let angle = (corner as f64 + 0.5) * std::f64::consts::FRAC_PI_3;
            let _ = writeln!(
                table,
                "{k},{:.6},{:.6}",
                centre[0] + side * angle.cos(),
                centre[1] + side * angle.sin()
            );
        }
    }
    let file = source.write("outlines.csv", &table);
    succeed("import outlines --y-axis up", &[("", &file), ("--out", data.path())]);
    let found = report(data.path());
    assert_described(&found);
    assert_eq!((number(&found, "/all/precision"), number(&found, "/all/recall")), (1.0, 1.0));
    assert!((number(&found, "/all/area_ratio") - 1.0).abs() < 1e-5);
    assert!((number(&found, "/all/perimeter_ratio") - 1.0).abs() < 1e-5);
    let areas: Array2<f64> = read(&data.file("true_areas.npy"));
    assert!(areas.iter().all(|area| (area - 1.5 * 3f64.sqrt() * side * side).abs() < 1e-4));
}

#[track_caller]
fn assert_labels_refused(name: &str, bytes: impl AsRef<[u8]>, facts: &[&str]) {
    let source = Folder::new();
    let file = source.write(name, bytes);
    assert_arguments_refused([OsStr::new("import"), OsStr::new("labels"), file.as_os_str()], facts);
}

#[test]
fn what_is_no_label_image_is_refused() {
    let zeros = vec![0; 400 * 8];
    assert_labels_refused(
        "a.npy",
        npy("<f8", "False", "(20, 20)", &zeros),
        &["a.npy", "real numbers", "integers"],
    );
    assert_labels_refused("a.npy", npy("<i8", "False", "(20, 20)", &zeros), &["frame 0", "all background"]);
    assert_labels_refused("a.npy", npy("<i8", "False", "(400,)", &zeros), &["shape (400,)", "(ny, nx)"]);
    assert_labels_refused("x_seg.npy", npy("|O", "False", "()", &[0; 50]), &["pickled"]);
    assert_labels_refused("a.jpg", b"\xff\xd8\xff\xe0", &["neither", "PNG"]);
    assert_labels_refused("a.npy", npy("<i8", "False", "(3000000, 3000000)", &zeros), &["truncated"]);
    let mut negative = zeros.clone();
    negative[8 * 45..8 * 46].copy_from_slice(&(-3_i64).to_le_bytes());
    assert_labels_refused("a.npy", npy("<i8", "False", "(20, 20)", &negative), &["row 2, column 5", "-3"]);
    let one: Vec<u8> = (0..400).flat_map(|_| 7_i64.to_le_bytes()).collect();
    assert_labels_refused(
        "a.npy",
        npy("<i8", "False", "(20, 20)", &one),
        &["frame 0 has 1 cells", "at least 3"],
    );
}

#[test]
fn a_damaged_tiff_is_refused() {
    let whole = tiff_bytes(&[mask(&centres(0.0), |k| k as u16 + 1)]);
    for length in [10, 200, whole.len() / 2, whole.len() - 1000] {
        assert_labels_refused("a.tif", &whole[..length], &["a.tif", "not a whole TIFF image"]);
    }
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    encoder.write_image::<colortype::RGB8>(4, 4, &[0; 48]).unwrap();
    assert_labels_refused("a.tif", bytes.into_inner(), &["page 0", "colour"]);
}

fn png_bytes(colour: png::ColorType, depth: png::BitDepth, size: [u32; 2], samples: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if colour == png::ColorType::Indexed {
        encoder.set_palette([200, 10, 90].repeat(1 << (depth as usize)));
    }
    encoder.write_header().unwrap().write_image_data(samples).unwrap();
    bytes
}

const SIZE: [u32; 2] = [COLUMNS as u32, ROWS as u32];

/// The numbers of a PNG are labels whatever their bits, also those of a palette whose colours are all one.
#[test]
fn a_png_is_the_array_it_was_made_of() {
    let source = Folder::new();
    let imported = |file: &Path| {
        let data = Folder::new();
        succeed("import labels", &[("", file), ("--out", data.path())]);
        let positions: Array3<f64> = read(&data.file("positions.npy"));
        let numbers: Array2<i64> = read(&data.file("cell_numbers.npy"));
        (positions, numbers)
    };
    let high = mask(&centres(0.0), |k| 600 * (k as u16 + 1));
    let low = mask(&centres(0.0), |k| k as u16 + 1);
    let few = mask(&centres(0.0), |k| (k % 15) as u16 + 1);
    let words: Vec<u8> = high.iter().flat_map(|label| label.to_be_bytes()).collect();
    let octets: Vec<u8> = low.iter().map(|&label| label as u8).collect();
    let halves: Vec<u8> = few
        .iter()
        .copied()
        .collect::<Vec<u16>>()
        .chunks(2)
        .map(|pair| (pair[0] << 4 | pair[1]) as u8)
        .collect();
    use png::{BitDepth, ColorType};
    for (labels, colour, depth, samples) in [
        (&high, ColorType::Grayscale, BitDepth::Sixteen, &words),
        (&low, ColorType::Grayscale, BitDepth::Eight, &octets),
        (&low, ColorType::Indexed, BitDepth::Eight, &octets),
        (&few, ColorType::Grayscale, BitDepth::Four, &halves),
    ] {
        source.write_array("labels.npy", labels);
        let array = imported(&source.file("labels.npy"));
        let picture = imported(&source.write("labels.png", png_bytes(colour, depth, SIZE, samples)));
        assert!(array.1.iter().all(|&number| number > 0) && array == picture, "{colour:?}, {depth:?}");
    }
}

#[test]
fn a_png_that_is_damaged_or_no_labels_is_refused() {
    use png::{BitDepth, ColorType};
    let pixels: Vec<u8> = mask(&centres(0.0), |k| k as u16 + 1).iter().map(|&label| label as u8).collect();
    let whole = png_bytes(ColorType::Grayscale, BitDepth::Eight, SIZE, &pixels);
    for length in [8, 20, 40, whole.len() / 2, whole.len() - 14, whole.len() - 3] {
        assert_labels_refused("a.png", &whole[..length], &["a.png", "not a whole PNG image"]);
    }
    assert_labels_refused("a.png", [], &["a.png"]);
    // Among the pixels, and in the check sum before the last twelve bytes.
    for (place, fact) in [(whole.len() / 2, ""), (whole.len() - 13, "CRC")] {
        let mut damaged = whole.clone();
        damaged[place] ^= 0x10;
        assert_labels_refused("a.png", damaged, &["not a whole PNG image", fact]);
    }
    let huge = png_bytes_of_size(&whole, [2_000_000_000, 2_000_000_000]);
    assert_labels_refused("a.png", huge, &["2000000000 × 2000000000", "the limit is"]);
    // Fits in memory, but the pixels are not there.
    assert_labels_refused("a.png", png_bytes_of_size(&whole, [12_000, 12_000]), &["not a whole PNG image"]);
    for (colour, samples) in [(ColorType::Rgb, 3), (ColorType::Rgba, 4), (ColorType::GrayscaleAlpha, 2)] {
        let picture = png_bytes(colour, BitDepth::Eight, [4, 4], &[7; 64][..16 * samples]);
        assert_labels_refused(
            "a.png",
            picture,
            &[&format!("{colour:?}(8)"), "a picture of labels, not labels"],
        );
    }
    let mut animated = Vec::new();
    let mut encoder = png::Encoder::new(&mut animated, 4, 4);
    encoder.set_animated(2, 0).unwrap();
    let mut writer = encoder.write_header().unwrap();
    (0..2).for_each(|_| writer.write_image_data(&[1; 16]).unwrap());
    writer.finish().unwrap();
    assert_labels_refused("a.png", animated, &["animated", "2 frames"]);
}

/// The same file with another size in its header.
fn png_bytes_of_size(whole: &[u8], size: [u32; 2]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    bytes[16..20].copy_from_slice(&size[0].to_be_bytes());
    bytes[20..24].copy_from_slice(&size[1].to_be_bytes());
    let mut sum = flate2::Crc::new();
    sum.update(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.sum().to_be_bytes());
    bytes
}

/// A field has heights, and the index of a colour is none.
#[test]
fn a_field_is_read_from_a_grey_png() {
    use png::{BitDepth, ColorType};
    let (source, array, picture) = (Folder::new(), Folder::new(), Folder::new());
    let height = |row: usize, column: usize| {
        let distance = |c: &[f64; 2]| (row as f64 - c[1]).hypot(column as f64 - c[0]);
        centres(0.0).iter().map(|c| 9000.0 * (-distance(c).powi(2) / 32.0).exp()).sum::<f64>() as u16
    };
    let field = Array2::from_shape_fn((ROWS, COLUMNS), |(row, column)| height(row, column));
    source.write_array("field.npy", &field.mapv(f64::from));
    let words: Vec<u8> = field.iter().flat_map(|value| value.to_be_bytes()).collect();
    let file = source.write("field.png", png_bytes(ColorType::Grayscale, BitDepth::Sixteen, SIZE, &words));
    succeed("import field", &[("", &source.file("field.npy")), ("--out", array.path())]);
    succeed("import field", &[("", &file), ("--out", picture.path())]);
    let heights: Array2<f64> = read(&picture.file("heights.npy"));
    assert!(heights.len() > 60);
    let expected: Array2<f64> = read(&array.file("heights.npy"));
    assert_eq!(heights, expected);
    let indexed = png_bytes(ColorType::Indexed, BitDepth::Eight, [4, 4], &[7; 16]);
    let file = source.write("indexed.png", indexed);
    assert_arguments_refused([OsStr::new("import"), OsStr::new("field"), file.as_os_str()], &["Indexed(8)"]);
}

#[test]
fn impossible_options_and_places_are_refused() {
    let source = Folder::new();
    source.write_array("labels.npy", &mask(&centres(0.0), |k| k as u16 + 1));
    let file = source.file("labels.npy");
    for flags in [["--pixel-size", "0"], ["--frame-interval", "-1"], ["--gap", "-1"], ["--link", "magic"]] {
        let words = ["import", "labels"].into_iter().map(OsStr::new).chain([file.as_os_str()]);
        assert_arguments_refused(
            words.chain(flags.iter().map(OsStr::new)),
            &[flags[0].trim_start_matches('-').split('-').next().unwrap()],
        );
    }
    let taken = source.write("taken", "a file");
    let words = [
        OsStr::new("import"),
        OsStr::new("labels"),
        file.as_os_str(),
        OsStr::new("--out"),
        taken.as_os_str(),
    ];
    assert_told(&words, &["taken", "is a file"]);
    let flat = source.write("flat.csv", "cell,x,y\n1,0,0\n1,1,1\n1,2,2\n");
    assert_arguments_refused(
        [OsStr::new("import"), OsStr::new("outlines"), flat.as_os_str()],
        &["cell 1", "3 corners"],
    );
    let nameless = source.write("nameless.csv", "a,x,y\n1,0,0\n");
    assert_arguments_refused(
        [OsStr::new("import"), OsStr::new("outlines"), nameless.as_os_str()],
        &["line 1", "track"],
    );
}
