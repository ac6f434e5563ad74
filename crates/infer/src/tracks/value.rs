//! The value of a movie's objective Φ: its parts, and how much each motion counts.

use super::anchors::Share;
use super::objective::MovieObjective;
use super::placed::Placed;
use crate::Error;
use crate::normal_equations::NormalEquations;
use crate::placing::Placing;
use crate::position_rows::squares;
use crate::robust::{loss, posterior_weight};
use voronudge_geometry::Vector;

/// Share of motions that nothing explains. Where contacts change, the way of a cell forks, and a fit can be caught on the wrong side of a
/// fork: what is then left of its motion must not decide a coefficient, nor keep it from crossing over.
const UNEXPLAINED: f64 = 0.01;

/// The parts of Φ, without their factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MovieParts {
    /// What counts of the squared residuals of motions.
    pub residual: f64,
    /// Sum of the squares of what is left of the measured positions, each over the square of its error in units of σ_r.
    pub nudges: f64,
    /// What keeps places that were not seen, and polarities.
    pub floor: f64,
    /// Penalty of the priors.
    pub priors: f64,
}

impl<'a> MovieObjective<'a> {
    /// Number of measured components that no unknown without a measurement takes up, without those of motions that nothing explains.
    pub fn explained_components(&self, placed: &Placed<'_>, parameters: &[f64]) -> f64 {
        let missing: f64 = self.weights(placed, parameters).iter().map(|weight| 2.0 * (1.0 - weight)).sum();
        (self.components() as f64 - missing).max(1.0)
    }

    /// What counts of what the model leaves of a motion.
    pub fn counted(&self, rest: &Vector<f64>) -> f64 {
        let variance = self.levels.velocity.powi(2);
        variance * loss(rest.norm_squared() / variance, UNEXPLAINED)
    }

    /// How much each motion counts, by what the model leaves of it.
    pub fn weights(&self, placed: &Placed<'_>, parameters: &[f64]) -> Vec<f64> {
        let variance = self.levels.velocity.powi(2);
        let weight = |rest: &Vector<f64>| posterior_weight(rest.norm_squared() / variance, UNEXPLAINED);
        self.residuals(placed, parameters).iter().map(weight).collect()
    }

    /// The parts of Φ.
    pub fn parts(&self, parameters: &[f64]) -> Result<MovieParts, Error> {
        Ok(self.parts_of(&self.displaced(parameters)?, parameters))
    }

    fn parts_of(&self, placed: &Placed<'_>, parameters: &[f64]) -> MovieParts {
        let (free, displacements) = self.split(parameters);
        let rests = self.residuals(placed, parameters);
        let residual = rests.iter().map(|rest| self.counted(rest)).sum();
        let of_seen = self.of_seen(placed, displacements, |_, cells, nudged, nudges| {
            squares(cells, &nudged.tessellation, &nudged.positions, nudges).sum::<f64>()
        });
        let nudges = of_seen.iter().sum();
        let surprise = self.weight_of_outset() * self.surprise(placed, displacements);
        let floor = self.stiffness().of(displacements) + surprise + self.driven(placed, parameters);
        let priors = self.space.penalty(&self.space.coefficients(free), self.levels.velocity);
        MovieParts { residual, nudges, floor, priors }
    }

    /// Φ with what integrating over the unknowns adds; infinite where there is no tessellation.
    pub fn value(&self, parameters: &[f64]) -> f64 {
        self.phi(parameters) + self.integration(self.split(parameters).0)
    }

    /// Φ by itself; infinite where there is no tessellation.
    pub fn phi(&self, parameters: &[f64]) -> f64 {
        self.displaced(parameters).map_or(f64::INFINITY, |placed| self.phi_of(&placed, parameters))
    }

    /// The same where cells are placed already.
    pub(super) fn phi_of(&self, placed: &Placed<'_>, parameters: &[f64]) -> f64 {
        let parts = self.parts_of(placed, parameters);
        let value = parts.residual + self.levels.spring() * parts.nudges + parts.floor + parts.priors;
        if value.is_nan() { f64::INFINITY } else { value }
    }
}

impl<'a> Placing for MovieObjective<'a> {
    type Placed = Placed<'a>;

    fn placed_at(&self, parameters: &[f64]) -> Result<Placed<'a>, Error> {
        self.displaced(parameters)
    }

    fn value_of(&self, placed: &Placed<'_>, parameters: &[f64]) -> f64 {
        self.phi_of(placed, parameters) + self.integration(self.split(parameters).0)
    }

    fn linearise_of(&self, placed: &Placed<'_>, parameters: &[f64]) -> Result<NormalEquations, Error> {
        let equations = self.linearise_at(placed, parameters, Share::Known)?;
        Ok(equations.tilted(self.tilt(self.split(parameters).0)))
    }

    fn obstacles_between(
        &self,
        before: (&Placed<'_>, &[f64]),
        after: (&Placed<'_>, &[f64]),
        promised: f64,
    ) -> Option<Vec<usize>> {
        self.obstacles(before, after, promised)
    }
}
