//! A tissue with and without chirality: how fast its cells move, what shape they have and how they are ordered.

use std::ops::ControlFlow;
use voronudge::observables::{hexatic, mean_square_velocity, shape_indices};
use voronudge::simulate::{Event, RandomPlacement, Schedule, Simulation, generator, run};
use voronudge::{Domain, Model, Parameters, PeriodicBox};

/// Prints a table of time, ⟨v²⟩, mean shape index P/√A and hexatic order for each chirality.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cell_box = PeriodicBox::new([12.0, 12.0])?;
    let schedule = Schedule { time: 20.0, time_step: 0.02, frames: 4 };
    for chirality in [0.0, 1.0] {
        let positions = RandomPlacement::new(144, cell_box).draw(&mut generator(1))?;
        let parameters = Parameters { preferred_perimeter: 3.8, chirality, ..Parameters::default() };
        let model = Model::chiral_voronoi(&parameters);
        let mut tissue = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
        println!("alpha = {chirality}\n  time    <v^2>      <P/sqrt A>  |psi_6|");
        let ended = run(&mut tissue, &schedule, |event| {
            if let Event::Frame(frame) = event {
                let (tissue, r) = (frame.simulation, frame.simulation.positions());
                let speed = mean_square_velocity(tissue.velocities());
                let shapes = shape_indices(tissue.tessellation(), r);
                let shape = shapes.iter().sum::<f64>() / shapes.len() as f64;
                let order = hexatic(tissue.tessellation(), r).order();
                println!("  {:4.1}  {speed:9.2e}  {shape:9.3}  {order:9.3}", tissue.time());
            }
            ControlFlow::Continue(())
        })?;
        println!("  T1 transitions per cell and time: {:.3}", ended.transition_rate.unwrap_or_default());
    }
    Ok(())
}
