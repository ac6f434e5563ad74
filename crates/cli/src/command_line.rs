//! The command line that runs, for all that tell of it.

use std::ffi::OsString;
use std::sync::OnceLock;

/// The words of the command line that runs, those of a file of --config among them.
static TYPED: OnceLock<Vec<String>> = OnceLock::new();

/// The words of the command line, the name of the program first.
pub(crate) fn typed() -> &'static [String] {
    TYPED.get().map_or(&[], Vec::as_slice)
}

/// Keeps the words of the command line that runs; what is not text is replaced.
pub(crate) fn keep(words: &[OsString]) {
    TYPED.get_or_init(|| words.iter().map(|word| word.to_string_lossy().into_owned()).collect());
}
