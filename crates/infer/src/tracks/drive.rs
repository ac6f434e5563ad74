//! What drives the polarities of cells, beside their neighbours and noise.
//!
//! A polarity may turn away from contacts, along n, and towards the velocity F that the model gives: `ṗ_i = −p_i/τ + b n_i + κ F_i + …`. From one frame
//! to the next, with g as it is expected half-way from where the cells are in this frame and were in the one before, g = 3/2 g_f − 1/2 g_{f−1},
//!
//! ```text
//! u_{f+1} = ρ M u_f + C_f + noise,     C = c_n n + c_F T F,     c_n = b T² φ,  c_F = κ T φ,  φ = (1 − e^{−x})/x
//! ```
//!
//! What is expected depends on places that the noise to come has not moved, so that the noise is no reason for a drive. Both c are unknowns of
//! the fit, in one block behind all others. How the innovations are held depends on the memory, which varies where likelihoods are compared; rows do not, if
//!
//! ```text
//! ‖u′ − ρMu − C‖² = ‖u′ − ρMu‖² − ‖u′‖² − ρ‖u‖² + ρa‖Lu‖²
//!                   + ‖u′ − C‖² + ρ‖u + C‖² − ρ(1 − a)‖C‖² − ρa‖Lu + C‖²
//! ```
//!
//! of which the first line is a form in the polarities alone and each term of the second the square of fixed rows with a weight.

use super::block::IDENTITY;
use super::instants::Place;
use super::memory::{Memory, innovation, share};
use super::objective::MovieObjective;
use super::placed::{Instant, Placed};
use super::polarities::{Driven, NONE, Polarities};
use super::row_builder::RowBuilder;
use super::states::States;
use crate::Drives;
use crate::objective::Nudged;
use crate::residuals::combined;
use crate::rows::Rows;
use crate::stiffness::Stiffness;
use nalgebra::DMatrix;
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_model::effect::{Column, away_from_contacts};
use voronudge_model::{BlockMatrix, Structure};

/// Times since the polarity before, in usual intervals, that count as usual.
const USUAL: [f64; 2] = [0.75, 1.25];

/// Rows of one kind.
pub(super) struct DriveRows {
    jacobian: BlockMatrix,
    rows: Vec<(usize, Vector<f64>, DMatrix<f64>)>,
}

impl DriveRows {
    pub fn rows(&self) -> Rows<'_> {
        Rows { jacobian: &self.jacobian, rows: &self.rows }
    }

    /// Sum of the squares of what is left.
    fn square(&self) -> f64 {
        self.rows.iter().map(|(_, rest, _)| rest.norm_squared()).sum()
    }

    /// The same with nothing left.
    fn without_rests(mut self) -> Self {
        self.rows.iter_mut().for_each(|(_, rest, _)| *rest = Vector::zeros());
        self
    }
}

/// n and T F of a frame, and the derivative of C by the places.
struct Fields {
    of_cells: [Vec<Vector<f64>>; 2],
    jacobians: Vec<BlockMatrix>,
}

impl Polarities {
    /// With drives.
    pub fn driven_by(mut self, drives: Drives) -> Self {
        let first = self.range().start as u32;
        let mut at = vec![(0, 0); self.count()];
        for (frame, blocks) in self.block.iter().enumerate() {
            for (cell, block) in blocks.iter().enumerate().filter(|(_, block)| **block != NONE) {
                at[(block - first) as usize] = (frame, cell);
            }
        }
        let is_usual = |since: &Option<f64>| since.is_some_and(|own| (USUAL[0]..=USUAL[1]).contains(&own));
        let usual: Vec<bool> = self.since.iter().map(is_usual).collect();
        let driven = |k: usize| {
            let ((frame, cell), before) = (at[k - 1], usual[k - 1]);
            let from = match before {
                true => vec![(frame, cell, 1.5), (at[k - 2].0, at[k - 2].1, -0.5)],
                false => vec![(frame, cell, 1.0)],
            };
            Driven { block: first + k as u32, from }
        };
        self.driven = (0..self.count()).filter(|k| usual[*k]).map(driven).collect();
        self.since.iter_mut().zip(usual).filter(|(_, usual)| *usual).for_each(|(own, _)| *own = Some(1.0));
        self.drives = drives;
        self
    }

    /// Takes off what rows of drives hold beside them, of cells that do not align.
    pub(super) fn release(&self, memory: Memory, ratio: f64, stiffness: &mut Stiffness) {
        let (own, rho) = innovation(1.0, memory.times);
        for Driven { block, .. } in &self.driven {
            stiffness.of_blocks[*block as usize] -= ratio * own;
            stiffness.of_blocks[*block as usize - 1] -= ratio * own * rho;
        }
    }

    /// Weights of the rows of drives.
    pub(super) fn weights_of_drives(&self, memory: Memory, ratio: f64) -> Vec<f64> {
        if !self.drives.any() {
            return Vec::new();
        }
        let (own, rho) = innovation(1.0, memory.times);
        let (weight, a) = (ratio * own, share(memory, 1.0));
        let mut weights = vec![weight, weight * rho, -weight * rho * (1.0 - a)];
        weights.extend(self.align().then_some(-weight * rho * a));
        weights
    }
}

