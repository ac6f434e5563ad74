//! `moduli`: the honeycomb against the theory, its files, and what is refused.

use crate::program::{assert_described, succeed, voronudge};
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, number, report};
use std::fs;

#[test]
fn a_honeycomb_is_as_the_theory_says() {
    let out = Folder::new();
    let line =
        "moduli --start honeycomb --cells 36 --box 60 51.96152422706632 --K_A 0.01 --P_0 30 --alpha -0.4";
    succeed(line, &[("--out", out.path())]);
    assert_eq!(out.names(), ["report.html", "report.json"]);
    let report = report(out.path());
    assert_described(&report);
    for k in 0..4 {
        let at = |name: &str| number(&report, &format!("/moduli/{k}/{name}"));
        assert!((at("value") - at("mean_field")).abs() < 1e-5, "{k}: {} {}", at("value"), at("mean_field"));
    }
    for place in ["0/0", "0/1", "1/0", "1/1"] {
        let [found, expected] =
            ["prestress", "mean_field_prestress"].map(|name| number(&report, &format!("/{name}/{place}")));
        assert!((found - expected).abs() < 1e-9, "{place}: {found} {expected}");
    }
}

#[test]
fn replicas_are_averaged_and_viscosities_measured() {
    let out = Folder::new();
    let line = "moduli --cells 16 --P_0 4 --alpha 1 --replicas 2 --time 2 --transient 0.5 --average 2 --viscosity --period 4 --rate 0.05 \
                --periods 1 --dt 0.02 --quiet";
    let text = succeed(line, &[("--out", out.path())]).stdout;
    assert_eq!(text, "");
    let report = report(out.path());
    assert_described(&report);
    assert_eq!(report["replicas"][1]["motion"], "flowing");
    let viscosity = &report["viscosities"][1];
    assert_eq!(viscosity["name"], "odd_shear_viscosity");
    let each: Vec<f64> =
        viscosity["replicas"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    assert!((viscosity["value"].as_f64().unwrap() - 0.5 * (each[0] + each[1])).abs() < 1e-12);
}

/// A repeat with the next seed is another measurement, and one run alone is the first of many.
#[test]
fn replicas_of_neighbouring_seeds_share_nothing() {
    let of = |line: &str| {
        let out = Folder::new();
        succeed(&format!("moduli --cells 16 --P_0 3 --time 20 {line} --quiet"), &[("--out", out.path())]);
        let report = report(out.path());
        let seeds = report["replicas"].as_array().unwrap().iter().map(|own| own["seed"].as_u64().unwrap());
        let moduli = report["moduli"][0]["replicas"].as_array().unwrap().iter();
        seeds.zip(moduli.map(|own| own.as_f64().unwrap())).collect::<Vec<_>>()
    };
    let runs = [1, 2, 3].map(|seed| of(&format!("--replicas 3 --seed {seed}")));
    for (k, run) in runs.iter().enumerate() {
        for (seed, value) in runs[k + 1..].iter().flatten() {
            assert!(run.iter().all(|own| own.0 != *seed && own.1 != *value), "{runs:?}");
        }
    }
    assert_eq!(of("--seed 2"), runs[1][..1]);
}

#[test]
fn results_do_not_depend_on_threads() {
    let of = |threads: &str| {
        let out = Folder::new();
        let line = format!("moduli --cells 20 --P_0 3.2 --alpha 0.5 --time 100 --threads {threads} --quiet");
        succeed(&line, &[("--out", out.path())]);
        report(out.path())["moduli"].clone()
    };
    assert_eq!(of("1"), of("3"));
}

#[test]
fn impossible_requests_are_refused() {
    let refuse = |line: &str, fact: &str| assert_arguments_refused(line.split_whitespace(), &[fact]);
    refuse("moduli --strain 0", "strain is 0");
    refuse("moduli --replicas 0", "--replicas is 0");
    refuse("moduli --start honeycomb --replicas 3", "--replicas 3");
    refuse("moduli --time -1", "--time is -1");
    refuse("moduli --average nan", "--average is NaN");
    refuse(
        "moduli --cells 16 --time 0.1 --average 0.1 --transient 0 --viscosity --rate -1",
        "shear rate is -1",
    );
    refuse(
        "moduli --cells 16 --time 0.1 --average 0.1 --transient 0 --frequencies 0",
        "angular frequency is 0",
    );
    assert_eq!(voronudge(["moduli"]).code, Some(2));
}

/// Slow shear of a solid finds its moduli at rest; two tissues that flow have shear moduli alone, and the nearest media are told.
#[test]
fn storage_and_loss_moduli_are_measured_at_rest_and_flowing() {
    let out = Folder::new();
    let line = "moduli --cells 16 --P_0 3 --alpha 0.5 --frequencies 1e-5 1 1e6 --seed 2";
    let text = succeed(line, &[("--out", out.path())]).stdout;
    assert!(text.contains("kelvin–voigt") && text.contains("μ″"), "{text}");
    let solid = report(out.path());
    assert_described(&solid);
    for k in 0..4 {
        for (frequency, limit) in [(0, "value"), (2, "affine")] {
            let at = format!("/dynamic/{frequency}/moduli/{k}");
            let storage = number(&solid, &format!("{at}/storage/value"));
            let expected = number(&solid, &format!("/moduli/{k}/{limit}"));
            assert!((storage - expected).abs() < 1e-4, "{k} {limit}: {storage} {expected}");
            assert!(number(&solid, &format!("{at}/loss/value")).abs() < 1e-3, "{k} {limit}");
        }
    }
    let page = fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("Storage and loss moduli") && page.contains("Maxwell (in series)"));

    let out = Folder::new();
    let line = "moduli --cells 16 --P_0 4 --alpha 1 --replicas 2 --time 2 --transient 0.5 --average 2 --frequencies 10 --dt 0.02 --quiet";
    succeed(line, &[("--out", out.path())]);
    let liquid = report(out.path());
    assert_described(&liquid);
    let moduli = liquid["dynamic"][0]["moduli"].as_array().unwrap();
    let names: Vec<_> = moduli.iter().map(|own| own["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["shear", "odd_shear"]);
    assert_eq!(moduli[0]["loss"]["replicas"].as_array().unwrap().len(), 2);
    assert_eq!(liquid["media"], serde_json::json!([]));
}
