//! The flow that a density wave sets off at once.

use crate::Error;
use rayon::prelude::*;
use std::f64::consts::TAU;
use voronudge_geometry::{Domain, Tessellation, Vector};
use voronudge_model::{Model, velocities};

/// An inhomogeneous displacement along x: `u_x = a sin(q x + φ)`, `q = 2π n/L_x`, at evenly spaced phases φ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinching {
    /// The amplitude `a`, in the unit of the positions.
    pub amplitude: f64,
    /// The number `n` of waves in the box.
    pub waves: u32,
    /// How many phases are averaged over; an even number cancels what is quadratic in `a`.
    pub phases: u32,
}

impl Default for Pinching {
    /// For unit cells.
    fn default() -> Self {
        Self { amplitude: 0.01, waves: 1, phases: 16 }
    }
}

/// Velocities that a displacement wave sets off: the parts in phase with it, per displacement and squared wave number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinchedFlow {
    /// Along the gradient, `−⟨v_x⟩/(a q²)`: `B + μ` for displacements that follow the wave.
    pub along: f64,
    /// Across it, `−⟨v_y⟩/(a q²)`: `A − Kᵒ`.
    pub across: f64,
}

impl PinchedFlow {
    /// `v_y/v_x`: `(A − Kᵒ)/(B + μ)`.
    pub fn ratio(&self) -> f64 {
        self.across / self.along
    }
}

/// The instantaneous flow of a snapshot (N positions) displaced by a wave, less its flow before: `∂_t u = −D(q) u`.
///
/// The part in phase is `(2/N) Σ_i Δv_i sin(q x_i + φ)` over cells at the places that they had before, averaged over phases.
///
/// # Errors
/// [`Error::OpenDomain`]; [`Error::Rate`] for an amplitude or a number of waves or phases that is not positive;
/// [`Error::Tessellation`] if the displaced cells cannot be tessellated.
///
/// ```
/// use voronudge_geometry::{Domain, Tessellation};
/// use voronudge_model::{Model, Parameters};
/// use voronudge_simulate::{honeycomb, measure::{Pinching, pinched_flow}};
/// let (positions, cell_box) = honeycomb(480)?;
/// let tessellation = Tessellation::new(&positions, Domain::Periodic(cell_box))?;
/// let parameters = Parameters { area_elasticity: 0.0, preferred_perimeter: 3.0, chirality: 0.5, ..Parameters::default() };
/// let model = Model::chiral_voronoi(&parameters);
/// let flow = pinched_flow(&tessellation, &positions, &model, &Pinching::default())?;
/// // α/(3 − a P_0), a = 1/(2√(2√3)) for long waves; one of 20 cells is 5 % above.
/// let expected = 0.5 / (3.0 - 3.0 * 0.5 / (2.0 * 3f64.sqrt()).sqrt());
/// assert!((flow.ratio() / expected - 1.05).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pinched_flow(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    model: &Model<f64>,
    pinching: &Pinching,
) -> Result<PinchedFlow, Error> {
    let Pinching { amplitude, waves, phases } = *pinching;
    let domain = tessellation.domain();
    let Domain::Periodic(cell_box) = domain else {
        return Err(Error::OpenDomain);
    };
    for (name, value) in [
        ("amplitude of a pinch", amplitude),
        ("number of waves", f64::from(waves)),
        ("number of phases", f64::from(phases)),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::Rate { name, value });
        }
    }
    let q = TAU * f64::from(waves) / cell_box.lengths()[0];
    let before = velocities(tessellation, positions, model);
    let of_phase = |phase: u32| -> Result<Vector<f64>, Error> {
        let wave = |r: &Vector<f64>| (q * r.x + TAU * f64::from(phase) / f64::from(phases)).sin();
        let displaced: Vec<_> =
            positions.iter().map(|r| Vector::new(r.x + amplitude * wave(r), r.y)).collect();
        let tessellation = Tessellation::new(&displaced, domain)
            .map_err(|source| Error::Tessellation { time: 0.0, source })?;
        let after = velocities(&tessellation, &displaced, model);
        let rows = positions.iter().zip(after.iter().zip(&before));
        Ok(rows.map(|(r, (after, before))| (after - before) * wave(r)).sum::<Vector<f64>>())
    };
    // Collected first: the sum is taken in the order of the phases.
    let each = (0..phases).into_par_iter().map(of_phase).collect::<Result<Vec<_>, Error>>()?;
    let scale = -2.0 / (positions.len() as f64 * f64::from(phases) * amplitude * q * q);
    let sum = each.into_iter().sum::<Vector<f64>>() * scale;
    Ok(PinchedFlow { along: sum.x, across: sum.y })
}
