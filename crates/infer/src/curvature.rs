//! What the curvature of the forces does to estimates.
//!
//! Coefficients and nudges x̂ that fit best are off from the true ones by an error that is linear in those of the data, and by what the
//! second derivative of the data f with them leaves over. To second order that is, on average, the Gauss–Newton step for
//! residuals of
//!
//! ```text
//! d = −½ E[δᵀ ∇²f δ] = ½ E[r(x̂ + δ) + r(x̂ − δ)] − r(x̂),        δ ~ N(0, covariance of x̂)
//! ```
//!
//! (M. J. Box, J. R. Stat. Soc. B 33, 171, 1971), r the residuals. It does not shrink with the number of cells, as standard errors do. The expectation is a
//! mean over draws, each with the contacts that cells have there, so it knows of the kinks of forces where contacts change.

use crate::linearisation::Linearisation;
use crate::normal_equations::{NormalEquations, Reduced};
use crate::normal_matrix::invert;
use crate::objective::{Measurable, Nudged, Objective};
use crate::position_rows::PositionRows;
use crate::residuals::residuals;
use crate::rows::Rows;
use crate::{Error, Observation};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// Draws of the errors; each is used with both signs.
const DRAWS: usize = 8;

/// Standard errors of a coefficient by which the mean over the draws may be uncertain. Where it is more, errors are too large for a second order.
const UNCERTAIN: f64 = 0.3;

/// What the free coefficients of a fit are too large by on average; zero where that cannot be told.
pub(crate) fn bias(
    objective: &Objective<'_>,
    parameters: &[f64],
    equations: &NormalEquations,
    reduced: &Reduced,
) -> Result<DVector<f64>, Error> {
    let (free, nudges) = objective.split(parameters);
    let (p, velocity) = (free.len(), objective.levels.velocity);
    let covariance = invert(reduced.information.clone())?;
    let root = covariance.clone().cholesky().ok_or(Error::Degenerate)?.l();
    let steps: Vec<DVector<f64>> = (0..DRAWS)
        .map(|draw| {
            let mut normal = normals(draw, 0);
            &root * DVector::from_fn(p, |_, _| velocity * normal())
        })
        .collect();
    let mut sums = vec![DVector::zeros(p); DRAWS];
    for (index, nudges) in nudges.iter().enumerate() {
        let about = About::new(objective, index, (free, nudges), (&equations.frames[index], &steps))?;
        let parts: Vec<Option<DVector<f64>>> =
            (0..DRAWS).into_par_iter().map(|draw| about.gradient(draw, &steps[draw])).collect();
        for (sum, part) in sums.iter_mut().zip(parts) {
            let Some(part) = part else { return Ok(DVector::zeros(p)) };
            *sum += part;
        }
    }
    let each: Vec<DVector<f64>> = sums.iter().map(|sum| &covariance * sum).collect();
    let mean = each.iter().sum::<DVector<f64>>() / DRAWS as f64;
    let is_certain = |k: usize| {
        let squares: f64 = each.iter().map(|bias| (bias[k] - mean[k]).powi(2)).sum();
        let error = (squares / (DRAWS * (DRAWS - 1)) as f64).sqrt();
        error <= UNCERTAIN * covariance[(k, k)].sqrt() * velocity
    };
    Ok(if (0..p).all(is_certain) { mean } else { DVector::zeros(p) })
}

/// Standard normal numbers of a draw; stream 0 is of the coefficients, the others of the frames.
fn normals(draw: usize, stream: usize) -> impl FnMut() -> f64 {
    let mut rng = Pcg64::seed_from_u64(((stream as u64) << 8) | draw as u64);
    move || StandardNormal.sample(&mut rng)
}

/// One frame about the fit.
struct About<'a> {
    objective: &'a Objective<'a>,
    index: usize,
    frame: &'a Observation,
    free: &'a [f64],
    nudges: &'a [f64],
    /// Of the velocities, with the roots of their weights: datum, residual, derivative by β.
    rows: Vec<(usize, Vector<f64>, DMatrix<f64>)>,
    jacobian: BlockMatrix,
    positions: PositionRows,
    /// What nudges do when coefficients decrease (n × p, by columns).
    follow: Vec<f64>,
    /// Errors of the nudges in each draw, with those of the coefficients.
    drawn: Vec<Vec<f64>>,
}

