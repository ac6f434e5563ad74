//! A fitted model and the candidates beside it, in one linear problem.
//!
//! Linearised about the nudged fit, the data are `y = v − F(r̃) + Jε` with covariance `σ_v² W`, `W = I + JJᵀ/k`. With
//! `X` the derivatives by the coefficients of the model and `Z` those by a candidate's, the score statistic
//!
//! ```text
//! T = sᵀ G⁻¹ s / σ_v²,    s = ZᵀP y,    G = ZᵀP Z,    P = W⁻¹ − W⁻¹X (XᵀW⁻¹X)⁻¹ XᵀW⁻¹
//! ```
//!
//! is χ² with as many degrees of freedom as the candidate has columns if the model lacks nothing. No derivative of the
//! candidate by positions is needed. Where σ_v was estimated, T is compared with what is left (an F test).

use super::candidate::Candidate;
use crate::fit_parameter::BASE;
use crate::objective::Objective;
use crate::tracks::{Beside, Followed, Movie};
use crate::uncertainty::nudges;
use crate::whitened::Whitened;
use crate::{CoefficientSpace, Error, Inference, NoiseSource, Observation, Request};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};
use std::ops::Range;
use voronudge_model::{Column, Structure};

/// Share of a direction's size beyond the model below which the model says it already.
const ABSORBED: f64 = 1e-7;

/// A fitted model with candidates beside it.
#[derive(Debug, Clone)]
pub(super) struct Lineup {
    /// XᵀW⁻¹X over the columns of the model and of all candidates.
    information: DMatrix<f64>,
    /// XᵀW⁻¹y
    score: DVector<f64>,
    /// yᵀW⁻¹y
    data: f64,
    /// XᵀX / Σ‖v‖²: the squared size of a field relative to the data.
    sizes: DMatrix<f64>,
    /// Columns of the model.
    model: Vec<usize>,
    /// Columns of each candidate; none if it cannot be tested.
    groups: Vec<Vec<usize>>,
    /// Measured components.
    components: f64,
    /// σ_v², if it is known.
    variance: Option<f64>,
}

/// A candidate against a model.
#[derive(Debug, Clone)]
pub(super) struct Score {
    /// χ² with `dimension` degrees of freedom under the null hypothesis.
    pub statistic: f64,
    /// Coefficients that the data determine.
    pub dimension: usize,
    pub p: f64,
    /// Estimates by generalised least squares.
    pub coefficients: DVector<f64>,
    /// Their root mean square velocity relative to the data, and for a single one its 95 % interval.
    pub size: f64,
    pub interval: Option<[f64; 2]>,
    /// Root mean square velocity, relative to the data, per unit of √noncentrality.
    unit: f64,
    /// σ_v² in the statistic.
    variance: f64,
}

/// What a model leaves of the candidates.
#[derive(Debug)]
pub(super) struct Projected<'a> {
    lineup: &'a Lineup,
    /// ZᵀPZ and ZᵀPy over all columns; zero for those of the model.
    pub gram: DMatrix<f64>,
    score: DVector<f64>,
    /// yᵀPy
    pub rest: f64,
    /// Components less coefficients of the model.
    pub left: f64,
}

/// The structure of a model with candidates beside it: where the columns of both are among the coefficients.
fn enlarged(model: &Structure, candidates: &[Candidate]) -> (Structure, Vec<usize>, Vec<Vec<usize>>) {
    let all: Vec<Column> =
        candidates.iter().filter_map(|c| c.columns.as_ref().ok()).flatten().copied().collect();
    let structure = model.with(&all);
    let terms = all.iter().filter(|column| matches!(column, Column::Term(_))).count();
    let first_response = model.terms.len() + terms;
    let own = (0..model.terms.len()).chain(first_response..first_response + model.responses.len()).collect();
    let (mut next_term, mut next_response) = (model.terms.len(), first_response + model.responses.len());
    let mut place = |column: &Column| {
        let next = if matches!(column, Column::Term(_)) { &mut next_term } else { &mut next_response };
        *next += 1;
        *next - 1
    };
    let groups = candidates
        .iter()
        .map(|candidate| candidate.columns.iter().flatten().map(&mut place).collect())
        .collect();
    (structure, own, groups)
}

/// Where the coefficients of a base model and of candidates added to it are.
pub(super) struct Places {
    pub structure: Structure,
    /// Those of the base model.
    pub model: Vec<usize>,
    /// Those of each candidate added.
    pub effects: Vec<Vec<usize>>,
}

