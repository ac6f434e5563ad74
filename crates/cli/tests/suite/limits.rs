//! Sizes beyond what can be meant or computed are refused before memory is taken, and what cannot be said is not said.

use crate::program::{command, succeed};
use crate::refusal::assert_told;
use crate::scratch::{Folder, npy, report};
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

#[track_caller]
fn assert_refused(line: &str, paths: &[&Path], facts: &[&str]) {
    let out = Folder::new();
    let words = line.split_whitespace().map(OsString::from);
    let paths = paths.iter().map(|path| path.as_os_str().to_owned());
    let words: Vec<OsString> = words.chain(paths).chain(["--out".into(), out.path().into()]).collect();
    let begun = Instant::now();
    assert_told(&words, facts);
    assert!(begun.elapsed() < Duration::from_secs(10), "{line}");
    assert!(out.names().is_empty(), "{line}: {:?}", out.names());
}

#[test]
fn more_cells_than_there_is_memory_for_are_refused() {
    let memory = ["GB of memory", "the machine has"];
    assert_refused("simulate --cells 499999999 --frames 1", &[], &memory);
    assert_refused("phase-diagram --cells 18446744073709551615 --P_0 4 4 1 --alpha 0 0 1", &[], &memory);
    assert_refused("phase-diagram --cells 499999999999 --P_0 4 4 1 --alpha 0 0 1", &[], &memory);
    assert_refused("simulate --cells 18446744073709551615", &[], &["more positions than"]);
    assert_refused("simulate --frames 18446744073709551615", &[], &["more positions than"]);
    let modes = "spectrum --lattice 400 400 --dense-limit 9000000 --P_0 3.7";
    assert_refused(modes, &[], &["all modes of 160000 cells", "about 5.734e3 GB", "the machine has"]);
}

#[test]
fn more_steps_than_anybody_waits_for_are_refused() {
    let steps = ["time steps"];
    assert_refused("simulate --cells 10 --time 1 --dt 1e-20", &[], &steps);
    assert_refused("simulate --cells 10 --time 1e300 --dt 1e-300", &[], &steps);
    assert_refused("phase-diagram --cells 20 --dt 1e-20 --P_0 4 4 1 --alpha 0 0 1", &[], &steps);
    assert_refused("moduli --cells 20 --dt 1e-20", &[], &steps);
}

#[test]
fn data_that_there_is_no_memory_for_are_refused() {
    let folder = Folder::new();
    // As long as one of very many cells, without anything on the disk.
    let whole = folder.write("whole.npy", npy("<f8", "False", "(1099511627776, 2)", &[]));
    fs::OpenOptions::new().append(true).open(&whole).unwrap().set_len(1 << 43).unwrap();
    assert_refused(
        "evaluate --open --positions",
        &[&whole],
        &["8796093022208 bytes", "the machine has memory for"],
    );
    // A fit takes thousands of times the memory of what is fitted.
    let body: Vec<u8> = (0..4_000_000).flat_map(|k| f64::from(k).to_le_bytes()).collect();
    let fitted = folder.write("fitted.npy", npy("<f8", "False", "(2000000, 2)", &body));
    let line = format!("infer --open --velocities {} --positions", fitted.display());
    if voronudge_io::machine_memory().is_some_and(|memory| memory < 150_000_000_000) {
        let facts = ["a fit of 2000000 cells in 1 frame", "about 1.800e2 GB", "fitted.npy"];
        assert_refused(&line, &[&fitted], &facts);
    }
}

#[test]
fn counts_that_nobody_means_are_refused() {
    assert_refused("channel --preset ht1080 --bins 4294967296", &[], &["4294967296 bins"]);
    assert_refused("moduli --cells 20 --replicas 18446744073709551615", &[], &["--replicas is"]);
    let data = crate::program::fixture("reference-small");
    assert_refused("phase-diffusion --wave-vectors 100000", &[&data], &["--wave-vectors is 100000"]);
    assert_refused("phase-diagram --shard 1/18446744073709551615", &[], &["a shard is written"]);
    for side in ["1e-200", "1e200"] {
        assert_refused(&format!("simulate --cells 10 --box {side} {side}"), &[], &["box side x", "1e-100"]);
    }
    let rate = "simulate --cells 20 --shear-rate 1e7 --time 1000";
    assert_refused(rate, &[], &["largest strain, 10000000000", "shear offset"]);
}

