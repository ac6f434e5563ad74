//! What plane waves see of the Jacobian of a snapshot.

use crate::{Error, LinearProblem};
use voronudge_geometry::{Vector, dot, quarter_turn};
use voronudge_linalg::LinearSystem;

/// Shift that tells translations, at which the Jacobian is singular, from the waves; over the largest rate.
const SHIFT: f64 = 1e-11;

/// Takes the mean over cells out of a vector.
fn still(vector: &mut [f64]) {
    for axis in 0..2 {
        let mean = vector.iter().skip(axis).step_by(2).sum::<f64>() / (vector.len() / 2) as f64;
        vector.iter_mut().skip(axis).step_by(2).for_each(|x| *x -= mean);
    }
}

impl LinearProblem {
    /// Mean over wave vectors `q` (1/length) of
    ///
    /// ```text
    /// D_ab(q) = −Σ_ij w_i w_j exp(−iq·r_i) ê_a·J_ij·ê_b exp(iq·r_j) / Σ_i w_i²        real part
    /// ```
    ///
    /// in components along q and a quarter turn ahead (1/time), rows first. `weights` are those of [`cells`](Self::cells). So forces answer a wave that is put on all cells alike; on a
    /// honeycomb it is D(q), in disordered tissues cells go on to move otherwise, which [`relaxed`](Self::relaxed) has.
    pub fn projected(&self, waves: &[Vector<f64>], weights: &[f64]) -> [[f64; 2]; 2] {
        let order = 2 * self.places.len();
        let mut image = vec![0.0; order];
        let mean = self.mean(waves, weights, |parts| {
            for part in parts.chunks_exact_mut(order) {
                self.matrix.apply(part, &mut image);
                part.copy_from_slice(&image);
            }
        });
        mean.map(|row| row.map(|entry| -entry))
    }

    /// The inverse of the mean over wave vectors of the compliance `P (−J)⁻¹ P†`, with P as in [`projected`](Self::projected): by which rates waves of forces that last are answered, all
    /// cells having given way, but for what is common to all of them; all cells of a periodic box move.
    ///
    /// # Errors
    /// [`Error::LinearAlgebra`] if the Jacobian, or the compliance, is singular.
    pub fn relaxed(&self, waves: &[Vec<Vector<f64>>]) -> Result<Vec<[[f64; 2]; 2]>, Error> {
        let shift = SHIFT * self.largest_rate();
        let system = LinearSystem::new(&self.matrix, shift, &self.places)?;
        let (weights, order) = (vec![1.0; self.places.len()], 2 * self.places.len());
        let of_shell = |waves: &Vec<Vector<f64>>| {
            // What is common to all cells meets no resistance; waves on cells in disorder have a little of it.
            let [[a, b], [c, d]] = self.mean(waves, &weights, |parts| {
                parts.chunks_exact_mut(order).for_each(still);
                system.solve(parts);
                parts.chunks_exact_mut(order).for_each(still);
            });
            let determinant = a * d - b * c;
            // Of J − σ, whose inverse is that of −D.
            [[-d / determinant - shift, b / determinant], [c / determinant, -a / determinant - shift]]
        };
        Ok(waves.iter().map(of_shell).collect())
    }

    /// Mean over waves of the real part of `P A P†`; `apply` replaces columns by A times these.
    fn mean(
        &self,
        waves: &[Vector<f64>],
        weights: &[f64],
        mut apply: impl FnMut(&mut [f64]),
    ) -> [[f64; 2]; 2] {
        let order = 2 * self.places.len();
        let mass: f64 = weights.iter().map(|w| w * w).sum();
        let mut sums = [[0.0; 2]; 2];
        for q in waves {
            let along = *q / q.norm();
            let axes = [along, quarter_turn(along)];
            let phases: Vec<[f64; 2]> = (self.places.iter().zip(weights))
                .map(|([x, y], w)| {
                    let (sin, cos) = (q.x * x + q.y * y).sin_cos();
                    [w * cos, w * sin]
                })
                .collect();
            // Columns: cosine and sine of the wave along the one axis, then along the other.
            let mut columns = vec![0.0; 4 * order];
            for (column, own) in columns.chunks_exact_mut(order).enumerate() {
                for (phase, entry) in phases.iter().zip(own.chunks_exact_mut(2)) {
                    let displaced = axes[column / 2] * phase[column % 2];
                    entry.copy_from_slice(&[displaced.x, displaced.y]);
                }
            }
            apply(&mut columns);
            for (column, own) in columns.chunks_exact(order).enumerate() {
                for (phase, entry) in phases.iter().zip(own.chunks_exact(2)) {
                    let answer = Vector::new(entry[0], entry[1]) * phase[column % 2];
                    for (a, axis) in axes.iter().enumerate() {
                        sums[a][column / 2] += dot(*axis, answer);
                    }
                }
            }
        }
        sums.map(|row| row.map(|sum| sum / mass / waves.len() as f64))
    }
}
