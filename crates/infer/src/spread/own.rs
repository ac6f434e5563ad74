//! What single cells do beyond what all cells do alike.

use super::columns::Layout;
use crate::{Error, Observation};
use nalgebra::DVector;
use std::sync::Arc;
use voronudge_model::{CellFactors, CellParameter, Environment};

/// The coefficient of the base model, in the order `K_A, K_P P_0, K_P, K_P α`, whose multiple a parameter of a cell is.
pub(super) fn coefficient(parameter: CellParameter) -> usize {
    match parameter {
        CellParameter::AreaElasticity | CellParameter::PreferredArea => 0,
        CellParameter::PreferredPerimeter => 1,
        CellParameter::Chirality => 3,
    }
}

/// Parts of the coefficients that single cells have: `c̄ u` of each, whatever the coefficient is.
#[derive(Debug)]
pub(crate) struct OwnParts<'a> {
    pub(super) layout: &'a Layout,
    pub(super) deviations: &'a DVector<f64>,
    /// c̄
    pub(super) reference: &'a DVector<f64>,
}

/// Surroundings of cells that differ from the mean by these shares of it.
///
/// # Errors
/// [`Error::Spread`] if one is not finite.
pub(crate) fn surroundings(
    around: &Environment,
    deviations: impl Iterator<Item = (CellParameter, Vec<f64>)>,
) -> Result<Arc<Environment>, Error> {
    let refused = |_| Error::Spread("parameters of cells are not finite");
    let mut factors = CellFactors::default();
    for (parameter, own) in deviations {
        let own = own.into_iter().map(|own| 1.0 + own).collect();
        factors = factors.with(parameter, own).map_err(refused)?;
    }
    Ok(Arc::new(around.clone().with_cell_factors(factors).map_err(refused)?))
}

impl OwnParts<'_> {
    /// The surroundings of the cells of a frame with their multiples of given coefficients.
    ///
    /// # Errors
    /// [`Error::Spread`] if a coefficient is nought.
    pub fn environment(
        &self,
        frame: usize,
        around: &Environment,
        coefficients: &[f64],
    ) -> Result<Arc<Environment>, Error> {
        let of_block = |(block, parameter): (usize, &CellParameter)| {
            let first = self.layout.block(block).start;
            let which = coefficient(*parameter);
            let ratio = self.reference[which] / coefficients[which];
            let own = self.layout.of_frames[frame].iter();
            (*parameter, own.map(|cell| ratio * self.deviations[first + cell]).collect())
        };
        surroundings(around, self.layout.parameters.iter().enumerate().map(of_block))
    }

    /// The frames with multiples 1 + u.
    pub fn frames(&self, frames: &[Observation]) -> Result<Vec<Observation>, Error> {
        let of_frame = |(index, frame): (usize, &Observation)| {
            let around = self.environment(index, frame.environment(), self.reference.as_slice())?;
            Ok(frame.clone().within(around))
        };
        frames.iter().enumerate().map(of_frame).collect()
    }
}