#[test]
fn smoothing_over_more_than_the_image_is_refused() {
    let folder = Folder::new();
    let body: Vec<u8> = (0..900).flat_map(|i| f64::from(i % 7).to_le_bytes()).collect();
    let field = folder.write("field.npy", npy("<f8", "False", "(30, 30)", &body));
    for smoothing in ["31", "1e18", "1e300"] {
        assert_refused(&format!("import field --smoothing {smoothing}"), &[&field], &["smoothing is"]);
    }
}

#[test]
fn a_diagram_that_no_run_writes_is_refused() {
    let made = Folder::new();
    let line = "phase-diagram --cells 20 --time 1 --P_0 4 4 1 --alpha 0 0 1 --shard 1/1";
    succeed(line, &[("--out", made.path())]);
    let whole = fs::read_to_string(made.file("points.jsonl")).unwrap();
    for (from, to) in [
        ("\"count\":1", "\"count\":18446744073709551615"),
        ("\"count\":1", "\"count\":0"),
        ("\"replicas\":1", "\"replicas\":18446744073709551615"),
        ("\"cells\":20", "\"cells\":0"),
        ("\"of\":1", "\"of\":18446744073709551615"),
        ("\"part\":1", "\"part\":0"),
        ("\"point\":0", "\"point\":18446744073709551615"),
        ("\"replica\":0", "\"replica\":1"),
        ("\"time\":1.0", "\"time\":1e300"),
    ] {
        assert!(whole.contains(from), "{from}");
        made.write("points.jsonl", whole.replace(from, to));
        assert_refused("merge", &[made.path()], &["points.jsonl, line "]);
    }
}

#[test]
fn a_diagram_without_a_single_result_says_no() {
    let out = Folder::new();
    let mut diagram = command();
    diagram.args("phase-diagram --cells 20 --time 5 --dt 1 --P_0 4 4 1 --alpha 3 3 1 --out".split(' '));
    let output = diagram.arg(out.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stderr).unwrap().contains("1 of 1 runs failed"));
    assert!(report(out.path())["warnings"].to_string().contains("1 of 1 runs failed"));
}

#[test]
fn a_run_that_fails_late_keeps_its_frames() {
    let parent = Folder::new();
    let out = parent.file("run");
    // At this step a honeycomb is unstable, and what disturbs it grows.
    let words = "simulate --start honeycomb --cells 36 --time 40 --dt 0.2 --frames 100 --alpha 1 --diffusion 1e-6 --seed 3 --quiet --out";
    let mut failing = command();
    failing.args(words.split(' ')).arg(&out);
    let output = failing.output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(
        told.contains("time step is too large") && told.contains("frames before that are kept"),
        "{told}"
    );
    assert!(told.contains("--start"), "{told}");
    let partial = out.join("partial");
    assert_eq!(crate::scratch::names(&partial), ["dataset.toml", "positions.npy", "velocities.npy"]);
    let on = parent.file("on");
    succeed("simulate --time 0.2 --frames 2 --alpha 1", &[("--start", &partial), ("--out", &on)]);
    succeed("evaluate", &[("", &partial), ("--out", &parent.file("evaluated"))]);
}

#[test]
fn numbers_that_mean_nothing_are_refused() {
    for flag in ["--K_P 1e308", "--K_A 1e300", "--alpha -1e200", "--P_0 1e51"] {
        let name = flag.split_once(' ').unwrap().0.trim_start_matches('-');
        let facts = [name, "1e50 is the most"];
        assert_refused(&format!("simulate --cells 10 --time 1e-3 --dt 1e-3 {flag}"), &[], &facts);
        assert_refused(&format!("evaluate {flag}"), &[&crate::program::fixture("reference-small")], &facts);
    }
    assert_refused("phase-diagram --cells 10 --K_A 1e200", &[], &["--K_A", "1e50"]);
    assert_refused("simulate --cells 10 --method adaptive --tolerance 1e6", &[], &["tolerance", "at most 1"]);
    let folder = Folder::new();
    let still = folder.write("still.csv", "x,v_x,v_y\n0,0,1\n1,0,2\n2,0,1.5\n3,0,1\n");
    let facts = ["still.csv: v_x is at most 0", "no flow across"];
    assert_refused("estimate-chirality --shape-index 4", &[&still], &facts);
}
