//! T1 transitions within a step of integration.
//!
//! ```text
//! ∫F dt ≈ h Σ_i w_i F_i + h Σ_q [ ∫_τ^1 ΔF_q(c) dc − Σ_i w_i ΔF_q(c_i) ],        ΔF_q(c) = (1 − c) ΔF_q(x_1) + c ΔF_q(x_4)
//! ```
//!
//! Where neighbours change, velocities jump by ΔF, from the fraction τ of the step on at which the side that vanishes has no length. Of
//! the stages of a step, at its shares c_i and with weights w_i, those that have the new neighbours (the second sum) would count the jump from
//! wherever they are. With the further term the displacement does not leap where a transition moves from one stage, or one step, to another.

use super::stages::{Derivatives, MIDDLE, STAGES, Stage};
use crate::objective::Nudged;
use nalgebra::DMatrix;
use std::sync::Arc;
use voronudge_geometry::{Side, Transition, Vector};
use voronudge_model::{Environment, Exchange, JumpSlopes, Model, Structure};

/// By how much a side shrinks at least over the time between two frames, in units of ℓ₀, if its transition is to be dated.
const GRAZING: f64 = 0.01;

/// A transition within a step.
pub(super) struct Turn {
    /// The four cells.
    pub cells: [usize; 4],
    /// Fraction of the step at which it happens.
    fraction: f64,
    /// The jump at the beginning of the step and at its last stage.
    jumps: [Jump; 2],
    /// What these weigh beside the stages.
    weights: [f64; 2],
    /// What they weigh beside the second estimate of the middle alone.
    beside_middle: [f64; 2],
    /// Derivative of the fraction by the places of the four cells at the beginning and at the last stage.
    pub slopes: [[Vector<f64>; 4]; 2],
}

/// What the new neighbours change of the velocities of the four cells at some positions.
struct Jump {
    exchange: Exchange,
    /// The numbers that the four cells have in the exchange, and its sign: it may be the way back.
    order: [usize; 4],
    sign: f64,
    /// The jump of the four cells by each coefficient.
    by_coefficient: Vec<[Vector<f64>; 4]>,
}

impl Jump {
    fn new(
        at: &Nudged<'_>,
        exchange: Exchange,
        cells: [usize; 4],
        sign: f64,
        terms: &[Model<f64>],
    ) -> Option<Self> {
        let number = cells.map(|cell| exchange.cells.iter().position(|own| *own == cell));
        let [Some(a), Some(b), Some(c), Some(d)] = number else { return None };
        let order = [a, b, c, d];
        let jumps = exchange.jumps(&at.tessellation, &at.positions, terms);
        let by_coefficient = jumps.iter().map(|jump| order.map(|number| jump[number] * sign)).collect();
        Some(Self { by_coefficient, exchange, order, sign })
    }
}

/// The terms of a model, one by one.
pub(super) fn single_terms(structure: &Structure, environment: &Arc<Environment>) -> Vec<Model<f64>> {
    structure.terms.iter().map(|term| Model::single(*term).within(environment)).collect()
}

