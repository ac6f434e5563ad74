//! One set: made, given to the program as a user would, and compared with its truth.

use super::latent;
use super::program::{Program, Run};
use super::record::{Activity, Discovery, Estimate, Fit, Record};
use claims::measured::{Class, View, Written};
use serde_json::Value;
use std::error::Error;
use std::path::Path;

/// Makes a set in a folder and lets the program at it.
pub fn run(
    class: &Class,
    seed: u64,
    cells: Option<usize>,
    program: &Program,
    discover: bool,
    folder: &Path,
) -> Result<Record, Box<dyn Error>> {
    let set = class.measure(seed, cells)?;
    let present = set.positions.index_axis(ndarray::Axis(0), 0);
    let cells = present.rows().into_iter().filter(|row| row[0].is_finite()).count();
    let written = set.write(folder)?;
    let out = folder.join("infer");
    let command: &[&str] = if class.recipe.crawls { &["infer", "--active"] } else { &["infer"] };
    let Run { report, seconds, message } = program.run(command, &written.data, &out)?;
    let fit = match report {
        Some(report) => Some(fit(&report, &written, class.recipe.view, &out)?),
        None => None,
    };
    let discovery = if discover {
        let run = program.run(&["discover"], &written.data, &folder.join("discover"))?;
        Some(discovery(&run, written.truth.effect.as_deref()))
    } else {
        None
    };
    Ok(Record {
        class: class.name.into(),
        seed,
        program: program.hash.clone(),
        flags: program.flags.clone(),
        cells,
        seconds,
        fit,
        message,
        discovery,
    })
}

fn fit(report: &Value, written: &Written, view: View, out: &Path) -> Result<Fit, Box<dyn Error>> {
    let estimate = |of: &str, name: &str| -> Result<Estimate, Box<dyn Error>> {
        let found = &report[of][name];
        let value = found["value"].as_f64().unwrap_or(f64::NAN);
        let ci95 = [0, 1].map(|end| found["ci95"][end].as_f64());
        let truth = *written.truth.parameters.get(name).ok_or("a parameter without a truth")?;
        Ok(Estimate { truth, value, ci95 })
    };
    let doubts = report["fit"]["doubts"].as_array().into_iter().flatten();
    Ok(Fit {
        k_p_alpha: estimate("parameters", "K_P_alpha")?,
        p_0: estimate("parameters", "P_0")?,
        trustworthy: report["fit"]["trustworthy"].as_bool().ok_or("a report without `trustworthy`")?,
        doubts: doubts.map(|doubt| doubt.as_str().map_or_else(|| doubt.to_string(), String::from)).collect(),
        verdict: report["verdict"]["kind"].as_str().map(String::from),
        recall: latent::recovery(written, view, out)?,
        activity: match report["activity"].is_object() {
            true => Some(Activity { v_0: estimate("activity", "v_0")?, d_r: estimate("activity", "D_r")? }),
            false => None,
        },
    })
}

fn discovery(run: &Run, truth: Option<&str>) -> Discovery {
    let Some(report) = &run.report else {
        return Discovery {
            verdict: run.message.clone(),
            effects: Vec::new(),
            right: truth.map(|_| false),
            seconds: run.seconds,
        };
    };
    let selected: Vec<&Value> = report["selected"].as_array().into_iter().flatten().collect();
    let is_it = |own: &Value, truth: &str| {
        let class = own["class"].as_array().into_iter().flatten();
        class.chain([&own["effect"]]).any(|effect| effect.as_str() == Some(truth))
    };
    Discovery {
        verdict: report["verdict"].as_str().map_or_else(|| report["verdict"].to_string(), String::from),
        right: truth.map(|truth| matches!(selected.as_slice(), [only] if is_it(only, truth))),
        effects: selected.iter().filter_map(|own| own["effect"].as_str().map(String::from)).collect(),
        seconds: run.seconds,
    }
}
