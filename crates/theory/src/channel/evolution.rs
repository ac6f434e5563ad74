//! The continuum equations of a channel in time, on a grid.

use super::{ChannelMedium, ChannelTurnover};
use crate::{EquationOfState, Error};

/// Density and velocities from an edge to the middle of a channel, in time:
///
/// ```text
/// ∂_t ρ + ∂_x(ρ v_x) = (k_prolif − k_extr) ρ
/// ```
///
/// with the force balance of [`ChannelMedium`] or of an [`EquationOfState`]. At the edge and in the middle both velocities vanish, by the symmetry of the
/// periodic box under rotations by π.
///
/// Between torque-free walls `v_x` vanishes at the edge too, since no cell passes, and without viscosities the theory is the same. `v_y` of
/// the cells does not: at the wall it is the shear stress `σ_yx` that vanishes, and the step up to the chiral prestress of the
/// tissue, which has no gradient elsewhere, drives an edge current that is not in here. With viscosities `v_y = 0` is the wrong condition there.
///
/// Densities belong to the cells of a grid, velocities to the faces between; fluxes cancel, so
/// cells are conserved to rounding. Second order in space, classical Runge–Kutta steps in time.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelEvolution {
    tissue: Tissue,
    turnover: ChannelTurnover,
    spacing: f64,
    /// Means of `exp(−d/d_extr)` and `exp(−d/d_prolif)` over each grid cell.
    decays: [Vec<f64>; 2],
    /// `ρ/ρ₀` of each grid cell.
    density: Vec<f64>,
    time: f64,
}

/// What gradients of the density push with.
#[derive(Debug, Clone, PartialEq)]
enum Tissue {
    Medium(ChannelMedium),
    Liquid(EquationOfState),
}

/// Largest eigenvalue times step for which the classical Runge–Kutta method is stable, with a margin.
const STABLE: f64 = 2.5;

impl ChannelEvolution {
    /// A channel of uniform density, seen on a grid of so many cells from the edge to the middle.
    ///
    /// # Errors
    /// [`Error::Channel`] if medium or turnover cannot be; [`Error::Grid`] for fewer than two grid cells.
    ///
    /// ```
    /// use voronudge_theory::{ChannelEvolution, ChannelMedium, ChannelTurnover};
    /// let turnover = ChannelTurnover {
    ///     width: 10.0, extrusion_rate: 0.1, extrusion_length: 1.4, proliferation_length: 0.25,
    /// };
    /// let mut flow = ChannelEvolution::new(ChannelMedium::elastic(3.0, 4.5)?, turnover, 40)?;
    /// flow.advance(50.0);
    /// let [v_x, v_y] = flow.velocities();
    /// assert!((v_y[10] / v_x[10] - 1.5).abs() < 1e-12);
    /// assert!((flow.density().iter().sum::<f64>() / 40.0 - 1.0).abs() < 1e-12);
    /// # Ok::<(), voronudge_theory::Error>(())
    /// ```
    pub fn new(medium: ChannelMedium, turnover: ChannelTurnover, cells: usize) -> Result<Self, Error> {
        Self::of(Tissue::Medium(medium.checked()?), turnover, cells)
    }

    /// The same of a liquid that gradients of pressure and torques move.
    ///
    /// # Errors
    /// [`Error::EquationOfState`] where the pressure does not rise with the density; otherwise as [`new`](Self::new).
    pub fn of_liquid(
        equation: EquationOfState,
        turnover: ChannelTurnover,
        cells: usize,
    ) -> Result<Self, Error> {
        if equation.stiffness()[0] <= 0.0 {
            return Err(Error::EquationOfState { reason: "a pressure that does not rise with the density" });
        }
        Self::of(Tissue::Liquid(equation), turnover, cells)
    }

    fn of(tissue: Tissue, turnover: ChannelTurnover, cells: usize) -> Result<Self, Error> {
        let turnover = turnover.checked()?;
        if cells < 2 {
            return Err(Error::Grid { cells });
        }
        let spacing = 0.5 * turnover.width / cells as f64;
        let lengths = [turnover.extrusion_length, turnover.proliferation_length];
        let decays = lengths.map(|length| {
            let mean = |cell: usize| {
                (-(cell as f64 * spacing) / length).exp() * -(-spacing / length).exp_m1() * length / spacing
            };
            (0..cells).map(mean).collect()
        });
        Ok(Self { tissue, turnover, spacing, decays, density: vec![1.0; cells], time: 0.0 })
    }

    /// Time since the beginning.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Middles of the grid cells: where densities belong.
    pub fn centres(&self) -> Vec<f64> {
        (0..self.density.len()).map(|cell| (cell as f64 + 0.5) * self.spacing).collect()
    }

    /// Edge, faces between grid cells, and middle of the channel: where velocities belong.
    pub fn faces(&self) -> Vec<f64> {
        (0..=self.density.len()).map(|face| face as f64 * self.spacing).collect()
    }

    /// `ρ/ρ₀`, with the mean `ρ₀` of the channel at the beginning.
    pub fn density(&self) -> &[f64] {
        &self.density
    }

    /// `v_x` and `v_y` at the faces.
    pub fn velocities(&self) -> [Vec<f64>; 2] {
        self.velocities_of(&self.density)
    }