/// Residuals beside the fit.
struct Rests {
    velocities: Vec<Vector<f64>>,
    /// None where positions are a linear function of the places.
    positions: Vec<Vector<f64>>,
}

impl<'a> About<'a> {
    fn new(
        objective: &'a Objective<'a>,
        index: usize,
        (free, nudges): (&'a [f64], &'a [f64]),
        (linear, steps): (&Linearisation, &[DVector<f64>]),
    ) -> Result<Self, Error> {
        let frame = &objective.frames[index];
        let coefficients = objective.space.coefficients(free);
        let Measurable { nudged, mut rows, mut jacobian, .. } =
            objective.measurable(index, coefficients.as_slice(), nudges)?;
        frame.weigh(&mut rows, &mut jacobian);
        let positions = position_rows(frame, &nudged, nudges, free.len());
        let (drawn, follow) = (Vec::new(), Vec::new());
        let mut about =
            Self { objective, index, frame, free, nudges, rows, jacobian, positions, follow, drawn };
        let mut right = linear.mixed(objective.spring());
        right.truncate(nudges.len() * free.len());
        right.extend((0..steps.len()).flat_map(|draw| about.pull(draw)));
        about.follow = linear.solutions(objective.spring(), &right)?;
        let drawn = about.follow.split_off(nudges.len() * free.len());
        let of_draw = |(drawn, step): (&[f64], &DVector<f64>)| {
            let mut drawn = drawn.to_vec();
            for (column, delta) in about.follow.chunks_exact(drawn.len()).zip(step.iter()) {
                drawn.iter_mut().zip(column).for_each(|(e, u)| *e -= delta * u);
            }
            drawn
        };
        about.drawn = drawn.chunks_exact(nudges.len()).zip(steps).map(of_draw).collect();
        Ok(about)
    }

    fn velocities(&self) -> Rows<'_> {
        Rows { jacobian: &self.jacobian, rows: &self.rows }
    }

    /// What is missing of the right-hand side of the coefficients' step for a draw of the errors; `None` if cells cannot be there.
    fn gradient(&self, draw: usize, step: &DVector<f64>) -> Option<DVector<f64>> {
        let [up, down] = [1.0, -1.0].map(|sign| self.rests(sign, step, &self.drawn[draw]));
        let (up, down) = (up?, down?);
        let mut sum = DVector::zeros(step.len());
        let mut along = vec![0.0; self.nudges.len()];
        for ((row, up), down) in self.rows.iter().zip(&up.velocities).zip(&down.velocities) {
            let d = (up + down) * 0.5 - row.1;
            sum += row.2.transpose() * DVector::from_column_slice(d.as_slice());
            add_transposed(&self.jacobian, row.0, d, &mut along);
        }
        let places = self.positions.rows();
        if up.positions.len() != down.positions.len() {
            return None;
        }
        for (row, (up, down)) in places.rows.iter().zip(up.positions.iter().zip(&down.positions)) {
            let d = (up + down) * 0.5 - row.1;
            add_transposed(places.jacobian, row.0, d * self.objective.spring(), &mut along);
        }
        for (k, column) in self.follow.chunks_exact(along.len()).enumerate() {
            sum[k] -= column.iter().zip(&along).map(|(u, a)| u * a).sum::<f64>();
        }
        sum.iter().all(|x| x.is_finite()).then_some(sum)
    }

    /// What errors of the data pull nudges with.
    fn pull(&self, draw: usize) -> Vec<f64> {
        let mut normal = normals(draw, self.index + 1);
        let velocity = self.objective.levels.velocity;
        let mut pull = vec![0.0; self.nudges.len()];
        for (data, weight) in [(self.velocities(), 1.0), (self.positions.rows(), self.objective.spring())] {
            let size = velocity * f64::sqrt(weight);
            for (datum, ..) in data.rows {
                add_transposed(data.jacobian, *datum, Vector::new(normal(), normal()) * size, &mut pull);
            }
        }
        let size = velocity * self.objective.floor().sqrt();
        for (_, e) in pull.chunks_exact_mut(2).enumerate().filter(|(cell, _)| !self.frame.is_seen(*cell)) {
            e.iter_mut().for_each(|e| *e += size * normal());
        }
        pull
    }

    fn rests(&self, sign: f64, step: &DVector<f64>, nudges: &[f64]) -> Option<Rests> {
        let moved = |from: &[f64], by: &[f64]| -> Vec<f64> {
            from.iter().zip(by).map(|(x, d)| x + sign * d).collect()
        };
        let coefficients = self.objective.space.coefficients(&moved(self.free, step.as_slice()));
        let nudges = moved(self.nudges, nudges);
        let nudged = self.objective.displaced(self.index, &nudges).ok()?;
        let rests = residuals(self.frame, &nudged.evaluate(coefficients.as_slice()).predicted);
        let velocities =
            rests.into_iter().map(|(datum, rest)| rest * self.frame.weight(datum).sqrt()).collect();
        let positions = match self.frame.share() {
            0.0 => Vec::new(),
            _ => {
                let positions = position_rows(self.frame, &nudged, &nudges, self.free.len());
                positions.rows().rows.iter().map(|row| row.1).collect()
            }
        };
        Some(Rests { velocities, positions })
    }
}

