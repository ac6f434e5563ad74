//! What integrating over the unknown ways of the cells adds to the likelihood of the coefficients.
//!
//! Places after the first, polarities and what else moves a cell are random; the likelihood of β is an integral over them. About its greatest
//! integrand (Laplace's method)
//!
//! ```text
//! −2 log L(β) = Φ(β, x̂)/σ_v² + log det H(β, x̂) + const
//! ```
//!
//! with x̂ the unknowns that make Φ least for β, and H the second derivative of Φ with respect to them, but for the first place of each cell, which is
//! no random number: the cells stand where they stood. The determinant depends on β. A stiff tissue yields less to polarities and forgets faster where
//! its cells were, so that the least of Φ by itself is one of too soft a tissue. Its slope, along the ridge x̂(β), is found from
//! differences, and stands beside Φ until the fit has moved.

use super::anchors::Share;
use super::objective::MovieObjective;
use super::states::Place;
use crate::Error;
use crate::least_squares::invert;
use crate::linearisation::Held;
use nalgebra::{DMatrix, DVector};

/// Steps of the differences to either side, in standard errors of independent directions.
const STEP: f64 = 1.5;

/// Stiffness of what is not integrated over, in units of that of a measured place.
const HELD: f64 = 1e6;

/// log det H to first order about some coefficients.
#[derive(Debug, Clone)]
pub(crate) struct Integrated {
    /// Those coefficients.
    about: DVector<f64>,
    /// Its slope.
    slope: DVector<f64>,
}

impl Integrated {
    /// About a fit of cells that crawl, with by how many standard errors it moves the coefficients at most.
    pub fn at(objective: &MovieObjective<'_>, parameters: &[f64]) -> Result<Self, Error> {
        let (free, _) = objective.split(parameters);
        let p = free.len();
        let equations = objective.linearise(parameters)?;
        let covariance = invert(equations.reduced()?.information)? * objective.levels.velocity.powi(2);
        let root = covariance.cholesky().ok_or(Error::Degenerate)?.unpack();
        let follow = equations.following()?;
        let held = objective.held_at_first();
        let determinant = |step: DVector<f64>| -> Result<f64, Error> {
            let at: Vec<f64> = parameters.iter().zip(follow(&step)).map(|(at, by)| at + by).collect();
            let placed = objective.place(&at)?;
            let mut equations = objective.linearise_at(&placed, &at, Share::Known)?;
            equations.hold(&held);
            equations.log_determinant()
        };
        let mut along = DVector::zeros(p);
        for k in 0..p {
            let step = root.column(k) * STEP;
            along[k] = (determinant(step.clone())? - determinant(-step)?) / (2.0 * STEP);
        }
        let slope = root.transpose().solve_upper_triangular(&along).ok_or(Error::Degenerate)?;
        let basis: DMatrix<f64> = objective.space.basis().clone();
        let slope = &basis * invert(basis.transpose() * &basis)? * slope;
        Ok(Self { about: objective.space.coefficients(free), slope })
    }

    /// log det H of some coefficients, but for a constant.
    fn of(&self, coefficients: &DVector<f64>) -> f64 {
        let known = self.slope.len().min(coefficients.len());
        (0..known).map(|k| self.slope[k] * (coefficients[k] - self.about[k])).sum()
    }
}

impl MovieObjective<'_> {
    /// What holds the unknowns, and the first place of each cell where it is.
    fn held_at_first(&self) -> Held {
        let mut held = self.held();
        let mut begun = vec![false; self.movie.tracks.len()];
        for instant in &self.states.instants {
            for (track, place) in instant.tracks.iter().zip(&instant.place) {
                if let (Place::Own(place), false) = (place, begun[*track as usize]) {
                    begun[*track as usize] = true;
                    held.stiffness.of_blocks[*place as usize] += HELD * self.levels.spring();
                }
            }
        }
        held
    }

    /// What integrating over the unknowns adds to Φ.
    pub(super) fn integration(&self, free: &[f64]) -> f64 {
        let of = |own: &Integrated| self.levels.velocity.powi(2) * own.of(&self.space.coefficients(free));
        self.states.integrated.as_ref().map_or(0.0, of)
    }

    /// Half of what −2 log L falls by, integrated over the unknowns, with the free coefficients.
    pub(super) fn tilt(&self) -> DVector<f64> {
        let of = |own: &Integrated| {
            let mut slope = own.slope.as_slice().to_vec();
            slope.resize(self.space.basis().nrows(), 0.0);
            self.space.basis().tr_mul(&DVector::from_vec(slope)) * -0.5
        };
        self.states.integrated.as_ref().map_or_else(|| DVector::zeros(self.space.dimension()), of)
    }
}
