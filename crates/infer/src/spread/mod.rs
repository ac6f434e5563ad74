//! Cells that differ: parameters of single cells as random effects.
//!
//! Velocities are linear in the multiples of a parameter that the cells have, so with deviations u of variance s_q²
//!
//! ```text
//! v = F_β(r + ε) + Σ_q Z_q u_q + n,        u_q ~ N(0, s_q²),    ε ~ N(0, σ_r²),    n ~ N(0, σ_v²)
//! ```
//!
//! What a cell has of its own stays as it is where the coefficients change: u is relative to a coefficient c̄ held for the time of a step, so X is that of
//! cells that are alike and Z does not depend on β. Were both to follow the coefficients, the least `Σ u²/s²` would be had with coefficients too large and
//! deviations too small by the same factor.
//!
//! The deviations are unknowns beside the nudges. Variances are found by restricted likelihood of the linearised problem, deviations and nudges are
//! what is expected of them given the data, and both follow from each other until they stay.

mod columns;
mod evidence;
mod gram;
mod interval;
mod inverse;
mod levels;
mod step;

use crate::noise::{LARGEST_POSITION_NOISE, SMALLEST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE};
use crate::normal_equations::NormalEquations;
use crate::objective::Objective;
use crate::own_parts::{Layout, OwnParts, coefficient};
use crate::search::{Found, Watch};
use crate::{Error, KnownNoise, NoiseLevels, Observation, Request};
use columns::{FrameColumns, columns};
pub(crate) use evidence::{evidence, evidence_of_field};
use gram::Gram;
pub(crate) use interval::probability;
use levels::{Held, Likelihood, SMALLEST, Variances};
use nalgebra::{DMatrix, DVector, Matrix4};
use rayon::prelude::*;
use voronudge_model::CellParameter;

/// Rounds of variances and steps.
const ROUNDS: u64 = 8;

/// Distance of the values of log k at which the likelihood is looked at.
const SPACING: f64 = 0.4;

/// Relative spread assumed first.
const FIRST: f64 = 0.05;

/// Decrease of the objective, as a share of it, that counts as none.
const TOLERANCE: f64 = 1e-4;

/// How much cells differ in one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// The parameter.
    pub parameter: CellParameter,
    /// Standard deviation over cells, relative to the parameter.
    pub value: f64,
    /// Ends of the 95 % interval by the profile of the restricted likelihood and the standard error of the coefficient that this is a share of;
    /// `None` where it goes on.
    pub interval: [Option<f64>; 2],
    /// Probability of so large a likelihood ratio if cells do not differ in this parameter but do in the others.
    pub p: f64,
    /// Deviation and its standard error for each cell of each frame (F, N), relative to the parameter: what is expected given the data, shrunk towards zero.
    pub deviations: Vec<Vec<[f64; 2]>>,
}

/// A fit with cells that differ.
pub(crate) struct Differing {
    /// With intervals that take the coefficients for known.
    spreads: Vec<Spread>,
    /// The frames with the parameters of their cells.
    pub frames: Vec<Observation>,
    pub found: Found,
    pub levels: NoiseLevels,
    /// What the spreads take off the information on the coefficients, in units of 1/σ_v².
    pub spent: DMatrix<f64>,
    layout: Layout,
    deviations: DVector<f64>,
    reference: DVector<f64>,
}

impl Differing {
    /// What cells have of their own beside the frames in which they are alike.
    pub fn own(&self) -> OwnParts<'_> {
        OwnParts { layout: &self.layout, deviations: &self.deviations, reference: &self.reference }
    }

    /// The spreads where the coefficients that they are shares of are not known any better than to a covariance.
    pub fn spreads_beside(&self, coefficients: &DVector<f64>, covariance: &Matrix4<f64>) -> Vec<Spread> {
        let of = |spread: &Spread| {
            let which = coefficient(spread.parameter);
            let relative_error = covariance[(which, which)].sqrt() / coefficients[which].abs();
            Spread {
                interval: interval::of_share(spread.value, spread.interval, relative_error),
                ..spread.clone()
            }
        };
        self.spreads.iter().map(of).collect()
    }
}

