//! The objective of a movie linearised: a row for each motion.

use super::anchors::{Anchors, Share};
use super::block::IDENTITY;
use super::drive::DriveRows;
use super::instants::Place;
use super::motions::Motion;
use super::objective::MovieObjective;
use super::outset::Outset;
use super::placed::Placed;
use super::row_builder::RowBuilder;
use super::tangent::Tangent;
use crate::Error;
use crate::linearisation::{Linearisation, Local};
use crate::normal_equations::{NormalEquations, Reduced};
use crate::placing::Placing;
use crate::residuals::combined;
use crate::rows::Rows;
use nalgebra::DMatrix;
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// Rows of motions, with the sign of a prediction: less those of the residuals.
struct MotionRows {
    jacobian: BlockMatrix,
    /// By the coefficients (2, p).
    columns: Vec<DMatrix<f64>>,
}

impl MotionRows {
    /// Rows times a factor each.
    fn scale(&mut self, factors: &[f64]) {
        let blocks = &mut self.jacobian.block;
        for (row, factor) in factors.iter().enumerate() {
            let own = self.jacobian.row_start[row]..self.jacobian.row_start[row + 1];
            blocks[own].iter_mut().flatten().for_each(|entry| *entry *= factor);
            self.columns[row] *= *factor;
        }
    }
}

/// What is left of all that the unknowns should be.
struct Rests<'a> {
    /// Of motions.
    residuals: Vec<Vector<f64>>,
    /// Of measured places.
    anchors: Anchors,
    /// Of the first polarities.
    outset: Outset,
    /// Of what drives them.
    drives: Vec<DriveRows>,
    /// The unknowns themselves, which are held.
    displacements: &'a [f64],
}

