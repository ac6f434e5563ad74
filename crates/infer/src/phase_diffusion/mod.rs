//! Phase diffusion: the linear equation that slow deformations of a pattern of cells obey, from displacements of its cells.
//!
//! ```text
//! ∂_t u = D_∥ ∇(∇·u) + D_⊥ Δu + D_∥^× ε·∇(∇·u) + D_⊥^× ε·Δu,      ε_xy = 1
//! ```
//!
//! Plane waves do not mix, and one wave changes by the propagator `u(t) = exp(−D(q) t) u(0)`, which is exact however long the time
//! between frames. The displacements are resolved into waves (`waves`), and the four diffusivities are those whose propagators fit the
//! courses of all waves together (`fit`).

mod fit;
mod waves;

#[cfg(test)]
mod tests;

pub use waves::PatternWave;

use crate::Error;
use fit::{Basis, Fit};
use statrs::distribution::{ContinuousCDF, StudentsT};
use voronudge_geometry::{PeriodicBox, Vector};
use voronudge_observables::RateMatrix;
use waves::resolve;

/// The fewest frames with a course.
const FEWEST_FRAMES: usize = 3;

/// Displacements of the cells of a periodic pattern.
#[derive(Debug, Clone)]
pub struct Pattern {
    /// The box.
    pub domain: PeriodicBox,
    /// Places of the cells without displacement (N), or about there.
    pub reference: Vec<Vector<f64>>,
    /// Displacements (frames, N), not wrapped.
    pub displacements: Vec<Vec<Vector<f64>>>,
    /// Time of each frame, ascending.
    pub times: Vec<f64>,
}

/// How the courses of waves are fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PhaseRequest {
    /// Number of wave vectors, the longest waves first, q and −q counted once. Waves of one length are taken all.
    pub wave_vectors: usize,
    /// How far rates are expanded in q.
    pub order: RateOrder,
    /// What the residuals are.
    pub fluctuations: Fluctuations,
    /// Whether the places without displacement are known.
    pub reference: ReferencePlaces,
}

/// How far rates are expanded in the wave vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RateOrder {
    /// `D(q) ∝ q²`: the phase diffusion equation.
    Second,
    /// A further isotropic matrix times q⁴, for waves that are not very long against the cells.
    Fourth,
}

/// What the residuals are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fluctuations {
    /// Errors of measurement, independent from frame to frame, about a course without noise.
    Measurement,
    /// Random forces: each frame is a step from the frame before as measured.
    Driving,
}

/// What the displacements are counted from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReferencePlaces {
    /// Places at which the pattern rests.
    Given,
    /// Any: the state of rest is a constant displacement that is fitted along.
    Free,
}

/// A value with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiffusivityEstimate {
    /// The value.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Student's 95 % interval.
    pub interval: [f64; 2],
}

/// The matrix of one wave vector, fitted to its course alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnMatrix {
    /// D(q) in components along q and a quarter turn ahead, rows first.
    pub matrix: [[f64; 2]; 2],
    /// Standard errors.
    pub standard_errors: [[f64; 2]; 2],
}

/// What the waves of a pattern tell.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseDiffusion {
    /// `D_∥`
    pub parallel: DiffusivityEstimate,
    /// `D_⊥`
    pub perpendicular: DiffusivityEstimate,
    /// `D_∥^×`
    pub parallel_cross: DiffusivityEstimate,
    /// `D_⊥^×`
    pub perpendicular_cross: DiffusivityEstimate,
    /// All coefficients of the fit: the four above and, to fourth order, the matrix that q⁴ multiplies, row by row.
    pub coefficients: Vec<f64>,
    /// χ² of the two cross diffusivities against none, of two degrees of freedom.
    pub chirality: f64,
    /// Root mean square of the residuals of amplitudes.
    pub residual: f64,
    /// Share of the squared changes of the amplitudes that is explained.
    pub explained: f64,
    /// Correlation of residuals of consecutive frames.
    pub residual_correlation: f64,
    /// The waves, the longest first.
    pub waves: Vec<PatternWave>,
    /// The matrix of each wave by itself; `None` where its course does not determine one.
    pub own: Vec<Option<OwnMatrix>>,
}

impl PhaseDiffusion {
    /// D(q) of the fit in components along q and a quarter turn ahead, rows first, at some q².
    pub fn matrix(&self, square: f64) -> [[f64; 2]; 2] {
        let order = if self.coefficients.len() > 4 { RateOrder::Fourth } else { RateOrder::Second };
        let RateMatrix(rows) = Basis::of(order).matrix(&self.coefficients, square);
        rows
    }
}

/// Fits the four diffusivities to the courses of the longest waves.
///
/// Amplitudes of waves are found by least squares over the cells, so the reference need not be a lattice. Within a wave the state at the
/// first frame, and the state of rest unless it is given, are fitted along; they are eliminated exactly at each step of a
/// Levenberg–Marquardt search over the diffusivities. Standard errors follow from the scatter of the residuals.
///
/// # Errors
/// [`Error::TooFewFrames`] and [`Error::TooFewPatternCells`] for too little data, [`Error::NoDeformation`] if nothing moves,
/// [`Error::Degenerate`] if the courses do not determine the coefficients.
pub fn phase_diffusion(pattern: &Pattern, request: &PhaseRequest) -> Result<PhaseDiffusion, Error> {
    let frames = pattern.displacements.len();
    if frames < FEWEST_FRAMES {
        return Err(Error::TooFewFrames { found: frames, required: FEWEST_FRAMES });
    }
    let waves = resolve(pattern, request.wave_vectors)?;
    let largest = waves.iter().map(PatternWave::amplitude).fold(0.0, f64::max);
    let size = (pattern.domain.area() / pattern.reference.len() as f64).sqrt();
    if largest <= 1e-12 * size {
        return Err(Error::NoDeformation { cells: pattern.reference.len(), frames });
    }
    let all = Fit::new(&waves, Basis::of(request.order), request, &pattern.times)?;
    let alone = |wave: &PatternWave| {
        let fit = Fit::new(std::slice::from_ref(wave), Basis::free(), request, &pattern.times).ok()?;
        let (value, error) = (|k: usize| fit.values[k], |k: usize| fit.variance(k, k).sqrt());
        Some(OwnMatrix {
            matrix: [[value(0), value(1)], [value(2), value(3)]],
            standard_errors: [[error(0), error(1)], [error(2), error(3)]],
        })
    };
    let own = waves.iter().map(alone).collect();
    let quantile = StudentsT::new(0.0, 1.0, all.freedom.max(1.0)).map_or(1.96, |law| law.inverse_cdf(0.975));
    let estimate = |k: usize| {
        let (value, standard_error) = (all.values[k], all.variance(k, k).sqrt());
        let reach = quantile * standard_error;
        DiffusivityEstimate { value, standard_error, interval: [value - reach, value + reach] }
    };
    let (a, b, c) = (all.variance(2, 2), all.variance(2, 3), all.variance(3, 3));
    let (x, y) = (all.values[2], all.values[3]);
    Ok(PhaseDiffusion {
        parallel: estimate(0),
        perpendicular: estimate(1),
        parallel_cross: estimate(2),
        perpendicular_cross: estimate(3),
        chirality: (c * x * x - 2.0 * b * x * y + a * y * y) / (a * c - b * b),
        residual: all.residual,
        explained: all.explained,
        residual_correlation: all.correlation,
        coefficients: all.values,
        waves,
        own,
    })
}