/// Where the fit stands.
#[derive(Clone)]
struct State {
    parameters: Vec<f64>,
    /// u, relative to the parameters of `reference`.
    deviations: DVector<f64>,
    /// c̄
    reference: DVector<f64>,
    levels: NoiseLevels,
    variances: Variances,
}

/// What is linearised about a state.
struct Linearised {
    equations: NormalEquations,
    columns: Vec<FrameColumns>,
    left: f64,
}

/// Lets cells differ in the parameters of the request, from a fit in which they do not.
///
/// # Errors
/// [`Error::Spread`] for data that cannot tell, [`Error`] otherwise as a fit.
pub(crate) fn fit(
    objective: &Objective<'_>,
    found: Found,
    request: &Request,
    watch: &mut Watch<'_>,
) -> Result<Differing, Error> {
    if !request.structure.responses.is_empty() {
        return Err(Error::Spread(
            "cells that differ go with terms, not with what acts on velocities as a whole",
        ));
    }
    let layout = Layout::new(objective.frames, &request.varied)?;
    let fitting = Fitting { objective, layout: &layout, known: request.noise };
    let u = DVector::zeros(layout.order());
    let velocity = 2.0 * objective.levels.velocity.ln();
    let mut state = State {
        parameters: found.parameters.clone(),
        deviations: u,
        reference: objective.space.coefficients(objective.split(&found.parameters).0),
        levels: objective.levels,
        variances: Variances { velocity, of_cells: vec![Some(2.0 * FIRST.ln()); request.varied.len()] },
    };
    let mut steps = 0;
    for round in 0..ROUNDS {
        watch.tell("spreads", (round, ROUNDS), found.value / objective.expected())?;
        fitting.refer(&mut state);
        let linearised = fitting.linearise(&state)?;
        fitting.estimate(&mut state, &linearised)?;
        let gained = fitting.step(&mut state, &linearised)?;
        steps += 1;
        if gained < TOLERANCE && round >= 2 {
            break;
        }
    }
    watch.tell("spreads", (ROUNDS, ROUNDS), found.value / objective.expected())?;
    fitting.refer(&mut state);
    let linearised = fitting.linearise(&state)?;
    let spreads = fitting.spreads(&state, &linearised)?;
    let spent = fitting.spent(&state, &linearised)?;
    let value = fitting.value(&state);
    let frames = fitting.own(&state).frames(objective.frames)?;
    let State { parameters, deviations, reference, levels, .. } = state;
    let found = Found { parameters, value, steps: found.steps + steps, ..found };
    Ok(Differing { spreads, frames, found, levels, spent, layout, deviations, reference })
}

/// What stays the same throughout a fit.
struct Fitting<'a> {
    objective: &'a Objective<'a>,
    layout: &'a Layout,
    known: KnownNoise,
}

impl<'a> Fitting<'a> {
    fn own<'s>(&'s self, state: &'s State) -> OwnParts<'s> {
        OwnParts { layout: self.layout, deviations: &state.deviations, reference: &state.reference }
    }

