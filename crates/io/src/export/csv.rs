//! Cells as rows.

use super::{CellFrame, numbers};
use ::csv::Writer;

/// A row for each cell and frame.
pub(super) fn table(frames: &[CellFrame], y_sign: f64, time: impl Fn(usize) -> f64) -> String {
    let cells = frames.iter().flat_map(|frame| (0..frame.cells.len()).map(move |cell| (frame, cell)));
    lines(cells.map(|(frame, cell)| {
        let place = frame.positions[cell];
        let neighbours: Vec<String> = frame.neighbours[cell].iter().map(usize::to_string).collect();
        let mut row = vec![
            ("frame".to_owned(), frame.frame.to_string()),
            ("time".to_owned(), text(time(frame.frame))),
            ("cell".to_owned(), frame.cells[cell].to_string()),
            ("x".to_owned(), text(place.x)),
            ("y".to_owned(), text(y_sign * place.y)),
        ];
        row.extend(numbers(frame, cell, y_sign).into_iter().map(|(name, value)| (name, text(value))));
        row.push(("neighbours".to_owned(), neighbours.join(" ")));
        row
    }))
}

/// Rows of a tracks layer of napari: track, frame, y, x and properties; sorted by track.
pub(super) fn tracks(frames: &[CellFrame], y_sign: f64) -> String {
    let mut sorted: Vec<(usize, usize, usize)> = Vec::new();
    for (index, frame) in frames.iter().enumerate() {
        sorted.extend(frame.cells.iter().enumerate().map(|(place, &cell)| (cell, index, place)));
    }
    sorted.sort_unstable();
    let rows = sorted.into_iter().map(|(track, index, cell)| {
        let frame = &frames[index];
        let place = frame.positions[cell];
        let mut row = vec![
            ("track_id".to_owned(), track.to_string()),
            ("t".to_owned(), frame.frame.to_string()),
            ("y".to_owned(), text(y_sign * place.y)),
            ("x".to_owned(), text(place.x)),
        ];
        row.extend(numbers(frame, cell, y_sign).into_iter().map(|(name, value)| (name, text(value))));
        row
    });
    lines(rows)
}

/// A table of rows with the same names.
fn lines(rows: impl Iterator<Item = Vec<(String, String)>>) -> String {
    let mut table = Writer::from_writer(Vec::new());
    for (number, row) in rows.enumerate() {
        let (names, values): (Vec<String>, Vec<String>) = row.into_iter().unzip();
        // Memory takes every row.
        if number == 0 {
            let _ = table.write_record(&names);
        }
        let _ = table.write_record(&values);
    }
    String::from_utf8(table.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// A number with all its digits; nothing for what is none.
fn text(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { String::new() }
}
