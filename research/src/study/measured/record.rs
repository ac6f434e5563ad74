//! What came of each set, one line of JSON each.

use super::count::Count;
use super::program::Program;
use crate::Outcome;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::error::Error;
use std::fmt;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::ops::Range;
use std::path::Path;
use std::sync::Mutex;

/// What came of a set.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Record {
    pub class: String,
    pub seed: u64,
    /// SHA-256 of the program, and its options.
    pub program: String,
    pub flags: String,
    /// Detections in the first frame.
    pub cells: usize,
    /// Wall time of `infer`, on one thread.
    pub seconds: f64,
    /// `None` if `infer` gave no answer; then the message says why.
    pub fit: Option<Fit>,
    pub message: String,
    /// Only of searches for missing effects.
    pub discovery: Option<Discovery>,
}

/// What `infer` reports.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Fit {
    pub k_p_alpha: Estimate,
    pub p_0: Estimate,
    pub trustworthy: bool,
    pub doubts: Vec<String>,
    /// The kind of the verdict, where there is one.
    pub verdict: Option<String>,
    /// Hidden cells that were found, of those that could be; `None` if the program names none.
    pub recall: Option<Recovery>,
    /// Of cells that crawl.
    #[serde(default)]
    pub activity: Option<Activity>,
}

/// What `infer` reports of cells that crawl.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Activity {
    pub v_0: Estimate,
    pub d_r: Estimate,
}

/// An estimate and its truth.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Estimate {
    pub truth: f64,
    pub value: f64,
    /// An end that is none is not bounded by the data.
    pub ci95: [Option<f64>; 2],
}

/// Latent cells against hidden ones.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Recovery {
    /// Hidden cells, of a movie in each frame, and those found again.
    pub hidden: usize,
    pub found: usize,
    /// Latent cells, and those that are one of the hidden.
    pub latent: usize,
    pub right: usize,
}

/// What `discover` says.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Discovery {
    pub verdict: String,
    pub effects: Vec<String>,
    /// Of data in which something acts that the model lacks: whether that is named, or what cannot be told from it, and nothing else.
    #[serde(default)]
    pub right: Option<bool>,
    pub seconds: f64,
}

impl Estimate {
    /// Relative error.
    pub fn error(&self) -> f64 {
        self.value / self.truth - 1.0
    }

    pub fn covers(&self) -> bool {
        let [low, high] = self.ci95;
        low.is_none_or(|low| low <= self.truth) && high.is_none_or(|high| self.truth <= high)
    }

    /// Distance from the truth in standard errors: those of the half of the interval towards it.
    pub fn deviation(&self) -> f64 {
        let [low, high] = self.ci95;
        let towards = if self.truth < self.value { low } else { high };
        towards.map_or(0.0, |end| 1.96 * (self.truth - self.value).abs() / (end - self.value).abs())
    }
}

impl Fit {
    /// Whether a parameter is off by more than three standard errors.
    pub fn is_off(&self) -> bool {
        self.k_p_alpha.deviation() > 3.0 || self.p_0.deviation() > 3.0
    }
}

impl Recovery {
    pub fn recall(&self) -> Count {
        Count { hits: self.found, total: self.hidden }
    }

    pub fn precision(&self) -> Count {
        Count { hits: self.right, total: self.latent }
    }
}

impl fmt::Display for Record {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} {}: {:.1} s", self.class, self.seed, self.seconds)?;
        let Some(fit) = &self.fit else {
            return write!(out, ", {}", self.message);
        };
        let of_model = [("K_P α", &fit.k_p_alpha), ("P_0", &fit.p_0)];
        let of_activity = fit.activity.iter().flat_map(|own| [("v_0", &own.v_0), ("D_r", &own.d_r)]);
        for (name, estimate) in of_model.into_iter().chain(of_activity) {
            let (error, deviation) = (100.0 * estimate.error(), estimate.deviation());
            write!(out, ", {name} {error:+.1} % ({deviation:.1} s.e.)")?;
        }
        write!(out, ", {}", if fit.trustworthy { "trustworthy" } else { "not trustworthy" })?;
        if let Some(recovery) = &fit.recall {
            let Recovery { hidden, found, latent, right } = recovery;
            write!(out, ", {found} of {hidden} hidden cells found, {right} of {latent} latent cells right")?;
        }
        if let Some(Discovery { verdict, effects, right, seconds }) = &self.discovery {
            let right = right.map_or("", |right| if right { " (right)" } else { " (wrong)" });
            write!(out, ", {verdict} {}{right} in {seconds:.1} s", effects.join(" "))?;
        }
        Ok(())
    }
}

/// All records of a folder.
pub struct Records {
    state: Mutex<State>,
}

struct State {
    file: File,
    /// By class and seed, program and options; later ones replace earlier ones.
    records: BTreeMap<(String, u64, String, String), Record>,
}

impl Records {
    /// The records of a folder: an earlier study is gone on with if that is wanted.
    pub fn open(folder: &Path, resume: bool) -> Result<Self, Box<dyn Error>> {
        std::fs::create_dir_all(folder)?;
        let path = folder.join("records.jsonl");
        let text = if path.is_file() { std::fs::read_to_string(&path)? } else { String::new() };
        if !(resume || text.is_empty()) {
            return Err(format!("{} holds a study; go on with --resume", path.display()).into());
        }
        // A line that was cut off when a study was stopped is made again.
        let records = text.lines().filter_map(|line| serde_json::from_str::<Record>(line).ok());
        let records = records.map(|record| (record.key(), record)).collect();
        let mut file = OpenOptions::new().create(true).append(true).open(path)?;
        if !(text.is_empty() || text.ends_with('\n')) {
            writeln!(file)?;
        }
        Ok(Self { state: Mutex::new(State { file, records }) })
    }

    /// Whether a set has been tried with this program, and if wanted searched for effects.
    pub fn has(&self, class: &str, seed: u64, program: &Program, discover: bool) -> bool {
        let key = (class.to_owned(), seed, program.hash.clone(), program.flags.clone());
        let known =
            |state: &State| state.records.get(&key).is_some_and(|own| !discover || own.discovery.is_some());
        self.state.lock().is_ok_and(|state| known(&state))
    }

    /// Adds a record, on the disk too.
    pub fn add(&self, record: Record) -> Outcome {
        let line = serde_json::to_string(&record)?;
        let mut state = self.state.lock().map_err(|_| "a thread failed")?;
        writeln!(state.file, "{line}")?;
        state.records.insert(record.key(), record);
        Ok(())
    }

    /// Those of a class and of these seeds.
    pub fn of(&self, class: &str, seeds: Range<u64>, program: &Program) -> Vec<Record> {
        let is_wanted = |record: &&Record| {
            record.class == class
                && seeds.contains(&record.seed)
                && (&record.program, &record.flags) == (&program.hash, &program.flags)
        };
        let wanted = |state: &State| state.records.values().filter(is_wanted).cloned().collect();
        self.state.lock().map(|state| wanted(&state)).unwrap_or_default()
    }
}

impl Record {
    fn key(&self) -> (String, u64, String, String) {
        (self.class.clone(), self.seed, self.program.clone(), self.flags.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_take_the_half_towards_the_truth() {
        let estimate = Estimate { truth: 2.0, value: 1.0, ci95: [Some(0.5), Some(1.98)] };
        assert!((estimate.deviation() - 2.0).abs() < 1e-12);
        assert!(!estimate.covers() && (estimate.error() + 0.5).abs() < 1e-12);
        let open = Estimate { ci95: [Some(0.5), None], ..estimate };
        assert!(open.covers() && open.deviation() == 0.0);
    }
}
