//! The program that is tried, and a run of it on a data set.

use serde_json::Value;
use sha2::{Digest, Sha256};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

/// Digits of the hash of the program that are kept.
const DIGITS: usize = 12;

/// The program that is tried.
pub struct Program {
    path: PathBuf,
    /// First digits of its SHA-256.
    pub hash: String,
    /// Options of its commands.
    pub flags: String,
}

/// A run of the program.
pub struct Run {
    /// `report.json`; none if it wrote none.
    pub report: Option<Value>,
    pub seconds: f64,
    /// What it said on stderr.
    pub message: String,
}

impl Program {
    pub fn new(path: Option<PathBuf>, flags: &str) -> Result<Self, Box<dyn Error>> {
        let path = path.map_or_else(crate::program::path, Ok)?;
        let digest = Sha256::digest(std::fs::read(&path)?);
        let hash: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { path, hash: hash[..DIGITS].into(), flags: flags.into() })
    }

    /// Runs a command on a data set, on one thread.
    pub fn run(&self, command: &[&str], data: &Path, out: &Path) -> Result<Run, Box<dyn Error>> {
        let report = out.join("report.json");
        if out.exists() {
            std::fs::remove_dir_all(out)?;
        }
        let begun = Instant::now();
        let Output { stderr, status, .. } = Command::new(&self.path)
            .args(command)
            .arg(data)
            .args(self.flags.split_whitespace())
            .args(["--threads", "1", "--quiet", "--out"])
            .arg(out)
            .output()?;
        let seconds = begun.elapsed().as_secs_f64();
        let report =
            if report.is_file() { Some(serde_json::from_slice(&std::fs::read(report)?)?) } else { None };
        let message = String::from_utf8_lossy(&stderr).trim().replace('\n', " ");
        let message = if report.is_some() { message } else { format!("{status}: {message}") };
        // Pages are large, and made again by the same command.
        let page = out.join("report.html");
        if page.is_file() {
            std::fs::remove_file(page)?;
        }
        Ok(Run { report, seconds, message })
    }
}
