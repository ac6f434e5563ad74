//! Jobs that the machine has no memory for are refused before any is taken.

use crate::failure::Failure;
use std::fmt::Display;
use voronudge_io::machine_memory;

/// Bytes for each cell: of a simulation; its frames are on the disk.
pub(crate) const OF_A_SIMULATED_CELL: usize = 1000;

/// Refuses what takes `count` times `bytes`, told as `what`, if the machine has less.
pub(crate) fn refuse_beyond(what: impl Display, count: usize, bytes: usize) -> Result<(), Failure> {
    let needed = count as f64 * bytes as f64;
    match machine_memory() {
        Some(memory) if needed > memory as f64 => {
            let [needed, memory] = [needed, memory as f64].map(|bytes| bytes / 1e9);
            Err(Failure::new(format!(
                "{what}: about {needed:.3e} GB of memory are needed, but the machine has {memory:.1} GB"
            ))
            .with_hint("ask for fewer, or use a machine with more memory"))
        }
        _ => Ok(()),
    }
}
