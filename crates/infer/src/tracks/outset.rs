//! What is known of the polarities of cells when their tracks begin.
//!
//! A cell that crawls pushes against its neighbours: where it is followed from on, the forces on it depend on where it has crawled to before.
//! If its polarity were taken for independent of them, what they do would be underestimated. So the first polarity of each cell is expected at
//! a combination of the columns X of the model at the places where it then is,
//!
//! ```text
//! u_0 = T Σ_j γ_j X_j(x_0) + rest,      variance of the rest: σ_u² less that of the sum
//! ```
//!
//! with coefficients γ of its own. (Chamberlain's device for effects of individuals that depend on what is regressed on.) What is new in the
//! polarity afterwards does not depend on places.

use super::block::IDENTITY;
use super::instants::Place;
use super::objective::MovieObjective;
use super::placed::Placed;
use super::polarities::First;
use super::row_builder::RowBuilder;
use super::states::States;
use crate::rows::Rows;
use nalgebra::DMatrix;
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// Least share of the variance of polarities that forces leave.
const LEAST_FREE: f64 = 0.05;

/// The rows of the first polarities: what is expected less what is.
pub(super) struct Outset {
    jacobian: BlockMatrix,
    rows: Vec<(usize, Vector<f64>, DMatrix<f64>)>,
}

impl Outset {
    /// For so many free coefficients.
    pub fn new(
        objective: &MovieObjective<'_>,
        placed: &Placed<'_>,
        displacements: &[f64],
        dimension: usize,
    ) -> Self {
        let states = objective.states;
        let interval = objective.movie.interval();
        let gamma = objective.gamma(displacements);
        let of_frames: Vec<Option<BlockMatrix>> = (placed.instants.par_iter().enumerate())
            .map(|(frame, (nudged, _))| {
                let begins = states.polarities.firsts.iter().any(|first| first.frame == frame);
                begins.then(|| nudged.jacobian_of_cells(&gamma))
            })
            .collect();
        let expected = objective.expected_polarities(placed, displacements);
        let mut builder = RowBuilder::new(states.blocks());
        let mut rows = Vec::with_capacity(expected.len());
        for (first, expected) in states.polarities.firsts.iter().zip(expected) {
            builder.add(Place::Own(first.block as u32), 1.0, &IDENTITY);
            let place = &states.instants[first.frame].place;
            for (cell, block) in of_frames[first.frame].iter().flat_map(|own| own.row(first.cell)) {
                builder.add(place[cell], -interval, block);
            }
            for (pair, block) in
                objective.columns_at(placed, first.frame, first.cell).chunks(2).zip(states.polarities.gamma())
            {
                let [one, other] = [0, 1].map(|k| pair.get(k).copied().unwrap_or_default());
                builder.add(Place::Own(block as u32), -interval, &[one.x, other.x, one.y, other.y]);
            }
            builder.end();
            let rest = expected - States::vector(displacements, first.block);
            rows.push((rows.len(), rest, DMatrix::zeros(2, dimension)));
        }
        Self { jacobian: builder.matrix, rows }
    }

    /// The same with nothing left.
    pub fn without_rests(mut self) -> Self {
        self.rows.iter_mut().for_each(|(_, rest, _)| *rest = Vector::zeros());
        self
    }

    pub fn rows(&self) -> Rows<'_> {
        Rows { jacobian: &self.jacobian, rows: &self.rows }
    }
}

impl MovieObjective<'_> {
    /// γ.
    fn gamma(&self, displacements: &[f64]) -> Vec<f64> {
        let all = self
            .states
            .polarities
            .gamma()
            .flat_map(|block| <[f64; 2]>::from(States::vector(displacements, block)));
        let mut gamma: Vec<f64> = all.take(self.states.polarities.terms).collect();
        gamma.resize(self.structure.dimension(), 0.0);
        gamma
    }

    /// The columns of the model at a cell.
    fn columns_at(&self, placed: &Placed<'_>, frame: usize, cell: usize) -> Vec<Vector<f64>> {
        let columns = &placed.instants[frame].1.by_coefficient;
        columns.iter().take(self.states.polarities.terms).map(|column| column[cell]).collect()
    }

    /// What the first polarities are expected to be.
    fn expected_polarities(&self, placed: &Placed<'_>, displacements: &[f64]) -> Vec<Vector<f64>> {
        let gamma = self.gamma(displacements);
        let expected = |first: &First| {
            let columns = self.columns_at(placed, first.frame, first.cell);
            columns.iter().zip(&gamma).map(|(x, gamma)| x * *gamma).sum::<Vector<f64>>()
                * self.movie.interval()
        };
        self.states.polarities.firsts.iter().map(expected).collect()
    }

    /// Sum of the squares of what the first polarities differ by from what is expected.
    pub(super) fn surprise(&self, placed: &Placed<'_>, displacements: &[f64]) -> f64 {
        let expected = self.expected_polarities(placed, displacements);
        let firsts = self.states.polarities.firsts.iter().zip(expected);
        firsts
            .map(|(first, expected)| (expected - States::vector(displacements, first.block)).norm_squared())
            .sum()
    }

    /// Which share of the variance of the first polarities is left by what is expected at a point, if a component has the standard deviation
    /// `speed`.
    pub(super) fn free_share(&self, placed: &Placed<'_>, parameters: &[f64], speed: f64) -> f64 {
        let expected = self.expected_polarities(placed, self.split(parameters).1);
        let count = expected.len().max(1) as f64;
        let mean = 0.5 * expected.iter().map(Vector::norm_squared).sum::<f64>() / count;
        (1.0 - mean / (speed * self.movie.interval()).powi(2)).max(LEAST_FREE)
    }
}
