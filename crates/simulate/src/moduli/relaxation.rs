//! A simulation brought to rest.

use super::Observer;
use crate::{Error, Simulation, State};
use voronudge_geometry::{Domain, Vector};
use voronudge_linalg::{BlockSparse, LinearSystem};
use voronudge_model::jacobian;

/// When a tissue counts as being at rest, and how it is brought there.
///
/// The equation of motion is integrated in time. Once all cells are slow, Newton's method goes on, `J δ = −v`, which gets over the
/// slowest modes at once; if it does not lead to rest near by, time goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// The time step.
    pub time_step: f64,
    /// The longest time a tissue is given to come to rest.
    pub longest: f64,
    /// A tissue in which no cell is faster is at rest (length/time).
    pub tolerance: f64,
    /// Below this speed of the fastest cell Newton's method is tried (length/time).
    pub slow: f64,
}

impl Default for Relaxation {
    /// For unit cells and `K_P = 1`.
    fn default() -> Self {
        Self { time_step: 0.02, longest: 300.0, tolerance: 1e-10, slow: 1e-3 }
    }
}

/// Steps between two looks at the speed.
const STEPS: usize = 100;
/// Most iterations of Newton's method.
const ITERATIONS: usize = 12;
/// Halvings of a step that does not lead to lower speed.
const HALVINGS: usize = 4;
/// Farthest that Newton's method may take a cell, in mean spacings: a rest farther away may be another one.
const FARTHEST: f64 = 0.1;

/// Largest speed.
pub(super) fn fastest(velocities: &[Vector<f64>]) -> f64 {
    velocities.iter().map(Vector::norm_squared).fold(0.0, f64::max).sqrt()
}

impl Relaxation {
    /// Brings a simulation to rest if that can be done, and returns the speed of the fastest cell.
    pub(super) fn relax(&self, simulation: &mut Simulation, observer: Observer<'_>) -> Result<f64, Error> {
        let end = simulation.time() + self.longest;
        loop {
            let speed = fastest(simulation.velocities());
            if speed <= self.tolerance {
                return Ok(speed);
            }
            if speed <= self.slow
                && let Some(rest) = self.newton(simulation)
            {
                *simulation = rest;
                return Ok(fastest(simulation.velocities()));
            }
            if simulation.time() >= end {
                return Ok(speed);
            }
            for _ in 0..STEPS {
                simulation.step(self.time_step)?;
            }
            observer.look()?;
        }
    }

    /// The rest near by, if Newton's method finds one.
    fn newton(&self, from: &Simulation) -> Option<Simulation> {
        let mut now = from.clone();
        for _ in 0..ITERATIONS {
            let speed = fastest(now.velocities());
            if speed <= self.tolerance {
                return Some(now);
            }
            let step = newton_step(&now)?;
            now = (0..HALVINGS).find_map(|halvings| {
                let share = 0.5f64.powi(halvings as i32);
                let moved = |(r, d): (&Vector<f64>, &Vector<f64>)| r + d * share;
                let positions: Vec<_> = now.positions().iter().zip(&step).map(moved).collect();
                let far = |(r, from): (&Vector<f64>, &Vector<f64>)| (r - from).norm();
                let farthest = positions.iter().zip(from.positions()).map(far).fold(0.0, f64::max);
                if farthest.is_nan() || farthest > FARTHEST * now.spacing() {
                    return None;
                }
                let next = now.clone().in_state(State { positions, ..now.state().clone() }).ok()?;
                (fastest(next.velocities()) < speed).then_some(next)
            })?;
        }
        None
    }
}

/// The displacement `δ` with `J δ = −v`. The first cell stays: translations are free.
fn newton_step(simulation: &Simulation) -> Option<Vec<Vector<f64>>> {
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions());
    let matrix = jacobian(tessellation, positions, simulation.model());
    let (mut row_start, mut column, mut block) = (vec![0], Vec::new(), Vec::new());
    for row in 1..positions.len() {
        for (other, entries) in matrix.row(row).filter(|(other, _)| *other > 0) {
            column.push(other as u32 - 1);
            block.push(*entries);
        }
        row_start.push(column.len());
    }
    let Domain::Periodic(cell_box) = tessellation.domain() else {
        return None;
    };
    let places: Vec<[f64; 2]> = positions[1..].iter().map(|r| cell_box.wrap(*r).into()).collect();
    let system = LinearSystem::new(&BlockSparse::new(row_start, column, block).ok()?, &places).ok()?;
    let mut solution: Vec<f64> = simulation.velocities()[1..].iter().flat_map(|v| [-v.x, -v.y]).collect();
    system.solve(&mut solution);
    let mut step = vec![Vector::zeros()];
    step.extend(solution.chunks_exact(2).map(|d| Vector::new(d[0], d[1])));
    Some(step)
}
