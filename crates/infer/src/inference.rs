//! The fit: naive, then nudged, with noise levels, intervals and errors.

use crate::coefficients::parameters;
use crate::cross_validation::cross_validate;
use crate::degrees_of_freedom::degrees_of_freedom;
use crate::least_squares::{self, invert, predict};
use crate::levenberg_marquardt::{LevenbergMarquardt, Observer};
use crate::noise::{FIRST_POSITION_NOISE, Spent};
use crate::objective::{Objective, Shared};
use crate::{CoefficientSpace, Error, Fixed, NoiseLevels, NoiseSource, Observation, Progress};
use argmin::core::{Executor, TerminationReason, TerminationStatus};
use nalgebra::{DMatrix, Matrix4, Vector4};
use std::ops::ControlFlow;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::{Parameters, Term, base_terms};

/// What to fit, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Parameters held at a value.
    pub fixed: Fixed,
    /// Preferred area, a gauge.
    pub preferred_area: f64,
    /// σ_r if known; otherwise it is estimated.
    pub position_noise: Option<f64>,
    /// σ_v if known; otherwise it is estimated.
    pub velocity_noise: Option<f64>,
    /// Steps of the optimiser at each stage.
    pub max_steps: u64,
}

/// How a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// No further step gains anything.
    Converged,
    /// The allowed number of steps was used up.
    StepLimit,
    /// No step, however short, decreases the objective: usually a kink at a T1 transition.
    Stalled,
}

/// A value and its standard error; 95 % intervals are ±1.96 of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Standard error; zero if the value was fixed.
    pub standard_error: f64,
}

/// Estimates of the parameters and of the combination that data determine best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterEstimates {
    /// `K_A`
    pub area_elasticity: Estimate,
    /// `K_P`
    pub perimeter_elasticity: Estimate,
    /// `P_0`
    pub preferred_perimeter: Estimate,
    /// `α`
    pub chirality: Estimate,
    /// `K_P α`
    pub chiral_coefficient: Estimate,
}

/// Normalised mean squared errors `Σ‖v − v̂‖² / Σ‖v‖²` over the cells used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nmse {
    /// Least squares at the measured positions.
    pub naive: f64,
    /// The nudged fit at the nudged positions: a training error, below the noise floor.
    pub nudged: f64,
    /// The nudged fit's parameters at the measured positions.
    pub un_nudged: f64,
    /// Velocities held out of the fit, predicted at the measured positions: mean over folds and its standard error.
    pub cross_validated: Option<[f64; 2]>,
}

/// A direction in the space of coefficients and how well the data determine it.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// Eigenvalue of the Fisher information (one over the variance along the direction).
    pub eigenvalue: f64,
    /// Components along `K_A`, `K_P P_0`, `K_P`, `K_P α` (scaled).
    pub components: [f64; 4],
}

/// One frame after the fit.
#[derive(Debug, Clone)]
pub struct FrameResult {
    /// Nudged positions (N).
    pub nudged_positions: Vec<Vector<f64>>,
    /// Tessellation of the nudged positions.
    pub tessellation: Tessellation,
    /// Predicted velocities (N) at the nudged positions; NaN next to the rim of an open field.
    pub predicted: Vec<Vector<f64>>,
    /// Delaunay edges of the measured positions that the nudges removed, and those they made, as pairs of cells.
    pub edges_lost: Vec<(u32, u32)>,
    /// See `edges_lost`.
    pub edges_gained: Vec<(u32, u32)>,
}

/// The result of [`infer`].
#[derive(Debug, Clone)]
pub struct Inference {
    /// Fitted parameters.
    pub parameters: ParameterEstimates,
    /// The fitted parameters as the model takes them.
    pub model_parameters: Parameters<f64>,
    /// Parameters of the naive fit.
    pub naive: Parameters<f64>,
    /// Errors.
    pub nmse: Nmse,
    /// Noise levels used in the last fit.
    pub noise: NoiseLevels,
    /// Where they come from.
    pub noise_source: NoiseSource,
    /// Degrees of freedom that the nudges use up.
    pub degrees_of_freedom: f64,
    /// Root mean square nudge (vector) over all cells.
    pub nudge_rms: f64,
    /// Stiffest direction first.
    pub directions: Vec<Direction>,
    /// The frames, in the order given.
    pub frames: Vec<FrameResult>,
    /// How the last fit ended.
    pub status: Status,
    /// Steps of all fits.
    pub steps: u64,
    /// Final objective `(Σ‖v − F‖² + kΣ‖ε‖²) / σ_v²`.
    pub objective: f64,
    /// What the objective is expected to be if the model and the noise levels are right: components minus coefficients.
    pub expected_objective: f64,
    /// Objective at each step of the last fit, in the units of `objective`.
    pub trace: Vec<f64>,
    /// Number of velocities used.
    pub used: usize,
}

