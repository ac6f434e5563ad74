//! From a data set to what [`infer`](crate::infer) needs, and back to the units of the data.
//!
//! A [`Problem`] is the frames of a [`DataSet`] as they are fitted: the cells that are there, with velocities that are given, derived or on a
//! grid, or with their tracks; the mean velocity removed where the camera drifts; scaled by `ℓ₀` and τ. It is made for a [`Question`],
//! finds out how the cells were measured, hands itself to the fit or to the search for effects, and tells what comes out in the units of
//! the data.
//!
//! ```
//! use std::ops::ControlFlow;
//! use voronudge::infer::{Constraints, FitParameter};
//! use voronudge::io::Source;
//! use voronudge::problem::{Problem, Question};
//!
//! let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/chiral-liquid");
//! let data = Source::folder(folder).load()?;
//! let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.1)]);
//! let mut problem = Problem::new(&data, &Question { constraints, ..Question::default() })?;
//! let mut watch = |_: voronudge::infer::Progress<'_>| ControlFlow::Continue(());
//! problem.understand(&mut watch)?;
//! let (found, _) = problem.infer(&mut watch)?;
//! assert!(problem.estimate(&found, FitParameter::ChiralCoefficient).covers(3.4)); // K_P α, per unit of time
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod answer;
mod detections;
mod error;
mod field;
mod measured;
mod question;
mod search;
mod surroundings;
mod tracks;

pub use error::Error;
pub use field::OrderedField;
pub use measured::Measured;
pub use question::{Detections, MeanToRemove, Question};
pub use tracks::Tracks;

use measured::typical;
use std::ops::ControlFlow;
use tracks::jumps;
use voronudge_geometry::Domain;
use voronudge_infer::{
    Completion, Constraints, Inference, Kinds, KnownMeasurement, Measurement, Observation, Progress, Request,
    Scale, Tracked, Window, complete, infer, infer_tracks, measure,
};
use voronudge_io::{DataSet, Snapshot};

/// Told of progress; may stop what is done.
pub type Observer<'o> = &'o mut dyn FnMut(Progress<'_>) -> ControlFlow<()>;

/// Frames of a data set in the units of a fit, and what is needed to translate its result.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The frames (F) by their number in the data set.
    pub frames: Vec<usize>,
    /// Their cells (F) in the units of the data.
    pub snapshots: Vec<Snapshot>,
    /// The frames (F) as they are fitted, scaled; completed, if that was asked for.
    pub observations: Vec<Observation>,
    /// The tracks, if these are fitted themselves.
    pub tracks: Option<Tracks>,
    /// What was wrong with the detections, if that was looked for.
    pub completion: Option<Completion>,
    /// What is asked of the fit, scaled.
    pub request: Request,
    /// `ℓ₀` and τ in the units of the data.
    pub scale: Scale,
    /// Whether the median velocity of each frame, or for tracks the translation in each interval, is taken for drift.
    pub mean_removed: bool,
    /// Degree of the background, if one is allowed.
    pub background: Option<u32>,
    /// The velocities to be explained, in the units of the data.
    pub velocities: Measured,
    /// What is known of the parameters, in the units of the data.
    pub constraints: Constraints,
    /// What is declared of the measurement, scaled.
    pub known: KnownMeasurement,
    /// How cells were measured, scaled.
    pub measurement: Measurement,
    /// Position errors of the cells of each frame (F, N) in units of a typical one, if they have errors of their own.
    pub own_errors: Option<Vec<Vec<f64>>>,
    /// Whether cells are looked for that were not detected.
    pub detections: Detections,
}

impl Problem {
    /// What a question asks of a data set: the velocities that there are, or the tracks, in the frames asked for.
    ///
    /// # Errors
    /// [`Error`] if the data lack velocities and tracks, a frame does not exist or cannot be tessellated, or no cell counts or moves.
    pub fn new(data: &DataSet, question: &Question) -> Result<Self, Error> {
        let velocities = Measured::of(data, question.difference)?;
        let frames = question.frames.clone().unwrap_or_else(|| velocities.frames());
        Self::of(data, question, velocities, frames)
    }

