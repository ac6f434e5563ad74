//! Reading the spots or the vectors of a table, compressed or not.

mod columns;
mod profile;
mod vectors;

use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

use csv::ByteRecord;
use flate2::read::MultiGzDecoder;

use crate::error::{Error, TableFault};
pub use columns::ColumnNames;
use columns::Columns;
pub(crate) use columns::{Layout, Spot};
pub use profile::{FlowProfile, read_flow_profile};
pub use vectors::FlowColumnNames;
pub(crate) use vectors::{Vector, VectorTable, read_table};

/// The most that a compressed table may grow to: far above any real one, far below what would
/// exhaust a machine.
const DECOMPRESSED_LIMIT: u64 = 1 << 30;
/// The most rows of a table.
const ROW_LIMIT: usize = 20_000_000;

/// Rows that TrackMate may put between the header and the first spot.
const EXTRA_HEADER_ROWS: usize = 3;

/// The spots of a table, in the order of its rows; at least one.
#[derive(Debug)]
pub(crate) struct SpotTable {
    pub(crate) spots: Vec<Spot>,
    /// Spots without a track.
    pub(crate) untracked: usize,
    /// The unit of length that TrackMate's extra header rows name.
    pub(crate) length_unit: Option<String>,
}

/// Reads a table; `path` only names the place.
pub(crate) fn read_spots(
    path: &Path,
    bytes: &[u8],
    layout: Layout,
    names: &ColumnNames,
) -> Result<SpotTable, Error> {
    let failure = |line, fault| Error::Table { path: path.to_path_buf(), line, fault };
    let text = decompress(bytes).map_err(|fault| failure(None, fault))?;
    parse(&text, layout, names).map_err(|(offset, fault)| {
        let line = offset.map(|offset| line_number(&text, offset));
        failure(line, fault)
    })
}

/// A fault and the byte offset of the row it is in.
type Located = (Option<u64>, TableFault);

fn parse(text: &[u8], layout: Layout, names: &ColumnNames) -> Result<SpotTable, Located> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).delimiter(delimiter(text)).from_reader(text);
    let mut rows = reader.byte_records();
    let header = match rows.next() {
        Some(row) => row.map_err(csv_fault)?,
        None => return Err((None, TableFault::Empty)),
    };
    if header.iter().all(|field| field.trim_ascii().is_empty()) {
        return Err((None, TableFault::Empty));
    }
    let columns = Columns::find(&header, layout, names).map_err(|fault| (offset_of(&header), fault))?;

    let mut table = SpotTable { spots: Vec::new(), untracked: 0, length_unit: None };
    let mut extra_rows = match layout {
        Layout::TrackMate => EXTRA_HEADER_ROWS,
        Layout::Tracks | Layout::Outlines => 0,
    };
    for row in rows {
        let row = row.map_err(csv_fault)?;
        if extra_rows > 0 && columns.all_texts(&row) {
            extra_rows -= 1;
            table.length_unit = bracketed(&columns.length_unit_text(&row)).or(table.length_unit);
            continue;
        }
        extra_rows = 0;
        match columns.spot(&row) {
            Ok(Some(_)) if table.spots.len() == ROW_LIMIT => {
                return Err((offset_of(&row), TableFault::TooManyRows { limit: ROW_LIMIT }));
            }
            Ok(Some(spot)) => table.spots.push(spot),
            Ok(None) => table.untracked += 1,
            Err(fault) => return Err((offset_of(&row), fault)),
        }
    }
    match (table.spots.len(), table.untracked) {
        (0, 0) => Err((None, TableFault::NoRows)),
        (0, spots) => {
            let column = columns.track_name();
            Err((None, TableFault::NoTracks { spots, column }))
        }
        _ => Ok(table),
    }
}

/// How files of other kinds begin.
const OTHER_KINDS: [(&[u8], &str); 11] = [
    (b"PAR1", "a Parquet file"),
    (b"{", "JSON"),
    (b"[{", "JSON"),
    (b"[[", "JSON"),
    (b"<", "XML or HTML"),
    (b"PK\x03\x04", "a zip archive or a spreadsheet"),
    (b"\x89HDF", "an HDF5 file"),
    (b"\x93NUMPY", "a .npy array"),
    (b"II*\0", "a TIFF image"),
    (b"MM\0*", "a TIFF image"),
    (b"\x89PNG", "a PNG image"),
];

/// The text of a table, decompressed if it begins like gzip, whatever its name.
fn decompress(bytes: &[u8]) -> Result<Cow<'_, [u8]>, TableFault> {
    let text = decompressed(bytes)?;
    let begin = text.trim_ascii_start();
    match OTHER_KINDS.iter().find(|(first, _)| begin.starts_with(first)) {
        Some((_, kind)) => Err(TableFault::AnotherKind { kind }),
        None => Ok(text),
    }
}

fn decompressed(bytes: &[u8]) -> Result<Cow<'_, [u8]>, TableFault> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut text = Vec::new();
    MultiGzDecoder::new(bytes)
        .take(DECOMPRESSED_LIMIT + 1)
        .read_to_end(&mut text)
        .map_err(|source| TableFault::Gzip(source.to_string()))?;
    if text.len() as u64 > DECOMPRESSED_LIMIT {
        let limit = DECOMPRESSED_LIMIT;
        return Err(TableFault::TooLong { limit });
    }
    Ok(Cow::Owned(text))
}

/// The commonest of comma, semicolon and tab in the first line that is not blank.
fn delimiter(text: &[u8]) -> u8 {
    let mut lines = text.split(|byte| matches!(byte, b'\n' | b'\r'));
    let first = lines.find(|line| !line.trim_ascii().is_empty());
    let count = |delimiter| {
        let line = first.unwrap_or_default().iter();
        line.filter(|&&byte| byte == delimiter).count()
    };
    // Of equals max_by_key takes the last: the comma.
    let candidates = [b'\t', b';', b','];
    candidates.into_iter().max_by_key(|&candidate| count(candidate)).unwrap_or(b',')
}

fn csv_fault(error: csv::Error) -> Located {
    let offset = error.position().map(csv::Position::byte);
    let fault = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            TableFault::FieldCount { found: *len, expected: *expected_len }
        }
        _ => TableFault::Unreadable(error.to_string()),
    };
    (offset, fault)
}

fn offset_of(row: &ByteRecord) -> Option<u64> {
    row.position().map(csv::Position::byte)
}

/// The line, counted from 1, of the row at a byte offset.
///
/// The reader's own count is one off after CRLF and blank lines, which it takes for the start
/// of the next row.
fn line_number(text: &[u8], offset: u64) -> u64 {
    let breaks = |byte: &&u8| matches!(byte, b'\n' | b'\r');
    let offset = offset as usize;
    let rest = text.get(offset..).unwrap_or_default();
    let start = offset + rest.iter().take_while(breaks).count();
    let before = text.iter().take(start);
    1 + before.filter(|&&byte| byte == b'\n').count() as u64
}

/// The unit in TrackMate's `(micron)`.
fn bracketed(text: &str) -> Option<String> {
    let unit = text.strip_prefix('(')?.strip_suffix(')')?.trim();
    (!unit.is_empty()).then(|| unit.to_owned())
}
