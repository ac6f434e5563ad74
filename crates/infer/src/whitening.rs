//! Residuals without the correlations that errors of the positions make.

use crate::objective::{Nudged, Objective};
use crate::position_rows::PositionRows;
use crate::residuals::residuals;
use crate::rows::linearised_back;
use crate::uncertainty::nudges;
use crate::{Error, Inference, Observation, Request};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// Most dimensions of the Krylov space.
const DIMENSIONS: usize = 160;

/// Stiffness, relative to that of a measured position, of cells that were not seen: soft enough for their positions to explain
/// what they can.
const SOFTEST: f64 = 1e-6;

/// Change of the result, relative to its size, that ends the iteration.
const TOLERANCE: f64 = 1e-9;

/// The residuals of a fit, one list for each frame in the order of the targets: linearised back to the measured positions and
/// freed from the correlations that their errors make.
///
/// # Errors
/// [`Error`] if a frame cannot be tessellated.
pub(crate) fn whitened_residuals(
    frames: &[Observation],
    request: &Request,
    inference: &Inference,
) -> Result<Vec<Vec<Vector<f64>>>, Error> {
    let space = request.space()?;
    let levels = inference.noise;
    let objective = Objective::new(frames, &request.structure, &space, levels);
    let coefficients = inference.coefficients.as_slice();
    let mut fields = Vec::with_capacity(frames.len());
    for (index, nudges) in nudges(frames, inference).iter().enumerate() {
        let placed = objective.displaced(index, nudges)?;
        let evaluated = placed.evaluate(coefficients);
        let jacobian = placed.jacobian(coefficients, &evaluated.of_cells);
        let off = misplacements(&frames[index], &placed, nudges);
        let (rows, y): (Vec<usize>, Vec<Vector<f64>>) = residuals(&frames[index], &evaluated.predicted)
            .into_iter()
            .map(|own| (own.0, linearised_back(&jacobian, own, &off)))
            .unzip();
        let springs: Vec<f64> = (0..frames[index].positions.len())
            .map(|cell| objective.spring() * frames[index].stiffness(cell).max(SOFTEST))
            .collect();
        fields.push(whitened(&jacobian, &springs, &rows, &y, levels.velocity));
    }
    Ok(fields)
}

/// By how much the places where cells would be seen are off from where they were seen, x and y of one cell after the other: the nudges, for
/// cells seen at their sites or not at all. Sites of cells that were seen at their centroids are off by about as much.
fn misplacements(frame: &Observation, placed: &Nudged<'_>, nudges: &[f64]) -> Vec<f64> {
    let rows = PositionRows::new(frame, &placed.tessellation, &placed.positions, nudges, 0, None);
    let mut off = nudges.to_vec();
    for (cell, rest, _) in rows.rows().rows {
        let root = frame.stiffness(*cell).sqrt();
        if root > 0.0 {
            off[2 * cell] = -rest.x / root;
            off[2 * cell + 1] = -rest.y / root;
        }
    }
    off
}

/// `W^{−1/2} y / σ_v` with `W = I + J K⁻¹ Jᵀ`, by the Lanczos method: of unit variance and without correlations if y has the
/// covariance `σ_v² W`. K has the spring of each cell on its diagonal; `rows` are the rows of J that belong to y.
fn whitened(
    jacobian: &BlockMatrix,
    springs: &[f64],
    rows: &[usize],
    y: &[Vector<f64>],
    velocity_noise: f64,
) -> Vec<Vector<f64>> {
    let apply = |x: &DVector<f64>| {
        let mut transposed = vec![0.0; 2 * springs.len()];
        for (k, row) in rows.iter().enumerate() {
            let (u, w) = (x[2 * k], x[2 * k + 1]);
            for (column, b) in jacobian.row(*row) {
                transposed[2 * column] += b[0] * u + b[2] * w;
                transposed[2 * column + 1] += b[1] * u + b[3] * w;
            }
        }
        let mut result = x.clone();
        for (k, row) in rows.iter().enumerate() {
            for (column, b) in jacobian.row(*row) {
                let (u, w) = (transposed[2 * column], transposed[2 * column + 1]);
                result[2 * k] += (b[0] * u + b[1] * w) / springs[column];
                result[2 * k + 1] += (b[2] * u + b[3] * w) / springs[column];
            }
        }
        result
    };
    let start = DVector::from_iterator(2 * y.len(), y.iter().flat_map(|v| [v.x, v.y]));
    let root = inverse_root(apply, &start) / velocity_noise;
    root.as_slice().chunks_exact(2).map(|v| Vector::new(v[0], v[1])).collect()
}

/// `A^{−1/2} b` for a symmetric operator A whose eigenvalues are one or more.
fn inverse_root(apply: impl Fn(&DVector<f64>) -> DVector<f64>, b: &DVector<f64>) -> DVector<f64> {
    let size = b.norm();
    if size <= 0.0 {
        return b.clone();
    }
    let (mut basis, mut diagonal, mut beside) = (vec![b / size], Vec::new(), Vec::<f64>::new());
    let mut previous: Option<DVector<f64>> = None;
    let most = DIMENSIONS.min(b.len());
    loop {
        let m = basis.len();
        let mut next = apply(&basis[m - 1]);
        diagonal.push(next.dot(&basis[m - 1]));
        // Twice, because once leaves rounding behind.
        for _ in 0..2 {
            for q in &basis {
                let amount = q.dot(&next);
                next.axpy(-amount, q, 1.0);
            }
        }
        let norm = next.norm();
        let ended = m == most || norm <= 1e-12 * diagonal[0].abs();
        if ended || m % 8 == 0 {
            let mut small = DMatrix::from_diagonal(&DVector::from_column_slice(&diagonal));
            for (k, entry) in beside.iter().enumerate() {
                small[(k, k + 1)] = *entry;
                small[(k + 1, k)] = *entry;
            }
            let eigen = small.symmetric_eigen();
            let first = eigen.eigenvectors.row(0).transpose();
            let weights = first.zip_map(&eigen.eigenvalues, |v, e| v / e.max(1.0).sqrt());
            let coordinates = &eigen.eigenvectors * weights * size;
            let change = previous.as_ref().map_or(f64::INFINITY, |old: &DVector<f64>| {
                let old = old.clone().resize_vertically(m, 0.0);
                (&coordinates - old).norm()
            });
            if ended || change <= TOLERANCE * coordinates.norm() {
                return basis
                    .iter()
                    .zip(coordinates.iter())
                    .fold(DVector::zeros(b.len()), |sum, (q, c)| sum + q * *c);
            }
            previous = Some(coordinates);
        }
        beside.push(norm);
        basis.push(next / norm);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_is_that_of_the_dense_matrix() {
        let n = 24;
        let j = DMatrix::from_fn(n, n, |i, k| ((i * 7 + k * 3) as f64).sin() * 3.0);
        let w = DMatrix::identity(n, n) + &j * j.transpose();
        let b = DVector::from_fn(n, |i, _| (i as f64).cos());
        let eigen = w.clone().symmetric_eigen();
        let expected = &eigen.eigenvectors
            * DMatrix::from_diagonal(&eigen.eigenvalues.map(|e| 1.0 / e.sqrt()))
            * eigen.eigenvectors.transpose()
            * &b;
        let found = inverse_root(|x| &w * x, &b);
        assert!((found - &expected).norm() < 1e-8 * expected.norm());
    }
}
