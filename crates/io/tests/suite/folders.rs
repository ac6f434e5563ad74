//! One process at a time writes to an output directory, and what it has decided happens.

use std::fs::{self, File};
use std::path::Path;

use voronudge_io::{Journal, OutputDirectory, OutputFolder, Recording, Source};

use crate::{Scratch, assert_told, names};

const ARRAYS: [(&str, [usize; 3]); 1] = [("positions.npy", [2, 3, 2])];

#[test]
fn a_directory_is_claimed_once() {
    let scratch = Scratch::new();
    let path = scratch.path("out");
    let out = OutputDirectory::create(&path).unwrap();
    let own = format!("is written to by process {}", std::process::id());
    assert_told(OutputDirectory::create(&path), &["out: ", &own], "another --out");
    assert_told(OutputFolder::claim(&path), &[&own], "wait until it has ended");
    // A copy holds the lock as well.
    let folder = out.folder().clone();
    drop(out);
    assert_told(OutputFolder::claim(&path), &[&own], "wait");
    drop(folder);
    assert!(!path.exists());
    OutputFolder::claim(&path).unwrap();
}

#[test]
fn a_lock_that_nobody_holds_is_taken() {
    let scratch = Scratch::new();
    scratch.write(".voronudge-lock", "process 1 (killed)");
    let folder = OutputFolder::claim(scratch.root()).unwrap();
    assert!(!fs::read_to_string(scratch.path(".voronudge-lock")).unwrap().contains("killed"));
    drop(folder);
    assert!(names(scratch.root()).is_empty());
}

#[test]
fn what_a_killed_process_left_behind_is_swept() {
    let scratch = Scratch::new();
    for (folder, file) in
        [(".voronudge-Ab12", "report.json"), (".voronudge-run", "positions.npy"), ("plots", ".voronudge-x")]
    {
        fs::create_dir(scratch.path(folder)).unwrap();
        scratch.write(&format!("{folder}/{file}"), "half");
    }
    scratch.write(".voronudge-notes", "a file of somebody else");
    drop(OutputFolder::claim(scratch.root()).unwrap());
    assert_eq!(names(scratch.root()), [".voronudge-notes", "plots"]);
    assert_eq!(names(&scratch.path("plots")), [".voronudge-x"]);
}

#[test]
fn a_run_that_can_be_taken_up_is_not_swept() {
    for file in ["checkpoint", "journal"] {
        let scratch = Scratch::new();
        fs::create_dir(scratch.path(".voronudge-run")).unwrap();
        scratch.write(&format!(".voronudge-run/{file}"), "kept");
        let mut out = OutputDirectory::create(scratch.root()).unwrap();
        out.write_text("report.json", "of another command").unwrap();
        out.commit().unwrap();
        assert_eq!(names(scratch.root()), [".voronudge-run", "report.json"]);
    }
}

#[test]
fn results_that_end_a_run_remove_it() {
    let scratch = Scratch::new();
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    let mut journal = Journal::begin(out.folder(), "what is asked for").unwrap();
    journal.append("a part").unwrap();
    out.write_text("report.json", "{}").unwrap();
    out.end_run();
    out.commit().unwrap();
    drop(journal);
    assert_eq!(names(scratch.root()), ["report.json"]);
}

/// A directory in the state in which a process leaves it that dies after results were decided, with so many of them in place.
fn decided(scratch: &Scratch, moved: usize) {
    let files = ["dataset.toml", "positions.npy", "report.json"];
    fs::create_dir(scratch.path(".voronudge-commit")).unwrap();
    for (index, name) in files.iter().enumerate() {
        scratch.write(name, "earlier");
        let place = if index < moved { String::new() } else { ".voronudge-commit/".into() };
        scratch.write(&format!("{place}{name}"), format!("new {name}"));
    }
}

#[test]
fn decided_results_are_put_in_place_whenever_the_process_died() {
    for moved in 0..=3 {
        let scratch = Scratch::new();
        decided(&scratch, moved);
        drop(OutputFolder::claim(scratch.root()).unwrap());
        assert_eq!(names(scratch.root()), ["dataset.toml", "positions.npy", "report.json"]);
        for name in names(scratch.root()) {
            assert_eq!(fs::read_to_string(scratch.path(&name)).unwrap(), format!("new {name}"));
        }
    }
}

#[test]
fn decided_withdrawals_happen_whenever_the_process_died() {
    let scratch = Scratch::new();
    decided(&scratch, 2);
    scratch.write("movie.gif", "earlier");
    scratch.write(".voronudge-commit/.withdrawn", "movie.gif\n../out-of-place\ngone.npy");
    drop(OutputFolder::claim(scratch.root()).unwrap());
    assert_eq!(names(scratch.root()), ["dataset.toml", "positions.npy", "report.json"]);
}

#[test]
fn a_reader_sees_decided_results() {
    let scratch = Scratch::new();
    let mut out = OutputDirectory::create(scratch.root()).unwrap();
    out.write_text("dataset.toml", "boundary = \"open\"\n").unwrap();
    out.write_array("positions.npy", ndarray::array![[1.0, 2.0], [3.0, 4.0]].view()).unwrap();
    out.commit().unwrap();
    fs::create_dir(scratch.path(".voronudge-commit")).unwrap();
    fs::rename(scratch.path("positions.npy"), scratch.path(".voronudge-commit/positions.npy")).unwrap();
    scratch.write("positions.npy", "earlier");
    let source = Source { folder: Some(scratch.root().into()), ..Source::default() };
    assert_eq!(source.load().unwrap().positions[[0, 1, 0]], 3.0);
    assert_eq!(names(scratch.root()), ["dataset.toml", "positions.npy"]);
}

