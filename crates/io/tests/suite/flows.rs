//! Flow fields of data sets: every rule, every broken file told.

use std::path::PathBuf;

use ndarray::{Array1, Array4, ArrayD, IxDyn, ShapeBuilder, array};
use sha2::{Digest, Sha256};
use voronudge_io::{Boundary, DataSet, Error, FlowField, OutputDirectory, Source, YAxis};

use crate::{Scratch, assert_told};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

/// Two frames on 3 rows and 4 columns.
fn field() -> Array4<f64> {
    Array4::from_shape_fn((2, 3, 4, 2), |(f, row, column, a)| (100 * f + 20 * row + 2 * column + a) as f64)
}

fn x() -> Array1<f64> {
    array![10.0, 12.5, 15.0, 17.5]
}

fn y() -> Array1<f64> {
    array![3.0, 2.0, 1.0]
}

/// A folder with positions of two frames and this flow field.
fn folder(field: &ArrayD<f64>, x: &Array1<f64>, y: &Array1<f64>) -> Scratch {
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", &array![[[1.0, 2.0]], [[1.5, 2.5]]]);
    scratch.write_array("flow.npy", field);
    scratch.write_array("flow_x.npy", x);
    scratch.write_array("flow_y.npy", y);
    scratch
}

fn whole() -> Scratch {
    folder(&field().into_dyn(), &x(), &y())
}

fn source(scratch: &Scratch) -> Source {
    Source { folder: Some(scratch.root().to_path_buf()), boundary: Some(Boundary::Open), ..Source::default() }
}

fn load(field: ArrayD<f64>, x: &Array1<f64>, y: &Array1<f64>) -> Result<DataSet, Error> {
    source(&folder(&field, x, y)).load()
}

fn load_coordinates(x: &[f64], y: &[f64]) -> Result<DataSet, Error> {
    let zeros = Array4::<f64>::zeros((2, y.len(), x.len(), 2)).into_dyn();
    load(zeros, &Array1::from(x.to_vec()), &Array1::from(y.to_vec()))
}

#[test]
fn a_field_is_read_with_its_grid_and_recorded() {
    let scratch = whole();
    let data = source(&scratch).load().unwrap();
    let flow = data.flow.unwrap();
    assert_eq!(flow, FlowField { velocities: field(), x: x().to_vec(), y: y().to_vec() });
    assert_eq!((flow.frames(), flow.spacing(), flow.missing()), (2, [2.5, 1.0], 0));
    let names = ["positions.npy", "flow.npy", "flow_x.npy", "flow_y.npy"];
    assert_eq!(data.inputs.len(), names.len());
    for (input, name) in data.inputs.iter().zip(names) {
        assert_eq!(input.path, scratch.path(name));
        let sum = Sha256::digest(std::fs::read(&input.path).unwrap());
        let hex: String = sum.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(input.sha256, hex);
    }
}

#[test]
fn velocities_of_cells_may_be_there_too() {
    let scratch = whole();
    scratch.write_array("velocities.npy", &array![[[1.0, 0.0]], [[0.0, 1.0]]]);
    let data = source(&scratch).load().unwrap();
    assert!(data.velocities.is_some() && data.flow.is_some());
}

#[test]
fn files_one_by_one_win_over_the_folder() {
    let scratch = whole();
    let other = scratch.write_array("other.npy", &(field() + 1.0));
    let x_alone = scratch.write_array("columns.npy", &(x() * 2.0));
    let y_alone = scratch.write_array("rows.npy", &(y() * 3.0));
    let data = Source { flow: Some(other), ..source(&scratch) }.load().unwrap();
    assert_eq!(data.flow.unwrap().velocities, field() + 1.0);
    let flags = Source { flow_x: Some(x_alone), flow_y: Some(y_alone), ..source(&scratch) };
    let flow = flags.load().unwrap().flow.unwrap();
    assert_eq!((flow.spacing(), flow.velocities), ([5.0, 3.0], field()));
}

#[test]
fn one_frame_may_leave_out_its_axis() {
    let scratch = whole();
    scratch.write_array("positions.npy", &array![[1.0, 2.0]]);
    let one = field().index_axis_move(ndarray::Axis(0), 0);
    scratch.write_array("flow.npy", &one);
    let flow = source(&scratch).load().unwrap().flow.unwrap();
    assert_eq!(flow.velocities.dim(), (1, 3, 4, 2));
}

#[test]
fn single_precision_and_fortran_order_are_read() {
    let scratch = whole();
    let mut fortran = Array4::<f32>::zeros((2, 3, 4, 2).f());
    fortran.assign(&field().mapv(|value| value as f32));
    scratch.write_array("flow.npy", &fortran);
    // Pixels of 0.65 far from zero, as a camera and a single-precision file leave them.
    scratch.write_array("flow_x.npy", &Array1::from_shape_fn(4, |k| 1300.0 + 0.65 * k as f32));
    let flow = source(&scratch).load().unwrap().flow.unwrap();
    assert_eq!(flow.velocities, field());
    assert!((flow.spacing()[0] - 0.65).abs() < 1e-4);
}

