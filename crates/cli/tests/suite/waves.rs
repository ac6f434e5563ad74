//! `waves`: D(q) of a recording beside that of the model that it was simulated with.

use crate::program::{assert_described, succeed};
use crate::refusal::assert_refused;
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array2, Array3, Axis};
use serde_json::Value;

const MODEL: &str = "--P_0 3.3 --K_A 0 --alpha 0.6";

/// A honeycomb that is kept going by noise, from where it has forgotten its beginning.
fn solid() -> Folder {
    let run = Folder::new();
    let line = format!(
        "simulate --start honeycomb --cells 120 {MODEL} --diffusion 1e-4 --time 160 --dt 0.01 --frames 800 --seed 4 --quiet"
    );
    succeed(&line, &[("--out", run.path())]);
    run
}

fn matrix(shell: &Value, pointer: &str) -> [f64; 4] {
    std::array::from_fn(|k| number(shell, &format!("{pointer}/{}/{}", k / 2, k % 2)))
}

/// A number between 0 and 1 that looks random, for some counters (SplitMix64).
fn uniform(counters: [usize; 3]) -> f64 {
    let seed =
        counters.into_iter().fold(0_u64, |seed, counter| seed.wrapping_mul(1_000_003) + counter as u64);
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Fluctuations tell the D(q) of the Jacobian and of the theory, a mirror image has the other chirality, and errors of localisation are told.
#[test]
fn a_solid_shows_its_odd_waves() {
    let (run, out, mirrored) = (solid(), Folder::new(), Folder::new());
    let line = format!("waves --frames 100..800 --largest-wave-number 1.5 {MODEL}");
    succeed(&line, &[("", run.path()), ("--out", out.path())]);
    let found = report(out.path());
    assert_described(&found);
    assert_eq!((&found["field"], &found["verdict"]), (&"displacements".into(), &"linear".into()));
    assert!(number(&found, "/achiral") < 1e-6);
    let shells = found["shells"].as_array().unwrap();
    let (mut pulls, mut told) = (Vec::new(), 0);
    for shell in shells {
        let [measured, errors] =
            ["/relaxation/matrix", "/relaxation/standard_errors"].map(|pointer| matrix(shell, pointer));
        let [projected, relaxed, theory] =
            ["/jacobian", "/jacobian_relaxed", "/mean_field"].map(|pointer| matrix(shell, pointer));
        for k in 0..4 {
            pulls.push((measured[k] - projected[k]) / errors[k]);
            // Places are means over a finite time, and shells have some directions only.
            assert!((projected[k] - theory[k]).abs() < 0.12 * theory[0] + 0.02, "{shell}");
            assert!((projected[k] - relaxed[k]).abs() < 0.02 * projected[0] + 0.002, "{shell}");
        }
        told += usize::from(number(shell, "/relaxation/frequency_ci95/0") > 0.0);
    }
    let square = pulls.iter().map(|pull| pull * pull).sum::<f64>() / pulls.len() as f64;
    assert!(square < 2.0, "{square}: {pulls:?}");
    assert!(told >= 2, "odd waves in {told} shells");
    let table: Array2<f64> = read(&out.file("dynamical_matrix.npy"));
    assert_eq!(table.dim(), (shells.len(), 9));
    let model: Array2<f64> = read(&out.file("dynamical_matrix_model.npy"));
    assert_eq!(model[(0, 1)], number(&shells[0], "/jacobian/0/0"));
    let odd: Array3<f64> = read(&out.file("dynamic_structure_odd_imaginary.npy"));
    assert_eq!(odd.dim().0, shells.len());

    let mut positions: Array3<f64> = read(&run.file("positions.npy"));
    let settings = std::fs::read_to_string(run.file("dataset.toml")).unwrap();
    let sides = settings.lines().find(|line| line.starts_with("box = ")).unwrap();
    positions.index_axis_mut(Axis(2), 0).mapv_inplace(|x| -x);
    mirrored.write_array("positions.npy", &positions);
    let settings = format!("boundary = \"periodic\"\n{sides}\nframe_interval = 0.2\nunwrapped = true\n");
    mirrored.write("dataset.toml", settings);
    succeed(
        "waves --frames 100..800 --largest-wave-number 1.5",
        &[("", mirrored.path()), ("--out", out.path())],
    );
    let image = report(out.path());
    for (shell, other) in shells.iter().zip(image["shells"].as_array().unwrap()) {
        let [own, other] = [shell, other].map(|shell| matrix(shell, "/relaxation/matrix"));
        for (k, sign) in [1.0, -1.0, -1.0, 1.0].into_iter().enumerate() {
            assert!((own[k] - sign * other[k]).abs() < 1e-8, "{own:?} {other:?}");
        }
    }
    let other: Array3<f64> = read(&out.file("dynamic_structure_odd_imaginary.npy"));
    let largest = odd.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let [mut same, mut opposite] = [0.0_f64; 2];
    for ((_, a), (_, b)) in odd.indexed_iter().zip(other.indexed_iter()).filter(|((at, _), _)| at.2 == 0) {
        (same, opposite) = (same.max((a - b).abs()), opposite.max((a + b).abs()));
    }
    assert!(opposite < 1e-9 * largest && same > largest, "{opposite} {same} {largest}");
    assert!(image["parameters"].is_null() && image["shells"][0]["jacobian"].is_null());

    // Errors of localisation of .005, and a gap in twenty.
    for ((frame, cell, axis), x) in positions.indexed_iter_mut() {
        *x += 0.005 * 12f64.sqrt() * (uniform([frame, cell, axis]) - 0.5);
        if (frame * 7 + cell * 13) % 20 == 0 {
            *x = f64::NAN;
        }
    }
    mirrored.write_array("positions.npy", &positions);
    succeed(&format!("waves --frames 100..800 {MODEL}"), &[("", mirrored.path()), ("--out", out.path())]);
    let part = report(out.path());
    assert_described(&part);
    assert!((number(&part, "/localisation/value") / 0.005 - 1.0).abs() < 0.3, "{}", part["localisation"]);
    assert!(number(&part, "/achiral") < 0.01);
}

#[test]
fn results_do_not_depend_on_threads_and_bad_requests_are_refused() {
    let (run, one, three) = (Folder::new(), Folder::new(), Folder::new());
    succeed(
        "simulate --cells 64 --P_0 4 --alpha 1 --time 12 --frames 60 --seed 3 --quiet",
        &[("--out", run.path())],
    );
    succeed("waves --threads 1 --P_0 4 --alpha 1", &[("", run.path()), ("--out", one.path())]);
    succeed("waves --threads 3 --P_0 4 --alpha 1", &[("", run.path()), ("--out", three.path())]);
    for name in ["dynamical_matrix.npy", "dynamic_structure_transverse.npy", "dynamical_matrix_model.npy"] {
        assert_eq!(
            std::fs::read(one.file(name)).unwrap(),
            std::fs::read(three.file(name)).unwrap(),
            "{name}"
        );
    }
    assert_eq!(report(one.path())["field"], "velocities");
    let cells = run.path();
    assert_refused("waves", cells, &["--lag", "0"], &["--lag is 0"]);
    assert_refused("waves", cells, &["--lag", "40"], &["lags reach 81 frames"]);
    assert_refused("waves", cells, &["--largest-wave-number", "-1"], &["--largest-wave-number is -1"]);
    assert_refused("waves", cells, &["--largest-wave-number", "0.1"], &["no waves up to this wave number"]);
    assert_refused("waves", cells, &["--frames", "0..5"], &["5 frames", "12 at least"]);
    let uneven = "0,1,2,3,4,5,6,7,8,9,10,11,12,20";
    assert_refused("waves", cells, &["--frames", uneven], &["is not that between the others"]);
}
