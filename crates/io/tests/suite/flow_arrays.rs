//! Imports of dense displacements.

use std::path::PathBuf;

use ndarray::{Array3, Array4, array};
use voronudge_io::{
    Boundary, Error, FlowColumnNames, FlowField, FlowImport, FlowOptions, ImageScale, OutputDirectory,
    Source, YAxis, import_flow,
};

use crate::{Scratch, assert_told};

const NAN: f64 = f64::NAN;

/// 6 rows and 4 columns of pixels; u and v are powers of two apart, so that means are exact.
fn dense() -> Array3<f64> {
    Array3::from_shape_fn((6, 4, 2), |(row, column, a)| (row * 4 + column) as f64 + 100.0 * a as f64)
}

fn up() -> FlowOptions {
    FlowOptions {
        scale: ImageScale { y_axis: Some(YAxis::Up), ..ImageScale::default() },
        ..FlowOptions::default()
    }
}

fn import(field: &Array3<f64>, options: &FlowOptions) -> Result<FlowImport, Error> {
    let scratch = Scratch::new();
    import_flow(&[scratch.write_array("flow.npy", field)], options)
}

fn field(import: FlowImport) -> FlowField {
    import.dataset.flow.unwrap()
}

#[test]
fn without_averaging_every_pixel_is_a_grid_point_at_its_centre() {
    let options = FlowOptions {
        scale: ImageScale { pixel_size: Some(0.5), frame_interval: Some(4.0), ..up().scale },
        ..up()
    };
    let import = import(&dense(), &options).unwrap();
    assert!(!import.is_complete());
    assert_eq!((import.summary.frames, import.summary.rows, import.summary.columns), (1, 6, 4));
    assert_eq!((import.summary.spacing, import.summary.missing), ([0.5, 0.5], 0));
    let flow = field(import);
    assert_eq!((flow.x[0], flow.x[3]), (0.25, 1.75));
    assert_eq!((flow.y[0], flow.y[5]), (0.25, 2.75));
    // Pixels per frame, half a unit each, in a quarter of the time.
    assert_eq!(flow.velocities, (dense() * 0.125).insert_axis(ndarray::Axis(0)));
}

#[test]
fn blocks_are_means_computed_by_hand() {
    let mut dense = dense();
    // Of the first square two of four pixels remain, of the second one of four.
    for (row, column) in [(0, 0), (1, 1), (0, 2), (0, 3), (1, 2)] {
        for axis in 0..2 {
            dense[[row, column, axis]] = NAN;
        }
    }
    let options = FlowOptions { grid_spacing: Some(2.0), ..up() };
    let import = import(&dense, &options).unwrap();
    assert_eq!((import.summary.rows, import.summary.columns, import.summary.missing), (3, 2, 1));
    let flow = field(import);
    assert_eq!((flow.x.as_slice(), flow.y.as_slice()), ([1.0, 3.0].as_slice(), [1.0, 3.0, 5.0].as_slice()));
    let at = |row: usize, column: usize| [0, 1].map(|axis| flow.velocities[[0, row, column, axis]]);
    assert_eq!(at(0, 0), [f64::midpoint(1.0, 4.0), 102.5]);
    assert!(at(0, 1).iter().all(|component| component.is_nan()));
    // Pixels 8, 9, 12, 13 and 18, 19, 22, 23.
    assert_eq!(at(1, 0), [10.5, 110.5]);
    assert_eq!(at(2, 1), [20.5, 120.5]);
}

#[test]
fn squares_need_not_be_whole_pixels_and_the_rest_is_left_out() {
    // Squares of 1.5 pixels have the pixels 0 | 1, 2 | 3 by their centres: 0.5 | 1.5, 2.5 | 3.5.
    let dense = Array3::from_shape_fn((4, 5, 2), |(_, column, _)| column as f64);
    let options = FlowOptions { grid_spacing: Some(1.5), ..up() };
    let flow = field(import(&dense, &options).unwrap());
    assert_eq!((flow.x.clone(), flow.y.clone()), (vec![0.75, 2.25, 3.75], vec![0.75, 2.25]));
    let row: Vec<f64> = (0..3).map(|column| flow.velocities[[0, 1, column, 0]]).collect();
    assert_eq!(row, [0.0, 1.5, 3.0]);
    // 16.25 / 0.65 is 25 pixels but for rounding: 100 pixels make four squares, 101 too.
    for pixels in [100, 101] {
        let dense = Array3::zeros((pixels, 100, 2));
        let options = FlowOptions {
            scale: ImageScale { pixel_size: Some(0.65), ..up().scale },
            grid_spacing: Some(16.25),
            ..up()
        };
        assert_eq!(import(&dense, &options).unwrap().summary.rows, 4);
    }
}

