//! The one error type of this crate: where it happened, what was found, and separately a hint.

mod arrays;
mod files;
mod grids;
mod images;
mod settings;
mod tables;

use std::fmt;
use std::path::{Path, PathBuf};

use crate::difference::Difference;

pub use arrays::{FormatFault, ShapeFault, ValueFault};
pub use files::{FileFault, OutputFault};
pub use grids::GridFault;
pub use images::ImageFault;
pub use settings::{SelectionFault, SettingFault, TomlFault};
pub use tables::TableFault;

/// Anything that can go wrong between a path and a checked value.
///
/// The message (`Display`) states facts: file, place, numbers. Advice is in [`Error::hint`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An input file cannot be read at all.
    #[error("{}: {fault}", path.display())]
    File {
        /// The file as given.
        path: PathBuf,
        /// What is wrong with it.
        fault: FileFault,
    },
    /// A file is not the `.npy` array it should be.
    #[error("{}: {fault}", path.display())]
    Format {
        /// The file as given.
        path: PathBuf,
        /// What is wrong with it.
        fault: FormatFault,
    },
    /// An array has the wrong shape.
    #[error("{}: {fault}", path.display())]
    Shape {
        /// The file as given.
        path: PathBuf,
        /// What is wrong with it.
        fault: ShapeFault,
    },
    /// An array holds a value that cannot be meant.
    #[error("{}: {fault}", path.display())]
    Value {
        /// The file as given.
        path: PathBuf,
        /// What is wrong with it.
        fault: ValueFault,
    },
    /// A flow field or its grid cannot be used.
    #[error("{}: {fault}", path.display())]
    Grid {
        /// The file as given.
        path: PathBuf,
        /// What is wrong with it.
        fault: GridFault,
    },
    /// An image, its labels or its outlines cannot be used.
    #[error("{}: {fault}", path.display())]
    Image {
        /// The file as given.
        path: PathBuf,
        /// What is wrong with it.
        fault: ImageFault,
    },
    /// A `dataset.toml` is malformed or says something impossible.
    #[error("{}: {fault}", Place(path, *line))]
    Toml {
        /// The file as given.
        path: PathBuf,
        /// Line, counted from 1, where one can be named.
        line: Option<u64>,
        /// What is wrong with it.
        fault: TomlFault,
    },
    /// A setting given outside a file (a flag, a field of a request) is missing or impossible.
    #[error("{0}")]
    Setting(SettingFault),
    /// A table of tracks or of vectors is malformed.
    #[error("{}: {fault}", Place(path, *line))]
    Table {
        /// The file as given.
        path: PathBuf,
        /// Line, counted from 1, where one can be named.
        line: Option<u64>,
        /// What is wrong with it.
        fault: TableFault,
    },
    /// A frame selection cannot be read or does not fit the data.
    #[error("frames \"{text}\": {fault}")]
    Selection {
        /// The selection as typed.
        text: String,
        /// What is wrong with it.
        fault: SelectionFault,
    },
    /// Velocities need more frames than there are.
    #[error("{difference} differences need {needed} frames, the data set has {found}")]
    TooFewFrames {
        /// The kind of difference asked for.
        difference: Difference,
        /// Frames needed.
        needed: usize,
        /// Frames present.
        found: usize,
    },
    /// A result cannot be written.
    #[error("{}: {fault}", path.display())]
    Output {
        /// The file or directory.
        path: PathBuf,
        /// What is wrong with it.
        fault: OutputFault,
    },
}

impl Error {
    /// What the user can do about it, if something can be said.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::File { fault, .. } => fault.hint(),
            Self::Format { fault, .. } => fault.hint(),
            Self::Shape { fault, .. } => fault.hint(),
            Self::Value { fault, .. } => fault.hint(),
            Self::Grid { fault, .. } => fault.hint(),
            Self::Image { fault, .. } => fault.hint(),
            Self::Toml { fault, .. } => fault.hint(),
            Self::Setting(fault) => fault.hint(),
            Self::Table { fault, .. } => fault.hint(),
            Self::Selection { fault, .. } => fault.hint(),
            Self::TooFewFrames { .. } => {
                Some("give measured velocities with --velocities, or a longer movie".into())
            }
            Self::Output { fault, .. } => fault.hint(),
        }
    }
}

/// An image that cannot be used.
pub(crate) fn image_error(path: &Path, fault: ImageFault) -> Error {
    Error::Image { path: path.to_path_buf(), fault }
}

/// A table that cannot be used, at no line in particular.
pub(crate) fn table_error(path: &Path, fault: TableFault) -> Error {
    Error::Table { path: path.to_path_buf(), line: None, fault }
}

/// A file and, where known, a line in it.
struct Place<'a>(&'a Path, Option<u64>);

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0.display())?;
        match self.1 {
            Some(line) => write!(f, ", line {line}"),
            None => Ok(()),
        }
    }
}

/// An array shape the way numpy prints it: `(3, 4)`, `(5,)`, `()`.
struct ShapeText<'a>(&'a [usize]);

impl fmt::Display for ShapeText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lengths: Vec<String> = self.0.iter().map(usize::to_string).collect();
        let comma = if lengths.len() == 1 { "," } else { "" };
        write!(f, "({}{comma})", lengths.join(", "))
    }
}

/// The begin of what a file says, in one line: a stray quotation mark may make a field of half a table.
pub(crate) fn excerpt(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut letters = text.chars().map(|letter| if letter.is_control() { ' ' } else { letter });
    let begin: String = letters.by_ref().take(LONGEST).collect();
    if letters.next().is_some() { begin + "…" } else { begin }
}
