//! Running the program as a user does.

use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How a run of the program ended.
#[derive(Debug)]
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

pub fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_voronudge"))
}

pub fn voronudge<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Outcome {
    let output = command().args(arguments).output().unwrap();
    Outcome {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Runs the words of `line`, then the options with a path each; the run must end with exit code 0.
#[track_caller]
pub fn succeed(line: &str, paths: &[(&str, &Path)]) -> Outcome {
    let words = line.split_whitespace().map(|word| word.as_ref());
    // An empty name stands for an argument without one, the data set.
    let paths = paths.iter().flat_map(|(name, path)| [OsStr::new(name), path.as_os_str()]);
    let outcome = voronudge(words.chain(paths.filter(|argument| !argument.is_empty())));
    assert_eq!(outcome.code, Some(0), "{line}: {}", outcome.stderr);
    outcome
}

/// Asserts that a report is as `voronudge schema` says of its command.
#[track_caller]
pub fn assert_described(report: &Value) {
    let [command, line] = ["command", "command_line"].map(|name| report[name].as_str().unwrap());
    let words = line.split_whitespace().skip_while(|word| *word != command);
    let words: Vec<&str> = words.take(if command == "import" { 2 } else { 1 }).collect();
    let schema = succeed(&format!("schema {}", words.join(" ")), &[]).stdout;
    let schema = jsonschema::validator_for(&serde_json::from_str(&schema).unwrap()).unwrap();
    let faults: Vec<String> =
        schema.iter_errors(report).map(|fault| format!("{}: {fault}", fault.instance_path())).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

pub fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name)
}