#[test]
fn rows_of_an_image_run_down() {
    let dense = dense();
    let import = import(&dense, &FlowOptions::default()).unwrap();
    assert_eq!(import.dataset.y_axis, YAxis::Down);
    let flow = import.dataset.flow.as_ref().unwrap();
    assert_eq!((flow.y[0], flow.y[5]), (-0.5, -5.5));
    assert_eq!(flow.velocities[[0, 0, 1, 1]], -101.0);
}

#[test]
fn a_vortex_that_turns_clockwise_in_the_image_does_so_in_memory() {
    // On the screen, y down: right of the centre the flow goes down, above it to the right.
    let dense = Array3::from_shape_fn((8, 8, 2), |(row, column, axis)| {
        let (x, y) = (column as f64 - 3.5, row as f64 - 3.5);
        if axis == 0 { -y } else { x }
    });
    let flow = field(import(&dense, &FlowOptions::default()).unwrap());
    let centre = [0, 1].map(|axis| {
        let coordinates = [&flow.x, &flow.y][axis];
        coordinates.iter().sum::<f64>() / 8.0
    });
    let mut turn = 0.0;
    for (row, y) in flow.y.iter().enumerate() {
        for (column, x) in flow.x.iter().enumerate() {
            let velocity = [0, 1].map(|axis| flow.velocities[[0, row, column, axis]]);
            turn += (x - centre[0]) * velocity[1] - (y - centre[1]) * velocity[0];
        }
    }
    // With y up, clockwise is a negative r × v.
    assert!(turn < -100.0, "{turn}");
}

#[test]
fn frames_come_from_one_file_or_several() {
    let scratch = Scratch::new();
    let frames = Array4::from_shape_fn((3, 2, 2, 2), |(f, j, i, a)| (f * 8 + j * 4 + i * 2 + a) as f32);
    let together = scratch.write_array("all.npy", &frames);
    let apart: Vec<PathBuf> = (0..3)
        .map(|f| scratch.write_array(&format!("{f}.npy"), &frames.index_axis(ndarray::Axis(0), f).to_owned()))
        .collect();
    let one = import_flow(std::slice::from_ref(&together), &up()).unwrap();
    let several = import_flow(&apart, &up()).unwrap();
    assert_eq!(one.dataset.flow, several.dataset.flow);
    assert_eq!(several.dataset.inputs.len(), 3);
    assert_eq!(field(one).velocities, frames.mapv(f64::from));
    let facts = ["all.npy: holds 3 frames, but of several files each must be one frame"];
    assert_told(import_flow(&[apart[0].clone(), together], &up()), &facts, "alone");
    let wide = scratch.write_array("wide.npy", &Array3::<f64>::zeros((2, 3, 2)));
    let facts = ["wide.npy: has 2 rows and 3 columns, but the first file has 2 and 2"];
    assert_told(import_flow(&[apart[0].clone(), wide], &up()), &facts, "same size");
    let table = scratch.write("piv.txt", "0 0 1 1\n1 0 1 1\n0 1 1 1\n1 1 1 1\n");
    for files in [[apart[0].clone(), table.clone()], [table, apart[0].clone()]] {
        assert_told(import_flow(&files, &up()), &["is an array after tables"], "only tables");
    }
    assert_told(import_flow(&[], &up()), &["no flow field is given"], "name the files");
}

#[test]
fn what_is_saved_is_loaded_again() {
    let scratch = Scratch::new();
    let flow = scratch.write_array("flow.npy", &dense());
    let positions = scratch.write_array("cells.npy", &array![[1.0, 2.0], [3.0, 4.0]]);
    let options = FlowOptions {
        scale: ImageScale {
            pixel_size: Some(0.65),
            frame_interval: Some(10.0),
            length_unit: Some("um".into()),
            time_unit: Some("min".into()),
            ..ImageScale::default()
        },
        ..FlowOptions::default()
    };
    for (positions, complete) in [(None, false), (Some(positions.clone()), true)] {
        let import =
            import_flow(std::slice::from_ref(&flow), &FlowOptions { positions, ..options.clone() }).unwrap();
        assert_eq!(import.is_complete(), complete);
        let path = scratch.path(if complete { "complete" } else { "flow-only" });
        let mut out = OutputDirectory::create(&path).unwrap();
        import.save(&mut out).unwrap();
        out.commit().unwrap();
        assert_eq!(path.join("positions.npy").exists(), complete);
        // What was missing is put into the folder.
        std::fs::copy(scratch.path("cells.npy"), path.join("positions.npy")).unwrap();
        let loaded = Source { folder: Some(path), ..Source::default() }.load().unwrap();
        assert_eq!(loaded.flow, import.dataset.flow);
        assert_eq!(loaded.positions, array![[[1.0, -2.0], [3.0, -4.0]]]);
        assert_eq!((loaded.y_axis, loaded.length_unit.as_str()), (YAxis::Down, "um"));
    }
}

