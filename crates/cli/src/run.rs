//! What every command does: threads, the record of the run, writing results.

use crate::arguments::{CommonArguments, Format, Verbosity};
use crate::failure::Failure;
use crate::progress::heed_signals;
use crate::terminal::{self, legible};
use std::time::Instant;
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_report::infer_report::{InputFile, RunRecord};

/// A command at work.
pub(crate) struct Run {
    name: &'static str,
    begun: Instant,
    seed: u64,
    pub format: Format,
    pub verbosity: Verbosity,
    pub warnings: Vec<String>,
    /// Whether the figures of the page are written as files, too.
    pub keeps_figures: bool,
}

/// More threads than any machine of use has cores.
const MOST_THREADS: usize = 1024;

impl Run {
    pub fn begin(name: &'static str, common: &CommonArguments) -> Result<Self, Failure> {
        heed_signals();
        if let Some(threads) = common.threads {
            if threads == 0 {
                return Err(Failure::new("--threads is 0, but at least one thread is needed")
                    .with_hint("leave --threads out to use all cores"));
            }
            if threads > MOST_THREADS {
                return Err(Failure::new(format!(
                    "--threads is {threads}, but at most {MOST_THREADS} are possible"
                ))
                .with_hint("leave --threads out to use all cores"));
            }
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build_global()
                .map_err(|error| Failure::new(format!("cannot start {threads} threads: {error}")))?;
        }
        Ok(Self {
            name,
            begun: Instant::now(),
            seed: common.seed,
            format: common.format,
            verbosity: common.verbosity(),
            warnings: Vec::new(),
            keeps_figures: common.figures,
        })
    }

    /// The seed of runs that were made before.
    pub fn seed_is(&mut self, seed: u64) {
        self.seed = seed;
    }

    pub fn seed(&self) -> u64 {
        self.seed
    }

    pub fn warn(&mut self, text: impl Into<String>) {
        let text = text.into();
        if self.verbosity == Verbosity::Normal {
            terminal::note(&format!("warning: {text}"));
        }
        self.warnings.push(text);
    }

    /// The record for the report.
    pub fn record(&self, inputs: Option<&DataSet>) -> RunRecord {
        RunRecord {
            command: self.name.into(),
            command_line: command_line(),
            version: env!("CARGO_PKG_VERSION").into(),
            seed: self.seed,
            threads: rayon::current_num_threads(),
            inputs: inputs
                .iter()
                .flat_map(|data| &data.inputs)
                .map(|input| InputFile {
                    path: input.path.display().to_string(),
                    sha256: input.sha256.clone(),
                })
                .collect(),
            wall_seconds: self.begun.elapsed().as_secs_f64(),
            warnings: self.warnings.clone(),
        }
    }

    /// Puts the results in place and prints the summary.
    pub fn finish(&self, out: Option<OutputDirectory>, json: &str, summary: &str) -> Result<(), Failure> {
        let place = out.as_ref().map(|out| out.path().to_owned());
        if let Some(out) = out {
            out.commit()?;
        }
        let printed = match (self.format, self.verbosity) {
            (Format::Json, _) => terminal::print(&format!("{json}\n")),
            (Format::Text, Verbosity::Normal) => terminal::print(&legible(summary)),
            (Format::Text, Verbosity::Quiet) => Ok(()),
        };
        printed.map_err(|error| {
            let failure = Failure::new(format!("stdout cannot be written: {error}"));
            match place {
                Some(out) => failure.with_hint(format!("the results are complete in {}", out.display())),
                None => failure,
            }
        })
    }
}

/// The command line as typed; what is not text is replaced.
fn command_line() -> String {
    crate::command_line::typed().join(" ")
}
