//! `evaluate`: the model's fields against recorded answers, and their shapes.

use crate::program::{fixture, succeed};
use crate::scratch::{Folder, assert_close, read, report};
use ndarray::{Array1, Array2, Array3, ArrayD};
use ndarray_npy::NpzReader;
use std::fs::File;

#[test]
fn a_second_implementation_agrees() {
    let (data, out) = (fixture("reference-small"), Folder::new());
    let parameters = data.join("parameters.json");
    let paths = [("", data.as_path()), ("--parameters", &parameters), ("--out", out.path())];
    succeed("evaluate --jacobian", &paths);
    for name in ["areas.npy", "perimeters.npy", "velocities.npy", "stress.npy", "jacobian.npy"] {
        let (found, recorded): (ArrayD<f64>, ArrayD<f64>) = (read(&out.file(name)), read(&data.join(name)));
        assert_close(&found, &recorded, 1e-10);
    }
}

#[test]
fn flags_win_over_the_parameter_file() {
    let data = fixture("reference-small");
    let parameters = data.join("parameters.json");
    let line = "evaluate --K_A 0.15 --K_P 1.2 --P_0 3.9 --A_0 1.1 --alpha -0.8";
    let (flags, both) = (Folder::new(), Folder::new());
    succeed(line, &[("", &data), ("--out", flags.path())]);
    let found: ArrayD<f64> = read(&flags.file("velocities.npy"));
    assert_close(&found, &read(&data.join("velocities.npy")), 1e-10);
    let paths = [("", data.as_path()), ("--parameters", &parameters), ("--out", both.path())];
    succeed("evaluate --alpha 2", &paths);
    let used = &report(both.path())["parameters"];
    assert_eq!((used["K_A"].as_f64(), used["alpha"].as_f64()), (Some(0.15), Some(2.0)));
}

#[test]
fn the_files_of_one_frame_have_no_axis_of_frames() {
    let (data, out) = (fixture("chiral-liquid"), Folder::new());
    succeed("evaluate", &[("", &data), ("--out", out.path())]);
    let names = ["areas.npy", "perimeters.npy", "report.json", "stress.npy", "velocities.npy"];
    assert_eq!(out.names(), names);
    let shape = |name: &str| read::<f64, ndarray::IxDyn>(&out.file(name)).shape().to_vec();
    assert_eq!(shape("velocities.npy"), [100, 2]);
    assert_eq!(shape("areas.npy"), [100]);
    assert_eq!(shape("perimeters.npy"), [100]);
    assert_eq!(shape("stress.npy"), [2, 2]);
    let areas: Array1<f64> = read(&out.file("areas.npy"));
    assert!((areas.sum() - 100.0).abs() < 1e-9, "polygons tile the box");
}

#[test]
fn the_files_of_several_frames_begin_with_an_axis_of_frames() {
    let data = fixture("open-field");
    let positions: Array3<f64> = read(&data.join("positions.npy"));
    let cells = positions.dim().1;
    for (flags, frames) in [("", vec![0, 1, 2, 3, 4]), ("--frames 1,3", vec![1, 3]), ("--frames 2", vec![2])]
    {
        let out = Folder::new();
        succeed(&format!("evaluate {flags}"), &[("", &data), ("--out", out.path())]);
        let shape = |name: &str| read::<f64, ndarray::IxDyn>(&out.file(name)).shape().to_vec();
        let count = frames.len();
        assert_eq!(shape("velocities.npy"), [count, cells, 2]);
        assert_eq!(shape("areas.npy"), [count, cells]);
        assert_eq!(shape("perimeters.npy"), [count, cells]);
        assert_eq!(shape("stress.npy"), [count, 2, 2]);
        let report = report(out.path());
        assert_eq!(report["cells"]["frames"], serde_json::json!(frames));
        let velocities: Array3<f64> = read(&out.file("velocities.npy"));
        for (index, &frame) in frames.iter().enumerate() {
            for cell in 0..cells {
                let absent = positions[[frame, cell, 0]].is_nan();
                assert!(!absent || velocities[[index, cell, 0]].is_nan(), "an absent cell has no velocity");
            }
        }
    }
}

#[test]
fn the_mirror_image_of_a_tissue_has_the_mirror_image_of_its_fields() {
    let up = Folder::copy_of("reference-small");
    let down = Folder::copy_of("reference-small");
    down.change("positions.npy", |r| r.column_mut(1).mapv_inplace(|y| -y));
    down.change("velocities.npy", |v| v.column_mut(1).mapv_inplace(|y| -y));
    let out = [Folder::new(), Folder::new()];
    succeed("evaluate --jacobian --alpha 1.5", &[("", up.path()), ("--out", out[0].path())]);
    succeed("evaluate --jacobian --alpha 1.5 --y-axis down", &[("", down.path()), ("--out", out[1].path())]);
    // A sign for every y along the axes.
    let sign = |index: usize| if index % 2 == 1 { -1.0 } else { 1.0 };
    let mut expected: Array2<f64> = read(&out[0].file("velocities.npy"));
    expected.indexed_iter_mut().for_each(|((_, axis), v)| *v *= sign(axis));
    assert_close(&read(&out[1].file("velocities.npy")), &expected.into_dyn(), 1e-12);
    for name in ["stress.npy", "jacobian.npy"] {
        let mut expected: Array2<f64> = read(&out[0].file(name));
        expected.indexed_iter_mut().for_each(|((i, j), entry)| *entry *= sign(i) * sign(j));
        assert_close(&read(&out[1].file(name)), &expected.into_dyn(), 1e-12);
    }
}

#[test]
fn a_large_jacobian_is_sparse_and_ignores_translations() {
    let (data, out) = (Folder::new(), Folder::new());
    let line = "simulate --cells 2100 --time 0.01 --dt 0.005 --frames 1 --alpha 1 --quiet";
    succeed(line, &[("--out", data.path())]);
    succeed("evaluate --jacobian --alpha 1", &[("", data.path()), ("--out", out.path())]);
    assert!(!out.file("jacobian.npy").exists());
    let mut npz = NpzReader::new(File::open(out.file("jacobian.npz")).unwrap()).unwrap();
    let shape: Array1<i64> = npz.by_name("shape.npy").unwrap();
    let row: Array1<i64> = npz.by_name("row.npy").unwrap();
    let column: Array1<i64> = npz.by_name("column.npy").unwrap();
    let value: Array1<f64> = npz.by_name("value.npy").unwrap();
    assert_eq!(shape.to_vec(), [4200, 4200]);
    assert!(row.len() == value.len() && column.len() == value.len());
    // Moving all cells alike along x or along y moves no velocity.
    let mut sums = Array2::<f64>::zeros((4200, 2));
    for ((&i, &j), &entry) in row.iter().zip(&column).zip(&value) {
        sums[[i as usize, (j % 2) as usize]] += entry;
    }
    let largest = value.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
    let worst = sums.iter().fold(0.0_f64, |most, sum| most.max(sum.abs()));
    assert!(largest > 0.1 && worst < 1e-11 * largest, "{worst:e} of {largest:e}");
}
