//! What may be unknown of a measurement.

/// An unknown of the measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unknown {
    /// The share c of the way from site to centroid.
    Share,
    /// The width of the windows.
    Width,
}
