//! Ctrl-C: a long run ends soon, and leaves no half results.

use crate::program::{command, fixture};
use crate::scratch::{Folder, names};
use std::ffi::OsString;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A run of many minutes, with frames close together.
const LINE: &str = "simulate --overwrite --cells 100 --time 10000 --dt 0.01 --frames 100000 --alpha 1";

fn start(line: &str, out: &Path) -> Child {
    let mut command = command();
    command.args(line.split_whitespace()).arg("--out").arg(out);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Interrupts the program once it is at work and returns its exit code and what it printed.
fn interrupt(run: Child, out: &Path) -> (Option<i32>, String, String) {
    let begun = Instant::now();
    let at_work = || out.is_dir() && names(out).iter().any(|name| name.starts_with(".voronudge-"));
    while !at_work() {
        assert!(begun.elapsed() < Duration::from_secs(60));
        sleep(Duration::from_millis(20));
    }
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
fn an_interrupted_search_leaves_nothing() {
    let parent = Folder::new();
    let out = parent.file("results");
    let mut command = command();
    // Of tracks, where nothing is kept.
    command.arg("discover").arg(fixture("open-field")).arg("--out").arg(&out);
    let search = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let (code, stdout, stderr) = interrupt(search, &out);
    assert_eq!((code, stdout.as_str()), (Some(130), ""));
    assert!(stderr.contains("error: interrupted"), "{stderr}");
    assert_eq!(names(parent.path()), Vec::<String>::new());
}

#[test]
fn an_interrupted_run_leaves_earlier_results_alone_and_can_be_taken_up() {
    let out = Folder::new();
    out.write("positions.npy", "earlier");
    let (code, stdout, stderr) = interrupt(start(LINE, out.path()), out.path());
    assert_eq!((code, stdout.as_str()), (Some(130), ""));
    assert!(stderr.contains("error: interrupted") && stderr.contains("--resume"), "{stderr}");
    assert_eq!(out.names(), [".voronudge-run", "positions.npy"]);
    assert_eq!(std::fs::read(out.file("positions.npy")).unwrap(), b"earlier");

    // Not by mistake, and not as another run.
    let told = |line: &str, facts: &[&str]| {
        let words = line.split_whitespace().map(OsString::from);
        let arguments: Vec<OsString> = words.chain(["--out".into(), out.path().into()]).collect();
        crate::refusal::assert_told(&arguments, facts);
    };
    told(LINE, &["interrupted"]);
    told(&format!("{} --resume", LINE.replace("--alpha 1", "--alpha 0.5")), &["\"parameters\""]);
    assert_eq!(out.names(), [".voronudge-run", "positions.npy"]);
}

#[test]
fn an_interrupted_diagram_can_be_taken_up_but_not_by_mistake() {
    let line = "phase-diagram --cells 400 --time 1000 --P_0 4 4.2 3";
    let out = Folder::new();
    let (code, stdout, stderr) = interrupt(start(line, out.path()), out.path());
    assert_eq!((code, stdout.as_str()), (Some(130), ""));
    assert!(stderr.contains("interrupted after") && stderr.contains("--resume"), "{stderr}");
    assert_eq!(out.names(), [".voronudge-run"]);
    let told = |line: &str, facts: &[&str]| {
        let words = line.split_whitespace().map(OsString::from);
        let arguments: Vec<OsString> = words.chain(["--out".into(), out.path().into()]).collect();
        crate::refusal::assert_told(&arguments, facts);
    };
    told(line, &["interrupted"]);
    told("phase-diagram --cells 300 --time 1000 --P_0 4 4.2 3 --resume", &["\"cells\""]);
    told(&format!("{line} --shard 1/2 --resume"), &["\"shard\""]);
    assert_eq!(out.names(), [".voronudge-run"]);
}

#[test]
fn commands_without_steps_end_at_once_and_leave_nothing() {
    let data = Folder::new();
    // A flat image takes a while to find no extrema in.
    let (image, size) = (data.file("flat.png"), 6000);
    let mut encoder = png::Encoder::new(std::fs::File::create(&image).unwrap(), size, size);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&vec![1; (size * size) as usize]).unwrap();
    for signal in ["-INT", "-TERM"] {
        let parent = Folder::new();
        let out = parent.file("results");
        let mut import = command();
        import.args(["import", "field"]).arg(&image).arg("--out").arg(&out);
        let run = import.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let begun = Instant::now();
        while !out.join(".voronudge-lock").exists() {
            assert!(begun.elapsed() < Duration::from_secs(60));
            sleep(Duration::from_millis(1));
        }
        assert!(Command::new("kill").args([signal, &run.id().to_string()]).status().unwrap().success());
        let begun = Instant::now();
        let output = run.wait_with_output().unwrap();
        assert!(begun.elapsed() < Duration::from_secs(2));
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            (output.status.code(), told.as_str()),
            (Some(130), "error: interrupted; nothing was written\n")
        );
        assert!(names(parent.path()).is_empty(), "{:?}", names(parent.path()));
    }
}
