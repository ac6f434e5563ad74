//! The slope of what integrating over the unknowns adds ([`super::integrated`]), from differences along the ridge x̂(β) of a fit.

use super::instants::Place;
use super::integrated::Integrated;
use super::objective::MovieObjective;
use crate::Error;
use crate::linearisation::Held;
use crate::normal_equations::{LINEARISED_TOGETHER, NormalEquations};
use crate::normal_matrix::invert;
use nalgebra::{DMatrix, DVector};

/// Steps of the differences to either side, in standard errors of independent directions.
const STEP: f64 = 1.5;

/// Stiffness of what is not integrated over, in units of that of a measured place.
const HELD: f64 = 1e6;

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
}
