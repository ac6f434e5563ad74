//! The selection of frames that a user types.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, SelectionFault};

/// Frames as typed: `6`, `4..16`, `4,7,9`, `1,4..6`; zero-based, ends excluded.
///
/// A range may leave out its start or its end: `4..` runs to the last frame.
///
/// ```
/// use voronudge_io::FrameSelection;
/// let selection: FrameSelection = "1,4..6".parse()?;
/// assert_eq!(selection.resolve(10)?, [1, 4, 5]);
/// # Ok::<(), voronudge_io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameSelection {
    text: String,
    parts: Vec<Part>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    One(usize),
    Range { start: usize, end: Option<usize> },
}

impl FrameSelection {
    /// The frames selected out of `total`, ascending.
    ///
    /// # Errors
    /// [`Error::Selection`] for a frame that does not exist, a range without frames, and a frame
    /// named twice.
    pub fn resolve(&self, total: usize) -> Result<Vec<usize>, Error> {
        self.select(total).map_err(|fault| Error::Selection { text: self.text.clone(), fault })
    }

    fn select(&self, total: usize) -> Result<Vec<usize>, SelectionFault> {
        let mut chosen = vec![false; total];
        for part in &self.parts {
            let (start, end) = match *part {
                Part::One(frame) => (frame, frame.saturating_add(1)),
                Part::Range { start, end } => (start, end.unwrap_or(total)),
            };
            if start >= total || end > total {
                let frame = start.max(total);
                return Err(SelectionFault::OutOfRange { frame, total });
            }
            for (frame, taken) in chosen.iter_mut().enumerate().take(end).skip(start) {
                if std::mem::replace(taken, true) {
                    return Err(SelectionFault::Twice { frame });
                }
            }
        }
        let frames = chosen.iter().enumerate();
        Ok(frames.filter_map(|(frame, &taken)| taken.then_some(frame)).collect())
    }
}

impl FromStr for FrameSelection {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let parts: Result<Vec<Part>, SelectionFault> = text.split(',').map(parse_part).collect();
        match parts {
            Ok(parts) => Ok(Self { text: text.to_owned(), parts }),
            Err(fault) => Err(Error::Selection { text: text.to_owned(), fault }),
        }
    }
}

impl fmt::Display for FrameSelection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

fn parse_part(part: &str) -> Result<Part, SelectionFault> {
    let part = part.trim();
    if part.is_empty() {
        return Err(SelectionFault::Empty);
    }
    let number = |digits: &str| {
        let digits = digits.trim();
        // A bare parse would also take "+3".
        let plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        let parsed = if plain { digits.parse().ok() } else { None };
        parsed.ok_or_else(|| SelectionFault::NotANumber { part: part.to_owned() })
    };
    let Some((start, end)) = part.split_once("..") else {
        return number(part).map(Part::One);
    };
    let start = if start.trim().is_empty() { 0 } else { number(start)? };
    if end.trim().is_empty() {
        return Ok(Part::Range { start, end: None });
    }
    let end = number(end)?;
    if end <= start {
        return Err(SelectionFault::Reversed { start, end });
    }
    Ok(Part::Range { start, end: Some(end) })
}
