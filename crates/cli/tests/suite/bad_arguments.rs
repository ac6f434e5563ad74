//! Command lines that cannot be meant.

use crate::program::{fixture, voronudge};
use crate::refusal::{assert_arguments_refused, assert_refused, assert_unreadable};
use crate::scratch::Folder;

#[track_caller]
fn assert_infer_refuses(flags: &str, facts: &[&str]) {
    let flags: Vec<&str> = flags.split_whitespace().collect();
    assert_refused("infer", &fixture("chiral-liquid"), &flags, facts);
}

#[track_caller]
fn assert_line_refused(line: &str, facts: &[&str]) {
    assert_arguments_refused(line.split_whitespace(), facts);
}

#[test]
fn impossible_noise_is_refused() {
    assert_infer_refuses("--position-noise -0.1", &["--position-noise", "-0.1", "not negative"]);
    assert_infer_refuses("--velocity-noise -2%", &["--velocity-noise", "-0.02", "not negative"]);
    assert_infer_refuses("--position-noise nan", &["--position-noise", "finite"]);
    assert_infer_refuses("--position-noise 0", &["position noise is 0"]);
    assert_infer_refuses("--velocity-noise much", &["--velocity-noise", "much"]);
}

#[test]
fn frames_that_are_no_selection_are_refused() {
    for flags in ["--frames one", "--frames 3..1", "--frames 1,,2", "--frames -1"] {
        assert_infer_refuses(flags, &["--frames"]);
    }
    assert_infer_refuses("--frames 0,0", &["positions.npy", "frame 0 is named twice"]);
}

#[test]
fn a_largest_area_that_is_no_factor_is_refused() {
    for factor in ["nan", "0", "-1", "inf"] {
        let flags = format!("--largest-area {factor}");
        assert_infer_refuses(&flags, &["--largest-area", "finite and above zero"]);
    }
}

#[test]
fn impossible_numbers_of_threads_are_refused() {
    assert_unreadable(&fixture("chiral-liquid"), &["--threads", "0"], &["--threads is 0"]);
    assert_line_refused("simulate --threads 0", &["--threads is 0"]);
    assert_line_refused("check-gradients --threads 0", &["--threads is 0"]);
    assert_line_refused("evaluate --threads 999999999", &["--threads is 999999999", "1024"]);
}

#[test]
fn negative_numbers_are_refused_where_counts_are_needed() {
    for flag in ["--seed", "--threads", "--max-steps", "--starts", "--bootstrap", "--points"] {
        assert_infer_refuses(&format!("{flag} -1"), &[flag, "-1"]);
    }
    assert_line_refused("simulate --cells -1", &["--cells", "-1"]);
    assert_line_refused("simulate --frames -1", &["--frames", "-1"]);
}

#[test]
fn contradicting_and_unknown_flags_are_refused() {
    assert_infer_refuses("--box 10 10 --open", &["--box", "--open"]);
    assert_infer_refuses("--y-axis left", &["--y-axis", "left"]);
    assert_infer_refuses("--difference sideways", &["--difference", "sideways"]);
    assert_infer_refuses("--format yaml", &["--format", "yaml", "json"]);
    assert_infer_refuses("--treads 2", &["--treads"]);
    assert_line_refused("inferr", &["inferr"]);
}

#[test]
fn a_command_without_data_is_refused() {
    assert_line_refused("infer", &["no data"]);
    assert_line_refused("evaluate", &["no data"]);
}

#[test]
fn parameter_files_that_hold_no_parameters_are_refused() {
    for (content, fact) in [
        ("{\"K_A\": 0.1,", "not JSON"),
        ("[0.1, 1, 4, 1, 0]", "not a table"),
        ("{}", "none of K_A"),
        ("{\"parameters\": 3}", "not a table"),
        ("{\"K_A\": \"soft\"}", "K_A is not a finite number"),
        ("{\"P_0\": {\"value\": null}}", "P_0 is not a finite number"),
    ] {
        let folder = Folder::new();
        let file = folder.write("tissue.json", content);
        let flags = ["--parameters", file.to_str().unwrap()];
        assert_refused("evaluate", &fixture("reference-small"), &flags, &["tissue.json", fact]);
    }
    let flags = ["--parameters", "gone.json"];
    assert_refused("evaluate", &fixture("reference-small"), &flags, &["gone.json"]);
}

#[test]
fn parameters_that_are_not_finite_are_refused() {
    for name in ["K_A", "K_P", "P_0", "A_0", "alpha"] {
        let flag = format!("--{name}");
        assert_refused("evaluate", &fixture("reference-small"), &[&flag, "nan"], &[&flag, "NaN"]);
    }
}

#[test]
fn impossible_simulations_are_refused() {
    assert_line_refused("simulate --cells 0", &["--cells is 0"]);
    assert_line_refused("simulate --frames 0", &["0 frames"]);
    assert_line_refused("simulate --dt 0", &["time step is 0"]);
    assert_line_refused("simulate --time -5", &["duration is -5"]);
    assert_line_refused("simulate --alignment 1", &["self-propulsion"]);
    assert_line_refused(
        "simulate --effect contact_inhibition=1",
        &["--contact-inhibition", "self-propulsion"],
    );
    assert_line_refused("simulate --free-speed", &["--free-speed", "self-propulsion"]);
    assert_line_refused("simulate --diffusion 0.1 --effect random_motion=0.1", &["--diffusion", "the same"]);
    assert_line_refused("simulate --effect polarity=0.3", &["1 coefficients", "2"]);
    assert_line_refused("simulate --box 0 4", &["box side x is 0"]);
    assert_line_refused("simulate --frames 99999999999999", &["--frames 99999999999999"]);
    assert_line_refused("simulate --cells 3000000000000", &["--cells 3000000000000"]);
}

#[test]
fn help_and_version_are_no_faults() {
    for arguments in [["--help"].as_slice(), &["infer", "--help"], &["--version"]] {
        let outcome = voronudge(arguments);
        assert_eq!(outcome.code, Some(0));
        assert!(outcome.stdout.contains("voronudge") && outcome.stderr.is_empty(), "{outcome:?}");
    }
}

/// Scripts that ask for JSON get faults in it, and people as ever.
#[test]
fn faults_are_told_as_json_where_results_are() {
    for line in ["infer /nowhere --format json", "infer --format=json --frames one"] {
        let outcome = voronudge(line.split_whitespace());
        let told: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
        assert_eq!((outcome.code, &told["exit_code"]), (Some(2), &2.into()));
        let [error, hint] = ["error", "hint"].map(|name| told[name].as_str().unwrap());
        assert_eq!(outcome.stderr, format!("error: {error}\n\nhint: {hint}\n"));
    }
    assert_eq!(voronudge(["infer", "/nowhere"]).stdout, "");
}

#[test]
fn shells_learn_all_commands_and_options() {
    for shell in ["bash", "zsh", "fish"] {
        let outcome = voronudge(["completions", shell]);
        assert_eq!(outcome.code, Some(0));
        for word in ["phase-diagram", "trackmate", "position-noise"] {
            assert!(outcome.stdout.contains(word), "{shell} {word}");
        }
    }
    assert_eq!(voronudge(["completions", "tcsh"]).code, Some(2));
}
