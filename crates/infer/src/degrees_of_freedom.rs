//! How many directions of the nudges the data determine.

use crate::Error;
use crate::linearisation::Linearisation;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Up to this order the trace is exact.
const EXACT_ORDER: usize = 800;

/// Random vectors of the stochastic trace above it; the error is then below one percent of the order's root.
const PROBES: usize = 48;

/// `df = Σ s² / (s² + k) = n − k tr (JᵀJ + kI)⁻¹` for one frame with n nudge components.
///
/// Small problems are solved exactly, large ones by Hutchinson's estimator with a fixed seed.
pub(crate) fn degrees_of_freedom(frame: &Linearisation, spring: f64) -> Result<f64, Error> {
    let factor = frame.factor(0.0)?;
    let n = frame.nudge_gradient().len();
    let trace = if n <= EXACT_ORDER {
        let mut identity = vec![0.0; n * n];
        (0..n).for_each(|i| identity[i * (n + 1)] = 1.0);
        factor.solve(&mut identity);
        (0..n).map(|i| identity[i * (n + 1)]).sum()
    } else {
        let mut rng = Pcg64Mcg::seed_from_u64(0x00D0_F0DF);
        let signs: Vec<f64> =
            (0..n * PROBES).map(|_| if rng.random::<bool>() { 1.0 } else { -1.0 }).collect();
        let mut solved = signs.clone();
        factor.solve(&mut solved);
        signs.iter().zip(&solved).map(|(z, x)| z * x).sum::<f64>() / PROBES as f64
    };
    Ok((n as f64 - spring * trace).clamp(0.0, n as f64))
}
