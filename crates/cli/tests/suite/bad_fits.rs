//! Fits and questions that cannot be meant.

use crate::program::fixture;
use crate::refusal::{assert_hinted, assert_refused};

#[track_caller]
fn assert_infer_refuses(flags: &str, facts: &[&str]) {
    let flags: Vec<&str> = flags.split_whitespace().collect();
    assert_refused("infer", &fixture("chiral-liquid"), &flags, facts);
}

#[test]
fn parameters_fixed_wrongly_are_refused() {
    assert_infer_refuses(
        "--fix K_B=1",
        &["--fix", "K_B is not a parameter", "K_A, K_P, P_0, alpha and K_P_alpha"],
    );
    assert_infer_refuses("--fix K_A", &["--fix", "NAME=VALUE"]);
    assert_infer_refuses("--fix K_A=soft", &["--fix", "soft is not a number"]);
    assert_infer_refuses("--fix K_A=nan", &["not finite"]);
    assert_infer_refuses("--fix K_P=0", &["K_P is fixed to zero"]);
    assert_infer_refuses("--fix K_A=0.1 --fix alpha=1 --fix K_A=0.1", &["--fix", "K_A is given twice"]);
}

#[test]
fn a_fit_of_nothing_is_refused() {
    assert_infer_refuses("--fix K_A=0.1 --fix K_P=1 --fix P_0=4 --fix alpha=-1", &["nothing to fit"]);
}

#[test]
fn bounds_that_are_no_bounds_are_refused() {
    assert_infer_refuses("--bounds K_B=0..", &["--bounds", "K_B is not a parameter"]);
    assert_infer_refuses("--bounds K_A", &["--bounds", "NAME=LOW..HIGH"]);
    assert_infer_refuses("--bounds K_A=0.1", &["--bounds", "NAME=LOW..HIGH"]);
    assert_infer_refuses("--bounds K_A=..", &["--bounds", "at least one end"]);
    assert_infer_refuses("--bounds K_A=2..1", &["--bounds", "lower end 2", "upper end 1"]);
    assert_infer_refuses("--bounds alpha=-1..-1", &["--bounds", "lower end -1"]);
    assert_infer_refuses("--bounds K_A=soft..", &["--bounds", "soft is not a number"]);
    assert_infer_refuses("--bounds K_A=nan..", &["--bounds", "nan is not finite"]);
    assert_infer_refuses("--bounds K_A=0.. --bounds K_A=..1", &["--bounds", "K_A is given twice"]);
    assert_infer_refuses("--stable --bounds K_P=0..", &["--bounds", "K_P is given twice"]);
    assert_infer_refuses("--bounds K_A=0..1 --fix K_A=2", &["fixed outside of its bounds"]);
}

#[test]
fn priors_that_are_no_priors_are_refused() {
    assert_infer_refuses("--prior K_B=1±1", &["--prior", "K_B is not a parameter"]);
    assert_infer_refuses("--prior P_0=4", &["--prior", "standard deviation is missing"]);
    assert_infer_refuses("--prior P_0", &["--prior", "NAME=MEAN±SD"]);
    assert_infer_refuses("--prior P_0=4±0", &["--prior", "standard deviation is 0"]);
    assert_infer_refuses("--prior P_0=4,-1", &["--prior", "standard deviation is -1"]);
    assert_infer_refuses("--prior P_0=4+-wide", &["--prior", "wide is not a number"]);
    assert_infer_refuses("--prior P_0=4±1 --prior P_0=4±1", &["--prior", "P_0 is given twice"]);
    assert_infer_refuses("--prior P_0=4±1 --fix P_0=4", &["--prior", "P_0 is held by --fix"]);
}

/// K_A is 2·10⁴ times the true one, as where its unit was forgotten.
#[test]
fn a_value_with_which_cells_fly_apart_is_told_from_bad_positions() {
    let facts = ["fly apart before the next", "positions.npy"];
    let hint = assert_refused("infer", &fixture("open-field"), &["--fix", "K_A=0.1"], &facts);
    assert!(hint.contains("mind its unit"), "{hint}");
}

#[test]
fn a_polarity_takes_tracks_of_three_frames() {
    assert_infer_refuses("--active", &["--active is for tracks"]);
    let flags = ["--active", "--frames", "0..2"];
    assert_refused(
        "infer",
        &fixture("open-field"),
        &flags,
        &["--active", "three frames or more", "2 frames"],
    );
}

#[test]
fn methods_and_their_options_belong_together() {
    assert_infer_refuses("--method luck", &["--method", "luck"]);
    assert_infer_refuses("--loss norms", &["--loss is for --method descent"]);
    assert_infer_refuses("--method descent --loss cubes", &["--loss", "cubes"]);
    assert_infer_refuses("--method descent --starts 2", &["--starts is for --method search"]);
    for starts in ["0", "65"] {
        assert_infer_refuses(&format!("--starts {starts}"), &["--starts", "1..=64"]);
    }
}

#[test]
fn equations_that_cannot_be_solved_are_told_with_file_frame_and_cause() {
    let flags = ["--fix", "K_A=0.1", "--velocity-noise", "1e-12", "--complete", "false"];
    let facts = ["positions.npy, frame 0", "equations of the fit cannot be solved", "not positive definite"];
    assert_refused("infer", &fixture("chiral-liquid"), &flags, &facts);
    assert_hinted("infer", &fixture("chiral-liquid"), &flags, &["noise levels far from", "observe"]);
}

#[test]
fn a_share_of_missed_cells_that_is_none_is_refused_with_what_to_say_instead() {
    assert_infer_refuses("--missed-rate 0", &["--missed-rate is 0", "between 0 and 1"]);
    for (rate, hint) in [("0", "--complete false"), ("1", "0.03 for 3 %"), ("nan", "0.03 for 3 %")] {
        let flags = ["--missed-rate", rate];
        assert_hinted("infer", &fixture("chiral-liquid"), &flags, &[hint]);
    }
}

#[test]
fn questions_without_an_answer_are_refused() {
    assert_infer_refuses("--profile K_B", &["--profile", "K_B is not a parameter"]);
    assert_infer_refuses("--profile K_A --fix K_A=0.1", &["--profile", "K_A is held"]);
    assert_infer_refuses(
        "--profile K_P_alpha --fix K_P=1 --fix alpha=3",
        &["--profile", "K_P_alpha is held"],
    );
    assert_infer_refuses("--profile K_A --profile K_A", &["--profile", "K_A is given twice"]);
    assert_infer_refuses("--landscape P_0", &["--landscape", "NAME,NAME"]);
    assert_infer_refuses("--landscape P_0,P_0", &["--landscape", "P_0 is named twice"]);
    assert_infer_refuses("--landscape P_0,beta", &["--landscape", "beta is not a parameter"]);
    assert_infer_refuses("--landscape P_0,alpha --fix P_0=4", &["--landscape P_0,alpha", "P_0 is held"]);
    let tied = "--landscape K_P,alpha --fix K_P_alpha=3.4";
    assert_infer_refuses(tied, &["--landscape K_P,alpha", "determines the other"]);
    for points in ["3", "102"] {
        assert_infer_refuses(&format!("--profile K_P --points {points}"), &["--points", "5..=101"]);
    }
    for count in ["39", "10001"] {
        assert_infer_refuses(&format!("--bootstrap {count}"), &["--bootstrap", "40 to 10000"]);
    }
    assert_infer_refuses("--bootstrap many", &["--bootstrap", "many is not a number"]);
}
