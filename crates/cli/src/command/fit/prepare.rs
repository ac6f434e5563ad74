//! From a data set to the scaled problem, and back.

use super::arguments::{MeanToRemove, SnapshotArguments};
use super::measured::Measured;
use super::{flow, measurement, scaling};
use crate::failure::Failure;
use crate::memory::refuse_fit_beyond;
use crate::run::Run;
use crate::snapshot::{Snapshot, domain};
use voronudge_geometry::{Domain, PeriodicBox, Vector, Visibility, areas};
use voronudge_infer::{
    Completion, Constraints, Error, Inference, KnownMeasurement, KnownNoise, Measurement, Method,
    Observation, Request, Scale, Velocities,
};
use voronudge_io::{DataSet, Noise};
use voronudge_report::infer_report::{MeanRemoved, NoiseSource, RegionSource};

/// What is asked of the data.
pub(crate) struct Question<'a> {
    pub arguments: &'a SnapshotArguments,
    pub data: &'a DataSet,
    /// What is known of the parameters, in the units of the data.
    pub constraints: Constraints,
    pub method: Method,
    pub seed: u64,
    /// The scale to use; that of the data if none is given.
    pub scale: Option<Scale>,
}

/// The problem in scaled units, and what is needed to translate its solution.
#[derive(Clone)]
pub(crate) struct Prepared {
    pub frames: Vec<usize>,
    pub snapshots: Vec<Snapshot>,
    /// The frames as they are fitted: completed, if that was asked for.
    pub observations: Vec<Observation>,
    /// What was wrong with the detections, if that was looked for.
    pub completion: Option<Completion>,
    pub request: Request,
    pub scale: Scale,
    pub mean_removed: MeanRemoved,
    /// Degree of the background, if one is allowed.
    pub background: Option<u32>,
    /// Where the noise levels come from if both were stated.
    pub stated_noise: NoiseSource,
    /// Where the field of view comes from, if it is open.
    pub region_source: RegionSource,
    pub velocities: Measured,
    /// What is known of the parameters, in the units of the data.
    pub constraints: Constraints,
    /// What is declared of the measurement, in scaled units.
    pub known: KnownMeasurement,
    /// How cells were measured, in scaled units.
    pub measurement: Measurement,
    /// Position errors of the cells of each frame (F, N) in units of a typical one, if they have errors of their own.
    pub own_errors: Option<Vec<Vec<f64>>>,
}

impl Prepared {
    /// Nudged positions of one frame in the units of the data.
    pub fn nudged_positions(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let nudged = result.frames[index].nudged_positions.iter();
        self.of_detections(index, nudged.map(|r| r * self.scale.length).collect())
    }

    /// Predicted velocities of the cells of one frame.
    pub fn predicted(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let predicted = result.frames[index].predicted.iter();
        self.of_detections(index, predicted.map(|v| v * self.scale.velocity()).collect())
    }

    /// Polarities of the cells of one frame; NaN where there is none.
    pub fn polarities(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let own = result.frames[index].polarities.iter();
        let velocity = |p: &Option<Vector<f64>>| p.map_or(NOWHERE, |p| p * self.scale.velocity());
        self.of_detections(index, own.map(velocity).collect())
    }

    /// The data of one frame as the model predicts them, of cells or on the grid; NaN out of its reach.
    pub fn predicted_data(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let observation = &self.observations[index];
        let predicted = result.frames[index].predicted_data.iter().enumerate();
        predicted
            .map(
                |(datum, v)| if observation.is_in_reach(datum) { v * self.scale.velocity() } else { NOWHERE },
            )
            .collect()
    }

    /// Measured minus predicted data of one frame; NaN where there is no measurement to be explained.
    pub fn residual_data(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let (observation, predicted) = (&self.observations[index], &result.frames[index].predicted_data);
        let mut rests: Vec<Vector<f64>> =
            observation.targets().map(|(datum, v)| (v - predicted[datum]) * self.scale.velocity()).collect();
        observation.remove_background(&mut rests);
        let mut field = vec![NOWHERE; predicted.len()];
        for ((datum, _), rest) in observation.targets().zip(rests) {
            field[datum] = rest;
        }
        match observation.velocities {
            Velocities::OfCells(_) => self.of_detections(index, field),
            Velocities::OnGrid(_) => field,
        }
    }

