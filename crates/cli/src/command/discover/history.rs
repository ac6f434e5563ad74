//! Velocities of earlier intervals, from which effects with a memory are predicted.
//!
//! A velocity may be predicted from velocities of intervals that end before its own begins, never from one that shares
//! time with it: the motion in the shared time would predict itself.

use crate::command::fit::{SnapshotArguments, place_of_data};
use crate::failure::Failure;
use crate::problem::Measured;
use clap::ValueEnum;
use ndarray::Axis;
use voronudge_geometry::Vector;
use voronudge_io::{DataSet, Difference, Snapshot, derive_velocities};
use voronudge_model::Effect;
use voronudge_report::discover_report::Predictors;

/// Effects that need earlier velocities.
const WITH_A_MEMORY: [&str; 2] = ["persistence", "alignment"];

/// What given velocities are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum GivenDifference {
    /// Velocities at the time of the frame.
    Instantaneous,
    /// Differences between the positions in the next and in the previous frame.
    Central,
    /// Differences from this frame to the next.
    Forward,
    /// Differences from the previous frame to this one.
    Backward,
}

/// The earlier velocities of each frame.
pub(super) struct History {
    velocities: Measured,
    /// How many frames back the velocity is filed.
    lag: usize,
    predictors: Predictors,
}

/// Whether an effect needs earlier velocities.
pub(super) fn has_memory(effect: &Effect) -> bool {
    WITH_A_MEMORY.contains(&effect.id)
}

impl History {
    /// The latest velocities before those to be explained that share no time with them; none of flow fields, whose grid
    /// points are no cells.
    pub fn new(
        data: &DataSet,
        explained: &Measured,
        given: Option<GivenDifference>,
    ) -> Result<Option<Self>, Failure> {
        if given.is_some() && !matches!(explained, Measured::Given(_)) {
            return Err(Failure::new(
                "--given-difference is for velocities that are given, but there are none",
            )
            .with_hint("leave it out; --difference says how velocities are derived from tracks"));
        }
        let (velocities, lag, interval, overlap) = match explained {
            Measured::Flow(_) | Measured::Tracks(_) => return Ok(None),
            Measured::Derived(_, Difference::Forward) => (
                Measured::Derived(derive_velocities(data, Difference::Backward)?, Difference::Backward),
                0,
                "the backward difference, from frame t − 1 to frame t",
                "the velocity that is explained runs from frame t to frame t + 1: the two intervals share no time. They \
                 share the position at t, whose error pulls the two apart and makes persistence look smaller",
            ),
            Measured::Derived(all, Difference::Central) => (
                Measured::Derived(all.clone(), Difference::Central),
                2,
                "the central difference of frame t − 2, from frame t − 3 to frame t − 1",
                "the velocity that is explained runs from frame t − 1 to frame t + 1: the two intervals share no time. \
                 They share the position at t − 1, whose error pulls the two apart and makes persistence look smaller",
            ),
            Measured::Derived(all, Difference::Backward) => (
                Measured::Derived(all.clone(), Difference::Backward),
                1,
                "the backward difference of frame t − 1, from frame t − 2 to frame t − 1",
                "the velocity that is explained runs from frame t − 1 to frame t: the two intervals share no time. They \
                 share the position at t − 1, whose error pulls the two apart and makes persistence look smaller",
            ),
            Measured::Given(all) => {
                let (lag, interval, overlap) = match given.unwrap_or(GivenDifference::Instantaneous) {
                    GivenDifference::Central => (
                        2,
                        "the given velocity of frame t − 2, a central difference from frame t − 3 to frame t − 1",
                        "the velocity that is explained runs from frame t − 1 to frame t + 1: the two intervals share no time",
                    ),
                    GivenDifference::Forward => (
                        1,
                        "the given velocity of frame t − 1, a difference from frame t − 1 to frame t",
                        "the velocity that is explained runs from frame t to frame t + 1: the two intervals share no time",
                    ),
                    GivenDifference::Backward => (
                        1,
                        "the given velocity of frame t − 1, a difference from frame t − 2 to frame t − 1",
                        "the velocity that is explained runs from frame t − 1 to frame t: the two intervals share no time",
                    ),
                    GivenDifference::Instantaneous => (
                        1,
                        "the given velocity of frame t − 1, taken as that at its time",
                        "velocities at different times share none. If they are differences of positions, say so with \
                         --given-difference",
                    ),
                };
                (Measured::Given(all.clone()), lag, interval, overlap)
            }
        };
        let predictors = Predictors { interval: interval.into(), overlap: overlap.into() };
        Ok(Some(Self { velocities, lag, predictors }))
    }

