//! Where cells are, and how they crawl, at the end of a part of a movie, by a model that is known.

use super::memory::Memory;
use super::motions::Explained;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::rule::Rule;
use super::states::States;
use crate::fit_parameter::BASE;
use crate::search::optimise;
use crate::{CoefficientSpace, Error, NoiseLevels};
use std::ops::ControlFlow;
use voronudge_geometry::Vector;
use voronudge_model::Structure;

/// Steps of the optimiser, and the relative decrease that counts as none.
const STEPS: u64 = 12;
const TOLERANCE: f64 = 1e-3;

/// How cells go on in a fit of a movie.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dynamics {
    pub(super) rule: Rule,
    pub(super) memory: Option<Memory>,
    pub(super) levels: NoiseLevels,
}

/// A cell in the last of some frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Present {
    pub track: usize,
    pub position: Vector<f64>,
    pub polarity: Option<Vector<f64>>,
}

impl Dynamics {
    /// Of cells that do not crawl, in so many steps of integration from frame to frame.
    pub fn passive(levels: NoiseLevels, steps: usize) -> Self {
        Self { rule: Rule::RungeKutta(steps), memory: None, levels }
    }

    /// Standard deviation, per component, of the mean velocity of a cell over an interval that nothing predicts.
    pub fn scatter(self) -> f64 {
        self.levels.velocity
    }

    /// Where the cells are in a frame, given what was seen of them since another one and not later: what is likeliest, and so many draws of what
    /// else may be, about which the problem is linearised.
    ///
    /// # Errors
    /// [`Error`] if cells cannot be tessellated.
    pub fn present(
        self,
        movie: &Movie,
        (from, to): (usize, usize),
        (structure, coefficients): (&Structure, &[f64]),
        (draws, mut normal): (usize, impl FnMut() -> f64),
    ) -> Result<(Vec<Present>, Vec<Vec<Present>>), Error> {
        let (part, numbers) = movie.between(from, to);
        let mut states = States::of(&part, Explained::All)?;
        if let Some(memory) = self.memory {
            states = states.crawling(&part, BASE);
            if memory.alignment > 0.0 {
                states = states.aligning();
            }
        }
        let space = CoefficientSpace::pinned(coefficients);
        let Self { rule, memory, levels } = self;
        let objective =
            MovieObjective { movie: &part, states: &states, rule, structure, space: &space, levels, memory };
        let start = vec![0.0; 2 * states.blocks()];
        let found = optimise(&objective, start, STEPS, TOLERANCE, &mut |_, _| ControlFlow::Continue(()))?;
        let last = part.frames() - 1;
        let cells = |displacements: &[f64]| -> Vec<Present> {
            let positions = objective.positions(last, displacements);
            let polarities = objective.polarities(displacements).pop().unwrap_or_default();
            let of_cell = |(cell, track): (usize, &u32)| {
                let polarity = polarities.get(cell).copied().flatten();
                Present { track: numbers[*track as usize], position: positions[cell], polarity }
            };
            states.instants[last].tracks.iter().enumerate().map(of_cell).collect()
        };
        let likeliest = objective.split(&found.parameters).1;
        let mut astray: Vec<f64> = (0..draws * likeliest.len()).map(|_| normal()).collect();
        if draws > 0 {
            let equations = objective.linearise(&found.parameters)?;
            for frame in &equations.frames {
                frame.factor(levels.spring())?.draw(&mut astray);
            }
        }
        let drawn = astray.chunks_exact(likeliest.len().max(1)).map(|astray| {
            let all: Vec<f64> =
                likeliest.iter().zip(astray).map(|(u, own)| u + own * levels.velocity).collect();
            cells(&all)
        });
        Ok((cells(likeliest), drawn.collect()))
    }
}
