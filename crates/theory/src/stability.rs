//! The phase diagram: what the first mode to become unstable does.

use crate::spectrum::{eigenvalues, roots};
use crate::{Eigenvalue, Error, MeanField, Orientation, SymmetryPoint, hexagon_perimeter};

/// What the honeycomb does, by its mode at q* ([`MeanField::critical_wave_vector`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// `P_0 < P_MF`; the mode decays without oscillation.
    Solid,
    /// `P_0 < P_MF`, beyond the exceptional line: the mode decays as an odd elastic wave.
    OddElasticSolid,
    /// `P_0 ≥ P_MF`: the honeycomb is not stable; the paper's liquid.
    Unstable,
}

/// A mode of the honeycomb.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Wave vector (1/ℓ_0).
    pub q: [f64; 2],
    /// The slower of its two decay rates.
    pub rate: Eigenvalue,
}

impl MeanField {
    /// `q*`, the point M of the Brillouin zone, `|q*| = 2π/(3d)`: the paper's most unstable mode.
    ///
    /// Along a neighbour the same mode appears at `|q| = 2π/(√3 d)`, which is M of the next zone.
    pub fn critical_wave_vector(&self, orientation: Orientation) -> [f64; 2] {
        orientation.wave_vector(SymmetryPoint::M)
    }

    /// Phase by the mode at q*: its limit of stability is `P_0 = P_MF`, for any α; its waves begin at
    /// [`MeanField::exceptional_chirality`]. For |α| below about 0.05 other modes become unstable up to 0.1 % earlier, see
    /// [`MeanField::stability_limit`].
    ///
    /// At q* the eigenvalues of `D` are `8 K_P s [2 ± √(1 − 3 (α/s)²)]` with `s = 1 − P_0/P_MF`, so both real parts have the
    /// sign of s unless a real root exceeds 2, which it cannot. Derivation: `docs/mean-field.md`, "The critical mode".
    pub fn phase(&self) -> Phase {
        if self.distance_to_limit() <= 0.0 {
            Phase::Unstable
        } else if self.parameters().chirality.abs() > self.exceptional_chirality() {
            Phase::OddElasticSolid
        } else {
            Phase::Solid
        }
    }

    /// The exceptional line at q*: `|α| = |P_MF − P_0|/(√3 P_MF)`.
    ///
    /// Waves with other wave vectors begin elsewhere, see [`MeanField::exceptional_chiralities`].
    pub fn exceptional_chirality(&self) -> f64 {
        (hexagon_perimeter() - self.parameters().preferred_perimeter).abs()
            / (3f64.sqrt() * hexagon_perimeter())
    }

    /// The `P_0` below which the modes at `q` decay, whatever the `P_0` of these parameters; `None` at Γ, where they
    /// never do.
    ///
    /// `D` is linear in P_0, so `tr D` is linear and `det D` quadratic in it; the limit is their lowest root. Derivation:
    /// `docs/mean-field.md`, "Stability at other wave vectors".
    ///
    /// # Errors
    /// [`Error::WaveVector`] if `q` (1/ℓ_0) is not finite.
    pub fn stability_limit_at(&self, q: [f64; 2], orientation: Orientation) -> Result<Option<f64>, Error> {
        let origin = self.with_preferred_perimeter(hexagon_perimeter()).dynamical_matrix(q, orientation)?;
        let next =
            self.with_preferred_perimeter(hexagon_perimeter() - 1.0).dynamical_matrix_at(q, orientation);
        // D = origin + x slope with x = P_MF − P_0; stable for x above the largest root.
        let slope = |i: usize, j: usize| next[i][j] - origin[i][j];
        let trace = slope(0, 0) + slope(1, 1);
        if trace <= 0.0 {
            return Ok(None);
        }
        let by_trace = -(origin[0][0] + origin[1][1]) / trace;
        let by_determinant = roots(
            origin[0][0] * origin[1][1] - origin[0][1] * origin[1][0],
            origin[0][0] * slope(1, 1) + slope(0, 0) * origin[1][1]
                - origin[0][1] * slope(1, 0)
                - slope(0, 1) * origin[1][0],
            slope(0, 0) * slope(1, 1) - slope(0, 1) * slope(1, 0),
        );
        let distance = by_determinant.map_or(by_trace, |[_, upper]| upper.max(by_trace));
        Ok(Some(hexagon_perimeter() - distance))
    }

    /// The `P_0` below which all modes on a mesh of `mesh × mesh` wave vectors of the Brillouin zone decay.
    ///
    /// It is `P_MF` at α = 0 and for |α| above about 0.05, and up to 0.1 % less in between. The mesh begins at Γ, which is
    /// left out; an even `mesh` contains q*. At least 2.
    pub fn stability_limit(&self, mesh: usize) -> f64 {
        let orientation = Orientation::NeighbourAlongY;
        zone(orientation, mesh)
            .filter_map(|q| self.stability_limit_at(q, orientation).ok().flatten())
            .fold(hexagon_perimeter(), f64::min)
    }

    /// The mode that grows fastest, or decays slowest, among `mesh × mesh` wave vectors of the Brillouin zone without Γ.
    ///
    /// In the solid that is a long wave, because all rates vanish as q². `mesh` is at least 2.
    pub fn slowest_mode(&self, orientation: Orientation, mesh: usize) -> Mode {
        let mode = |q| Mode { q, rate: eigenvalues(self.dynamical_matrix_at(q, orientation))[0] };
        zone(orientation, mesh).map(mode).fold(
            mode(self.critical_wave_vector(orientation)),
            |slowest, other| {
                if other.rate.real < slowest.rate.real { other } else { slowest }
            },
        )
    }

    /// `⟨ω²⟩`, the mean square frequency over both modes at `mesh × mesh` wave vectors of the Brillouin zone.
    ///
    /// Γ counts as two modes that rest. It is the value that all modes of a periodic honeycomb of `mesh × mesh` cells
    /// have. `mesh` is at least 2.
    pub fn mean_square_frequency(&self, mesh: usize) -> f64 {
        let orientation = Orientation::NeighbourAlongY;
        let mesh = mesh.max(2);
        let square = |q| eigenvalues(self.dynamical_matrix_at(q, orientation))[0].imaginary.powi(2);
        zone(orientation, mesh).map(square).sum::<f64>() / (mesh * mesh) as f64
    }
}

/// The points of a mesh that starts at Γ and spans the reciprocal cell, without Γ.
fn zone(orientation: Orientation, mesh: usize) -> impl Iterator<Item = [f64; 2]> {
    let mesh = mesh.max(2);
    let [g, h] = orientation.reciprocal();
    (1..mesh * mesh).map(move |k| {
        let [m, n] = [k / mesh, k % mesh].map(|index| index as f64 / mesh as f64);
        [0, 1].map(|axis| m * g[axis] + n * h[axis])
    })
}
