//! How far ahead a run can be differentiated: the derivative of all positions by the chirality beside a difference of two runs.

use voronudge::simulate::{Direction, RandomPlacement, Simulation, derivatives, generator};
use voronudge::{Domain, Model, Parameters, PeriodicBox};

const STEP: f64 = 0.01;
const CHANGE: f64 = 1e-3;

/// Prints both, root mean squares over the cells, and by how much the difference misses the derivative.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cell_box = PeriodicBox::new([10.0, 10.0])?;
    let parameters = Parameters { preferred_perimeter: 3.8, chirality: 0.8, ..Parameters::default() };
    let positions = RandomPlacement::new(100, cell_box).draw(&mut generator(1))?;
    let model = Model::chiral_voronoi(&parameters);
    let mut tissue = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
    (0..2000).try_for_each(|_| tissue.step(STEP))?; // until it has forgotten how it was made
    let mut exact =
        tissue.along(&[Direction::parameter("alpha", &parameters).ok_or("no such parameter")?])?;
    let changed = Parameters { chirality: parameters.chirality + CHANGE, ..parameters };
    let mut other = tissue.clone().with_model(Model::chiral_voronoi(&changed))?;
    println!("time  |dr/dalpha|  from a change of alpha by {CHANGE}   error");
    for step in 1..=1000 {
        tissue.step(STEP)?;
        exact.step(STEP)?;
        other.step(STEP)?;
        if step % 100 == 0 {
            let mut squares = [0.0; 3];
            for (cell, r) in tissue.positions().iter().enumerate() {
                let slope = exact.positions()[cell].map(|x| derivatives(&x)[0]);
                let difference = (other.positions()[cell] - r) / CHANGE;
                let all = [slope, difference, difference - slope].map(|v| v.norm_squared() / 100.0);
                (0..3).for_each(|k| squares[k] += all[k]);
            }
            let [slope, seen, missed] = squares.map(f64::sqrt);
            let [time, error] = [STEP * f64::from(step), 100.0 * missed / slope];
            println!("{time:4.1} {slope:12.3} {seen:12.3} {error:26.1} %");
        }
    }
    Ok(())
}