    /// The same of some velocities in some frames, ascending.
    ///
    /// # Errors
    /// As for [`Problem::new`].
    pub fn of(
        data: &DataSet,
        question: &Question,
        mut velocities: Measured,
        frames: Vec<usize>,
    ) -> Result<Self, Error> {
        if let Some(&frame) = frames.iter().find(|frame| **frame >= data.frames()) {
            return Err(Error::NoSuchFrame { frame, frames: data.frames() });
        }
        let jumps = match &velocities {
            Measured::Tracks(_) => jumps(data, &frames)?,
            _ => Vec::new(),
        };
        for jump in &jumps {
            velocities.forget(frames[jump.frames[0]], jump.cell);
        }
        let mut own = Self::of_velocities(data, question, velocities, frames)?;
        if let Measured::Tracks(_) = own.velocities {
            own.tracks = Some(Tracks::new(data, &own, &jumps)?);
        }
        Ok(own)
    }

    fn of_velocities(
        data: &DataSet,
        question: &Question,
        velocities: Measured,
        frames: Vec<usize>,
    ) -> Result<Self, Error> {
        let mut snapshots = Vec::new();
        let mut observations = Vec::new();
        for &frame in &frames {
            let (snapshot, observation) = velocities.observe(data, question.largest_area, frame)?;
            snapshots.push(snapshot);
            observations.push(observation);
        }
        // Drift of the stage shows in tracks and in a flow field; given velocities may have been freed from it.
        let drifts = !matches!(velocities, Measured::Given(_)) && matches!(data.domain()?, Domain::Open);
        let mean_removed = match question.remove_mean {
            MeanToRemove::PerFrame => true,
            MeanToRemove::Auto => drifts,
            MeanToRemove::None => false,
        };
        if mean_removed {
            observations.iter_mut().for_each(Observation::remove_median);
        }
        // The data must have a scale of their own, even if it is not used.
        let own = Scale::of(&observations)?;
        let scale = question.scale.unwrap_or(own);
        let errors: Option<Vec<Vec<f64>>> = snapshots
            .iter()
            .zip(&frames)
            .map(|(snapshot, &frame)| {
                let errors = data.position_errors.as_ref()?;
                Some(snapshot.cells.iter().map(|&cell| errors[(frame, cell)]).collect())
            })
            .collect();
        let typical_error = errors.as_ref().and_then(|all| typical(all.iter().flatten()));
        let own_errors = errors.zip(typical_error).map(|(all, typical)| -> Vec<Vec<f64>> {
            all.into_iter().map(|of_frame| of_frame.iter().map(|error| error / typical).collect()).collect()
        });
        let mut request = question.request(data, &scale, typical_error);
        request.frame_interval = velocities.derived().map(|_| data.frame_interval / scale.time);
        let known = velocities.known(data, &scale);
        let observations = observations
            .iter()
            .enumerate()
            .map(|(index, observation)| {
                let mut observation = observation.scaled(index, &scale)?;
                let identities = snapshots[index].cells.iter().map(|cell| Some(*cell)).collect();
                observation = observation.with_identities(identities);
                if let Some(relative) = &own_errors {
                    observation = observation.with_position_errors(&relative[index]);
                }
                if let Some(share) = known.share.filter(|share| *share > 0.0) {
                    observation = observation.with_positions_at(share)?;
                }
                Ok(observation.with_background(question.background))
            })
            .collect::<Result<Vec<_>, Error>>()?;
        Ok(Self {
            frames,
            snapshots,
            observations,
            tracks: None,
            completion: None,
            request,
            scale,
            mean_removed,
            background: question.background,
            velocities,
            constraints: question.constraints.clone(),
            known,
            measurement: Measurement::stated(&known),
            own_errors,
            detections: question.detections,
        })
    }