impl MovieObjective<'_> {
    /// The problem linearised about a point, with what integrating over the unknowns adds.
    pub fn linearise(&self, parameters: &[f64]) -> Result<NormalEquations, Error> {
        self.linearise_of(&self.displaced(parameters)?, parameters)
    }

    /// Φ by itself, perhaps with the share of the way to the centroids as a further coefficient, after all others.
    pub(super) fn linearise_with(&self, parameters: &[f64], share: Share) -> Result<NormalEquations, Error> {
        self.linearise_at(&self.displaced(parameters)?, parameters, share)
    }

    /// The same where cells are placed already.
    pub(super) fn linearise_at(
        &self,
        placed: &Placed<'_>,
        parameters: &[f64],
        share: Share,
    ) -> Result<NormalEquations, Error> {
        let residuals = self.residuals(placed, parameters);
        let displacements = self.split(parameters).1;
        let anchors = Anchors::new(self, placed, displacements, share);
        let outset = Outset::new(self, placed, displacements, anchors.dimension);
        let drives = self.drive_rows(placed, parameters, anchors.dimension);
        self.equations(parameters, placed, Rests { residuals, anchors, outset, drives, displacements })
    }

    /// The problem in β alone about a minimum whose residuals have changed by so much.
    pub fn response(
        &self,
        placed: &Placed<'_>,
        parameters: &[f64],
        residuals: Vec<Vector<f64>>,
    ) -> Result<Reduced, Error> {
        let displacements = self.split(parameters).1;
        let anchors = Anchors::new(self, placed, displacements, Share::Known).without_rests();
        let outset = Outset::new(self, placed, displacements, anchors.dimension).without_rests();
        let drives = self.drive_rows_without_rests(placed, parameters, anchors.dimension);
        let displacements = &vec![0.0; displacements.len()];
        let rests = Rests { residuals, anchors, outset, drives, displacements };
        self.equations(parameters, placed, rests)?.reduced()
    }

    /// The equations for some rests, with the derivatives at a point.
    fn equations(
        &self,
        parameters: &[f64],
        placed: &Placed<'_>,
        rests: Rests<'_>,
    ) -> Result<NormalEquations, Error> {
        let Rests { residuals, anchors, outset, drives, displacements } = rests;
        let (free, _) = self.split(parameters);
        let coefficients = self.space.coefficients(free);
        let mut motions = self.motion_rows(placed, coefficients.as_slice());
        let roots: Vec<f64> = self.weights(placed, parameters).into_iter().map(f64::sqrt).collect();
        motions.scale(&roots);
        let MotionRows { jacobian, columns } = motions;
        let p = anchors.dimension;
        let row = |(row, (rest, x)): (usize, (Vector<f64>, DMatrix<f64>))| {
            (row, rest * roots[row], x.resize_horizontally(p, 0.0))
        };
        let rows: Vec<(usize, Vector<f64>, DMatrix<f64>)> =
            residuals.into_iter().zip(columns).enumerate().map(row).collect();
        let known = std::iter::once(outset.rows()).chain(drives.iter().map(DriveRows::rows));
        let linearised = Linearisation::new(Local {
            velocities: Rows { jacobian: &jacobian, rows: &rows },
            positions: anchors.rows(),
            known: known.zip(self.weights_of_known()).collect(),
            nudges: displacements,
            stiffness: self.stiffness(),
            left_out: 0,
            free: p,
            places: self.states.where_and_when(&self.movie.times),
            chains: self.states.chains(),
            dissections: &self.states.dissections,
        });
        let mut free = free.to_vec();
        let further = p - free.len();
        free.resize(p, 0.0);
        Ok(NormalEquations::new(&self.space.widened(further), self.levels, &free, vec![linearised]))
    }

    /// `Σ_j ‖∂r/∂x_j‖² / m_j` of each motion: what errors of measured places of unit variance make of the square of what is left of it.
    pub(super) fn sensitivities(&self, parameters: &[f64]) -> Result<Vec<f64>, Error> {
        let placed = self.displaced(parameters)?;
        let (free, displacements) = self.split(parameters);
        let anchors = Anchors::new(self, &placed, displacements, Share::Known);
        let square = |block: &[f64; 4]| block.iter().map(|entry| entry * entry).sum::<f64>();
        let mut m = vec![0.0; self.states.blocks()];
        let Rows { jacobian, rows } = anchors.rows();
        for (row, ..) in rows {
            jacobian.row(*row).for_each(|(place, block)| m[place] += 0.5 * square(block));
        }
        let motions = self.motion_rows(&placed, self.space.coefficients(free).as_slice()).jacobian;
        let of_motion = |row: usize| {
            let measured = motions.row(row).filter(|(place, _)| m[*place] > 0.0);
            measured.map(|(place, block)| square(block) / m[place]).sum()
        };
        Ok((0..self.states.motions.len()).map(of_motion).collect())
    }

    /// The derivatives of all motions.
    fn motion_rows(&self, placed: &Placed<'_>, coefficients: &[f64]) -> MotionRows {
        let intervals: Vec<&[Motion]> =
            self.states.motions.chunk_by(|one, next| one.interval == next.interval).collect();
        let of_frames: Vec<BlockMatrix> = match placed.passages.is_empty() {
            true => {
                let instants = placed.instants.par_iter();
                instants.map(|(nudged, _)| nudged.jacobian_of_cells(coefficients)).collect()
            }
            false => Vec::new(),
        };
        let parts: Vec<MotionRows> = intervals
            .into_par_iter()
            .map(|motions| {
                let interval = motions[0].interval;
                match placed.passages.get(interval) {
                    None => self.of_trapezoid(motions, placed, &of_frames),
                    Some(passage) => {
                        self.of_passage(motions, &Tangent::at_end(self, interval, passage, coefficients))
                    }
                }
            })
            .collect();
        let mut all = MotionRows {
            jacobian: BlockMatrix { row_start: vec![0], ..BlockMatrix::default() },
            columns: Vec::new(),
        };
        for MotionRows { jacobian, columns } in parts {
            let offset = all.jacobian.column.len();
            all.jacobian.row_start.extend(jacobian.row_start[1..].iter().map(|end| offset + end));
            all.jacobian.column.extend(jacobian.column);
            all.jacobian.block.extend(jacobian.block);
            all.columns.extend(columns);
        }
        all
    }

    /// The derivatives of all motions by the coefficients (2, p), if the cells are followed.
    pub fn columns_of_passages(&self, placed: &Placed<'_>, coefficients: &[f64]) -> Vec<DMatrix<f64>> {
        let passages = placed.passages.par_iter().enumerate();
        let tangents: Vec<Tangent> = passages
            .map(|(interval, passage)| Tangent::of_coefficients(self, interval, passage, coefficients))
            .collect();
        let column = |motion: &Motion| {
            tangents[motion.interval].by_coefficients(motion.between as usize) * self.unit(motion.interval)
        };
        self.states.motions.iter().map(column).collect()
    }

    /// The motions of an interval by the mean of the velocities at both frames, whose derivatives are given.
    fn of_trapezoid(&self, motions: &[Motion], placed: &Placed<'_>, of_frames: &[BlockMatrix]) -> MotionRows {
        let mut rows = RowBuilder::new(self.states.blocks());
        for motion in motions {
            let unit = self.unit(motion.interval);
            let half = 0.5 * self.span(motion.interval) * unit;
            for (end, sign) in [(0, unit), (1, -unit)] {
                let frame = motion.interval + end;
                let place = &self.states.instants[frame].place;
                let cell = motion.cells[end] as usize;
                rows.add(place[cell], sign, &IDENTITY);
                of_frames[frame].row(cell).for_each(|(other, block)| rows.add(place[other], half, block));
            }
            self.add_crawling(&mut rows, motion, 1.0, &IDENTITY);
            if let Some(drift) = self.states.drift(motion.interval) {
                rows.add(Place::Own(drift as u32), unit, &IDENTITY);
            }
            rows.end();
        }
        MotionRows { jacobian: rows.matrix, columns: self.columns_of_trapezoid(motions, placed) }
    }

    /// The derivatives of all motions by the coefficients (2, p), if they follow the mean of the velocities at both frames.
    pub fn columns_of_trapezoid(&self, motions: &[Motion], placed: &Placed<'_>) -> Vec<DMatrix<f64>> {
        let along = self.along();
        let of_motion = |motion: &Motion| {
            let half = 0.5 * self.span(motion.interval) * self.unit(motion.interval);
            let mut x = DMatrix::zeros(2, along.len());
            for (along, mut column) in along.iter().zip(x.column_iter_mut()) {
                let at = |end: usize| {
                    let by_coefficient = &placed.instants[motion.interval + end].1.by_coefficient;
                    combined(by_coefficient, along, motion.cells[end] as usize)
                };
                column.copy_from(&((at(0) + at(1)) * half));
            }
            x
        };
        motions.par_iter().map(of_motion).collect()
    }

    /// Adds a factor times the derivative by the way that a cell crawls in an interval, which is a block.
    fn add_crawling(&self, rows: &mut RowBuilder, motion: &Motion, factor: f64, block: &[f64; 4]) {
        let span = self.span(motion.interval) / self.movie.interval();
        for own in self.states.polarity(motion).into_iter().flatten() {
            rows.add(Place::Own(own as u32), 0.5 * factor * span * self.unit(motion.interval), block);
        }
    }

    /// The motions of an interval by integration.
    fn of_passage(&self, motions: &[Motion], tangent: &Tangent) -> MotionRows {
        let states = self.states;
        let mut rows = RowBuilder::new(states.blocks());
        let mut columns = Vec::with_capacity(motions.len());
        for motion in motions {
            let unit = self.unit(motion.interval);
            let between = &states.intervals[motion.interval].ends;
            let place = [0, 1].map(|end| &states.instants[motion.interval + end].place);
            for (column, block) in tangent.row(motion.between as usize) {
                // Cells of the interval at its beginning, then at its end, then the ways that they crawl.
                let (end, number) = (column / between.len(), column % between.len());
                match place.get(end) {
                    Some(place) => rows.add(place[between[number][end] as usize], unit, block),
                    None => self.add_crawling(
                        &mut rows,
                        &Motion { cells: between[number], ..*motion },
                        1.0,
                        block,
                    ),
                }
            }
            rows.add(place[1][motion.cells[1] as usize], -unit, &IDENTITY);
            if let Some(drift) = states.drift(motion.interval) {
                rows.add(Place::Own(drift as u32), unit, &tangent.by_translation(motion.between as usize));
            }
            for number in states.pushing(motion) {
                rows.add(place[1][between[*number as usize][1] as usize], 0.0, &IDENTITY);
            }
            rows.end();
            columns.push(tangent.by_coefficients(motion.between as usize) * unit);
        }
        match &states.own_motion {
            None => MotionRows { jacobian: rows.matrix, columns },
            Some(own) => {
                own.of_rows(motions, &mut rows.matrix, &mut columns);
                MotionRows { jacobian: self.with_own_ways(motions, &rows.matrix), columns }
            }
        }
    }

    /// Rows of motions that are told apart, with how each depends on the way that its cell crawls.
    fn with_own_ways(&self, motions: &[Motion], told_apart: &BlockMatrix) -> BlockMatrix {
        let mut rows = RowBuilder::new(self.states.blocks());
        for (number, motion) in motions.iter().enumerate() {
            told_apart
                .row(number)
                .for_each(|(column, block)| rows.add(Place::Own(column as u32), 1.0, block));
            self.add_crawling(&mut rows, motion, 1.0, &IDENTITY);
            rows.end();
        }
        rows.matrix
    }
}

#[cfg(test)]
mod tests;
