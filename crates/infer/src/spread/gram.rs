//! Products of the data, the coefficients' and the cells' columns with what errors of the positions leave of them.

use super::columns::FrameColumns;
use crate::Error;
use crate::normal_equations::NormalEquations;
use crate::normal_matrix::invert;
use crate::whitened::Whitened;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// `Aᵀ W⁻¹ B` between X, Z and y at one spring k, W = I + JJᵀ/k, summed over frames.
pub(super) struct Gram {
    /// log k
    pub log_k: f64,
    /// ZᵀW⁻¹Z
    pub of_cells: DMatrix<f64>,
    /// ZᵀW⁻¹X
    pub mixed: DMatrix<f64>,
    /// ZᵀW⁻¹y for y without what the cells do at present.
    pub gradient: DVector<f64>,
    /// (JᵀJ + kHᵀH)⁻¹JᵀZ of each frame
    pub solved: Vec<DMatrix<f64>>,
    /// The same products after the coefficients are eliminated, with y whole.
    pub reduced: Projected,
}

/// `Aᵀ P B` with P = W⁻¹ − W⁻¹X (XᵀW⁻¹X)⁻¹ XᵀW⁻¹.
pub(super) struct Projected {
    /// ZᵀPZ
    pub of_cells: DMatrix<f64>,
    /// ZᵀPy
    pub data: DVector<f64>,
    /// yᵀPy
    pub misfit: f64,
    /// log det W + log det XᵀW⁻¹X
    pub log_determinant: f64,
}

impl Gram {
    /// The products at one spring, with the cells' unknowns u at which the problem is linearised.
    pub fn new(
        equations: &NormalEquations,
        columns: &[FrameColumns],
        log_k: f64,
        present: &DVector<f64>,
    ) -> Result<Self, Error> {
        let spring = log_k.exp();
        let p = equations.dimension();
        let parts = equations.frames.par_iter().zip(columns).map(|(frame, own)| {
            let factor = frame.factor(spring)?;
            let mut solved = own.coupled.clone();
            factor.solve(solved.as_mut_slice());
            let mixed = DMatrix::from_vec(frame.order(), p + 1, frame.mixed(spring));
            let of_cells = own.of_cells.tr_mul(&own.of_cells) - own.coupled.tr_mul(&solved);
            let with_free = own.of_cells.tr_mul(&own.free) - solved.tr_mul(&mixed.columns(0, p));
            let with_data = own.of_cells.tr_mul(&own.data) - solved.tr_mul(&mixed.column(p));
            Ok((of_cells, with_free, with_data, solved, frame.whiten(spring)?))
        });
        let parts = parts.collect::<Result<Vec<_>, Error>>()?;
        let m = present.len();
        let (mut of_cells, mut mixed) = (DMatrix::zeros(m, m), DMatrix::zeros(m, p));
        let (mut gradient, mut solved, mut whitened) = (DVector::zeros(m), Vec::new(), Vec::new());
        for (cells, with_free, with_data, own, part) in parts {
            of_cells += cells;
            mixed += with_free;
            gradient += with_data;
            solved.push(own);
            whitened.push(part);
        }
        let mut whole = Whitened::sum(&whitened, p);
        let moved = &of_cells * present;
        let data = &gradient + &moved;
        whole.data += 2.0 * gradient.dot(present) + moved.dot(present);
        whole.mixed += mixed.tr_mul(present);
        let inverse = invert(whole.free.clone())?;
        let leftover = whole.restricted()?;
        let explained = &mixed * inverse;
        let reduced = Projected {
            of_cells: &of_cells - &explained * mixed.transpose(),
            data: data - explained * &whole.mixed,
            misfit: leftover.misfit,
            log_determinant: leftover.log_determinant,
        };
        Ok(Self { log_k, of_cells, mixed, gradient, solved, reduced })
    }
}