    /// Says in which file and frame a fault lies, with the cell as the file numbers it.
    pub fn place(&self, error: Error, arguments: &SnapshotArguments) -> Failure {
        let file = arguments.data.positions_file();
        match error {
            Error::Geometry { frame, source } => {
                let place = format!("{}, frame {}", file.display(), self.frames[frame]);
                Failure::from(source).at(place)
            }
            Error::Degenerate | Error::Algebra(_) => {
                Failure::from(error).at(format!("{}, {}", file.display(), told_frames(&self.frames)))
            }
            other => faulty_data(other, &self.velocities, arguments),
        }
    }
}

/// No vector.
const NOWHERE: Vector<f64> = Vector::new(f64::NAN, f64::NAN);

/// Which frames, in words.
fn told_frames(frames: &[usize]) -> String {
    match frames {
        [] => "no frame".into(),
        [one] => format!("frame {one}"),
        [first, .., last] => format!("{} frames from {first} to {last}", frames.len()),
    }
}

/// A fault of the data as a whole.
fn faulty_data(error: Error, velocities: &Measured, arguments: &SnapshotArguments) -> Failure {
    let flow = velocities.flow().is_some();
    match error {
        Error::TooFewVelocities { used, required } if flow => Failure::new(format!(
            "{used} grid points have a velocity and a window filled by cells with a trusted neighbourhood, but a fit needs \
             at least {required}"
        ))
        .with_hint("check that grid and cells are in one frame of reference and unit, or give more frames")
        .at(velocities.file(arguments).display()),
        Error::NothingMoves if flow => Failure::from(error).at(velocities.file(arguments).display()),
        Error::Constraint(_) | Error::Interrupted => error.into(),
        other => Failure::from(other).at(arguments.data.positions_file().display()),
    }
}

impl Question<'_> {
    /// The velocities of some frames as a problem in scaled units.
    pub fn prepare(
        self,
        velocities: Measured,
        frames: Vec<usize>,
        run: &mut Run,
    ) -> Result<Prepared, Failure> {
        let Self { arguments, data, .. } = self;
        let domain = domain(data)?;
        let present = |frame: &usize| {
            let places = data.positions.index_axis(ndarray::Axis(0), *frame);
            places.column(0).iter().filter(|x| x.is_finite()).count()
        };
        let followed = matches!(velocities, Measured::Tracks(_));
        refuse_fit_beyond(&frames.iter().map(present).collect::<Vec<_>>(), followed)
            .map_err(|failure| failure.at(arguments.data.positions_file().display()))?;
        let mut snapshots = Vec::new();
        let mut observations = Vec::new();
        for &frame in &frames {
            let (snapshot, observation) = observe(arguments, data, &velocities, frame)?;
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
        // Drift of the stage shows in tracks and in a flow field; given velocities may have been freed from it.
        let drifts = !matches!(velocities, Measured::Given(_)) && matches!(domain, Domain::Open);
        let mean_removed = match arguments.remove_mean {
            MeanToRemove::PerFrame => MeanRemoved::PerFrame,
            MeanToRemove::Auto if drifts => MeanRemoved::PerFrame,
            _ => MeanRemoved::None,
        };
        if mean_removed == MeanRemoved::PerFrame {
            observations.iter_mut().for_each(remove_median);
        }
        // The data must have a scale of their own, even if it is not used.
        let own = scale_of(&observations).map_err(|error| faulty_data(error, &velocities, arguments))?;
        let scale = self.scale.unwrap_or(own);
        let errors: Option<Vec<Vec<f64>>> = snapshots
            .iter()
            .zip(&frames)
            .map(|(snapshot, &frame)| measurement::position_errors(data, snapshot, frame))
            .collect();
        let typical_error = errors.as_ref().and_then(|all| measurement::typical(all.iter().flatten()));
        let own_errors = errors.zip(typical_error).map(|(all, typical)| -> Vec<Vec<f64>> {
            all.into_iter().map(|of_frame| of_frame.iter().map(|error| error / typical).collect()).collect()
        });
        let (mut request, stated_noise) = self.request(&scale, typical_error);
        request.frame_interval = velocities.derived().map(|_| data.frame_interval / scale.time);
        let known = measurement::known(data, velocities.flow(), &scale);
        let observations = observations
            .iter()
            .enumerate()
            .map(|(index, observation)| {
                let mut observation = scaled(index, observation, &scale)?;
                let identities = snapshots[index].cells.iter().map(|cell| Some(*cell)).collect();
                observation = observation.with_identities(identities);
                if let Some(relative) = &own_errors {
                    observation = observation.with_position_errors(&relative[index]);
                }
                if let Some(share) = known.share.filter(|share| *share > 0.0) {
                    observation = observation.with_positions_at(share)?;
                }
                Ok(observation.with_background(arguments.background))
            })
            .collect::<Result<Vec<_>, Failure>>()?;
        Ok(Prepared {
            frames,
            snapshots,
            observations,
            completion: None,
            request,
            scale,
            mean_removed,
            background: arguments.background,
            stated_noise,
            region_source: match &data.field_of_view {
                Some(_) if arguments.data.field_of_view.is_some() => RegionSource::Given,
                Some(_) => RegionSource::DataSet,
                None => RegionSource::Hull,
            },
            velocities,
            constraints: self.constraints,
            known,
            measurement: Measurement::stated(&known),
            own_errors,
        })
    }

    /// What is asked of the fit, and where the noise levels come from.
    ///
    /// Errors of single cells, of which a typical one is given, are those of the positions unless a noise level is stated besides:
    /// then they say how it is shared out.
    fn request(&self, scale: &Scale, typical_error: Option<f64>) -> (Request, NoiseSource) {
        let Self { arguments, data, constraints, .. } = self;
        let level = |noise: Option<Noise>, unit: f64| {
            noise.map(|noise| match noise {
                Noise::Absolute(value) => value / unit,
                // Relative to ℓ₀ and to the root mean square velocity, which are one here.
                Noise::Relative(share) => share,
            })
        };
        let from_flags = arguments.data.position_noise.is_some() || arguments.data.velocity_noise.is_some();
        (
            Request {
                noise: KnownNoise {
                    position: level(data.position_noise.or(typical_error.map(Noise::Absolute)), scale.length),
                    velocity: level(data.velocity_noise, scale.velocity()),
                },
                method: self.method,
                seed: self.seed,
                ..Request::new(scaling::scaled(constraints, scale))
            },
            if from_flags { NoiseSource::Given } else { NoiseSource::DataSet },
        )
    }
}

