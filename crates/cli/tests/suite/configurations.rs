//! `--config`, `--dry-run` and `man`: options from a file, what would be done, and the manual.

use crate::program::{fixture, succeed, voronudge};
use crate::refusal::{assert_arguments_refused, assert_told};
use crate::scratch::{Folder, number, report};
use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The report of `simulate` with such a file and such words, and the command line that it records.
#[track_caller]
fn simulated(file: &str, line: &str) -> (Value, String) {
    let (folder, out) = (Folder::new(), Folder::new());
    let file = folder.write("options.toml", file);
    succeed(&format!("simulate {line}"), &[("--config", &file), ("--out", out.path())]);
    let report = report(out.path());
    let recorded = report["command_line"].as_str().unwrap().to_owned();
    (report, recorded)
}

#[test]
fn a_file_gives_options_and_what_is_typed_wins() {
    let file = "seed = 3\ntime = 9\n[simulate]\ncells = 20\ntime = 0.1\nframes = 2\nbox = [4, 5]\nquiet = true\n\
                lyapunov = false\n[infer]\nnothing_of_the_kind = 1\n";
    let (report, recorded) = simulated(file, "--cells 30 --alpha -0.5");
    assert_eq!(report["seed"], 3);
    assert_eq!((&report["cells"], &report["frames"]), (&Value::from(30), &Value::from(2)));
    assert_eq!(number(&report, "/time"), 0.1);
    assert_eq!(number(&report, "/parameters/alpha"), -0.5);
    for words in ["--seed=3", "--time=0.1", "--box 4 5", "--cells 30 --alpha -0.5"] {
        assert!(recorded.contains(words), "{recorded}");
    }
    assert!(!recorded.contains("--cells=20") && !recorded.contains("--config"), "{recorded}");
}

#[test]
fn the_recorded_command_line_gives_the_same_without_the_file() {
    let (first, recorded) = simulated("cells = 20\ntime = 0.1\nframes = 2\nP_0 = 3.9\nalpha = -1", "");
    let words: Vec<&str> = recorded.split(' ').skip(1).collect();
    let out = Folder::new();
    let at = words.iter().position(|word| *word == "--out").unwrap();
    let words = words.iter().enumerate().map(|(k, word)| match k == at + 1 {
        true => out.path().as_os_str(),
        false => OsStr::new(word),
    });
    assert_eq!(voronudge(words).code, Some(0));
    let second = report(out.path());
    assert_eq!(first["mean_square_velocity"], second["mean_square_velocity"]);
    assert_eq!(second["parameters"]["P_0"], 3.9);
}

#[test]
fn lists_tables_and_contradictions_are_as_typed() {
    let (folder, out) = (Folder::new(), Folder::new());
    // The data set is periodic; the box of the file gives way to --open.
    let file = folder.write(
        "options.toml",
        "K_A = 0.2\nframes = \"0\"\n[evaluate]\nbox = [10, 10]\neffect = { friction_gradient = [0.1, 0.2] }\nexport = [\"csv\", \"vtk\"]\n",
    );
    let positions = fixture("chiral-liquid").join("positions.npy");
    let paths: [(&str, &Path); 3] = [("--positions", &positions), ("--config", &file), ("--out", out.path())];
    succeed("evaluate --open", &paths);
    let recorded = report(out.path())["command_line"].as_str().unwrap().to_owned();
    assert!(
        recorded.contains("--effect=friction_gradient=0.1,0.2 --export=csv,vtk")
            && !recorded.contains("--box"),
        "{recorded}"
    );
    assert!(out.file("cells.csv").exists() && out.file("cells.pvd").exists());
}

