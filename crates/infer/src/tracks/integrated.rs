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

/// log det H to first order about some free coefficients of the model.
#[derive(Debug, Clone)]
pub(crate) struct Integrated {
    /// Those coefficients.
    about: DVector<f64>,
    /// Its slope.
    slope: DVector<f64>,
}

/// The ridge x̂(β) about a fit.
struct Ridge<'a> {
    objective: MovieObjective<'a>,
    parameters: &'a [f64],
    /// Independent directions of the free coefficients, a standard error long.
    directions: DMatrix<f64>,
    /// Derivatives of all unknowns by these.
    unknowns: DMatrix<f64>,
    held: Held,
}

impl<'a> Ridge<'a> {
    fn new(objective: MovieObjective<'a>, parameters: &'a [f64]) -> Result<Self, Error> {
        let equations = objective.linearise(parameters)?;
        let (reduced, unknowns) = equations.ridge()?;
        let covariance = invert(reduced.information)? * objective.levels.velocity.powi(2);
        Ok(Self {
            objective,
            parameters,
            directions: covariance.cholesky().ok_or(Error::Degenerate)?.unpack(),
            unknowns,
            held: objective.held_at_first(),
        })
    }

    /// log det H a step of the free coefficients farther.
    fn determinant(&self, step: &DVector<f64>) -> Result<f64, Error> {
        let moved = &self.unknowns * step;
        let at: Vec<f64> = self.parameters.iter().zip(&moved).map(|(at, by)| at + by).collect();
        let mut equations = self.objective.linearise(&at)?;
        equations.hold(&self.held);
        equations.log_determinant()
    }

    /// Its derivative by the free coefficients.
    fn slope(&self) -> Result<DVector<f64>, Error> {
        let mut along = DVector::zeros(self.directions.ncols());
        for (k, direction) in self.directions.column_iter().enumerate() {
            let step = direction * STEP;
            along[k] = (self.determinant(&step)? - self.determinant(&-step)?) / (2.0 * STEP);
        }
        self.directions.tr_solve_lower_triangular(&along).ok_or(Error::Degenerate)
    }
}

impl Integrated {
    /// About a fit of cells that crawl.
    pub fn at(objective: &MovieObjective<'_>, parameters: &[f64]) -> Result<Self, Error> {
        let slope = Ridge::new(*objective, parameters)?.slope()?;
        Ok(Self { about: DVector::from_column_slice(objective.split(parameters).0), slope })
    }

    /// Whether it is one of a model with so many free coefficients.
    pub fn is_of(&self, coefficients: usize) -> bool {
        self.about.len() == coefficients
    }

    /// Of a share of the data.
    pub fn of_share(&self, share: f64) -> Self {
        Self { about: self.about.clone(), slope: &self.slope * share }
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
        let of = |own: &Integrated| own.slope.dot(&(DVector::from_column_slice(free) - &own.about));
        self.levels.velocity.powi(2) * self.states.integrated.as_ref().map_or(0.0, of)
    }

    /// Half of what −2 log L falls by, integrated over the unknowns, with the free coefficients.
    pub(super) fn tilt(&self) -> DVector<f64> {
        let of = |own: &Integrated| &own.slope * -0.5;
        self.states.integrated.as_ref().map_or_else(|| DVector::zeros(self.space.dimension()), of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Activity;
    use crate::tracks::sample::followed;

    /// The slope is that of the determinant, and pulls towards a stiffer tissue.
    #[test]
    fn a_soft_tissue_yields_more() {
        let (movie, request, followed) = followed(Activity::Polarity);
        let space = request.space().unwrap();
        let objective = followed.objective(&movie, &request.structure, &space);
        let ridge = Ridge::new(objective, &followed.fit.parameters).unwrap();
        let slope = ridge.slope().unwrap();
        let step = &ridge.directions * DVector::from_element(space.dimension(), 0.5);
        let rise = ridge.determinant(&step).unwrap() - ridge.determinant(&-&step).unwrap();
        let expected = 2.0 * slope.dot(&step);
        assert!((rise - expected).abs() < 0.3 * expected.abs() + 0.5, "{rise} {expected}");
        // Along K_P, which is where the tilt of the fit goes.
        let stiffer = space.nearest(&[0.0, 3.6, 1.0, 0.0]);
        let softer = space.nearest(&[0.0, 0.0, 0.0, 0.0]);
        let along = DVector::from_vec(stiffer) - DVector::from_vec(softer);
        assert!(slope.dot(&along) < 0.0, "{slope:?}");
        assert!(objective.tilt().dot(&along) > 0.0);
    }
}
