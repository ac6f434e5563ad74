//! The first coefficients of a movie, from where the cells were seen alone.

use super::objective::MovieObjective;
use crate::Error;
use crate::least_squares::{invert, within_bounds};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;

/// Gauss–Newton steps of the first coefficients by the trapezoid rule, which are linear but for responses.
const LINEAR_STEPS: usize = 4;

/// Gauss–Newton steps of the first coefficients by following the cells; how often one that does not help is halved.
const FORWARD_STEPS: usize = 12;
const HALVINGS: usize = 6;

/// Relative decrease of the sum of squares that counts as none there.
const FORWARD_TOLERANCE: f64 = 1e-3;

/// The coefficients by regression of the displacements on the mean of the forces at both ends.
pub(super) fn naive_coefficients(objective: &MovieObjective<'_>) -> Result<Vec<f64>, Error> {
    let mut free = DVector::zeros(objective.space.dimension());
    for _ in 0..LINEAR_STEPS {
        let at = objective.start(free.as_slice());
        let placed = objective.place(&at)?;
        let rests = objective.residuals(&placed, &at);
        let columns = objective.columns_of_trapezoid(&objective.states.motions, &placed);
        free = newton(objective, &free, &columns, &rests)?;
    }
    Ok(free.as_slice().to_vec())
}

/// The coefficients that follow the cells best from where they were seen in one frame to where they were seen in the next.
pub(super) fn forward_coefficients(objective: &MovieObjective<'_>, first: &[f64]) -> Result<Vec<f64>, Error> {
    let rests = |free: &[f64]| -> Result<_, Error> {
        let at = objective.start(free);
        let placed = objective.place(&at)?;
        let rests = objective.residuals(&placed, &at);
        let sum: f64 = rests.iter().map(|rest| rest.norm_squared()).sum();
        Ok((placed, rests, if sum.is_nan() { f64::INFINITY } else { sum }))
    };
    let mut free = DVector::from_column_slice(first);
    let mut known = rests(first)?;
    for _ in 0..FORWARD_STEPS {
        let (placed, before, sum) = &known;
        if sum.is_infinite() {
            break;
        }
        let coefficients = objective.space.coefficients(free.as_slice());
        let columns = objective.columns_of_passages(placed, coefficients.as_slice());
        let step = newton(objective, &free, &columns, before)? - &free;
        let shorter = (0..HALVINGS).map(|halving| &free + &step * 0.5_f64.powi(halving as i32));
        let tried = shorter.map(|next| Ok((rests(next.as_slice())?, next)));
        let better = tried.filter_map(|tried: Result<_, Error>| tried.ok()).find(|(next, _)| next.2 < *sum);
        let Some((next, at)) = better else { break };
        let is_settled = next.2 > (1.0 - FORWARD_TOLERANCE) * sum;
        (known, free) = (next, at);
        if is_settled {
            break;
        }
    }
    Ok(free.as_slice().to_vec())
}

/// Where one step of Gauss and Newton leads from some coefficients, within their bounds.
fn newton(
    objective: &MovieObjective<'_>,
    free: &DVector<f64>,
    columns: &[DMatrix<f64>],
    rests: &[Vector<f64>],
) -> Result<DVector<f64>, Error> {
    let (mut normal, mut right) = (DMatrix::zeros(free.len(), free.len()), DVector::zeros(free.len()));
    for (x, rest) in columns.iter().zip(rests) {
        normal += x.transpose() * x;
        right += x.transpose() * rest;
    }
    let step = invert(normal.clone())? * right;
    within_bounds(objective.space, free + step, normal)
}
