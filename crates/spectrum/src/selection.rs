//! Which modes are computed, and what is told of them.

use crate::mode::participation;
use crate::{Error, Growth, LinearProblem, Mode};
use rayon::prelude::*;
use voronudge_linalg::{
    Complex64, Eigenpairs, PartialEigenpairs, Progress, Wanted, eigen, nearest, rightmost,
};

/// Values closer than this, relative to the largest rate there can be, are one value that occurs several times. Rounding
/// parts those by less, and two that coalesce at an exceptional point by more.
const SAME: f64 = 1e-11;

/// Which modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Selection {
    /// All 2N, by the QR algorithm on the dense matrix.
    All,
    /// This many with the largest rate of growth.
    Largest(usize),
    /// This many nearest to a point of the complex plane.
    Near {
        /// The point.
        shift: Complex64,
        /// How many.
        count: usize,
    },
    /// Those of at most `count` near the middle of a band of frequencies, on the line of no growth, that lie in it.
    Band {
        /// Ends of the band of angular frequencies.
        frequencies: [f64; 2],
        /// How many are looked at.
        count: usize,
    },
}

/// What is told of each mode beside its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Character {
    /// Nothing: no vectors are computed.
    None,
    /// Participation, longitudinal share and overlap.
    Shape,
    /// And the condition number, which needs left vectors.
    Full,
}

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Which modes.
    pub selection: Selection,
    /// What is told of them.
    pub character: Character,
    /// Rates that count as zero, relative to the largest rate there can be ([`LinearProblem::largest_rate`]).
    pub tolerance: f64,
    /// Cells up to which all modes are computed.
    pub dense_limit: usize,
}

impl Request {
    /// All about these modes; 1e-10 as tolerance, 3000 cells as limit.
    pub fn new(selection: Selection) -> Self {
        Self { selection, character: Character::Full, tolerance: 1e-10, dense_limit: 3000 }
    }
}

/// How much of the spectrum was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scope {
    /// All of it.
    All,
    /// The neighbourhood of a shift, up to a distance from it.
    Part {
        /// Where the matrix was factorised.
        shift: Complex64,
        /// Distance up to which nothing is missing, as far as the iteration can tell.
        reach: f64,
    },
}

/// How many modes do what.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rate of growth below zero.
    pub decaying: usize,
    /// Rate of growth above zero.
    pub growing: usize,
    /// Neither, but oscillating.
    pub neutral: usize,
    /// Rate and frequency zero: translations.
    pub zero: usize,
    /// Frequency other than zero, growing or not.
    pub oscillating: usize,
}

/// The modes that were found, the fastest growing first.
#[derive(Debug, Clone)]
pub struct Modes {
    /// The modes.
    pub modes: Vec<Mode>,
    /// Rates up to this are zero.
    pub tolerance: f64,
    /// How much of the spectrum this is.
    pub scope: Scope,
    pairs: Eigenpairs,
}

impl Modes {
    /// The displacements of a mode with unit length, (2n), in the order of [`LinearProblem::cells`]; none if the request
    /// did not ask for character.
    pub fn vector(&self, index: usize) -> Option<Vec<Complex64>> {
        self.pairs.right(index)
    }

    /// How many modes do what.
    pub fn counts(&self) -> Counts {
        let mut counts = Counts::default();
        for mode in &self.modes {
            let slot = match mode.growth(self.tolerance) {
                Growth::Decaying => &mut counts.decaying,
                Growth::Growing => &mut counts.growing,
                Growth::Neutral if mode.is_zero(self.tolerance) => &mut counts.zero,
                Growth::Neutral => &mut counts.neutral,
            };
            *slot += 1;
            counts.oscillating += usize::from(mode.oscillates(self.tolerance));
        }
        counts
    }

    /// `⟨ω²⟩ = (1/2N) Σ (Im λ)²` over all modes, the paper's measure of odd elastic waves; `None` of a part of them.
    pub fn mean_square_frequency(&self) -> Option<f64> {
        let sum: f64 = self.modes.iter().map(|mode| mode.value.im.powi(2)).sum();
        (self.scope == Scope::All && !self.modes.is_empty()).then(|| sum / self.modes.len() as f64)
    }

    /// The mode with the highest frequency, if one oscillates.
    pub fn fastest_oscillation(&self) -> Option<usize> {
        let oscillating = (0..self.modes.len()).filter(|&k| self.modes[k].oscillates(self.tolerance));
        oscillating.fold(None, |best: Option<usize>, k| match best {
            Some(best) if self.modes[best].value.im >= self.modes[k].value.im => Some(best),
            _ => Some(k),
        })
    }

    /// The mode with the largest rate of growth that is not zero altogether.
    pub fn most_unstable(&self) -> Option<usize> {
        (0..self.modes.len()).find(|&k| !self.modes[k].is_zero(self.tolerance))
    }