/// The base model with candidates added.
pub(super) fn added_places(model: &Structure, candidates: &[Candidate], added: &[usize]) -> Places {
    let chosen: Vec<Candidate> = added.iter().map(|candidate| candidates[*candidate].clone()).collect();
    let (structure, model, effects) = enlarged(model, &chosen);
    Places { structure, model, effects }
}

/// A fit of the base model with some candidates added as one of a model with all candidates, most of them zero.
struct Widened {
    structure: Structure,
    space: CoefficientSpace,
    coefficients: Vec<f64>,
    /// Where the columns of the base model and of each candidate are among the free directions.
    model: Vec<usize>,
    groups: Vec<Vec<usize>>,
}

impl Widened {
    /// `request` is that of the base model.
    fn new(
        request: &Request,
        candidates: &[Candidate],
        added: &[usize],
        result: &Inference,
    ) -> Result<Self, Error> {
        let (structure, own, groups) = enlarged(&request.structure, candidates);
        let places = added_places(&request.structure, candidates, added);
        let space = request.space()?.with_coefficients(structure.dimension());
        let mut coefficients = vec![0.0; structure.dimension()];
        own.iter().zip(&places.model).for_each(|(to, from)| coefficients[*to] = result.coefficients[*from]);
        for (candidate, from) in added.iter().zip(&places.effects) {
            let pairs = groups[*candidate].iter().zip(from);
            pairs.for_each(|(to, from)| coefficients[*to] = result.coefficients[*from]);
        }
        // Free directions of the base model come first; each effect has one of its own.
        let base = space.base_dimension();
        let free = |coefficient: &usize| base + coefficient - BASE;
        Ok(Self {
            model: (0..base).chain(own.iter().filter(|c| **c >= BASE).map(free)).collect(),
            groups: groups.iter().map(|group: &Vec<usize>| group.iter().map(free).collect()).collect(),
            structure,
            space,
            coefficients,
        })
    }
}

impl Widened {
    /// With unknowns of the measurement as columns of the model.
    fn with_unknowns(mut self, columns: Range<usize>) -> Self {
        self.model.extend(columns);
        self
    }

    /// The lineup from the linear problem in the coefficients alone, and the sizes of fields.
    fn lineup(self, problem: Problem, sizes: DMatrix<f64>, result: &Inference) -> Lineup {
        let Problem { information, score, data, components } = problem;
        let variance = (result.noise_source == NoiseSource::Given).then(|| result.noise.velocity.powi(2));
        let Self { model, groups, .. } = self;
        Lineup { information, score, data, sizes, model, groups, components, variance }
    }
}

/// See [`Lineup`].
struct Problem {
    information: DMatrix<f64>,
    score: DVector<f64>,
    data: f64,
    components: f64,
}

impl Lineup {
    /// Linearises about a fit of the base model with some candidates added. `request` is that of the base model. What is not known of the
    /// measurement, such as the width of windows, belongs to the model.
    pub fn new(
        frames: &[Observation],
        request: &Request,
        candidates: &[Candidate],
        added: &[usize],
        result: &Inference,
    ) -> Result<Self, Error> {
        let widened = Widened::new(request, candidates, added, result)?;
        let Widened { structure, space, coefficients, .. } = &widened;
        let mut at = space.nearest(coefficients);
        at.extend(nudges(frames, result).concat());
        let objective = Objective::new(frames, structure, space, result.noise);
        let unknowns = frames.first().map_or(&[][..], Observation::unknowns);
        let equations = objective.linearise_with(&at, unknowns)?;
        let spring = objective.spring();
        let parts: Vec<Result<Whitened, Error>> =
            equations.frames.par_iter().map(|frame| frame.whiten_data(spring)).collect();
        let parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?;
        let p = space.dimension() + unknowns.len();
        let Whitened { free: information, mixed: score, data, .. } = Whitened::sum(&parts, p);
        let sizes = equations.frames.iter().map(|f| f.free_normal() / result.total).sum();
        let components = objective.components() as f64;
        let unknowns = space.dimension()..p;
        let widened = widened.with_unknowns(unknowns);
        Ok(widened.lineup(Problem { information, score, data, components }, sizes, result))
    }

