//! Velocities across a channel, as a table.

use std::borrow::Cow;
use std::path::Path;

use csv::ByteRecord;

use super::columns::Column;
use super::header::plain;
use super::{csv_fault, delimiter, line_number, offset_of, text_of, with_points};
use crate::error::{Error, TableFault};
use crate::input::{InputFile, read_input};

/// A profile of velocities: one row for each place across a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowProfile {
    /// Distance from the edge of the channel.
    pub x: Vec<f64>,
    /// Velocities across and along the channel.
    pub velocity: [Vec<f64>; 2],
    /// Their standard errors, where the table has columns of them.
    pub errors: Option<[Vec<f64>; 2]>,
    /// The file.
    pub input: InputFile,
}

/// Reads a table with columns `x`, `v_x`, `v_y` and, if both are there, `v_x_error`, `v_y_error`; further columns are left alone.
///
/// Separators are commas, semicolons or tabs; the table may be compressed. Rows without a velocity (`nan` or nothing) are skipped.
///
/// # Errors
/// [`Error::File`] where it cannot be read; [`Error::Table`] for missing columns, fields that are no numbers, and no rows.
pub fn read_flow_profile(path: &Path) -> Result<FlowProfile, Error> {
    let (bytes, input) = read_input(path)?;
    let failure = |line, fault| Error::Table { path: path.to_path_buf(), line, fault };
    let text = text_of(&bytes).map_err(|fault| failure(None, fault))?.bytes;
    parse(&text).map(|(x, velocity, errors)| FlowProfile { x, velocity, errors, input }).map_err(
        |(offset, fault)| {
            let line = offset.map(|offset: u64| line_number(&text, offset));
            failure(line, fault)
        },
    )
}

type Columns = (Vec<f64>, [Vec<f64>; 2], Option<[Vec<f64>; 2]>);

fn parse(text: &[u8]) -> Result<Columns, super::Located> {
    let separator = delimiter(text).unwrap_or(b',');
    let (text, _) = with_points(Cow::Borrowed(text), separator);
    let text = &*text;
    let mut reader = csv::ReaderBuilder::new().has_headers(false).delimiter(separator).from_reader(text);
    let mut rows = reader.byte_records();
    let header = match rows.next() {
        Some(row) => row.map_err(csv_fault)?,
        None => return Err((None, TableFault::Empty)),
    };
    let names: Vec<String> = header
        .iter()
        .map(|field| String::from_utf8_lossy(field).trim_start_matches('\u{feff}').trim().to_owned())
        .collect();
    let find = |role, known: &[&str]| {
        Column::find(&names, role, &None, known, plain, "x,v_x,v_y or x,v_x,v_y,v_x_error,v_y_error")
    };
    let needed = [
        find("distance from the edge", &["x", "distance", "d_b"]),
        find("velocity across the channel", &["v_x", "vx"]),
        find("velocity along the channel", &["v_y", "vy"]),
    ];
    let [x, v_x, v_y] = needed.map(|column| column.map_err(|fault| (offset_of(&header), fault)));
    let velocity_columns = [v_x?, v_y?];
    let x_column = x?;
    let error_columns = [
        find("standard error of v_x", &["v_x_error", "vx_error", "v_x_err"]),
        find("standard error of v_y", &["v_y_error", "vy_error", "v_y_err"]),
    ];
    let [of_x, of_y] = error_columns;
    let error_columns = of_x.ok().zip(of_y.ok()).map(|(x, y)| [x, y]);
    let mut x = Vec::new();
    let (mut velocity, mut errors) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for row in rows {
        let row = row.map_err(csv_fault)?;
        if velocity_columns.iter().any(|column| is_missing(&column.text(&row))) {
            continue;
        }
        let number = |column: &Column| column.finite(&row).map_err(|fault| (offset_of(&row), fault));
        x.push(number(&x_column)?);
        for (values, column) in velocity.iter_mut().zip(&velocity_columns) {
            values.push(number(column)?);
        }
        for (values, column) in errors.iter_mut().zip(error_columns.iter().flatten()) {
            values.push(positive(column, &row)?);
        }
    }
    if x.is_empty() {
        return Err((None, TableFault::NoRows));
    }
    Ok((x, velocity, error_columns.map(|_| errors)))
}

fn is_missing(text: &str) -> bool {
    matches!(text.to_lowercase().as_str(), "" | "nan" | "na" | "none" | "null")
}

fn positive(column: &Column, row: &ByteRecord) -> Result<f64, super::Located> {
    let fault = || (offset_of(row), column.fault(&column.text(row), "a number above zero"));
    column.finite(row).ok().filter(|error| *error > 0.0).ok_or_else(fault)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail anywhere")]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name_and_faults_have_their_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("profile.csv");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_flow_profile(&path)
        };
        let whole =
            read("density;x;V_y;v_x;v_x_error;v_y_error\n1;0.5;2;1;0.1;0.2\n1;1.5;nan;1;0.1;0.2\n").unwrap();
        assert_eq!((whole.x, whole.velocity), (vec![0.5], [vec![1.0], vec![2.0]]));
        assert_eq!(whole.errors, Some([vec![0.1], vec![0.2]]));
        assert_eq!(read("x,v_x,v_y\n1,2,3\n").unwrap().errors, None);
        let line = |text: &str| match read(text) {
            Err(Error::Table { line, fault, .. }) => (line, fault),
            other => panic!("{other:?}"),
        };
        assert!(matches!(line("x,v_x\n1,2\n"), (Some(1), TableFault::MissingColumn { .. })));
        assert!(matches!(line("x,v_x,v_y\n1,2,3\n1,fast,3\n"), (Some(3), TableFault::NotANumber { .. })));
        assert!(matches!(
            line("x,v_x,v_y,v_x_error,v_y_error\n1,2,3,0,1\n"),
            (Some(2), TableFault::NotANumber { .. })
        ));
        assert!(matches!(line("x,v_x,v_y\n"), (None, TableFault::NoRows)));
        assert!(matches!(line(""), (None, TableFault::Empty)));
    }
}
