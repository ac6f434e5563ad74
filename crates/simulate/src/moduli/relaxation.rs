//! A simulation brought to rest.

use super::Observer;
use crate::{Error, Simulation, State};
use voronudge_geometry::{Domain, Vector};
use voronudge_linalg::{BlockSparse, LinearSystem};
use voronudge_model::{BlockMatrix, jacobian, jacobian_with_images};

/// When a tissue counts as being at rest, and how it is brought there.
///
/// The equation of motion is integrated in time. Once all cells are slow, implicit steps go on, `(1/h − J) δ = v`, whose size `h`
/// grows as the cells slow down: they follow the motion, get over the slowest modes quickly, and end as Newton's method. Where
/// they do not lead to lower speeds, time goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// The time step.
    pub time_step: f64,
    /// The longest time a tissue is given to come to rest, implicit steps not counted.
    pub longest: f64,
    /// A tissue in which no cell is faster is at rest (length/time).
    pub tolerance: f64,
    /// Below this speed of the fastest cell implicit steps are tried (length/time).
    pub slow: f64,
}

impl Default for Relaxation {
    /// For unit cells and `K_P = 1`.
    fn default() -> Self {
        Self { time_step: 0.01, longest: 300.0, tolerance: 1e-10, slow: 1e-2 }
    }
}

/// Steps between two looks at the speed.
const STEPS: usize = 100;
/// Most implicit steps in a row.
const MOST: usize = 200;
/// The first implicit step and the largest, in time steps.
const FIRST: f64 = 100.0;
const LARGEST: f64 = 1e10;
/// Farthest that one implicit step may take a cell, in mean spacings.
const FARTHEST: f64 = 0.05;

/// Largest speed.
pub(super) fn fastest(velocities: &[Vector<f64>]) -> f64 {
    velocities.iter().map(Vector::norm_squared).fold(0.0, f64::max).sqrt()
}

impl Relaxation {
    /// Brings a simulation to rest if that can be done, and returns the speed of the fastest cell.
    pub(super) fn relax(&self, simulation: &mut Simulation, observer: Observer<'_>) -> Result<f64, Error> {
        let end = simulation.time() + self.longest;
        loop {
            let mut speed = fastest(simulation.velocities());
            if speed > self.tolerance && speed <= self.slow {
                self.implicit(simulation, observer)?;
                speed = fastest(simulation.velocities());
            }
            if speed <= self.tolerance || simulation.time() >= end {
                return Ok(speed);
            }
            for _ in 0..STEPS {
                simulation.step(self.time_step)?;
            }
            observer.look()?;
        }
    }

    /// Implicit steps for as long as they lead to lower speeds.
    fn implicit(&self, simulation: &mut Simulation, observer: Observer<'_>) -> Result<(), Error> {
        let first = FIRST * self.time_step;
        let mut h = first;
        for _ in 0..MOST {
            let speed = fastest(simulation.velocities());
            if speed <= self.tolerance {
                return Ok(());
            }
            observer.look()?;
            let next = implicit_step(simulation, h);
            let Some((after, next)) = next.map(|next| (fastest(next.velocities()), next)) else {
                return Ok(());
            };
            let moved =
                next.positions().iter().zip(simulation.positions()).map(|(r, from)| (r - from).norm());
            let near = moved.fold(0.0, f64::max) < FARTHEST * simulation.spacing();
            if near && after < 2.0 * speed {
                *simulation = next;
                h = (h * (2.0 * speed / after).clamp(1.0, 100.0)).min(LARGEST * self.time_step);
            } else if h > first {
                h = (0.1 * h).max(first);
            } else {
                return Ok(());
            }
        }
        Ok(())
    }
}

/// The exact Jacobian of the velocities of a periodic tissue, or of one between walls, and where its unknowns are.
pub(super) struct SparseJacobian {
    pub matrix: BlockSparse,
    pub places: Vec<[f64; 2]>,
}

impl SparseJacobian {
    pub fn of(simulation: &Simulation) -> Result<Self, Error> {
        let (tessellation, positions) = (simulation.tessellation(), simulation.positions());
        let Domain::Periodic(cell_box) = tessellation.domain() else {
            return Err(Error::OpenDomain);
        };
        let BlockMatrix { row_start, column, block } = match simulation.walls() {
            Some(walls) => jacobian_with_images(
                tessellation,
                simulation.positions_with_images(),
                simulation.model(),
                walls.mirrors(),
                positions.len(),
            ),
            None => jacobian(tessellation, positions, simulation.model()),
        };
        let matrix = BlockSparse::new(row_start, column, block)
            .map_err(|source| Error::Response { frequency: 0.0, source })?;
        Ok(Self { matrix, places: positions.iter().map(|r| cell_box.wrap(*r).into()).collect() })
    }
}

/// The state after an implicit step of size `h`; none if it cannot be made.
fn implicit_step(simulation: &Simulation, h: f64) -> Option<Simulation> {
    let SparseJacobian { matrix, places } = SparseJacobian::of(simulation).ok()?;
    let positions = simulation.positions();
    let mut step: Vec<f64> = simulation.velocities().iter().flat_map(|v| [-v.x, -v.y]).collect();
    LinearSystem::new(&matrix, 1.0 / h, &places).ok()?.solve(&mut step);
    let moved = |(r, d): (&Vector<f64>, &[f64])| r + Vector::new(d[0], d[1]);
    let positions = positions.iter().zip(step.chunks_exact(2)).map(moved).collect();
    simulation.clone().in_state(State { positions, ..simulation.state().clone() }).ok()
}
