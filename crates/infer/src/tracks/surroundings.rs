//! What terms refer to in a movie: where the middle is, and labels of the cells.

use super::Movie;
use std::sync::Arc;
use voronudge_geometry::Vector;
use voronudge_model::{Column, Effect, Environment};

impl Movie {
    /// Gives labels to the cells that the movie was made from; a track has that of its first name.
    #[must_use]
    pub fn with_labels(self, labels: Vec<Option<i64>>) -> Self {
        Self { labels, ..self }
    }

    /// What surrounds the cells.
    pub(crate) fn environment(&self) -> Arc<Environment> {
        self.environment.clone()
    }

    /// The same of the cells of some tracks, with their labels.
    pub(super) fn environment_of(&self, tracks: &[u32]) -> Arc<Environment> {
        if self.labels.is_empty() {
            return self.environment.clone();
        }
        let label = |track: &u32| {
            let (_, name) = self.tracks[*track as usize].names.first()?;
            self.labels.get(*name).copied().flatten()
        };
        let labels = tracks.iter().map(label).collect();
        // There is nothing else about cells that it could disagree with.
        Environment::clone(&self.environment)
            .with_labels(labels)
            .map_or_else(|_| self.environment.clone(), Arc::new)
    }

    /// The columns of an effect among its cells.
    ///
    /// # Errors
    /// The reason why the effect cannot act there.
    pub fn columns(&self, effect: &Effect) -> Result<Vec<Column>, &'static str> {
        let earlier = Environment::clone(&self.environment).with_earlier(vec![Some(Vector::zeros())]);
        effect.columns(&earlier.unwrap_or_default(), self.domain)
    }
}
