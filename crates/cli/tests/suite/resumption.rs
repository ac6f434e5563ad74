//! A run that is killed goes on from its last checkpoint, and its result is that of a run that was not.

use crate::program::{command, succeed};
use crate::scratch::Folder;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Runs with checkpoints, killed after one random share after another of the time that it takes on the whole, until it ends by itself;
/// how often it was killed.
fn run_to_the_end(line: &str, flags: &[&str], out: &Path, whole: Duration, mut random: u64) -> usize {
    for kills in 0..200 {
        let mut command = command();
        command.args(line.split_whitespace()).args(flags).args(["--resume", "--out"]).arg(out);
        let mut run = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = 0.1 + 0.3 * (random >> 33) as f64 / (1u64 << 31) as f64;
        let patience = whole.mul_f64(share + 0.05 * kills as f64);
        let begun = Instant::now();
        let ended = loop {
            match run.try_wait().unwrap() {
                Some(status) => break Some(status),
                None if begun.elapsed() > patience => break None,
                None => sleep(Duration::from_millis(2)),
            }
        };
        match ended {
            Some(status) => {
                assert!(status.success(), "{status}");
                return kills;
            }
            None => {
                run.kill().unwrap();
                run.wait().unwrap();
            }
        }
    }
    panic!("it does not come to an end");
}

fn assert_killed_and_resumed_is_the_same(line: &str) {
    let names = crate::simulations::FILES.into_iter().filter(|name| !name.starts_with("report"));
    let names: Vec<_> = names.collect();
    let whole = Folder::new();
    let begun = Instant::now();
    succeed(&format!("{line} --quiet"), &[("--out", whole.path())]);
    let time = begun.elapsed();
    let mut kills = 0;
    for seed in 0..3 {
        let parts = Folder::new();
        kills += run_to_the_end(line, &["--checkpoint", "0.02"], parts.path(), time, seed);
        for name in &names {
            assert!(
                fs::read(parts.file(name)).unwrap() == fs::read(whole.file(name)).unwrap(),
                "{name}, seed {seed}"
            );
        }
        let value = |folder: &Folder, key: &str| {
            let report = crate::scratch::report(folder.path());
            report.pointer(key).unwrap().clone()
        };
        for key in
            ["/mean_square_velocity", "/mean_square_velocity_error", "/t1_rate", "/hexatic_order", "/steps"]
        {
            assert_eq!(value(&parts, key), value(&whole, key), "{key}");
        }
        assert_eq!(parts.names(), crate::simulations::FILES);
    }
    assert!(kills >= 3, "killed {kills} times only");
}

#[test]
fn a_killed_run_goes_on_to_the_same_bytes() {
    assert_killed_and_resumed_is_the_same(
        "simulate --cells 200 --time 12 --dt 0.01 --frames 90 --alpha 1 --seed 5 --threads 1",
    );
}

#[test]
fn a_killed_run_with_noise_and_adaptive_steps_goes_on_to_the_same_bytes() {
    assert_killed_and_resumed_is_the_same(
        "simulate --cells 200 --time 10 --dt 0.02 --frames 50 --method adaptive --tolerance 1e-3 --alpha 1 --seed 6 --self-propulsion 0.5 --rotational-diffusion 1 --free-speed --alignment 1 --contact-inhibition 2 --velocity-alignment 0.2 --diffusion 0.01 --threads 2",
    );
}

#[test]
fn a_killed_diagram_goes_on_to_the_same_bytes() {
    let line = "phase-diagram --P_0 3.6 4 3 --alpha -0.2 0.2 3 --replicas 2 --cells 64 --time 6 --seed 3";
    let names = |folder: &Folder| -> Vec<String> {
        folder.names().into_iter().filter(|name| !name.starts_with("report")).collect()
    };
    let whole = Folder::new();
    let begun = Instant::now();
    succeed(&format!("{line} --threads 1 --quiet"), &[("--out", whole.path())]);
    let time = begun.elapsed() / 2;
    let mut kills = 0;
    for seed in 0..2 {
        let parts = Folder::new();
        kills += run_to_the_end(line, &["--threads", "2"], parts.path(), time, seed);
        assert_eq!(parts.names(), whole.names());
        for name in names(&whole) {
            let bytes = |folder: &Folder| fs::read(folder.file(&name)).unwrap();
            assert!(bytes(&parts) == bytes(&whole), "{name}, seed {seed}");
        }
    }
    assert!(kills >= 2, "killed {kills} times only");
}