/// The cells of one frame with their velocities, in the units of the data.
pub(crate) fn observe(
    arguments: &SnapshotArguments,
    data: &DataSet,
    velocities: &Measured,
    frame: usize,
) -> Result<(Snapshot, Observation), Failure> {
    let snapshot = Snapshot::new(data, frame);
    let targets = velocities.of(&snapshot, frame);
    let place = || format!("{}, frame {frame}", arguments.data.positions_file().display());
    let domain = domain(data)?;
    let observation =
        Observation::new(frame, snapshot.positions.clone(), targets, domain, arguments.field_of_view(data)?)
            .map_err(|error| match error {
                Error::Geometry { source, .. } => Failure::from(snapshot.in_file_numbers(source)).at(place()),
                other => Failure::from(other).at(place()),
            })?;
    Ok((snapshot, observation))
}

/// Removes the median velocity of the cells used: the median does not follow a few fast ones.
pub(crate) fn remove_median(observation: &mut Observation) {
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
fn scale_of(observations: &[Observation]) -> Result<Scale, Error> {
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
        return Err(Error::TooFewVelocities { used, required: 4 });
    }
    if squares == 0.0 {
        return Err(Error::NothingMoves);
    }
    let length = (area / cells).sqrt();
    Ok(Scale { length, time: length / (squares / used as f64).sqrt() })
}

fn scaled(index: usize, observation: &Observation, scale: &Scale) -> Result<Observation, Failure> {
    let domain = match observation.tessellation.domain() {
        Domain::Periodic(cell_box) => {
            let lengths = cell_box.lengths().map(|l| l / scale.length);
            Domain::Periodic(PeriodicBox::sheared(lengths, cell_box.offset() / scale.length)?)
        }
        Domain::Open => Domain::Open,
    };
    let positions = observation.positions.iter().map(|r| r / scale.length).collect();
    let velocities = match &observation.velocities {
        Velocities::OfCells(all) => {
            Velocities::OfCells(all.iter().map(|v| v.map(|v| v / scale.velocity())).collect())
        }
        Velocities::OnGrid(flow) => Velocities::OnGrid(flow::scaled(flow, scale)?),
    };
    let field_of_view = observation.field_of_view.scaled(scale.length.recip());
    Ok(Observation::new(index, positions, velocities, domain, field_of_view)?)
}
