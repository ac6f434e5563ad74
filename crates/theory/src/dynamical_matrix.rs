//! The dynamical matrix of the honeycomb at any wave vector.

use crate::{Error, MeanField, Orientation, Parameters, hexagon_perimeter, hexagon_side};

/// Directions within a sixth of a turn over which is averaged.
const DIRECTIONS: usize = 24;

impl MeanField {
    /// `D(q)` of `∂_t u = −D(q) u` for displacements `u exp(i q·r)` of the cell centres, rows and columns (x, y).
    ///
    /// With the neighbours `a_n` (n = 1, 2, 3), unit vectors `â_n` and `t_n = ẑ × â_n`,
    ///
    /// ```text
    /// D = K_P (P_MF − P_0) Λ + (K_P + ¾ K_A d²) C Cᵀ − α K_P [P_MF X + (ẑ × C) Cᵀ]
    ///
    /// Λ = 4/(3d) Σ_n t_n t_nᵀ (1 − cos q·a_n)                                     side lengths, transverse springs
    /// C = 2/(3d) Σ_n a_n sin q·a_n                                                change of one perimeter
    /// X = 4/(3d) Σ_n [â_n t_nᵀ (1 − cos q·a_n) − (2/√3) t_n t_nᵀ (cos q·a_{n−1} − cos q·a_{n+1})]
    /// ```
    ///
    /// It is real, since each cell is a centre of inversion, and equal to the lattice sum printed in the paper's SI (not
    /// to the matrices printed after it; see `docs/corrections.md`). Derivation: `docs/mean-field.md`, "The dynamical
    /// matrix". `q` is in units of 1/ℓ_0; the matrix is a rate. The eigenvalues of the Jacobian ∂v/∂r are those of −D.
    ///
    /// # Errors
    /// [`Error::WaveVector`] if `q` is not finite.
    ///
    /// ```
    /// use voronudge_theory::{MeanField, Orientation, Parameters};
    /// let theory = MeanField::new(Parameters { chirality: 0.3, ..Parameters::default() })?;
    /// let matrix = theory.dynamical_matrix([0.5, 0.0], Orientation::NeighbourAlongY)?;
    /// assert!(matrix[0][1] < 0.0 && matrix[1][0] > 0.0);
    /// # Ok::<(), voronudge_theory::Error>(())
    /// ```
    pub fn dynamical_matrix(&self, q: [f64; 2], orientation: Orientation) -> Result<[[f64; 2]; 2], Error> {
        if !q.iter().all(|component| component.is_finite()) {
            return Err(Error::WaveVector { q });
        }
        Ok(self.dynamical_matrix_at(q, orientation))
    }

    /// D at a wave number `q` (1/ℓ_0) in components along the wave vector and a quarter turn ahead, averaged over its directions.
    ///
    /// # Errors
    /// [`Error::WaveVector`] if `q` is not finite.
    pub fn isotropic_dynamical_matrix(&self, q: f64) -> Result<[[f64; 2]; 2], Error> {
        let mut mean = [[0.0; 2]; 2];
        for step in 0..DIRECTIONS {
            let (sin, cos) =
                (std::f64::consts::FRAC_PI_3 * (step as f64 + 0.5) / DIRECTIONS as f64).sin_cos();
            let own = self.dynamical_matrix([q * cos, q * sin], Orientation::NeighbourAlongX)?;
            let axes = [[cos, sin], [-sin, cos]];
            for (a, row) in mean.iter_mut().enumerate() {
                for (b, entry) in row.iter_mut().enumerate() {
                    let of_column = |i: usize| own[i][0] * axes[b][0] + own[i][1] * axes[b][1];
                    *entry += (axes[a][0] * of_column(0) + axes[a][1] * of_column(1)) / DIRECTIONS as f64;
                }
            }
        }
        Ok(mean)
    }

    /// As [`MeanField::dynamical_matrix`], for a wave vector known to be finite.
    pub(crate) fn dynamical_matrix_at(&self, q: [f64; 2], orientation: Orientation) -> [[f64; 2]; 2] {
        let Parameters {
            area_elasticity: k_a,
            perimeter_elasticity: k_p,
            preferred_perimeter: p_0,
            chirality: alpha,
        } = self.parameters();
        let (d, p_mf) = (hexagon_side(), hexagon_perimeter());
        let sums = LatticeSums::new(q, orientation);
        let c = sums.perimeter;
        let turned = [-c[1], c[0]];
        let entry = |i: usize, j: usize| {
            k_p * (p_mf - p_0) * sums.tension[i][j] + (k_p + 0.75 * k_a * d * d) * c[i] * c[j]
                - alpha * k_p * (p_mf * sums.turned_tension[i][j] + turned[i] * c[j])
        };
        [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
    }
}

/// The sums over the neighbours, which depend on geometry only.
struct LatticeSums {
    /// Λ
    tension: [[f64; 2]; 2],
    /// C
    perimeter: [f64; 2],
    /// X
    turned_tension: [[f64; 2]; 2],
}

impl LatticeSums {
    fn new(q: [f64; 2], orientation: Orientation) -> Self {
        let d = hexagon_side();
        let a = orientation.neighbours();
        let phase = a.map(|a| q[0] * a[0] + q[1] * a[1]);
        let mut sums = Self { tension: [[0.0; 2]; 2], perimeter: [0.0; 2], turned_tension: [[0.0; 2]; 2] };
        for n in 0..3 {
            let unit = a[n].map(|component| component / (3f64.sqrt() * d));
            let t = [-unit[1], unit[0]];
            // 1 − cos, without cancellation for long waves.
            let one_less_cosine = 2.0 * (0.5 * phase[n]).sin().powi(2);
            // cos q·a_{n−1} − cos q·a_{n+1}, with a_{n+1} + a_{n−1} = a_n and a_{n+1} − a_{n−1} = 3d t_n.
            let across = 1.5 * d * (q[0] * t[0] + q[1] * t[1]);
            let difference = 2.0 * (0.5 * phase[n]).sin() * across.sin();
            for i in 0..2 {
                sums.perimeter[i] += 2.0 / (3.0 * d) * a[n][i] * phase[n].sin();
                for j in 0..2 {
                    sums.tension[i][j] += 4.0 / (3.0 * d) * t[i] * t[j] * one_less_cosine;
                    sums.turned_tension[i][j] += 4.0 / (3.0 * d)
                        * t[j]
                        * (unit[i] * one_less_cosine - 2.0 / 3f64.sqrt() * t[i] * difference);
                }
            }
        }
        sums
    }
}