    /// Finds out how the cells were measured: which were not detected, what a position is, over which windows velocities are
    /// averaged. Windows make the data of a flow field; what a position is can be told of complete cells only.
    ///
    /// # Errors
    /// Those of [`complete`], [`measure`] and their like for tracks.
    pub fn understand(&mut self, observe: Observer<'_>) -> Result<(), voronudge_infer::Error> {
        if let Some(mut tracks) = self.tracks.take() {
            let completed = self.complete_tracks(&mut tracks, observe);
            let understood = completed.and_then(|()| self.measure_tracks(&mut tracks, observe));
            self.tracks = Some(tracks);
            return understood;
        }
        if self.velocities.flow().is_some() {
            self.measure(observe)?;
            return self.complete(observe);
        }
        self.complete(observe)?;
        self.measure(observe)
    }

    /// Lets the cells of each label have parameters of their own, before it is found out how they were measured: missed cells and errors of
    /// positions would take the blame for differences.
    ///
    /// # Errors
    /// [`voronudge_infer::Error::Surroundings`].
    pub fn distinguish(&mut self, kinds: Kinds, data: &DataSet) -> Result<(), voronudge_infer::Error> {
        for (index, observation) in self.observations.iter_mut().enumerate() {
            if let Some(labels) = data.labels_of(&self.snapshots[index], self.frames[index]) {
                *observation = observation.clone().with_labels(labels)?;
            }
        }
        self.label_tracks(data);
        self.request = self.request.clone().with_kinds(kinds);
        Ok(())
    }

    /// Completes the frames, if that was not said to be needless.
    fn complete(&mut self, observe: Observer<'_>) -> Result<(), voronudge_infer::Error> {
        let Detections::Completed { missed_rate } = self.detections else { return Ok(()) };
        let completion = complete(&self.observations, &self.request, missed_rate, observe)?;
        self.observations = completion.frames.iter().map(|frame| frame.observation.clone()).collect();
        self.completion = Some(completion);
        Ok(())
    }

    /// Determines what is not declared of the measurement.
    fn measure(&mut self, observe: Observer<'_>) -> Result<(), voronudge_infer::Error> {
        let (observations, measurement) = measure(&self.observations, &self.request, &self.known, observe)?;
        if let (Some(kind), Some(width), Some(field)) =
            (measurement.kind, measurement.width, self.velocities.flow_mut())
        {
            field.take(Window { kind, width: width.value * self.scale.length });
        }
        self.observations = observations;
        self.measurement = measurement;
        Ok(())
    }

    /// Fits the model by nudged inference; of tracks also what their fit finds beside.
    ///
    /// # Errors
    /// Those of [`infer`] and [`infer_tracks`].
    pub fn infer(
        &self,
        observe: Observer<'_>,
    ) -> Result<(Inference, Option<Tracked>), voronudge_infer::Error> {
        match &self.tracks {
            Some(tracks) => infer_tracks(&tracks.movie, &self.request, observe)
                .map(|(result, tracked)| (result, Some(tracked))),
            None => infer(&self.observations, &self.request, observe).map(|result| (result, None)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array3;
    use voronudge_io::Boundary;

    #[test]
    fn what_is_not_there_is_refused() {
        let data = |frames| {
            let place = |(frame, cell, axis): (usize, usize, usize)| {
                let (row, column) = (cell / 6, cell % 6);
                let place = [column, row][axis] as f64;
                place + 0.3 * ((1 + cell + 7 * axis + 3 * frame) as f64).sin()
            };
            DataSet::new(
                Array3::from_shape_fn((frames, 36, 2), place),
                Boundary::Periodic { lengths: [6.0; 2] },
            )
        };
        let refusal = |frames, question: &Question| Problem::new(&data(frames), question).err();
        let usual = Question::default();
        assert!(matches!(refusal(1, &usual), Some(Error::NothingTellsMotion)));
        assert!(refusal(2, &usual).is_none());
        let beyond = Question { frames: Some(vec![0, 2]), ..Question::default() };
        assert!(matches!(refusal(2, &beyond), Some(Error::NoSuchFrame { frame: 2, frames: 2 })));
    }
}
