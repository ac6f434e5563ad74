//! What single cells do beyond what all cells do alike.

use crate::{Error, Observation, Velocities};
use nalgebra::DVector;
use std::collections::HashMap;
use std::sync::Arc;
use voronudge_model::{CellFactors, CellParameter, Environment};

/// Most unknown parameters of cells: the linear algebra is dense.
const LARGEST: usize = 4000;

/// Which unknown belongs to which cell: those of one parameter follow each other, one for each cell of the tissue.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    pub parameters: Vec<CellParameter>,
    /// Unknowns of one cell.
    pub blocks: usize,
    /// Number of cells of the tissue.
    pub cells: usize,
    /// Which of them the cells of each frame are.
    pub of_frames: Vec<Vec<usize>>,
}

impl Layout {
    /// Cells of one identity are the same in all frames; those without one are new in each.
    pub fn new(frames: &[Observation], parameters: &[CellParameter]) -> Result<Self, Error> {
        let mut known = HashMap::new();
        let mut cells = 0;
        let mut of_frames = Vec::with_capacity(frames.len());
        for frame in frames {
            if !matches!(frame.velocities, Velocities::OfCells(_)) {
                return Err(Error::Spread(
                    "cells that differ are told from velocities of cells, not from a flow field",
                ));
            }
            let mut next = || {
                cells += 1;
                cells - 1
            };
            let own = (0..frame.positions.len()).map(|cell| match frame.identity(cell) {
                Some(identity) => *known.entry(identity).or_insert_with(&mut next),
                None => next(),
            });
            of_frames.push(own.collect());
        }
        if cells * parameters.len() > LARGEST {
            return Err(Error::Spread("cells that differ are told of up to 4000 cells times parameters"));
        }
        Ok(Self { parameters: parameters.to_vec(), blocks: parameters.len(), cells, of_frames })
    }

    /// The two components of a smooth velocity that is another in each frame, with a centre at each cell.
    pub fn of_field(frames: &[Observation]) -> Self {
        let mut cells = 0;
        let of_frame = |frame: &Observation| {
            let first = cells;
            cells += frame.positions.len();
            (first..cells).collect()
        };
        let of_frames = frames.iter().map(of_frame).collect();
        Self { parameters: Vec::new(), blocks: 2, cells, of_frames }
    }

    /// Number of unknowns.
    pub fn order(&self) -> usize {
        self.blocks * self.cells
    }

    /// The unknowns of one parameter.
    pub fn block(&self, parameter: usize) -> std::ops::Range<usize> {
        parameter * self.cells..(parameter + 1) * self.cells
    }
}

/// The coefficient of the base model, in the order `K_A, K_P P_0, K_P, K_P α`, whose multiple a parameter of a cell is.
pub(crate) fn coefficient(parameter: CellParameter) -> usize {
    match parameter {
        CellParameter::AreaElasticity | CellParameter::PreferredArea => 0,
        CellParameter::PreferredPerimeter => 1,
        CellParameter::Chirality => 3,
    }
}

/// Parts of the coefficients that single cells have: `c̄ u` of each, whatever the coefficient is.
#[derive(Debug)]
pub(crate) struct OwnParts<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) deviations: &'a DVector<f64>,
    /// c̄
    pub(crate) reference: &'a DVector<f64>,
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
