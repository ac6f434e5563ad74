//! What a velocity shares with the nudges that it pulls itself: G = J_i A⁻¹ J_iᵀ with A = wJᵀJ + kHᵀH.
//!
//! Entries of A⁻¹ fall off with distance. In large frames those of a patch come from A among the cells of the patch and some rings around it, the others held.

use crate::Error;
use crate::linearisation::Linearisation;
use crate::objective::{Linear, Patches};
use nalgebra::Matrix2;
use rayon::prelude::*;
use voronudge_linalg::SelectedInverse;
use voronudge_model::BlockMatrix;

/// Velocities to be looked at from which on it costs less to have the whole of A⁻¹ at once than a solution for each.
const MANY: usize = 64;

/// Rings around a patch.
const RINGS: usize = 8;

/// A frame about a fit.
pub(super) struct About<'a> {
    pub linear: &'a Linear<'a>,
    /// J, without the weights of velocities.
    pub jacobian: &'a BlockMatrix,
    pub nudges: &'a [f64],
    /// k
    pub spring: f64,
}

impl About<'_> {
    /// G of some velocities.
    pub fn leverages(&self, data: &[usize]) -> Result<Vec<Matrix2<f64>>, Error> {
        match Patches::of(self.linear.frame) {
            Some(patches) => self.in_patches(&patches, data, RINGS),
            None => leverages(&self.linear.whole(self.nudges), self.spring, self.jacobian, data),
        }
    }

    /// The same from patches with so many rings around each.
    fn in_patches(
        &self,
        patches: &Patches,
        data: &[usize],
        rings: usize,
    ) -> Result<Vec<Matrix2<f64>>, Error> {
        let of_patch = |patch: usize| {
            let own: Vec<usize> = (0..data.len()).filter(|k| patches.patch(data[*k]) == patch).collect();
            let free = patches.with_rings(patch, &self.linear.frame.tessellation, rings);
            let jacobian = free.columns_of(self.jacobian);
            let linear = self.linear.around(&free, self.nudges);
            let asked: Vec<usize> = own.iter().map(|k| data[*k]).collect();
            let found = leverages(&linear, self.spring, &jacobian, &asked)?;
            Ok(own.into_iter().zip(found).collect::<Vec<_>>())
        };
        let parts: Vec<Vec<(usize, Matrix2<f64>)>> =
            (0..patches.cells.len()).into_par_iter().map(of_patch).collect::<Result<_, Error>>()?;
        let mut all = vec![Matrix2::zeros(); data.len()];
        parts.into_iter().flatten().for_each(|(k, g)| all[k] = g);
        Ok(all)
    }
}

/// G of some velocities, with columns of their derivatives as the problem has them.
fn leverages(
    linear: &Linearisation,
    spring: f64,
    jacobian: &BlockMatrix,
    data: &[usize],
) -> Result<Vec<Matrix2<f64>>, Error> {
    let factor = linear.factor(spring)?;
    let inverse = if data.len() < MANY { None } else { Some(factor.selected_inverse()?) };
    let n = linear.order();
    let mut right = vec![0.0; 2 * n];
    let mut solved = |datum: usize| {
        right.fill(0.0);
        let (along_x, along_y) = right.split_at_mut(n);
        for (cell, b) in jacobian.row(datum) {
            along_x[2 * cell..2 * cell + 2].copy_from_slice(&b[..2]);
            along_y[2 * cell..2 * cell + 2].copy_from_slice(&b[2..]);
        }
        factor.solve(&mut right);
        let mut g = Matrix2::zeros();
        for (cell, b) in jacobian.row(datum) {
            for (column, solved) in right.chunks_exact(n).enumerate() {
                let [x, y] = [solved[2 * cell], solved[2 * cell + 1]];
                g[(0, column)] += b[0] * x + b[1] * y;
                g[(1, column)] += b[2] * x + b[3] * y;
            }
        }
        g
    };
    let of = |datum: &usize| {
        let known = inverse.as_ref().and_then(|inverse| of_entries(jacobian, *datum, inverse));
        known.unwrap_or_else(|| solved(*datum))
    };
    Ok(data.iter().map(of).collect())
}

/// G of a datum, where the inverse is known between all cells that it depends on.
fn of_entries(jacobian: &BlockMatrix, datum: usize, inverse: &SelectedInverse) -> Option<Matrix2<f64>> {
    let mut g = Matrix2::zeros();
    for (cell, b) in jacobian.row(datum) {
        for (other, c) in jacobian.row(datum) {
            for (axis, side) in (0..2).flat_map(|axis| (0..2).map(move |side| (axis, side))) {
                let entry = inverse.entry(2 * cell + axis, 2 * other + side)?;
                g += Matrix2::new(
                    b[axis] * c[side],
                    b[axis] * c[2 + side],
                    b[2 + axis] * c[side],
                    b[2 + axis] * c[2 + side],
                ) * entry;
            }
        }
    }
    Some(g)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placing::Placing;
    use crate::sample::with_objective;

    /// What is far away hardly counts.
    #[test]
    fn patches_with_rings_around_are_as_the_whole() {
        for share in [0.0, 0.8] {
            with_objective(40, share, |objective, at| {
                let placed = objective.placed_at(at).unwrap();
                let linear = &objective.linear(&placed, at, &[]).unwrap()[0];
                let (nudged, predicted) = &placed[0];
                let coefficients = objective.space.coefficients(&at[..4]);
                let jacobian = &nudged.jacobian(coefficients.as_slice(), &predicted.of_cells);
                let about = About { linear, jacobian, nudges: &at[4..], spring: objective.spring() };
                let data: Vec<usize> = (0..1600).step_by(3).collect();
                let whole = about.leverages(&data).unwrap();
                let patches = Patches::new(linear.frame, 100);
                assert_eq!(patches.cells.len(), 16);
                let off = |rings: usize| {
                    let found = about.in_patches(&patches, &data, rings).unwrap();
                    let pairs = found.iter().zip(&whole);
                    pairs.map(|(one, other)| (one - other).norm() / other.norm()).fold(0.0, f64::max)
                };
                assert!(off(RINGS) < 0.01 && off(2) > 0.05);
            });
        }
    }
}
