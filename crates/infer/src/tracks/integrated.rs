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
//! differences, and stands beside Φ until the fit has moved. With z the independent directions of β, in standard errors,
//!
//! ```text
//! log det H(β) ≈ const + Σ_k s_k f(z_k),      f(z) = z / (1 + (z/R)⁴)^¼
//! ```
//!
//! f is z as far as the slope is known, and ends at R: where the data hardly determine a direction, a line would lead a fit away for ever.

use super::objective::MovieObjective;
use super::states::Place;
use crate::Error;
use crate::linearisation::Held;
use crate::normal_equations::{LINEARISED_TOGETHER, NormalEquations};
use crate::normal_matrix::invert;
use nalgebra::{DMatrix, DVector};

/// Steps of the differences to either side, in standard errors of independent directions.
const STEP: f64 = 1.5;

/// R
const REACH: f64 = 4.0;

/// Stiffness of what is not integrated over, in units of that of a measured place.
const HELD: f64 = 1e6;

/// log det H about some free coefficients of the model.
#[derive(Debug, Clone)]
pub(crate) struct Integrated {
    /// Those coefficients.
    about: DVector<f64>,
    /// Its slope along independent directions.
    slope: DVector<f64>,
    /// These directions, a standard error long: lower triangular.
    directions: DMatrix<f64>,
}

/// The ridge x̂(β) about a fit.
struct Ridge<'a> {
    objective: MovieObjective<'a>,
    parameters: &'a [f64],
    /// The problem linearised there.
    equations: NormalEquations,
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
            equations,
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

    /// Its slope along each direction.
    fn slope(&self) -> Result<DVector<f64>, Error> {
        let sides: Vec<DVector<f64>> = self
            .directions
            .column_iter()
            .flat_map(|direction| [direction * STEP, direction * -STEP])
            .collect();
        let at = self.equations.each_of(LINEARISED_TOGETHER, &sides, |step| self.determinant(step))?;
        let slopes = at.chunks_exact(2).map(|side| (side[0] - side[1]) / (2.0 * STEP));
        Ok(DVector::from_iterator(self.directions.ncols(), slopes))
    }
}

impl Integrated {
    /// About a fit of cells that crawl.
    pub fn at(objective: &MovieObjective<'_>, parameters: &[f64]) -> Result<Self, Error> {
        let ridge = Ridge::new(*objective, parameters)?;
        let about = DVector::from_column_slice(objective.split(parameters).0);
        Ok(Self { about, slope: ridge.slope()?, directions: ridge.directions })
    }

    /// Whether it is one of a model with so many free coefficients.
    pub fn is_of(&self, coefficients: usize) -> bool {
        self.about.len() == coefficients
    }

    /// Of a share of the data.
    pub fn of_share(&self, share: f64) -> Self {
        Self { slope: &self.slope * share, ..self.clone() }
    }

    /// How far some free coefficients are, z.
    fn distance(&self, free: &[f64]) -> DVector<f64> {
        let mut z = DVector::from_column_slice(free) - &self.about;
        self.directions.solve_lower_triangular_mut(&mut z);
        z
    }

    /// By how much log det H rises to some free coefficients.
    fn rise(&self, free: &[f64]) -> f64 {
        let reached = |z: f64| z / (1.0 + (z / REACH).powi(4)).powf(0.25);
        self.slope.dot(&self.distance(free).map(reached))
    }

    /// Its derivative by these.
    fn derivative(&self, free: &[f64]) -> DVector<f64> {
        let left = |z: f64| (1.0 + (z / REACH).powi(4)).powf(-1.25);
        let mut along = self.slope.component_mul(&self.distance(free).map(left));
        self.directions.tr_solve_lower_triangular_mut(&mut along);
        along
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
        let rise = self.states.integrated.as_ref().map_or(0.0, |own| own.rise(free));
        self.levels.velocity.powi(2) * rise
    }

    /// Half of what −2 log L falls by, integrated over the unknowns, with the free coefficients.
    pub(super) fn tilt(&self, free: &[f64]) -> DVector<f64> {
        let of = |own: &Integrated| own.derivative(free) * -0.5;
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
        let along = DVector::from_element(space.dimension(), 0.5);
        let step = &ridge.directions * &along;
        let rise = ridge.determinant(&step).unwrap() - ridge.determinant(&-&step).unwrap();
        let slope = ridge.slope().unwrap();
        let expected = 2.0 * slope.dot(&along);
        assert!((rise - expected).abs() < 0.3 * expected.abs() + 0.5, "{rise} {expected}");
        // Along K_P, which is where the tilt of the fit goes.
        let stiffer = space.nearest(&[0.0, 3.6, 1.0, 0.0]);
        let softer = space.nearest(&[0.0, 0.0, 0.0, 0.0]);
        let along = DVector::from_vec(stiffer) - DVector::from_vec(softer);
        let free = objective.split(&followed.fit.parameters).0;
        let integrated = Integrated::at(&objective, &followed.fit.parameters).unwrap();
        assert!(integrated.derivative(free).dot(&along) < 0.0, "{integrated:?}");
        assert!(objective.tilt(free).dot(&along) > 0.0);
    }

    /// A line near by, which ends; the derivative is that of the rise.
    #[test]
    fn what_integrating_adds_has_an_end() {
        let own = Integrated {
            about: DVector::from_vec(vec![1.0, -2.0]),
            slope: DVector::from_vec(vec![3.0, -1.0]),
            directions: DMatrix::from_row_slice(2, 2, &[0.1, 0.0, 0.3, 0.2]),
        };
        let at = |z: [f64; 2]| -> Vec<f64> {
            (&own.about + &own.directions * DVector::from_column_slice(&z)).as_slice().to_vec()
        };
        assert!((own.rise(&at([0.5, -1.0])) - 2.5).abs() < 3e-3);
        assert!(own.rise(&at([1e6, -1e6])) < 4.0 * REACH + 1e-9);
        for z in [[0.0, 0.0], [2.0, -5.0], [-7.0, 3.0]] {
            let free = at(z);
            for (k, slope) in own.derivative(&free).iter().enumerate() {
                let moved = |by: f64| {
                    let mut there = free.clone();
                    there[k] += by;
                    own.rise(&there)
                };
                let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                assert!((difference - slope).abs() < 1e-6 * slope.abs().max(1.0), "{difference} {slope}");
            }
        }
    }
}
