//! First-order descent on the loss as the paper prints it, to compare with.
//!
//! ```text
//! L = ‖v − F_β(r + ε)‖ + κ ‖ε‖        norms, not their squares
//! ```
//!
//! κ is chosen as the paper chooses it: both terms are to contribute alike at the end. Each direction is the gradient;
//! the length of a step follows from backtracking to a sufficient decrease, and coefficients are scaled by the norms of
//! their columns. At the end the coefficients are those that fit best at the nudged positions.

use super::found::Found;
use super::optimise::own_error;
use super::watch::Watch;
use crate::least_squares::fit_at;
use crate::objective::{Nudged, Objective};
use crate::residuals::{free_rows, residuals};
use crate::{Error, Loss, Status};
use argmin::core::{CostFunction, Error as ArgminError, Executor, Gradient};
use argmin::solver::gradientdescent::SteepestDescent;
use argmin::solver::linesearch::BacktrackingLineSearch;
use argmin::solver::linesearch::condition::ArmijoCondition;
use voronudge_geometry::Vector;

/// Rounds in which κ is adapted; each has its share of the steps.
const ROUNDS: u64 = 4;

/// Steps between two reports of progress.
const CHUNK: u64 = 25;

/// Relative decrease over a chunk that counts as none.
const TOLERANCE: f64 = 1e-7;

/// The loss as a problem for argmin, in scaled coefficients.
struct Problem<'a> {
    objective: &'a Objective<'a>,
    kind: Loss,
    /// κ for norms, k for squares.
    spring: f64,
    /// β per scaled β.
    scale: Vec<f64>,
}

/// Descends from zero nudges and the given β, for at most so many steps.
pub(crate) fn descend(
    objective: &Objective<'_>,
    free: &[f64],
    kind: Loss,
    max_steps: u64,
    watch: &mut Watch<'_>,
) -> Result<Found, Error> {
    let mut loss = Problem { objective, kind, spring: objective.spring(), scale: scales(objective, free) };
    if kind == Loss::Norms {
        // What the noise levels lead to expect of the two norms.
        loss.spring = loss.spring.sqrt();
    }
    let mut at = free.to_vec();
    at.resize(free.len() + objective.nudge_count(), 0.0);
    loss.to_scaled(&mut at);
    let (mut steps, mut trace, mut status) = (0, Vec::new(), Status::StepLimit);
    for round in 1..=ROUNDS {
        status = Status::StepLimit;
        while steps < max_steps * round / ROUNDS {
            let before = loss.value(&at);
            let wanted = CHUNK.min(max_steps * round / ROUNDS - steps);
            at = loss.steps(at, wanted)?;
            steps += wanted;
            let after = loss.value(&at);
            trace.push(objective.value(&loss.unscaled(&at)));
            watch.tell("gradient descent", (steps, max_steps), after / before)?;
            if before - after <= TOLERANCE * before {
                status = Status::Stalled;
                break;
            }
        }
        if kind == Loss::Norms && round < ROUNDS {
            let parts = objective.parts(&loss.unscaled(&at));
            if parts.nudges > 0.0 && parts.residual > 0.0 {
                loss.spring = (parts.residual / parts.nudges).sqrt();
            }
        }
    }
    let mut parameters = loss.unscaled(&at);
    refit(objective, &mut parameters)?;
    let value = objective.value(&parameters);
    trace.push(value);
    Ok(Found::by(parameters, value, status, steps, trace))
}

/// The best coefficients at the nudged positions.
fn refit(objective: &Objective<'_>, parameters: &mut [f64]) -> Result<(), Error> {
    let (_, nudges) = objective.split(parameters);
    let placed = nudges
        .into_iter()
        .enumerate()
        .map(|(index, nudges)| objective.displaced(index, nudges))
        .collect::<Result<Vec<_>, _>>()?;
    let free = fit_at(objective.frames, &placed, objective.structure, objective.space)?;
    parameters[..free.len()].copy_from_slice(&free);
    Ok(())
}

/// One over the norm of each free column at the measured positions.
fn scales(objective: &Objective<'_>, free: &[f64]) -> Vec<f64> {
    let coefficients = objective.space.coefficients(free);
    let mut squares = vec![0.0; free.len()];
    for frame in objective.frames {
        let evaluated = Nudged::as_measured(frame, objective.structure).evaluate(coefficients.as_slice());
        for x in free_rows(frame, &evaluated.by_coefficient, objective.space) {
            squares.iter_mut().zip(x.column_iter()).for_each(|(sum, column)| *sum += column.norm_squared());
        }
    }
    squares.into_iter().map(|square: f64| 1.0 / square.sqrt()).collect()
}

