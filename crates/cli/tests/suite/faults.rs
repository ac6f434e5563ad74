//! Every call by which a command changes files fails once, or is the last before the process is killed. Whatever happens, results are
//! complete or as before, and the same command then makes them.
//!
//! Calls are failed with strace; where there is none, nothing can be tested.

use crate::program::{command, fixture};
use crate::scratch::{Folder, names};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Calls that change what files there are, or wait for the disk.
const CHANGES: &str = "?rename,?renameat,?renameat2,?link,?linkat,?mkdir,?mkdirat,?unlink,?unlinkat,?rmdir,fsync,fdatasync,ftruncate";
/// What happens at a call, and to which of them.
const FAULTS: [(&str, &str); 5] = [
    (CHANGES, "signal=SIGKILL"),
    (CHANGES, "error=EIO"),
    ("?rename,?renameat,?renameat2,?link,?linkat", "error=EXDEV"),
    ("write,?pwrite64", "error=ENOSPC"),
    ("openat,?creat", "error=EACCES"),
];

/// Visible files with their content, records of the run aside.
fn visible(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = names(folder).into_iter().filter(|name| !name.starts_with('.'));
    names
        .map(|name| {
            let content = fs::read(folder.join(&name)).unwrap();
            (name.clone(), if name.starts_with("report.") { Vec::new() } else { content })
        })
        .collect()
}

fn words(line: &str, data: Option<&PathBuf>, out: &Path) -> Vec<OsString> {
    let words = line.split_whitespace().map(OsString::from).chain(data.map(OsString::from));
    words.chain(["--threads".into(), "1".into(), "--out".into(), out.into()]).collect()
}

fn run(words: &[OsString]) -> Output {
    command().args(words).output().unwrap()
}

/// Runs a command with a fault at a call of a number; whether there was one.
fn run_with_fault(
    words: &[OsString],
    (calls, fault): (&str, &str),
    number: usize,
    log: &Path,
) -> (bool, Output) {
    let mut strace = Command::new("strace");
    strace.args(["-f", "-qq", "-e", &format!("trace={calls}")]);
    strace.args(["-e", &format!("inject={calls}:{fault}:when={number}"), "-o"]).arg(log);
    let output = strace.arg(env!("CARGO_BIN_EXE_voronudge")).args(words).output().unwrap();
    let log = fs::read_to_string(log).unwrap();
    (log.contains("INJECTED") || log.contains("killed by SIGKILL"), output)
}

/// The stride: every call, if that is asked for by the environment.
fn stride(usual: usize) -> usize {
    if std::env::var_os("VORONUDGE_EVERY_FAULT").is_some() { 1 } else { usual }
}

/// Goes through the faults of a command, of so many calls one, with earlier results in its folder.
fn assert_survives(line: &str, earlier: &str, resume: &str, data: Option<PathBuf>, usual: usize) {
    if Command::new("strace").arg("-V").stdout(Stdio::null()).status().is_err() {
        eprintln!("there is no strace, so no call can be failed");
        return;
    }
    let (before, after) = (Folder::new(), Folder::new());
    assert!(run(&words(earlier, data.as_ref(), before.path())).status.code().is_some_and(|code| code < 2));
    assert!(run(&words(line, data.as_ref(), after.path())).status.code().is_some_and(|code| code < 2));
    let [old, new] = [&before, &after].map(|folder| visible(folder.path()));
    assert!(old != new && old.keys().eq(new.keys()));
    let stride = stride(usual);
    let logs = Folder::new();
    let mut survived = 0;
    for (at, fault) in FAULTS.into_iter().enumerate() {
        // Runs begin at different calls, so that strides do not miss the same ones.
        for number in (1 + at % stride..).step_by(stride) {
            let out = Folder::new();
            for name in before.names() {
                fs::copy(before.file(&name), out.file(&name)).unwrap();
            }
            let words = words(line, data.as_ref(), out.path());
            let (happened, output) = run_with_fault(&words, fault, number, &logs.file("log"));
            let told = format!("{line}: {fault:?} at {number}: {output:?}");
            if !happened {
                assert!(visible(out.path()) == new, "{told}");
                break;
            }
            survived += 1;
            assert!(!matches!(output.status.code(), Some(101 | 134)), "{told}");
            let decided = out.file(".voronudge-commit").is_dir();
            let found = visible(out.path());
            let succeeded = output.status.code().is_some_and(|code| code < 2);
            assert!(found == new || (!succeeded && (found == old || decided)), "{told}");
            // What was begun is finished, or made again.
            let mut again = words.clone();
            again.extend((!resume.is_empty()).then(|| resume.into()));
            let output = run(&again);
            assert!(output.status.code().is_some_and(|code| code < 2), "{told}, then {output:?}");
            assert!(visible(out.path()) == new, "{told}");
            assert!(out.names().iter().all(|name| !name.starts_with('.')), "{told}: {:?}", out.names());
        }
    }
    assert!(survived >= 5, "{line}: {survived} faults only");
}

#[test]
fn a_simulation_survives_faults() {
    let line = "simulate --cells 20 --time 0.2 --frames 2 --checkpoint 0 --quiet --seed";
    assert_survives(&format!("{line} 2"), &format!("{line} 1"), "--resume", None, 23);
}

#[test]
fn an_evaluation_survives_faults() {
    let data = Some(fixture("chiral-liquid"));
    assert_survives("evaluate --quiet --alpha 1", "evaluate --quiet --alpha 2", "", data, 9);
}

#[test]
fn a_diagram_survives_faults() {
    let line = "phase-diagram --cells 16 --time 0.5 --P_0 3.8 4 2 --alpha 0 0 1 --quiet --seed";
    assert_survives(&format!("{line} 2"), &format!("{line} 1"), "--resume", None, 29);
}

#[test]
fn a_fit_survives_faults() {
    let data = Some(fixture("chiral-liquid-clean"));
    let line = "infer --quiet --fix K_A=0.1 --max-steps 2 --position-noise 0.5% --velocity-noise";
    assert_survives(&format!("{line} 5%"), &format!("{line} 9%"), "--resume", data, 151);
}
