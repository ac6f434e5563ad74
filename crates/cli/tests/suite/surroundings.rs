//! `simulate` under shear and between walls, and what other commands make of it.

use crate::program::succeed;
use crate::refusal::{assert_arguments_refused, assert_refused};
use crate::scratch::{Folder, assert_close, number, read, report};
use ndarray::Array3;
use std::fs;

const LINE: &str = "simulate --cells 60 --box 10 6 --time 2 --frames 4 --P_0 4 --alpha 1 --quiet";

fn simulate(flags: &str) -> Folder {
    let out = Folder::new();
    succeed(&format!("{LINE} {flags}"), &[("--out", out.path())]);
    out
}

/// Strain rate at a time.
type Rate = fn(f64) -> f64;

/// Recorded velocities are those of the model and the streaming γ̇ y of the shear.
#[test]
fn a_sheared_run_is_evaluated_in_its_box() {
    let rates: [(&str, Rate); 3] = [
        ("--shear-strain 0.3", |_| 0.0),
        ("--shear-rate -0.4", |_| -0.4),
        ("--shear-amplitude 0.2 --shear-frequency 3", |t| 0.6 * (3.0 * t).cos()),
    ];
    for (flags, rate) in rates {
        let (run, model) = (simulate(flags), Folder::new());
        let parameters = run.file("report.json");
        let paths = [("", run.path()), ("--parameters", &parameters), ("--out", model.path())];
        succeed("evaluate", &paths);
        let positions: Array3<f64> = read(&run.file("positions.npy"));
        let mut recorded: Array3<f64> = read(&run.file("velocities.npy"));
        for ((frame, cell, axis), v) in recorded.indexed_iter_mut() {
            if axis == 0 {
                *v -= rate(0.5 * (frame + 1) as f64) * positions[(frame, cell, 1)];
            }
        }
        assert_close(&read(&model.file("velocities.npy")), &recorded.into_dyn(), 1e-8);
        // Modes are those of the sheared box too; it goes on from the last frame; a fit refuses it.
        let modes = Folder::new();
        succeed("spectrum --frames 3 --values-only", &[("", run.path()), ("--out", modes.path())]);
        let next = Folder::new();
        succeed("simulate --time 0.1 --frames 1", &[("--start", run.path()), ("--out", next.path())]);
        let settings = fs::read_to_string(next.file("dataset.toml")).unwrap();
        assert!(settings.contains("box_offset = ["), "{settings}");
        assert_refused("infer", run.path(), &[], &["sheared"]);
    }
}

#[test]
fn cells_between_walls_stay_there_and_other_commands_say_so() {
    let run = simulate("--walls both");
    let positions: Array3<f64> = read(&run.file("positions.npy"));
    for ((.., axis), x) in positions.indexed_iter() {
        assert!((0.0..=[10.0, 6.0][axis]).contains(x), "{x}");
    }
    let report = report(run.path());
    assert_eq!(report["walls"], "both");
    assert!((number(&report, "/area/mean") - 1.0).abs() < 1e-9);
    for command in ["infer", "discover", "evaluate"] {
        assert_refused(command, run.path(), &[], &["walls"]);
    }
}

#[test]
fn impossible_surroundings_are_refused() {
    let refuse = |flags: &str, fact: &str| {
        assert_arguments_refused(format!("simulate --cells 20 --time 1 {flags}").split_whitespace(), &[fact]);
    };
    refuse("--shear-rate 1 --shear-strain 1", "cannot be used with");
    refuse("--shear-amplitude 1", "required");
    refuse("--shear-rate inf", "--shear-rate is inf");
    refuse("--walls x --shear-rate 1", "cannot be used with");
    refuse("--walls x --effect drift=0.1,0.2", "walls");
    refuse("--walls x --effect coordination_tension=0.1", "walls");
    refuse("--walls x --effect p0_gradient=0.1,0.1,0.1,0.1", "walls");
}

#[test]
fn wrong_offsets_are_told() {
    let run = simulate("--shear-rate 0.1");
    let settings = fs::read_to_string(run.file("dataset.toml")).unwrap();
    let start = settings.find("box_offset = [").unwrap();
    let end = start + settings[start..].find('\n').unwrap();
    for (line, fact) in [
        ("box_offset = [0.0]", "1 entries, but there are 4 frames"),
        ("box_offset = 0.1", "box_offset is a number"),
        ("box_offset = [0.0, 0.0, nan, 0.0]", "must be finite"),
        ("walls = \"y\"", "walls is \"y\""),
    ] {
        run.write("dataset.toml", format!("{}{line}{}", &settings[..start], &settings[end..]));
        assert_refused("evaluate", run.path(), &[], &[fact]);
    }
}
