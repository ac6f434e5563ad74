//! What surrounds and preceded the cells: data that terms may refer to.

/// What surrounds and preceded the cells of one configuration. Empty by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Environment {}
