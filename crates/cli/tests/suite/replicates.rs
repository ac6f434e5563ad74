//! Null sets of `discover` and the bootstrap of `infer`: taken up again, shared among machines, and what is refused.

use crate::program::{Outcome, command, fixture, voronudge};
use crate::refusal::assert_told;
use crate::scratch::{Folder, report};
use serde_json::Value;
use sha2::Digest;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

const SEARCH: &str = "discover --effects drift --null-sets 6 --level 0.3";
const BOOTSTRAP: &str = "infer --fix K_A=0.1 --fix P_0=4 --max-steps 2 --position-noise 0.5% --velocity-noise 5% \
                         --bootstrap 40";
const SEARCH_DATA: &str = "undeclared/set-05";
const BOOTSTRAP_DATA: &str = "chiral-liquid";

fn words(line: &str, data: &Path, out: &Path) -> Vec<OsString> {
    let words = line.split_whitespace().map(OsString::from);
    words.chain([data.into(), "--out".into(), out.into()]).collect()
}

/// A run that ends with an answer, good or bad.
#[track_caller]
fn run(line: &str, data: &Path, out: &Path) -> Outcome {
    let outcome = voronudge(words(&format!("{line} --quiet"), data, out));
    assert!(matches!(outcome.code, Some(0 | 1)), "{line}: {outcome:?}");
    outcome
}

/// Results of a run, without what is recorded of the run itself.
struct Results {
    /// Files other than the report, by name.
    files: BTreeMap<String, Vec<u8>>,
    report: Value,
    page: String,
}

impl Results {
    fn in_folder(folder: &Path) -> Self {
        let mut files: BTreeMap<String, Vec<u8>> = crate::scratch::names(folder)
            .into_iter()
            .map(|name| (name.clone(), fs::read(folder.join(name)).unwrap()))
            .collect();
        assert!(files.remove("report.json").is_some());
        let mut report = report(folder);
        for of_record in ["command_line", "wall_seconds", "threads"] {
            assert!(report.as_object_mut().unwrap().remove(of_record).is_some());
        }
        let page = String::from_utf8(files.remove("report.html").unwrap()).unwrap();
        let record = ["command line", "wall time", "threads"];
        let lines =
            page.lines().filter(|line| !record.iter().any(|own| line.contains(&format!("<th>{own}</th>"))));
        Self { files, report, page: lines.collect() }
    }

    /// Those of a run that nothing cuts off.
    fn of(line: &str, data: &str) -> Self {
        let out = Folder::new();
        run(line, &fixture(data), out.path());
        Self::in_folder(out.path())
    }
}

/// Whole runs, which several tests compare with.
static SEARCHED: LazyLock<Results> = LazyLock::new(|| Results::of(SEARCH, SEARCH_DATA));
static BOOTSTRAPPED: LazyLock<Results> = LazyLock::new(|| Results::of(BOOTSTRAP, BOOTSTRAP_DATA));

/// Asserts that a run has these results.
#[track_caller]
fn assert_same(found: &Path, expected: &Results) {
    let found = Results::in_folder(found);
    assert!(found.files.keys().eq(expected.files.keys()));
    for (name, bytes) in &found.files {
        assert!(*bytes == expected.files[name], "{name}");
    }
    assert_eq!(found.report, expected.report);
    assert!(found.page == expected.page);
}

/// Lines of the journal of an interrupted run.
fn journal(out: &Path) -> usize {
    fs::read_to_string(out.join(".voronudge-run/journal")).map_or(0, |text| text.lines().count())
}

