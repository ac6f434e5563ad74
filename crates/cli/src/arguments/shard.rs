//! A part of what many machines do.

use serde::{Deserialize, Serialize};

/// Part `part` of `of`, from one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Typed")]
pub(crate) struct Shard {
    pub part: usize,
    pub of: usize,
}

/// A part as it stands in a file.
#[derive(Deserialize)]
struct Typed {
    part: usize,
    of: usize,
}

impl TryFrom<Typed> for Shard {
    type Error = String;

    fn try_from(Typed { part, of }: Typed) -> Result<Self, String> {
        match 1 <= part && part <= of && of <= MOST_PARTS {
            true => Ok(Self { part, of }),
            false => Err(format!("a shard is written 1/4, 2/4, 3/4 or 4/4, of {MOST_PARTS} at most")),
        }
    }
}

/// Parts that nobody has machines for.
const MOST_PARTS: usize = 10_000;

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
        let (part, of) = parts.unwrap_or_default();
        Self::try_from(Typed { part, of })
    }
}