/// Factors on σ_v while a fit is led from loose to tight data, the springs held: a stiff start keeps the nudges from
/// falling into a wrong topology.
const CONTINUATION: [f64; 5] = [10.0, 5.0, 2.5, 1.5, 1.0];

/// Steps at each stage of the continuation but the last.
const STEPS_PER_STAGE: u64 = 6;

/// Relative decrease of the objective that counts as none.
const TOLERANCE: f64 = 1e-5;

/// Rounds of estimating the noise levels.
const NOISE_ROUNDS: usize = 6;

/// One nudged fit.
pub(crate) struct Fit {
    pub parameters: Vec<f64>,
    pub status: Status,
    pub steps: u64,
    pub trace: Vec<f64>,
}

/// Fits the model to snapshots. Frames share the parameters and have nudges of their own.
///
/// Positions in units of ℓ₀ and velocities of order one serve best (see [`crate::Scale`]); the estimates are in the same
/// units. `observe` is told of progress and may stop the fit.
///
/// # Errors
/// [`Error`] if there is too little to fit, the terms cannot be told apart, or the caller stops.
pub fn infer(
    frames: &[Observation],
    request: &Request,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Inference, Error> {
    let space = CoefficientSpace::new(&request.fixed)?;
    let used: usize = frames.iter().map(|frame| frame.targets().count()).sum();
    let required = 2 * space.dimension() + 2;
    if used < required {
        return Err(Error::TooFewVelocities { used, required });
    }
    let total: f64 = frames.iter().flat_map(Observation::targets).map(|(_, v)| v.norm_squared()).sum();
    if total <= 0.0 {
        return Err(Error::NothingMoves);
    }
    let terms = base_terms(request.preferred_area);
    let naive = least_squares::fit(frames, &terms, &space)?;
    let mut levels = first_levels(frames, request, &terms, &space, &naive)?;
    let estimated = request.position_noise.is_none() || request.velocity_noise.is_none();
    let mut objective = Objective { frames, terms: &terms, space: &space, spring: levels.spring() };
    let mut fit = nudged_fit(&mut objective, &naive, &levels, request.max_steps, "fit", observe)?;
    let mut steps = fit.steps;
    let mut spent = account(&objective, &fit.parameters, used)?;
    for _ in 0..if estimated { NOISE_ROUNDS } else { 0 } {
        let updated = spent.update(&levels);
        let next = NoiseLevels {
            position: request.position_noise.unwrap_or(updated.position),
            velocity: request.velocity_noise.unwrap_or(updated.velocity),
        };
        let change = (next.spring() / levels.spring()).ln().abs();
        levels = next;
        fit = nudged_fit(&mut objective, &naive, &levels, request.max_steps, "noise and fit", observe)?;
        steps += fit.steps;
        spent = account(&objective, &fit.parameters, used)?;
        if change < 0.05 {
            break;
        }
    }
    let cross_validated =
        cross_validate(frames, &terms, &space, &levels, request.max_steps.min(12), observe)?;
    let (free, nudges) = objective.split(&fit.parameters);
    let coefficients = space.coefficients(free);
    let objective_value = (spent.residual + levels.spring() * spent.nudges) / levels.velocity.powi(2);
    let expected = spent.components - spent.free;
    // Where the model misses more than the noise explains, the misfit counts as noise.
    let variance = levels.velocity.powi(2) * (objective_value / expected.max(1.0)).max(1.0);
    let information = schur(&objective, &fit.parameters)?;
    let covariance = invert(information.clone())? * variance;
    let residual_at = |beta: &[f64]| -> f64 {
        let coefficients = space.coefficients(beta);
        frames
            .iter()
            .map(|frame| {
                let columns = least_squares::columns_of(&frame.tessellation, &frame.positions, &terms);
                frame
                    .targets()
                    .map(|(cell, v)| (v - predict(&columns, coefficients.as_slice(), cell)).norm_squared())
                    .sum::<f64>()
            })
            .sum::<f64>()
    };
    let results = frames
        .iter()
        .zip(&nudges)
        .enumerate()
        .map(|(index, (frame, nudges))| {
            frame_result(&objective, frame, nudges, &coefficients)
                .map_err(|source| Error::Geometry { frame: index, source })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let cells: usize = frames.iter().map(|frame| frame.positions.len()).sum();
    Ok(Inference {
        parameters: estimates(&coefficients, &space.covariance(&covariance), &request.fixed),
        model_parameters: parameters(&coefficients, request.preferred_area),
        naive: parameters(&space.coefficients(&naive), request.preferred_area),
        nmse: Nmse {
            naive: residual_at(&naive) / total,
            nudged: spent.residual / total,
            un_nudged: residual_at(free) / total,
            cross_validated,
        },
        noise: levels,
        noise_source: if estimated { NoiseSource::Estimated } else { NoiseSource::Given },
        degrees_of_freedom: spent.degrees_of_freedom,
        nudge_rms: (spent.nudges / cells as f64).sqrt(),
        directions: directions(&space, &(information / variance)),
        frames: results,
        status: fit.status,
        steps,
        objective: objective_value,
        expected_objective: expected,
        trace: fit.trace.iter().map(|phi| phi / levels.velocity.powi(2)).collect(),
        used,
    })
}

/// Noise levels before any nudged fit: as given, or a usual position noise and the spread of the naive residual.
fn first_levels(
    frames: &[Observation],
    request: &Request,
    terms: &[Term],
    space: &CoefficientSpace,
    naive: &[f64],
) -> Result<NoiseLevels, Error> {
    for (name, value) in [("position", request.position_noise), ("velocity", request.velocity_noise)] {
        if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
            return Err(Error::Noise { name, value });
        }
    }
    let coefficients = space.coefficients(naive);
    let mut residuals: Vec<f64> = frames
        .iter()
        .flat_map(|frame| {
            let columns = least_squares::columns_of(&frame.tessellation, &frame.positions, terms);
            frame
                .targets()
                .flat_map(|(cell, v)| {
                    let rest = v - predict(&columns, coefficients.as_slice(), cell);
                    [rest.x.abs(), rest.y.abs()]
                })
                .collect::<Vec<_>>()
        })
        .collect();
    residuals.sort_unstable_by(f64::total_cmp);
    // The median absolute deviation of a normal distribution is 0.6745 standard deviations.
    let spread = residuals[residuals.len() / 2] / 0.6745;
    Ok(NoiseLevels {
        position: request.position_noise.unwrap_or(FIRST_POSITION_NOISE),
        velocity: request.velocity_noise.unwrap_or(0.3 * spread).max(1e-9),
    })
}

/// A nudged fit by continuation, from zero nudges and the given β.
pub(crate) fn nudged_fit(
    objective: &mut Objective<'_>,
    free: &[f64],
    levels: &NoiseLevels,
    max_steps: u64,
    stage: &str,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Fit, Error> {
    let mut at = free.to_vec();
    at.resize(free.len() + objective.nudge_count(), 0.0);
    let mut fit = Fit { parameters: at, status: Status::StepLimit, steps: 0, trace: Vec::new() };
    let expected = levels.velocity.powi(2) * objective.nudge_count() as f64;
    let all_steps = STEPS_PER_STAGE * (CONTINUATION.len() as u64 - 1) + max_steps;
    for (index, factor) in CONTINUATION.into_iter().enumerate() {
        let last = index + 1 == CONTINUATION.len();
        objective.spring = levels.spring() * factor * factor;
        let (done, mut trace) = (fit.steps, Vec::new());
        let mut watch = |step: u64, value: f64| {
            trace.push(value);
            observe(Progress { stage, step: (done + step, all_steps), objective: value / expected })
        };
        let (parameters, status, steps) =
            optimise(objective, &fit.parameters, if last { max_steps } else { STEPS_PER_STAGE }, &mut watch)?;
        fit = Fit { parameters, status, steps: fit.steps + steps, trace };
    }
    Ok(fit)
}

fn optimise(
    objective: &Objective<'_>,
    start: &[f64],
    max_steps: u64,
    observer: Observer<'_>,
) -> Result<(Vec<f64>, Status, u64), Error> {
    let solver = LevenbergMarquardt::new(TOLERANCE, observer);
    let executor = Executor::new(Shared(objective), solver)
        .configure(|state| state.param(start.to_vec()).max_iters(max_steps))
        .ctrlc(false);
    let mut state = executor
        .run()
        .map_err(|error| match error.downcast::<Error>() {
            Ok(own) => own,
            Err(other) => Error::Optimiser(other.to_string()),
        })?
        .state;
    let status = match &state.termination_status {
        TerminationStatus::Terminated(TerminationReason::Interrupt) => return Err(Error::Interrupted),
        TerminationStatus::Terminated(TerminationReason::SolverConverged) => Status::Converged,
        TerminationStatus::Terminated(TerminationReason::SolverExit(_)) => Status::Stalled,
        _ => Status::StepLimit,
    };
    let parameters = state.take_best_param().ok_or_else(|| Error::Optimiser("no best point".into()))?;
    Ok((parameters, status, state.iter))
}

/// Residuals, nudges and degrees of freedom at a solution.
fn account(objective: &Objective<'_>, parameters: &[f64], used: usize) -> Result<Spent, Error> {
    let (residual, nudges) = objective.parts(parameters);
    let degrees_of_freedom = objective
        .linearise(parameters)?
        .iter()
        .map(|frame| degrees_of_freedom(frame, objective.spring))
        .sum::<Result<f64, _>>()?;
    Ok(Spent {
        residual,
        components: 2.0 * used as f64,
        nudges,
        degrees_of_freedom,
        free: objective.space.dimension() as f64,
    })
}

/// The information on β with the nudges eliminated, in units of 1/σ_v².
fn schur(objective: &Objective<'_>, parameters: &[f64]) -> Result<DMatrix<f64>, Error> {
    let p = objective.space.dimension();
    let mut sum = DMatrix::zeros(p, p);
    for frame in objective.linearise(parameters)? {
        sum += frame.eliminate(0.0)?.schur;
    }
    Ok(sum)
}

fn estimates(c: &Vector4<f64>, covariance: &Matrix4<f64>, fixed: &Fixed) -> ParameterEstimates {
    let error = |gradient: Vector4<f64>| (gradient.transpose() * covariance * gradient)[0].max(0.0).sqrt();
    let k_p = c[2];
    let ratio = |index: usize, fixed: Option<f64>| {
        let mut gradient = Vector4::zeros();
        gradient[index] = 1.0 / k_p;
        gradient[2] = -c[index] / (k_p * k_p);
        match fixed {
            Some(value) => Estimate { value, standard_error: 0.0 },
            None => Estimate { value: c[index] / k_p, standard_error: error(gradient) },
        }
    };
    let plain = |index: usize| Estimate { value: c[index], standard_error: error(Vector4::ith(index, 1.0)) };
    ParameterEstimates {
        area_elasticity: plain(0),
        perimeter_elasticity: plain(2),
        preferred_perimeter: ratio(1, fixed.preferred_perimeter),
        chirality: ratio(3, fixed.chirality),
        chiral_coefficient: plain(3),
    }
}

fn directions(space: &CoefficientSpace, information: &DMatrix<f64>) -> Vec<Direction> {
    let eigen = information.clone().symmetric_eigen();
    let mut directions: Vec<Direction> = (0..information.nrows())
        .map(|k| {
            let along = space.basis() * eigen.eigenvectors.column(k);
            // The sign of an eigenvector is arbitrary: the largest component is positive.
            let sign = along[along.iamax()].signum() / along.norm();
            Direction {
                eigenvalue: eigen.eigenvalues[k],
                components: std::array::from_fn(|i| sign * along[i]),
            }
        })
        .collect();
    directions.sort_by(|a, b| b.eigenvalue.total_cmp(&a.eigenvalue));
    directions
}

fn frame_result(
    objective: &Objective<'_>,
    frame: &Observation,
    nudges: &[f64],
    coefficients: &Vector4<f64>,
) -> Result<FrameResult, voronudge_geometry::Error> {
    let nudged = objective.nudge(frame, nudges)?;
    let predicted = (0..frame.positions.len())
        .map(|cell| predict(&nudged.columns, coefficients.as_slice(), cell))
        .collect();
    let (before, after) = (frame.tessellation.edges(), nudged.tessellation.edges());
    let missing_from = |edges: &[(u32, u32, [i16; 2])], others: &[(u32, u32, [i16; 2])]| {
        edges
            .iter()
            .filter(|edge| others.binary_search(edge).is_err())
            .map(|edge| (edge.0, edge.1))
            .collect::<Vec<_>>()
    };
    Ok(FrameResult {
        edges_lost: missing_from(&before, &after),
        edges_gained: missing_from(&after, &before),
        nudged_positions: nudged.positions,
        tessellation: nudged.tessellation,
        predicted,
    })
}
