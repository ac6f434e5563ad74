//! Arrays that are not what they should be.

use crate::refusal::assert_unreadable;
use crate::scratch::{Folder, npy, read};
use ndarray::{Array2, Array3, Axis};
use std::fs;

/// Asserts what is said about these bytes in place of the positions and in place of the velocities.
#[track_caller]
fn assert_bytes_refused(bytes: &[u8], facts: &[&str]) {
    for name in ["positions.npy", "velocities.npy"] {
        let data = Folder::copy_of("chiral-liquid");
        data.write(name, bytes);
        let place = data.file(name).display().to_string();
        assert_unreadable(data.path(), &[], &[&[place.as_str()], facts].concat());
    }
}

/// Asserts what is said about a changed array in either place.
#[track_caller]
fn assert_change_refused(change: impl Fn(&mut Array2<f64>), facts: &[&str]) {
    for name in ["positions.npy", "velocities.npy"] {
        let data = Folder::copy_of("chiral-liquid");
        data.change(name, &change);
        let place = data.file(name).display().to_string();
        assert_unreadable(data.path(), &[], &[&[place.as_str()], facts].concat());
    }
}

#[test]
fn three_columns_are_refused() {
    let body = [0; 100 * 3 * 8];
    assert_bytes_refused(&npy("<f8", "False", "(100, 3)", &body), &["shape (100, 3)", "x, y"]);
}

#[test]
fn a_flat_array_and_four_axes_are_refused() {
    let body = [0; 16];
    assert_bytes_refused(&npy("<f8", "False", "(2,)", &body), &["shape (2,)"]);
    assert_bytes_refused(&npy("<f8", "False", "(1, 1, 1, 2)", &body), &["shape (1, 1, 1, 2)"]);
}

#[test]
fn an_array_without_cells_is_refused() {
    let data = Folder::copy_of("chiral-liquid");
    data.write_array("positions.npy", &Array2::<f64>::zeros((0, 2)));
    assert_unreadable(data.path(), &[], &["positions.npy", "no cells"]);
}

#[test]
fn elements_that_are_not_real_numbers_are_refused() {
    for (descr, size) in [("<c16", 16), ("|b1", 1), ("<U4", 16), ("|O", 8)] {
        let body = vec![0; 4 * 2 * size];
        assert_bytes_refused(&npy(descr, "False", "(4, 2)", &body), &["type", &descr[1..]]);
    }
}

#[test]
fn half_absent_cells_are_refused() {
    assert_change_refused(|array| array[[7, 1]] = f64::NAN, &["frame 0, cell 7", "half absent"]);
}

#[test]
fn infinite_values_are_refused() {
    assert_change_refused(|array| array[[99, 0]] = f64::INFINITY, &["frame 0, cell 99", "inf"]);
    assert_change_refused(|array| array[[0, 1]] = f64::NEG_INFINITY, &["frame 0, cell 0", "inf"]);
}

#[test]
fn truncated_arrays_are_refused() {
    let data = Folder::copy_of("chiral-liquid");
    let whole = fs::read(data.file("positions.npy")).unwrap();
    assert_bytes_refused(&whole[..whole.len() - 8], &["truncated", "(100, 2)", "1600 bytes", "1592 bytes"]);
    assert_bytes_refused(&whole[..40], &["header", "40"]);
}

#[test]
fn empty_files_are_refused() {
    assert_bytes_refused(b"", &["is empty"]);
}

#[test]
fn files_of_other_kinds_are_refused() {
    assert_bytes_refused(b"x,y\n1.0,2.0\n", &["not a .npy file"]);
    assert_bytes_refused(b"PK\x03\x04 and the rest of an archive", &["not a .npy file"]);
    assert_bytes_refused(b"\x1f\x8b\x08 and the rest of a gzip stream", &["not a .npy file"]);
}

#[test]
fn a_huge_claimed_size_is_refused_without_being_believed() {
    for shape in
        ["(1000000000000, 2)", "(4611686018427387904, 2)", "(9223372036854775807, 9223372036854775807, 2)"]
    {
        assert_bytes_refused(&npy("<f8", "False", shape, &[0; 32]), &["truncated", "32 bytes"]);
    }
}

#[test]
fn velocities_of_another_shape_are_refused() {
    let data = Folder::copy_of("chiral-liquid");
    data.change("velocities.npy", |velocities| velocities.remove_index(Axis(0), 99));
    let facts = ["velocities.npy", "(1, 99, 2)", "(1, 100, 2)"];
    assert_unreadable(data.path(), &[], &facts);
}

#[test]
fn velocities_of_fewer_frames_are_refused() {
    let data = Folder::copy_of("open-field");
    let positions: Array3<f64> = read(&data.file("positions.npy"));
    let (frames, cells, _) = positions.dim();
    data.write_array("velocities.npy", &Array3::<f64>::zeros((frames - 1, cells, 2)));
    let [found, expected] = [frames - 1, frames].map(|count| format!("({count}, {cells}, 2)"));
    assert_unreadable(data.path(), &[], &["velocities.npy", &found, &expected]);
}
