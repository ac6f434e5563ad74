//! What a fit answers.

use crate::own_parts::surroundings;
use crate::{Doubt, Error, FitParameter, KindEstimates, NoiseLevels, NoiseSource, Observation, Spread};
use nalgebra::DVector;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::{CellParameter, Parameters};

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

/// A value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Standard error to first order, bounds apart; zero if the value was fixed.
    pub standard_error: f64,
    /// Ends of the 95 % likelihood-ratio interval of the linearised problem; `None` where it is unbounded.
    pub interval: [Option<f64>; 2],
}

impl Estimate {
    /// The same in a unit of which it is so many.
    #[must_use]
    pub fn in_unit(&self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            standard_error: self.standard_error * factor,
            interval: self.interval.map(|end| end.map(|end| end * factor)),
        }
    }

    /// Whether the interval contains a value.
    pub fn covers(&self, value: f64) -> bool {
        self.interval[0].is_none_or(|low| low <= value) && self.interval[1].is_none_or(|high| value <= high)
    }
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

impl ParameterEstimates {
    /// The estimate of a quantity.
    pub fn get(&self, quantity: FitParameter) -> &Estimate {
        match quantity {
            FitParameter::AreaElasticity => &self.area_elasticity,
            FitParameter::PerimeterElasticity => &self.perimeter_elasticity,
            FitParameter::PreferredPerimeter => &self.preferred_perimeter,
            FitParameter::Chirality => &self.chirality,
            FitParameter::ChiralCoefficient => &self.chiral_coefficient,
        }
    }
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
    /// What the noise alone makes of `un_nudged` if the model is right: `(n σ_v² + σ_r² ‖∂v/∂r‖²) / Σ‖v‖²`, linearised
    /// at the nudged positions. NaN if the position noise is at its limit, or
    /// if positions are not those of sites.
    pub noise_floor: f64,
    /// Velocities held out of the fit, predicted at the measured positions: mean over folds and its standard error.
    pub cross_validated: Option<[f64; 2]>,
}

/// A direction in the space of coefficients and how well the data determine it.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// One over the variance along the direction.
    pub eigenvalue: f64,
    /// Components of the unit vector along `K_A`, `K_P P_0 / 3.722`, `K_P`, `K_P α`: where the first of the middle two
    /// equals the second, `P_0` stays at the perimeter of a regular hexagon of unit area.
    pub components: [f64; 4],
}

/// One frame after the fit.
#[derive(Debug, Clone)]
pub struct FrameResult {
    /// Nudged positions (N).
    pub nudged_positions: Vec<Vector<f64>>,
    /// Tessellation of the nudged positions.
    pub tessellation: Tessellation,
    /// Predicted velocities of the cells (N) at the nudged positions; NaN next to the rim of an open field.
    pub predicted: Vec<Vector<f64>>,
    /// The same as they are measured: of the cells, or at the grid points.
    pub predicted_data: Vec<Vector<f64>>,
    /// What fits that did not see a velocity predict of it, at the measured positions and with the background as measured;
    /// one for each datum, `None` where it was not held out.
    pub held_out: Vec<Option<Vector<f64>>>,
    /// Polarities of the cells (N), where cells crawl, `None` of those without; empty otherwise.
    pub polarities: Vec<Option<Vector<f64>>>,
    /// Weight of each velocity in the fit, between nought and one; empty if all are one.
    pub weights: Vec<f64>,
    /// Delaunay edges of the measured positions that the nudges removed, and those they made, as pairs of cells.
    pub edges_lost: Vec<(u32, u32)>,
    /// See `edges_lost`.
    pub edges_gained: Vec<(u32, u32)>,
}

/// The result of [`infer`](crate::infer).
#[derive(Debug, Clone)]
pub struct Inference {
    /// Fitted parameters.
    pub parameters: ParameterEstimates,
    /// Coefficients of effects, in the order of the structure.
    pub effects: Vec<Estimate>,
    /// Parameters of the cells of each label, the reference first, where the request has kinds.
    pub kinds: Vec<KindEstimates>,
    /// The fitted parameters as the model takes them.
    pub model_parameters: Parameters<f64>,
    /// Parameters of the naive fit.
    pub naive: Parameters<f64>,
    /// Errors.
    pub nmse: Nmse,
    /// Coefficients: `K_A, K_P P_0, K_P, K_P α`, then those of effects.
    pub coefficients: DVector<f64>,
    /// Noise levels used in the last fit.
    pub noise: NoiseLevels,
    /// Where they come from.
    pub noise_source: NoiseSource,
    /// Degrees of freedom that the nudges use up.
    pub degrees_of_freedom: f64,
    /// Root mean square nudge (vector) over all cells.
    pub nudge_rms: f64,
    /// `k Σ‖ε‖² / Σ‖v − F‖²`: the paper chooses k such that this is one; it is `df / (n − df − p)` where the levels are
    /// right.
    pub contribution_ratio: f64,
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
    /// Objective after each step of the way to the best point, in the units of `objective`: first those of the
    /// continuation, with the springs in force at each, then one for each round of flipped contacts.
    pub trace: Vec<f64>,
    /// Objective at the end of each start.
    pub starts: Vec<f64>,
    /// Contacts whose flip was tried, and those whose flip was kept.
    pub transitions: [usize; 2],
    /// Reasons not to trust the fit; none if it is sound.
    pub doubts: Vec<Doubt>,
    /// How much cells differ, in the order of the request.
    pub spreads: Vec<Spread>,
    /// Number of velocities used.
    pub used: usize,
    /// `Σ‖v‖²` over them, without the background.
    pub total: f64,
}

impl Inference {
    /// By how much the objective exceeds its expected value; one where it does not.
    pub fn excess(&self) -> f64 {
        (self.objective / self.expected_objective).max(1.0)
    }

    /// Whether cells turn around between the frames of tracks, so that the paths of the fit need not be theirs.
    pub fn cells_turn(&self) -> bool {
        self.doubts.iter().any(|doubt| matches!(doubt, Doubt::Turning(_)))
    }

    /// The frames with the weights that their velocities have in the fit; `None` if all count alike.
    pub(crate) fn weighed(&self, frames: &[Observation]) -> Option<Vec<Observation>> {
        if self.frames.iter().all(|own| own.weights.is_empty()) {
            return None;
        }
        let pairs = frames.iter().zip(&self.frames);
        Some(pairs.map(|(frame, own)| frame.clone().with_weights(own.weights.clone())).collect())
    }

    /// The frames with what their cells have of their own in some parameters.
    ///
    /// # Errors
    /// [`Error::Spread`] if that is not finite.
    pub(crate) fn differing(
        &self,
        frames: &[Observation],
        parameters: &[CellParameter],
    ) -> Result<Vec<Observation>, Error> {
        let of_frame = |(index, frame): (usize, &Observation)| {
            let spreads = self.spreads.iter().filter(|own| parameters.contains(&own.parameter));
            let of = |spread: &Spread| {
                (spread.parameter, spread.deviations[index].iter().map(|own| own[0]).collect())
            };
            Ok(frame.clone().within(surroundings(frame.environment(), spreads.map(of))?))
        };
        frames.iter().enumerate().map(of_frame).collect()
    }
}
