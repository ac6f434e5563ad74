//! Linearised data of one kind: rows of residuals with their derivatives, and their products.

use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;
use voronudge_linalg::SymmetricMatrix;
use voronudge_model::BlockMatrix;

/// Residuals of one kind with their derivatives: by the coordinates, a block column for each place, and by the free
/// coefficients.
pub(crate) struct Rows<'a> {
    /// ∂F/∂ε; only the rows of `rows` matter.
    pub jacobian: &'a BlockMatrix,
    /// Row of the Jacobian, residual r, and the derivative by the free coefficients (2, p).
    pub rows: &'a [(usize, Vector<f64>, DMatrix<f64>)],
}

/// `y = r + Jε` of one datum.
pub(crate) fn linearised_back(
    jacobian: &BlockMatrix,
    (datum, residual): (usize, Vector<f64>),
    nudges: &[f64],
) -> Vector<f64> {
    jacobian.row(datum).fold(residual, |y, (column, b)| {
        let (ex, ey) = (nudges[2 * column], nudges[2 * column + 1]);
        y + Vector::new(b[0] * ex + b[1] * ey, b[2] * ex + b[3] * ey)
    })
}

/// Products of rows.
#[derive(Debug)]
pub(crate) struct Group {
    /// JᵀJ
    pub normal: SymmetricMatrix,
    /// JᵀX (n × p, by columns), then Jᵀy as the last column.
    pub mixed: Vec<f64>,
    /// Jᵀr
    pub gradient: Vec<f64>,
    /// XᵀX
    pub free_normal: DMatrix<f64>,
    /// Xᵀr
    pub free_gradient: DVector<f64>,
    /// Xᵀy
    pub free_data: DVector<f64>,
    /// yᵀy
    pub data: f64,
    /// Number of components of r.
    pub components: usize,
}

impl Group {
    /// The products of rows whose JᵀJ is known, about the nudges ε, for p free coefficients.
    pub fn new(rows: &Rows<'_>, normal: SymmetricMatrix, nudges: &[f64], p: usize) -> Self {
        let n = normal.order();
        let mut group = Self {
            normal,
            mixed: vec![0.0; n * (p + 1)],
            gradient: vec![0.0; n],
            free_normal: DMatrix::zeros(p, p),
            free_gradient: DVector::zeros(p),
            free_data: DVector::zeros(p),
            data: 0.0,
            components: 2 * rows.rows.len(),
        };
        for (datum, residual, x) in rows.rows {
            let y = linearised_back(rows.jacobian, (*datum, *residual), nudges);
            group.data += y.norm_squared();
            group.free_normal += x.transpose() * x;
            group.free_gradient += x.transpose() * DVector::from_column_slice(residual.as_slice());
            group.free_data += x.transpose() * DVector::from_column_slice(y.as_slice());
            for (column, b) in rows.jacobian.row(*datum) {
                let transposed = |v: Vector<f64>| [b[0] * v.x + b[2] * v.y, b[1] * v.x + b[3] * v.y];
                let add = |to: &mut [f64], v: Vector<f64>| {
                    to.iter_mut().zip(transposed(v)).for_each(|(sum, part)| *sum += part);
                };
                for k in 0..p {
                    let at = k * n + 2 * column;
                    add(&mut group.mixed[at..at + 2], Vector::new(x[(0, k)], x[(1, k)]));
                }
                let at = p * n + 2 * column;
                add(&mut group.mixed[at..at + 2], y);
                add(&mut group.gradient[2 * column..2 * column + 2], *residual);
            }
        }
        group
    }
}
