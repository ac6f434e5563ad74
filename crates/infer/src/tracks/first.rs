//! The first coefficients of a movie, from where the cells were seen alone.

use super::objective::MovieObjective;
use crate::Error;
use crate::normal_matrix::{invert, within_bounds};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;

/// Gauss–Newton steps of the first coefficients by the trapezoid rule, which are linear but for responses.
const LINEAR_STEPS: usize = 4;

/// Gauss–Newton steps of the first coefficients by following the cells; how often one that does not help is halved.
const FORWARD_STEPS: usize = 12;
const HALVINGS: usize = 6;

/// How many times the usual size the derivatives of a motion may have there.
const WILD: f64 = 30.0;

/// Relative decrease of the sum of squares that counts as none there.
const FORWARD_TOLERANCE: f64 = 1e-3;

/// The coefficients by regression of the displacements on the mean of the forces at both ends.
pub(super) fn naive_coefficients(objective: &MovieObjective<'_>) -> Result<Vec<f64>, Error> {
    let mut free = DVector::zeros(objective.space.dimension());
    for _ in 0..LINEAR_STEPS {
        let at = objective.start(free.as_slice());
        let placed = objective.displaced(&at)?;
        let rests = objective.residuals(&placed, &at);
        let columns = objective.columns_of_trapezoid(&objective.states.motions, &placed);
        free = newton(objective, &free, columns.iter().zip(&rests))?;
    }
    Ok(free.as_slice().to_vec())
}

/// The coefficients that follow the cells best from where they were seen in one frame to where they were seen in the next.
pub(super) fn forward_coefficients(objective: &MovieObjective<'_>, first: &[f64]) -> Result<Vec<f64>, Error> {
    let rests = |free: &[f64]| -> Result<_, Error> {
        let at = objective.start(free);
        let placed = objective.displaced(&at)?;
        let rests = objective.residuals(&placed, &at);
        Ok((placed, rests))
    };
    let mut free = DVector::from_column_slice(first);
    let mut known = rests(first)?;
    for _ in 0..FORWARD_STEPS {
        let (placed, before) = &known;
        let coefficients = objective.space.coefficients(free.as_slice());
        let columns = objective.columns_of_passages(placed, coefficients.as_slice());
        let tame = tame(&columns);
        let square = |rests: &[Vector<f64>]| -> f64 {
            let sum: f64 =
                rests.iter().zip(&tame).filter(|(_, tame)| **tame).map(|(r, _)| r.norm_squared()).sum();
            if sum.is_nan() { f64::INFINITY } else { sum }
        };
        let sum = square(before);
        if sum.is_infinite() {
            break;
        }
        let rows = columns.iter().zip(before).zip(&tame).filter(|(_, tame)| **tame).map(|(row, _)| row);
        let step = newton(objective, &free, rows)? - &free;
        let shorter = (0..HALVINGS).map(|halving| &free + &step * 0.5_f64.powi(halving as i32));
        let tried = shorter.filter_map(|next| Some((rests(next.as_slice()).ok()?, next)));
        let summed = tried.map(|(next, at)| (square(&next.1), next, at));
        let Some((after, next, at)) = summed.into_iter().find(|(after, ..)| *after < sum) else { break };
        (known, free) = (next, at);
        if after > (1.0 - FORWARD_TOLERANCE) * sum {
            break;
        }
    }
    Ok(free.as_slice().to_vec())
}

/// Which motions do not depend on the coefficients much more than others: cells nearly upon each other, or with a polygon that is hardly
/// closed, would decide alone.
fn tame(columns: &[DMatrix<f64>]) -> Vec<bool> {
    let sizes: Vec<f64> = columns.iter().map(DMatrix::norm_squared).collect();
    let mut ordered: Vec<f64> = sizes.iter().copied().filter(|size| size.is_finite()).collect();
    ordered.sort_unstable_by(f64::total_cmp);
    let most = WILD * WILD * ordered.get(ordered.len() / 2).copied().unwrap_or(0.0);
    sizes.into_iter().map(|size| size <= most).collect()
}

/// Where one step of Gauss and Newton leads from some coefficients, within their bounds.
fn newton<'r>(
    objective: &MovieObjective<'_>,
    free: &DVector<f64>,
    rows: impl Iterator<Item = (&'r DMatrix<f64>, &'r Vector<f64>)>,
) -> Result<DVector<f64>, Error> {
    let (mut normal, mut right) = (DMatrix::zeros(free.len(), free.len()), DVector::zeros(free.len()));
    for (x, rest) in rows {
        normal += x.transpose() * x;
        right += x.transpose() * rest;
    }
    let step = invert(normal.clone())? * right;
    within_bounds(objective.space, free + step, normal)
}
