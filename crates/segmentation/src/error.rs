use thiserror::Error;

/// Why an image cannot be made of what is given.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// Values that do not fill the rows of an image.
    #[error("{values} values do not fill an image of {columns} columns and {rows} rows")]
    Raster {
        /// Number of values given.
        values: usize,
        /// Pixels in a row.
        columns: usize,
        /// Number of rows.
        rows: usize,
    },
}

impl Error {
    /// Advice on what to change, if there is any.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::Raster { .. } => "give one value for each pixel, row after row",
        })
    }
}
