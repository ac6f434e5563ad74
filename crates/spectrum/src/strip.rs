//! A strip of rows of cells: periodic along y, with ends across.

use crate::Error;
use crate::bloch::{BlochMatrix, MiddleRoots};
use crate::localisation::{Localisation, Rows};
use rayon::prelude::*;
use std::f64::consts::TAU;
use voronudge_geometry::Vector;
use voronudge_linalg::{Complex64, eigen_complex};
use voronudge_model::BlockMatrix;

/// What ends the rows of a honeycomb on both sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// Nothing: the last row meets the first.
    Periodic,
    /// A row at each end whose cells are held where they are.
    Held,
    /// Torque-free walls.
    Walls,
}

/// Rows of cells along y, each a lattice of one cell in a period, and how the velocities of one cell of each depend on all others.
///
/// The displacements `u_r exp(i q y)` of the rows r obey `∂_t u = J(q) u` with
///
/// ```text
/// J(q)_rs = Σ_{j in row s} J_ij exp(i q (y_j − y_i))          i: a cell of row r
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    places: Vec<f64>,
    period: f64,
    couplings: Vec<Coupling>,
    centred: bool,
}

/// A block of the Jacobian between cells of two rows.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Coupling {
    rows: [usize; 2],
    /// Displacement along the rows.
    along: f64,
    block: [f64; 4],
}

/// Fewest rows that move: the middle one must not feel both ends.
const FEWEST: usize = 6;

/// Rows whose cells differ more in x, relative to the period, are not straight.
const STRAIGHT: f64 = 1e-7;

/// One mode of a strip.
#[derive(Debug, Clone, PartialEq)]
pub struct StripMode {
    /// λ
    pub value: Complex64,
    /// Where it is.
    pub localisation: Localisation,
    /// |u|² of each row, with sum one.
    pub profile: Vec<f64>,
    /// What the periodic tissue says of it.
    pub middle_roots: Option<MiddleRoots>,
    /// How often the spectrum of the periodic tissue winds around its value.
    pub winding: i32,
}

impl StripMode {
    /// The growth per row that the periodic tissue has the mode grow by: that of the generalised Brillouin zone for a mode that fills the strip,
    /// that of the root of its side for one of an edge.
    pub fn expected_growth(&self, rows: usize) -> Option<f64> {
        let roots = self.middle_roots?;
        Some(match (self.is_of_edge(rows), self.localisation.side < 0.0) {
            (false, _) => roots.growth(),
            (true, true) => roots.below,
            (true, false) => roots.above,
        })
    }

    /// Whether it is a mode of an edge: more than a third of it is at the ends, and no two waves of the periodic tissue that make a mode of the whole
    /// strip decay alike.
    pub fn is_of_edge(&self, rows: usize) -> bool {
        let gap = self.middle_roots.map_or(f64::INFINITY, |roots| roots.gap());
        self.localisation.edge > EDGE_SHARE && gap * rows as f64 > EDGE_GAP
    }

    /// Whether it grows by more than a factor e from one end to the other, and if so whether to the right.
    pub fn piles_up_right(&self, rows: &[f64]) -> Option<bool> {
        let width = rows.last().zip(rows.first()).map_or(0.0, |(last, first)| last - first);
        (self.localisation.growth.abs() * width > 1.0).then_some(self.localisation.growth > 0.0)
    }
}

/// In modes that fill a strip the two waves differ at one end by what they are reflected with: `rows × gap` is the logarithm of that.
const EDGE_GAP: f64 = 10.0;

/// Share within two rows of the ends.
const EDGE_SHARE: f64 = 1.0 / 3.0;

