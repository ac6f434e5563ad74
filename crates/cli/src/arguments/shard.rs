//! A part of what many machines do.

use serde::{Deserialize, Serialize};

/// Part `part` of `of`, from one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Shard {
    pub part: usize,
    pub of: usize,
}

impl Shard {
    pub const WHOLE: Self = Self { part: 1, of: 1 };

    /// Whether a task, numbered from zero, is one of this part.
    pub fn has(self, index: usize) -> bool {
        index % self.of == self.part - 1
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "part {} of {}", self.part, self.of)
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((part, of)) if 1 <= part && part <= of => Ok(Self { part, of }),
            _ => Err("a shard is written 1/4, 2/4, 3/4 or 4/4".into()),
        }
    }
}