#[test]
fn files_of_options_that_cannot_be_meant_are_refused() {
    let folder = Folder::new();
    let refused = |text: &str, facts: &[&str], advice: &str| {
        let file = folder.write("options.toml", text);
        let words = [OsStr::new("simulate"), OsStr::new("--config"), file.as_os_str()];
        let facts: Vec<&str> = facts.iter().copied().chain(["options.toml: "]).collect();
        let hint = assert_arguments_refused(words, &facts);
        assert!(hint.contains(advice), "{hint}");
    };
    refused("treads = 2", &["treads is no option of simulate"], "--threads");
    refused("[simulat]\ncells = 2", &["simulat is no option of simulate"], "");
    refused("method_ = \"rk4\"\n", &["method_ is no option"], "--method");
    refused("config = \"a.toml\"", &["config is no option"], "");
    refused("help = true", &["help is no option"], "");
    refused("cells = \"many\"", &["invalid value 'many' for '--cells"], "");
    refused("cells = [20, 30]", &["cells is a list of 2, but one value is needed"], "write options as in");
    refused("cells = true", &["cells is true, but a text or a number is needed"], "");
    refused("quiet = 1", &["quiet is 1, but true or false is needed"], "");
    refused("box = 10", &["box is 10, but a list of 2"], "box = [10, 10]");
    refused("time = 1979-05-27", &["time is 1979-05-27, but a text or a number"], "");
    refused("simulate = 3", &["simulate is 3, but it is the name of a command"], "[simulate]");
    refused("cell-parameter = []\ncell_parameter = []", &["cell_parameter is given twice"], "");
    refused("cells = 20\ntime = ", &["line 2: "], "write options as in");
    refused(
        "[import]\n[import.tracks]\n[infer]\n[simulate]\ncellz = 2",
        &["cellz is no option of simulate"],
        "--cells",
    );
    let missing = folder.file("none.toml");
    let words = [OsStr::new("simulate"), OsStr::new("--config"), missing.as_os_str()];
    assert_arguments_refused(words, &["none.toml: no such file"]);
    assert_told(&["simulate", "--config"], &["--config"]);
    let words = ["info", "x.npy", "--config", "a.toml"];
    assert_told(&words, &["unexpected argument '--config'"]);
}

#[test]
fn a_file_that_contradicts_itself_is_refused() {
    let folder = Folder::new();
    let file = folder.write("options.toml", "[infer]\nopen = true\nbox = [3, 4]\n");
    let words = [OsStr::new("infer"), OsStr::new("--config"), file.as_os_str()];
    assert_arguments_refused(words, &["options.toml: ", "--open", "--box", "cannot be used with"]);
}

/// A command line of each kind, and the files that it reads.
fn lines() -> Vec<(&'static str, Vec<PathBuf>)> {
    let sample = |name: &str| fixture("imports").join(name);
    vec![
        ("infer --fix K_A=0.1", vec![fixture("chiral-liquid")]),
        ("evaluate", vec![fixture("reference-small")]),
        ("spectrum", vec![fixture("reference-small")]),
        ("observe", vec![fixture("reference-small")]),
        ("simulate --cells 20 --time 0.1 --frames 2", vec![]),
        ("check-gradients", vec![fixture("reference-small")]),
        ("import tracks", vec![sample("napari-tracks.npy")]),
        ("import trackmate", vec![sample("trackmate-model.xml")]),
        ("import points", vec![sample("napari-points.csv")]),
        ("import labels", vec![sample("labels-plain.tif")]),
    ]
}

#[test]
fn a_dry_run_tells_what_a_run_does_and_leaves_nothing() {
    for (line, inputs) in lines() {
        let folder = Folder::new();
        let out = folder.file("results");
        let mut paths: Vec<(&str, &Path)> = inputs.iter().map(|path| ("", path.as_path())).collect();
        paths.push(("--out", &out));
        let told = succeed(&format!("{line} --dry-run"), &paths).stdout;
        for begin in ["dry run of ", "would read ", "would compute ", "would write ", "not checked "] {
            assert!(told.lines().any(|line| line.starts_with(begin)), "{line}: {told}");
        }
        assert!(told.contains("a new folder"), "{line}: {told}");
        assert!(folder.names().is_empty(), "{line}: {:?}", folder.names());
        let json = succeed(&format!("{line} --dry-run --format json"), &paths).stdout;
        let json: Value = serde_json::from_str(&json).unwrap();
        assert!(!out.exists());
        succeed(&format!("{line} --quiet"), &paths);
        let writes = json["writes"].as_array().unwrap();
        assert!(!writes.is_empty());
        let done = report(&out);
        for name in writes {
            assert!(out.join(name.as_str().unwrap()).exists(), "{line}: {name} was not written");
        }
        let files = |list: &Value, of: fn(&Value) -> &Value| -> Vec<String> {
            list.as_array().unwrap().iter().map(|one| of(one).as_str().unwrap().to_owned()).collect()
        };
        assert_eq!(files(&json["inputs"], |one| one), files(&done["inputs"], |one| &one["path"]), "{line}");
        let before = crate::scratch::names(&out);
        let told = succeed(&format!("{line} --dry-run"), &paths).stdout;
        assert!(told.contains("where it would replace report.json"), "{line}: {told}");
        assert_eq!(crate::scratch::names(&out), before);
    }
}

