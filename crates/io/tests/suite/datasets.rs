//! Loading, checking and saving data sets.

use ndarray::{Array, Array2, Array3, Array4, Dimension, array};
use sha2::{Digest, Sha256};
use voronudge_io::{
    Boundary, DataSet, DeclaredWindow, Error, FlowField, Noise, OutputDirectory, PositionsAre, Source,
    WindowKind, YAxis,
};

use crate::{Scratch, assert_told};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

fn open_source(scratch: &Scratch) -> Source {
    Source { folder: Some(scratch.root().to_path_buf()), boundary: Some(Boundary::Open), ..Source::default() }
}

/// Loads one array of positions in an open field of view.
fn load_positions(positions: &Array3<f64>) -> Result<DataSet, Error> {
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", positions);
    open_source(&scratch).load()
}

fn three_frames() -> Array3<f64> {
    Array3::from_shape_fn((3, 4, 2), |(f, c, a)| 1.5 * c as f64 + 0.125 * f as f64 + 0.75 * a as f64)
}

/// Three frames on a grid of 4 columns and 2 rows, with a missing point.
fn flow() -> FlowField {
    let mut velocities = Array4::from_shape_fn((3, 2, 4, 2), |(f, row, column, a)| {
        (f + 3 * row + 5 * column + a) as f64 / 3.0
    });
    for axis in 0..2 {
        velocities[[2, 1, 3, axis]] = NAN;
    }
    FlowField { velocities, x: vec![0.0, 0.1, 0.2, 0.1 + 0.2], y: vec![-1.0, -3.0] }
}

fn full_data() -> DataSet {
    let mut positions = three_frames();
    let mut velocities = positions.mapv(|value| 2.0 - value);
    for axis in 0..2 {
        positions[[1, 2, axis]] = NAN;
        velocities[[0, 3, axis]] = NAN;
    }
    DataSet {
        positions,
        velocities: Some(velocities),
        flow: Some(flow()),
        labels: Some(Array2::from_shape_fn((3, 4), |(f, c)| f as i64 - 2 * c as i64)),
        position_errors: Some(Array2::from_shape_fn((3, 4), |(f, c)| 0.1 / (1 + f + c) as f64)),
        positions_are: Some(PositionsAre::between(0.1 + 0.2).unwrap()),
        window: DeclaredWindow { kind: Some(WindowKind::GaussianArea), width: Some(1.0 / 3.0) },
        boundary: Boundary::Periodic { lengths: [10.0, 0.1 + 0.2 + 20.0] },
        box_offset: None,
        walls: None,
        frame_interval: 1.0 / 3.0,
        length_unit: "\"µm\" \\ '".into(),
        time_unit: "line\nbreak".into(),
        y_axis: YAxis::Down,
        unwrapped: true,
        position_noise: Some(Noise::Relative(0.1 / 3.0)),
        velocity_noise: Some(Noise::Absolute(1e-300)),
        inputs: Vec::new(),
        field_of_view: None,
    }
}

/// Equal bit by bit but for zeros of either sign, NaN equal to NaN.
fn same<D: Dimension>(a: &Array<f64, D>, b: &Array<f64, D>) -> bool {
    let equal = |(x, y): (&f64, &f64)| x == y || (x.is_nan() && y.is_nan());
    a.dim() == b.dim() && a.iter().zip(b).all(equal)
}

fn round_trip(data: &DataSet) -> DataSet {
    let scratch = Scratch::new();
    let path = scratch.path("saved");
    let mut out = OutputDirectory::create(&path).unwrap();
    data.save(&mut out).unwrap();
    out.commit().unwrap();
    let source = Source { folder: Some(path), ..Source::default() };
    source.load().unwrap()
}

#[track_caller]
fn assert_same(a: &DataSet, b: &DataSet) {
    assert!(same(&a.positions, &b.positions));
    match (&a.velocities, &b.velocities) {
        (Some(a), Some(b)) => assert!(same(a, b)),
        (a, b) => assert_eq!(a.is_some(), b.is_some()),
    }
    match (&a.flow, &b.flow) {
        (Some(a), Some(b)) => {
            assert!(same(&a.velocities, &b.velocities));
            assert_eq!((&a.x, &a.y), (&b.x, &b.y));
        }
        (a, b) => assert_eq!(a.is_some(), b.is_some()),
    }
    // The rest compares directly once what holds NaN is out of the way.
    let rest = |data: &DataSet| DataSet {
        positions: Array3::zeros((0, 0, 2)),
        velocities: None,
        flow: None,
        inputs: Vec::new(),
        ..data.clone()
    };
    assert_eq!(rest(a), rest(b));
}

