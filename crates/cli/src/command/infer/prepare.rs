//! From a data set to the scaled problem, and back.

use super::{Arguments, MeanToRemove, scaling};
use crate::failure::Failure;
use crate::run::Run;
use crate::snapshot::{Snapshot, domain};
use ndarray::Axis;
use voronudge_geometry::{Domain, PeriodicBox, Vector, Visibility, areas};
use voronudge_infer::{Inference, KnownNoise, Method, Observation, Request, Scale};
use voronudge_io::{DataSet, Difference, Noise, derive_velocities};
use voronudge_report::infer_report::{MeanRemoved, NoiseSource};

/// The problem in scaled units, and what is needed to translate its solution.
pub(crate) struct Prepared {
    pub frames: Vec<usize>,
    pub snapshots: Vec<Snapshot>,
    pub observations: Vec<Observation>,
    pub request: Request,
    pub scale: Scale,
    pub mean_removed: MeanRemoved,
    /// Where the noise levels come from if both were stated.
    pub stated_noise: NoiseSource,
    pub derived: Option<Difference>,
}

impl Prepared {
    /// Nudged positions, predicted velocities and residual velocities of one frame, in the units of the data.
    pub fn fields(&self, result: &Inference, index: usize) -> [Vec<Vector<f64>>; 3] {
        let (frame, observation) = (&result.frames[index], &self.observations[index]);
        let velocity = self.scale.velocity();
        let nan = Vector::new(f64::NAN, f64::NAN);
        [
            frame.nudged_positions.iter().map(|r| r * self.scale.length).collect(),
            frame.predicted.iter().map(|v| v * velocity).collect(),
            (0..frame.predicted.len())
                .map(|cell| observation.target(cell).map_or(nan, |v| (v - frame.predicted[cell]) * velocity))
                .collect(),
        ]
    }

    /// Says in which file and frame a fault lies, with the cell as the file numbers it.
    pub fn place(&self, error: voronudge_infer::Error, arguments: &Arguments) -> Failure {
        let file = arguments.data.positions_file();
        match error {
            voronudge_infer::Error::Geometry { frame, source } => {
                let place = format!("{}, frame {}", file.display(), self.frames[frame]);
                Failure::from(source).at(place)
            }
            voronudge_infer::Error::Interrupted => error.into(),
            other => Failure::from(other).at(file.display()),
        }
    }
}

pub(super) fn prepare(arguments: &Arguments, data: &DataSet, run: &mut Run) -> Result<Prepared, Failure> {
    let (velocities, derived) = match &data.velocities {
        Some(given) => (given.clone(), None),
        None => {
            let derived = derive_velocities(data, arguments.difference)
                .map_err(|error| Failure::from(error).at(arguments.data.positions_file().display()))?;
            (derived, Some(arguments.difference))
        }
    };
    if let Some(difference @ (Difference::Forward | Difference::Backward)) = derived {
        run.warn(format!(
            "velocities are {difference} differences, which share the error of the position they start or end at: it acts \
             as a spurious force; central differences do not"
        ));
    }
    let domain = domain(data)?;
    let frames = chosen_frames(arguments, data, &velocities, derived)?;
    let mut snapshots = Vec::new();
    let mut observations = Vec::new();
    for &frame in &frames {
        let snapshot = Snapshot::new(data, frame);
        let targets = snapshot.pick(velocities.index_axis(Axis(0), frame));
        let place = || format!("{}, frame {frame}", arguments.data.positions_file().display());
        let observation =
            Observation::new(frame, snapshot.positions.clone(), targets, domain, arguments.largest_area)
                .map_err(|error| match error {
                    voronudge_infer::Error::Geometry { source, .. } => {
                        Failure::from(snapshot.in_file_numbers(source)).at(place())
                    }
                    other => Failure::from(other).at(place()),
                })?;
        snapshots.push(snapshot);
        observations.push(observation);
    }
    let absent: usize = snapshots.iter().map(|snapshot| data.cells() - snapshot.cells.len()).sum();
    if absent > 0 && matches!(domain, Domain::Periodic(_)) {
        run.warn(format!(
            "{absent} cells are absent from frames of the periodic box: if they were there and not seen, the polygons around \
             the holes are wrong"
        ));
    }
    let mean_removed = match (arguments.remove_mean, derived, domain) {
        (MeanToRemove::PerFrame, ..) | (MeanToRemove::Auto, Some(_), Domain::Open) => {
            observations.iter_mut().for_each(remove_median);
            MeanRemoved::PerFrame
        }
        _ => MeanRemoved::None,
    };
    let scale = scale_of(&observations)
        .map_err(|error| Failure::from(error).at(arguments.data.positions_file().display()))?;
    let (request, stated_noise) = request(arguments, data, &scale)?;
    let observations = observations
        .iter()
        .enumerate()
        .map(|(index, observation)| scaled(index, observation, &scale, arguments.largest_area))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(Prepared { frames, snapshots, observations, request, scale, mean_removed, stated_noise, derived })
}

