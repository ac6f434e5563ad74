//! From the options to a problem, and faults of the data as the user sees them.

use super::arguments::SnapshotArguments;
use super::measured::file;
use crate::boundary::{domain, unknown};
use crate::failure::Failure;
use crate::memory::refuse_fit_beyond;
use crate::problem::{Detections, Measured, Problem, Question};
use crate::run::Run;
use std::path::PathBuf;
use voronudge_geometry::Domain;
use voronudge_infer::{Constraints, Error, Method, Scale};
use voronudge_io::DataSet;

/// What is asked of the data.
pub(crate) struct Inquiry<'a> {
    pub arguments: &'a SnapshotArguments,
    pub data: &'a DataSet,
    /// What is known of the parameters, in the units of the data.
    pub constraints: Constraints,
    pub method: Method,
    pub seed: u64,
    pub detections: Detections,
    /// The scale to use; that of the data if none is given.
    pub scale: Option<Scale>,
}

impl Inquiry<'_> {
    /// The velocities or tracks of some frames as a problem in scaled units.
    pub fn prepare(
        self,
        velocities: Measured,
        frames: Vec<usize>,
        run: &mut Run,
    ) -> Result<Problem, Failure> {
        let Self { arguments, data, .. } = self;
        let domain = domain(data)?;
        let present = |frame: &usize| {
            let places = data.positions.index_axis(ndarray::Axis(0), *frame);
            places.column(0).iter().filter(|x| x.is_finite()).count()
        };
        let present: Vec<usize> = frames.iter().map(present).collect();
        let followed = matches!(velocities, Measured::Tracks(_));
        refuse_fit_beyond(&present, followed)
            .map_err(|failure| failure.at(arguments.data.positions_file().display()))?;
        let place = Place::new(arguments, &velocities, &frames);
        let question = Question {
            constraints: self.constraints,
            method: self.method,
            seed: self.seed,
            remove_mean: arguments.remove_mean.into(),
            background: arguments.background,
            largest_area: arguments.largest_area,
            detections: self.detections,
            scale: self.scale,
            ..Question::default()
        };
        let problem = Problem::of(data, &question, velocities, frames);
        let absent: usize = present.iter().map(|present| data.cells() - present).sum();
        let seen = matches!(problem, Ok(_) | Err(crate::problem::Error::Fit(_)));
        if seen && absent > 0 && matches!(domain, Domain::Periodic(_)) {
            run.warn(format!(
                "{absent} cells are absent from frames of the periodic box: if they were there and not seen, the polygons around \
                 the holes are wrong"
            ));
        }
        problem.map_err(|error| place.of(error))
    }
}

/// Says in which file and frame a fault lies, with the cell as the file numbers it.
pub(crate) fn with_location(problem: &Problem, error: Error, arguments: &SnapshotArguments) -> Failure {
    Place::new(arguments, &problem.velocities, &problem.frames).of_fit(error)
}

/// Says in which file and frame a fault of data lies.
pub(crate) fn place_of_data(arguments: &SnapshotArguments, error: crate::problem::Error) -> Failure {
    use crate::problem::Error;
    match error {
        Error::Frame { frame, source } => {
            let file = arguments.data.positions_file();
            Failure::from(source).at(format!("{}, frame {frame}", file.display()))
        }
        Error::Data(error) => unknown(error),
        other => other.into(),
    }
}

/// Where the data of a fit come from.
struct Place<'a> {
    arguments: &'a SnapshotArguments,
    positions: PathBuf,
    velocities: PathBuf,
    frames: Vec<usize>,
    on_grid: bool,
}

impl<'a> Place<'a> {
    fn new(arguments: &'a SnapshotArguments, velocities: &Measured, frames: &[usize]) -> Self {
        Self {
            arguments,
            positions: arguments.data.positions_file(),
            velocities: file(velocities, arguments),
            frames: frames.to_vec(),
            on_grid: velocities.flow().is_some(),
        }
    }

    /// A fault of data that make no problem.
    fn of(&self, error: crate::problem::Error) -> Failure {
        use crate::problem::Error;
        match error {
            Error::Fit(error) => self.of_fit(error),
            Error::NoFrame => Failure::from(error).at(self.positions.display()),
            other => place_of_data(self.arguments, other),
        }
    }

    /// A fault of a fit.
    fn of_fit(&self, error: Error) -> Failure {
        match error {
            Error::Geometry { frame, source } => {
                let place = format!("{}, frame {}", self.positions.display(), self.frames[frame]);
                Failure::from(source).at(place)
            }
            Error::Diverges { frame } => {
                Failure::from(Error::Diverges { frame: self.frames[frame] }).at(self.positions.display())
            }
            Error::Degenerate | Error::Algebra(_) => Failure::from(error).at(format!(
                "{}, {}",
                self.positions.display(),
                told_frames(&self.frames)
            )),
            other => self.of_all(other),
        }
    }

    /// A fault of the data as a whole.
    fn of_all(&self, error: Error) -> Failure {
        match error {
            Error::TooFewVelocities { used, required } if self.on_grid => Failure::new(format!(
                "{used} grid points have a velocity and a window filled by cells with a trusted neighbourhood, but a fit needs \
                 at least {required}"
            ))
            .with_hint("check that grid and cells are in one frame of reference and unit, or give more frames")
            .at(self.velocities.display()),
            Error::NothingMoves if self.on_grid => Failure::from(error).at(self.velocities.display()),
            Error::Constraint(_) | Error::Interrupted => error.into(),
            other => Failure::from(other).at(self.positions.display()),
        }
    }
}

/// Which frames, in words.
fn told_frames(frames: &[usize]) -> String {
    match frames {
        [] => "no frame".into(),
        [one] => format!("frame {one}"),
        [first, .., last] => format!("{} frames from {first} to {last}", frames.len()),
    }
}
