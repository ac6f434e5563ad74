//! What was understood of a file that does not say everything about itself.

use std::fmt;

/// How sure something is that was understood of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoteKind {
    /// The file says so.
    Read,
    /// The file does not say so; it is usually so.
    Guessed,
    /// Something does not fit and needs to be looked at.
    Doubtful,
}

/// Something that was understood of a file, for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// How sure it is.
    pub kind: NoteKind,
    /// What it is, in a few words.
    pub text: String,
}

impl Note {
    pub(crate) fn read(text: impl Into<String>) -> Self {
        Self { kind: NoteKind::Read, text: text.into() }
    }

    pub(crate) fn guessed(text: impl Into<String>) -> Self {
        Self { kind: NoteKind::Guessed, text: text.into() }
    }

    pub(crate) fn doubtful(text: impl Into<String>) -> Self {
        Self { kind: NoteKind::Doubtful, text: text.into() }
    }
}

impl fmt::Display for NoteKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Read => "read",
            Self::Guessed => "guessed",
            Self::Doubtful => "doubtful",
        })
    }
}
