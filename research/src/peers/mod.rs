//! The program beside what else one might use on the same movies: the Python package StochasticForceInference 2, with our columns as its basis,
//! and plain least squares with cross-validation.

mod least_squares;
mod set;
mod table;

use crate::Outcome;
use crate::study::Program;
use clap::Args;
use serde_json::Value;
use set::{BASE, CANDIDATES, KINDS, Set};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use table::{Found, Method};

/// What to do where the rival is not installed.
const INSTALL: &str = "StochasticForceInference is not installed for this Python. To install it:\n\n  \
    python3 -m venv rival && rival/bin/pip install 'StochasticForceInference==2.0.4'\n  \
    cargo xtask peers --python rival/bin/python\n";

/// How the comparison is made.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Tissues of each kind; each is measured with nothing missing and with an effect.
    #[arg(long, default_value_t = 4)]
    seeds: u64,
    /// The Python that has the package StochasticForceInference.
    #[arg(long, value_name = "FILE", default_value = "python3")]
    python: PathBuf,
    /// Also by the estimator of the package that models errors of positions, which takes minutes for each set.
    #[arg(long)]
    parametric: bool,
    /// Folder for the sets, the fits and the table.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Compares all methods and prints tables.
pub fn run(root: &Path, arguments: &Arguments) -> Outcome {
    let folder = arguments.out.clone().unwrap_or_else(|| root.join("target/peers"));
    let script = root.join("research/src/peers/stochastic_force_inference.py");
    let has_rival = Command::new(&arguments.python).args(["-c", "import SFI"]).output();
    let has_rival = has_rival.is_ok_and(|output| output.status.success());
    if !has_rival {
        eprintln!("{INSTALL}");
    }
    let program = Program::new(None, &format!("--complete false --effects {}", CANDIDATES.join(",")))?;
    let names = set::names()?;
    let each = 2 * KINDS.len() as u64;
    let sets = (0..arguments.seeds * each)
        .map(|task| {
            let kind = KINDS[(task % each / 2) as usize];
            let (set, folder) = (Set::new(kind, task / each, task % 2 == 1)?, folder.join(task.to_string()));
            set.write(&folder)?;
            Ok((kind.name, set, folder))
        })
        .collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    if has_rival {
        let folders = sets.iter().map(|(_, _, folder)| folder);
        let status = Command::new(&arguments.python)
            .arg(script)
            .args(arguments.parametric.then_some("--parametric"))
            .args(folders)
            .status()?;
        if !status.success() {
            return Err("the script of the rival failed".into());
        }
    }
    let mut found = Vec::new();
    for (kind, set, folder) in &sets {
        let mut all = vec![ours(set, &names, &program, folder)?];
        let [before, after] = least_squares::fit(set, &names)?;
        all.push(Found::new(set, &names, Method::LeastSquares, Some([before, after]))?);
        if has_rival {
            all.extend(rival(set, &names, folder)?);
        }
        all.iter().for_each(|own| eprintln!("{kind} {}: {own}", folder.display()));
        found.extend(all.into_iter().map(|own| (*kind, own)));
    }
    table::print(&found);
    if !has_rival {
        println!("\nThe package StochasticForceInference was not run.");
    }
    Ok(())
}

/// What the program finds.
fn ours(set: &Set, names: &[&str], program: &Program, folder: &Path) -> Result<Found, Box<dyn Error>> {
    let run = program.run(&["discover"], folder, &folder.with_extension("found"))?;
    let Some(report) = run.report else { return Found::new(set, names, Method::Ours, None) };
    let mut all = [before_or_after(&report, "before", names)?, before_or_after(&report, "after", names)?];
    for effect in report["selected"].as_array().into_iter().flatten() {
        let places = (0..names.len()).filter(|k| effect["effect"] == names[*k]);
        let values = effect["coefficients"].as_array().into_iter().flatten();
        places.zip(values).for_each(|(k, own)| all[1][k] = own["value"].as_f64().unwrap_or(0.0));
    }
    Found::new(set, names, Method::Ours, Some(all))
}

/// The base model of a report as coefficients of all columns.
fn before_or_after(report: &Value, which: &str, names: &[&str]) -> Result<Vec<f64>, Box<dyn Error>> {
    let value = |name: &str| {
        report[which]["parameters"][name]["value"].as_f64().ok_or_else(|| format!("no {name} {which}"))
    };
    let base = [value("K_A")?, value("K_P")? * value("P_0")?, value("K_P")?, value("K_P_alpha")?];
    let mut all = vec![0.0; names.len()];
    all[..BASE.len()].copy_from_slice(&base);
    Ok(all)
}

/// What the rival finds, by both of its estimators.
fn rival(set: &Set, names: &[&str], folder: &Path) -> Result<Vec<Found>, Box<dyn Error>> {
    let found: Value = serde_json::from_slice(&std::fs::read(folder.join("rival.json"))?)?;
    let coefficients =
        |own: &Value| -> Option<Vec<f64>> { own.as_array()?.iter().map(Value::as_f64).collect() };
    let of = |(method, name): (Method, &str)| {
        let own = &found[name];
        let both = coefficients(&own["before"]).zip(coefficients(&own["after"]));
        Found::new(set, names, method, both.map(|(before, after)| [before, after]))
    };
    let tried = Method::OF_RIVAL.into_iter().filter(|(_, name)| found.get(*name).is_some());
    tried.map(of).collect()
}