fn position_rows(frame: &Observation, nudged: &Nudged<'_>, nudges: &[f64], p: usize) -> PositionRows {
    PositionRows::new(frame, &nudged.tessellation, &nudged.positions, nudges, p, None)
}

/// Adds a row of a matrix, transposed, times a vector.
fn add_transposed(matrix: &BlockMatrix, row: usize, v: Vector<f64>, to: &mut [f64]) {
    for (column, b) in matrix.row(row) {
        to[2 * column] += b[0] * v.x + b[2] * v.y;
        to[2 * column + 1] += b[1] * v.x + b[3] * v.y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::refine;
    use crate::{CoefficientSpace, Constraints, FitParameter, NoiseLevels, Velocities};
    use voronudge_model::Structure;

    /// Data with errors of either sign: what is linear in these cancels in the mean of both fits.
    #[test]
    fn fits_of_many_draws_are_off_by_the_bias_on_average() {
        const PAIRS: usize = 100;
        let (noise, structure) = (0.01, Structure::base(1.0));
        let space =
            CoefficientSpace::new(&Constraints::fixed([(FitParameter::AreaElasticity, 0.1)])).unwrap();
        let truth = crate::sample::observation(0.0, 0.0, 1);
        let levels = NoiseLevels { position: noise, velocity: noise };
        let free = space.nearest(&crate::sample::COEFFICIENTS);
        let start = |nudges: &[f64]| -> Vec<f64> { free.iter().chain(nudges).copied().collect() };
        let exact = std::slice::from_ref(&truth);
        let objective = Objective::new(exact, &structure, &space, levels);
        let at = start(&[0.0; 72]);
        let equations = objective.linearise(&at).unwrap();
        let reduced = equations.reduced().unwrap();
        let told = bias(&objective, &at, &equations, &reduced).unwrap();
        let mut found: DVector<f64> = DVector::zeros(free.len());
        for pair in 0..PAIRS {
            let mut normal = normals(pair, 7);
            let errors: Vec<f64> = (0..144).map(|_| noise * normal()).collect();
            for sign in [1.0, -1.0] {
                let error = |k: usize| Vector::new(errors[2 * k], errors[2 * k + 1]) * sign;
                let velocities = truth.targets().map(|(k, v)| Some(v + error(36 + k))).collect::<Vec<_>>();
                let positions = truth.positions.iter().enumerate().map(|(k, r)| r + error(k)).collect();
                let measured = Observation::new(
                    0,
                    positions,
                    Velocities::OfCells(velocities),
                    truth.tessellation.domain(),
                    voronudge_geometry::FieldOfView::default(),
                )
                .unwrap();
                let frames = [measured];
                let objective = Objective::new(&frames, &structure, &space, levels);
                let back: Vec<f64> = errors[..72].iter().map(|e| -sign * e).collect();
                let fit = refine(&objective, start(&back), 100).unwrap();
                for (sum, (fitted, free)) in found.iter_mut().zip(fit.parameters.iter().zip(&free)) {
                    *sum += (fitted - free) / (2 * PAIRS) as f64;
                }
            }
        }
        let unit = invert(reduced.information).unwrap().diagonal().map(|variance| noise * variance.sqrt());
        for k in 0..free.len() {
            let [told, found] = [told[k] / unit[k], found[k] / unit[k]];
            println!("{k}: {told} {found}");
            assert!((told - found).abs() < 0.3 * found.abs() + 0.01, "{k}: {told} {found}");
        }
    }
}