    /// The mode nearest to an exceptional point: the largest condition number among those that are not zero.
    pub fn nearest_exceptional(&self) -> Option<usize> {
        let known = (0..self.modes.len())
            .filter(|&k| !self.modes[k].is_zero(self.tolerance))
            .filter_map(|k| Some((k, self.modes[k].condition.filter(|c| !c.is_nan())?)));
        known
            .fold(None, |best: Option<(usize, f64)>, (k, c)| match best {
                Some(best) if best.1 >= c => Some(best),
                _ => Some((k, c)),
            })
            .map(|(k, _)| k)
    }
}

/// Bytes that all modes of so many cells take at most, with left and right vectors.
pub fn dense_memory(cells: usize) -> f64 {
    7.0 * 8.0 * (2.0 * cells as f64).powi(2)
}

/// Computes modes. The same request gives the same result with any number of threads.
///
/// # Errors
/// [`Error::TooManyCells`] for all modes of more cells than the limit; [`Error::NoModes`], [`Error::Shift`] and
/// [`Error::Band`] for a request that makes no sense; [`Error::LinearAlgebra`] if the search fails.
pub fn modes(
    problem: &LinearProblem,
    request: &Request,
    progress: &mut Progress<'_>,
) -> Result<Modes, Error> {
    let cells = problem.cells().len();
    let wanted = match request.character {
        Character::None => Wanted::Values,
        Character::Shape => Wanted::Right,
        Character::Full => Wanted::RightAndLeft,
    };
    let tolerance = request.tolerance * problem.largest_rate();
    let (matrix, places) = (&problem.matrix, &problem.places);
    let (mut found, scope) = match request.selection {
        Selection::All if cells > request.dense_limit => {
            return Err(Error::TooManyCells { cells, limit: request.dense_limit });
        }
        Selection::All => {
            progress("all modes", 0, 1);
            let pairs = eigen(&matrix.to_dense(), matrix.order(), wanted)?;
            progress("character of the modes", 0, 1);
            (
                PartialEigenpairs {
                    pairs,
                    residuals: Vec::new(),
                    shift: Complex64::ZERO,
                    reach: f64::INFINITY,
                },
                Scope::All,
            )
        }
        Selection::Largest(0) | Selection::Near { count: 0, .. } | Selection::Band { count: 0, .. } => {
            return Err(Error::NoModes);
        }
        Selection::Largest(count) => part(rightmost(matrix, places, count, wanted, progress)?),
        Selection::Near { shift, count } => {
            if !(shift.re.is_finite() && shift.im.is_finite()) {
                return Err(Error::Shift { real: shift.re, imaginary: shift.im });
            }
            part(nearest(matrix, places, shift, count, wanted, progress)?)
        }
        Selection::Band { frequencies: [low, high], count } => {
            if !(low >= 0.0 && low < high && high.is_finite()) {
                return Err(Error::Band { low, high });
            }
            let middle = Complex64::new(0.0, 0.5 * (low + high));
            let (mut found, scope) = part(nearest(matrix, places, middle, count, wanted, progress)?);
            found.retain(|value| (low..=high).contains(&value.im));
            (found, scope)
        }
    };
    found.residuals.resize(found.pairs.values.len(), f64::NAN);
    let pairs = found.pairs;
    let modes = (0..pairs.values.len())
        .into_par_iter()
        .map(|index| {
            let residual = Some(found.residuals[index]).filter(|residual| residual.is_finite());
            describe(problem, &pairs, index, residual, tolerance)
        })
        .collect();
    Ok(Modes { modes, tolerance, scope, pairs })
}

fn part(found: PartialEigenpairs) -> (PartialEigenpairs, Scope) {
    let scope = Scope::Part { shift: found.shift, reach: found.reach };
    (found, scope)
}

fn describe(
    problem: &LinearProblem,
    pairs: &Eigenpairs,
    index: usize,
    residual: Option<f64>,
    tolerance: f64,
) -> Mode {
    let value = pairs.values[index];
    let same = SAME * problem.largest_rate();
    let vector = pairs.right(index);
    let longitudinal = vector.as_ref().filter(|_| value.norm() > tolerance).and_then(|u| {
        let [divergence, curl] = problem.gradients.divergence_and_curl(u);
        Some(divergence / (divergence + curl)).filter(|share| share.is_finite())
    });
    Mode {
        value,
        residual,
        participation: vector.as_deref().map(participation),
        longitudinal,
        condition: pairs.condition(index, same).filter(|condition| !condition.is_nan()),
        overlap: vector.and_then(|u| overlap(pairs, index, &u, same)),
    }
}

/// With the vector of the nearest other value.
fn overlap(pairs: &Eigenpairs, index: usize, u: &[Complex64], same: f64) -> Option<f64> {
    let value = pairs.values[index];
    let others = (0..pairs.values.len()).filter(|&other| !pairs.is_same(index, other, same));
    let distance = |other: usize| (pairs.values[other] - value).norm();
    let other = others.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
    let product: Complex64 = pairs.right(other)?.iter().zip(u).map(|(v, u)| v.conj() * u).sum();
    Some(product.norm())
}
