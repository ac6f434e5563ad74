//! The measured positions of a movie, frame by frame, as rows in its unknowns.

use super::objective::MovieObjective;
use super::placed::Placed;
use super::row_builder::RowBuilder;
use crate::position_rows::PositionRows;
use crate::rows::Rows;
use nalgebra::DMatrix;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// The share of the way from site to centroid at which positions are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Share {
    /// As it is.
    Known,
    /// An unknown beside the coefficients.
    Unknown,
}

/// Rows of all measured positions.
pub(super) struct Anchors {
    jacobian: BlockMatrix,
    rows: Vec<(usize, Vector<f64>, DMatrix<f64>)>,
    /// Number of coefficients, the share included if it is one.
    pub dimension: usize,
}

impl Anchors {
    /// The rows at some displacements.
    pub fn new(
        objective: &MovieObjective<'_>,
        placed: &Placed<'_>,
        displacements: &[f64],
        share: Share,
    ) -> Self {
        let own = objective.space.dimension();
        let of_share = (share == Share::Unknown).then_some(own);
        let dimension = own + usize::from(of_share.is_some());
        let of_frames = objective.of_seen(placed, displacements, |frame, cells, nudged, nudges| {
            let (tessellation, positions) = (&nudged.tessellation, &nudged.positions);
            (frame, PositionRows::new(cells, tessellation, positions, nudges, dimension, of_share))
        });
        let mut builder = RowBuilder::new(objective.states.blocks());
        let mut rows = Vec::new();
        for (frame, of_frame) in &of_frames {
            let place = &objective.states.instants[*frame].place;
            let of_frame = of_frame.rows();
            for (row, rest, x) in of_frame.rows {
                for (cell, block) in of_frame.jacobian.row(*row) {
                    builder.add(place[cell], 1.0, block);
                }
                builder.end();
                rows.push((rows.len(), *rest, x.clone()));
            }
        }
        Self { jacobian: builder.matrix, rows, dimension }
    }

    /// The same about a point that explains the positions.
    pub fn without_rests(mut self) -> Self {
        self.rows.iter_mut().for_each(|(_, rest, _)| *rest = Vector::zeros());
        self
    }

    pub fn rows(&self) -> Rows<'_> {
        Rows { jacobian: &self.jacobian, rows: &self.rows }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::movie::Movie;
    use crate::tracks::rule::Rule;
    use crate::tracks::sample::Filmed;
    use crate::tracks::states::States;
    use crate::{CoefficientSpace, Constraints, NoiseLevels};
    use voronudge_model::Structure;

    fn movie(share: f64) -> Movie {
        let (movie, _) = Filmed { size: [100, 3], step: 0.1, error: 0.02, seed: 5 }.movie();
        let errors = vec![(0..100).map(|cell| 1.0 + 0.3 * f64::from(cell).sin()).collect(); 3];
        movie.with_position_errors(&errors).with_positions_at(share)
    }

    /// Rows of centroids with errors of their own against differences, by the places and by the share.
    #[test]
    fn rows_are_the_derivatives_of_what_is_left_of_the_positions() {
        let (movie, space) = (movie(0.8), CoefficientSpace::new(&Constraints::default()).unwrap());
        let structure = Structure::base(1.0);
        let states = States::new(&movie).unwrap();
        let levels = NoiseLevels { position: 0.02, velocity: 0.1 };
        let (movie, states, structure, space) = (&movie, &states, &structure, &space);
        let objective =
            MovieObjective { movie, states, rule: Rule::Trapezoid, structure, space, levels, memory: None };
        let at = |step: f64| -> Vec<f64> {
            let free = [0.1, 2.0, 0.5, 1.0];
            let places = (0..2 * states.blocks())
                .map(|k| 0.003 * (1.7 * k as f64).cos() + step * (0.9 * k as f64).sin());
            free.into_iter().chain(places).collect()
        };
        let rows = |step: f64| {
            let at = at(step);
            Anchors::new(
                &objective,
                &objective.displaced(&at).unwrap(),
                objective.split(&at).1,
                Share::Unknown,
            )
        };
        let exact = rows(0.0);
        let sum: f64 = exact.rows.iter().map(|row| row.1.norm_squared()).sum();
        assert!((sum - objective.parts(&at(0.0)).unwrap().nudges).abs() < 1e-12 * sum);
        assert_eq!((exact.rows.len(), exact.dimension), (states.anchors.len(), 5));
        let direction: Vec<Vector<f64>> = (0..states.blocks())
            .map(|block| Vector::new((0.9 * (2 * block) as f64).sin(), (0.9 * (2 * block + 1) as f64).sin()))
            .collect();
        let by_places = exact.jacobian.apply(&direction);
        let [before, after] = [-1e-6, 1e-6].map(rows);
        for (row, _, _) in &exact.rows {
            let difference = (before.rows[*row].1 - after.rows[*row].1) / 2e-6;
            assert!((by_places[*row] - difference).norm() < 1e-5, "{row}: {} {difference}", by_places[*row]);
        }
        // About the same places, what is left is linear in the share.
        let other = states.clone().at_share(0.9);
        let moved = MovieObjective { states: &other, ..objective };
        let further =
            Anchors::new(&moved, &moved.displaced(&at(0.0)).unwrap(), moved.split(&at(0.0)).1, Share::Known);
        for ((_, rest, x), (_, after, _)) in exact.rows.iter().zip(&further.rows) {
            assert!((x.column(4) * 0.1 - (rest - after)).norm() < 1e-12);
        }
    }
}
