//! The objective linearised about a point.

use super::patches::Patches;
use super::{Measurable, Moving, Objective};
use crate::free_cells::Free;
use crate::linearisation::{Linearisation, Local};
use crate::normal_equations::NormalEquations;
use crate::placing::Placing;
use crate::position_rows::PositionRows;
use crate::residuals::{free_rows, residuals};
use crate::rows::{Row, Rows};
use crate::stiffness::Stiffness;
use crate::unknown::Unknown;
use crate::{Error, Observation};
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_linalg::Dissections;
use voronudge_model::BlockMatrix;

impl<'a> Objective<'a> {
    /// The problem linearised about a point.
    pub fn linearise(&self, parameters: &[f64]) -> Result<NormalEquations, Error> {
        self.linearise_with(parameters, &[])
    }

    /// What is measured of one frame, linearised about its nudges; weights of velocities are not yet in it.
    pub fn measurable(
        &self,
        index: usize,
        coefficients: &[f64],
        nudges: &[f64],
    ) -> Result<Measurable<'a>, Error> {
        let nudged = self.displaced_with_own(index, nudges, coefficients)?;
        let predicted = nudged.predict(coefficients);
        let placed = (nudged, predicted);
        let (rows, jacobian) = self.derivatives(index, coefficients, nudges, &placed)?;
        Ok(Measurable { nudged: placed.0, rows, jacobian })
    }

    /// The residuals of one frame with their derivatives by the free coefficients, and the derivative of what is measured by the positions.
    fn derivatives(
        &self,
        index: usize,
        coefficients: &[f64],
        nudges: &[f64],
        (nudged, predicted): &Moving<'_>,
    ) -> Result<(Vec<Row>, BlockMatrix), Error> {
        let frame = &self.frames[index];
        let evaluated = match self.own {
            // What a cell has of its own does not change with the coefficients.
            Some(_) => self.displaced(index, nudges)?.evaluate(coefficients),
            None => nudged.evaluate(coefficients),
        };
        let of_free = free_rows(frame, &evaluated.by_coefficient, self.space);
        let rests = residuals(frame, predicted.as_measured()).into_iter();
        let rows = rests.zip(of_free).map(|((datum, rest), x)| (datum, rest, x)).collect();
        let mut jacobian = nudged.jacobian(coefficients, &predicted.of_cells);
        if !frame.is_free() {
            jacobian = jacobian.only(|cell| !frame.is_held(cell));
        }
        Ok((rows, jacobian))
    }

    /// The same with unknowns of the measurement as further coefficients, after all others.
    pub fn linearise_with(&self, parameters: &[f64], unknowns: &[Unknown]) -> Result<NormalEquations, Error> {
        self.linearise_among(&self.placed_at(parameters)?, parameters, unknowns, None)
    }

    /// The same for the nudges of those cells alone that are not held, where there is one frame.
    pub fn linearise_free(
        &self,
        placed: &[Moving<'_>],
        parameters: &[f64],
        free: &Free,
    ) -> Result<NormalEquations, Error> {
        self.linearise_among(placed, parameters, &[], Some(free))
    }

    /// The problem that noise levels come from, and its number of components: that of all data, of large frames that of patches.
    pub fn linearise_for_levels(
        &self,
        parameters: &[f64],
        unknowns: &[Unknown],
    ) -> Result<(NormalEquations, usize), Error> {
        let (_, nudges) = self.split(parameters);
        let parts = self.linear(&self.placed_at(parameters)?, parameters, unknowns)?;
        let of_frame = |(linear, nudges): (&Linear<'_>, &&[f64])| match Patches::of(linear.frame) {
            Some(patches) => linear.in_patches(&patches, nudges),
            None => (vec![linear.whole(nudges)], linear.frame.components()),
        };
        let parts: Vec<(Vec<Linearisation>, usize)> = parts.par_iter().zip(&nudges).map(of_frame).collect();
        let components = parts.iter().map(|(_, components)| components).sum();
        let all = parts.into_iter().flat_map(|(parts, _)| parts).collect();
        Ok((self.equations(parameters, unknowns, all), components))
    }

    pub(super) fn linearise_among(
        &self,
        placed: &[Moving<'_>],
        parameters: &[f64],
        unknowns: &[Unknown],
        among: Option<&Free>,
    ) -> Result<NormalEquations, Error> {
        let (_, nudges) = self.split(parameters);
        let parts = self.linear(placed, parameters, unknowns)?;
        let of_frame = |(linear, nudges): (Linear<'_>, &&[f64])| match among {
            Some(free) => linear.among(free, nudges),
            None => linear.whole(nudges),
        };
        let all = parts.into_par_iter().zip(&nudges).map(of_frame).collect();
        Ok(self.equations(parameters, unknowns, all))
    }

    fn equations(
        &self,
        parameters: &[f64],
        unknowns: &[Unknown],
        parts: Vec<Linearisation>,
    ) -> NormalEquations {
        let mut free = self.split(parameters).0.to_vec();
        free.resize(self.space.dimension() + unknowns.len(), 0.0);
        NormalEquations::new(&self.space.widened(unknowns.len()), self.levels, &free, parts)
    }

    /// What is measured of each frame, linearised.
    pub fn linear(
        &self,
        placed: &[Moving<'_>],
        parameters: &[f64],
        unknowns: &[Unknown],
    ) -> Result<Vec<Linear<'a>>, Error> {
        let (free, nudges) = self.split(parameters);
        let coefficients = self.space.coefficients(free);
        let own = self.space.dimension();
        let p = own + unknowns.len();
        let of_share = unknowns.iter().position(|unknown| *unknown == Unknown::Share).map(|k| own + k);
        let of_width = unknowns.iter().position(|unknown| *unknown == Unknown::Width).map(|k| own + k);
        let of_frame =
            |(index, ((frame, nudges), placed)): (usize, ((&'a Observation, &&[f64]), &Moving<'_>))| {
                let (mut rows, mut jacobian) =
                    self.derivatives(index, coefficients.as_slice(), nudges, placed)?;
                let (nudged, predicted) = placed;
                for (_, _, x) in &mut rows {
                    *x = std::mem::take(x).resize_horizontally(p, 0.0);
                }
                if let (Some(k), Some(sampling)) = (of_width, &nudged.sampling) {
                    let slopes = sampling.width_slope(&predicted.of_cells);
                    let mut slopes: Vec<Vector<f64>> =
                        rows.iter().map(|(datum, ..)| slopes[*datum]).collect();
                    frame.remove_background(&mut slopes);
                    rows.iter_mut().zip(slopes).for_each(|((_, _, x), slope)| x.set_column(k, &slope));
                }
                frame.weigh(&mut rows, &mut jacobian);
                let positions =
                    PositionRows::new(frame, &nudged.tessellation, &nudged.positions, nudges, p, of_share);
                Ok(Linear { frame, floor: self.floor(), p, rows, jacobian, positions })
            };
        self.frames.par_iter().zip(&nudges).zip(placed).enumerate().map(of_frame).collect()
    }
}

/// What is measured of one frame, linearised about its nudges.
pub(crate) struct Linear<'a> {
    pub frame: &'a Observation,
    /// Stiffness of cells that were not seen.
    floor: f64,
    /// Number of free coefficients.
    p: usize,
    /// Of velocities.
    pub rows: Vec<Row>,
    jacobian: BlockMatrix,
    positions: PositionRows,
}

impl Linear<'_> {
    /// The problem of all nudges.
    pub fn whole(&self, nudges: &[f64]) -> Linearisation {
        let all: Vec<usize> = (0..self.frame.positions.len()).collect();
        self.of_cells(&all, nudges)
    }

    /// That of the nudges of free cells.
    fn among(mut self, free: &Free, nudges: &[f64]) -> Linearisation {
        free.renumber(&mut self.jacobian);
        self.positions.keep(free);
        self.of_cells(&free.cells, &free.of(nudges))
    }

    /// That of the nudges of some cells with all data that depend on them, the others held.
    pub fn around(&self, free: &Free, nudges: &[f64]) -> Linearisation {
        let (jacobian, rows) = free.part_of(&Rows { jacobian: &self.jacobian, rows: &self.rows });
        let Self { frame, floor, p, .. } = *self;
        let positions = self.positions.around(free);
        Linear { frame, floor, p, rows, jacobian, positions }.of_cells(&free.cells, &free.of(nudges))
    }

    fn of_cells(&self, cells: &[usize], nudges: &[f64]) -> Linearisation {
        let frame = self.frame;
        let of_cell = |cell: &usize| if frame.is_seen(*cell) { 0.0 } else { self.floor };
        Linearisation::new(Local {
            velocities: Rows { jacobian: &self.jacobian, rows: &self.rows },
            positions: self.positions.rows(),
            known: Vec::new(),
            nudges,
            stiffness: match frame.unseen() {
                0 => Stiffness::default(),
                _ => Stiffness::of_blocks(cells.iter().map(of_cell)),
            },
            free: self.p,
            places: self.places(cells),
            chains: (0..cells.len() as u32).collect(),
            dissections: frame.dissections(),
            left_out: frame.positions.len() - cells.len(),
        })
    }

    fn places(&self, cells: &[usize]) -> Vec<Option<[f64; 3]>> {
        cells.iter().map(|cell| self.frame.positions[*cell]).map(|r| Some([r[0], r[1], 0.0])).collect()
    }

    /// One problem for each patch, and the number of components of all of them that neither a background nor cells without a measured position take up.
    pub fn in_patches(&self, patches: &Patches, nudges: &[f64]) -> (Vec<Linearisation>, usize) {
        let of_patch = |(patch, cells): (usize, &Vec<usize>)| {
            let velocities = patches.velocities(patch, &Rows { jacobian: &self.jacobian, rows: &self.rows });
            let (positions, lacking) = patches.positions(patch, &self.positions.rows());
            let mut met = vec![false; cells.len()];
            [&velocities, &positions].iter().for_each(|own| own.mark(&mut met));
            let unseen = lacking.iter().zip(&met).filter(|(lacking, met)| **lacking && **met).count();
            let own: Vec<f64> =
                cells.iter().flat_map(|cell| [nudges[2 * cell], nudges[2 * cell + 1]]).collect();
            let local = Linearisation::new(Local {
                velocities: velocities.rows(),
                positions: positions.rows(),
                known: Vec::new(),
                nudges: &own,
                stiffness: Stiffness::of_blocks(
                    lacking.iter().map(|lacking| if *lacking { self.floor } else { 0.0 }),
                ),
                free: self.p,
                places: self.places(cells),
                chains: Vec::new(),
                dissections: &Dissections::default(),
                left_out: 0,
            });
            (local, (2 * velocities.count()).saturating_sub(2 * unseen))
        };
        let parts: Vec<_> = patches.cells.par_iter().enumerate().map(of_patch).collect();
        let components = parts.iter().map(|(_, components)| components).sum::<usize>();
        let parts = parts.into_iter().map(|(part, _)| part).collect();
        (parts, components.saturating_sub(self.frame.background_dimension()))
    }
}