impl Turn {
    /// The transitions within a step that takes a share of the time between two frames.
    pub fn within(stages: &[Stage<'_>; 4], terms: &[Model<f64>], share: f64) -> Vec<Self> {
        let least = GRAZING * share;
        let ends = [&stages[0].0, &stages[3].0];
        let turn = |transition: Transition| {
            let Transition { lost, gained } = transition;
            let before = &ends[0].tessellation;
            let side = |end: usize| Side::new(before, &ends[end].positions, lost.0, lost.1);
            let sides = [side(0)?, side(1)?];
            let [first, last] = [sides[0].length, sides[1].length];
            // A side that does not shrink through zero has done something else in between.
            if !(first >= 0.0 && last <= 0.0 && first - last > 0.0) {
                return None;
            }
            let shrinks = first - last;
            let fraction = first / shrinks;
            // A side that hardly shrinks would let the least error of a place decide when it vanishes.
            let per_length = shrinks / (shrinks * shrinks + least * least);
            let [by_first, by_last] = [(1.0 - fraction) * per_length, fraction * per_length];
            let slopes = [sides[0].gradient.map(|g| g * by_first), sides[1].gradient.map(|g| g * by_last)];
            let cells = sides[0].cells;
            let vanishing = Exchange::new(before, &ends[0].positions, lost.0, lost.1)?;
            let appearing = Exchange::new(&ends[1].tessellation, &ends[1].positions, gained.0, gained.1)?;
            let jumps = [
                Jump::new(ends[0], vanishing, cells, 1.0, terms)?,
                Jump::new(ends[1], appearing, cells, -1.0, terms)?,
            ];
            let whole = [0.5 * (1.0 - fraction).powi(2), 0.5 * (1.0 - fraction * fraction)];
            let (mut weights, mut beside_middle) = (whole, whole);
            for (number, ((share, weight), stage)) in STAGES.iter().zip(stages).enumerate() {
                if stage.0.tessellation.has_edge(&ends[1].tessellation, gained) {
                    weights[0] -= weight * (1.0 - share);
                    weights[1] -= weight * share;
                    if number == MIDDLE {
                        beside_middle = [whole[0] - (1.0 - share), whole[1] - share];
                    }
                }
            }
            Some(Self { cells, fraction, jumps, weights, beside_middle, slopes })
        };
        Transition::between(&ends[0].tessellation, &ends[1].tessellation)
            .into_iter()
            .filter_map(turn)
            .collect()
    }

    /// What it adds to the mean velocity of one of the four cells over the step, for some coefficients.
    pub fn added(&self, number: usize, coefficients: &[f64]) -> Vector<f64> {
        self.combined(number, coefficients, self.weights)
    }

    /// Derivative of the same by the fraction.
    pub fn added_by_fraction(&self, number: usize, coefficients: &[f64]) -> Vector<f64> {
        self.combined(number, coefficients, [self.fraction - 1.0, -self.fraction])
    }

    /// What its jumps weigh beside what derivatives are made of.
    fn weights(&self, by: Derivatives) -> [f64; 2] {
        match by {
            Derivatives::OfStages => self.weights,
            Derivatives::OfMiddle => self.beside_middle,
        }
    }

    /// Derivative of the same, for each of the four cells, by the positions at the beginning and at the last stage, the fraction held.
    pub fn added_by_places(&self, model: &Model<f64>, by: Derivatives) -> [JumpSlopes; 2] {
        [0, 1].map(|end| {
            let Jump { exchange, order, sign, .. } = &self.jumps[end];
            let mut slopes = exchange.slopes(model);
            let factor = sign * self.weights(by)[end];
            slopes.iter_mut().flatten().flat_map(|(_, block)| block).for_each(|entry| *entry *= factor);
            order.map(|number| std::mem::take(&mut slopes[number]))
        })
    }

    /// Derivative of the same by the free coefficients, whose directions are the columns of `basis` (2, p).
    pub fn added_by_coefficients(
        &self,
        number: usize,
        basis: &DMatrix<f64>,
        by: Derivatives,
    ) -> DMatrix<f64> {
        let mut x = DMatrix::zeros(2, basis.ncols());
        for (k, mut column) in x.column_iter_mut().enumerate() {
            let along = basis.column(k);
            column.copy_from(&self.combined(number, along.as_slice(), self.weights(by)));
        }
        x
    }

    /// The jumps of one of the four cells for some coefficients, weighted.
    fn combined(&self, number: usize, coefficients: &[f64], weights: [f64; 2]) -> Vector<f64> {
        let at = |end: usize| -> Vector<f64> {
            let by_coefficient = self.jumps[end].by_coefficient.iter();
            by_coefficient.zip(coefficients).map(|(jump, c)| jump[number] * *c).sum()
        };
        at(0) * weights[0] + at(1) * weights[1]
    }
}
