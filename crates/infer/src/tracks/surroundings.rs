//! What terms refer to in a movie: where the middle is, and labels of the cells.

use super::Movie;
use std::sync::Arc;
use voronudge_geometry::Vector;
use voronudge_model::{Column, Effect, Environment};

impl Movie {
    /// Gives labels to the cells that the movie was made from; a track has that of the first of its names that has one.
    pub fn label(&mut self, labels: &[Option<i64>]) {
        for track in self.tracks.iter_mut().filter(|track| !track.names.is_empty()) {
            track.label = track.names.iter().find_map(|(_, name)| labels.get(*name).copied().flatten());
        }
    }

    /// What surrounds the cells.
    pub(crate) fn environment(&self) -> Arc<Environment> {
        self.environment.clone()
    }

    /// The same of the cells of some tracks, with their labels.
    pub(super) fn environment_of(&self, tracks: &[u32]) -> Arc<Environment> {
        let labels: Vec<_> = tracks.iter().map(|track| self.tracks[*track as usize].label).collect();
        if labels.iter().all(Option::is_none) {
            return self.environment.clone();
        }
        // There is nothing else about cells that it could disagree with.
        Environment::clone(&self.environment)
            .with_labels(labels)
            .map_or_else(|_| self.environment.clone(), Arc::new)
    }

    /// The same of all its cells.
    fn environment_of_all(&self) -> Arc<Environment> {
        self.environment_of(&(0..self.tracks.len() as u32).collect::<Vec<_>>())
    }

    /// The labels of its cells, ascending, but the most frequent one.
    pub fn other_labels(&self) -> Vec<i64> {
        self.environment_of_all().other_labels()
    }

    /// The columns of an effect among its cells.
    ///
    /// # Errors
    /// The reason why the effect cannot act there.
    pub fn columns(&self, effect: &Effect) -> Result<Vec<Column>, &'static str> {
        let earlier = vec![Some(Vector::zeros()); self.tracks.len()];
        let earlier = Environment::clone(&self.environment_of_all()).with_earlier(earlier);
        effect.columns(&earlier.unwrap_or_default(), self.domain)
    }
}
