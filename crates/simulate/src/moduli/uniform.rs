//! Pressure, torques and shapes of a uniform tissue: what an equation of state is made of.

use super::average::{Averages, STRIDE};
use super::{Observer, Stop, stress_of};
use crate::{
    Error, MOST_STEPS, RandomPlacement, Simulation, generator, recommended_time_step, sort_in_space,
};
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_observables::shape_indices;

/// A tissue of random cells in a square periodic box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformTissue {
    /// Its parameters, in the unit of length in which the density is given.
    pub parameters: Parameters<f64>,
    /// Cells per area `ρ`.
    pub density: f64,
    /// Number of cells.
    pub cells: usize,
    /// Time that is not averaged over, and time that is.
    pub times: [f64; 2],
    /// Largest time step; none: as [recommended](recommended_time_step).
    pub time_step: Option<f64>,
}

/// Averages over time of a uniform tissue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformState {
    /// Pressure `p = −(σ_xx + σ_yy)/2` (rate × area/area: friction is absorbed).
    pub pressure: f64,
    /// Density of torques `τ = σ_xy − σ_yx`.
    pub torque: f64,
    /// Mean of `P/√A`.
    pub shape_index: f64,
    /// Mean square of the velocities.
    pub mean_square_velocity: f64,
}

impl UniformTissue {
    /// The time step that is taken: the largest that divides both times.
    fn steps(&self) -> Result<([usize; 2], f64), Error> {
        let [settle, average] = self.times;
        if !(average.is_finite() && average > 0.0) {
            return Err(Error::Duration { time: average });
        }
        if !(settle.is_finite() && settle >= 0.0) {
            return Err(Error::Duration { time: settle });
        }
        let largest = self
            .time_step
            .unwrap_or_else(|| recommended_time_step(&self.parameters, self.density.sqrt().recip()));
        if !(largest.is_finite() && largest > 0.0) {
            return Err(Error::TimeStep { time_step: largest });
        }
        let steps = (settle + average) / largest;
        if steps > MOST_STEPS {
            return Err(Error::TooManySteps { steps, limit: MOST_STEPS });
        }
        let count = (average / largest).ceil();
        let time_step = average / count;
        Ok(([(settle / time_step).round() as usize, count as usize], time_step))
    }

    /// Steps of the whole run.
    ///
    /// # Errors
    /// As [`measure`](Self::measure).
    pub fn length(&self) -> Result<usize, Error> {
        self.steps().map(|([settle, average], _)| settle + average)
    }

    /// Runs it from random positions and averages over the second time; steps in which cells would move too far are
    /// [cut](Simulation::step_or_parts). `stop` is asked every hundred steps.
    ///
    /// # Errors
    /// [`Error::Interrupted`]; those of the placement, of time steps and times that are none, and of [`Simulation::step`].
    pub fn measure(&self, seed: u64, stop: Stop<'_>) -> Result<UniformState, Error> {
        let ([settle, average], time_step) = self.steps()?;
        let side = (self.cells as f64 / self.density).sqrt();
        let of_box = |source| Error::Tessellation { time: 0.0, source };
        let cell_box = PeriodicBox::new([side; 2]).map_err(of_box)?;
        let mut positions = RandomPlacement::new(self.cells, cell_box).draw(&mut generator(seed))?;
        sort_in_space(&mut positions, &cell_box);
        let model = Model::chiral_voronoi(&self.parameters);
        let mut simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
        let (observer, mut averages) = (Observer(stop), Averages::default());
        for step in 1..=settle + average {
            simulation.step_or_parts(time_step)?;
            if step.is_multiple_of(10 * STRIDE) {
                observer.look()?;
            }
            if step > settle && (step - settle).is_multiple_of(STRIDE.min(average)) {
                averages.add(look(&simulation));
            }
        }
        let [pressure, torque, shape_index, mean_square_velocity] = averages.mean()?.parts;
        Ok(UniformState { pressure, torque, shape_index, mean_square_velocity })
    }
}

fn look(simulation: &Simulation) -> [f64; 4] {
    let sigma = stress_of(simulation);
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions());
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / positions.len() as f64;
    [
        -0.5 * (sigma[0][0] + sigma[1][1]),
        sigma[0][1] - sigma[1][0],
        mean(&mut shape_indices(tessellation, positions).into_iter()),
        mean(&mut simulation.velocities().iter().map(|v| v.norm_squared())),
    ]
}
