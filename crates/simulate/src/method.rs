//! Methods of integration in time.

use crate::scaled::real;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use voronudge_geometry::{Scalar, Vector};

/// How positions are moved in time.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Method {
    /// The classical Runge–Kutta method of fourth order; every step has the size that is asked for.
    #[default]
    RungeKutta4,
    /// The embedded pair of Bogacki and Shampine (1989), of orders three and two: a step is cut into parts so that the
    /// estimated error of each cell's displacement stays below a share of the mean spacing in every part.
    BogackiShampine {
        /// Largest error of a displacement in one part of a step, in mean spacings.
        tolerance: f64,
    },
}

/// Weights of the third-order result and of its difference from the second-order one, for slopes k₁ … k₄.
pub(crate) const THIRD_ORDER: [f64; 3] = [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0];
pub(crate) const DIFFERENCE: [f64; 4] = [-5.0 / 72.0, 1.0 / 12.0, 1.0 / 9.0, -1.0 / 8.0];

/// Bounds of the change of the step from one part to the next, and the margin below the error allowed.
const LEAST_CHANGE: f64 = 0.2;
const LARGEST_CHANGE: f64 = 4.0;
const MARGIN: f64 = 0.9;

/// The factor by which the step changes for an error of `share` times what is allowed.
pub(crate) fn change_of_step(share: f64) -> f64 {
    let factor = MARGIN * share.powf(-1.0 / 3.0);
    if factor.is_finite() {
        factor.clamp(LEAST_CHANGE, LARGEST_CHANGE)
    } else if share == 0.0 {
        LARGEST_CHANGE
    } else {
        LEAST_CHANGE
    }
}

/// The largest error of a displacement over all cells: `h |Σ_s d_s k_s|`.
pub(crate) fn largest_error<S: Scalar>(slopes: [&[Vector<S>]; 4], time_step: f64) -> f64 {
    let error = |cell: usize| {
        let sum: Vector<f64> = slopes.iter().zip(DIFFERENCE).map(|(k, weight)| real(&k[cell]) * weight).sum();
        sum.norm_squared()
    };
    (0..slopes[0].len()).map(error).fold(0.0, f64::max).sqrt() * time_step
}
