//! An effect of one's own: cells follow a field, here towards the middle line of the box, and a fit finds how strongly.

use std::{f64::consts::TAU, ops::ControlFlow, sync::Arc};
use voronudge::geometry::{FieldOfView, Grid};
use voronudge::infer::{Constraints, FitParameter, KnownNoise, Observation, Request, infer};
use voronudge::model::effect::ExternalField;
use voronudge::model::{Column, Environment, VectorMap};
use voronudge::simulate::{RandomPlacement, Simulation, generator};
use voronudge::{Domain, Model, Parameters, PeriodicBox, Vector};

const STRENGTH: f64 = 0.3;
const ERROR: f64 = 0.02;

/// Simulates with the effect, adds errors to the velocities, fits, and prints both strengths.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cell_box = PeriodicBox::new([12.0, 12.0])?;
    let domain = Domain::Periodic(cell_box);
    let grid = Grid::new([0.0, 0.0], [0.5, 0.5], [25, 25])?; // for any function of the place
    let field = |k| Vector::new(0.0, (TAU * grid.centre(k).y / 12.0).sin());
    let map = VectorMap::new(grid, (0..grid.len()).map(field).collect())?;
    let surroundings = Arc::new(Environment::default().with_map(map));
    let effect = Column::from(ExternalField { map: 0 });
    let parameters = Parameters { preferred_perimeter: 3.9, chirality: 0.5, ..Parameters::default() };
    let model = Model::chiral_voronoi(&parameters).with(effect, STRENGTH).within(&surroundings);
    let positions = RandomPlacement::new(144, cell_box).draw(&mut generator(1))?;
    let mut tissue = Simulation::new(positions, domain, model)?;
    (0..200).try_for_each(|_| tissue.step(0.02))?;
    let error = |k: f64| ERROR * Vector::new((12.9 * k).sin(), (78.2 * k).sin());
    let seen =
        tissue.velocities().iter().enumerate().map(|(k, v)| Some(v + error(k as f64))).collect::<Vec<_>>();
    let frame = Observation::new(0, tissue.positions().to_vec(), seen, domain, FieldOfView::everywhere())?;
    let mut request = Request::new(Constraints::fixed([(FitParameter::AreaElasticity, 0.1)]));
    request.structure = request.structure.with(&[effect]);
    request.noise = KnownNoise { position: Some(1e-3), velocity: Some(ERROR / 2f64.sqrt()) };
    let found = infer(&[frame.within(surroundings)], &request, &mut |_| ControlFlow::Continue(()))?;
    let own = found.effects[0];
    println!("strength {STRENGTH}, fitted {:.4} ± {:.4}", own.value, own.standard_error);
    Ok(())
}
