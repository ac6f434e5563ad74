//! The error on velocities that a fit has not seen.

use crate::least_squares::{self, residuals_as_measured};
use crate::objective::Objective;
use crate::search::{Watch, follow, refine};
use crate::{Error, Observation, Progress, Velocities};
use std::ops::ControlFlow;
use voronudge_geometry::Vector;
use voronudge_model::Structure;

/// Blocks along each axis into which a frame is cut at least.
pub(crate) const BLOCKS: usize = 2;

/// Steps at the end of a fold's fit. One continuation is enough: the flip of a contact hardly changes the parameters.
const STEPS: u64 = 12;

/// Rings of cells around those whose velocities are held out that lose the nudges which the fit to all has given them.
const RINGS: usize = 4;

/// Errors on velocities held out of the fit, predicted at the measured positions (whose nudges they would otherwise have
/// shaped).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Folds {
    /// Whether whole frames are held out, or contiguous blocks of cells.
    pub of_frames: bool,
    /// Squared error and sum of squares of each.
    folds: Vec<(f64, f64)>,
    /// Perhaps the same of each region of the field, of all folds together: folds can be too few to tell how much they scatter.
    regions: Vec<(f64, f64)>,
    /// For each frame and datum what was predicted of its velocity; `None` where it has no target or was in no fold.
    pub velocities: Vec<Vec<Option<Vector<f64>>>>,
}

/// What the fit without one fold says of it.
struct Tested {
    /// Squared error and sum of squares.
    squares: (f64, f64),
    /// Frame, datum and predicted velocity.
    velocities: Vec<(usize, usize, Vector<f64>)>,
}

impl Folds {
    /// Errors of a model with given coefficients on whole frames.
    pub fn predicted(frames: &[Observation], structure: &Structure, coefficients: &[f64]) -> Self {
        let held_out = |index: usize| -> Vec<Vec<bool>> {
            let out = |(k, frame): (usize, &Observation)| vec![k == index; frame.velocities.values().len()];
            frames.iter().enumerate().map(out).collect()
        };
        let tested = (0..frames.len()).map(|k| predict(frames, structure, coefficients, &held_out(k)));
        Self::new(true, frames, tested.collect())
    }

    /// Folds without anything that moves say nothing.
    fn new(of_frames: bool, frames: &[Observation], tested: Vec<Tested>) -> Self {
        let mut velocities: Vec<Vec<_>> =
            frames.iter().map(|frame| vec![None; frame.velocities.values().len()]).collect();
        for (frame, datum, v) in tested.iter().flat_map(|fold| &fold.velocities) {
            velocities[*frame][*datum] = Some(*v);
        }
        let folds = tested.iter().map(|fold| fold.squares).filter(|(_, total)| *total > 0.0).collect();
        Self { of_frames, folds, regions: Vec::new(), velocities }
    }

    /// From the squared errors and sums of squares of each region in each fold alone.
    pub fn of_regions(of_frames: bool, folds: &[Vec<(f64, f64)>]) -> Self {
        let add = |sum: (f64, f64), part: &(f64, f64)| (sum.0 + part.0, sum.1 + part.1);
        let count = folds.iter().map(Vec::len).min().unwrap_or(0);
        let region = |k: usize| folds.iter().map(|fold| &fold[k]).fold((0.0, 0.0), add);
        Self {
            of_frames,
            folds: folds.iter().map(|fold| fold.iter().fold((0.0, 0.0), add)).collect(),
            regions: (0..count).map(region).collect(),
            velocities: Vec::new(),
        }
    }

    pub fn count(&self) -> usize {
        self.folds.len()
    }

    /// Normalised error, pooled, and its standard error: over folds, or over regions if these scatter more.
    pub fn error(&self) -> [f64; 2] {
        larger(ratio(self.folds.iter().copied()), ratio(self.regions.iter().copied()))
    }

    /// By how much another model's error is less, on the same folds.
    pub fn gain(&self, other: &Self) -> [f64; 2] {
        let gain = |own: &[(f64, f64)], other: &[(f64, f64)]| {
            let pairs: Vec<(f64, f64)> = own.iter().zip(other).map(|(a, b)| (a.0 - b.0, a.1)).collect();
            ratio(pairs.into_iter())
        };
        larger(gain(&self.folds, &other.folds), gain(&self.regions, &other.regions))
    }
}

