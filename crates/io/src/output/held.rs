//! The output directories that this process holds.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Directories that this process holds, and whether it has decided on results of one.
static HELD: Mutex<Held> = Mutex::new(Held { claims: Vec::new(), decided: false });

pub(super) struct Held {
    pub(super) claims: Vec<(PathBuf, Origin)>,
    pub(super) decided: bool,
}

/// The table of what is held; it stays usable if a thread has died with it.
pub(super) fn held() -> MutexGuard<'static, Held> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Does what decides on results, and what comes after; no signal ends the process in between.
pub(super) fn deciding<T>(decide: impl FnOnce() -> T) -> T {
    let mut held = held();
    held.decided = true;
    decide()
}

/// Whether a directory was there, or was made for its results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    Found,
    Made,
}
