//! A tissue that was given time to come to rest, on which moduli are measured.

use super::relaxation::Relaxation;
use super::{Motion, Observer, Stop};
use crate::{Error, Simulation};

/// A tissue that was given time to come to rest.
#[derive(Debug, Clone)]
pub struct Settled {
    simulation: Simulation,
    speed: f64,
    motion: Motion,
}

impl Settled {
    /// Brings the state that a simulation is in to rest, if that can be done.
    ///
    /// # Errors
    /// [`Error::Interrupted`], and the errors of [`Simulation::step`].
    pub fn new(simulation: &Simulation, relaxation: &Relaxation, stop: Stop<'_>) -> Result<Self, Error> {
        let mut simulation = simulation.clone();
        let speed = relaxation.relax(&mut simulation, Observer(stop))?;
        let motion = if speed <= relaxation.tolerance { Motion::AtRest } else { Motion::Flowing };
        Ok(Self { simulation, speed, motion })
    }

    /// The state at the end.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The speed of the fastest cell at the end (length/time).
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Whether it came to rest.
    pub fn motion(&self) -> Motion {
        self.motion
    }
}
