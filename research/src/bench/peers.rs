//! Other programs at the same numbers of points, where a Python has them.

use crate::Outcome;
use std::path::Path;
use std::process::Command;

pub fn run(python: &Path, cells: &[usize]) -> Outcome {
    let cells: Vec<String> = cells.iter().map(usize::to_string).collect();
    // The table goes on where ours ends. One thread, as ours in the first rows.
    let status = Command::new(python)
        .args(["-c", include_str!("peers.py")])
        .args(cells)
        .envs([("OMP_NUM_THREADS", "1"), ("RAYON_NUM_THREADS", "1")])
        .status()?;
    if status.success() { Ok(()) } else { Err("the script that times other programs failed".into()) }
}