/// A run with a checkpoint after one of two frames.
fn unfinished(scratch: &Scratch) -> Recording {
    let folder = OutputFolder::claim(scratch.root()).unwrap();
    let mut recording = Recording::begin(&folder, &ARRAYS).unwrap();
    recording.append(0, &[0.5; 6]).unwrap();
    recording.checkpoint(b"after one frame").unwrap();
    recording.append(0, &[1.5; 6]).unwrap();
    recording
}

#[test]
fn a_run_whose_results_are_decided_is_over() {
    let scratch = Scratch::new();
    let recording = unfinished(&scratch);
    // Writes all frames to the disk; the results are not committed.
    drop(recording.results().unwrap());
    // The state after the decision: frames are both in the run and among the results.
    fs::create_dir(scratch.path(".voronudge-commit")).unwrap();
    let [run, decided] = [".voronudge-run", ".voronudge-commit"].map(|name| scratch.path(name));
    fs::hard_link(run.join("positions.npy"), decided.join("positions.npy")).unwrap();
    File::create(decided.join(".ends-run")).unwrap();
    let whole = fs::read(run.join("positions.npy")).unwrap();

    let folder = OutputFolder::claim(scratch.root()).unwrap();
    assert_eq!(Recording::find(scratch.root()).unwrap(), None);
    // A run that begins anew, and is cut off, does not touch them.
    let mut recording = Recording::begin(&folder, &ARRAYS).unwrap();
    recording.append(0, &[7.0; 6]).unwrap();
    recording.checkpoint(b"another").unwrap();
    assert!(fs::read(scratch.path("positions.npy")).unwrap() == whole);
}

#[test]
fn a_run_without_a_checkpoint_leaves_nothing() {
    let scratch = Scratch::new();
    let path = scratch.path("out");
    let folder = OutputFolder::claim(&path).unwrap();
    drop(Recording::begin(&folder, &ARRAYS).unwrap());
    drop(folder);
    assert!(!path.exists());
}

/// Looks at a file with a bit of one of its first so many bytes changed, one byte after the other.
fn for_each_byte_changed(path: &Path, count: usize, look: impl Fn()) {
    let whole = fs::read(path).unwrap();
    for at in 0..count {
        let mut changed = whole.clone();
        changed[at] ^= 1 << (at % 8);
        fs::write(path, changed).unwrap();
        look();
    }
}

#[test]
fn a_checkpoint_with_any_byte_changed_is_refused() {
    let scratch = Scratch::new();
    drop(unfinished(&scratch));
    let path = scratch.path(".voronudge-run/checkpoint");
    let whole = fs::read(&path).unwrap();
    for_each_byte_changed(&path, whole.len(), || {
        assert_told(Recording::find(scratch.root()), &["checkpoint: ", "checksum"], ".voronudge-run");
    });
    fs::write(&path, &whole[..whole.len() - 1]).unwrap();
    assert_told(Recording::find(scratch.root()), &["checkpoint: "], ".voronudge-run");
    fs::write(&path, &whole).unwrap();
    assert_eq!(Recording::find(scratch.root()).unwrap().unwrap(), b"after one frame");
}

#[test]
fn frames_with_any_byte_changed_are_refused() {
    let scratch = Scratch::new();
    drop(unfinished(&scratch));
    let path = scratch.path(".voronudge-run/positions.npy");
    let whole = fs::read(&path).unwrap();
    let folder = OutputFolder::claim(scratch.root()).unwrap();
    // The second frame is not part of the checkpoint.
    for_each_byte_changed(&path, whole.len() - 48, || {
        assert_told(Recording::resume(&folder, &ARRAYS, 1), &["positions.npy: ", "checksum"], "begin again");
    });
    fs::write(&path, &whole).unwrap();
    assert_eq!(Recording::resume(&folder, &ARRAYS, 1).unwrap().frame(0, 0).unwrap(), [0.5; 6]);
}

#[test]
fn a_journal_with_any_byte_changed_is_refused_or_a_line_shorter() {
    let scratch = Scratch::new();
    let folder = OutputFolder::claim(scratch.root()).unwrap();
    let mut journal = Journal::begin(&folder, "first").unwrap();
    journal.append("a part").unwrap();
    journal.append("another part").unwrap();
    drop(journal);
    let path = scratch.path(".voronudge-run/journal");
    let whole = fs::read(&path).unwrap();
    let mut shorter = 0;
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut changed = whole.clone();
            changed[at] ^= 1 << bit;
            fs::write(&path, changed).unwrap();
            match Journal::find(scratch.root()) {
                Ok(lines) => {
                    // Without its end a last line is one that was cut off.
                    assert_eq!(lines.unwrap(), ["first", "a part"]);
                    shorter += 1;
                }
                Err(error) => assert!(error.to_string().contains("checksum"), "{error}"),
            }
        }
    }
    assert_eq!(shorter, 8);
    // Lines that change places are no journal either.
    let text = String::from_utf8(whole).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    fs::write(&path, [lines[0], lines[2], lines[1], ""].join("\n")).unwrap();
    assert_told(Journal::find(scratch.root()), &["journal: line 2 is not as it was written"], "begin again");
}