#[test]
fn a_dry_run_of_a_part_tells_its_lines() {
    let out = Folder::new();
    let told = |line: &str| {
        let json = succeed(&format!("{line} --dry-run --format json"), &[("--out", out.path())]).stdout;
        serde_json::from_str::<Value>(&json).unwrap()["writes"].clone()
    };
    assert_eq!(told("phase-diagram --shard 1/2"), serde_json::json!(["report.json", "points.jsonl"]));
    let data = fixture("chiral-liquid");
    let line = format!("infer {} --bootstrap 40 --shard=2/2", data.display());
    assert_eq!(told(&line), serde_json::json!(["replicates.jsonl"]));
}

#[test]
fn a_dry_run_refuses_what_a_run_refuses() {
    let refused = |line: &str, facts: &[&str]| assert_arguments_refused(line.split(' '), facts);
    refused("simulate --dry-run --cells 0", &["cells"]);
    refused("simulate --dry-run --lyapunov --walls both", &["lyapunov"]);
    refused("phase-diagram --dry-run --P_0 3 4 0", &["P_0"]);
    let data = fixture("chiral-liquid");
    let data = data.to_str().unwrap();
    refused(&format!("infer {data} --dry-run --frames 7"), &["frame"]);
    refused(&format!("infer {data} --dry-run --active"), &["tracks"]);
    refused(&format!("infer {data}/none --dry-run"), &["none"]);
    let table = fixture("imports").join("imagej-results.csv");
    refused(&format!("import tracks {} --dry-run", table.display()), &["no number of a track"]);
    let own = Folder::copy_of("reference-small");
    let place = own.path().to_str().unwrap();
    assert_told(&["evaluate", place, "--out", place, "--dry-run"], &["is read by this run"]);
    assert_told(&["evaluate", data, "--out", place, "--dry-run"], &["was not written by this program"]);
    assert_told(&["evaluate", data, "--dry-run"], &["no output folder"]);
    let file = own.file("dataset.toml");
    assert_told(&["evaluate", data, "--out", file.to_str().unwrap(), "--dry-run"], &["is a file"]);
    let below = file.join("below");
    assert_told(&["evaluate", data, "--out", below.to_str().unwrap(), "--dry-run"], &["below"]);
    assert!(succeed("check-gradients --dry-run", &[]).stdout.contains("nothing, without --out"));
}

#[test]
fn every_command_has_a_manual_page() {
    let out = Folder::new();
    out.write("other.1", "");
    let told = succeed("man", &[("", out.path())]).stdout;
    let names = out.names();
    assert!(told.starts_with(&format!("{} pages written", names.len() - 1)), "{told}");
    for name in
        ["voronudge.1", "voronudge-infer.1", "voronudge-import.1", "voronudge-import-tracks.1", "other.1"]
    {
        assert!(names.iter().any(|found| found == name), "{name} is not in {names:?}");
    }
    let page = std::fs::read_to_string(out.file("voronudge-import-tracks.1")).unwrap();
    for part in
        [".TH ", ".SH NAME", ".SH SYNOPSIS", ".SH OPTIONS", "track\\-column", "voronudge import tracks"]
    {
        assert!(page.contains(part), "{part}: {page}");
    }
    assert_told(&[OsStr::new("man"), out.file("other.1").as_os_str()], &["other.1"]);
}
