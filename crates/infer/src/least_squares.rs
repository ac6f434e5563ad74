//! The linear part: coefficients at fixed positions.

use crate::normal_matrix::{invert, within_bounds};
use crate::objective::Nudged;
use crate::residuals::{Columns, combined, free_rows, residuals};
use crate::{CoefficientSpace, Error, Observation};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;
use voronudge_model::Structure;

/// Gauss–Newton steps of a naive fit where velocities are not linear in the coefficients.
const STEPS: usize = 4;

/// Least squares at the measured positions within bounds: the naive fit. Returns β.
pub(crate) fn fit(
    frames: &[Observation],
    structure: &Structure,
    space: &CoefficientSpace,
) -> Result<Vec<f64>, Error> {
    let measured: Vec<_> = frames.iter().map(|frame| Nudged::as_measured(frame, structure)).collect();
    fit_at(frames, &measured, structure, space)
}

/// The same with the frames at some positions.
pub(crate) fn fit_at(
    frames: &[Observation],
    placed: &[Nudged<'_>],
    structure: &Structure,
    space: &CoefficientSpace,
) -> Result<Vec<f64>, Error> {
    let terms = structure.terms.len();
    // What acts on the velocities of the terms has no column before they have coefficients.
    let linear = space.with_coefficients(terms);
    let zero = vec![0.0; structure.dimension()];
    let of_frame = |(frame, placed): (&Observation, &Nudged<'_>), space: &CoefficientSpace, at: &[f64]| {
        let evaluated = placed.evaluate(at);
        let known = DVector::from_column_slice(at) - space.with_coefficients(at.len()).origin();
        normal_equations(frame, &evaluated.predicted, &evaluated.by_coefficient, space, known.as_slice())
    };
    let pairs = || frames.iter().zip(placed);
    let mut free = solve(&linear, pairs().map(|pair| Ok(of_frame(pair, &linear, &zero))))?;
    if terms < structure.dimension() {
        free.resize(space.dimension(), 0.0);
        for _ in 0..STEPS {
            let at = space.coefficients(&free);
            free = solve(space, pairs().map(|pair| Ok(of_frame(pair, space, at.as_slice()))))?;
        }
    }
    Ok(free)
}

/// The β within bounds that solves the normal equations of all frames together.
fn solve(
    space: &CoefficientSpace,
    frames: impl Iterator<Item = Result<(DMatrix<f64>, DVector<f64>), Error>>,
) -> Result<Vec<f64>, Error> {
    let p = space.dimension();
    let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
    for frame in frames {
        let (own, part) = frame?;
        normal += own;
        right += part;
    }
    let free = invert(normal.clone())? * right;
    within_bounds(space, free, normal).map(|beta| beta.as_slice().to_vec())
}

/// XᵀX and Xᵀ(v − F + X (c − c₀)) of one frame, with the prediction F, its derivatives by the coefficients, and the
/// coefficients at which they hold, relative to the origin of the space.
fn normal_equations(
    frame: &Observation,
    predicted: &[Vector<f64>],
    by_coefficient: &Columns,
    space: &CoefficientSpace,
    known: &[f64],
) -> (DMatrix<f64>, DVector<f64>) {
    let p = space.dimension();
    let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
    let base: Vec<Vector<f64>> =
        predicted.iter().enumerate().map(|(datum, f)| f - combined(by_coefficient, known, datum)).collect();
    let rows = free_rows(frame, by_coefficient, space);
    for (x, (_, rest)) in rows.iter().zip(residuals(frame, &base)) {
        normal += x.transpose() * x;
        right += x.transpose() * DVector::from_column_slice(rest.as_slice());
    }
    (normal, right)
}

/// What given coefficients leave unexplained at the measured positions: datum and residual, for each target.
pub(crate) fn residuals_as_measured(
    frame: &Observation,
    structure: &Structure,
    coefficients: &[f64],
) -> Vec<(usize, Vector<f64>)> {
    residuals(frame, &Nudged::as_measured(frame, structure).evaluate(coefficients).predicted)
}
