//! Bad input: exit code 2, a message that says where, a hint, and nothing lost.

use crate::program::voronudge;
use crate::scratch::Folder;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;

const EARLIER: &str = "{\"command\": \"earlier\"}";

/// Commands that read a data set.
pub const READERS: [&str; 5] = ["infer", "discover", "evaluate", "spectrum", "observe"];

/// Asserts that every command that reads a data set refuses this one, and says these facts.
#[track_caller]
pub fn assert_unreadable(data: &Path, flags: &[&str], facts: &[&str]) {
    for reader in READERS {
        assert_refused(reader, data, flags, facts);
    }
}

/// Asserts that one command refuses a data set or its flags; the hint.
#[track_caller]
pub fn assert_refused(command: &str, data: &Path, flags: &[&str], facts: &[&str]) -> String {
    let arguments = [OsStr::new(command), data.as_os_str()];
    assert_arguments_refused(arguments.into_iter().chain(flags.iter().map(OsStr::new)), facts)
}

/// Asserts that the hint with which one command refuses a data set or its flags has these words.
#[track_caller]
pub fn assert_hinted(command: &str, data: &Path, flags: &[&str], words: &[&str]) {
    let hint = assert_refused(command, data, flags, &[]);
    for word in words {
        assert!(hint.contains(word), "\"{word}\" is not in: {hint}");
    }
}

/// Asserts that a command line is refused in the agreed form while an earlier result stays as it was; the hint.
#[track_caller]
pub fn assert_arguments_refused<S: AsRef<OsStr>>(
    arguments: impl IntoIterator<Item = S>,
    facts: &[&str],
) -> String {
    let out = Folder::new();
    out.write("report.json", EARLIER);
    let mut arguments: Vec<OsString> = arguments.into_iter().map(|word| word.as_ref().to_owned()).collect();
    arguments.extend(["--out".into(), out.path().into()]);
    let hint = assert_told(&arguments, facts);
    assert_eq!(out.names(), ["report.json"], "{arguments:?}");
    assert_eq!(fs::read_to_string(out.file("report.json")).unwrap(), EARLIER, "{arguments:?}");
    hint
}

/// Asserts exit code 2, an empty stdout, and on stderr the error with every fact, an empty line, and a hint, which it returns.
#[track_caller]
pub fn assert_told<S: AsRef<OsStr>>(arguments: &[S], facts: &[&str]) -> String {
    let outcome = voronudge(arguments);
    assert_eq!(outcome.code, Some(2), "{outcome:?}");
    assert_eq!(outcome.stdout, "", "{outcome:?}");
    let told = outcome.stderr.strip_prefix("error: ").and_then(|rest| rest.split_once("\n\nhint: "));
    let Some((message, hint)) = told else {
        panic!("not of the form \"error: …\", empty line, \"hint: …\": {}", outcome.stderr)
    };
    for fact in facts {
        assert!(message.contains(fact), "\"{fact}\" is not in: {message}");
    }
    assert!(!message.contains('\n'), "several lines: {message}");
    assert!(hint.trim().len() > 5 && hint.ends_with('\n') && !hint.trim().contains('\n'), "{hint}");
    hint.to_owned()
}