#[test]
fn y_down_turns_components_and_rows_and_back() {
    let mut field = field();
    for axis in 0..2 {
        field[[1, 0, 0, axis]] = NAN;
    }
    field[[0, 0, 0, 1]] = 0.0;
    let scratch = folder(&field.clone().into_dyn(), &x(), &array![0.0, 1.0, 2.0]);
    let down = Source { y_axis: Some(YAxis::Down), ..source(&scratch) };
    let data = down.load().unwrap();
    let flow = data.flow.as_ref().unwrap();
    assert_eq!((flow.x.clone(), flow.y.clone()), (x().to_vec(), vec![0.0, -1.0, -2.0]));
    assert!(flow.y[0].is_sign_positive() && flow.velocities[[0, 0, 0, 1]].is_sign_positive());
    assert_eq!((flow.velocities[[0, 1, 2, 0]], flow.velocities[[0, 1, 2, 1]]), (24.0, -25.0));
    assert_eq!((flow.missing(), flow.spacing()), (1, [2.5, 1.0]));
    let mut out = OutputDirectory::create(scratch.path("saved")).unwrap();
    data.save(&mut out).unwrap();
    let saved = out.commit().unwrap();
    let names: Vec<_> = saved.iter().filter_map(|path| path.file_name()?.to_str()).collect();
    assert_eq!(names, ["positions.npy", "flow.npy", "flow_x.npy", "flow_y.npy", "dataset.toml"]);
    let stored = voronudge_io::read_reals(&saved[1]).unwrap();
    assert!(stored.iter().zip(&field).all(|(a, b)| a == b || (a.is_nan() && b.is_nan())));
    assert_eq!(voronudge_io::read_reals(&saved[3]).unwrap(), array![0.0, 1.0, 2.0].into_dyn());
}

#[test]
fn a_field_needs_both_coordinates_and_they_need_a_field() {
    for (name, axis) in [("flow_x.npy", 'x'), ("flow_y.npy", 'y')] {
        let scratch = whole();
        std::fs::remove_file(scratch.path(name)).unwrap();
        let fact = format!("flow.npy: the {axis} coordinates of this flow field are not given: there is no");
        assert_told(source(&scratch).load(), &[&fact, name], "--flow-x");
    }
    let scratch = whole();
    let alone = Source {
        positions: Some(scratch.path("positions.npy")),
        flow: Some(scratch.path("flow.npy")),
        boundary: Some(Boundary::Open),
        ..Source::default()
    };
    assert_told(alone.load(), &["flow.npy: the x coordinates of this flow field are not given"], "--flow-y");
    std::fs::remove_file(scratch.path("flow.npy")).unwrap();
    let facts = ["flow_x.npy: holds x coordinates of a flow field, but there is no flow field"];
    assert_told(source(&scratch).load(), &facts, "--flow FILE");
    let named = Source { flow: Some(PathBuf::from("gone.npy")), ..source(&scratch) };
    assert_told(named.load(), &["gone.npy: no such file"], "spelling");
}

#[test]
fn shapes_that_are_no_field_are_told() {
    let load = |shape: &[usize]| load(ArrayD::<f64>::zeros(IxDyn(shape)), &x(), &y());
    let facts = ["flow.npy: has shape (3, 4) with 2 dimensions, expected (ny, nx, 2)"];
    assert_told(load(&[3, 4]), &facts, "frames, rows, columns");
    let facts = ["flow.npy: has shape (2, 3, 4, 3)", "last axis must hold x, y"];
    assert_told(load(&[2, 3, 4, 3]), &facts, "frames, rows, columns");
    assert_told(load(&[2, 3, 4]), &["flow.npy: has shape (2, 3, 4)"], "moveaxis");
    assert_told(load(&[2, 2, 3, 4]), &["flow.npy: has shape (2, 2, 3, 4)"], "moveaxis");
    assert_told(load(&[0, 3, 4, 2]), &["flow.npy", "no frames"], "empty selection");
    assert_told(load(&[2, 0, 4, 2]), &["flow.npy", "no rows"], "empty selection");
    let facts = ["flow_x.npy: has 4 x coordinates, but the flow field has 3 points along x"];
    assert_told(load(&[2, 4, 3, 2]), &facts, "exchanged");
    let facts = ["flow.npy: number of frames is 3, but that of the positions is 2"];
    assert_told(load(&[3, 3, 4, 2]), &facts, "n − 1 frames");
    assert_told(load(&[3, 4, 2]), &["number of frames is 1"], "n − 1 frames");
    let scratch = whole();
    scratch.write_array("flow_y.npy", &array![[1.0, 2.0, 3.0]]);
    let facts = ["flow_y.npy: has shape (1, 3) with 2 dimensions, expected (ny,)"];
    assert_told(source(&scratch).load(), &facts, "one row of numbers");
}

