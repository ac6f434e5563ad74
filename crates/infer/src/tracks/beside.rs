//! Further terms beside the fit of a movie, in one linear problem.

use super::anchors::Share;
use super::driven::HintsOfDrives;
use super::inference::Followed;
use super::look::Seen;
use super::memory::Memory;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::own_motion::OwnMotion;
use super::states::States;
use crate::fit_parameter::BASE;
use crate::search::{Watch, optimise_knowing};
use crate::{CoefficientSpace, Drives, Error, NoiseLevels, Request};
use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;
use voronudge_model::Structure;

/// Steps in which a fit settles at other noise levels, and the relative decrease that counts as none.
const STEPS: u64 = 8;
const TOLERANCE: f64 = 1e-4;

/// The problem in the coefficients alone, where nothing else of a fit is held, linearised about it.
pub(crate) struct Beside {
    /// The information on the coefficients, in units of 1/σ_v².
    pub information: DMatrix<f64>,
    /// Half the decrease of Φ with these.
    pub gradient: DVector<f64>,
    /// Φ.
    pub value: f64,
    /// XᵀX
    pub normal: DMatrix<f64>,
    /// Measured components that the model explains.
    pub components: f64,
}

impl Followed {
    pub(super) fn objective<'a>(
        &'a self,
        movie: &'a Movie,
        structure: &'a Structure,
        space: &'a CoefficientSpace,
    ) -> MovieObjective<'a> {
        let fit = &self.fit;
        let (states, rule, levels, memory) = (&fit.states, fit.rule, fit.levels, fit.memory);
        MovieObjective { movie, states, rule, structure, space, levels, memory }
    }

    /// Linearises a model with further terms about the fit. `coefficients` are those of the fit, zero for the further terms. Cells are followed
    /// in more steps than in the fit: these are enough for its own terms, and what they leave must not pose as another.
    pub fn beside(
        &self,
        movie: &Movie,
        structure: &Structure,
        space: &CoefficientSpace,
        coefficients: &[f64],
    ) -> Result<Beside, Error> {
        let objective =
            MovieObjective { rule: self.fit.rule.twice(), ..self.objective(movie, structure, space) };
        let mut at = space.nearest(coefficients);
        at.extend(self.displacements());
        let placed = objective.displaced(&at)?;
        // Φ by itself: what integrating adds is known of the terms of the fit alone, and beside these another that acts alike would be taken for
        // missing.
        let equations = objective.linearise_at(&placed, &at, Share::Known)?;
        let reduced = equations.reduced()?;
        Ok(Beside {
            value: objective.phi_of(&placed, &at),
            normal: equations.frames.iter().map(|part| part.free_normal().clone()).sum(),
            components: objective.explained_components(&placed, &at),
            information: reduced.information,
            gradient: reduced.gradient,
        })
    }

    /// The least Φ/σ_v² at other noise levels.
    pub fn at_levels(
        &self,
        movie: &Movie,
        structure: &Structure,
        space: &CoefficientSpace,
        levels: NoiseLevels,
        watch: &mut Watch<'_>,
    ) -> Result<f64, Error> {
        let objective = MovieObjective { levels, ..self.objective(movie, structure, space) };
        let expected = objective.expected();
        let mut observer = |_: u64, value: f64| match watch.tell("tracks", (1, 1), value / expected) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        let start = (self.fit.parameters.clone(), None);
        let optimum = optimise_knowing(&objective, start, STEPS, TOLERANCE, &mut observer)?;
        Ok(optimum.value / levels.velocity.powi(2))
    }

    /// By how much −2 log L falls at most, of a few polarities, if cells that do not crawl in this fit were to crawl, or if those of cells that
    /// do were to align: a fit of its own would gain more where there is something, and little where there is nothing.
    pub fn hint_of_polarity(
        &self,
        movie: &Movie,
        request: &Request,
        space: &CoefficientSpace,
    ) -> Result<f64, Error> {
        let levels = self.fit.levels;
        let (states, memory) = match self.fit.memory {
            None => (
                self.fit.states.clone().crawling(movie, BASE),
                Memory { speed: levels.velocity, ..Memory::FIRST },
            ),
            Some(memory) => (self.fit.states.clone().aligning(), memory),
        };
        let memory = Some(memory);
        let mut at = self.fit.parameters.clone();
        at.resize(space.dimension() + 2 * states.blocks(), 0.0);
        let fitted = self.objective(movie, &request.structure, space);
        let own_motion = OwnMotion::at(&MovieObjective { states: &states, memory, ..fitted }, &at)?;
        let states = States { own_motion, ..states };
        let objective = MovieObjective { states: &states, memory, ..fitted };
        let placed = objective.displaced(&at)?;
        let components = objective.explained_components(&placed, &at);
        let equations = objective.linearise_at(&placed, &at, Share::Known)?;
        Seen { objective, equations: &equations, components, known: request.noise }.hint()
    }

    /// By how much −2 log L would fall, to first order, with each drive of polarities that a fit with polarities lacks.
    pub fn hints_of_drives(
        &self,
        movie: &Movie,
        request: &Request,
        space: &CoefficientSpace,
    ) -> Result<HintsOfDrives, Error> {
        let own = &self.fit.states;
        let both = Drives { contact_inhibition: true, velocity_alignment: true };
        let states = own.clone().driven_by(both);
        let objective =
            MovieObjective { states: &states, ..self.objective(movie, &request.structure, space) };
        let mut at = self.fit.parameters.clone();
        at.resize(space.dimension() + 2 * states.blocks(), 0.0);
        let equations = objective.linearise(&at)?;
        objective.hints_of_drives(&equations, own.polarities.drives)
    }

    /// Where the fit of a model with the same unknowns beside the coefficients may begin; `None` if it has others.
    pub(super) fn point_for(&self, states: &States, free: Vec<f64>) -> Option<Vec<f64>> {
        let own = &self.fit.states;
        if own.unknowns_of_cells() != states.unknowns_of_cells() {
            return None;
        }
        // The first terms are those of both models.
        let terms = own.polarities.terms.min(states.polarities.terms);
        let length = free.len() + 2 * states.blocks();
        let mut at = free;
        at.extend(&self.displacements()[..2 * own.unknowns_of_cells() + terms]);
        at.resize(length, 0.0);
        Some(at)
    }

    pub(super) fn displacements(&self) -> &[f64] {
        let count = 2 * self.fit.states.blocks();
        &self.fit.parameters[self.fit.parameters.len() - count..]
    }
}
