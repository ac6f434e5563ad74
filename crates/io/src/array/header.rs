//! The header of a `.npy` file: element type, order, shape.

use super::item::Item;
use crate::error::{FormatFault, excerpt};

const SIGNATURE: &[u8] = b"\x93NUMPY";

/// What a `.npy` file says about its elements, checked against the bytes that follow.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) item: Item,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<usize>,
}

impl Header {
    /// Splits a file into its header and exactly the bytes of the elements it claims.
    pub(super) fn parse(file: &[u8]) -> Result<(Self, &[u8]), FormatFault> {
        let (dictionary, body) = split(file)?;
        let header = Self::parse_dictionary(dictionary)?;
        header.check_length(body.len() as u64)?;
        Ok((header, body))
    }

    /// What is known of an array that has no header, checked against its bytes.
    pub(super) fn of(
        item: &str,
        shape: Vec<usize>,
        fortran_order: bool,
        body: &[u8],
    ) -> Result<Self, FormatFault> {
        let header = Self { item: Item::parse(item)?, fortran_order, shape };
        header.check_length(body.len() as u64)?;
        Ok(header)
    }

    /// Reads the Python dictionary, e.g. `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }`.
    fn parse_dictionary(text: &str) -> Result<Self, FormatFault> {
        let inner = text
            .trim()
            .strip_prefix('{')
            .and_then(|rest| rest.strip_suffix('}'))
            .ok_or_else(|| malformed("no dictionary in braces"))?;
        let (mut item, mut fortran_order, mut shape) = (None, None, None);
        for entry in split_entries(inner) {
            let (key, value) = entry
                .split_once(':')
                .ok_or_else(|| malformed(format!("\"{}\" has no colon", excerpt(entry))))?;
            let value = value.trim();
            match unquote(key.trim()) {
                Some("descr") => item = Some(Item::parse(unquote(value).unwrap_or(value))?),
                Some("fortran_order") => fortran_order = Some(parse_flag(value)?),
                Some("shape") => shape = Some(parse_shape(value)?),
                _ => return Err(malformed(format!("unknown entry \"{}\"", excerpt(key.trim())))),
            }
        }
        Ok(Self {
            item: item.ok_or_else(|| malformed("no entry 'descr'"))?,
            fortran_order: fortran_order.ok_or_else(|| malformed("no entry 'fortran_order'"))?,
            shape: shape.ok_or_else(|| malformed("no entry 'shape'"))?,
        })
    }

    fn check_length(&self, found: u64) -> Result<(), FormatFault> {
        let needed = self.length();
        match needed {
            Some(length) if length == found => Ok(()),
            Some(length) if length < found => {
                Err(FormatFault::Trailing { shape: self.shape.clone(), extra: found - length })
            }
            _ => Err(FormatFault::Truncated {
                shape: self.shape.clone(),
                item_type: self.item.name.clone(),
                needed,
                found,
            }),
        }
    }

    /// Bytes of all elements; `None` on overflow.
    fn length(&self) -> Option<u64> {
        if self.shape.contains(&0) {
            return Some(0);
        }
        self.shape.iter().try_fold(self.item.size as u64, |bytes, &length| bytes.checked_mul(length as u64))
    }
}

/// What follows the header of an array of Python objects.
pub(super) fn pickled(file: &[u8]) -> Option<&[u8]> {
    let (dictionary, body) = split(file).ok()?;
    let plain: String = dictionary.chars().filter(|letter| !letter.is_whitespace()).collect();
    plain.contains("'descr':'|O'").then_some(body)
}

/// Checks signature and version; returns the dictionary text and what follows the header.
fn split(file: &[u8]) -> Result<(&str, &[u8]), FormatFault> {
    if file.is_empty() {
        return Err(FormatFault::Empty);
    }
    let begin = &file[..file.len().min(SIGNATURE.len())];
    if !SIGNATURE.starts_with(begin) {
        let first = begin.to_vec();
        return Err(FormatFault::NotNpy { first });
    }
    let cut = |needed: usize| FormatFault::HeaderCut { needed: needed as u64, found: file.len() as u64 };
    let rest = file.get(6..).unwrap_or_default();
    // Version 1 gives the length of the dictionary in two bytes, the later ones in four.
    let (start, length) = match rest {
        [1, 0, a, b, ..] => (10, usize::from(u16::from_le_bytes([*a, *b]))),
        [2 | 3, 0, a, b, c, d, ..] => (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize),
        [1..=3, 0, ..] | [_] | [] => return Err(cut(12)),
        [major, minor, ..] => {
            let (major, minor) = (*major, *minor);
            return Err(FormatFault::UnknownVersion { major, minor });
        }
    };
    let end = start + length;
    let dictionary = file.get(start..end).ok_or_else(|| cut(end))?;
    let dictionary = std::str::from_utf8(dictionary).map_err(|_| malformed("not text"))?;
    Ok((dictionary, &file[end..]))
}

/// Splits at the commas that are in no quotation and no bracket; blank entries are dropped.
fn split_entries(text: &str) -> Vec<&str> {
    let (mut entries, mut start, mut depth) = (Vec::new(), 0, 0_i32);
    let mut quote: Option<char> = None;
    for (at, letter) in text.char_indices() {
        match (quote, letter) {
            (Some(open), _) if letter == open => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(letter),
            (None, '(' | '[' | '{') => depth += 1,
            (None, ')' | ']' | '}') => depth -= 1,
            (None, ',') if depth == 0 => {
                entries.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    entries.push(&text[start..]);
    entries.retain(|entry| !entry.trim().is_empty());
    entries
}

fn unquote(text: &str) -> Option<&str> {
    ['\'', '"'].into_iter().find_map(|quote| text.strip_prefix(quote)?.strip_suffix(quote))
}

fn parse_flag(text: &str) -> Result<bool, FormatFault> {
    match text {
        "True" => Ok(true),
        "False" => Ok(false),
        _ => Err(malformed(format!("fortran_order is {}", excerpt(text)))),
    }
}

fn parse_shape(text: &str) -> Result<Vec<usize>, FormatFault> {
    let bad = || malformed(format!("shape is {}", excerpt(text)));
    let inner = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).ok_or_else(bad)?;
    // Python 2 wrote long integers as 3L.
    split_entries(inner)
        .into_iter()
        .map(|length| {
            let digits = length.trim().trim_end_matches('L');
            digits.parse().map_err(|_| bad())
        })
        .collect()
}

fn malformed(detail: impl Into<String>) -> FormatFault {
    FormatFault::HeaderMalformed { detail: detail.into() }
}
