//! Ctrl-C: a long run ends soon, and leaves no half results.

use crate::program::command;
use crate::scratch::{Folder, names};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A run that would take hours, with frames close together.
const LINE: &str = "simulate --cells 100 --time 100000 --dt 0.01 --frames 1000000 --alpha 1";

fn start(out: &std::path::Path) -> Child {
    let mut command = command();
    command.args(LINE.split_whitespace()).arg("--out").arg(out);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Interrupts the program once it is at work and returns its exit code and what it printed.
fn interrupt(run: Child) -> (Option<i32>, String, String) {
    sleep(Duration::from_secs(1));
    let begun = Instant::now();
    let sent = Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = run.wait_with_output().unwrap();
    assert!(begun.elapsed() < Duration::from_secs(10));
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn an_interrupted_run_leaves_earlier_results_alone() {
    let out = Folder::new();
    out.write("positions.npy", "earlier");
    let (code, stdout, stderr) = interrupt(start(out.path()));
    assert_eq!((code, stdout.as_str()), (Some(130), ""));
    assert!(stderr.contains("error: interrupted"), "{stderr}");
    assert_eq!(out.names(), ["positions.npy"]);
    assert_eq!(std::fs::read(out.file("positions.npy")).unwrap(), b"earlier");
}

#[test]
fn an_interrupted_run_takes_its_new_folder_away() {
    let parent = Folder::new();
    let (code, ..) = interrupt(start(&parent.file("results")));
    assert_eq!(code, Some(130));
    assert_eq!(names(parent.path()), Vec::<String>::new());
}
