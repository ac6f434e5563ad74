//! Tables of a page.

use serde::Serialize;

use super::Text;

/// A table, most often one whose first column names the rows.
///
/// ```
/// use voronudge_report::page::Table;
/// let table = Table::new([("", ""), ("value", ""), ("unit", "unit")]).row(["K_P", "0.02", "min⁻¹"]);
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Table {
    class: &'static str,
    header: Vec<Cell>,
    rows: Vec<Row>,
    /// Whether the first cell of a row is its name.
    is_named: bool,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Row {
    cells: Vec<Cell>,
    /// Whether it stands out.
    is_main: bool,
}

/// A cell of a table, or the head of a column; by `into` from text, or from text and a class of `style.css`. The cells of a column have the class of its head:
/// `text` is for words, `unit` for units, `quiet` for what matters less.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Cell {
    text: Text,
    class: &'static str,
    /// What is behind it; empty for nothing.
    colour: String,
}

impl Table {
    /// A table of these columns, without rows.
    #[must_use]
    pub fn new<C: Into<Cell>>(header: impl IntoIterator<Item = C>) -> Self {
        let header = header.into_iter().map(Into::into).collect();
        Self { class: "parameters", header, rows: Vec::new(), is_named: true }
    }

    /// Names and contents, without heads of columns.
    #[must_use]
    pub fn plain<R: Into<Row>>(rows: impl IntoIterator<Item = R>) -> Self {
        Self { class: "plain", is_named: true, ..Self::default() }.rows(rows)
    }

    /// Looks like another class of `style.css`.
    #[must_use]
    pub fn class(self, class: &'static str) -> Self {
        Self { class, ..self }
    }

    /// The first cell of a row is no name.
    #[must_use]
    pub fn without_names(self) -> Self {
        Self { is_named: false, ..self }
    }

    /// With one more row.
    #[must_use]
    pub fn row(mut self, row: impl Into<Row>) -> Self {
        let mut row = row.into();
        for (cell, head) in row.cells.iter_mut().zip(&self.header) {
            cell.class = head.class;
        }
        self.rows.push(row);
        self
    }

    /// With these rows beneath those it has.
    #[must_use]
    pub fn rows<R: Into<Row>>(self, rows: impl IntoIterator<Item = R>) -> Self {
        rows.into_iter().fold(self, Self::row)
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

impl Row {
    /// Stands out if it is the main one.
    #[must_use]
    pub fn main(self, is_main: bool) -> Self {
        Self { is_main, ..self }
    }
}

impl Cell {
    /// On a coloured ground.
    #[must_use]
    pub fn on(self, colour: String) -> Self {
        Self { colour, ..self }
    }
}

impl<C: Into<Cell>> FromIterator<C> for Row {
    fn from_iter<I: IntoIterator<Item = C>>(cells: I) -> Self {
        Self { cells: cells.into_iter().map(Into::into).collect(), is_main: false }
    }
}

impl<C: Into<Cell>> From<Vec<C>> for Row {
    fn from(cells: Vec<C>) -> Self {
        cells.into_iter().collect()
    }
}

impl<C: Into<Cell>, const N: usize> From<[C; N]> for Row {
    fn from(cells: [C; N]) -> Self {
        cells.into_iter().collect()
    }
}

impl<T: Into<Text>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self { text: text.into(), ..Self::default() }
    }
}

impl<T: Into<Text>> From<(T, &'static str)> for Cell {
    fn from((text, class): (T, &'static str)) -> Self {
        Self { text: text.into(), class, colour: String::new() }
    }
}
