//! How far ahead a run can be differentiated: the derivative of all positions by the chirality, and what a difference of two runs says of it.

use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{Direction, RandomPlacement, Simulation, derivatives, generator};

const STEP: f64 = 0.01;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cell_box = PeriodicBox::new([10.0, 10.0])?;
    let parameters = Parameters { preferred_perimeter: 3.8, chirality: 0.8, ..Parameters::default() };
    let positions = RandomPlacement::new(100, cell_box).draw(&mut generator(1))?;
    let model = Model::chiral_voronoi(&parameters);
    let mut tissue = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
    for _ in 0..2000 {
        tissue.step(STEP)?; // until it has forgotten how it was made
    }
    let by_alpha = Direction::parameter("alpha", &parameters).ok_or("alpha is a parameter")?;
    let mut exact = tissue.along(&[by_alpha])?;
    let change = 1e-3;
    let other = Parameters { chirality: parameters.chirality + change, ..parameters };
    let mut other = tissue.clone().with_model(Model::chiral_voronoi(&other))?;
    println!("time   root mean square ∂r/∂α   the same from a change of α by {change}   error");
    for step in 1..=1000 {
        tissue.step(STEP)?;
        exact.step(STEP)?;
        other.step(STEP)?;
        if step % 100 == 0 {
            let (mut sum, mut seen, mut missed) = (0.0, 0.0, 0.0);
            for ((r, dual), changed) in
                tissue.positions().iter().zip(exact.positions()).zip(other.positions())
            {
                let slope = Vector::new(derivatives(&dual.x)[0], derivatives(&dual.y)[0]);
                let difference = (changed - r) / change;
                sum += slope.norm_squared();
                seen += difference.norm_squared();
                missed += (difference - slope).norm_squared();
            }
            let [sum, seen, missed] = [sum, seen, missed].map(|square: f64| (square / 100.0).sqrt());
            println!("{:4.1} {sum:12.3} {seen:12.3} {:9.1} %", 0.01 * f64::from(step), 100.0 * missed / sum);
        }
    }
    Ok(())
}