/// A value with the larger of two standard errors; of fewer than two parts there is none.
fn larger([value, error]: [f64; 2], [_, other]: [f64; 2]) -> [f64; 2] {
    [value, error.max(other)]
}

/// A ratio of sums over folds with its standard error.
pub(crate) fn ratio(folds: impl Iterator<Item = (f64, f64)> + Clone) -> [f64; 2] {
    let (sum, total) = folds.clone().fold((0.0, 0.0), |sum, fold| (sum.0 + fold.0, sum.1 + fold.1));
    let (pooled, n) = (sum / total, folds.clone().count() as f64);
    let spread: f64 = folds.map(|(part, weight)| (part - pooled * weight).powi(2)).sum();
    [pooled, (n / (n - 1.0) * spread).sqrt() / total]
}

/// What is held out together.
#[derive(Debug, Clone)]
pub(crate) struct Split {
    /// Whether whole frames, or contiguous blocks of cells.
    pub of_frames: bool,
    /// For each fold and frame, which velocities are held out.
    pub folds: Vec<Vec<Vec<bool>>>,
}

impl Split {
    /// Whole frames in turn where there are three or more; otherwise blocks, so many along each axis.
    pub fn new(frames: &[Observation], blocks: usize) -> Self {
        let of_frames = frames.len() >= 3;
        let count = if of_frames { frames.len() } else { blocks * blocks };
        let folds = (0..count)
            .map(|fold| {
                let held_out = |(index, frame): (usize, &Observation)| match of_frames {
                    true => vec![index == fold; frame.velocities.values().len()],
                    false => in_block(frame, fold, blocks),
                };
                frames.iter().enumerate().map(held_out).collect()
            })
            .collect();
        Self { of_frames, folds }
    }
}

/// The frames without velocities held out, each with its index; those without any velocity left are not among them.
pub(crate) fn training(frames: &[Observation], held_out: &[Vec<bool>]) -> Vec<(usize, Observation)> {
    let pairs = frames.iter().zip(held_out).enumerate();
    pairs
        .map(|(index, (frame, out))| (index, without(frame, out)))
        .filter(|(_, frame)| frame.targets().next().is_some())
        .collect()
}

/// Fits without the velocities of each fold. `at` is the fit to all: where whole frames are held out, the nudges of the others start
/// from there, since they do not depend on that frame but through the parameters, and where blocks are, those of cells far from them, with parameters that
/// know nothing of the block. `None` if too few velocities are left to
/// fit, or to hold out.
pub(crate) fn cross_validate(
    whole: &Objective<'_>,
    at: &[f64],
    split: &Split,
    watch: &mut Watch<'_>,
) -> Result<Option<Folds>, Error> {
    let tested = watch
        .each("cross-validation", &split.folds, 1.0, |held_out| test(whole, at, split.of_frames, held_out))?;
    let tested: Option<Vec<Tested>> = tested.into_iter().collect();
    let folds = tested.map(|tested| Folds::new(split.of_frames, whole.frames, tested));
    Ok(folds.filter(|folds| folds.count() >= 2))
}

/// Fits without some velocities and predicts them. `None` if too few are left.
fn test(
    whole: &Objective<'_>,
    at: &[f64],
    of_frames: bool,
    held_out: &[Vec<bool>],
) -> Result<Option<Tested>, Error> {
    let Objective { frames, structure, space, .. } = *whole;
    let (kept, training): (Vec<usize>, Vec<Observation>) = training(frames, held_out).into_iter().unzip();
    let used: usize = training.iter().map(|frame| frame.targets().count()).sum();
    if used < 2 * space.dimension() + 2 {
        return Ok(None);
    }
    let objective = Objective { frames: &training, ..*whole };
    let known = whole.part(at, &kept);
    let parameters = if of_frames {
        refine(&objective, known, STEPS)?.parameters
    } else {
        let naive = least_squares::fit(&training, structure, space)?;
        let touched = kept.iter().map(|&index| touched(&frames[index], &held_out[index]));
        match touched.collect::<Option<Vec<Vec<bool>>>>() {
            Some(touched) => {
                let mut start = known;
                start[..naive.len()].copy_from_slice(&naive);
                let nudges = start[naive.len()..].chunks_exact_mut(2).zip(touched.concat());
                nudges.filter(|(_, touched)| *touched).for_each(|(nudge, _)| nudge.fill(0.0));
                refine(&objective, start, STEPS)?.parameters
            }
            None => {
                let mut silent = |_: Progress<'_>| ControlFlow::Continue(());
                follow(&objective, &naive, STEPS, "", &mut Watch { observe: &mut silent })?.parameters
            }
        }
    };
    let coefficients = space.coefficients(objective.split(&parameters).0);
    Ok(Some(predict(frames, structure, coefficients.as_slice(), held_out)))
}

