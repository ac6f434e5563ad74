//! Jobs that the machine has no memory for are refused before any is taken.

use crate::failure::Failure;
use std::fmt::Display;
use voronudge_io::machine_memory;

/// Bytes for each cell: of a simulation; its frames are on the disk.
pub(crate) const OF_A_SIMULATED_CELL: usize = 1000;
/// For each cell whose moduli are measured: its strained states at one time.
pub(crate) const OF_A_STRAINED_CELL: usize = 3000;
/// For each cell of each frame that `evaluate` or `observe` looks at.
pub(crate) const OF_A_DESCRIBED_CELL: usize = 400;
/// For each cell of a frame whose modes are searched, of which some are wanted.
pub(crate) const OF_A_CELL_WITH_MODES: usize = 25_000;
/// For each cell of the largest frame that is fitted: its factors, and the patches in which contacts are tried.
const OF_A_FITTED_CELL: usize = 80_000;
/// For each cell of each frame that is fitted: its linearised problem.
const OF_A_LINEARISED_CELL: usize = 10_000;
/// For each cell of each frame that is followed in a movie.
const OF_A_FOLLOWED_CELL: usize = 150_000;

/// Refuses fits of frames with so many cells that the machine has no memory for.
pub(crate) fn refuse_fit_beyond(cells: &[usize], followed: bool) -> Result<(), Failure> {
    let (all, most) = (cells.iter().sum::<usize>(), cells.iter().max().copied().unwrap_or(0));
    let frames = if cells.len() == 1 { "1 frame".into() } else { format!("{} frames", cells.len()) };
    let what = format!("a fit of {all} cells in {frames}, {most} in the largest");
    match followed {
        true => refuse_beyond(what, all, OF_A_FOLLOWED_CELL),
        false => {
            let bytes = most.saturating_mul(OF_A_FITTED_CELL);
            refuse_beyond(what, 1, bytes.saturating_add(all.saturating_mul(OF_A_LINEARISED_CELL)))
        }
    }
}

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