impl Problem<'_> {
    fn to_scaled(&self, parameters: &mut [f64]) {
        parameters.iter_mut().zip(&self.scale).for_each(|(x, scale)| *x /= scale);
    }

    fn unscaled(&self, scaled: &[f64]) -> Vec<f64> {
        let mut parameters = scaled.to_vec();
        parameters.iter_mut().zip(&self.scale).for_each(|(x, scale)| *x *= scale);
        parameters
    }

    fn value(&self, scaled: &[f64]) -> f64 {
        let parts = self.objective.parts(&self.unscaled(scaled));
        let value = match self.kind {
            Loss::Norms => parts.residual.sqrt() + self.spring * parts.nudges.sqrt(),
            Loss::Squares => parts.residual + self.spring * parts.nudges + parts.priors,
        };
        if value.is_nan() { f64::INFINITY } else { value }
    }

    /// So many steps of argmin's steepest descent.
    fn steps(&self, from: Vec<f64>, count: u64) -> Result<Vec<f64>, Error> {
        let condition = ArmijoCondition::new(1e-4).map_err(own_error)?;
        let search = BacktrackingLineSearch::new(condition).rho(0.5).map_err(own_error)?;
        let executor = Executor::new(self, SteepestDescent::new(search))
            .configure(|state| state.param(from).max_iters(count))
            .ctrlc(false);
        let mut state = executor.run().map_err(own_error)?.state;
        state.take_best_param().ok_or_else(|| Error::Optimiser("no best point".into()))
    }

    /// ∂L/∂(scaled β, ε).
    fn slope(&self, scaled: &[f64]) -> Result<Vec<f64>, Error> {
        let parameters = self.unscaled(scaled);
        let objective = self.objective;
        let (free, nudges) = objective.split(&parameters);
        let coefficients = objective.space.coefficients(free);
        let p = free.len();
        // Half the derivatives of the sums of squares.
        let (mut of_residual, mut residual, mut squares) = (vec![0.0; parameters.len()], 0.0, 0.0);
        let mut offset = p;
        for (index, (frame, nudges)) in objective.frames.iter().zip(&nudges).enumerate() {
            let nudged = objective.displaced(index, nudges)?;
            let evaluated = nudged.evaluate(coefficients.as_slice());
            let jacobian = nudged.jacobian(coefficients.as_slice(), &evaluated.of_cells);
            let rows = free_rows(frame, &evaluated.by_coefficient, objective.space);
            for ((datum, rest), x) in residuals(frame, &evaluated.predicted).into_iter().zip(rows) {
                for k in 0..p {
                    of_residual[k] -= Vector::new(x[(0, k)], x[(1, k)]).dot(&rest);
                }
                for (column, b) in jacobian.row(datum) {
                    of_residual[offset + 2 * column] -= b[0] * rest.x + b[2] * rest.y;
                    of_residual[offset + 2 * column + 1] -= b[1] * rest.x + b[3] * rest.y;
                }
                residual += rest.norm_squared();
            }
            squares += nudges.iter().map(|e| e * e).sum::<f64>();
            offset += nudges.len();
        }
        let (left, right) = match self.kind {
            Loss::Norms => (
                1.0 / residual.sqrt().max(f64::MIN_POSITIVE),
                // At zero nudges the norm has no derivative; its subgradient zero lets the nudges start.
                if squares > 0.0 { self.spring / squares.sqrt() } else { 0.0 },
            ),
            Loss::Squares => (2.0, 2.0 * self.spring),
        };
        let mut slope: Vec<f64> = of_residual.into_iter().map(|part| part * left).collect();
        slope[p..].iter_mut().zip(&parameters[p..]).for_each(|(s, e)| *s += right * e);
        slope.iter_mut().zip(&self.scale).for_each(|(s, scale)| *s *= scale);
        Ok(slope)
    }
}

impl CostFunction for &Problem<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, scaled: &Vec<f64>) -> Result<f64, ArgminError> {
        Ok(self.value(scaled))
    }
}

impl Gradient for &Problem<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, scaled: &Vec<f64>) -> Result<Vec<f64>, ArgminError> {
        Ok(self.slope(scaled)?)
    }
}