#[test]
fn saving_and_loading_is_the_identity() {
    let full = full_data();
    assert_same(&full, &round_trip(&full));
    let bare = DataSet {
        velocities: None,
        flow: None,
        labels: None,
        position_errors: None,
        positions_are: Some(PositionsAre::CENTROIDS),
        window: DeclaredWindow::default(),
        boundary: Boundary::Open,
        y_axis: YAxis::Up,
        unwrapped: false,
        position_noise: None,
        velocity_noise: None,
        field_of_view: None,
        ..full
    };
    assert_same(&bare, &round_trip(&bare));
}

#[test]
fn what_could_not_be_loaded_is_not_saved() {
    let scratch = Scratch::new();
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    let mut data = full_data();
    data.frame_interval = 0.0;
    assert_told(data.save(&mut out), &["frame_interval is 0"], "positive number");
    let mut data = full_data();
    data.velocities = Some(Array3::zeros((3, 3, 2)));
    let facts = ["velocities.npy: has shape (3, 3, 2)", "shape (3, 4, 2)"];
    assert_told(data.save(&mut out), &facts, "same cell");
    let mut data = full_data();
    data.flow.as_mut().unwrap().x.pop();
    let facts = ["flow_x.npy: has 3 x coordinates", "4 points along x"];
    assert_told(data.save(&mut out), &facts, "rows (y), columns (x)");
    let mut data = full_data();
    data.positions = Array3::zeros((3, 0, 2));
    assert_told(data.save(&mut out), &["positions.npy", "no cells"], "empty");
    assert!(out.staged().is_empty());
}

#[test]
fn y_down_is_turned_up_in_memory_and_down_on_disk() {
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", &array![[1.0, 2.0], [3.0, 0.0]]);
    scratch.write_array("velocities.npy", &array![[5.0, 6.0], [NAN, NAN]]);
    scratch.write("dataset.toml", "boundary = \"periodic\"\nbox = [9, 9]\ny_axis = \"down\"");
    let source = Source { folder: Some(scratch.root().to_path_buf()), ..Source::default() };
    let data = source.load().unwrap();
    assert_eq!(data.positions, array![[[1.0, -2.0], [3.0, 0.0]]]);
    assert!(data.positions[[0, 1, 1]].is_sign_positive());
    let velocities = data.velocities.as_ref().unwrap();
    assert_eq!((velocities[[0, 0, 0]], velocities[[0, 0, 1]]), (5.0, -6.0));
    let mut out = OutputDirectory::create(scratch.path("saved")).unwrap();
    data.save(&mut out).unwrap();
    let written = out.commit().unwrap();
    let stored = voronudge_io::read_reals(&written[0]).unwrap();
    assert_eq!(stored, array![[[1.0, 2.0], [3.0, 0.0]]].into_dyn());
}

#[test]
fn files_one_by_one_need_no_folder() {
    let scratch = Scratch::new();
    let positions = scratch.write_array("here.npy", &three_frames());
    let velocities = scratch.write_array("there.npy", &three_frames());
    let labels = scratch.write_array("kinds.npy", &array![1_u8, 2, 3, 4]);
    let source = Source {
        positions: Some(positions.clone()),
        velocities: Some(velocities.clone()),
        labels: Some(labels.clone()),
        boundary: Some(Boundary::Open),
        ..Source::default()
    };
    let data = source.load().unwrap();
    assert_eq!((data.frames(), data.cells()), (3, 4));
    assert_eq!(data.velocities, Some(three_frames()));
    let row = [1, 2, 3, 4];
    assert_eq!(data.labels, Some(Array2::from_shape_fn((3, 4), |(_, c)| row[c])));
    let paths: Vec<_> = data.inputs.iter().map(|input| input.path.clone()).collect();
    assert_eq!(paths, [positions, velocities, labels]);
}

#[test]
fn a_file_flag_wins_over_the_folder() {
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", &three_frames());
    let other = scratch.write_array("other.npy", &(three_frames() + 1.0));
    let source = Source { positions: Some(other), ..open_source(&scratch) };
    assert_eq!(source.load().unwrap().positions, three_frames() + 1.0);
}

