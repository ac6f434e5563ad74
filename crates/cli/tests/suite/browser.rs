//! The pages of commands in a browser, where there is one.

#[path = "../../../report/tests/report/chromium.rs"]
mod chromium;

use crate::program::{fixture, succeed};
use crate::scratch::Folder;
use std::fs;

/// Name of a run, what is typed, and what it reads: a fixture, or what is in the folder of all: results of an earlier run, or a fit of a solid.
const RUNS: [(&str, &str, &str); 14] = [
    ("infer", "infer", "fixture chiral-liquid"),
    ("discover", "discover --effects drift,alpha_area,p0_gradient", "fixture chiral-liquid"),
    ("long", "simulate --cells 60 --time 8 --frames 80 --P_0 4 --alpha 1", ""),
    ("simulate", "simulate --cells 60 --box 10 6 --time 2 --frames 6 --P_0 4 --alpha 1", ""),
    ("observe", "observe", "simulate"),
    ("waves", "waves --P_0 4 --alpha 1", "long"),
    ("tracks", "infer --fix K_A=0.1 --frames 0..4 --position-noise 1%", "simulate"),
    ("spectrum", "spectrum", "fixture reference-small"),
    ("phase-diagram", "phase-diagram --P_0 3.5 4 3 --alpha 0.1 0.3 2 --cells 36 --time 2", ""),
    ("moduli", "moduli --cells 16 --P_0 3 --time 20 --frequencies 0.01 1", ""),
    ("rheology", "rheology --cells 16 --replicas 2", "solid"),
    (
        "channel",
        "channel --preset ht1080 --width 200 --length 150 --relaxation 2 --time 8 --dt 0.02 --samples 8 --frames 3",
        "",
    ),
    ("estimate-chirality", "estimate-chirality", "channel"),
    ("labels", "import labels --link labels", "fixture examples/masks.tif"),
];

#[test]
fn every_page_can_be_read() {
    let scratch = Folder::new();
    scratch.write("solid", crate::rheology::fit(3.0, 0.5, 3).to_string());
    let page = |(name, line, data): (&str, &str, &str)| {
        let data = match data.strip_prefix("fixture ") {
            Some(data) => Some(fixture(data)),
            None => (!data.is_empty()).then(|| scratch.file(data)),
        };
        let out = scratch.file(name);
        let read = data.iter().map(|data| ("", data.as_path()));
        let paths: Vec<_> = read.chain([("--out", out.as_path())]).collect();
        succeed(&format!("{line} --quiet --seed 1"), &paths);
        (format!("{name}.html"), fs::read_to_string(out.join("report.html")).unwrap())
    };
    chromium::assert_sound(&RUNS.map(page), "(ℓ₀|length)²").unwrap();
}