#[test]
fn broken_files_are_told() {
    for name in ["flow.npy", "flow_x.npy", "flow_y.npy"] {
        let scratch = whole();
        let bytes = std::fs::read(scratch.path(name)).unwrap();
        let load = |bytes: &[u8]| {
            scratch.write(name, bytes);
            source(&scratch).load()
        };
        assert_told(load(&bytes[..bytes.len() - 1]), &[name, "is truncated"], "write it again");
        assert_told(load(b""), &[name, "is empty"], "write it again");
        assert_told(load(b"x,y,u,v\n"), &[name, "is not a .npy file"], "numpy.save");
        scratch.write_array(name, &array![true, false]);
        assert_told(source(&scratch).load(), &[name, "type |b1"], "float64");
        let mut huge =
            String::from_utf8_lossy(&bytes[10..128]).replace("'shape': (", "'shape': (999999999, ");
        huge.truncate(118);
        let huge = [&bytes[..10], huge.as_bytes(), &[0; 64]].concat();
        assert_told(load(&huge), &[name, "is truncated", "999999999"], "write it again");
    }
}

#[test]
fn values_that_cannot_be_meant_are_told_with_their_place() {
    for (vx, vy) in [(INF, 1.0), (1.0, -INF), (INF, NAN)] {
        let mut field = field();
        (field[[1, 2, 3, 0]], field[[1, 2, 3, 1]]) = (vx, vy);
        let fact = format!("flow.npy: frame 1, row 2, column 3: infinite value ({vx}, {vy})");
        assert_told(load(field.into_dyn(), &x(), &y()), &[&fact], "NaN in both");
    }
    for (vx, vy) in [(NAN, 1.0), (1.0, NAN)] {
        let mut field = field();
        (field[[0, 1, 0, 0]], field[[0, 1, 0, 1]]) = (vx, vy);
        let fact = format!("flow.npy: frame 0, row 1, column 0: half missing ({vx}, {vy})");
        assert_told(load(field.into_dyn(), &x(), &y()), &[&fact], "both components");
    }
}

#[test]
fn coordinates_must_be_an_even_grid() {
    let fine = [0.0, 1.0, 2.0];
    for good in [[0.0, 1.0, 2.0], [2.0, 1.0, 0.0], [-3.0, -1.0, 1.0], [0.0, 1.00005, 2.0]] {
        assert!(load_coordinates(&good, &fine).is_ok() && load_coordinates(&fine, &good).is_ok());
    }
    let told = |bad: &[f64], fact: &str, advice: &str| {
        assert_told(load_coordinates(bad, &fine), &["flow_x.npy: ", fact], advice);
        let fact = fact.replace("x coord", "y coord").replace("along x", "along y");
        assert_told(load_coordinates(&fine, bad), &["flow_y.npy: ", &fact], advice);
    };
    told(&[0.0, NAN, 2.0], "x coordinate 1 is NaN", "only velocities");
    told(&[0.0, 1.0, INF], "x coordinate 2 is inf", "only velocities");
    told(&[0.0, 1.0, 1.0], "x coordinate 2 is 1 after 1", "same distance");
    told(&[0.0, 1.0, 0.5], "x coordinate 2 is 0.5 after 1", "same distance");
    told(&[0.0, -1.0, 1.0], "x coordinate 2 is 1 after -1", "same distance");
    told(&[0.0, 1.001, 2.0], "x coordinate 1 is 1.001, on an even grid it is 1", "same distance");
    told(&[-1.7e308, 0.0, 1.7e308], "x coordinate", "same distance");
    told(&[4.0], "number of grid points along x is 1", "2 × 2");
}

#[test]
fn a_grid_covers_a_periodic_box_at_most_once() {
    let scratch = whole();
    let load = |lengths| {
        Source { boundary: Some(Boundary::Periodic { lengths }), ..source(&scratch) }.load().map(|_| ())
    };
    assert!(load([10.0, 3.0]).is_ok() && load([7.5, 2.0]).is_ok());
    let facts = ["flow_x.npy: the grid extends over 7.5 along x, but the box length is 7"];
    assert_told(load([7.0, 3.0]), &facts, "covers the box once");
    let facts = ["flow_y.npy: the grid extends over 2 along y, but the box length is 1.5"];
    assert_told(load([10.0, 1.5]), &facts, "covers the box once");
}
