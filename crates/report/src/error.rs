//! What can go wrong while a report is written.

/// Failure of a page or a report file.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A page template could not be filled.
    #[error("page template {template} could not be filled")]
    Template {
        /// Name of the template.
        template: &'static str,
        /// What the template engine says.
        #[source]
        source: minijinja::Error,
    },
    /// An animated image could not be written.
    #[error("the movie could not be written as GIF")]
    Image(#[from] gif::EncodingError),
    /// A report could not be written as JSON.
    #[error("report could not be written as JSON")]
    Json(#[from] serde_json::Error),
}
