//! What surrounds the cells of each frame.

use super::{Error, Problem};
use std::sync::Arc;
use voronudge_geometry::{Domain, Vector, Visibility};
use voronudge_io::DataSet;
use voronudge_model::{Environment, EnvironmentError};

impl Problem {
    /// The middle of the box, or the mean position of the cells that count, over all frames; scaled.
    pub fn origin(&self) -> Vector<f64> {
        let (mut sum, mut count) = (Vector::zeros(), 0usize);
        for observation in &self.observations {
            if let Domain::Periodic(cell_box) = observation.tessellation.domain() {
                let [x, y] = cell_box.lengths();
                return Vector::new(0.5 * x, 0.5 * y);
            }
            let cells = observation.positions.iter().zip(&observation.visibility);
            for (r, _) in cells.filter(|(_, visibility)| **visibility == Visibility::Counted) {
                sum += r;
                count += 1;
            }
        }
        sum / count.max(1) as f64
    }

    /// What effects may refer to in one frame, scaled: where the middle is, labels of the cells, and which cells of an open field are beyond
    /// its edge.
    ///
    /// # Errors
    /// [`EnvironmentError`] if there are labels for other cells.
    pub fn surroundings(&self, data: &DataSet, index: usize) -> Result<Environment, EnvironmentError> {
        let (observation, snapshot) = (&self.observations[index], &self.snapshots[index]);
        let mut environment = Environment::default().about(self.origin());
        if let Some(labels) = data.labels_of(snapshot, self.frames[index]) {
            environment = environment.with_labels(self.of_cells(index, labels, &None))?;
        }
        if matches!(observation.tessellation.domain(), Domain::Open) {
            let beyond = observation.visibility.iter().map(|v| *v != Visibility::Counted).collect();
            environment = environment.with_beyond_edge(beyond)?;
        }
        Ok(environment)
    }

    /// Puts the cells into their [`surroundings`](Self::surroundings), once it is known how they were measured.
    ///
    /// # Errors
    /// [`Error::Surroundings`].
    pub fn surround(&mut self, data: &DataSet) -> Result<(), Error> {
        let own = |index| self.surroundings(data, index);
        let all = (0..self.observations.len()).map(own).collect::<Result<Vec<_>, _>>()?;
        self.observations = (self.observations.drain(..).zip(all))
            .map(|(observation, environment)| observation.within(Arc::new(environment)))
            .collect();
        self.label_tracks(data);
        Ok(())
    }

    /// Gives tracks the labels of their cells, if there are tracks and labels.
    pub fn label_tracks(&mut self, data: &DataSet) {
        if let Some(tracks) = &mut self.tracks {
            tracks.label(data, &self.frames);
        }
    }
}
