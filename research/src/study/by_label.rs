//! Kinds of cells told by labels: whether parameters and differences are covered, and what is named where all cells are alike.

use super::measured::Program;
use super::scene::{Scene, View};
use super::seeds::{on_one_core_each, quartiles};
use crate::Outcome;
use serde_json::Value;
use std::error::Error;
use std::path::Path;
use voronudge_model::{CellParameter, Parameters};

const NAMES: [&str; 2] = ["P_0", "alpha"];
/// Mean parameters, and how far two kinds of cells are from them.
const TRUTH: Parameters<f64> = Parameters {
    area_elasticity: 0.1,
    perimeter_elasticity: 1.0,
    preferred_perimeter: 3.9,
    preferred_area: 1.0,
    chirality: 1.0,
};
const SETTINGS: [(&str, [f64; 2]); 2] = [("all alike", [0.0, 0.0]), ("P_0 ± 1 %, α ± 30 %", [0.01, 0.3])];
const TIME: f64 = 10.0;

/// What a fit says of one set.
struct Row {
    differs: bool,
    /// Of P_0 and α: of both kinds, and of the difference: whether the interval contains the truth, and the error relative to the mean.
    found: [[(bool, f64); 3]; 2],
}

/// A table with a row for each way of seeing and each difference.
pub fn run(sets: u64, first: u64, only: &[String], out: &Path) -> Outcome {
    let program = Program::new(None, "--fix K_A=0.1 --by-label P_0,alpha")?;
    println!(
        "| seen | kinds | named different | covered: P_0 of both kinds, of the difference | α of both kinds, of the difference | median error of the difference (% of the mean): P_0, α |"
    );
    println!("|---|---|---|---|---|---|");
    for view in [View::Whole, View::Window, View::Tracks] {
        for (number, (name, shares)) in SETTINGS.iter().enumerate() {
            let setting = format!("{}, {name}", view.name());
            if !only.is_empty() && !only.iter().any(|part| setting.contains(part.as_str())) {
                continue;
            }
            let rows = on_one_core_each(sets, |set| {
                let seed = first + set;
                let folder = out.join(format!("{number}-{}-{seed}", view as u8));
                row(&program, (view, *shares), seed, &folder)
            })?;
            print(view, name, &rows);
        }
    }
    Ok(())
}

fn row(
    program: &Program,
    (view, shares): (View, [f64; 2]),
    seed: u64,
    folder: &Path,
) -> Result<Row, Box<dyn Error>> {
    let kinds = [(CellParameter::PreferredPerimeter, shares[0]), (CellParameter::Chirality, shares[1])];
    let data = folder.join("data");
    Scene { parameters: TRUTH, kinds, time: TIME, view, seed }.write(&data)?;
    let run = program.run(&["infer"], &data, &folder.join("infer"))?;
    let report = run.report.ok_or(run.message)?;
    let all = report["by_label"].as_array().ok_or("a report without labels")?;
    let of = |reference: bool| all.iter().find(|kind| kind["is_reference"] == reference).ok_or("two kinds");
    let (reference, other) = (of(true)?, of(false)?);
    let side = |kind: &Value| if kind["label"] == 1 { 1.0 } else { -1.0 };
    let mut found = [[(false, f64::NAN); 3]; 2];
    for (k, (name, mean)) in NAMES.into_iter().zip([TRUTH.preferred_perimeter, TRUTH.chirality]).enumerate() {
        let truth = |kind: &Value| mean * (1.0 + shares[k] * side(kind));
        let values = [
            (&reference["parameters"][name], truth(reference)),
            (&other["parameters"][name], truth(other)),
            (&other["differences"][name], truth(other) - truth(reference)),
        ];
        found[k] = values.map(|(own, truth)| {
            let end = |which: usize| own["ci95"][which].as_f64();
            let covers = end(0).is_none_or(|low| low <= truth) && end(1).is_none_or(|high| truth <= high);
            (covers, (own["value"].as_f64().unwrap_or(f64::NAN) - truth) / mean)
        });
    }
    Ok(Row { differs: other["differs"] == true, found })
}

fn print(view: View, name: &str, rows: &[Row]) {
    let count = rows.len();
    let covered = |k: usize| {
        let of = |which: usize| rows.iter().filter(|row| row.found[k][which].0).count();
        format!("{} and {}, {} of {count}", of(0), of(1), of(2))
    };
    let error = |k: usize| {
        let [_, median, _] = quartiles(rows.iter().map(|row| 100.0 * row.found[k][2].1.abs()).collect());
        median
    };
    let differ = rows.iter().filter(|row| row.differs).count();
    println!(
        "| {} | {name} | {differ} of {count} | {} | {} | {:.2}, {:.1} |",
        view.name(),
        covered(0),
        covered(1),
        error(0),
        error(1)
    );
}
