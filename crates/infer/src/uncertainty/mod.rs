//! How far to believe a fit: profiles, slices of the landscape, the parametric bootstrap.

mod bootstrap;
mod landscape;
mod profile;

pub(crate) use bootstrap::synthetic;
pub use bootstrap::{Bootstrap, bootstrap};
pub use landscape::{Landscape, landscape};
pub use profile::{Profile, profile};

use crate::objective::Objective;
use crate::search::refine;
use crate::{CoefficientSpace, Error, FitParameter, FrameResult, Inference, Observation, Request};
use nalgebra::DVector;
use voronudge_model::Structure;

/// Steps of a refit from a neighbouring solution.
const STEPS: u64 = 30;

/// Standard errors to either side that profiles and landscapes cover.
const REACH: f64 = 3.0;

/// A finished fit, to ask further questions of.
struct Point<'a> {
    frames: &'a [Observation],
    structure: &'a Structure,
    space: CoefficientSpace,
    result: &'a Inference,
    /// ε of all frames.
    nudges: Vec<f64>,
    /// −2 log likelihood per unit of Φ.
    unit: f64,
}

impl<'a> Point<'a> {
    pub fn new(
        frames: &'a [Observation],
        request: &'a Request,
        result: &'a Inference,
    ) -> Result<Self, Error> {
        let nudges = nudges(frames, result).concat();
        Ok(Self {
            frames,
            structure: &request.structure,
            space: request.space()?,
            result,
            nudges,
            // Where the model misses more than the noise explains, the misfit counts as noise.
            unit: 1.0 / (result.noise.velocity.powi(2) * result.excess()),
        })
    }

    fn objective<'s>(&'s self, space: &'s CoefficientSpace) -> Objective<'s> {
        Objective::new(self.frames, self.structure, space, self.result.noise)
    }

    /// −2 log likelihood with quantities held, everything else refitted.
    fn refitted(&self, held: &[(FitParameter, f64)]) -> Result<f64, Error> {
        let mut space = self.space.clone();
        for (quantity, value) in held {
            space = space.hold(*quantity, *value)?;
        }
        let mut start = space.nearest(self.result.coefficients.as_slice());
        start.extend(&self.nudges);
        Ok(refine(&self.objective(&space), start, STEPS)?.value * self.unit)
    }

    /// Values around that of a quantity where Φ is least, ascending. The estimate is off from there by the bias that was taken off.
    fn range(&self, quantity: FitParameter, points: usize) -> Result<Vec<f64>, Error> {
        let estimate = self.result.parameters.get(quantity);
        if !estimate.value.is_finite() {
            return Err(Error::Constraint("a ratio to K_P has no profile where K_P is zero"));
        }
        if estimate.standard_error == 0.0 || points < 3 {
            return Err(Error::Constraint("a parameter that is held has no profile"));
        }
        let value = quantity.of(self.result.coefficients.as_slice());
        let reach = REACH * estimate.standard_error;
        let (mut low, mut high) = (value - reach, value + reach);
        // A bound ends the range; a long tail extends it.
        if let [Some(lower), _] = estimate.interval {
            let tail = estimate.value - lower;
            low = if tail == 0.0 { lower } else { low.min(value - 1.3 * tail) };
        }
        if let [_, Some(upper)] = estimate.interval {
            let tail = upper - estimate.value;
            high = if tail == 0.0 { upper } else { high.max(value + 1.3 * tail) };
        }
        Ok((0..points).map(|k| low + (high - low) * k as f64 / (points - 1) as f64).collect())
    }

    /// Φ over its expected value, for progress.
    fn level(&self) -> f64 {
        self.result.objective / self.result.expected_objective
    }
}

/// ε of each frame.
pub(crate) fn nudges(frames: &[Observation], result: &Inference) -> Vec<Vec<f64>> {
    let of = |(frame, own): (&Observation, &FrameResult)| {
        let pairs = frame.positions.iter().zip(&own.nudged_positions);
        pairs.flat_map(|(from, to)| [to.x - from.x, to.y - from.y]).collect()
    };
    frames.iter().zip(&result.frames).map(of).collect()
}

/// Coefficients with one quantity changed and the other parameters kept.
fn with(c: &DVector<f64>, quantity: FitParameter, value: f64) -> DVector<f64> {
    let mut changed = c.clone();
    match quantity {
        FitParameter::PerimeterElasticity => {
            changed.rows_mut(1, 3).copy_from(&(c.rows(1, 3) * (value / c[2])))
        }
        ratio if ratio.is_ratio() => changed[ratio.coefficient()] = value * c[2],
        other => changed[other.coefficient()] = value,
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changing_a_quantity_keeps_the_other_parameters() {
        let c = DVector::from_column_slice(&[0.1, 8.0, 2.0, 6.0]);
        for quantity in FitParameter::ALL {
            let changed = with(&c, quantity, 5.0);
            assert!((quantity.of(changed.as_slice()) - 5.0).abs() < 1e-12);
            for other in
                [FitParameter::AreaElasticity, FitParameter::PreferredPerimeter, FitParameter::Chirality]
            {
                let coupled = other == FitParameter::Chirality && quantity == FitParameter::ChiralCoefficient;
                if other != quantity && !coupled {
                    assert!(
                        (other.of(changed.as_slice()) - other.of(c.as_slice())).abs() < 1e-12,
                        "{quantity:?} {other:?}"
                    );
                }
            }
        }
    }
}