/// Ends a run by a signal once a few fits are in its journal.
#[cfg(unix)]
fn cut_off(line: &str, data: &Path, out: &Path, signal: &str) -> Outcome {
    let mut program = command();
    program.args(words(line, data, out)).stdout(Stdio::piped()).stderr(Stdio::piped());
    let program = program.spawn().unwrap();
    let begun = Instant::now();
    while journal(out) < 4 {
        assert!(begun.elapsed() < Duration::from_secs(120));
        sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args([signal, &program.id().to_string()]).status().unwrap().success());
    let output = program.wait_with_output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Outcome { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

#[cfg(unix)]
fn assert_cut_off_and_resumed_is_the_same(
    line: &str,
    name: &str,
    data: &Path,
    others: &[(&str, &str)],
    whole: &Results,
) {
    let out = Folder::new();
    let told = cut_off(&format!("{line} --threads 2"), data, out.path(), "-TERM");
    assert_eq!((told.code, told.stdout.as_str()), (Some(130), ""), "{told:?}");
    assert!(told.stderr.contains("error: interrupted after ") && told.stderr.contains(name), "{told:?}");
    assert!(told.stderr.contains("--resume"), "{told:?}");
    assert_eq!(out.names(), [".voronudge-run"]);

    // Not by mistake, and not as another run.
    assert_told(&words(line, data, out.path()), &["interrupted"]);
    for (changed, fact) in others {
        assert_told(&words(&format!("{line} --resume {changed}"), data, out.path()), &[fact]);
    }
    let copy = Folder::new();
    for file in crate::scratch::names(data) {
        fs::copy(data.join(&file), copy.file(&file)).unwrap();
    }
    copy.change("velocities.npy", |velocities| velocities[[3, 0]] *= 1.5);
    assert_told(&words(&format!("{line} --resume"), copy.path(), out.path()), &["velocities.npy\""]);
    let kept = journal(out.path());
    assert!(kept >= 4);

    // A line that was cut off counts for nothing, and the program may be killed anew.
    let torn = out.file(".voronudge-run/journal");
    fs::write(&torn, fs::read_to_string(&torn).unwrap() + "{\"series\":0,\"ind").unwrap();
    let outcome = run(&format!("{line} --resume --threads 1"), data, out.path());
    assert_eq!(outcome.stderr, "");
    assert_same(out.path(), whole);
}

#[cfg(unix)]
#[test]
#[ignore = "slow"]
fn a_search_that_was_cut_off_goes_on_to_the_same_bytes() {
    let others = [
        ("--seed 4", "\"--seed\""),
        ("--most-effects 2", "\"--most-effects\""),
        ("--fix K_A=0.1", "\"--fix\""),
        ("--shard 1/2", "\"--shard\""),
    ];
    let data = fixture(SEARCH_DATA);
    assert_cut_off_and_resumed_is_the_same(SEARCH, "6 null sets, which are kept", &data, &others, &SEARCHED);
}

#[cfg(unix)]
#[test]
fn a_bootstrap_that_was_cut_off_goes_on_to_the_same_bytes() {
    let others = [("--seed 4", "\"--seed\""), ("--stable", "\"--stable\"")];
    let data = fixture(BOOTSTRAP_DATA);
    let name = "40 replicates, which are kept";
    assert_cut_off_and_resumed_is_the_same(BOOTSTRAP, name, &data, &others, &BOOTSTRAPPED);
}

#[cfg(unix)]
#[test]
#[ignore = "slow"]
fn a_search_that_was_killed_goes_on_with_what_is_on_the_disk() {
    let out = Folder::new();
    let data = fixture(SEARCH_DATA);
    let told = cut_off(SEARCH, &data, out.path(), "-KILL");
    assert_eq!(told.code, None);
    // What was made is not made again: a number that is put into the journal comes out.
    let path = out.file(".voronudge-run/journal");
    let text = fs::read_to_string(&path).unwrap();
    let last = text.lines().last().unwrap();
    let (head, _) = last.split_once("[").unwrap();
    let (_, head) = head.split_once(' ').unwrap();
    let line = format!("{head}[0.00123]}}");
    // A line has a checksum of itself and its number before it.
    let number = text.lines().count() - 1;
    let sum = sha2::Sha256::digest(format!("{number} {line}"));
    let sum: String = sum.iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    fs::write(&path, text.replace(last, &format!("{sum} {line}"))).unwrap();
    run(&format!("{SEARCH} --resume"), &data, out.path());
    let smallest = |report: &Value| report["calibration"]["words"].as_str().unwrap().to_owned();
    let found = smallest(&report(out.path()));
    assert!(found.contains("0.0012"), "{found}");
    assert!(!smallest(&SEARCHED.report).contains("0.0012"));
}

/// Asserts that parts make the whole, whatever their numbers of threads; returns them.
#[track_caller]
fn assert_parts_make_the_whole(line: &str, data: &Path, whole: &Results) -> [Folder; 2] {
    let merged = Folder::new();
    let parts = [1, 2].map(|part| {
        let out = Folder::new();
        run(&format!("{line} --shard {part}/2 --threads {part}"), data, out.path());
        assert_eq!(out.names(), ["replicates.jsonl"]);
        // A part that ended is not made again: a number that nothing computes stays.
        let made = fs::read_to_string(out.file("replicates.jsonl")).unwrap();
        let (head, tail) = made.rsplit_once('[').unwrap();
        let end = tail.find([',', ']']).unwrap();
        let marked = format!("{head}[0.125{}", &tail[end..]);
        out.write("replicates.jsonl", &marked);
        run(&format!("{line} --shard {part}/2 --resume"), data, out.path());
        let again = fs::read_to_string(out.file("replicates.jsonl")).unwrap();
        // The first line has the command line.
        assert!(again.lines().skip(1).eq(marked.lines().skip(1)), "{again}");
        out.write("replicates.jsonl", made);
        out
    });
    let [first, second] = parts.each_ref().map(|part| part.path().as_os_str());
    let out = ["--out".as_ref(), merged.path().as_os_str()];
    let outcome = voronudge(["merge".as_ref(), "--quiet".as_ref(), second, first].into_iter().chain(out));
    assert!(matches!(outcome.code, Some(0 | 1)), "{outcome:?}");
    assert_same(merged.path(), whole);
    parts
}

#[track_caller]
fn assert_merge_refused(parts: &[&Folder], facts: &[&str]) {
    let out = Folder::new();
    let parts = parts.iter().map(|part| part.path().into());
    let all: Vec<OsString> = ([OsString::from("merge")].into_iter().chain(parts))
        .chain(["--out".into(), out.path().into()])
        .collect();
    assert_told(&all, facts);
    assert_eq!(out.names(), Vec::<String>::new());
}

#[test]
#[ignore = "slow"]
fn parts_of_a_search_make_the_whole() {
    let data = fixture(SEARCH_DATA);
    let [first, second] = assert_parts_make_the_whole(SEARCH, &data, &SEARCHED);
    let other = Folder::new();
    run(&format!("{SEARCH} --shard 2/2 --seed 3"), &data, other.path());
    assert_merge_refused(&[&first], &["part 2 of 2 is missing"]);
    assert_merge_refused(&[&first, &second, &first], &["both part 1 of 2"]);
    assert_merge_refused(&[&first, &other], &["different runs", "\"--seed\""]);
    assert_merge_refused(&[&first, &Folder::new()], &["replicates.jsonl"]);

    let changed = |change: &dyn Fn(&str) -> String| {
        let part = Folder::new();
        let text = fs::read_to_string(second.file("replicates.jsonl")).unwrap();
        part.write("replicates.jsonl", change(&text));
        part
    };
    let short = changed(&|text| text.lines().take(3).map(|line| format!("{line}\n")).collect());
    assert_merge_refused(&[&first, &short], &["has 1 runs, but part 2 of 2 has 3"]);
    let another = changed(&|text| text.replace("\"fit\":[0.", "\"fit\":[1."));
    assert_merge_refused(&[&first, &another], &["different runs", "\"fit\""]);
    let unreadable = changed(&|text| text.replace("\"index\"", "\"number\""));
    assert_merge_refused(&[&first, &unreadable], &["replicates.jsonl, line 3"]);
    // Of a version that is not this one, all of them.
    let aged = [&first, &second].map(|part| {
        let text = fs::read_to_string(part.file("replicates.jsonl")).unwrap();
        let part = Folder::new();
        part.write("replicates.jsonl", text.replace("\"version\":\"", "\"version\":\"9."));
        part
    });
    assert_merge_refused(&[&aged[0], &aged[1]], &["the parts have another \"version\""]);
}

#[test]
fn parts_of_a_bootstrap_make_the_whole() {
    let data = fixture(BOOTSTRAP_DATA);
    let [first, _] = assert_parts_make_the_whole(BOOTSTRAP, &data, &BOOTSTRAPPED);
    let search = Folder::new();
    let of_search = fs::read_to_string(first.file("replicates.jsonl")).unwrap();
    search.write("replicates.jsonl", of_search.replacen("\"infer\"", "\"discover\"", 1));
    assert_merge_refused(&[&first, &search], &["\"command\""]);
}

#[test]
fn what_cannot_be_shared_is_refused() {
    let refused = |command: &str, data: &str, flags: &[&str], facts: &[&str]| {
        crate::refusal::assert_refused(command, &fixture(data), flags, facts);
    };
    refused("infer", "chiral-liquid", &["--shard", "1/2"], &["--bootstrap"]);
    refused("infer", "chiral-liquid", &["--bootstrap", "40", "--shard", "3/2"], &["--shard", "1/4"]);
    refused("discover", "chiral-liquid", &["--shard", "1/2", "--null-sets", "0"], &["--null-sets is 0"]);
    refused("discover", "open-field", &["--shard", "1/2"], &["--shard", "only tracks"]);
}