#[test]
fn inputs_carry_the_sum_of_the_bytes_read() {
    let scratch = Scratch::new();
    let path = scratch.write_array("positions.npy", &three_frames());
    scratch.write("dataset.toml", "boundary = \"open\"");
    let data = open_source(&scratch).load().unwrap();
    assert_eq!(data.inputs.len(), 2);
    assert!(data.inputs[0].path.ends_with("dataset.toml"));
    assert_eq!(data.inputs[1].path, path);
    let sum = Sha256::digest(std::fs::read(&path).unwrap());
    let hex: String = sum.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(data.inputs[1].sha256, hex);
}

#[test]
fn a_folder_without_settings_needs_a_boundary() {
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", &three_frames());
    assert!(open_source(&scratch).load().is_ok());
    let source = Source { boundary: None, ..open_source(&scratch) };
    let facts = ["the boundary is not given: neither by", "dataset.toml"];
    assert_told(source.load(), &facts, "--open or --box");
    let source = Source { positions: Some(scratch.path("positions.npy")), ..Source::default() };
    assert_told(source.load(), &["the boundary is not given"], "--open");
}

#[test]
fn missing_places_are_told() {
    let scratch = Scratch::new();
    let source = Source { folder: Some(scratch.path("nowhere")), ..open_source(&scratch) };
    assert_told(source.load(), &["nowhere: no such file or folder"], "spelling");
    let facts = ["positions.npy: no such file"];
    assert_told(open_source(&scratch).load(), &facts, "positions.npy");
    let source = Source { boundary: Some(Boundary::Open), ..Source::default() };
    assert_told(source.load(), &["no positions are given"], "--positions FILE");
    let file = scratch.write_array("positions.npy", &three_frames());
    let source = Source { folder: Some(file), ..open_source(&scratch) };
    let facts = ["positions.npy: is a file, a data set folder is needed"];
    assert_told(source.load(), &facts, "--positions FILE");
    let source = Source { velocities: Some(scratch.path("v.npy")), ..open_source(&scratch) };
    assert_told(source.load(), &["v.npy: no such file"], "spelling");
}

#[test]
fn absent_cells_are_legal_even_for_a_whole_frame() {
    let mut positions = three_frames();
    positions.index_axis_mut(ndarray::Axis(0), 1).fill(NAN);
    let data = load_positions(&positions).unwrap();
    assert!(same(&data.positions, &positions));
}

#[test]
fn infinities_are_told_with_frame_and_cell() {
    for (x, y) in [(INF, 1.0), (1.0, -INF), (INF, NAN)] {
        let mut positions = three_frames();
        positions[[2, 3, 0]] = x;
        positions[[2, 3, 1]] = y;
        let fact = format!("frame 2, cell 3: infinite value ({x}, {y})");
        assert_told(load_positions(&positions), &["positions.npy", &fact], "NaN in both");
    }
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", &array![[1.0, 2.0], [3.0, 4.0]]);
    scratch.write_array("velocities.npy", &array![[1.0, 2.0], [INF, 4.0]]);
    let facts = ["velocities.npy: frame 0, cell 1: infinite"];
    assert_told(open_source(&scratch).load(), &facts, "NaN");
}

#[test]
fn half_absent_cells_are_told() {
    for (x, y) in [(NAN, 2.0), (2.0, NAN)] {
        let mut positions = three_frames();
        positions[[1, 0, 0]] = x;
        positions[[1, 0, 1]] = y;
        let fact = format!("positions.npy: frame 1, cell 0: half absent ({x}, {y})");
        assert_told(load_positions(&positions), &[&fact], "both components");
    }
}

#[test]
fn two_cells_in_one_place_are_told() {
    let mut positions = three_frames();
    for axis in 0..2 {
        positions[[2, 3, axis]] = positions[[2, 1, axis]];
    }
    let facts = ["positions.npy: frame 2: cells 1 and 3 are both at (1.75, 2.5)"];
    assert_told(load_positions(&positions), &facts, "remove one");
    // Zeros of either sign are the same place; a shared coordinate alone is not.
    let facts = ["frame 0: cells 0 and 2 are both at (0, 1)"];
    let positions = array![[[0.0, 1.0], [0.0, 2.0], [-0.0, 1.0]]];
    assert_told(load_positions(&positions), &facts, "double detection");
}

