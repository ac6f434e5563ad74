//! How often the intervals of `rheology` contain what tissues of the true parameters do.

use super::measured::Program;
use super::scene::{Scene, View};
use super::seeds::{on_one_core_each, quartiles};
use crate::Outcome;
use serde_json::Value;
use std::error::Error;
use std::path::Path;
use std::process::Command;
use voronudge_model::{CellParameter, Parameters};

const NAMES: [&str; 4] = ["bulk", "odd_bulk", "shear", "odd_shear"];
const CELLS: &str = "64";

/// A tissue, how it is measured, and how moduli are.
struct Setting {
    name: &'static str,
    /// P_0 and α.
    truth: [f64; 2],
    /// Time after a random start: a solid is seen on its way to rest.
    time: f64,
    view: View,
    replicas: &'static str,
    /// Tissues of the true parameters.
    true_replicas: &'static str,
    protocol: &'static str,
}

const SETTINGS: [Setting; 4] =
    [Setting { view: View::Whole, ..SOLID }, SOLID, Setting { view: View::Whole, ..LIQUID }, LIQUID];
const SOLID: Setting = Setting {
    name: "solid",
    truth: [3.4, 0.3],
    time: 1.0,
    view: View::Window,
    replicas: "8",
    true_replicas: "200",
    protocol: "",
};
const LIQUID: Setting = Setting {
    name: "liquid",
    truth: [3.95, 1.0],
    time: 10.0,
    view: View::Window,
    replicas: "4",
    true_replicas: "40",
    protocol: "--time 1 --transient 5 --average 20",
};

impl Setting {
    fn parameters(&self) -> Parameters<f64> {
        let [preferred_perimeter, chirality] = self.truth;
        Parameters { preferred_perimeter, chirality, ..Parameters::default() }
    }

    /// B, A, μ, Kᵒ of tissues of the true parameters.
    fn moduli(&self, out: &Path) -> Result<[f64; 4], Box<dyn Error>> {
        let [perimeter, chirality] = self.truth.map(|value| value.to_string());
        let line = ["moduli", "--quiet", "--seed", "77", "--cells", CELLS, "--replicas", self.true_replicas];
        let status = Command::new(crate::program::path()?)
            .args(line)
            .args(["--P_0", &perimeter, "--alpha", &chirality])
            .args(self.protocol.split_whitespace())
            .arg("--out")
            .arg(out)
            .status()?;
        if !status.success() {
            return Err("the moduli of the true parameters cannot be measured".into());
        }
        let report: Value = serde_json::from_slice(&std::fs::read(out.join("report.json"))?)?;
        Ok(std::array::from_fn(|k| report["moduli"][k]["value"].as_f64().unwrap_or(f64::NAN)))
    }
}

/// A table with a row for each setting.
pub fn run(sets: u64, first: u64, only: &[String], out: &Path) -> Outcome {
    let fits = Program::new(None, "--fix K_A=0.1")?;
    println!(
        "| tissue | seen | fits that explain nothing | covered by the others: B | A | μ | Kᵒ | median error in half widths of the interval: B | A | μ | Kᵒ |\n|---|---|---|---|---|---|---|---|---|---|---|"
    );
    for (number, setting) in SETTINGS.iter().enumerate() {
        let name = format!("{}, {}", setting.name, setting.view.name());
        if !only.is_empty() && !only.iter().any(|part| name.contains(part.as_str())) {
            continue;
        }
        let truth = setting.moduli(&out.join(format!("truth-{}", setting.name)))?;
        let flags = format!("--cells {CELLS} --replicas {} {}", setting.replicas, setting.protocol);
        let programs = [&fits, &Program::new(None, &flags)?];
        let rows = on_one_core_each(sets, |set| {
            let seed = first + set;
            row(setting, programs, seed, &truth, &out.join(format!("{number}-{seed}")))
        })?;
        let told: Vec<Row> = rows.iter().copied().flatten().collect();
        print(setting, rows.len() - told.len(), &told);
    }
    Ok(())
}

/// What is found of each modulus.
type Row = [(bool, f64); 4];

/// Of each modulus whether its interval contains the truth, and how far from it the value is, in half widths of the interval; of a fit that explains
/// nothing there are none.
fn row(
    setting: &Setting,
    [fits, strains]: [&Program; 2],
    seed: u64,
    truth: &[f64; 4],
    folder: &Path,
) -> Result<Option<Row>, Box<dyn Error>> {
    let kinds = [(CellParameter::PreferredPerimeter, 0.0), (CellParameter::Chirality, 0.0)];
    let (data, fit) = (folder.join("data"), folder.join("infer"));
    Scene { parameters: setting.parameters(), kinds, time: setting.time, view: setting.view, seed }
        .write(&data)?;
    let run = fits.run(&["infer"], &data, &fit)?;
    if run.report.ok_or(run.message)?["verdict"]["kind"] == "explains_nothing" {
        return Ok(None);
    }
    let seed = seed.to_string();
    let run = strains.run(&["rheology", "--seed", &seed], &fit, &folder.join("rheology"))?;
    let report = run.report.ok_or(run.message)?;
    let moduli = report["fits"][0]["moduli"].as_array().ok_or("a report without moduli")?;
    let mut found = [(false, f64::NAN); 4];
    for (k, name) in NAMES.iter().enumerate() {
        let own = moduli.iter().find(|own| own["name"] == *name).ok_or("a modulus that is missing")?;
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let [low, high] = [0, 1].map(|end| number(&own["ci95"][end]));
        found[k] =
            ((low..=high).contains(&truth[k]), 2.0 * (number(&own["value"]) - truth[k]).abs() / (high - low));
    }
    Ok(Some(found))
}

fn print(setting: &Setting, refused: usize, rows: &[Row]) {
    let covered = |k: usize| format!("{} of {}", rows.iter().filter(|row| row[k].0).count(), rows.len());
    let error = |k: usize| format!("{:.2}", quartiles(rows.iter().map(|row| row[k].1).collect())[1]);
    let cells: Vec<String> = (0..4).map(covered).chain((0..4).map(error)).collect();
    let all = refused + rows.len();
    println!("| {} | {} | {refused} of {all} | {} |", setting.name, setting.view.name(), cells.join(" | "));
}
