//! A movie as frames of cells with the velocities that they are seen to have.

use super::movie::Movie;
use super::states::States;
use crate::{Error, Observation};
use voronudge_geometry::Vector;

impl Movie {
    /// The cells of each frame, those in gaps of their tracks included, with their mean velocities up to the next frame, where the model
    /// can explain these, without the median of the interval; in the last frame there is none. Tracks ascend within a frame.
    ///
    /// # Errors
    /// [`Error::Geometry`].
    pub fn observations(&self) -> Result<Vec<Observation>, Error> {
        Ok(self.seen_by(States::new(self)?))
    }

    /// The same from states.
    pub(super) fn seen_by(&self, states: States) -> Vec<Observation> {
        let mut velocities: Vec<Vec<Option<Vector<f64>>>> =
            states.instants.iter().map(|instant| vec![None; instant.tracks.len()]).collect();
        for motion in &states.motions {
            let (frame, track) = (motion.interval, &self.tracks[motion.track as usize]);
            if track.at(frame).is_some() && track.at(frame + 1).is_some() {
                let at =
                    |node: usize| states.instants[frame + node].cells.positions[motion.cells[node] as usize];
                let time = self.times[frame + 1] - self.times[frame];
                velocities[frame][motion.cells[0] as usize] =
                    Some((at(1) - at(0) - self.first_drift(frame)) / time);
            }
        }
        let frames = states.instants.into_iter().zip(velocities);
        frames.map(|(instant, velocities)| instant.cells.with_velocities(velocities)).collect()
    }
}
