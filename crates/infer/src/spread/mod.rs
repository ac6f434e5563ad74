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
mod fitting;
mod gram;
mod interval;
mod inverse;
mod levels;
mod step;

use crate::objective::Objective;
use crate::own_parts::{Layout, OwnParts, coefficient};
use crate::search::{Found, Watch};
use crate::{Error, NoiseLevels, Observation, Request};
pub(crate) use evidence::{evidence, evidence_of_field};
use fitting::{FIRST, Fitting, State};
pub(crate) use interval::probability;
use levels::Variances;
use nalgebra::{DMatrix, DVector, Matrix4};
use voronudge_model::CellParameter;

/// Rounds of variances and steps.
const ROUNDS: u64 = 8;

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

#[cfg(test)]
mod tests;
