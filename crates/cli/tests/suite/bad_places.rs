//! Cells where no tissue can be.

use crate::refusal::{assert_refused, assert_unreadable};
use crate::scratch::Folder;
use ndarray::{Array2, array};

const OPEN: &str = "boundary = \"open\"\n";

/// Gives velocities to a data set that has positions only, so that nothing but its positions can be at fault.
fn moving(data: &Folder, cells: usize) {
    data.write_array("velocities.npy", &Array2::<f64>::ones((cells, 2)));
}

#[test]
fn two_cells_in_one_place_are_refused() {
    let data = Folder::copy_of("chiral-liquid");
    data.change("positions.npy", |r| {
        let (x, y) = (r[[3, 0]], r[[3, 1]]);
        (r[[8, 0]], r[[8, 1]]) = (x, y);
    });
    assert_unreadable(data.path(), &[], &["positions.npy", "frame 0", "cells 3 and 8"]);
}

#[test]
fn two_cells_in_one_place_after_wrapping_are_refused_by_their_numbers_in_the_file() {
    let data = Folder::copy_of("chiral-liquid");
    data.change("positions.npy", |r| {
        // An absent cell before them must not shift the numbers.
        (r[[1, 0]], r[[1, 1]]) = (f64::NAN, f64::NAN);
        (r[[4, 0]], r[[4, 1]]) = (0.5, 1.25);
        (r[[9, 0]], r[[9, 1]]) = (10.5, 1.25);
    });
    assert_unreadable(data.path(), &[], &["positions.npy, frame 0", "cells 4 and 9", "same point"]);
    assert_refused("check-gradients", data.path(), &[], &["positions.npy, frame 0", "cells 4 and 9"]);
}

#[test]
fn cells_on_one_line_are_refused() {
    let line = Array2::from_shape_fn((12, 2), |(cell, axis)| (cell * (axis + 1)) as f64);
    let data = Folder::data_set(&line, OPEN);
    moving(&data, 12);
    assert_unreadable(data.path(), &[], &["positions.npy, frame 0", "12 cells", "one line"]);
}

#[test]
fn too_few_cells_are_refused() {
    let data = Folder::data_set(&array![[0.0, 0.0], [1.0, 0.5]], OPEN);
    moving(&data, 2);
    assert_unreadable(data.path(), &[], &["positions.npy, frame 0", "2 cells"]);
}

#[test]
fn a_frame_without_any_cell_is_refused() {
    let data = Folder::data_set(&Array2::from_elem((5, 2), f64::NAN), OPEN);
    moving(&data, 5);
    assert_unreadable(data.path(), &[], &["positions.npy, frame 0", "0 cells"]);
}

#[test]
fn too_few_cells_with_a_closed_polygon_cannot_be_fitted() {
    let data = Folder::data_set(&array![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.1], [1.0, 1.2]], OPEN);
    moving(&data, 5);
    assert_refused("infer", data.path(), &[], &["positions.npy", "needs at least"]);
}

#[test]
fn a_box_too_small_for_the_cells_is_refused() {
    let data = Folder::copy_of("chiral-liquid");
    assert_unreadable(
        data.path(),
        &["--box", "2", "10"],
        &["positions.npy", "box", "along x", "length is 2"],
    );
}

#[test]
fn cells_that_do_not_move_cannot_be_fitted() {
    let data = Folder::copy_of("chiral-liquid");
    data.write_array("velocities.npy", &Array2::<f64>::zeros((100, 2)));
    assert_refused("infer", data.path(), &[], &["npy", "velocities are zero"]);
}

#[test]
fn cells_without_a_single_velocity_cannot_be_fitted() {
    let data = Folder::copy_of("chiral-liquid");
    data.write_array("velocities.npy", &Array2::from_elem((100, 2), f64::NAN));
    assert_refused("infer", data.path(), &[], &["npy", "0 cells have a measured velocity"]);
    assert_refused(
        "infer",
        data.path(),
        &["--frames", "0"],
        &["velocities.npy, frame 0", "no cell has a velocity"],
    );
}
