//! Nothing is lost and nothing is overwritten, whoever else works, reads or fills the disk.

use crate::program::{command, succeed, voronudge};
use crate::refusal::assert_told;
use crate::scratch::{Folder, names};
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;

const SHORT: &str = "simulate --cells 30 --time 0.2 --frames 2";

/// The output folder of a short simulation.
fn simulated() -> Folder {
    let folder = Folder::new();
    succeed(SHORT, &[("--out", folder.path())]);
    folder
}

fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
    names(folder).into_iter().map(|name| (name.clone(), fs::read(folder.join(name)).unwrap())).collect()
}

#[track_caller]
fn assert_refused(line: &str, paths: &[(&str, &Path)], facts: &[&str]) {
    let words = line.split_whitespace().map(OsString::from);
    let paths = paths.iter().flat_map(|(name, path)| [OsString::from(name), path.as_os_str().to_owned()]);
    let words: Vec<OsString> = words.chain(paths).filter(|word| !word.is_empty()).collect();
    assert_told(&words, facts);
}

#[test]
fn a_second_run_in_a_folder_is_refused_until_the_first_has_ended_or_was_killed() {
    let out = Folder::new();
    let mut first = command();
    first.args("simulate --cells 100 --time 1e4 --frames 1000 --quiet --out".split_whitespace());
    let mut first = first.arg(out.path()).spawn().unwrap();
    while !out.file(".voronudge-run/velocities.npy").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let holder = format!("is written to by process {} (simulate --cells 100", first.id());
    for line in [SHORT, "phase-diagram --cells 20 --time 1", "channel --seed 1"] {
        assert_refused(line, &[("--out", out.path())], &[&holder]);
    }
    assert!(out.file(".voronudge-run/velocities.npy").exists());
    first.kill().unwrap();
    first.wait().unwrap();
    succeed(SHORT, &[("--out", out.path())]);
    assert_eq!(out.names(), crate::simulations::FILES);
}

#[test]
fn a_folder_that_is_read_is_not_written_to() {
    let data = simulated();
    let before = content(data.path());
    let fact = ["is read by this run"];
    #[cfg(unix)]
    let other = {
        let other = Folder::new();
        std::os::unix::fs::symlink(data.path(), other.file("link")).unwrap();
        other
    };
    for flags in ["", "--overwrite"] {
        let line = format!("simulate --time 0.1 {flags}");
        assert_refused(&line, &[("--start", data.path()), ("--out", data.path())], &fact);
        #[cfg(unix)]
        assert_refused(&line, &[("--start", data.path()), ("--out", &other.file("link"))], &fact);
        for reader in ["evaluate", "observe", "spectrum", "infer --difference central"] {
            let line = format!("{reader} {flags}");
            assert_refused(&line, &[("", data.path()), ("--out", data.path())], &fact);
        }
        let line = format!("evaluate --box 5 6 {flags}");
        let positions = data.file("positions.npy");
        assert_refused(&line, &[("--positions", &positions), ("--out", data.path())], &fact);
        let parameters = data.file("report.json");
        let line = format!("simulate --time 0.1 {flags}");
        assert_refused(&line, &[("--parameters", &parameters), ("--out", data.path())], &fact);
    }
    let table = Folder::new();
    let spots = table.write("spots.csv", "TRACK_ID,FRAME,POSITION_X,POSITION_Y\n1,0,2,3\n");
    assert_refused("import tracks", &[("", &spots), ("--out", table.path())], &fact);
    assert_eq!(table.names(), ["spots.csv"]);
    assert!(content(data.path()) == before);
}

