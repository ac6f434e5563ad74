//! Searches that cannot be meant.

use crate::program::fixture;
use crate::refusal::assert_refused;
use crate::scratch::Folder;
use ndarray::{Array1, Array3};

#[track_caller]
fn assert_discover_refuses(flags: &str, facts: &[&str]) {
    let flags: Vec<&str> = flags.split_whitespace().collect();
    assert_refused("discover", &fixture("chiral-liquid"), &flags, facts);
}

#[test]
fn unknown_effects_are_refused() {
    assert_discover_refuses("--effects persistance", &["--effects", "no effect \"persistance\""]);
    assert_discover_refuses("--effects drift,nothing", &["--effects", "\"nothing\""]);
    assert_discover_refuses("--without drifts", &["--without", "\"drifts\""]);
    assert_discover_refuses("--effects drift --without drift", &["no candidate is left"]);
}

#[test]
fn a_misspelt_effect_is_recognised() {
    let data = fixture("chiral-liquid");
    let out = Folder::new();
    let arguments = ["discover".as_ref(), data.as_os_str(), "--effects".as_ref(), "persistance".as_ref()];
    let end = ["--out".as_ref(), out.path().as_os_str()];
    let outcome = crate::program::voronudge(arguments.into_iter().chain(end));
    assert!(outcome.stderr.contains("hint: did you mean persistence?"), "{}", outcome.stderr);
}

#[test]
fn searches_out_of_range_are_refused() {
    for (flags, fact) in [
        ("--level 0", "not between 0 and 1"),
        ("--level 1", "not between 0 and 1"),
        ("--level -0.1", "not between 0 and 1"),
        ("--level often", "often is not a number"),
        ("--null-sets -1", "--null-sets"),
        ("--null-sets 10001", "--null-sets"),
        ("--most-effects 0", "--most-effects"),
        ("--most-effects 17", "--most-effects"),
        ("--starts 0", "--starts"),
        ("--difference sideways", "--difference"),
        ("--given-difference sideways", "--given-difference"),
        ("--method descent", "--method"),
        ("--bootstrap 100", "--bootstrap"),
        ("--largest-area 0", "--largest-area"),
        ("--fix K_B=1", "K_B is not a parameter"),
        ("--frames 3", "frame"),
    ] {
        assert_discover_refuses(flags, &[fact]);
    }
}

#[test]
fn a_statement_on_velocities_that_are_not_given_is_refused() {
    let facts = ["--given-difference is for velocities that are given"];
    assert_refused("discover", &fixture("open-field"), &["--given-difference", "forward"], &facts);
}

#[test]
fn simulations_to_compare_with_take_a_movie() {
    assert_discover_refuses("--check", &["--check: 1 frame, but a comparison", "takes four at least"]);
}

#[test]
fn frames_without_velocities_are_refused() {
    let facts = ["positions.npy, frame 4", "no cell has a velocity"];
    let flags = ["--frames", "4", "--difference", "forward"];
    assert_refused("discover", &fixture("open-field"), &flags, &facts);
    let facts = ["positions.npy, frame 4", "tracks take two frames or more"];
    assert_refused("discover", &fixture("open-field"), &flags[..2], &facts);
}

#[test]
fn labels_of_another_number_of_cells_are_refused() {
    let data = Folder::copy_of("chiral-liquid");
    data.write_array("labels.npy", &Array1::from_elem(7, 1_i64));
    assert_refused("discover", data.path(), &[], &["labels.npy", "7"]);
    let data = Folder::copy_of("chiral-liquid");
    data.write_array("types.npy", &Array1::from_elem(7, 1_i64));
    let file = data.file("types.npy");
    assert_refused("discover", data.path(), &["--labels", file.to_str().unwrap()], &["types.npy", "7"]);
}

#[test]
fn external_fields_that_are_none_are_refused() {
    let data = Folder::copy_of("chiral-liquid");
    data.write_array("x.npy", &Array1::linspace(0.0, 9.0, 4));
    data.write_array("y.npy", &Array1::linspace(0.0, 9.0, 3));
    let [field, x, y] = ["field.npy", "x.npy", "y.npy"].map(|name| data.file(name));
    let [field, x, y] = [&field, &x, &y].map(|file| file.to_str().unwrap());
    let refused = |flags: &[&str], facts: &[&str]| assert_refused("discover", data.path(), flags, facts);
    refused(&["--field", field], &["--field-x"]);
    refused(&["--field-x", x], &["--field"]);
    let all = ["--field", field, "--field-x", x, "--field-y", y];
    refused(&all, &["field.npy", "no such file"]);
    data.write_array("field.npy", &Array3::<f64>::zeros((4, 4, 2)));
    refused(&all, &["y.npy", "3"]);
    let mut vectors = Array3::<f64>::ones((3, 4, 2));
    vectors[[1, 2, 0]] = f64::NAN;
    vectors[[1, 2, 1]] = f64::NAN;
    data.write_array("field.npy", &vectors);
    refused(&all, &["field.npy", "1 vectors are missing"]);
}

#[test]
fn what_is_for_velocities_is_refused_of_tracks() {
    for [option, value] in [["--null-sets", "3"], ["--background", "1"], ["--predict", "."]] {
        assert_refused("discover", &fixture("open-field"), &[option, value], &[option, "only tracks"]);
    }
}