impl MovieObjective<'_> {
    /// c_n and c_F.
    pub(super) fn drives(&self, displacements: &[f64]) -> [f64; 2] {
        let block = self.states.polarities.of_drives();
        block.map_or([0.0; 2], |block| States::vector(displacements, block).into())
    }

    /// n, T F and derivatives at the frames.
    fn fields(&self, placed: &Placed<'_>, coefficients: &[f64], c: [f64; 2]) -> Vec<Fields> {
        let (interval, drives) = (self.movie.interval(), self.states.polarities.drives);
        let (column, sign) = away_from_contacts();
        let contacts = Structure {
            terms: match column {
                Column::Term(term) => vec![term],
                Column::Response(_) => Vec::new(),
            },
            responses: Vec::new(),
        };
        let of_frame = |(frame, (nudged, evaluated)): (usize, &Instant<'_>)| {
            let mut fields = Fields { of_cells: [Vec::new(), Vec::new()], jacobians: Vec::new() };
            if drives.contact_inhibition {
                let environment = self.states.instants[frame].cells.environment().clone();
                let (positions, tessellation) = (nudged.positions.clone(), nudged.tessellation.clone());
                let away = Nudged::placed(&contacts, environment, positions, tessellation, None);
                fields.jacobians.push(away.jacobian_of_cells(&[sign * c[0]]));
                fields.of_cells[0] = away.velocities(&[sign]);
            }
            if drives.velocity_alignment {
                let scaled: Vec<f64> = coefficients.iter().map(|own| own * c[1] * interval).collect();
                fields.jacobians.push(nudged.jacobian_of_cells(&scaled));
                fields.of_cells[1] = evaluated.of_cells.iter().map(|v| v * interval).collect();
            }
            fields
        };
        placed.instants.par_iter().enumerate().map(of_frame).collect()
    }

    /// The rows of drives at a point, for so many free coefficients: `u′ − C`, `u + C`, `C`, and `Lu + C` of cells that may align.
    pub(super) fn drive_rows(
        &self,
        placed: &Placed<'_>,
        parameters: &[f64],
        dimension: usize,
    ) -> Vec<DriveRows> {
        let (polarities, instants) = (&self.states.polarities, &self.states.instants);
        let Some(block) = polarities.of_drives() else { return Vec::new() };
        let (free, displacements) = self.split(parameters);
        let c = self.drives(displacements);
        let fields = self.fields(placed, self.space.coefficients(free).as_slice(), c);
        let along = self.along();
        let kinds = if polarities.align() { 4 } else { 3 };
        let of_kind = |kind: usize| {
            let sign = if kind == 0 { -1.0 } else { 1.0 };
            let mut builder = RowBuilder::new(self.states.blocks());
            let mut rows = Vec::with_capacity(polarities.driven.len());
            for (number, driven) in polarities.driven.iter().enumerate() {
                let of_polarities = match kind {
                    0 => vec![(driven.block, 1.0)],
                    1 => vec![(driven.block - 1, 1.0)],
                    2 => Vec::new(),
                    _ => polarities.laplacian(driven.block - 1),
                };
                let mut value = Vector::zeros();
                for (own, factor) in of_polarities {
                    builder.add(Place::Own(own), factor, &IDENTITY);
                    value += States::vector(displacements, own as usize) * factor;
                }
                let (mut g, mut x) = ([Vector::zeros(); 2], DMatrix::zeros(2, dimension));
                for &(frame, cell, share) in &driven.from {
                    for (g, own) in g.iter_mut().zip(&fields[frame].of_cells) {
                        *g += own.get(cell).map_or(Vector::zeros(), |own| own * share);
                    }
                    for (other, entry) in fields[frame].jacobians.iter().flat_map(|own| own.row(cell)) {
                        builder.add(instants[frame].place[other], sign * share, entry);
                    }
                    if polarities.drives.velocity_alignment {
                        let factor = sign * share * c[1] * self.movie.interval();
                        let by_coefficient = &placed.instants[frame].1.by_coefficient;
                        for (along, mut column) in along.iter().zip(x.column_iter_mut()) {
                            column += combined(by_coefficient, along, cell) * factor;
                        }
                    }
                }
                builder.add(Place::Own(block as u32), sign, &[g[0].x, g[1].x, g[0].y, g[1].y]);
                builder.end();
                value += (g[0] * c[0] + g[1] * c[1]) * sign;
                rows.push((number, -value, x));
            }
            DriveRows { jacobian: builder.matrix, rows }
        };
        (0..kinds).into_par_iter().map(of_kind).collect()
    }

    /// The same with nothing left.
    pub(super) fn drive_rows_without_rests(
        &self,
        placed: &Placed<'_>,
        parameters: &[f64],
        dimension: usize,
    ) -> Vec<DriveRows> {
        let rows = self.drive_rows(placed, parameters, dimension);
        rows.into_iter().map(DriveRows::without_rests).collect()
    }

    /// What rows of drives add to Φ.
    pub(super) fn driven(&self, placed: &Placed<'_>, parameters: &[f64]) -> f64 {
        let Some(memory) = self.memory.filter(|_| self.states.polarities.drives.any()) else { return 0.0 };
        let weights = self.states.polarities.weights_of_drives(memory, self.ratio(memory));
        let rows = self.drive_rows(placed, parameters, self.space.dimension());
        rows.iter().zip(weights).map(|(rows, weight)| weight * rows.square()).sum()
    }
}

#[cfg(test)]
mod tests;
