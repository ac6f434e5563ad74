//! Results arrive whole or not at all.

use std::fs;
use std::path::Path;

use ndarray::{Array3, ShapeBuilder, array};
use voronudge_io::{OutputDirectory, OutputFolder, read_integers, read_reals};

use crate::{Scratch, assert_told, names};

#[test]
fn results_appear_at_the_commit_and_read_back() {
    let scratch = Scratch::new();
    let path = scratch.path("deep/er/results");
    let mut out = OutputDirectory::create(&path).unwrap();
    let reals = array![[1.5, f64::MIN_POSITIVE], [-0.0, 1e300]];
    out.write_array("reals.npy", reals.view()).unwrap();
    out.write_integers("integers.npy", array![1, -2, i64::MAX].view()).unwrap();
    out.write_text("note.txt", "µm").unwrap();
    out.write_bytes("raw.bin", &[0, 255]).unwrap();
    assert_eq!(out.staged(), ["reals.npy", "integers.npy", "note.txt", "raw.bin"]);
    assert!(!path.join("reals.npy").exists());
    let written = out.commit().unwrap();
    assert_eq!(written[0], path.join("reals.npy"));
    assert_eq!(names(&path), ["integers.npy", "note.txt", "raw.bin", "reals.npy"]);
    assert_eq!(read_reals(&written[0]).unwrap(), reals.into_dyn());
    let integers = read_integers(&written[1]).unwrap();
    assert_eq!(integers, array![1, -2, i64::MAX].into_dyn());
    assert_eq!(fs::read_to_string(&written[2]).unwrap(), "µm");
    assert_eq!(fs::read(&written[3]).unwrap(), [0, 255]);
}

#[test]
fn views_of_any_memory_order_read_back() {
    let scratch = Scratch::new();
    let standard = Array3::from_shape_fn((2, 3, 4), |(i, j, k)| (100 * i + 10 * j + k) as f64);
    let mut fortran = Array3::zeros((2, 3, 4).f());
    fortran.assign(&standard);
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    out.write_array("f.npy", fortran.view()).unwrap();
    out.write_array("t.npy", standard.t()).unwrap();
    let every_second = ndarray::Slice::new(0, None, 2);
    let strided = standard.slice_axis(ndarray::Axis(2), every_second);
    out.write_array("s.npy", strided).unwrap();
    let written = out.commit().unwrap();
    assert_eq!(read_reals(&written[0]).unwrap(), standard.clone().into_dyn());
    assert_eq!(read_reals(&written[1]).unwrap(), standard.t().into_dyn());
    assert_eq!(read_reals(&written[2]).unwrap(), strided.into_dyn());
}

#[test]
fn without_a_commit_earlier_results_stay_and_nothing_is_left() {
    let scratch = Scratch::new();
    scratch.write("report.json", "earlier");
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    out.write_text("report.json", "later").unwrap();
    drop(out);
    assert_eq!(names(scratch.root()), ["report.json"]);
    let kept = fs::read_to_string(scratch.path("report.json")).unwrap();
    assert_eq!(kept, "earlier");
}

#[test]
fn a_directory_made_in_vain_goes_again() {
    let scratch = Scratch::new();
    let path = scratch.path("results");
    drop(OutputDirectory::create(&path).unwrap());
    assert!(!path.exists());
    // One that was there stays, empty or not.
    fs::create_dir(&path).unwrap();
    drop(OutputDirectory::create(&path).unwrap());
    assert!(path.exists());
}

#[test]
fn a_commit_replaces_earlier_results_and_keeps_strangers() {
    let scratch = Scratch::new();
    scratch.write("report.json", "earlier");
    scratch.write("notes.txt", "mine");
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    out.write_text("report.json", "first").unwrap();
    out.write_text("report.json", "second").unwrap();
    assert_eq!(out.staged(), ["report.json"]);
    out.commit().unwrap();
    assert_eq!(names(scratch.root()), ["notes.txt", "report.json"]);
    let replaced = fs::read_to_string(scratch.path("report.json")).unwrap();
    assert_eq!(replaced, "second");
}