#[test]
fn velocities_must_have_the_shape_of_the_positions() {
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", &three_frames());
    scratch.write_array("velocities.npy", &array![[1.0, 2.0], [3.0, 4.0]]);
    let facts = ["velocities.npy: has shape (1, 2, 2)", "positions have shape (3, 4, 2)"];
    assert_told(open_source(&scratch).load(), &facts, "same cell");
}

#[test]
fn labels_must_count_the_cells() {
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", &three_frames());
    let load = |labels: ndarray::ArrayD<i64>| {
        scratch.write_array("labels.npy", &labels);
        open_source(&scratch).load()
    };
    let labels = Array2::from_shape_fn((3, 4), |(f, c)| (10 * f + c) as i64);
    let data = load(labels.clone().into_dyn()).unwrap();
    assert_eq!(data.labels, Some(labels));
    let facts = ["labels.npy: has shape (5,)", "positions have shape (3, 4, 2)"];
    assert_told(load(array![1, 2, 3, 4, 5].into_dyn()), &facts, "same cell");
    let facts = ["labels.npy: has shape (4, 3)", "(3, 4, 2)"];
    assert_told(load(Array2::zeros((4, 3)).into_dyn()), &facts, "same cell");
    let facts = ["(3, 4, 1) with 3 dimensions, expected (cells,) or (frames, cells)"];
    assert_told(load(Array3::zeros((3, 4, 1)).into_dyn()), &facts, "axes are");
    scratch.write_array("labels.npy", &array![1.0, 2.0, 3.0, 4.0]);
    let facts = ["labels.npy", "type <f8, integers"];
    assert_told(open_source(&scratch).load(), &facts, "int64");
}

#[test]
fn a_box_that_cannot_be_right_is_told() {
    let scratch = Scratch::new();
    // The first frame is absent, so the second one is looked at.
    let positions = array![[[NAN, NAN], [NAN, NAN]], [[0.0, -1.0], [3.0, 15.0]]];
    scratch.write_array("positions.npy", &positions);
    let load = |lengths, unwrapped| {
        let source =
            Source { boundary: Some(Boundary::Periodic { lengths }), unwrapped, ..open_source(&scratch) };
        source.load()
    };
    let facts = ["frame 1: the box is too small", "extend over 16 along y", "length is 10"];
    assert_told(load([10.0, 10.0], None), &facts, "--unwrapped");
    let facts = ["extend over 3 along x", "box length is 1.5"];
    assert_told(load([1.5, 20.0], None), &facts, "unwrapped = true");
    assert!(load([10.0, 10.0], Some(true)).is_ok());
    // Exactly one and a half lengths is still taken.
    assert!(load([2.0, 16.0 / 1.5], None).is_ok());
}

#[test]
fn position_errors_must_be_those_of_the_cells() {
    let scratch = Scratch::new();
    let mut positions = three_frames();
    for axis in 0..2 {
        positions[[1, 2, axis]] = NAN;
    }
    scratch.write_array("positions.npy", &positions);
    let load = |errors: ndarray::ArrayD<f64>| {
        scratch.write_array("position_errors.npy", &errors);
        open_source(&scratch).load()
    };
    // One row holds in every frame; cells that are absent need none.
    let data = load(array![0.1, 0.2, 0.3, 0.4].into_dyn()).unwrap();
    assert_eq!(data.position_errors.unwrap()[[2, 3]], 0.4);
    let mut errors = Array2::from_elem((3, 4), 0.2);
    errors[[1, 2]] = NAN;
    assert!(load(errors.clone().into_dyn()).is_ok());
    for (value, fact) in
        [(0.0, "deviation is 0"), (NAN, "deviation is NaN"), (-1.0, "deviation is -1"), (INF, "is inf")]
    {
        errors[[2, 1]] = value;
        let facts = ["position_errors.npy: frame 2, cell 1: the standard", fact];
        assert_told(load(errors.clone().into_dyn()), &facts, "each cell that is present");
    }
    let facts = ["position_errors.npy: has shape (4, 3)", "(3, 4, 2)"];
    assert_told(load(Array2::from_elem((4, 3), 1.0).into_dyn()), &facts, "same cell");
}