/// Which cells are so near those whose velocities are held out that these say something of their nudges: a velocity depends on the cells within two rings,
/// which are in as much touch with others. None where velocities are not of cells, or such cells are more than half: what begins where it was measured has to
/// be led from loose to tight data.
fn touched(frame: &Observation, held_out: &[bool]) -> Option<Vec<bool>> {
    let Velocities::OfCells(_) = frame.velocities else { return None };
    let mut touched = held_out.to_vec();
    for _ in 0..RINGS {
        let before = touched.clone();
        for cell in (0..before.len()).filter(|cell| before[*cell]) {
            frame.tessellation.neighbours(cell).iter().for_each(|other| touched[*other as usize] = true);
        }
    }
    let few = 2 * touched.iter().filter(|touched| **touched).count() <= touched.len();
    few.then_some(touched)
}

/// What given coefficients make of some velocities at the measured positions.
fn predict(
    frames: &[Observation],
    structure: &Structure,
    coefficients: &[f64],
    held_out: &[Vec<bool>],
) -> Tested {
    let (mut error, mut total, mut velocities) = (0.0, 0.0, Vec::new());
    for (index, (frame, out)) in frames.iter().zip(held_out).enumerate() {
        if !out.iter().any(|out| *out) {
            continue;
        }
        let rests = residuals_as_measured(frame, structure, coefficients);
        let targets = frame.targets().zip(frame.explainable());
        for (((datum, measured), v), (_, rest)) in
            targets.zip(rests).filter(|(((datum, _), _), _)| out[*datum])
        {
            error += rest.norm_squared();
            total += v.norm_squared();
            velocities.push((index, datum, measured - rest));
        }
    }
    Tested { squares: (error, total), velocities }
}

/// Whether a cell is in one of the blocks between the quantiles of the coordinates of cells with a target.
fn in_block(frame: &Observation, fold: usize, blocks: usize) -> Vec<bool> {
    let block = [fold % blocks, fold / blocks];
    let bounds: Vec<(f64, f64)> = (0..2)
        .map(|axis| {
            let mut at: Vec<f64> =
                frame.targets().map(|(datum, _)| frame.position_of_datum(datum)[axis]).collect();
            at.sort_unstable_by(f64::total_cmp);
            let quantile = |k: usize| match k {
                0 => f64::NEG_INFINITY,
                k if k == blocks => f64::INFINITY,
                k => at.get(k * at.len() / blocks).copied().unwrap_or(f64::INFINITY),
            };
            (quantile(block[axis]), quantile(block[axis] + 1))
        })
        .collect();
    (0..frame.velocities.values().len())
        .map(|datum| frame.position_of_datum(datum))
        .map(|r| bounds.iter().enumerate().all(|(axis, (low, high))| r[axis] >= *low && r[axis] < *high))
        .collect()
}

/// A frame without some of its velocities.
pub(crate) fn without(frame: &Observation, held_out: &[bool]) -> Observation {
    let mut training = frame.clone();
    for (v, out) in training.velocities.values_mut().iter_mut().zip(held_out) {
        if *out {
            *v = None;
        }
    }
    let degree = training.background_degree();
    training.with_background(degree)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two folds may happen to be alike where their parts are not.
    #[test]
    fn folds_that_are_alike_do_not_hide_what_regions_scatter() {
        let fold = vec![(1.0, 2.0), (3.0, 2.0)];
        let before = Folds::of_regions(true, &[fold.clone(), fold]);
        assert_eq!(before.error(), [1.0, 0.5]);
        let after = Folds::of_regions(true, &[vec![(1.0, 2.0), (1.0, 2.0)], vec![(1.0, 2.0), (1.0, 2.0)]]);
        assert_eq!(before.gain(&after), [0.5, 0.5]);
        // Folds that scatter more are believed.
        let apart = Folds::of_regions(true, &[vec![(1.0, 2.0), (1.0, 2.0)], vec![(3.0, 2.0), (3.0, 2.0)]]);
        assert_eq!(apart.error(), [1.0, 0.5]);
    }
}
