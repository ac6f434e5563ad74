//! Coefficients that no small part of the data decides: a Student distribution of the residuals at a fixed scale.

use super::neighbourhood::FREEDOM;
use super::scene::Scene;
use crate::least_squares::{invert, within_bounds};
use crate::objective::Nudged;
use crate::{CoefficientSpace, Error, NoiseLevels};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::sync::Arc;
use voronudge_geometry::Vector;
use voronudge_model::Structure;

/// One velocity: what is measured, its free columns, and the variance of a component.
struct Row {
    target: Vector<f64>,
    columns: DMatrix<f64>,
    variance: f64,
}

/// Reweighted least squares at the positions of the scenes.
pub(super) struct Robust<'a> {
    pub structure: &'a Structure,
    pub space: &'a CoefficientSpace,
    pub levels: NoiseLevels,
}

/// Coefficients, and how large residuals are.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub free: Vec<f64>,
    /// Squared residuals in units of their variance, in ascending order.
    pub squares: Vec<f64>,
}

const ROUNDS: usize = 3;
const ITERATIONS: usize = 12;

impl Robust<'_> {
    pub fn fit(&self, scenes: &[Scene<'_>], start: Option<&[f64]>, excess: f64) -> Result<Fit, Error> {
        let p = self.space.dimension();
        let origin = self.space.origin().clone();
        let placed: Vec<Nudged<'_>> = scenes
            .par_iter()
            .map(|scene| {
                Nudged::placed(
                    self.structure,
                    Arc::default(),
                    scene.positions.clone(),
                    scene.tessellation.clone(),
                    None,
                )
            })
            .collect();
        let mut free = start.map(<[f64]>::to_vec);
        let mut rows: Vec<Row> = Vec::new();
        for (scene, placed) in scenes.iter().zip(&placed) {
            let evaluated = placed.evaluate(origin.as_slice());
            for (cell, site) in scene.sites.iter().enumerate() {
                let Some(target) = site.target else { continue };
                let columns = DMatrix::<f64>::from_fn(2, p, |axis, k| {
                    let along = self.space.basis().column(k);
                    evaluated.by_coefficient.iter().zip(along.iter()).map(|(x, c)| x[cell][axis] * c).sum()
                });
                let target = target - evaluated.predicted[cell];
                if columns.iter().all(|x: &f64| x.is_finite()) {
                    rows.push(Row { target, columns, variance: 0.05 });
                }
            }
        }
        for round in 0..ROUNDS {
            if let Some(free) = &free {
                self.variances(scenes, &placed, free, excess, &mut rows)?;
            }
            if round == 0 && free.is_none() {
                // No coefficients yet: all residuals count alike.
            }
            for _ in 0..ITERATIONS {
                let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
                for row in &rows {
                    let weight = match &free {
                        None => 1.0 / row.variance,
                        Some(free) => {
                            (FREEDOM + 2.0) / (FREEDOM + square(row, free) / row.variance) / row.variance
                        }
                    };
                    normal += row.columns.transpose() * &row.columns * weight;
                    right += row.columns.transpose() * DVector::from_column_slice(row.target.as_slice()) * weight;
                }
                let centre = invert(normal.clone())? * right;
                let next = within_bounds(self.space, centre, normal)?.as_slice().to_vec();
                let change = free.as_ref().map_or(f64::INFINITY, |free| {
                    free.iter().zip(&next).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                });
                free = Some(next);
                if change < 1e-4 {
                    break;
                }
            }
        }
        let free = free.unwrap_or_default();
        self.variances(scenes, &placed, &free, 1.0, &mut rows)?;
        let mut squares: Vec<f64> = rows.iter().map(|row| square(row, &free) / row.variance).collect();
        squares.sort_unstable_by(f64::total_cmp);
        Ok(Fit { free, squares })
    }

    fn variances(
        &self,
        scenes: &[Scene<'_>],
        placed: &[Nudged<'_>],
        free: &[f64],
        excess: f64,
        rows: &mut [Row],
    ) -> Result<(), Error> {
        let coefficients = self.space.coefficients(free);
        let mut next = rows.iter_mut();
        for (scene, placed) in scenes.iter().zip(placed) {
            let evaluated = placed.evaluate(coefficients.as_slice());
            let jacobian = placed.jacobian(coefficients.as_slice(), &evaluated);
            for (cell, _) in scene.sites.iter().enumerate().filter(|(_, site)| site.target.is_some()) {
                let Some(row) = next.next() else { break };
                let square: f64 = jacobian.row(cell).flat_map(|(_, b)| b.iter()).map(|x| x * x).sum();
                row.variance = excess
                    * (self.levels.velocity.powi(2) + 0.5 * square * self.levels.position.powi(2));
            }
        }
        Ok(())
    }
}

fn square(row: &Row, free: &[f64]) -> f64 {
    let predicted = &row.columns * DVector::from_column_slice(free);
    (row.target - Vector::new(predicted[0], predicted[1])).norm_squared()
}
