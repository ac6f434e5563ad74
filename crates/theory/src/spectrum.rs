//! Eigenvalues of the dynamical matrix, and where they coalesce.

use crate::{Error, MeanField, Orientation};

/// An eigenvalue λ of `D`: a mode behaves as `exp(−λ t)`, so the real part is its decay rate (negative if it grows) and
/// the imaginary part its frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eigenvalue {
    /// Decay rate, in units of `K_P` if that is 1.
    pub real: f64,
    /// Angular frequency: that of an odd elastic wave, zero if the mode does not oscillate.
    pub imaginary: f64,
}

impl MeanField {
    /// The two eigenvalues of `D(q)`, `λ = ½ tr D ± √Δ` with `Δ = ¼ (D_xx − D_yy)² + D_xy D_yx`.
    ///
    /// The slower decay comes first; of a complex pair the one with the positive frequency. `tr D` does not depend on α,
    /// so chirality alone changes no decay rate of a mode that oscillates. Derivation: `docs/mean-field.md`,
    /// "Eigenvalues".
    ///
    /// # Errors
    /// [`Error::WaveVector`] if `q` (1/ℓ_0) is not finite.
    pub fn decay_rates(&self, q: [f64; 2], orientation: Orientation) -> Result<[Eigenvalue; 2], Error> {
        Ok(eigenvalues(self.dynamical_matrix(q, orientation)?))
    }

    /// The chiralities at which the two modes at `q` coalesce (exceptional points), the lower one first; `None` if there
    /// are none, or if all of them do (at Γ).
    ///
    /// `D` is linear in α, so `Δ = Δ_0 + Δ_1 α + Δ_2 α²` and the exceptional points are the roots. Modes oscillate where
    /// Δ < 0. The chirality of these parameters plays no part. At q* the roots are `±(P_MF − P_0)/(√3 P_MF)`; where the
    /// modes of α = 0 are degenerate, as at K, both are zero and any chirality makes waves. Derivation:
    /// `docs/mean-field.md`, "Exceptional points".
    ///
    /// # Errors
    /// [`Error::WaveVector`] if `q` (1/ℓ_0) is not finite.
    pub fn exceptional_chiralities(
        &self,
        q: [f64; 2],
        orientation: Orientation,
    ) -> Result<Option<[f64; 2]>, Error> {
        let achiral = self.with_chirality(0.0).dynamical_matrix(q, orientation)?;
        let with_one = self.with_chirality(1.0).dynamical_matrix_at(q, orientation);
        let slope = |i: usize, j: usize| with_one[i][j] - achiral[i][j];
        let (h, h_1) = (0.5 * (achiral[0][0] - achiral[1][1]), 0.5 * (slope(0, 0) - slope(1, 1)));
        let zeroth = h * h + achiral[0][1] * achiral[1][0];
        let first = 2.0 * h * h_1 + achiral[0][1] * slope(1, 0) + slope(0, 1) * achiral[1][0];
        let second = h_1 * h_1 + slope(0, 1) * slope(1, 0);
        Ok(roots(zeroth, first, second))
    }
}

/// Eigenvalues of a real 2 × 2 matrix.
pub(crate) fn eigenvalues(matrix: [[f64; 2]; 2]) -> [Eigenvalue; 2] {
    let [[xx, xy], [yx, yy]] = matrix;
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let discriminant = half * half + xy * yx;
    let root = discriminant.abs().sqrt();
    if discriminant >= 0.0 {
        [mean - root, mean + root].map(|real| Eigenvalue { real, imaginary: 0.0 })
    } else {
        [root, -root].map(|imaginary| Eigenvalue { real: mean, imaginary })
    }
}

/// Real roots of `c + b x + a x²`, sorted, without cancellation; `None` if there are not two.
pub(crate) fn roots(c: f64, b: f64, a: f64) -> Option<[f64; 2]> {
    let discriminant = b * b - 4.0 * a * c;
    if a == 0.0 || discriminant < 0.0 {
        return None;
    }
    let sum = -0.5 * (b + discriminant.sqrt().copysign(b));
    let pair = if sum == 0.0 { [0.0, 0.0] } else { [sum / a, c / sum] };
    Some([pair[0].min(pair[1]), pair[0].max(pair[1])])
}
