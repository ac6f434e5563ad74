//! Macroscopic chiral flows along torque-free walls, and the tissues of such studies.

use super::seeds::{Replicas, mean, on_one_core_each};
use crate::Outcome;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_observables::BlockAverage;
use voronudge_simulate::{RandomPlacement, Simulation, Walls, generator};
use voronudge_theory::MeanField;

type Failure = Box<dyn std::error::Error>;

/// Cells between walls.
const EDGE_CELLS: usize = 100;
/// Area elasticity of all tissues here, with K_P = 1.
pub(super) const AREA_ELASTICITY: f64 = 0.1;

/// A model with the area elasticity of all tissues here, and K_P = 1.
pub(crate) fn parameters(preferred_perimeter: f64, chirality: f64) -> Parameters<f64> {
    Parameters { area_elasticity: AREA_ELASTICITY, preferred_perimeter, chirality, ..Parameters::default() }
}

pub(super) fn theory(p: &Parameters<f64>, area_elasticity: f64) -> Result<MeanField, Failure> {
    Ok(MeanField::new(voronudge_theory::Parameters {
        area_elasticity,
        perimeter_elasticity: p.perimeter_elasticity,
        preferred_perimeter: p.preferred_perimeter,
        chirality: p.chirality,
    })?)
}

/// Cells at random in a square box, one to a unit of area.
pub(crate) fn random(cells: usize, p: &Parameters<f64>, seed: u64) -> Result<Simulation, Failure> {
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2])?;
    let positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(seed))?;
    Ok(Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(p))?)
}

/// Preferred perimeters and chiralities of the study of edge currents.
const EDGE_PERIMETERS: [f64; 4] = [3.0, 3.4, 3.7, 3.9];
const EDGE_CHIRALITIES: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 0.3, 0.5];
/// Time before edge currents are averaged, and the time averaged over.
pub(crate) const TRANSIENT: f64 = 60.0;
pub(crate) const AVERAGE: f64 = 40.0;
const EDGE_STEP: f64 = 0.02;

/// An edge current.
pub(crate) struct EdgeCurrent {
    pub preferred_perimeter: f64,
    pub chirality: f64,
    /// The printed threshold, and where a row of the lattice slips.
    pub thresholds: [f64; 2],
    /// `v_E` and its standard error over seeds.
    pub velocity: (f64, f64),
    /// Mean over the last tenth of the time.
    pub late: f64,
}

/// v_E of cells between four walls, beside both estimates of the threshold.
pub(crate) fn edge_currents(
    replicas: Replicas,
    [transient, average]: [f64; 2],
) -> Result<Vec<EdgeCurrent>, Failure> {
    let points: Vec<(f64, f64)> =
        EDGE_PERIMETERS.into_iter().flat_map(|p| EDGE_CHIRALITIES.map(|a| (p, a))).collect();
    on_one_core_each(points.len() as u64, |k| {
        let (preferred_perimeter, chirality) = points[k as usize];
        let at = parameters(preferred_perimeter, chirality);
        let (mut all, mut late) = (Vec::new(), Vec::new());
        for seed in replicas.seeds() {
            let mut simulation = random(EDGE_CELLS, &at, seed)?.with_walls(Walls::Both)?;
            let steps = |time: f64| (time / EDGE_STEP).round() as usize;
            let (mut whole, mut last) = (BlockAverage::default(), BlockAverage::default());
            for step in 0..steps(transient + average) {
                simulation.step(EDGE_STEP)?;
                let Some(v) = simulation.edge_velocity().filter(|_| step >= steps(transient)) else {
                    continue;
                };
                whole.add(v);
                if step >= steps(transient + 0.9 * average) {
                    last.add(v);
                }
            }
            all.push(whole.mean().unwrap_or(f64::NAN));
            late.push(last.mean().unwrap_or(f64::NAN));
        }
        let theory = theory(&at, AREA_ELASTICITY)?;
        let thresholds = [theory.edge_current_threshold(), theory.edge_slip_chirality()];
        let (velocity, (late, _)) = (mean(&all), mean(&late));
        Ok(EdgeCurrent { preferred_perimeter, chirality, thresholds, velocity, late })
    })
}

pub fn edge(replicas: Replicas) -> Outcome {
    tell(&edge_currents(replicas, [TRANSIENT, AVERAGE])?);
    Ok(())
}

pub(crate) fn tell(currents: &[EdgeCurrent]) {
    println!("| P_0 | α | printed threshold | row slips at | v_E | of the last tenth |");
    println!("|---|---|---|---|---|---|");
    for current in currents {
        let EdgeCurrent { preferred_perimeter, chirality, thresholds, velocity, late } = current;
        println!(
            "| {preferred_perimeter} | {chirality} | {:.3} | {:.3} | {:.5} ± {:.5} | {late:.1e} |",
            thresholds[0], thresholds[1], velocity.0, velocity.1
        );
    }
}
