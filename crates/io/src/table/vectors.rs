//! Reading the vectors of a table, as programs for particle image velocimetry export them.

use std::borrow::Cow;
use std::path::Path;

use csv::ByteRecord;

use super::columns::Column;
use super::header::{unbracketed, unit_in};
use super::pivlab::read_pivlab;
use super::vector_table::{FlowColumnNames, Vector, VectorTable};
use super::{Located, csv_fault, line_number, offset_of, tabbed, text_of, with_points};
use crate::error::{Error, TableFault, excerpt};
use crate::mat;

/// Reads a table, compressed or not; `path` only names the place.
pub(crate) fn read_table(path: &Path, bytes: &[u8], names: &FlowColumnNames) -> Result<VectorTable, Error> {
    let failure = |line, fault| Error::Table { path: path.to_path_buf(), line, fault };
    if bytes.starts_with(mat::SIGNATURE) {
        return read_pivlab(path, bytes, names);
    }
    let text = text_of(bytes).map_err(|fault| failure(None, fault))?.bytes;
    let (text, separator) = match separator(&text) {
        Some(separator) => (text, separator),
        None => (Cow::Owned(tabbed(&text)), b'\t'),
    };
    let (text, commas) = with_points(text, separator);
    let mut table = parse(&text, separator, names).map_err(|(offset, fault)| {
        let line = offset.map(|offset| line_number(&text, offset));
        failure(line, fault)
    })?;
    table.notes.extend(commas);
    Ok(table)
}

fn parse(text: &[u8], separator: u8, names: &FlowColumnNames) -> Result<VectorTable, Located> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).delimiter(separator).from_reader(text);
    let mut columns: Option<Columns> = None;
    // The last line of text that is no header, and why it is none.
    let mut preface: Option<(ByteRecord, TableFault)> = None;
    let mut lines = Lines { text, at: 0, line: 1 };
    let mut table = VectorTable::default();
    for row in reader.byte_records() {
        let row = row.map_err(csv_fault)?;
        if row.iter().all(|field| field.trim_ascii().is_empty()) {
            continue;
        }
        let here = |fault| (offset_of(&row), fault);
        let known = match &columns {
            Some(_) if is_comment(&row) => continue,
            Some(known) => known,
            None if is_numbers(&row) => match preface.take() {
                // Where a line has a text for each number, it means to name them.
                Some((header, fault)) if !is_comment(&header) || header.len() == row.len() => {
                    return Err((offset_of(&header), fault));
                }
                _ => columns.insert(Columns::unnamed(&row, names).map_err(here)?),
            },
            None => {
                match Columns::find(&row, names) {
                    Ok(found) => columns = Some(found),
                    Err(fault) => preface = Some((row, fault)),
                }
                continue;
            }
        };
        let line = lines.number(offset_of(&row).unwrap_or_default());
        table.vectors.push(known.vector(&row, line).map_err(here)?);
    }
    match (columns, preface) {
        (Some(_), _) if table.vectors.is_empty() => Err((None, TableFault::NoRows)),
        (Some(columns), _) => {
            table.unit = unit_in(&columns.u.name);
            table.place_unit = unit_in(&columns.x.name);
            table.columns = format!("columns {}", columns.described());
            Ok(table)
        }
        (None, Some((header, fault))) => Err((offset_of(&header), fault)),
        (None, None) => Err((None, TableFault::Empty)),
    }
}

/// The columns of a table that matter.
struct Columns {
    frame: Option<Column>,
    x: Column,
    y: Column,
    u: Column,
    v: Column,
    mask: Option<Column>,
    /// Fields of a row.
    width: usize,
}

impl Columns {
    fn find(header: &ByteRecord, names: &FlowColumnNames) -> Result<Self, TableFault> {
        const EXAMPLE: &str = "--x-column X --u-column dx";
        let found: Vec<String> = header
            .iter()
            .map(|field| {
                let text = String::from_utf8_lossy(field);
                text.trim_start_matches(['\u{feff}', '#', ' ']).trim().to_owned()
            })
            .collect();
        let find = |role, given: &Option<String>, known: &[&str]| {
            Column::find(&found, role, given, known, unbracketed, EXAMPLE)
        };
        // These may be absent, unless they were asked for.
        let find_optional = |role, given: &Option<String>, known: &[&str]| match find(role, given, known) {
            Ok(column) => Ok(Some(column)),
            Err(fault) if given.is_some() => Err(fault),
            Err(_) => Ok(None),
        };
        Ok(Self {
            x: find("x coordinate", &names.x, &["x", "position_x", "pos_x", "x_position"])?,
            y: find("y coordinate", &names.y, &["y", "position_y", "pos_y", "y_position"])?,
            u: find("displacement along x", &names.u, &["u", "dx", "vx", "velocity_x"])?,
            v: find("displacement along y", &names.v, &["v", "dy", "vy", "velocity_y"])?,
            frame: find_optional("frame", &names.frame, &["frame", "t", "time_index", "time_point"])?,
            mask: find_optional("mask", &names.mask, &["mask"])?,
            width: found.len(),
        })
    }