#[test]
fn measured_data_are_replaced_only_if_that_is_asked_for() {
    let measured = simulated();
    for name in measured.names() {
        if !["positions.npy", "dataset.toml"].contains(&name.as_str()) {
            measured.remove(&name);
        }
    }
    let before = content(measured.path());
    let out = [("--out", measured.path())];
    for line in [SHORT, "phase-diagram --cells 20 --time 1 --P_0 4 4 1 --alpha 0 0 1", "check-gradients"] {
        assert_refused(line, &out, &["positions.npy: was not written by this program"]);
    }
    assert!(content(measured.path()) == before);
    // An earlier report about them does not make them results.
    let report = format!(
        "{{\"command\": \"infer\", \"inputs\": [{{\"path\": {:?}, \"sha256\": \"\"}}]}}",
        measured.file("positions.npy")
    );
    measured.write("report.json", report);
    assert_refused(SHORT, &out, &["positions.npy: was not written by this program"]);
    succeed(&format!("{SHORT} --overwrite"), &out);
    assert_eq!(measured.names(), crate::simulations::FILES);
    // Results are replaced without more ado.
    succeed(SHORT, &out);
}

#[cfg(unix)]
#[test]
fn nobody_listens_and_results_are_written() {
    let data = simulated();
    for format in ["text", "json"] {
        let out = Folder::new();
        // A pipe that nobody reads from.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut evaluate = command();
        evaluate.arg("evaluate").arg(data.path()).args(["--jacobian", "--format", format, "--out"]);
        evaluate.arg(out.path()).stdout(writer.try_clone().unwrap()).stderr(writer);
        assert_eq!(evaluate.status().unwrap().code(), Some(0));
        assert!(out.names().contains(&"report.json".into()));
    }
    // Even the message of a failure.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let mut evaluate = command();
    evaluate.args(["evaluate", "nowhere"]).stdout(writer.try_clone().unwrap()).stderr(writer);
    assert_eq!(evaluate.status().unwrap().code(), Some(2));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_stdout_is_told_and_results_are_written() {
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let data = simulated();
    let out = Folder::new();
    let mut evaluate = command();
    evaluate.arg("evaluate").arg(data.path()).arg("--out").arg(out.path()).stdout(full());
    let output = evaluate.output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(
        told.contains("error: stdout cannot be written") && told.contains("hint: the results are"),
        "{told}"
    );
    assert!(out.names().contains(&"report.json".into()));
    // Warnings that cannot be written are no reason to fail.
    let out = Folder::new();
    let mut evaluate = command();
    evaluate.arg("evaluate").arg(data.path()).args(["--jacobian", "--out"]).arg(out.path());
    assert_eq!(evaluate.stderr(full()).stdout(std::process::Stdio::null()).status().unwrap().code(), Some(0));
}

#[cfg(target_os = "linux")]
#[test]
fn paths_need_not_be_text() {
    use std::os::unix::ffi::OsStrExt;
    let parent = Folder::new();
    let place = |name: &[u8]| parent.path().join(OsStr::from_bytes(name));
    let [data, evaluated, observed] = [b"\xff-data".as_slice(), b"\xfe", b"\xfd"].map(place);
    succeed(SHORT, &[("--out", &data)]);
    assert_eq!(names(&data), crate::simulations::FILES);
    for (line, out) in [("evaluate", &evaluated), ("observe", &observed)] {
        let words = [OsStr::new(line), data.as_os_str(), OsStr::new("--out"), out.as_os_str()];
        let output = command().args(words).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(out.join("report.json").exists());
    }
    let again = place(b"\xfc");
    let words =
        [OsStr::new("simulate"), "--start".as_ref(), data.as_os_str(), "--out".as_ref(), again.as_os_str()];
    assert_eq!(command().args(words).args(["--time", "0.1"]).output().unwrap().status.code(), Some(0));
}

#[test]
fn messages_hold_no_control_characters() {
    let outcome = voronudge(["evaluate", "no\u{1b}[2Jwhere\r", "--out", "x"]);
    assert_eq!(outcome.code, Some(2));
    assert!(!outcome.stderr.contains(|letter: char| letter.is_control() && letter != '\n'), "{outcome:?}");
    assert!(outcome.stderr.contains("no\\u{1b}[2Jwhere\\r"), "{outcome:?}");
}
