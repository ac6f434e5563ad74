//! `discover`: what it adds to tissues whose missing effect is known, and the files it leaves.

use crate::program::{assert_described, fixture, succeed};
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array2, Array3};
use serde_json::Value;
use std::fs;
use std::path::Path;

const FILES: [&str; 9] = [
    "after_nudged_positions.npy",
    "after_predicted_velocities.npy",
    "after_residual_velocities.npy",
    "before_nudged_positions.npy",
    "before_predicted_velocities.npy",
    "before_residual_velocities.npy",
    "latent_cells.npy",
    "report.html",
    "report.json",
];

/// The results of a search.
fn discover(data: &Path, flags: &str) -> Folder {
    let out = Folder::new();
    succeed(&format!("discover {flags}"), &[("", data), ("--out", out.path())]);
    out
}

/// Sum of the squares of an array, without what is absent.
fn squares(folder: &Folder, name: &str) -> f64 {
    let array: Array2<f64> = read(&folder.file(name));
    array.iter().filter(|value| value.is_finite()).map(|value| value * value).sum()
}

#[test]
fn what_is_found_is_put_to_the_test_on_other_data() {
    let data = fixture("undeclared/set-05");
    let options = ["--null-sets", "0", "--effects", "drift,rotation", "--predict"];
    // The same data must be predicted about as well as they are fitted; a twin without the drift must not.
    let twin = fixture("undeclared/set-08");
    let out = Folder::new();
    let (same, other) = (data.to_str().unwrap(), twin.to_str().unwrap());
    let line = format!("discover {} {same} --predict {other}", options.join(" "));
    succeed(&line, &[("", &data), ("--out", out.path())]);
    let report = report(out.path());
    assert_described(&report);
    assert_eq!(report["predictions"].as_array().unwrap().len(), 2);
    let error = |at: &str| number(&report, &format!("/predictions/{at}/value"));
    assert!((error("0/after") - number(&report, "/after/nmse/un_nudged")).abs() < 1e-9);
    assert!(error("0/after") < error("0/before"));
    assert!(error("1/after") > error("1/before"));
}

#[test]
fn a_drift_is_found_and_taken_out() {
    let data = fixture("undeclared/set-05");
    let out = discover(&data, "");
    assert_eq!(out.names(), FILES);
    let report = report(out.path());
    assert_described(&report);
    assert_eq!(report["verdict"], "attributed");
    let selected: Vec<&Value> = report["selected"].as_array().unwrap().iter().collect();
    assert_eq!(selected.len(), 1, "{selected:?}");
    assert_eq!(selected[0]["effect"], "drift");
    assert_eq!(selected[0]["kind"], "motion");
    // The truth of this set is (0.931, -0.698).
    for (k, truth) in [(0, 0.931), (1, -0.698)] {
        let end = |side: usize| number(&report, &format!("/selected/0/ci95/{k}/{side}"));
        assert!(end(0) < truth && truth < end(1), "coefficient {k}: {} to {}", end(0), end(1));
        assert_eq!(report["selected"][0]["coefficients"][k]["unit"], "ℓ₀ τ⁻¹");
    }
    let held_out = |side: &str| number(&report, &format!("/{side}/nmse/cross_validated/value"));
    assert!(held_out("after") < 0.5 * held_out("before"));
    assert!(report["before"]["nmse"]["held_out_frames"].is_null());
    assert!(report["sentence"].as_str().unwrap().contains("drift"));
    assert!(report["caveat"].as_str().unwrap().contains("association"));
    // Every candidate has a reason.
    let ranking = report["ranking"].as_array().unwrap();
    assert_eq!(ranking[0]["effect"], "drift");
    assert!(ranking.iter().all(|candidate| !candidate["reason"].as_str().unwrap().is_empty()));
    // Nothing is read beside the data set.
    let folder = data.display().to_string();
    for input in report["inputs"].as_array().unwrap() {
        let path = input["path"].as_str().unwrap();
        assert!(path.starts_with(&folder) && !path.contains("truth"), "{path}");
    }
}

