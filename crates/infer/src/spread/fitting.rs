//! A fit with cells that differ, under way: where it stands, and the most likely variances there.

use super::columns::{FrameColumns, columns};
use super::gram::Gram;
use super::levels::{Held, Likelihood, SMALLEST, Variances};
use crate::noise::{LARGEST_POSITION_NOISE, SMALLEST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE};
use crate::normal_equations::NormalEquations;
use crate::objective::Objective;
use crate::own_parts::{Layout, OwnParts, coefficient};
use crate::{Error, KnownNoise, NoiseLevels};
use nalgebra::DVector;
use rayon::prelude::*;

/// Relative spread assumed first.
pub(super) const FIRST: f64 = 0.05;

/// Distance of the values of log k at which the likelihood is looked at.
pub(super) const SPACING: f64 = 0.4;

/// Where the fit stands.
#[derive(Clone)]
pub(super) struct State {
    pub parameters: Vec<f64>,
    /// u, relative to the parameters of `reference`.
    pub deviations: DVector<f64>,
    /// c̄
    pub reference: DVector<f64>,
    pub levels: NoiseLevels,
    pub variances: Variances,
}

/// What is linearised about a state.
pub(super) struct Linearised {
    pub equations: NormalEquations,
    pub columns: Vec<FrameColumns>,
    pub left: f64,
}

/// What stays the same throughout a fit.
pub(super) struct Fitting<'a> {
    pub objective: &'a Objective<'a>,
    pub layout: &'a Layout,
    pub known: KnownNoise,
}

impl<'a> Fitting<'a> {
    pub(super) fn own<'s>(&'s self, state: &'s State) -> OwnParts<'s> {
        OwnParts { layout: self.layout, deviations: &state.deviations, reference: &state.reference }
    }

    /// The objective of coefficients and nudges where single cells have parts of their own.
    pub(super) fn with<'s>(&'s self, own: &'s OwnParts<'s>, state: &State) -> Objective<'s> {
        Objective { own: Some(own), levels: state.levels, ..*self.objective }
    }

    fn coefficients(&self, state: &State) -> DVector<f64> {
        self.objective.space.coefficients(self.objective.split(&state.parameters).0)
    }

    /// Makes what cells have of their own relative to the present coefficients.
    pub(super) fn refer(&self, state: &mut State) {
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

    pub(super) fn linearise(&self, state: &State) -> Result<Linearised, Error> {
        let own = self.own(state);
        let columns = columns(&self.with(&own, state), &state.parameters, self.layout)?;
        self.linearised(state, columns)
    }

    /// The same with columns of the cells that are known.
    pub(super) fn linearised(&self, state: &State, columns: Vec<FrameColumns>) -> Result<Linearised, Error> {
        let own = self.own(state);
        let objective = self.with(&own, state);
        let equations = objective.linearise(&state.parameters)?;
        let left = (objective.components() as f64 - equations.dimension() as f64).max(1.0);
        Ok(Linearised { equations, columns, left })
    }

    /// `Σ u² / s²`
    pub(super) fn penalty(&self, at: &Variances, u: &DVector<f64>) -> f64 {
        let of = |(block, own): (usize, &Option<f64>)| {
            own.map_or(0.0, |own| u.rows_range(self.layout.block(block)).norm_squared() / own.exp())
        };
        at.of_cells.iter().enumerate().map(of).sum()
    }

    pub(super) fn grams(
        &self,
        state: &State,
        linearised: &Linearised,
        centre: f64,
    ) -> Result<[Gram; 3], Error> {
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
    pub(super) fn over_springs(
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
    pub(super) fn estimate(&self, state: &mut State, linearised: &Linearised) -> Result<(), Error> {
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
