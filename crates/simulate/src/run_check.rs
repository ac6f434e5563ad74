//! Derivatives of a short run against differences of runs.

use crate::simulation::slopes;
use crate::{Direction, Error, Simulation, recommended_time_step};
use voronudge_geometry::{Domain, Vector};
use voronudge_model::gradient_check::{Axis, GradientRow, MODEL, Place, Quantity};
use voronudge_model::{Model, PARAMETER_NAMES, Parameters};

/// Steps of the run, of the recommended size each.
const STEPS: usize = 30;

/// How far the runs to either side are, as what that alone moves cells by over the run, in mean spacings. The less of them is for runs whose
/// contacts change at other steps with the first.
const ASIDE: [f64; 2] = [1e-6, 2e-7];

/// Directions of a run: each parameter and a coordinate of a cell at the start.
const DIRECTIONS: usize = PARAMETER_NAMES.len() + 1;

/// The derivatives of the positions after a short run of the model, by each of its parameters and by a coordinate of one cell at the start, against
/// central differences of runs in which contacts change at the same steps; those for which there are none have no row, and none has one where the run
/// cannot be made. The domain is periodic.
///
/// # Errors
/// As [`Simulation::new`], and those of [`Simulation::step`] where a run beside one that can be made cannot.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox};
/// use voronudge_model::Parameters;
/// use voronudge_simulate::{RandomPlacement, check_run, generator};
/// let cell_box = PeriodicBox::new([6.0, 6.0])?;
/// let positions = RandomPlacement::new(36, cell_box).draw(&mut generator(1))?;
/// let rows = check_run(&positions, Domain::Periodic(cell_box), &Parameters { chirality: 0.5, ..Parameters::default() })?;
/// assert!(rows.iter().all(|row| row.passed()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check_run(
    positions: &[Vector<f64>],
    domain: Domain,
    parameters: &Parameters<f64>,
) -> Result<Vec<GradientRow>, Error> {
    let plain = Simulation::new(positions.to_vec(), domain, Model::chiral_voronoi(parameters))?;
    let time_step = recommended_time_step(parameters, plain.spacing());
    if !time_step.is_finite() {
        return Ok(Vec::new());
    }
    let displaced = positions.len() / 2;
    let parameter = |name| Direction::parameter(name, parameters).unwrap_or_default();
    let directions: [Direction; DIRECTIONS] = std::array::from_fn(|k| match PARAMETER_NAMES.get(k) {
        Some(name) => parameter(*name),
        None => Direction::position(displaced, 0),
    });
    let mut exact = plain.along(&directions)?;
    let first: Vec<f64> = (0..DIRECTIONS).map(|k| size(&slopes(exact.velocities(), k))).collect();
    // A tissue of the opposite stiffness, say, flies apart: there is no run to compare.
    if (0..STEPS).try_for_each(|_| exact.step(time_step)).is_err() {
        return Ok(Vec::new());
    }
    let contacts = run(plain.clone(), time_step)?.1;
    let mut rows = Vec::new();
    for (k, direction) in directions.iter().enumerate() {
        let reach = match PARAMETER_NAMES.get(k) {
            Some(_) => first[k] * time_step * STEPS as f64,
            None => 1.0,
        };
        let found = slopes(exact.positions(), k);
        let Some(differences) = differences(&plain, direction, (reach, time_step), &contacts)? else {
            continue;
        };
        let largest = size(&found);
        let errors = found.iter().zip(&differences).enumerate().flat_map(|(cell, (exact, seen))| {
            Axis::BOTH.map(|axis| (cell, axis, (exact[axis.index()] - seen[axis.index()]).abs()))
        });
        let Some((cell, axis, error)) = errors.max_by(|a, b| a.2.total_cmp(&b.2)) else { continue };
        let quantity = Quantity::RunDerivative(PARAMETER_NAMES.get(k).copied().unwrap_or("x(0)"));
        rows.push(GradientRow {
            term: MODEL.to_owned(),
            quantity,
            worst: if error == 0.0 { 0.0 } else { error / largest },
            place: Place::Cell { cell, axis },
            compared: 2 * found.len(),
            tolerance: quantity.tolerance(),
        });
    }
    Ok(rows)
}

/// The largest.
fn size(vectors: &[Vector<f64>]) -> f64 {
    vectors.iter().map(Vector::norm).fold(0.0, f64::max)
}

type Contacts = Vec<Vec<(u32, u32, [i16; 2])>>;

/// Where cells come to, and who touch in each step.
fn run(mut simulation: Simulation, time_step: f64) -> Result<(Vec<Vector<f64>>, Contacts), Error> {
    let mut contacts = Vec::with_capacity(STEPS);
    for _ in 0..STEPS {
        simulation.step(time_step)?;
        contacts.push(simulation.tessellation().edges());
    }
    Ok((simulation.positions().to_vec(), contacts))
}

/// Differences of runs to either side of one with some contacts; none if those of either side are never the same.
fn differences(
    plain: &Simulation,
    direction: &Direction,
    (reach, time_step): (f64, f64),
    contacts: &Contacts,
) -> Result<Option<Vec<Vector<f64>>>, Error> {
    if reach == 0.0 {
        return Ok(None);
    }
    for aside in ASIDE {
        let way = aside * plain.spacing() / reach;
        let (plus, of_plus) = run(plain.beside(direction, way)?, time_step)?;
        let (minus, of_minus) = run(plain.beside(direction, -way)?, time_step)?;
        if of_plus == *contacts && of_minus == *contacts {
            let pairs = plus.iter().zip(&minus);
            return Ok(Some(pairs.map(|(plus, minus)| (plus - minus) / (2.0 * way)).collect()));
        }
    }
    Ok(None)
}
