//! How many directions of the nudges the data determine.

use super::Linearisation;
use crate::Error;
use crate::diagnostics::random_signs;
use crate::rows::{from_lanes, to_lanes};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// Step in log k of the derivative of the log determinant; its square is the relative error.
const STEP: f64 = 2e-4;

/// Random signs where a trace does not come from factors.
const SIGNS: usize = 8;

/// The signs are the same ones at each point.
pub(super) const SEED: u64 = 0x5eed;

impl Linearisation {
    /// Directions of the nudges that the data determine, `df = n − k tr (JᵀJ + kHᵀH)⁻¹HᵀH`, which is n less the derivative of
    /// `log det(JᵀJ + kHᵀH)` with respect to log k.
    pub fn degrees_of_freedom(&self, spring: f64) -> Result<f64, Error> {
        let n = self.order() as f64;
        let trace = if self.is_past_factors() {
            self.trace_of_signs(spring)?
        } else {
            let above = self.factor(spring * STEP.exp())?.log_determinant();
            let below = self.factor(spring * (-STEP).exp())?.log_determinant();
            (above - below) / (2.0 * STEP)
        };
        Ok((n - trace).clamp(0.0, n))
    }

    /// `k tr A⁻¹HᵀH` from random signs (Hutchinson 1990), to `√(2n/8)` or better.
    fn trace_of_signs(&self, spring: f64) -> Result<f64, Error> {
        let n = self.order();
        let mut signs = vec![1.0; SIGNS * n];
        random_signs::draw(&mut Pcg64::seed_from_u64(SEED), &mut signs);
        let mut room = Vec::new();
        let mut right = Vec::with_capacity(signs.len());
        for signs in signs.chunks_exact(n) {
            let mut product = vec![[[0.0]; 2]; n / 2];
            self.positions.add_products(spring, &to_lanes::<1>(signs, n), &mut product, &mut room);
            right.extend(from_lanes(&product, 1));
        }
        let solved = self.solutions(spring, &right)?;
        Ok(signs.iter().zip(&solved).map(|(sign, solved)| sign * solved).sum::<f64>() / SIGNS as f64)
    }
}

#[cfg(test)]
mod tests {
    use crate::sample::with_objective;

    /// Random signs against factors.
    #[test]
    fn signs_have_the_trace_of_factors() {
        for share in [0.0, 0.8] {
            with_objective(24, share, |objective, at| {
                let frame = &objective.linearise(at).unwrap().frames[0];
                let trace = frame.order() as f64 - frame.degrees_of_freedom(1.0).unwrap();
                let signs = frame.trace_of_signs(1.0).unwrap();
                assert!((signs - trace).abs() < 0.03 * trace, "{signs} {trace}");
            });
        }
    }
}