    /// Goes on for a time, in equal steps that are stable.
    pub fn advance(&mut self, time: f64) {
        let highest = self.density.iter().copied().fold(1.0, f64::max);
        // The density at the edge can still rise; a tenth is room for that in each of these pieces.
        let stiffest = match &self.tissue {
            Tissue::Medium(medium) => medium.longitudinal * highest,
            Tissue::Liquid(equation) => equation.stiffness()[1],
        };
        let rate = 4.4 * stiffest / (self.spacing * self.spacing) + self.turnover.extrusion_rate;
        let steps = (time * rate / STABLE).ceil().max(1.0) as usize;
        let step = time / steps as f64;
        for _ in 0..steps {
            let k1 = self.slope(&self.density);
            let k2 = self.slope(&self.moved(&k1, 0.5 * step));
            let k3 = self.slope(&self.moved(&k2, 0.5 * step));
            let k4 = self.slope(&self.moved(&k3, step));
            for (cell, density) in self.density.iter_mut().enumerate() {
                *density += step / 6.0 * (k1[cell] + 2.0 * (k2[cell] + k3[cell]) + k4[cell]);
            }
        }
        self.time += time;
    }

    /// Goes on until no density changes by more than `tolerance` of `ρ₀` in a unit of time, or for `longest`; tells whether it
    /// got there.
    pub fn settle(&mut self, tolerance: f64, longest: f64) -> bool {
        let end = self.time + longest;
        loop {
            if self.slope(&self.density).iter().all(|rate| rate.abs() <= tolerance) {
                return true;
            }
            if self.time >= end {
                return false;
            }
            self.advance((0.01 * longest).min(1.0));
        }
    }

    fn moved(&self, slope: &[f64], step: f64) -> Vec<f64> {
        self.density.iter().zip(slope).map(|(density, slope)| density + step * slope).collect()
    }

    /// `∂_t ρ` of each grid cell.
    fn slope(&self, density: &[f64]) -> Vec<f64> {
        let [v_x, _] = self.velocities_of(density);
        let flux = |face: usize| {
            if face == 0 || face == density.len() {
                return 0.0;
            }
            0.5 * (density[face - 1] + density[face]) * v_x[face]
        };
        let [extrusion, proliferation] = &self.decays;
        let sum =
            |decay: &[f64]| decay.iter().zip(density).map(|(decay, density)| decay * density).sum::<f64>();
        let k_extr = self.turnover.extrusion_rate;
        let k_prolif = k_extr * sum(extrusion) / sum(proliferation);
        (0..density.len())
            .map(|cell| {
                (flux(cell) - flux(cell + 1)) / self.spacing
                    + (k_prolif * proliferation[cell] - k_extr * extrusion[cell]) * density[cell]
            })
            .collect()
    }

    fn velocities_of(&self, density: &[f64]) -> [Vec<f64>; 2] {
        let cells = density.len();
        // On the cells between two grid cells, per cell.
        let force = |face: usize| {
            if face == 0 || face == cells {
                return [0.0; 2];
            }
            let (before, after) = (density[face - 1], density[face]);
            match &self.tissue {
                Tissue::Medium(medium) => [medium.longitudinal, medium.transverse]
                    .map(|modulus| -modulus * ((after - before) / self.spacing)),
                Tissue::Liquid(equation) => [
                    equation.pressure(after) - equation.pressure(before),
                    0.5 * (equation.torque(after) - equation.torque(before)),
                ]
                .map(|rise| -rise / (0.5 * (before + after) * self.spacing)),
            }
        };
        let forces: Vec<[f64; 2]> = (0..=cells).map(force).collect();
        let velocities = match &self.tissue {
            Tissue::Medium(medium) => self.viscous(medium, forces),
            Tissue::Liquid(_) => forces,
        };
        [0, 1].map(|axis| velocities.iter().map(|v| v[axis]).collect())
    }

    /// Solves `v − η ∂_x² v = f` with `v = 0` at both ends: block elimination (Thomas).
    fn viscous(&self, medium: &ChannelMedium, mut forces: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        let viscosities = [
            [medium.longitudinal_viscosity, medium.odd_shear_viscosity],
            [medium.odd_bulk_viscosity - medium.odd_shear_viscosity, medium.shear_viscosity],
        ];
        if viscosities == [[0.0; 2]; 2] {
            return forces;
        }
        let share = viscosities.map(|row| row.map(|eta| eta / (self.spacing * self.spacing)));
        let diagonal =
            [[1.0 + 2.0 * share[0][0], 2.0 * share[0][1]], [2.0 * share[1][0], 1.0 + 2.0 * share[1][1]]];
        let last = forces.len() - 1;
        forces[0] = [0.0; 2];
        // Above[face] v[face + 1] is what is left of the next unknown in the line of a face.
        let mut above = vec![[[0.0; 2]; 2]; forces.len()];
        for face in 1..last {
            let coupled = product(share, above[face - 1]);
            let own = inverse([0, 1].map(|i| [0, 1].map(|j| diagonal[i][j] - coupled[i][j])));
            above[face] = product(own, share);
            let before = apply(share, forces[face - 1]);
            forces[face] = apply(own, [forces[face][0] + before[0], forces[face][1] + before[1]]);
        }
        forces[last] = [0.0; 2];
        for face in (1..last).rev() {
            let next = apply(above[face], forces[face + 1]);
            forces[face] = [forces[face][0] + next[0], forces[face][1] + next[1]];
        }
        forces
    }
}

type Block = [[f64; 2]; 2];

fn product(a: Block, b: Block) -> Block {
    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

fn apply(a: Block, v: [f64; 2]) -> [f64; 2] {
    a.map(|row| row[0] * v[0] + row[1] * v[1])
}

fn inverse([[a, b], [c, d]]: Block) -> Block {
    let determinant = a * d - b * c;
    [[d / determinant, -b / determinant], [-c / determinant, a / determinant]]
}
