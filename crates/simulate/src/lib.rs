//! Time integration of the chiral Voronoi model in a periodic box.
//!
//! A [`Simulation`] holds cell centres `r_i` and moves them by `dr_i/dt = v_i(r)` with the classical fourth-order
//! Runge–Kutta method at a fixed time step; the Voronoi tessellation is renewed at every evaluation of `v`.
//! [`run`] drives one by a [`Schedule`] and hands out evenly spaced frames. Starting positions come from
//! [`RandomPlacement`].
//!
//! Lengths and times are in whatever unit the parameters of the model are in. The result does not depend on the number
//! of threads.
//!
//! ```
//! use std::ops::ControlFlow;
//! use voronudge_geometry::{Domain, PeriodicBox};
//! use voronudge_model::{Model, Parameters};
//! use voronudge_simulate::{Event, RandomPlacement, Schedule, Simulation, generator, run};
//!
//! let cell_box = PeriodicBox::new([5.0, 5.0])?;
//! let positions = RandomPlacement::new(25, cell_box).draw(&mut generator(1))?;
//! let model = Model::chiral_voronoi(&Parameters { chirality: 0.5, ..Parameters::default() });
//! let mut simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
//! let mut times = Vec::new();
//! let schedule = Schedule { time: 1.0, time_step: 0.02, frames: 4 };
//! let summary = run(&mut simulation, &schedule, |event| {
//!     if let Event::Frame(frame) = event {
//!         times.push(frame.simulation.time());
//!     }
//!     ControlFlow::Continue(())
//! })?;
//! assert_eq!(summary.steps, 52); // thirteen steps of 0.25/13 between frames
//! assert_eq!(times.len(), 4);
//! assert!((times[3] - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod channel;
mod channel_run;
pub mod collapse;
mod driving;
mod error;
mod headings;
mod heterogeneity;
mod honeycomb;
pub mod measure;
mod method;
pub mod moduli;
mod placement;
mod run_check;
mod scaled;
mod schedule;
mod sensitivity;
mod simulation;
mod spatial_order;
mod time_step;
mod turning;
mod turnover;
mod walls;

pub use channel::Channel;
pub use channel_run::{ChannelRun, ChannelSchedule, run_channel};
pub use driving::{Driving, Shear};
pub use error::Error;
pub use heterogeneity::Distribution;
pub use honeycomb::honeycomb;
pub use method::Method;
pub use placement::{Generator, RandomPlacement, generator, seed_of_replica, seed_of_run};
pub use run_check::check_run;
pub use schedule::{Completion, Event, Frame, MOST_STEPS, RunState, Schedule, Summary, resume, run};
pub use sensitivity::{Derivatives, Sensitivity, sensitivities};
pub use simulation::{Bond, Direction, Simulation, State, derivatives};
pub use spatial_order::sort_in_space;
pub use time_step::recommended_time_step;
pub use turnover::{
    CellCycle, DivisionAxis, EdgeRate, Injection, LastStep, Life, LivingTissue, Origin, Progress,
    Proliferation, Turnover, distance_of_halves,
};
pub use walls::{CellsAndImages, Walls};