#[test]
fn what_is_withdrawn_goes_with_the_commit_unless_it_is_written() {
    let scratch = Scratch::new();
    for name in ["movie.gif", "cells.csv", "notes.txt"] {
        scratch.write(name, "earlier");
    }
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    out.withdraw("movie.gif").unwrap();
    out.withdraw("cells.csv").unwrap();
    out.withdraw("never-there.npy").unwrap();
    out.write_text("cells.csv", "new").unwrap();
    assert_told(out.withdraw("../x"), &["\"../x\" is not a plain file name"], "directly");
    assert!(scratch.path("movie.gif").exists());
    drop(out);
    assert_eq!(names(scratch.root()), ["cells.csv", "movie.gif", "notes.txt"]);
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    out.withdraw("movie.gif").unwrap();
    out.withdraw("cells.csv").unwrap();
    out.write_text("cells.csv", "new").unwrap();
    out.commit().unwrap();
    assert_eq!(names(scratch.root()), ["cells.csv", "notes.txt"]);
    assert_eq!(fs::read_to_string(scratch.path("cells.csv")).unwrap(), "new");
}

#[test]
fn a_check_tells_what_a_claim_tells_and_leaves_nothing() {
    let scratch = Scratch::new();
    OutputFolder::check(&scratch.path("a/b/results")).unwrap();
    OutputFolder::check(scratch.root()).unwrap();
    assert_eq!(names(scratch.root()), Vec::<String>::new());
    let file = scratch.write("taken", "x");
    assert_told(OutputFolder::check(&file), &["taken: is a file"], "another --out");
    assert_told(
        OutputFolder::check(&file.join("results")),
        &["results: output directory cannot be created"],
        "--out",
    );
    assert_told(OutputFolder::check(Path::new("")), &["empty name"], "--out DIR");
    let held = OutputFolder::claim(scratch.path("held")).unwrap();
    assert_told(OutputFolder::check(&scratch.path("held")), &["is written to by process"], "wait");
    drop(held);
    OutputFolder::check(&scratch.path("held")).unwrap();
}

#[test]
fn a_hopeless_place_is_told_at_once() {
    let scratch = Scratch::new();
    let file = scratch.write("taken", "x");
    let facts = ["taken: is a file, an output directory is needed"];
    assert_told(OutputDirectory::create(&file), &facts, "another --out");
    let below = file.join("results");
    let facts = ["results: output directory cannot be created"];
    assert_told(OutputDirectory::create(&below), &facts, "--out");
    assert_told(OutputDirectory::create(""), &["empty name"], "--out DIR");
}

#[cfg(target_os = "linux")]
#[test]
fn an_unwritable_directory_is_told_at_once() {
    // Nobody, not even root, can make files in /proc.
    let facts = ["/proc: output directory is not writable"];
    assert_told(OutputDirectory::create("/proc"), &facts, "--out");
}

#[test]
fn names_that_leave_the_directory_are_refused() {
    let scratch = Scratch::new();
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    for name in ["", ".", "..", "../x", "a/b", "/x", "a/"] {
        let fact = format!("\"{name}\" is not a plain file name");
        assert_told(out.write_text(name, "x"), &[&fact], "directly");
    }
    assert!(out.staged().is_empty());
}

#[test]
fn a_folder_in_the_way_is_told_before_anything_moves() {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path("b.txt")).unwrap();
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    let facts = ["b.txt: is a folder"];
    assert_told(out.write_text("b.txt", "x"), &facts, "move the folder");
    out.write_text("a.txt", "new").unwrap();
    out.write_text("c.txt", "new").unwrap();
    fs::create_dir(scratch.path("c.txt")).unwrap();
    assert_told(out.commit(), &["c.txt: is a folder"], "move the folder");
    assert_eq!(names(scratch.root()), ["b.txt", "c.txt"]);
}