    /// The objective of coefficients and nudges where single cells have parts of their own.
    fn with<'s>(&'s self, own: &'s OwnParts<'s>, state: &State) -> Objective<'s> {
        Objective { own: Some(own), levels: state.levels, ..*self.objective }
    }

    fn coefficients(&self, state: &State) -> DVector<f64> {
        self.objective.space.coefficients(self.objective.split(&state.parameters).0)
    }

    /// Makes what cells have of their own relative to the present coefficients.
    fn refer(&self, state: &mut State) {
        let present = self.coefficients(state);
        for (block, parameter) in self.layout.parameters.iter().enumerate() {
            let ratio = state.reference[coefficient(*parameter)] / present[coefficient(*parameter)];
            if ratio.is_finite() {
                state.deviations.rows_range_mut(self.layout.block(block)).scale_mut(ratio);
                let variance = &mut state.variances.of_cells[block];
                *variance = variance.map(|own| own + 2.0 * ratio.abs().ln());
            }
        }
        state.reference = present;
    }

    fn linearise(&self, state: &State) -> Result<Linearised, Error> {
        let own = self.own(state);
        let columns = columns(&self.with(&own, state), &state.parameters, self.layout)?;
        self.linearised(state, columns)
    }

    /// The same with columns of the cells that are known.
    fn linearised(&self, state: &State, columns: Vec<FrameColumns>) -> Result<Linearised, Error> {
        let own = self.own(state);
        let objective = self.with(&own, state);
        let equations = objective.linearise(&state.parameters)?;
        let left = (objective.components() as f64 - equations.dimension() as f64).max(1.0);
        Ok(Linearised { equations, columns, left })
    }

    /// `Σ u² / s²`
    fn penalty(&self, at: &Variances, u: &DVector<f64>) -> f64 {
        let of = |(block, own): (usize, &Option<f64>)| {
            own.map_or(0.0, |own| u.rows_range(self.layout.block(block)).norm_squared() / own.exp())
        };
        at.of_cells.iter().enumerate().map(of).sum()
    }

    fn grams(&self, state: &State, linearised: &Linearised, centre: f64) -> Result<[Gram; 3], Error> {
        let at = |log_k: f64| Gram::new(&linearised.equations, &linearised.columns, log_k, &state.deviations);
        Ok([at(centre - SPACING)?, at(centre)?, at(centre + SPACING)?])
    }

    /// The most likely variances at one spring.
    fn most_likely(
        &self,
        gram: &Gram,
        left: f64,
        start: &Variances,
        held: Option<usize>,
    ) -> Result<(Variances, f64), Error> {
        let likelihood = Likelihood { layout: self.layout, products: &gram.reduced, left };
        let mut start = start.clone();
        let stated = self.known.variance(gram.log_k);
        if let Some(variance) = stated {
            start.velocity = variance.ln();
        }
        likelihood.most_likely(&start, Held { velocity: stated.is_some(), parameter: held })
    }

    /// The most likely log k, variances and −2 log L near some, by the parabola through three values of log k.
    fn over_springs(
        &self,
        grams: &[Gram; 3],
        left: f64,
        start: &Variances,
        held: Option<usize>,
    ) -> Result<(f64, Variances, f64), Error> {
        if self.known.velocity.is_some() && self.known.position.is_some() {
            let (variances, criterion) = self.most_likely(&grams[1], left, start, held)?;
            return Ok((grams[1].log_k, variances, criterion));
        }
        let found = grams
            .par_iter()
            .map(|gram| self.most_likely(gram, left, start, held))
            .collect::<Result<Vec<_>, _>>()?;
        let (slope, bend) = (found[2].1 - found[0].1, found[2].1 - 2.0 * found[1].1 + found[0].1);
        let step = match bend > 0.0 {
            true => (-0.5 * slope / bend).clamp(-2.0, 2.0),
            false => -(2.0_f64.copysign(slope)),
        };
        let inside = step.clamp(-1.0, 1.0);
        let criterion = found[1].1 + 0.5 * inside * slope + 0.5 * inside * inside * bend;
        let nearest = (inside.round() + 1.0) as usize;
        Ok((grams[1].log_k + step * SPACING, found[nearest].0.clone(), criterion))
    }

    /// Noise levels and spreads of greatest restricted likelihood.
    fn estimate(&self, state: &mut State, linearised: &Linearised) -> Result<(), Error> {
        let mut start = state.variances.clone();
        // A spread that was none may be some at other nudges.
        start.of_cells.iter_mut().for_each(|own| *own = own.or(Some(2.0 * (4.0 * SMALLEST).ln())));
        let grams = self.grams(state, linearised, state.levels.spring().ln())?;
        let (log_k, variances, _) = self.over_springs(&grams, linearised.left, &start, None)?;
        let gram = Gram::new(&linearised.equations, &linearised.columns, log_k, &state.deviations)?;
        let (variances, _) = self.most_likely(&gram, linearised.left, &variances, None)?;
        let velocity = (0.5 * variances.velocity).exp().max(SMALLEST_VELOCITY_NOISE);
        let position =
            (velocity * (-0.5 * log_k).exp()).clamp(SMALLEST_POSITION_NOISE, LARGEST_POSITION_NOISE);
        state.levels = NoiseLevels {
            velocity: self.known.velocity.unwrap_or(velocity),
            position: self.known.position.unwrap_or(position),
        };
        state.variances = Variances { velocity: 2.0 * state.levels.velocity.ln(), ..variances };
        Ok(())
    }
}

#[cfg(test)]
mod tests;