fn chosen_frames(
    arguments: &Arguments,
    data: &DataSet,
    velocities: &ndarray::Array3<f64>,
    derived: Option<Difference>,
) -> Result<Vec<usize>, Failure> {
    let has_velocity = |frame: usize| velocities.index_axis(Axis(0), frame).iter().any(|v| v.is_finite());
    let Some(selection) = &arguments.frames else {
        return Ok((0..data.frames()).filter(|&frame| has_velocity(frame)).collect());
    };
    let file = arguments.data.positions_file();
    let frames = selection.resolve(data.frames()).map_err(|error| Failure::from(error).at(file.display()))?;
    if let Some(frame) = frames.iter().find(|&&frame| !has_velocity(frame)) {
        let hint = match derived {
            Some(Difference::Central) => "central differences need the frame before and the frame after",
            Some(_) => "differences need the neighbouring frame",
            None => "choose a frame whose velocities are not all NaN",
        };
        let file = if derived.is_some() { file } else { arguments.data.velocities_file() };
        let place = format!("{}, frame {frame}", file.display());
        return Err(Failure::new("no cell has a velocity").with_hint(hint).at(place));
    }
    Ok(frames)
}

/// Removes the median velocity of the cells used: the median does not follow a few fast ones.
fn remove_median(observation: &mut Observation) {
    let targets: Vec<Vector<f64>> = observation.targets().map(|(_, v)| v).collect();
    if targets.is_empty() {
        return;
    }
    let median = |axis: usize| {
        let mut values: Vec<f64> = targets.iter().map(|v| v[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        let middle = values.len() / 2;
        if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
    };
    let drift = Vector::new(median(0), median(1));
    observation.velocities.values_mut().iter_mut().flatten().for_each(|v| *v -= drift);
}

/// ℓ₀² is the mean area of the cells that count; τ makes the root mean square velocity one.
fn scale_of(observations: &[Observation]) -> Result<Scale, voronudge_infer::Error> {
    let (mut area, mut cells, mut squares, mut used) = (0.0, 0.0, 0.0, 0usize);
    for observation in observations {
        let areas = areas(&observation.tessellation, &observation.positions);
        for (a, visibility) in areas.iter().zip(&observation.visibility) {
            if *visibility == Visibility::Counted {
                area += a;
                cells += 1.0;
            }
        }
        for (_, v) in observation.targets() {
            squares += v.norm_squared();
            used += 1;
        }
    }
    if used == 0 || cells == 0.0 {
        return Err(voronudge_infer::Error::TooFewVelocities { used, required: 4 });
    }
    if squares == 0.0 {
        return Err(voronudge_infer::Error::NothingMoves);
    }
    let length = (area / cells).sqrt();
    Ok(Scale { length, time: length / (squares / used as f64).sqrt() })
}

fn scaled(
    index: usize,
    observation: &Observation,
    scale: &Scale,
    largest_area: f64,
) -> Result<Observation, Failure> {
    let domain = match observation.tessellation.domain() {
        Domain::Periodic(cell_box) => {
            let lengths = cell_box.lengths().map(|l| l / scale.length);
            Domain::Periodic(PeriodicBox::sheared(lengths, cell_box.offset() / scale.length)?)
        }
        Domain::Open => Domain::Open,
    };
    let positions = observation.positions.iter().map(|r| r / scale.length).collect();
    let velocities: Vec<_> =
        observation.velocities.values().iter().map(|v| v.map(|v| v / scale.velocity())).collect();
    Ok(Observation::new(index, positions, velocities, domain, largest_area)?)
}

fn request(arguments: &Arguments, data: &DataSet, scale: &Scale) -> Result<(Request, NoiseSource), Failure> {
    let constraints = arguments.constraints()?;
    let level = |noise: Option<Noise>, unit: f64| {
        noise.map(|noise| match noise {
            Noise::Absolute(value) => value / unit,
            // Relative to ℓ₀ and to the root mean square velocity, which are one here.
            Noise::Relative(share) => share,
        })
    };
    let from_flags = arguments.data.position_noise.is_some() || arguments.data.velocity_noise.is_some();
    Ok((
        Request {
            noise: KnownNoise {
                position: level(data.position_noise, scale.length),
                velocity: level(data.velocity_noise, scale.velocity()),
            },
            method: Method::Search { max_steps: arguments.max_steps, starts: 1 },
            ..Request::new(scaling::scaled(&constraints, scale))
        },
        if from_flags { NoiseSource::Given } else { NoiseSource::DataSet },
    ))
}
