//! Folders and settings that do not make a data set, and places where no result can go.

use crate::program::fixture;
use crate::refusal::{READERS, assert_refused, assert_told, assert_unreadable};
use crate::scratch::Folder;
use std::ffi::OsStr;
use std::fs;

#[test]
fn a_missing_folder_is_refused() {
    let folder = Folder::new();
    assert_unreadable(&folder.file("nowhere"), &[], &["nowhere", "no such file or folder"]);
}

#[test]
fn a_file_in_place_of_the_folder_is_refused() {
    assert_unreadable(&fixture("chiral-liquid/positions.npy"), &[], &["positions.npy", "is a file"]);
}

#[test]
fn missing_positions_and_named_files_that_are_not_there_are_refused() {
    let data = Folder::copy_of("chiral-liquid");
    assert_unreadable(data.path(), &["--velocities", "gone.npy"], &["gone.npy", "no such file"]);
    data.remove("positions.npy");
    assert_unreadable(data.path(), &[], &["positions.npy", "no such file"]);
}

#[test]
fn a_boundary_nobody_states_is_refused() {
    let data = Folder::copy_of("chiral-liquid");
    data.remove("dataset.toml");
    assert_unreadable(data.path(), &[], &["boundary is not given", "dataset.toml"]);
}

#[test]
fn settings_that_cannot_be_used_are_refused_with_their_line() {
    for (settings, facts) in [
        ("frame_interval = 1.0\nboundary = = 3\n", ["line 2", "malformed TOML"]),
        ("boundary = \"open\"\n\nframe_intervall = 2.0\n", ["line 3", "\"frame_intervall\""]),
        ("boundary = \"periodic\"\n", ["line 1", "no box"]),
        ("boundary = \"open\"\nbox = [1.0, 1.0]\n", ["line 2", "open"]),
        ("boundary = \"open\"\nposition_noise = -0.1\n", ["line 2", "position_noise is -0.1"]),
    ] {
        let data = Folder::copy_of("chiral-liquid");
        data.write("dataset.toml", settings);
        assert_unreadable(data.path(), &[], &[&["dataset.toml"], facts.as_slice()].concat());
    }
}

#[test]
fn a_frame_that_does_not_exist_is_refused() {
    let data = fixture("open-field");
    for command in ["infer", "evaluate", "check-gradients"] {
        let facts = ["positions.npy", "frame 5 does not exist", "5 frames"];
        assert_refused(command, &data, &["--frames", "1,5"], &facts);
        assert_refused(command, &data, &["--frames", "2..9"], &facts);
    }
}

#[test]
fn a_frame_without_velocities_is_refused() {
    let data = fixture("open-field");
    let refused = |frames: &str, facts: &[&str]| {
        assert_refused("infer", &data, &["--difference", "central", "--frames", frames], facts);
    };
    refused("0", &["positions.npy, frame 0", "no cell has a velocity"]);
    refused("1..5", &["positions.npy, frame 4"]);
}

#[test]
fn tracks_of_one_frame_are_refused() {
    let data = fixture("open-field");
    let facts = ["positions.npy, frame 2", "two frames or more"];
    assert_refused("infer", &data, &["--frames", "2"], &facts);
    for option in [["--background", "1"], ["--bootstrap", "40"], ["--method", "descent"]] {
        let facts = [option[0], "only tracks"];
        assert_refused("infer", &data, &option, &facts);
    }
}

#[test]
fn positions_of_one_moment_have_no_velocities() {
    let data = Folder::copy_of("chiral-liquid");
    data.remove("velocities.npy");
    assert_refused("infer", data.path(), &[], &["positions.npy", "there is one frame and no velocities"]);
    let facts = ["positions.npy", "need 3 frames", "has 1"];
    assert_refused("infer", data.path(), &["--difference", "central"], &facts);
}

#[test]
fn an_output_folder_that_cannot_be_made_is_refused() {
    let data = fixture("chiral-liquid");
    let folder = Folder::new();
    let file = folder.write("taken", "notes");
    for reader in READERS {
        for out in [file.clone(), file.join("below")] {
            let arguments = [OsStr::new(reader), data.as_os_str(), "--out".as_ref(), out.as_os_str()];
            assert_told(&arguments, &["taken", "output directory"]);
        }
    }
    assert_told(&["simulate".as_ref(), OsStr::new("--out"), file.join("below").as_os_str()], &["taken"]);
    assert_eq!(folder.names(), ["taken"]);
    assert_eq!(fs::read_to_string(&file).unwrap(), "notes");
}

#[test]
fn a_missing_output_folder_argument_is_refused() {
    for reader in READERS {
        let data = fixture("chiral-liquid");
        assert_told(&[OsStr::new(reader), data.as_os_str()], &["no output folder"]);
    }
}
