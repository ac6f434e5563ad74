//! The linear part: coefficients at fixed positions.

use crate::objective::Nudged;
use crate::quadratic::Quadratic;
use crate::{CoefficientSpace, Error, Observation};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;
use voronudge_model::Structure;

/// Fields for cells or for grid points, one for each coefficient.
pub(crate) type Columns = Vec<Vec<Vector<f64>>>;

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

/// The point within the bounds of β where `(β − centre)ᵀ H (β − centre)` is least.
pub(crate) fn within_bounds(
    space: &CoefficientSpace,
    centre: DVector<f64>,
    hessian: DMatrix<f64>,
) -> Result<DVector<f64>, Error> {
    let bounds = space.half_spaces();
    if bounds.is_empty() {
        return Ok(centre);
    }
    let minimum = Quadratic::new(centre, &hessian)?.minimise(&bounds, None);
    minimum.map(|minimum| minimum.at).ok_or(Error::Constraint("no parameters lie within all bounds"))
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

/// Σ c_t X_t at one place.
pub(crate) fn combined(columns: &Columns, coefficients: &[f64], datum: usize) -> Vector<f64> {
    columns.iter().zip(coefficients).fold(Vector::zeros(), |sum, (column, c)| sum + column[datum] * *c)
}

/// What a prediction leaves unexplained: datum and residual, for each target.
pub(crate) fn residuals(frame: &Observation, predicted: &[Vector<f64>]) -> Vec<(usize, Vector<f64>)> {
    let mut rests: Vec<Vector<f64>> = frame.targets().map(|(datum, v)| v - predicted[datum]).collect();
    frame.remove_background(&mut rests);
    frame.targets().map(|(datum, _)| datum).zip(rests).collect()
}

/// The same for given coefficients at the measured positions.
pub(crate) fn residuals_as_measured(
    frame: &Observation,
    structure: &Structure,
    coefficients: &[f64],
) -> Vec<(usize, Vector<f64>)> {
    residuals(frame, &Nudged::as_measured(frame, structure).evaluate(coefficients).predicted)
}

/// `X B` (2, p) for each target.
pub(crate) fn free_rows(
    frame: &Observation,
    by_coefficient: &Columns,
    space: &CoefficientSpace,
) -> Vec<DMatrix<f64>> {
    let fields: Vec<Vec<Vector<f64>>> = (0..space.dimension())
        .map(|k| {
            let along = space.basis().column(k);
            let mut field: Vec<Vector<f64>> =
                frame.targets().map(|(datum, _)| combined(by_coefficient, along.as_slice(), datum)).collect();
            frame.remove_background(&mut field);
            field
        })
        .collect();
    let count = fields.first().map_or_else(|| frame.targets().count(), Vec::len);
    (0..count).map(|row| DMatrix::from_fn(2, fields.len(), |axis, k| fields[k][row][axis])).collect()
}

/// The inverse of a normal matrix, refused if its columns are dependent to rounding.
pub(crate) fn invert(normal: DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let scale: Vec<f64> = normal.diagonal().iter().map(|d| d.sqrt()).collect();
    if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return Err(Error::Degenerate);
    }
    let scaled = DMatrix::from_fn(scale.len(), scale.len(), |i, j| normal[(i, j)] / (scale[i] * scale[j]));
    let eigenvalues = scaled.clone().symmetric_eigen().eigenvalues;
    if eigenvalues.min() < 1e-12 {
        return Err(Error::Degenerate);
    }
    let inverse = scaled.cholesky().ok_or(Error::Degenerate)?.inverse();
    Ok(DMatrix::from_fn(scale.len(), scale.len(), |i, j| inverse[(i, j)] / (scale[i] * scale[j])))
}