impl Strip {
    /// From the Jacobian of a tissue of rows that are periodic along y, at positions (N) in a box with these side lengths. `row_of` has the row of each
    /// cell that moves, from left to right. `centred` says that each cell of the lattice is a centre of inversion, as it is where forces know
    /// no direction.
    ///
    /// # Errors
    /// [`Error::FewRows`], [`Error::CrookedRow`] if the cells of a row do not lie on a line along y at equal distances.
    pub fn new(
        jacobian: &BlockMatrix,
        positions: &[Vector<f64>],
        lengths: [f64; 2],
        row_of: &[Option<usize>],
        centred: bool,
    ) -> Result<Self, Error> {
        let rows = row_of.iter().flatten().max().map_or(0, |last| last + 1);
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); rows];
        for (cell, row) in row_of.iter().enumerate() {
            if let Some(row) = row {
                members[*row].push(cell);
            }
        }
        let per_row = members.iter().map(Vec::len).min().unwrap_or(0);
        if rows < FEWEST || per_row == 0 {
            return Err(Error::FewRows { rows, least: FEWEST });
        }
        let period = lengths[1] / per_row as f64;
        let wrapped = |y: f64| y - lengths[1] * (y / lengths[1]).round();
        let mut places = Vec::new();
        let mut couplings = Vec::new();
        for (row, cells) in members.iter().enumerate() {
            let first = cells[0];
            let straight = cells.iter().all(|&cell| {
                let d = positions[cell] - positions[first];
                let steps = d.y / period;
                d.x.abs() < STRAIGHT * period && (steps - steps.round()).abs() < STRAIGHT
            });
            if !straight || cells.len() != per_row {
                return Err(Error::CrookedRow { row });
            }
            places.push(positions[first].x);
            for (other, block) in jacobian.row(first) {
                if let Some(to) = row_of[other] {
                    let along = wrapped(positions[other].y - positions[first].y);
                    couplings.push(Coupling { rows: [row, to], along, block: *block });
                }
            }
        }
        Ok(Self { places, period, couplings, centred })
    }

    /// Places of the rows that move (length), from left to right.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// Mean distance of the rows that move.
    pub fn spacing(&self) -> f64 {
        let rows = self.places.len();
        (self.places[rows - 1] - self.places[0]) / (rows - 1) as f64
    }

    /// The period of the rows along y.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// `steps + 1` wave numbers (1/length) at equal distances from one end of the Brillouin zone of the rows to the other.
    pub fn wave_numbers(&self, steps: usize) -> Vec<f64> {
        let at = |step: usize| (step as f64 / steps as f64 - 0.5) * TAU / self.period;
        (0..=steps).map(at).collect()
    }

    /// `J(q)`, row by row, of order twice the number of rows that move.
    pub fn matrix(&self, q: f64) -> Vec<Complex64> {
        let order = 2 * self.places.len();
        let mut matrix = vec![Complex64::ZERO; order * order];
        for Coupling { rows: [row, to], along, block } in &self.couplings {
            let phase = Complex64::from_polar(1.0, q * along);
            for (entry, value) in block.iter().enumerate() {
                matrix[(2 * row + entry / 2) * order + 2 * to + entry % 2] += phase * value;
            }
        }
        matrix
    }

    /// The tissue that repeats the middle row of the strip. Where cells are centres of inversion, `J_{−m}` is the conjugate of `J_m`; what the
    /// ends leave of a difference is taken out.
    pub fn periodic(&self, q: f64) -> BlochMatrix {
        let middle = self.places.len() / 2;
        let of_middle = || self.couplings.iter().filter(|own| own.rows[0] == middle);
        let range = of_middle().map(|own| own.rows[1].abs_diff(middle)).max().unwrap_or(0);
        let mut blocks = vec![[Complex64::ZERO; 4]; 2 * range + 1];
        for Coupling { rows: [_, to], along, block } in of_middle() {
            let phase = Complex64::from_polar(1.0, q * along);
            let sum = &mut blocks[to + range - middle];
            sum.iter_mut().zip(block).for_each(|(sum, entry)| *sum += phase * entry);
        }
        if self.centred {
            for m in 0..=range {
                let (ahead, behind) = (blocks[range + m], blocks[range - m]);
                for (entry, (a, b)) in ahead.iter().zip(behind).enumerate() {
                    let mean = 0.5 * (a + b.conj());
                    (blocks[range + m][entry], blocks[range - m][entry]) = (mean, mean.conj());
                }
            }
        }
        BlochMatrix::new(blocks)
    }

    /// All modes at a wave number along the rows, the fastest growing first.
    ///
    /// # Errors
    /// [`Error::LinearAlgebra`].
    pub fn modes(&self, q: f64) -> Result<Vec<StripMode>, Error> {
        let pairs = eigen_complex(&self.matrix(q), 2 * self.places.len(), true)?;
        let (rows, periodic) = (Rows::of_strip(&self.places), self.periodic(q));
        let mode = |(index, &value): (usize, &Complex64)| {
            let u = pairs.right(index).unwrap_or_default();
            Ok(StripMode {
                value,
                localisation: rows.localisation(&u),
                profile: rows.profile(&u),
                middle_roots: periodic.middle_roots(value)?,
                winding: periodic.winding(value)?,
            })
        };
        pairs.values.iter().enumerate().map(mode).collect()
    }

    /// The modes at many wave numbers.
    ///
    /// # Errors
    /// As [`Strip::modes`].
    pub fn bands(&self, wave_numbers: &[f64]) -> Result<Vec<Vec<StripMode>>, Error> {
        wave_numbers.par_iter().map(|&q| self.modes(q)).collect()
    }
}

/// Numbers of a honeycomb's rows from left to right, for the cells of [`Honeycomb`](crate::Honeycomb) with rows along y: the first rows of the lattice are at the right.
pub fn rows_of_honeycomb(columns: usize, rows: usize, ends: Ends) -> Vec<Option<usize>> {
    let row = |cell: usize| {
        let from_left = rows - 1 - cell / columns;
        match ends {
            Ends::Periodic | Ends::Walls => Some(from_left),
            Ends::Held if from_left == 0 || from_left + 1 == rows => None,
            Ends::Held => Some(from_left - 1),
        }
    };
    (0..columns * rows).map(row).collect()
}