#[test]
fn arrays_before_and_after_belong_to_the_cells() {
    let data = fixture("undeclared/set-05");
    let out = discover(&data, "--effects drift,smooth_field --null-sets 0");
    let velocities: Array2<f64> = read(&data.join("velocities.npy"));
    for side in ["before", "after"] {
        let field = |name: &str| -> Array2<f64> { read(&out.file(&format!("{side}_{name}.npy"))) };
        let [nudged, predicted, residual] =
            ["nudged_positions", "predicted_velocities", "residual_velocities"].map(field);
        assert_eq!(nudged.dim(), velocities.dim());
        let error = (&predicted + &residual - &velocities).iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        assert!(error < 1e-9, "{side}: {error}");
    }
    let rest = |side: &str| squares(&out, &format!("{side}_residual_velocities.npy"));
    assert!(rest("after") < 0.7 * rest("before"));
    let report = report(out.path());
    let ranking = report["ranking"].as_array().unwrap().iter();
    let mut ids: Vec<&str> = ranking.map(|own| own["effect"].as_str().unwrap()).collect();
    ids.sort_unstable();
    assert_eq!(ids, ["drift", "position_noise", "smooth_field"]);
}

#[test]
fn nothing_is_added_where_nothing_is_missing() {
    let out = discover(&fixture("undeclared/set-48"), "");
    assert_eq!(out.names(), FILES);
    let report = report(out.path());
    assert_described(&report);
    assert_eq!(report["verdict"], "nothing_missing");
    assert_eq!(report["selected"], serde_json::json!([]));
    assert_eq!(report["before"]["parameters"], report["after"]["parameters"]);
    assert!(report["caveat"].as_str().unwrap().contains("detection limits"));
    for name in ["nudged_positions.npy", "residual_velocities.npy"] {
        let [before, after] =
            ["before", "after"].map(|side| fs::read(out.file(&format!("{side}_{name}"))).unwrap());
        assert!(before == after, "{name}");
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let [one, two] = ["1", "2"].map(|threads| {
        let flags = format!("--effects drift,alpha_area --null-sets 3 --seed 5 --threads {threads}");
        let out = discover(&fixture("undeclared/set-48"), &flags);
        let report = report(out.path());
        (report["after"].clone(), report["ranking"].clone(), report["sentence"].clone())
    });
    assert!(one == two);
}

#[test]
fn the_summary_tells_the_verdict_and_the_best_candidates() {
    let out = Folder::new();
    let data = fixture("undeclared/set-48");
    let outcome = succeed("discover --null-sets 0", &[("", &data), ("--out", out.path())]);
    for text in ["nothing missing:", "held out", "candidate", "more in the report", "report.html"] {
        assert!(outcome.stdout.contains(text), "\"{text}\" is not in {}", outcome.stdout);
    }
    let outcome =
        succeed("discover --null-sets 0 --format json --quiet", &[("", &data), ("--out", out.path())]);
    let printed: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_described(&printed);
    assert_eq!(printed, report(out.path()));
}

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let out = discover(&fixture("undeclared/set-48"), "--null-sets 0");
    let page = fs::read_to_string(out.file("report.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("nothing missing"));
    let without_namespaces = page.replace("http://www.w3.org/", "");
    for outside in ["http://", "https://", "src=\"//", "href=\"//", "url(", "@import"] {
        assert!(!without_namespaces.contains(outside), "the page refers to {outside}");
    }
}

/// Positions alone, of cells that move as the model says: the tracks themselves are searched.
#[test]
#[ignore = "slow"]
fn tracks_that_lack_nothing_lead_to_nothing() {
    let out = discover(&fixture("open-field"), "");
    let told = report(out.path());
    assert_described(&told);
    assert_eq!(told["verdict"], "nothing_missing");
    assert!(told["measurement"]["tracks"]["tracks"].as_u64() > Some(100));
    let reason = |id: &str| {
        let all = told["ranking"].as_array().unwrap();
        all.iter().find(|own| own["effect"] == id).unwrap()["reason"].as_str().unwrap().to_owned()
    };
    assert!(reason("persistence").contains("polarity"));
    assert!(reason("polarity").contains("no more than chance"));
    assert!(out.file("before_trajectories.npy").is_file());
}

#[test]
fn earlier_velocities_never_share_time_with_those_explained() {
    // Positions alone: forward differences of frames 0 to 3, of which frame 0 has no past.
    let data = fixture("open-field");
    let out = Folder::new();
    let line = "discover --effects persistence,alignment --difference forward --null-sets 0 --position-noise 1% --velocity-noise 60%";
    let outcome = succeed(line, &[("", &data), ("--out", out.path())]);
    let warned =
        |text: &str| assert!(outcome.stderr.contains(text), "\"{text}\" is not in {}", outcome.stderr);
    warned("frame 0 is left out: no cell has an earlier velocity");
    warned("forward differences");
    warned("spurious restoring force");
    let told = report(out.path());
    assert_described(&told);
    assert_eq!(told["cells"]["frames"], serde_json::json!([1, 2, 3]));
    let interval = told["predictors"]["interval"].as_str().unwrap();
    assert!(interval.contains("from frame t − 1 to frame t"), "{interval}");
    assert!(told["predictors"]["overlap"].as_str().unwrap().contains("share no time"));
    let residual: Array3<f64> = read(&out.file("after_residual_velocities.npy"));
    assert_eq!(residual.dim().0, 3);
    // Without effects that remember, every frame with a velocity is used.
    let flags = "--effects drift --difference forward --null-sets 0 --position-noise 1% --velocity-noise 60%";
    let out = discover(&data, flags);
    let told = report(out.path());
    assert_eq!(told["cells"]["frames"], serde_json::json!([0, 1, 2, 3]));
    assert!(told["predictors"].is_null());
    // Central differences overlap with those of the frame before: only frame 3 has one of frame 1.
    let flags =
        "--effects persistence --difference central --null-sets 0 --position-noise 1% --velocity-noise 60%";
    let told = report(discover(&data, flags).path());
    assert_eq!(told["cells"]["frames"], serde_json::json!([3]));
    assert!(told["predictors"]["interval"].as_str().unwrap().contains("frame t − 2"));
}

#[test]
fn coefficients_are_in_the_units_of_the_data() {
    // A cell of 20 µm and a time of 5 min instead of one of both.
    let (length, time) = (20.0, 5.0);
    let search = |data: &Path, flags: &str| {
        let noise = "--position-noise 1% --velocity-noise 5%";
        report(discover(data, &format!("--effects alpha_area --null-sets 0 {noise} {flags}")).path())
    };
    let plain = search(&fixture("undeclared/set-29"), "");
    let data = Folder::copy_of("undeclared/set-29");
    data.change("positions.npy", |r| *r *= length);
    data.change("velocities.npy", |v| *v *= length / time);
    let settings = fs::read_to_string(data.file("dataset.toml")).unwrap();
    let sides = settings.lines().find_map(|line| line.strip_prefix("box = [")?.strip_suffix(']')).unwrap();
    let sides: Vec<String> =
        sides.split(',').map(|side| (length * side.trim().parse::<f64>().unwrap()).to_string()).collect();
    let units = "--length-unit um --time-unit min";
    let scaled = search(data.path(), &format!("--box {} {units}", sides.join(" ")));
    assert_eq!(scaled["selected"][0]["coefficients"][0]["unit"], "µm⁻² min⁻¹");
    for pointer in ["/selected/0/coefficients/0/value", "/selected/0/ci95/0/0", "/selected/0/ci95/0/1"] {
        let ratio = number(&scaled, pointer) / number(&plain, pointer) * length * length * time;
        assert!((ratio - 1.0).abs() < 1e-3, "{pointer}: {ratio}");
    }
}
