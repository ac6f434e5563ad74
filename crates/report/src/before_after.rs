//! The base model against the model with the effects that were added.

use schemars::JsonSchema;
use serde::Serialize;

/// Something of the base model and the same of the model with the effects added. Where no effect
/// was added the two are equal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct BeforeAfter<T> {
    /// With the base model.
    pub before: T,
    /// With the selected effects, everything fitted again; equal to `before` if none was selected.
    pub after: T,
}

impl<T> BeforeAfter<T> {
    /// The two with their names.
    pub fn named(&self) -> [(&'static str, &T); 2] {
        [("before", &self.before), ("after", &self.after)]
    }
}