    /// The same about a fit of tracks, in which the places of the cells at all frames, and their polarities, are eliminated.
    pub fn of_tracks(
        (movie, followed): (&Movie, &Followed),
        request: &Request,
        candidates: &[Candidate],
        added: &[usize],
        result: &Inference,
    ) -> Result<Self, Error> {
        let widened = Widened::new(request, candidates, added, result)?;
        let Widened { structure, space, coefficients, .. } = &widened;
        let Beside { information, gradient: score, value: data, normal, components } =
            followed.beside(movie, structure, space, coefficients)?;
        let problem = Problem { information, score, data, components };
        Ok(widened.lineup(problem, normal / result.total, result))
    }

    /// The same with data that have back what a candidate with some coefficients explains, so that others can be put in
    /// its place.
    pub fn restored(&self, candidate: usize, coefficients: &[f64]) -> Self {
        let mut with = self.clone();
        for (k, c) in self.groups[candidate].iter().zip(coefficients) {
            with.data += 2.0 * c * with.score[*k] + c * c * with.information[(*k, *k)];
            with.score += with.information.column(*k) * *c;
        }
        with
    }

    /// Columns of a candidate.
    pub fn group(&self, candidate: usize) -> &[usize] {
        &self.groups[candidate]
    }

    /// Projects the columns of the model, and those of candidates that belong to it, out of all others.
    pub fn beyond(&self, added: &[usize]) -> Projected<'_> {
        let mut model = self.model.clone();
        added.iter().for_each(|candidate| model.extend(&self.groups[*candidate]));
        let q = model.len();
        let own = DMatrix::from_fn(q, q, |i, j| self.information[(model[i], model[j])]);
        let scale: Vec<f64> =
            model.iter().map(|k| self.information[(*k, *k)].sqrt().max(f64::MIN_POSITIVE)).collect();
        let (inverse, rank) = pseudo_inverse(&own, &scale);
        let mixed = DMatrix::from_fn(q, self.score.len(), |i, j| self.information[(model[i], j)]);
        let score = DVector::from_fn(q, |i, _| self.score[model[i]]);
        let shared = &inverse * &mixed;
        Projected {
            gram: &self.information - mixed.transpose() * &shared,
            score: &self.score - shared.transpose() * &score,
            rest: self.data - score.dot(&(&inverse * &score)),
            left: (self.components - rank as f64).max(1.0),
            lineup: self,
        }
    }

    /// Number of coefficients on offer.
    pub fn number_of_columns(&self) -> usize {
        self.groups.iter().map(Vec::len).sum()
    }

    /// Measured components less those that the model's coefficients take up.
    pub fn left(&self) -> f64 {
        self.components - self.model.len() as f64
    }
}

/// The inverse of a scaled positive matrix on the directions that are not degenerate, and their number.
fn pseudo_inverse(matrix: &DMatrix<f64>, scale: &[f64]) -> (DMatrix<f64>, usize) {
    let d = scale.len();
    if d == 0 {
        return (DMatrix::zeros(0, 0), 0);
    }
    let eigen = DMatrix::from_fn(d, d, |i, j| matrix[(i, j)] / (scale[i] * scale[j])).symmetric_eigen();
    let kept = |k: &usize| eigen.eigenvalues[*k] > ABSORBED;
    let mut inverse = DMatrix::zeros(d, d);
    for k in (0..d).filter(kept) {
        let v = eigen.eigenvectors.column(k);
        inverse += v * v.transpose() / eigen.eigenvalues[k];
    }
    (DMatrix::from_fn(d, d, |i, j| inverse[(i, j)] / (scale[i] * scale[j])), (0..d).filter(kept).count())
}

