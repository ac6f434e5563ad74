//! Time of a Runge–Kutta step in a liquid: `cargo run --release -p voronudge-simulate --example step_time -- CELLS STEPS`.
//!
//! Prints nanoseconds per cell and force evaluation, the least of all steps and the mean, with the flips of one step.

use std::time::Instant;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{RandomPlacement, Simulation, generator, sort_in_space};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let numbers: Vec<usize> = std::env::args().skip(1).map(|a| a.parse()).collect::<Result<_, _>>()?;
    let [cells, steps] = *numbers.as_slice() else {
        return Err("give CELLS and STEPS".into());
    };
    let side = (cells as f64).sqrt();
    let cell_box = PeriodicBox::new([side, side])?;
    let mut positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(7))?;
    sort_in_space(&mut positions, &cell_box);
    let model = Model::chiral_voronoi(&Parameters { chirality: 1.0, ..Parameters::default() });
    let mut simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
    let (mut least, mut total, mut timed) = (f64::INFINITY, 0.0, 0);
    for step in 0..steps {
        let begun = Instant::now();
        simulation.step(0.01)?;
        let time = begun.elapsed().as_secs_f64() / (4 * cells) as f64 * 1e9;
        if 2 * step >= steps {
            least = least.min(time);
            total += time;
            timed += 1;
        }
    }
    println!("{cells} cells: {least:.0} ns at least, {:.0} ns on average", total / f64::from(timed));
    Ok(())
}
