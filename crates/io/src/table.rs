//! Reading the spots or the vectors of a table, compressed or not.

mod columns;
mod header;
mod known;
mod pivlab;
mod profile;
mod spot;
mod text;
mod vector_table;
mod vectors;

use std::borrow::Cow;
use std::path::Path;

use csv::ByteRecord;

use crate::error::{Error, TableFault};
use crate::note::Note;
use crate::stated::Stated;
pub use columns::ColumnNames;
use columns::Columns;

pub use profile::{FlowProfile, read_flow_profile};
pub(crate) use spot::{Layout, Spot};
pub(crate) use text::{decompressed, text_in_utf8};
use text::{delimiter, tabbed, text_of, with_points};
pub use vector_table::FlowColumnNames;
pub(crate) use vector_table::{Vector, VectorTable};
pub(crate) use vectors::read_table;

/// The most rows of a table.
pub(crate) const ROW_LIMIT: usize = 20_000_000;

/// Rows that TrackMate may put between the header and the first spot.
const EXTRA_HEADER_ROWS: usize = 3;

/// The spots of a table, in the order of its rows; at least one.
#[derive(Debug)]
pub(crate) struct SpotTable {
    pub(crate) spots: Vec<Spot>,
    /// Spots without a track.
    pub(crate) untracked: usize,
    /// Units that the file names.
    pub(crate) stated: Stated,
    /// What was understood of its columns.
    pub(crate) notes: Vec<Note>,
}

/// Reads a table; `path` only names the place.
pub(crate) fn read_spots(
    path: &Path,
    bytes: &[u8],
    layout: Layout,
    names: &ColumnNames,
) -> Result<SpotTable, Error> {
    let failure = |line, fault| Error::Table { path: path.to_path_buf(), line, fault };
    let text = text_of(bytes).map_err(|fault| failure(None, fault))?;
    let (separated, separator) = match delimiter(&text.bytes) {
        Some(separator) => (Cow::Borrowed(&*text.bytes), separator),
        None => (Cow::Owned(tabbed(&text.bytes)), b'\t'),
    };
    let (separated, commas) = with_points(separated, separator);
    let mut table = parse(&separated, separator, layout, names).map_err(|(offset, fault)| {
        let line = offset.map(|offset| line_number(&separated, offset));
        failure(line, fault)
    })?;
    table.notes.extend(text.note());
    table.notes.extend(commas);
    Ok(table)
}

/// A fault and the byte offset of the row it is in.
type Located = (Option<u64>, TableFault);

fn parse(text: &[u8], separator: u8, layout: Layout, names: &ColumnNames) -> Result<SpotTable, Located> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).delimiter(separator).from_reader(text);
    let mut rows = reader.byte_records();
    let header = match rows.next() {
        Some(row) => row.map_err(csv_fault)?,
        None => return Err((None, TableFault::Empty)),
    };
    if header.iter().all(|field| field.trim_ascii().is_empty()) {
        return Err((None, TableFault::Empty));
    }
    let columns = Columns::find(&header, layout, names).map_err(|fault| {
        let is_number =
            |field: &[u8]| std::str::from_utf8(field).is_ok_and(|text| text.trim().parse::<f64>().is_ok());
        let fault = if header.iter().all(is_number) { TableFault::NoNames } else { fault };
        (offset_of(&header), fault)
    })?;

    let by = "header of the table";
    let mut table = SpotTable {
        spots: Vec::new(),
        untracked: 0,
        stated: Stated { length_unit: columns.length_unit(), is_scaled: true, by, ..Stated::default() },
        notes: columns.notes(names),
    };
    let mut depths = Depths::default();
    let mut extra_rows = match layout {
        Layout::TrackMate => EXTRA_HEADER_ROWS,
        Layout::Tracks | Layout::Outlines | Layout::Points => 0,
    };
    for row in rows {
        let row = row.map_err(csv_fault)?;
        if extra_rows > 0 && columns.all_texts(&row) {
            extra_rows -= 1;
            let unit = bracketed(&columns.length_unit_text(&row));
            table.stated.length_unit = unit.or(table.stated.length_unit);
            continue;
        }
        extra_rows = 0;
        if table.spots.is_empty() {
            columns.check_label(&row, names).map_err(|fault| (offset_of(&row), fault))?;
        }
        match columns.spot(&row) {
            Ok(Some(_)) if table.spots.len() == ROW_LIMIT => {
                return Err((offset_of(&row), TableFault::TooManyRows { limit: ROW_LIMIT }));
            }
            Ok(Some(spot)) => {
                depths.include(columns.depth(&row));
                table.spots.push(spot);
            }
            Ok(None) => table.untracked += 1,
            Err(fault) => return Err((offset_of(&row), fault)),
        }
    }
    table.notes.extend(depths.note());
    match (table.spots.len(), table.untracked) {
        (0, 0) => Err((None, TableFault::NoRows)),
        (0, spots) => {
            let column = columns.track_name();
            Err((None, TableFault::NoTracks { spots, column }))
        }
        _ => Ok(table),
    }
}

/// The smallest and the largest z of spots, which the model does not know.
#[derive(Debug, Default)]
pub(crate) struct Depths(Option<[f64; 2]>);

impl Depths {
    pub(crate) fn include(&mut self, depth: Option<f64>) {
        if let Some(z) = depth.filter(|z| z.is_finite()) {
            let [low, high] = self.0.unwrap_or([z, z]);
            self.0 = Some([low.min(z), high.max(z)]);
        }
    }

    /// That z is left out, if it is more than one and the same number.
    pub(crate) fn note(&self) -> Option<Note> {
        let [low, high] = self.0.filter(|[low, high]| low < high)?;
        Some(Note::doubtful(format!(
            "z runs from {low} to {high} and is left out: cells are taken for one layer"
        )))
    }
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