impl Projected<'_> {
    /// sᵀG⁻¹s: by how much the squared misfit falls if a candidate is added.
    pub fn gain(&self, candidate: usize) -> f64 {
        let group = self.lineup.group(candidate);
        let s = DVector::from_fn(group.len(), |i, _| self.score[group[i]]);
        s.dot(&(self.inverse(candidate).0 * &s)).max(0.0)
    }

    /// The statistic that is expected of a candidate with some coefficients, if its score is this.
    pub fn expected(&self, candidate: usize, coefficients: &[f64], score: &Score) -> f64 {
        let group = self.lineup.group(candidate);
        let pairs = group
            .iter()
            .zip(coefficients)
            .flat_map(|(i, a)| group.iter().zip(coefficients).map(move |(j, b)| a * b * self.gram[(*i, *j)]));
        pairs.sum::<f64>() / score.variance
    }

    /// The score of a candidate.
    pub fn score(&self, candidate: usize) -> Score {
        self.score_of(candidate, &self.score, self.rest)
    }

    /// The score that data with the given ZᵀPy and yᵀPy would have.
    pub fn score_of(&self, candidate: usize, score: &DVector<f64>, rest: f64) -> Score {
        let (inverse, dimension) = self.inverse(candidate);
        let group = self.lineup.group(candidate);
        let s = DVector::from_fn(group.len(), |i, _| score[group[i]]);
        let coefficients = &inverse * &s;
        let gain = s.dot(&coefficients).max(0.0);
        let d = dimension.max(1) as f64;
        let (statistic, p, variance) = match self.lineup.variance {
            Some(variance) => {
                // What is left may scatter more than the noise given: an effect must stand out against that.
                let found = ((rest - gain) / (self.left - d).max(1.0)).max(0.0);
                let statistic = gain / variance.max(found);
                (statistic, upper_chi_squared(statistic, d), variance.max(found))
            }
            None => {
                let left = (self.left - d).max(1.0);
                let variance = ((rest - gain) / left).max(f64::MIN_POSITIVE);
                let ratio = gain / variance / d;
                (gain / variance, upper_fisher(ratio, d, left), variance)
            }
        };
        let sizes = &self.lineup.sizes;
        let squared = |c: &DVector<f64>| -> f64 {
            let pairs =
                group.iter().enumerate().flat_map(|(i, a)| group.iter().enumerate().map(move |b| (i, a, b)));
            pairs.map(|(i, a, (j, b))| c[i] * c[j] * sizes[(*a, *b)]).sum::<f64>().max(0.0)
        };
        let size = squared(&coefficients).sqrt();
        let average: f64 = (0..group.len())
            .map(|i| (0..group.len()).map(|j| inverse[(i, j)] * sizes[(group[j], group[i])]).sum::<f64>())
            .sum::<f64>()
            / d;
        let unit = (average * variance).max(0.0).sqrt();
        let interval = (group.len() == 1 && dimension == 1).then(|| {
            let error = 1.96 * unit;
            [(size - error).max(0.0), size + error]
        });
        let p = if dimension == 0 { 1.0 } else { p };
        Score { statistic, dimension, p, coefficients, size, interval, unit, variance }
    }

    fn inverse(&self, candidate: usize) -> (DMatrix<f64>, usize) {
        let group = self.lineup.group(candidate);
        let own = DMatrix::from_fn(group.len(), group.len(), |i, j| self.gram[(group[i], group[j])]);
        let whole = |k: &usize| self.lineup.information[(*k, *k)].sqrt().max(f64::MIN_POSITIVE);
        pseudo_inverse(&own, &group.iter().map(whole).collect::<Vec<_>>())
    }

    /// σ_v², if it is known.
    pub fn variance(&self) -> Option<f64> {
        self.lineup.variance
    }
}

impl Score {
    /// The relative root mean square velocity that is found with a probability of 90 % if a candidate needs the given p.
    pub fn detection_limit(&self, single_p: f64) -> f64 {
        if self.dimension == 0 {
            return f64::NAN;
        }
        let d = self.dimension as f64;
        let critical = critical_chi_squared(single_p, d);
        // The noncentral χ² has mean d + λ and variance 2 d + 4 λ: λ such that its 10 % quantile is the critical value.
        let z = 1.2816;
        let (mean, spread) = (critical - d, 2.0 * z * z);
        let lambda = mean + spread + (spread * spread + 2.0 * spread * mean + spread * d).sqrt();
        self.unit * lambda.max(0.0).sqrt()
    }
}

/// P(χ²_d > x)
pub(super) fn upper_chi_squared(x: f64, d: f64) -> f64 {
    ChiSquared::new(d).map_or(f64::NAN, |chi| chi.sf(x.max(0.0)))
}

/// x such that P(χ²_d > x) is p.
pub(super) fn critical_chi_squared(p: f64, d: f64) -> f64 {
    ChiSquared::new(d).map_or(f64::NAN, |chi| chi.inverse_cdf(1.0 - p))
}

fn upper_fisher(x: f64, d: f64, left: f64) -> f64 {
    FisherSnedecor::new(d, left).map_or(f64::NAN, |fisher| fisher.sf(x.max(0.0)))
}
