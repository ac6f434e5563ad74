//! How probable a fitted model makes velocities that are left out.
//!
//! Linearised about the fit, the likelihood of all data is that of some times that of the others given those. So for
//! velocities B, with the restricted likelihood L of the module [`restricted`](crate::restricted),
//!
//! ```text
//! −2 log p(v_B | rest) = −2 log L(all) + 2 log L(rest) = e_Bᵀ P_BB e_B / σ_v² + log det (σ_v² P_BB⁻¹),    e_B = P_BB⁻¹ (P y)_B
//! ```
//!
//! e_B is the error of the prediction from everything else. Its size is measured against what is expected of it, the effect of
//! errors of the positions included, which dominate the error itself.

use crate::cross_validation::{Split, training};
use crate::objective::Objective;
use crate::search::Watch;
use crate::whitened::Whitened;
use crate::{Error, Observation};

/// `−2 log p` of the velocities of each fold, given all others.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Predictive {
    folds: Vec<f64>,
}

impl Predictive {
    /// At the noise levels and about the point of a fit. `None` if some coefficient is not determined without one of the
    /// folds.
    pub fn new(
        objective: &Objective<'_>,
        at: &[f64],
        split: &Split,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Self>, Error> {
        let parts = whitened(objective, at)?;
        let all = deviance(objective, &parts.iter().collect::<Vec<_>>(), objective.components())?;
        let folds = watch.each("held out", &split.folds, 1.0, |held_out| {
            match rest(objective, at, &parts, split.of_frames, held_out) {
                Ok(rest) => Ok(Some(all - rest)),
                Err(Error::Degenerate) => Ok(None),
                Err(error) => Err(error),
            }
        })?;
        Ok(folds.into_iter().collect::<Option<Vec<f64>>>().map(|folds| Self { folds }))
    }

    /// By how much another model's `−2 log p` is less over all folds, and its standard error, from the scatter of the folds.
    pub fn gain(&self, other: &Self) -> [f64; 2] {
        let gains: Vec<f64> = self.folds.iter().zip(&other.folds).map(|(own, other)| own - other).collect();
        let (total, n) = (gains.iter().sum::<f64>(), gains.len() as f64);
        let scatter: f64 = gains.iter().map(|gain| (gain - total / n).powi(2)).sum();
        [total, (n / (n - 1.0) * scatter).sqrt()]
    }
}

/// `−2 log L` of the data that are left.
fn rest(
    objective: &Objective<'_>,
    at: &[f64],
    parts: &[Whitened],
    of_frames: bool,
    held_out: &[Vec<bool>],
) -> Result<f64, Error> {
    if of_frames {
        let kept = |index: &usize| !held_out[*index].iter().all(|out| *out);
        let others: Vec<usize> = (0..parts.len()).filter(kept).collect();
        let components = others.iter().map(|index| objective.frames[*index].components()).sum();
        return deviance(
            objective,
            &others.iter().map(|index| &parts[*index]).collect::<Vec<_>>(),
            components,
        );
    }
    let (indices, frames): (Vec<usize>, Vec<Observation>) =
        training(objective.frames, held_out).into_iter().unzip();
    let kept = objective.part(at, &indices);
    let objective = Objective { frames: &frames, ..*objective };
    deviance(&objective, &whitened(&objective, &kept)?.iter().collect::<Vec<_>>(), objective.components())
}

fn whitened(objective: &Objective<'_>, at: &[f64]) -> Result<Vec<Whitened>, Error> {
    objective.linearise(at)?.frames.iter().map(|frame| frame.whiten(objective.spring())).collect()
}

/// `−2 log L` at the noise levels of the objective.
fn deviance(objective: &Objective<'_>, parts: &[&Whitened], components: usize) -> Result<f64, Error> {
    let p = objective.space.dimension();
    let left = Whitened::sum(parts.iter().copied(), p).restricted()?;
    let variance = objective.levels.velocity.powi(2);
    Ok((components as f64 - p as f64) * variance.ln() + left.log_determinant + left.misfit / variance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::residuals::residuals;
    use crate::{CoefficientSpace, Constraints, NoiseLevels, Progress};
    use nalgebra::{DMatrix, DVector};
    use std::ops::ControlFlow;
    use voronudge_model::Structure;

    fn of(objective: &Objective<'_>, at: &[f64], split: &Split) -> Predictive {
        let mut silent = |_: Progress<'_>| ControlFlow::Continue(());
        Predictive::new(objective, at, split, &mut Watch { observe: &mut silent }).unwrap().unwrap()
    }

    /// Blocks of one frame, and whole frames, against `e_B = P_BB⁻¹ (P y)_B` with dense matrices.
    #[test]
    fn it_is_that_of_the_dense_error() {
        let three: Vec<Observation> =
            (1..4).map(|seed| crate::sample::observation(0.03, 0.05, seed)).collect();
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let structure = Structure::base(1.0);
        let levels = NoiseLevels { position: 0.03, velocity: 0.05 };
        for frames in [&three[..1], &three[..]] {
            let objective = Objective::new(frames, &structure, &space, levels);
            let mut at = vec![0.1, 3.9, 1.0, 1.6];
            at.extend((0..72 * frames.len()).map(|k| 0.01 * (k as f64).sin()));
            let split = Split::new(frames, 2);
            let found = of(&objective, &at, &split);
            let m = 72 * frames.len();
            let (mut j, mut x, mut y) = (DMatrix::zeros(m, m), DMatrix::zeros(m, 4), DVector::zeros(m));
            let (free, nudges) = objective.split(&at);
            let c = space.coefficients(free);
            for (index, nudges) in nudges.iter().enumerate() {
                let placed = objective.displaced(index, nudges).unwrap();
                let evaluated = placed.evaluate(c.as_slice());
                let own = DMatrix::from_row_slice(
                    72,
                    72,
                    &placed.jacobian(c.as_slice(), &evaluated.of_cells).to_dense(),
                );
                let rests = residuals(&frames[index], &evaluated.predicted);
                let flat = DVector::from_iterator(72, rests.iter().flat_map(|(_, rest)| [rest.x, rest.y]));
                y.rows_mut(72 * index, 72).copy_from(&(flat + &own * DVector::from_column_slice(nudges)));
                j.view_mut((72 * index, 72 * index), (72, 72)).copy_from(&own);
                for (row, term) in (0..72).flat_map(|row| (0..4).map(move |term| (row, term))) {
                    x[(72 * index + row, term)] = evaluated.by_coefficient[term][row / 2][row % 2];
                }
            }
            let inverse =
                (DMatrix::identity(m, m) + &j * j.transpose() / levels.spring()).try_inverse().unwrap();
            let information = (x.transpose() * &inverse * &x).try_inverse().unwrap();
            let p = &inverse - &inverse * &x * information * x.transpose() * &inverse;
            let py = &p * &y;
            for (held_out, found) in split.folds.iter().zip(&found.folds) {
                let block: Vec<usize> = (0..m).filter(|row| held_out[row / 72][(row % 72) / 2]).collect();
                let n = block.len();
                let own = DMatrix::from_fn(n, n, |a, b| p[(block[a], block[b])]);
                let variance = levels.velocity.powi(2);
                let determinant: f64 =
                    own.clone().symmetric_eigen().eigenvalues.iter().map(|e| (variance / e).ln()).sum();
                let right = DVector::from_fn(n, |a, _| py[block[a]]);
                let error = own.clone().try_inverse().unwrap() * right;
                let expected = (error.transpose() * own * &error).sum() / variance + determinant;
                assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} {expected}");
            }
        }
    }
}
