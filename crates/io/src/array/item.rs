//! Element types of `.npy` arrays and how their bytes become numbers.

use crate::error::{FormatFault, excerpt};

const REALS: &str = "float32, float64 or integers of up to 64 bits";
const INTEGERS: &str = "integers of up to 64 bits";

/// An element type that can be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Item {
    /// The type as the header names it, e.g. `<f8`.
    pub(super) name: String,
    kind: Kind,
    /// Bytes per element: 1, 2, 4 or 8.
    pub(super) size: usize,
    order: ByteOrder,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ByteOrder {
    Little,
    Big,
}

impl Item {
    /// Reads a type description such as `<f8`, `>i4` or `|u1`.
    pub(super) fn parse(name: &str) -> Result<Self, FormatFault> {
        let unsupported = || FormatFault::UnsupportedType { found: excerpt(name), needed: REALS };
        let mut letters = name.chars();
        let order = match letters.next() {
            Some('<' | '|') => ByteOrder::Little,
            Some('>') => ByteOrder::Big,
            _ => return Err(unsupported()),
        };
        let (kind, size) = match letters.as_str() {
            "f4" => (Kind::Float, 4),
            "f8" => (Kind::Float, 8),
            "i1" => (Kind::Signed, 1),
            "i2" => (Kind::Signed, 2),
            "i4" => (Kind::Signed, 4),
            "i8" => (Kind::Signed, 8),
            "u1" => (Kind::Unsigned, 1),
            "u2" => (Kind::Unsigned, 2),
            "u4" => (Kind::Unsigned, 4),
            "u8" => (Kind::Unsigned, 8),
            _ => return Err(unsupported()),
        };
        Ok(Self { name: name.to_owned(), kind, size, order })
    }

    /// The elements as f64. Integers beyond 2^53 are rounded.
    pub(super) fn reals(&self, bytes: &[u8]) -> Vec<f64> {
        let words = bytes.chunks_exact(self.size).map(|word| self.word(word));
        match (self.kind, self.size) {
            (Kind::Float, 4) => words.map(|word| f64::from(f32::from_bits(word as u32))).collect(),
            (Kind::Float, _) => words.map(f64::from_bits).collect(),
            (Kind::Signed, _) => words.map(|word| self.signed(word) as f64).collect(),
            (Kind::Unsigned, _) => words.map(|word| word as f64).collect(),
        }
    }

    /// The elements as i64.
    pub(super) fn integers(&self, bytes: &[u8]) -> Result<Vec<i64>, FormatFault> {
        let words = bytes.chunks_exact(self.size).map(|word| self.word(word));
        match self.kind {
            Kind::Float => Err(FormatFault::UnsupportedType { found: self.name.clone(), needed: INTEGERS }),
            Kind::Signed => Ok(words.map(|word| self.signed(word)).collect()),
            Kind::Unsigned => words
                .map(|value| i64::try_from(value).map_err(|_| FormatFault::IntegerTooLarge { value }))
                .collect(),
        }
    }

    /// The bits of one element, zero-extended.
    fn word(&self, bytes: &[u8]) -> u64 {
        let join = |word: u64, byte: &u8| (word << 8) | u64::from(*byte);
        match self.order {
            ByteOrder::Little => bytes.iter().rev().fold(0, join),
            ByteOrder::Big => bytes.iter().fold(0, join),
        }
    }

    /// Sign-extends the bits of one element.
    fn signed(&self, word: u64) -> i64 {
        let unused = 64 - 8 * self.size as u32;
        ((word << unused) as i64) >> unused
    }
}
