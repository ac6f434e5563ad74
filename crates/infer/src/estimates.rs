//! From fitted coefficients and their information matrix to estimates and directions.

use crate::{CoefficientSpace, Direction, Estimate, Fixed, ParameterEstimates};
use nalgebra::{DMatrix, Matrix4, Vector4};

/// Parameters with standard errors, those of ratios to first order.
pub(crate) fn estimates(c: &Vector4<f64>, covariance: &Matrix4<f64>, fixed: &Fixed) -> ParameterEstimates {
    let error = |gradient: Vector4<f64>| (gradient.transpose() * covariance * gradient)[0].max(0.0).sqrt();
    let k_p = c[2];
    let ratio = |index: usize, fixed: Option<f64>| {
        let mut gradient = Vector4::zeros();
        gradient[index] = 1.0 / k_p;
        gradient[2] = -c[index] / (k_p * k_p);
        match fixed {
            Some(value) => Estimate { value, standard_error: 0.0 },
            None => Estimate { value: c[index] / k_p, standard_error: error(gradient) },
        }
    };
    let plain = |index: usize| Estimate { value: c[index], standard_error: error(Vector4::ith(index, 1.0)) };
    ParameterEstimates {
        area_elasticity: plain(0),
        perimeter_elasticity: plain(2),
        preferred_perimeter: ratio(1, fixed.preferred_perimeter),
        chirality: ratio(3, fixed.chirality),
        chiral_coefficient: plain(3),
    }
}

/// Eigenvectors of the information on β as directions in the space of coefficients, stiffest first.
pub(crate) fn directions(space: &CoefficientSpace, information: &DMatrix<f64>) -> Vec<Direction> {
    let eigen = information.clone().symmetric_eigen();
    let mut directions: Vec<Direction> = (0..information.nrows())
        .map(|k| {
            let along = space.basis() * eigen.eigenvectors.column(k);
            // The sign of an eigenvector is arbitrary: the largest component is positive.
            let sign = along[along.iamax()].signum() / along.norm();
            Direction {
                eigenvalue: eigen.eigenvalues[k],
                components: std::array::from_fn(|i| sign * along[i]),
            }
        })
        .collect();
    directions.sort_by(|a, b| b.eigenvalue.total_cmp(&a.eigenvalue));
    directions
}
