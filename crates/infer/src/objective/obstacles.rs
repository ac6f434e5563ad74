//! The cells at which a step of a fit to snapshots fails.

use super::{Moving, Objective};
use crate::least_squares::residuals;
use crate::obstacles::{around, failing};
use crate::position_rows::squares;
use voronudge_geometry::Vector;

/// What a term of Φ belongs to, with its frame.
#[derive(Debug, Clone, Copy)]
enum Owner {
    Velocity(usize, usize),
    Position(usize, usize),
}

impl Objective<'_> {
    /// The terms of Φ, but for cells that were not seen and priors.
    fn terms(&self, placed: &[Moving<'_>], parameters: &[f64]) -> Vec<(Owner, f64)> {
        let mut terms = Vec::new();
        let frames = self.frames.iter().zip(self.split(parameters).1).zip(placed);
        for (index, ((frame, nudges), (nudged, predicted))) in frames.enumerate() {
            let of_velocity = |(datum, rest): (usize, Vector<f64>)| {
                (Owner::Velocity(index, datum), frame.weight(datum) * rest.norm_squared())
            };
            terms.extend(residuals(frame, predicted.as_measured()).into_iter().map(of_velocity));
            let springs = squares(frame, &nudged.tessellation, &nudged.positions, nudges).enumerate();
            terms
                .extend(springs.map(|(cell, square)| (Owner::Position(index, cell), self.spring() * square)));
        }
        terms
    }

    /// The cells, counted through all frames, at which a step from one point to another fails, with those around them, if they are few.
    pub(super) fn obstacles(
        &self,
        before: (&Vec<Moving<'_>>, &[f64]),
        after: (&Vec<Moving<'_>>, &[f64]),
        promised: f64,
    ) -> Option<Vec<usize>> {
        let [old, new] = [before, after].map(|(placed, parameters)| self.terms(placed, parameters));
        let cells: Vec<usize> = self.frames.iter().map(|frame| frame.positions.len()).collect();
        let mut marked: Vec<Vec<bool>> = cells.iter().map(|count| vec![false; *count]).collect();
        for owner in failing(&old, &new, promised, cells.iter().sum())? {
            let (frame, cells) = match owner {
                Owner::Position(frame, cell) => (frame, vec![cell]),
                Owner::Velocity(frame, datum) => (frame, before.0[frame].0.measured_in(datum)),
            };
            for cell in cells.into_iter().flat_map(|cell| around(&before.0[frame].0.tessellation, cell)) {
                marked[frame][cell] = true;
            }
        }
        let places = marked.into_iter().flatten().enumerate();
        Some(places.filter(|(_, marked)| *marked).map(|(place, _)| place).collect())
    }
}