#[test]
fn positions_are_held_to_the_rules_of_data_sets() {
    let scratch = Scratch::new();
    let flow = [scratch.write_array("flow.npy", &dense())];
    let import = |positions: &Array3<f64>| {
        let positions = Some(scratch.write_array("cells.npy", positions));
        import_flow(&flow, &FlowOptions { positions, ..up() })
    };
    let facts = ["flow.npy: number of frames is 1, but that of the positions is 2"];
    assert_told(import(&Array3::from_shape_fn((2, 1, 2), |_| 1.0)), &facts, "last frame");
    let facts = ["cells.npy: frame 0: cells 0 and 1 are both at (1, 1)"];
    assert_told(import(&Array3::from_shape_fn((1, 2, 2), |_| 1.0)), &facts, "double detection");
}

#[test]
fn arrays_that_cannot_be_meant_are_told() {
    let mut half = dense();
    half[[4, 2, 1]] = NAN;
    let mut infinite = dense();
    infinite[[5, 3, 0]] = f64::INFINITY;
    let coarse = FlowOptions { grid_spacing: Some(2.0), ..up() };
    for options in [up(), coarse] {
        let facts = ["flow.npy: frame 0, row 4, column 2: half missing (18, NaN)"];
        assert_told(import(&half, &options), &facts, "both components");
        let facts = ["flow.npy: frame 0, row 5, column 3: infinite value (inf, 123)"];
        assert_told(import(&infinite, &options), &facts, "never infinite");
    }
    let scratch = Scratch::new();
    let path = [scratch.write("flow.npy", b"x y u v\n")];
    assert_told(import_flow(&path, &up()), &["flow.npy: is not a .npy file"], "numpy.save");
    let path = [scratch.write("flow.npy.gz", b"\x1f\x8b\x08")];
    assert_told(import_flow(&path, &up()), &["flow.npy.gz: is not a .npy file"], "decompress");
    let path = [scratch.write_array("image.npy", &array![[1.0, 2.0]])];
    assert_told(import_flow(&path, &up()), &["image.npy: has shape (1, 2)"], "frames, rows, columns");
}

#[test]
fn options_that_cannot_be_meant_are_told() {
    let with = |options: FlowOptions| import(&dense(), &options);
    let facts = ["flow.npy: the grid spacing is 0.5, but a pixel is 1"];
    assert_told(with(FlowOptions { grid_spacing: Some(0.5), ..up() }), &facts, "not below one pixel");
    let facts = ["along x there are 4 pixels of 1, less than two squares of 2.5"];
    assert_told(with(FlowOptions { grid_spacing: Some(2.5), ..up() }), &facts, "smaller");
    assert_told(
        with(FlowOptions { grid_spacing: Some(1e300), ..up() }),
        &["less than two squares"],
        "smaller",
    );
    assert_told(with(FlowOptions { grid_spacing: Some(NAN), ..up() }), &["grid_spacing is NaN"], "positive");
    assert_told(
        with(FlowOptions { scale: ImageScale { pixel_size: Some(0.0), ..up().scale }, ..up() }),
        &["pixel_size is 0"],
        "positive",
    );
    assert_told(
        with(FlowOptions { scale: ImageScale { frame_interval: Some(-1.0), ..up().scale }, ..up() }),
        &["frame_interval is -1"],
        "positive",
    );
    let boundary = Some(Boundary::Periodic { lengths: [4.0, 4.0] });
    let facts = ["flow.npy: the grid extends over 5 along y, but the box length is 4"];
    assert_told(with(FlowOptions { boundary, ..up() }), &facts, "check the box");
    let columns = FlowColumnNames { x: Some("x".into()), ..FlowColumnNames::default() };
    let facts = ["flow.npy: is an array, but columns"];
    assert_told(with(FlowOptions { columns, ..up() }), &facts, "--x-column");
}
