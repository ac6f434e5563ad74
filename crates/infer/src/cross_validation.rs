//! The error on velocities that a fit has not seen.

use crate::fit::nudged_fit;
use crate::least_squares::{self, residuals};
use crate::objective::Objective;
use crate::{CoefficientSpace, Error, NoiseLevels, Observation, Progress};
use std::ops::ControlFlow;
use voronudge_model::Term;

/// Blocks along each axis into which a single frame is cut.
const BLOCKS: usize = 2;

/// Which velocities are held out together.
enum Folds {
    /// Each frame in turn.
    Frames(usize),
    /// Each contiguous block of cells in turn, in all frames.
    Blocks,
}

/// Normalised error of velocities held out of the fit, predicted at the measured positions (whose nudges they would
/// otherwise have shaped): the pooled value and its standard error over folds. Whole frames are held out where there are
/// three or more, contiguous blocks of cells otherwise.
pub(crate) fn cross_validate(
    frames: &[Observation],
    terms: &[Term],
    space: &CoefficientSpace,
    levels: &NoiseLevels,
    max_steps: u64,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Option<[f64; 2]>, Error> {
    let folds = if frames.len() >= 3 { Folds::Frames(frames.len()) } else { Folds::Blocks };
    let count = match folds {
        Folds::Frames(count) => count,
        Folds::Blocks => BLOCKS * BLOCKS,
    };
    let mut errors = Vec::new();
    for fold in 0..count {
        let held_out: Vec<Vec<bool>> = frames
            .iter()
            .enumerate()
            .map(|(index, frame)| match folds {
                Folds::Frames(_) => vec![index == fold; frame.positions.len()],
                Folds::Blocks => in_block(frame, fold),
            })
            .collect();
        let training: Vec<Observation> = frames
            .iter()
            .zip(&held_out)
            .filter(|(_, out)| !out.iter().all(|out| *out))
            .map(|(frame, out)| without(frame, out))
            .collect();
        let used: usize = training.iter().map(|frame| frame.targets().count()).sum();
        if used < 2 * space.dimension() + 2 {
            return Ok(None);
        }
        let naive = least_squares::fit(&training, terms, space)?;
        let mut objective = Objective { frames: &training, terms, space, spring: levels.spring() };
        let fit = nudged_fit(&mut objective, &naive, levels, max_steps, "cross-validation", observe)?;
        let coefficients = space.coefficients(objective.split(&fit.parameters).0);
        let (mut error, mut total) = (0.0, 0.0);
        for (frame, out) in frames.iter().zip(&held_out) {
            let rests = residuals(frame, terms, coefficients.as_slice());
            for ((_, v), (_, rest)) in frame.targets().zip(rests).filter(|((cell, _), _)| out[*cell]) {
                error += rest.norm_squared();
                total += v.norm_squared();
            }
        }
        if total > 0.0 {
            errors.push((error, total));
        }
    }
    if errors.len() < 2 {
        return Ok(None);
    }
    let (error, total) = errors.iter().fold((0.0, 0.0), |sum, fold| (sum.0 + fold.0, sum.1 + fold.1));
    let (pooled, n) = (error / total, errors.len() as f64);
    // Standard error of a ratio of sums over folds.
    let spread: f64 = errors.iter().map(|(error, weight)| (error - pooled * weight).powi(2)).sum();
    Ok(Some([pooled, (n / (n - 1.0) * spread).sqrt() / total]))
}

/// Whether a cell is in one of the blocks between the quantiles of the coordinates of cells with a target.
fn in_block(frame: &Observation, fold: usize) -> Vec<bool> {
    let block = [fold % BLOCKS, fold / BLOCKS];
    let bounds: Vec<(f64, f64)> = (0..2)
        .map(|axis| {
            let mut at: Vec<f64> = frame.targets().map(|(cell, _)| frame.positions[cell][axis]).collect();
            at.sort_unstable_by(f64::total_cmp);
            let quantile = |k: usize| match k {
                0 => f64::NEG_INFINITY,
                k if k == BLOCKS => f64::INFINITY,
                k => at.get(k * at.len() / BLOCKS).copied().unwrap_or(f64::INFINITY),
            };
            (quantile(block[axis]), quantile(block[axis] + 1))
        })
        .collect();
    frame
        .positions
        .iter()
        .map(|r| bounds.iter().enumerate().all(|(axis, (low, high))| r[axis] >= *low && r[axis] < *high))
        .collect()
}

fn without(frame: &Observation, held_out: &[bool]) -> Observation {
    let mut training = frame.clone();
    for (v, out) in training.velocities.iter_mut().zip(held_out) {
        if *out {
            *v = None;
        }
    }
    training
}
