//! `simulate --sensitivity`: derivatives of a run beside runs with other parameters.

use crate::program::succeed;
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array3, Array4, Axis, Ix2, Ix3};
use serde_json::Value;

fn simulate(flags: &str) -> Folder {
    let out = Folder::new();
    let line = "simulate --cells 60 --box 10 6 --P_0 4 --time 0.4 --frames 4 --seed 5 --quiet";
    succeed(&format!("{line} {flags}"), &[("--out", out.path())]);
    out
}

/// Derivatives of a run are those of runs with other parameters, of what is measured too.
#[test]
fn a_run_is_differentiated() {
    const STEP: f64 = 1e-6;
    let run = simulate("--alpha 0.5 --sensitivity alpha,y7");
    let slopes: Array4<f64> = read(&run.file("position_derivatives.npy"));
    assert_eq!(slopes.dim(), (2, 4, 60, 2));
    let measured: Array3<f64> = read(&run.file("measurement_derivatives.npy"));
    assert_eq!(measured.dim(), (2, 4, 7));
    let beside = [0.5 + STEP, 0.5 - STEP].map(|alpha| simulate(&format!("--alpha {alpha}")));
    let [plus, minus] = beside.each_ref().map(|run| read::<f64, Ix3>(&run.file("positions.npy")));
    let differences = (plus - minus) / (2.0 * STEP);
    let of_alpha = slopes.index_axis(Axis(0), 0);
    let size = of_alpha.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    let error = (&differences - &of_alpha).iter().fold(0.0, |error: f64, x| error.max(x.abs()));
    assert!(size > 0.01 && error < 1e-4 * size, "{error:.1e} of {size:.1e}");
    let squares = beside.each_ref().map(|run| read::<f64, Ix2>(&run.file("mean_square_velocity.npy")));
    for frame in 0..4 {
        let difference = (squares[0][(frame, 1)] - squares[1][(frame, 1)]) / (2.0 * STEP);
        let slope = measured[(0, frame, 1)];
        assert!((difference - slope).abs() < 1e-4 * slope.abs() + 1e-6, "{frame}: {difference} {slope}");
        assert!((measured[(0, frame, 0)] - 0.1 * (frame + 1) as f64).abs() < 1e-12);
    }
    let report = report(run.path());
    assert_eq!(report["sensitivity"][0]["by"], "alpha");
    for direction in 0..2 {
        let agrees = (0..4).take_while(|frame| measured[(direction, *frame, 6)] <= 0.1).count();
        let until = report.pointer(&format!("/sensitivity/{direction}/agrees_until")).and_then(Value::as_f64);
        assert_eq!(until.map(|time| (10.0 * time).round() as usize), (agrees > 0).then_some(agrees));
    }
    let stresses = beside.each_ref().map(|run| number(&crate::scratch::report(run.path()), "/stress/0/1"));
    let slope = number(&report, "/sensitivity/0/stress/0/1");
    let difference = (stresses[0] - stresses[1]) / (2.0 * STEP);
    assert!((difference - slope).abs() < 1e-4 * slope.abs(), "{difference} {slope}");
}

#[test]
fn a_run_is_differentiated_by_what_there_is() {
    for (names, said) in [
        ("gamma", ["\"gamma\"", "K_A, K_P, P_0, alpha"]),
        ("x20", ["\"x20\"", "y19"]),
        ("alpha,P_0,alpha", ["alpha twice", "once"]),
    ] {
        let line = format!("simulate --cells 20 --time 1 --sensitivity {names}");
        let hint = assert_arguments_refused(line.split_whitespace(), &said[..1]);
        assert!(hint.contains(said[1]), "{hint}");
    }
}
