//! Variables of MATLAB files of version 5 and 7: numbers, texts, and cells of them.

use std::collections::BTreeMap;
use std::io::Read;

use flate2::read::ZlibDecoder;

/// How such files begin.
pub(crate) const SIGNATURE: &[u8] = b"MATLAB 5.0 MAT-file";

/// Bytes before the first variable.
const HEADER: usize = 128;
/// The most that a variable may decompress to.
const DECOMPRESSED_LIMIT: u64 = 1 << 30;

/// What an element of a file holds.
mod element {
    pub(super) const MATRIX: u32 = 14;
    pub(super) const COMPRESSED: u32 = 15;
}

/// Kinds of arrays.
mod class {
    pub(super) const CELL: u8 = 1;
    pub(super) const TEXT: u8 = 4;
    pub(super) const DOUBLE: u8 = 6;
    pub(super) const UNSIGNED_64: u8 = 15;
}

/// A variable.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Variable {
    /// Rows, columns and the numbers column by column; higher dimensions count as columns.
    Numbers {
        rows: usize,
        columns: usize,
        values: Vec<f64>,
    },
    Text(String),
    Cells(Vec<Variable>),
    /// Of another kind, such as a structure.
    Other,
}

/// Why a file cannot be read, in words.
type Fault = String;

/// All variables of a file by their names.
pub(crate) fn variables(bytes: &[u8]) -> Result<BTreeMap<String, Variable>, Fault> {
    let order = match bytes.get(HEADER - 2..HEADER) {
        Some(b"IM") => Order::Little,
        Some(b"MI") => Order::Big,
        _ => return Err("its header is cut or damaged".into()),
    };
    let mut rest = bytes.get(HEADER..).unwrap_or_default();
    let mut found = BTreeMap::new();
    while !rest.is_empty() {
        let (kind, body) = next(&mut rest, order)?;
        match kind {
            element::COMPRESSED => {
                let mut unpacked = Vec::new();
                let mut reader = ZlibDecoder::new(body).take(DECOMPRESSED_LIMIT + 1);
                reader.read_to_end(&mut unpacked).map_err(|error| error.to_string())?;
                if unpacked.len() as u64 > DECOMPRESSED_LIMIT {
                    return Err(format!("a variable decompresses to more than {DECOMPRESSED_LIMIT} bytes"));
                }
                let (_, body) = next(&mut unpacked.as_slice(), order)?;
                found.extend([array(body, order, Depth::Variable)?]);
            }
            element::MATRIX => found.extend([array(body, order, Depth::Variable)?]),
            _ => {}
        }
    }
    Ok(found)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Little,
    Big,
}

/// Cells within cells are not looked into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Depth {
    Variable,
    InCell,
}

impl Order {
    fn number<const N: usize>(self, bytes: &[u8]) -> Option<[u8; N]> {
        let mut own: [u8; N] = bytes.get(..N)?.try_into().ok()?;
        if self == Self::Big {
            own.reverse();
        }
        Some(own)
    }

    fn word(self, bytes: &[u8]) -> Result<u32, Fault> {
        self.number(bytes).map(u32::from_le_bytes).ok_or_else(cut)
    }
}

fn cut() -> Fault {
    "it ends in the middle of a variable".into()
}

/// The kind and the bytes of the next element.
fn next<'a>(rest: &mut &'a [u8], order: Order) -> Result<(u32, &'a [u8]), Fault> {
    let tag = order.word(rest)?;
    // Up to four bytes stand within the tag.
    let (kind, start, length) = match tag >> 16 {
        0 => (tag, 8_usize, order.word(rest.get(4..).unwrap_or_default())? as usize),
        length => (tag & 0xffff, 4, length as usize),
    };
    let end = start.checked_add(length).ok_or_else(cut)?;
    let body = rest.get(start..end).ok_or_else(cut)?;
    let padded = if kind == element::COMPRESSED { end } else { end.next_multiple_of(8) };
    *rest = rest.get(padded..).unwrap_or_default();
    Ok((kind, body))
}

/// The name and the content of an array.
fn array(mut body: &[u8], order: Order, depth: Depth) -> Result<(String, Variable), Fault> {
    if body.is_empty() {
        return Ok((String::new(), Variable::Numbers { rows: 0, columns: 0, values: Vec::new() }));
    }
    let (_, flags) = next(&mut body, order)?;
    let class = (order.word(flags)? & 0xff) as u8;
    let (_, lengths) = next(&mut body, order)?;
    let lengths: Vec<usize> =
        lengths.chunks_exact(4).map(|own| Ok(order.word(own)? as usize)).collect::<Result<_, Fault>>()?;
    let (_, name) = next(&mut body, order)?;
    let name = String::from_utf8_lossy(name).into_owned();
    let rows = lengths.first().copied().unwrap_or_default();
    let columns = lengths.iter().skip(1).try_fold(1_usize, |all, own| all.checked_mul(*own));
    let count = columns.and_then(|columns| columns.checked_mul(rows)).ok_or_else(cut)?;
    let columns = columns.unwrap_or_default();
    let content = match (class, depth) {
        (class::CELL, Depth::Variable) => {
            let mut cells = Vec::new();
            for _ in 0..count {
                let (_, own) = next(&mut body, order)?;
                cells.push(array(own, order, Depth::InCell)?.1);
            }
            Variable::Cells(cells)
        }
        (class::TEXT, _) => {
            let letters = numbers(next(&mut body, order)?, order)?;
            Variable::Text(letters.into_iter().filter_map(|letter| char::from_u32(letter as u32)).collect())
        }
        (class::DOUBLE..=class::UNSIGNED_64, _) => {
            let values = if count == 0 { Vec::new() } else { numbers(next(&mut body, order)?, order)? };
            if values.len() != count {
                return Err(format!("{name} has {} numbers, but room for {count}", values.len()));
            }
            Variable::Numbers { rows, columns, values }
        }
        _ => Variable::Other,
    };
    Ok((name, content))
}

/// The numbers of an element, whatever they are stored as.
fn numbers((kind, body): (u32, &[u8]), order: Order) -> Result<Vec<f64>, Fault> {
    macro_rules! all {
        ($number:ty) => {
            body.chunks_exact(size_of::<$number>())
                .filter_map(|own| order.number(own).map(<$number>::from_le_bytes))
                .map(|value| value as f64)
                .collect()
        };
    }
    Ok(match kind {
        1 => all!(i8),
        2 | 16 => all!(u8),
        3 => all!(i16),
        4 | 17 => all!(u16),
        5 => all!(i32),
        6 | 18 => all!(u32),
        7 => all!(f32),
        9 => all!(f64),
        12 => all!(i64),
        13 => all!(u64),
        other => return Err(format!("numbers of an unknown kind, {other}")),
    })
}
