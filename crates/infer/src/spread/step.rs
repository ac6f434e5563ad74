//! Steps of coefficients, nudges and deviations together, and what deviations mean at the end.

use super::Spread;
use super::fitting::{Fitting, Linearised, State};
use super::gram::Gram;
use super::inverse::inverse;
use crate::Error;
use crate::linearisation::Accuracy;
use crate::noisy_fit::STEPS_PER_ROUND;
use crate::normal_matrix::{invert, within_bounds};
use crate::search::refine;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Halvings of a step at most.
const HALVINGS: usize = 8;

/// D (I + D ZᵀW⁻¹Z D)⁻¹ D, as an inverse between D.
struct Prior {
    roots: DVector<f64>,
    inverse: DMatrix<f64>,
}

impl Prior {
    fn new(roots: DVector<f64>, of_cells: &DMatrix<f64>) -> Result<Self, Error> {
        let m = roots.len();
        let scaled = DMatrix::from_fn(m, m, |i, j| {
            roots[i] * of_cells[(i, j)] * roots[j] + if i == j { 1.0 } else { 0.0 }
        });
        Ok(Self { roots, inverse: inverse(&scaled)?.0 })
    }

    fn times(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let scale = |mut matrix: DMatrix<f64>| {
            matrix.column_iter_mut().for_each(|mut column| column.component_mul_assign(&self.roots));
            matrix
        };
        scale(&self.inverse * scale(right.clone()))
    }

    fn of(&self, right: &DVector<f64>) -> DVector<f64> {
        (&self.inverse * right.component_mul(&self.roots)).component_mul(&self.roots)
    }
}

impl Fitting<'_> {
    fn gram(&self, state: &State, linearised: &Linearised) -> Result<Gram, Error> {
        let log_k = state.levels.spring().ln();
        Gram::new(&linearised.equations, &linearised.columns, log_k, &state.deviations)
    }

    /// What the spreads take off the information on the coefficients.
    pub fn spent(&self, state: &State, linearised: &Linearised) -> Result<DMatrix<f64>, Error> {
        let gram = self.gram(state, linearised)?;
        let prior = Prior::new(state.variances.roots(self.layout), &gram.of_cells)?;
        Ok(gram.mixed.tr_mul(&prior.times(&gram.mixed)))
    }

    /// Φ with the penalty of the deviations.
    pub fn value(&self, state: &State) -> f64 {
        let penalty = self.penalty(&state.variances, &state.deviations);
        let own = self.own(state);
        self.with(&own, state).value(&state.parameters) + penalty * state.levels.velocity.powi(2)
    }

    /// One Gauss–Newton step, halved until it gains; by what share of itself the objective decreases.
    pub fn step(&self, state: &mut State, linearised: &Linearised) -> Result<f64, Error> {
        let gram = self.gram(state, linearised)?;
        // Deviations of a spread that is none are none.
        for (block, own) in state.variances.of_cells.iter().enumerate() {
            if own.is_none() {
                state.deviations.rows_range_mut(self.layout.block(block)).fill(0.0);
            }
        }
        let roots = state.variances.roots(self.layout);
        let prior = Prior::new(roots.clone(), &gram.of_cells)?;
        let reduced = linearised.equations.reduced_at(state.levels)?;
        let held =
            state.deviations.zip_map(&roots, |u, root| if root > 0.0 { u / (root * root) } else { 0.0 });
        let gradient = &gram.gradient - held;
        let information = &reduced.information - gram.mixed.tr_mul(&prior.times(&gram.mixed));
        let pull = &reduced.gradient - gram.mixed.tr_mul(&prior.of(&gradient));
        let (free, nudges) = self.objective.split(&state.parameters);
        let free = DVector::from_column_slice(free);
        let newton = &free + invert(information.clone())? * pull;
        let free_step = within_bounds(self.objective.space, newton, information)? - &free;
        let of_cells = prior.of(&(gradient - &gram.mixed * &free_step));
        let mut step = free_step.as_slice().to_vec();
        let frames = linearised.equations.frames.par_iter().zip(&gram.solved);
        let of_frames = frames
            .map(|(frame, solved)| {
                let spring = state.levels.spring();
                let own = frame.eliminate(spring, &[], Accuracy::OfResults)?.nudge_step(&free_step);
                Ok((DVector::from_vec(own) - solved * &of_cells).as_slice().to_vec())
            })
            .collect::<Result<Vec<_>, Error>>()?;
        debug_assert_eq!(of_frames.len(), nudges.len());
        step.extend(of_frames.into_iter().flatten());
        let before = self.value(state);
        let mut scale = 1.0;
        for _ in 0..HALVINGS {
            let next = State {
                parameters: state.parameters.iter().zip(&step).map(|(at, step)| at + scale * step).collect(),
                deviations: &state.deviations + &of_cells * scale,
                ..state.clone()
            };
            let after = self.value(&next);
            if after < before {
                *state = next;
                self.settle(state)?;
                return Ok((before - self.value(state)) / before);
            }
            scale *= 0.5;
        }
        // Where contacts change, the nudges may have to go another way.
        let mut next = State { deviations: &state.deviations + &of_cells, ..state.clone() };
        self.settle(&mut next)?;
        let after = self.value(&next);
        if after < before {
            *state = next;
        }
        Ok(((before - after) / before).max(0.0))
    }

    /// Lets coefficients and nudges follow the deviations.
    fn settle(&self, state: &mut State) -> Result<(), Error> {
        let own = self.own(state);
        let settled = refine(&self.with(&own, state), state.parameters.clone(), STEPS_PER_ROUND)?;
        state.parameters = settled.parameters;
        Ok(())
    }

    /// The spreads at the end of a fit.
    pub fn spreads(&self, state: &State, linearised: &Linearised) -> Result<Vec<Spread>, Error> {
        let gram = self.gram(state, linearised)?;
        let roots = state.variances.roots(self.layout);
        let products = &gram.reduced.of_cells;
        let m = roots.len();
        let scaled = DMatrix::from_fn(m, m, |i, j| {
            roots[i] * products[(i, j)] * roots[j] + if i == j { 1.0 } else { 0.0 }
        });
        let (inverse, _) = inverse(&scaled)?;
        let velocity = state.levels.velocity;
        let profiles = self.profiles(state, linearised)?;
        let parameters = self.layout.parameters.iter().zip(profiles).enumerate();
        let spreads = parameters.map(|(block, (parameter, profile))| {
            let first = self.layout.block(block).start;
            let of_cell = |cell: &usize| {
                let i = first + cell;
                [state.deviations[i], velocity * roots[i] * inverse[(i, i)].sqrt()]
            };
            Spread {
                parameter: *parameter,
                value: state.variances.ratio(block).sqrt() * velocity,
                interval: profile.interval,
                p: profile.p,
                deviations: self
                    .layout
                    .of_frames
                    .iter()
                    .map(|own| own.iter().map(of_cell).collect())
                    .collect(),
            }
        });
        Ok(spreads.collect())
    }
}
