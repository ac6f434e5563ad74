//! What a fit would know if more, or better, had been measured: the next measurement, by Fisher information.
//!
//! The information that data have on the coefficients depends on where the cells are and on the model, hardly on what errors they happened to
//! have. So the information of data that nobody has is known beforehand, as far as they are of the same kind:
//!
//! | instead | information |
//! |---|---|
//! | twice the frames | frames are independent: twice that of the data. Of tracks: that of the fitted movie gone on by the model, without noise, for as many frames; where cells crawl, as many times as there are more motions |
//! | half the interval | of tracks: that of the fitted movie in which each cell is seen half-way between frames too. Errors of positions are the same, and the dynamics scatter as much in the same time |
//! | half the position noise | nudges are held by springs four times as stiff |
//! | twice the field | as many times as there are more velocities: twice, and more in an open field, whose rim does not count and grows with the root of the area |
//!
//! Priors say the same whatever is measured. What the model misses beyond noise counts as noise, and stays.

mod snapshots;

pub(crate) use snapshots::informed;
pub use snapshots::prospects;

use crate::estimates::{Fitted, StandardErrors};
use crate::normal_matrix::invert;
use crate::{CoefficientSpace, Constraints, Error, FitParameter, Inference};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Domain;

/// A way to measure more, or better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Twice as many frames, at the same interval.
    TwiceTheFrames,
    /// Half the interval, over the same time.
    HalfTheInterval,
    /// Half the error of positions.
    HalfThePositionNoise,
    /// A field of view of twice the area.
    TwiceTheField,
}

impl Design {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::TwiceTheFrames, Self::HalfTheInterval, Self::HalfThePositionNoise, Self::TwiceTheField];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TwiceTheFrames => "twice_the_frames",
            Self::HalfTheInterval => "half_the_interval",
            Self::HalfThePositionNoise => "half_the_position_noise",
            Self::TwiceTheField => "twice_the_field",
        }
    }
}

/// What would be known with another design.
#[derive(Debug, Clone, PartialEq)]
pub struct Prospect {
    /// The design.
    pub design: Design,
    /// Standard error of each quantity of [`FitParameter::ALL`] as a share of the present one; NaN for those that are held.
    pub parameters: [f64; FitParameter::ALL.len()],
    /// The same of the coefficients of effects, in the order of the structure; of a search, of those of the effects that were added, one after
    /// the other, NaN of what has no column.
    pub effects: Vec<f64>,
}

/// Two effects that the data cannot tell apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Ambiguity {
    /// Id of the effect that was added.
    pub effect: &'static str,
    /// Id of the one that could stand in its place.
    pub other: &'static str,
    /// By how many standard errors the first stands out beside the other.
    pub separation: f64,
    /// The same with each design.
    pub with: Vec<(Design, f64)>,
}

/// What would be known with other designs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prospects {
    /// One for each design that can be judged.
    pub designs: Vec<Prospect>,
    /// Effects that the data cannot tell apart.
    pub ambiguities: Vec<Ambiguity>,
}

impl Prospects {
    /// What would be known with a design.
    pub fn with(&self, design: Design) -> Option<&Prospect> {
        self.designs.iter().find(|own| own.design == design)
    }
}

/// The information on the free coefficients, of the data as they are and with other designs.
pub(crate) struct Informed {
    pub now: DMatrix<f64>,
    pub with: Vec<(Design, DMatrix<f64>)>,
}

/// Information by which data are multiplied: all but that of the priors.
pub(crate) fn multiplied(information: &DMatrix<f64>, priors: &DMatrix<f64>, factor: f64) -> DMatrix<f64> {
    (information - priors) * factor + priors
}

/// By how much the number of velocities in reach grows with twice the area, if a share of them is in reach.
pub(crate) fn growth_with_area(domain: Domain, in_reach: f64) -> f64 {
    match domain {
        Domain::Periodic(_) => 2.0,
        Domain::Open => ((2.0 - 2f64.sqrt() * (1.0 - in_reach)) / in_reach).max(2.0),
    }
}

impl Informed {
    /// Standard errors as shares of the present ones, about a fit.
    pub fn prospects(
        &self,
        space: &CoefficientSpace,
        constraints: &Constraints,
        result: &Inference,
    ) -> Result<Prospects, Error> {
        let free = space.nearest(&corrected(result));
        let errors = |information: &DMatrix<f64>| -> Result<StandardErrors, Error> {
            let centre = DVector::from_column_slice(&free);
            Fitted { space, constraints, free: &free, information, centre }.standard_errors()
        };
        let now = errors(&self.now)?;
        let mut designs = Vec::with_capacity(self.with.len());
        for (design, information) in &self.with {
            let with = errors(information)?;
            designs.push(Prospect {
                design: *design,
                parameters: std::array::from_fn(|k| with.parameters[k] / now.parameters[k]),
                effects: with.effects.iter().zip(&now.effects).map(|(with, now)| with / now).collect(),
            });
        }
        Ok(Prospects { designs, ambiguities: Vec::new() })
    }

    /// By how many standard errors the coefficients of an effect stand out, now and with each design: `√(cᵀ C⁻¹ c)`, C their covariance
    /// beside all others.
    pub fn separations(&self, places: &[usize], c: &[f64]) -> Result<(f64, Vec<(Design, f64)>), Error> {
        let of = |information: &DMatrix<f64>| -> Result<f64, Error> {
            let covariance = invert(information.clone())?;
            let own = DMatrix::from_fn(c.len(), c.len(), |i, j| covariance[(places[i], places[j])]);
            let c = DVector::from_column_slice(c);
            Ok(c.dot(&(invert(own)? * &c)).max(0.0).sqrt())
        };
        let with = self.with.iter().map(|(design, information)| Ok((*design, of(information)?)));
        Ok((of(&self.now)?, with.collect::<Result<_, Error>>()?))
    }
}

/// The coefficients that belong to the parameters as they are reported, with a known bias taken off.
fn corrected(result: &Inference) -> Vec<f64> {
    let p = &result.parameters;
    let scale = p.perimeter_elasticity.value;
    let base =
        [p.area_elasticity.value, p.preferred_perimeter.value * scale, scale, p.chiral_coefficient.value];
    let mut all = result.coefficients.as_slice().to_vec();
    if base.iter().all(|c| c.is_finite()) {
        all[..base.len()].copy_from_slice(&base);
    }
    for (k, effect) in result.effects.iter().enumerate() {
        all[FitParameter::COEFFICIENTS + k] = effect.value;
    }
    all
}

#[cfg(test)]
mod tests;
