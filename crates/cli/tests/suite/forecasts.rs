//! `discover --forecast` and `--check`: what the models make of cells.

use crate::program::{assert_described, succeed};
use crate::refusal::assert_refused;
use crate::scratch::{Folder, report};
use serde_json::{Value, json};
use std::fs;

/// A simulated tissue of 100 cells.
fn tissue(flags: &str) -> Folder {
    let data = Folder::new();
    let line = format!("simulate --cells 100 --P_0 3.9 --K_A 0 --alpha 1 --seed 3 {flags}");
    succeed(&line, &[("--out", data.path())]);
    data
}

fn values(forecast: &Value, list: &str) -> Vec<f64> {
    let all = forecast.pointer(list).and_then(Value::as_array).unwrap();
    all.iter().map(|own| own["value"].as_f64().unwrap()).collect()
}

/// Frames after those of the fit are told by the polarities that cells had before, better than by forces alone and by baselines.
#[test]
#[ignore = "slow"]
fn cells_that_crawl_are_forecast() {
    let data =
        tissue("--time 0.55 --frames 12 --self-propulsion 0.6 --rotational-diffusion 0.3 --start random");
    fs::remove_file(data.file("velocities.npy")).unwrap();
    let out = Folder::new();
    let line = "discover --frames 2..7 --fix K_A=0 --effects polarity,drift --forecast 3 --check 39 --seed 4";
    succeed(line, &[("", data.path()), ("--out", out.path())]);
    let told = report(out.path());
    assert_described(&told);
    assert_eq!(told["selected"][0]["effect"], "polarity");
    let forecast = &told["forecast"];
    assert_eq!(forecast["starts"], json!([7, 8, 9, 10]));
    assert_eq!(forecast["horizons"], json!([1, 2, 3]));
    assert_eq!(forecast["scored"], json!([400, 300, 200]));
    let [base, extended, constant] =
        ["base", "extended", "constant_velocity"].map(|who| values(forecast, &format!("/skill/{who}")));
    for h in 0..3 {
        assert!(extended[h] > 0.9 && extended[h] > base[h] && extended[h] > constant[h], "{forecast}");
    }
    assert!(
        values(forecast, "/gain")
            .iter()
            .zip(&base)
            .zip(&extended)
            .all(|((gain, base), own)| { (gain - (own - base)).abs() < 1e-9 })
    );
    let check = &told["check"];
    assert_eq!((&check["frames"], &check["draws"]), (&json!([4, 5, 6, 7, 8, 9, 10, 11]), &json!(39)));
    let [base, extended] = ["base", "extended"].map(|own| check["p"][own].as_f64().unwrap());
    assert!(base < 0.05 && extended > 0.1, "{base} {extended}");
    assert!(check["quantities"].as_array().unwrap().len() > 10);
    let page = fs::read_to_string(out.file("report.html")).unwrap();
    assert!(page.contains("What the models make of the cells"));
    assert!(page.contains("What the cells do next") && page.contains("best possible"));
}

/// With velocities, the first half of the frames is fitted if nothing else is said.
#[test]
fn a_tissue_without_noise_goes_on_as_the_model_says() {
    let data = tissue("--time 0.7 --frames 8 --start random");
    let out = Folder::new();
    succeed(
        "discover --fix K_A=0 --effects drift --forecast 2 --null-sets 0",
        &[("", data.path()), ("--out", out.path())],
    );
    let told = report(out.path());
    assert_described(&told);
    assert_eq!(told["cells"]["frames"], json!([0, 1, 2, 3]));
    let forecast = &told["forecast"];
    assert_eq!((&forecast["starts"], &forecast["skill"]["extended"]), (&json!([4, 5, 6]), &Value::Null));
    assert!(values(forecast, "/skill/base").iter().all(|skill| *skill > 0.98), "{forecast}");
}

#[test]
fn nothing_is_forecast_that_the_fit_has_seen() {
    let data = tissue("--time 0.3 --frames 4 --start random");
    assert_refused(
        "discover",
        data.path(),
        &["--frames", "0..4", "--forecast", "1"],
        &["--forecast", "0 of the frames come after those of the fit"],
    );
}