    /// Columns x, y, u, v in this order, the table having no header.
    fn unnamed(row: &ByteRecord, names: &FlowColumnNames) -> Result<Self, TableFault> {
        if *names != FlowColumnNames::default() {
            return Err(TableFault::NoHeader);
        }
        let column = |index, name: &str| Column { index, name: name.to_owned() };
        Ok(Self {
            frame: None,
            x: column(0, "x"),
            y: column(1, "y"),
            u: column(2, "u"),
            v: column(3, "v"),
            mask: None,
            width: row.len(),
        })
    }

    /// Which columns are what.
    fn described(&self) -> String {
        let roles = [("x", Some(&self.x)), ("y", Some(&self.y)), ("u", Some(&self.u)), ("v", Some(&self.v))];
        let more = [("frame", self.frame.as_ref()), ("mask", self.mask.as_ref())];
        let found = roles.into_iter().chain(more).filter_map(|(role, column)| Some((role, column?)));
        found
            .map(|(role, column)| format!("{role} is \"{}\"", excerpt(&column.name)))
            .collect::<Vec<_>>()
            .join(", ")
    }

    fn vector(&self, row: &ByteRecord, line: u64) -> Result<Vector, TableFault> {
        // A separator at the end of the line makes one empty field more.
        let surplus = row.iter().skip(self.width).any(|field| !field.trim_ascii().is_empty());
        if row.len() < self.width || surplus {
            return Err(TableFault::FieldCount { found: row.len() as u64, expected: self.width as u64 });
        }
        let frame = self.frame.as_ref().map_or(Ok(0), |column| column.whole(row))?;
        let (x, y) = (self.x.finite(row)?, self.y.finite(row)?);
        let masked = match &self.mask {
            Some(column) => column.finite(row)? != 0.0,
            None => false,
        };
        let displacement = match masked {
            true => [f64::NAN; 2],
            false => [component(&self.u, row)?, component(&self.v, row)?],
        };
        let [u, v] = displacement;
        if u.is_nan() != v.is_nan() {
            return Err(TableFault::HalfMissing { u: self.u.text(row).into(), v: self.v.text(row).into() });
        }
        Ok(Vector { line, frame, x, y, displacement })
    }
}

/// A component of a displacement; NaN and an empty field mean that it is missing.
fn component(column: &Column, row: &ByteRecord) -> Result<f64, TableFault> {
    let text = column.text(row);
    if text.is_empty() {
        return Ok(f64::NAN);
    }
    let number = text.parse::<f64>().ok().filter(|value| !value.is_infinite());
    number.ok_or_else(|| column.fault(&text, "a finite number or NaN"))
}

/// Line numbers of rows that come in order.
///
/// The reader's own count is one off after CRLF and blank lines.
struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: u64,
}

impl Lines<'_> {
    /// The line, counted from 1, of the row at a byte offset not before the last one.
    fn number(&mut self, offset: u64) -> u64 {
        let rest = self.text.get(offset as usize..).unwrap_or_default();
        let start = offset as usize + rest.iter().take_while(|byte| matches!(byte, b'\n' | b'\r')).count();
        let passed = self.text.get(self.at..start).unwrap_or_default();
        self.line += passed.iter().filter(|&&byte| byte == b'\n').count() as u64;
        self.at = start;
        self.line
    }
}

/// What separates the fields of the first line of numbers; `None` for blanks.
fn separator(text: &[u8]) -> Option<u8> {
    let is_separator = |byte: &u8| matches!(byte, b',' | b';' | b'\t' | b' ');
    let is_data = |line: &&[u8]| {
        let mut fields = line.split(is_separator).filter(|field| !field.is_empty());
        let number = fields.next().and_then(|field| std::str::from_utf8(field).ok()?.parse::<f64>().ok());
        number.is_some() && fields.count() >= 3
    };
    let mut lines =
        text.split(|byte| matches!(byte, b'\n' | b'\r')).filter(|line| !line.trim_ascii().is_empty());
    let first = lines.clone().next();
    let line = lines.find(is_data).or(first)?.trim_ascii();
    [b';', b'\t', b','].into_iter().find(|separator| line.contains(separator))
}

fn is_comment(row: &ByteRecord) -> bool {
    row.get(0).is_some_and(|field| field.trim_ascii_start().starts_with(b"#"))
}

/// At least four fields, all of them numbers.
fn is_numbers(row: &ByteRecord) -> bool {
    let mut fields = row.iter().map(<[u8]>::trim_ascii).filter(|field| !field.is_empty());
    let is_number = |field: &[u8]| std::str::from_utf8(field).is_ok_and(|text| text.parse::<f64>().is_ok());
    row.len() >= 4 && fields.all(is_number)
}