    /// Whether any cell of a frame has an earlier velocity.
    fn reaches(&self, data: &DataSet, frame: usize) -> bool {
        let velocities = match &self.velocities {
            Measured::Given(all) | Measured::Derived(all, _) => all,
            Measured::Flow(_) | Measured::Tracks(_) => return false,
        };
        frame.checked_sub(self.lag).is_some_and(|earlier| {
            let picked = Snapshot::new(data, frame).pick(velocities.index_axis(Axis(0), earlier));
            picked.iter().any(Option::is_some)
        })
    }

    /// The earlier velocities of the cells of a frame, in the units of the data, treated as those to be explained were.
    pub fn earlier(
        &self,
        (arguments, data): (&SnapshotArguments, &DataSet),
        (snapshot, frame): (&Snapshot, usize),
        mean_removed: bool,
    ) -> Result<Vec<Option<Vector<f64>>>, Failure> {
        let nothing = || vec![None; snapshot.cells.len()];
        let Some(earlier) = frame.checked_sub(self.lag).filter(|_| self.reaches(data, frame)) else {
            return Ok(nothing());
        };
        let observed = self.velocities.observe(data, arguments.largest_area, earlier);
        let (then, mut observation) = observed.map_err(|error| place_of_data(arguments, error))?;
        if mean_removed {
            observation.remove_median();
        }
        let mut of_track = vec![None; data.cells()];
        for (&cell, velocity) in then.cells.iter().zip(observation.velocities.values()) {
            of_track[cell] = *velocity;
        }
        Ok(snapshot.cells.iter().map(|&cell| of_track[cell]).collect())
    }
}

/// The frames that are explained.
pub(super) struct Kept {
    pub frames: Vec<usize>,
    /// What effects with a memory are predicted from, if they can be tested.
    pub predictors: Option<Predictors>,
    /// Which frames were left out, and why.
    pub warning: Option<String>,
}

/// Frames with earlier velocities, if candidates have a memory and there are such frames; all otherwise.
pub(super) fn keep_frames(
    history: Option<&History>,
    data: &DataSet,
    frames: Vec<usize>,
    candidates: &[&'static Effect],
) -> Kept {
    let remembering: Vec<&str> =
        candidates.iter().filter(|effect| has_memory(effect)).map(|effect| effect.id).collect();
    let Some(history) = history.filter(|_| !remembering.is_empty()) else {
        return Kept { frames, predictors: None, warning: None };
    };
    let (with, without): (Vec<usize>, Vec<usize>) =
        frames.iter().partition(|&&frame| history.reaches(data, frame));
    if with.is_empty() {
        return Kept { frames, predictors: None, warning: None };
    }
    let list: Vec<String> = without.iter().map(usize::to_string).collect();
    let (noun, verb, them) =
        if without.len() == 1 { ("frame", "is", "it") } else { ("frames", "are", "them") };
    let warning = (!without.is_empty()).then(|| {
        format!(
            "{noun} {} {verb} left out: no cell has an earlier velocity there, from which {} could be predicted; \
             --without {} keeps {them}",
            list.join(", "),
            remembering.join(" and "),
            remembering.join(","),
        )
    });
    Kept { frames: with, predictors: Some(history.predictors.clone()), warning }
}
