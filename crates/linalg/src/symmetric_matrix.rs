//! Sparse symmetric matrices.

use crate::Error;
use faer::sparse::SymbolicSparseColMatRef;
use std::sync::Arc;

/// The lower triangle of a sparse symmetric matrix, in compressed columns. Matrices made from one another share their
/// pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct SymmetricMatrix {
    places: Arc<Places>,
    value: Vec<f64>,
}

/// Where entries are.
#[derive(Debug, PartialEq)]
pub(crate) struct Places {
    column_start: Vec<usize>,
    row: Vec<usize>,
}

impl Places {
    /// How many entries there are.
    pub fn count(&self) -> usize {
        self.row.len()
    }
}

impl SymmetricMatrix {
    /// A matrix of order `column_start.len() − 1`. Every column holds its diagonal entry first, then the entries below
    /// in ascending rows.
    ///
    /// # Errors
    /// [`Error::Malformed`] if the arrays do not fit together.
    pub fn new(column_start: Vec<usize>, row: Vec<usize>, value: Vec<f64>) -> Result<Self, Error> {
        let order = column_start.len().checked_sub(1).ok_or(Error::Malformed("no column starts"))?;
        if row.len() != value.len() || column_start[0] != 0 || column_start[order] != row.len() {
            return Err(Error::Malformed("array lengths differ"));
        }
        for (column, range) in column_start.windows(2).enumerate() {
            let rows = row.get(range[0]..range[1]).ok_or(Error::Malformed("column starts descend"))?;
            let sound = rows.first() == Some(&column)
                && rows.windows(2).all(|pair| pair[0] < pair[1])
                && rows.last().is_some_and(|&last| last < order);
            if !sound {
                return Err(Error::Malformed("a column does not start at its diagonal and ascend"));
            }
        }
        Ok(Self { places: Arc::new(Places { column_start, row }), value })
    }

    /// A matrix with the same pattern and other values, in the same order.
    ///
    /// # Errors
    /// [`Error::Malformed`] if there are not as many.
    pub fn with_values(&self, value: Vec<f64>) -> Result<Self, Error> {
        if value.len() != self.value.len() {
            return Err(Error::Malformed("array lengths differ"));
        }
        Ok(Self { places: Arc::clone(&self.places), value })
    }

    /// Whether entries are at the same places as those of another matrix.
    pub fn has_pattern_of(&self, other: &Self) -> bool {
        self.is_at(&other.places)
    }

    /// Whether these are the places of the entries.
    pub(crate) fn is_at(&self, places: &Arc<Places>) -> bool {
        Arc::ptr_eq(&self.places, places) || self.places == *places
    }

    /// The places of the entries.
    pub(crate) fn shared_places(&self) -> Arc<Places> {
        Arc::clone(&self.places)
    }

    /// This matrix plus `factor` times another one of the same pattern.
    ///
    /// # Errors
    /// [`Error::Malformed`] if the patterns differ.
    pub fn plus(&self, factor: f64, other: &Self) -> Result<Self, Error> {
        if !self.has_pattern_of(other) {
            return Err(Error::Malformed("the patterns of two matrices differ"));
        }
        let value = self.value.iter().zip(&other.value).map(|(a, b)| a + factor * b).collect();
        Ok(Self { places: Arc::clone(&self.places), value })
    }

    /// Number of rows.
    pub fn order(&self) -> usize {
        self.places.column_start.len() - 1
    }

    /// The diagonal.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> {
        self.places.column_start[..self.order()].iter().map(|&start| self.value[start])
    }

    /// The entries of the lower triangle that are not zero: row, column and value.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let columns = self.places.column_start.windows(2).enumerate();
        let places = columns.flat_map(|(column, range)| (range[0]..range[1]).map(move |at| (at, column)));
        places
            .map(|(at, column)| (self.places.row[at], column, self.value[at]))
            .filter(|entry| entry.2 != 0.0)
    }

    /// Adds `shift` to every diagonal entry.
    pub fn shift_diagonal(&mut self, shift: f64) {
        self.add_to_diagonal(std::iter::repeat(shift));
    }

    /// Adds one value after another to the diagonal.
    pub fn add_to_diagonal(&mut self, shifts: impl IntoIterator<Item = f64>) {
        for (start, shift) in self.places.column_start[..self.order()].iter().zip(shifts) {
            self.value[*start] += shift;
        }
    }

    /// Adds a value to an entry of the lower triangle.
    ///
    /// # Errors
    /// [`Error::Malformed`] if the pattern has no such entry.
    pub fn add(&mut self, row: usize, column: usize, value: f64) -> Result<(), Error> {
        let absent = Error::Malformed("the pattern has no such entry");
        let starts = &self.places.column_start;
        let (Some(&begin), Some(&end)) = (starts.get(column), starts.get(column + 1)) else {
            return Err(absent);
        };
        let at = self.places.row[begin..end].binary_search(&row).map_err(|_| absent)?;
        self.value[begin + at] += value;
        Ok(())
    }

    /// Whether unknowns, in groups of one size that follow each other, are coupled by whole blocks.
    pub(crate) fn is_of_blocks(&self, group: usize) -> bool {
        let Places { column_start, row } = &*self.places;
        let rows = |column: usize| &row[column_start[column]..column_start[column + 1]];
        (0..self.order()).step_by(group).all(|column| {
            let first = rows(column);
            let is_whole =
                |own: &[usize]| own[0].is_multiple_of(group) && own[own.len() - 1] == own[0] + group - 1;
            first.len().is_multiple_of(group)
                && first.chunks_exact(group).all(is_whole)
                && (1..group).all(|j| rows(column + j) == &first[j..])
        })
    }

    /// Column starts and rows.
    pub(crate) fn places(&self) -> (&[usize], &[usize]) {
        (&self.places.column_start, &self.places.row)
    }

    /// Entries, column by column.
    pub(crate) fn values(&self) -> &[f64] {
        &self.value
    }

    pub(crate) fn pattern(&self) -> SymbolicSparseColMatRef<'_, usize> {
        let Places { column_start, row } = &*self.places;
        SymbolicSparseColMatRef::new_checked(self.order(), self.order(), column_start, None, row)
    }
}
