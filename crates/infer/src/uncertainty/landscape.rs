//! Slices of the loss landscape over two parameters.

use super::{Point, with};
use crate::objective::{Nudged, Objective};
use crate::position_rows;
use crate::residuals::residuals;
use crate::search::Watch;
use crate::{Error, FitParameter, Inference, Observation, Progress, Request};
use nalgebra::DVector;
use std::ops::ControlFlow;

/// The rise of −2 log likelihood over two parameters, with the nudges as they are and with everything fitted again.
#[derive(Debug, Clone, PartialEq)]
pub struct Landscape {
    /// Parameters along x and y.
    pub quantities: [FitParameter; 2],
    /// Their values, ascending.
    pub values: [Vec<f64>; 2],
    /// With nudges and other parameters as fitted: the paper's slices. Row by row, rows along y.
    pub fixed: Vec<f64>,
    /// With nudges and other parameters fitted anew at every point.
    pub refitted: Vec<f64>,
}

/// Both slices at `points` × `points` values around a fit's estimates, the noise levels kept.
///
/// # Errors
/// [`Error::Constraint`] if one of the parameters is held or both are the same; [`Error::Interrupted`].
pub fn landscape(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
    quantities: [FitParameter; 2],
    points: usize,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Landscape, Error> {
    let [x, y] = quantities;
    if x == y {
        return Err(Error::Constraint("a landscape needs two different parameters"));
    }
    let point = Point::new(frames, request, result)?;
    let values = [point.range(x, points)?, point.range(y, points)?];
    let places: Vec<[f64; 2]> = values[1].iter().flat_map(|y| values[0].iter().map(|x| [*x, *y])).collect();
    let mut watch = Watch { observe };
    let refitted =
        watch.each("landscape", &places, point.level(), |at| point.refitted(&[(x, at[0]), (y, at[1])]))?;
    let slice = Slice::new(&point)?;
    // K_P first: the ratios are kept when it changes.
    let order = if y == FitParameter::PerimeterElasticity { [1, 0] } else { [0, 1] };
    let fixed: Vec<f64> = places
        .iter()
        .map(|at| order.iter().fold(result.coefficients.clone(), |c, k| with(&c, quantities[*k], at[*k])))
        .map(|c| slice.height(&c))
        .collect();
    let best = result.objective / result.excess();
    let rise = |heights: Vec<f64>| {
        let least = heights.iter().copied().fold(best, f64::min);
        heights.into_iter().map(|h| h - least).collect()
    };
    Ok(Landscape { quantities, values, fixed: rise(fixed), refitted: rise(refitted) })
}

/// The frames at their nudged positions, where the velocities are linear in the coefficients.
struct Slice<'a> {
    objective: Objective<'a>,
    nudged: Vec<Nudged<'a>>,
    /// k Σ‖ε‖²
    springs: f64,
    unit: f64,
}

impl<'a> Slice<'a> {
    fn new(point: &'a Point<'a>) -> Result<Self, Error> {
        let objective = point.objective(&point.space);
        let mut rest = point.nudges.as_slice();
        let (mut nudged, mut squares) = (Vec::with_capacity(point.frames.len()), 0.0);
        for (index, frame) in point.frames.iter().enumerate() {
            let (own, after) = rest.split_at(2 * frame.positions.len());
            rest = after;
            let placed = objective.displaced(index, own)?;
            squares +=
                position_rows::squares(frame, &placed.tessellation, &placed.positions, own).sum::<f64>();
            nudged.push(placed);
        }
        let springs = objective.spring() * squares;
        Ok(Self { objective, nudged, springs, unit: point.unit })
    }

    fn height(&self, c: &DVector<f64>) -> f64 {
        let frames = self.objective.frames.iter().zip(&self.nudged);
        let residual: f64 = frames
            .flat_map(|(frame, nudged)| residuals(frame, &nudged.evaluate(c.as_slice()).predicted))
            .map(|(_, rest)| rest.norm_squared())
            .sum();
        (residual + self.springs + self.objective.prior_penalty(c)) * self.unit
    }
}
