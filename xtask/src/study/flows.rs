//! Macroscopic chiral flows: along torque-free walls, and across a density gradient.

use super::seeds::on_one_core_each;
use crate::Outcome;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_observables::BlockAverage;
use voronudge_simulate::measure::{PinchedFlow, Pinching, pinched_flow};
use voronudge_simulate::{RandomPlacement, Simulation, Walls, generator, honeycomb, recommended_time_step};
use voronudge_theory::MeanField;

type Failure = Box<dyn std::error::Error>;

/// Cells between walls, and cells that are pinched: a wave of 20 cells, as shorter ones are dispersive.
const EDGE_CELLS: usize = 100;
pub(super) const PINCH_CELLS: usize = 400;
/// Area elasticity of all tissues here, with K_P = 1.
const AREA_ELASTICITY: f64 = 0.1;

/// A model with the area elasticity of all tissues here, and K_P = 1.
pub(crate) fn parameters(preferred_perimeter: f64, chirality: f64) -> Parameters<f64> {
    Parameters { area_elasticity: AREA_ELASTICITY, preferred_perimeter, chirality, ..Parameters::default() }
}

fn theory(p: &Parameters<f64>, area_elasticity: f64) -> Result<MeanField, Failure> {
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

/// Mean and standard error of the mean.
pub(super) fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt())
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
pub(crate) fn edge_currents(seeds: u64, [transient, average]: [f64; 2]) -> Result<Vec<EdgeCurrent>, Failure> {
    let points: Vec<(f64, f64)> =
        EDGE_PERIMETERS.into_iter().flat_map(|p| EDGE_CHIRALITIES.map(|a| (p, a))).collect();
    on_one_core_each(points.len() as u64, |k| {
        let (preferred_perimeter, chirality) = points[k as usize];
        let at = parameters(preferred_perimeter, chirality);
        let (mut all, mut late) = (Vec::new(), Vec::new());
        for seed in 1..=seeds {
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

pub fn edge(seeds: u64) -> Outcome {
    println!("| P_0 | α | printed threshold | row slips at | v_E | of the last tenth |");
    println!("|---|---|---|---|---|---|");
    for current in edge_currents(seeds, [TRANSIENT, AVERAGE])? {
        let EdgeCurrent { preferred_perimeter, chirality, thresholds, velocity, late } = current;
        println!(
            "| {preferred_perimeter} | {chirality} | {:.3} | {:.3} | {:.5} ± {:.5} | {late:.1e} |",
            thresholds[0], thresholds[1], velocity.0, velocity.1
        );
    }
    Ok(())
}

/// Preferred perimeters and chiralities of the study of pinching.
const PINCH_PERIMETERS: [f64; 4] = [3.0, 3.4, 3.7, 4.0];
const PINCH_CHIRALITIES: [f64; 4] = [0.4, 0.8, 1.6, 3.2];
/// Time before the first snapshot, and between snapshots.
pub(crate) const SETTLE: f64 = 30.0;
pub(crate) const APART: f64 = 5.0;
const SNAPSHOTS: usize = 4;

/// Flow across a density gradient.
pub(crate) struct PinchedRatio {
    pub preferred_perimeter: f64,
    pub chirality: f64,
    /// The formula, as printed up to its sign and with K_A.
    pub formulas: [f64; 2],
    pub honeycomb: f64,
    /// v_y/v_x of snapshots and its standard error over seeds.
    pub simulated: (f64, f64),
    pub mean_square_velocity: f64,
}

/// v_y/v_x of a pinched honeycomb and of pinched snapshots of simulations from a time on, beside the formula.
pub(crate) fn pinched_ratios(seeds: u64, [settle, apart]: [f64; 2]) -> Result<Vec<PinchedRatio>, Failure> {
    let points: Vec<(f64, f64)> =
        PINCH_PERIMETERS.into_iter().flat_map(|p| PINCH_CHIRALITIES.map(|a| (p, a))).collect();
    on_one_core_each(points.len() as u64, |k| {
        let (preferred_perimeter, chirality) = points[k as usize];
        let at = parameters(preferred_perimeter, chirality);
        let (lattice, cell_box) = honeycomb(PINCH_CELLS)?;
        let lattice = Simulation::new(lattice, Domain::Periodic(cell_box), Model::chiral_voronoi(&at))?;
        let honeycomb = pinched(&lattice)?.ratio();
        let (mut ratios, mut squares) = (Vec::new(), Vec::new());
        for seed in 1..=seeds {
            let mut simulation = random(PINCH_CELLS, &at, seed)?;
            let time_step = recommended_time_step(&at, 1.0);
            let mut sum = [0.0; 2];
            for snapshot in 0..SNAPSHOTS {
                let time = if snapshot == 0 { settle } else { apart };
                for _ in 0..(time / time_step).round() as usize {
                    simulation.step(time_step)?;
                }
                let flow = pinched(&simulation)?;
                sum = [sum[0] + flow.along, sum[1] + flow.across];
                squares.push(voronudge_observables::mean_square_velocity(simulation.velocities()));
            }
            ratios.push(sum[1] / sum[0]);
        }
        let expected = |k_a: f64| -> Result<f64, Failure> {
            Ok(theory(&at, k_a)?.transverse_flow().unwrap_or(f64::NAN))
        };
        Ok(PinchedRatio {
            preferred_perimeter,
            chirality,
            formulas: [expected(0.0)?, expected(AREA_ELASTICITY)?],
            honeycomb,
            simulated: mean(&ratios),
            mean_square_velocity: mean(&squares).0,
        })
    })
}

pub fn pinching(seeds: u64) -> Outcome {
    println!("| P_0 | α | α/(3 − aP_0) | with K_A | honeycomb | simulated | ratio | ⟨v²⟩ |");
    println!("|---|---|---|---|---|---|---|---|");
    for ratio in pinched_ratios(seeds, [SETTLE, APART])? {
        let PinchedRatio {
            preferred_perimeter,
            chirality,
            formulas: [printed, with_area],
            honeycomb,
            simulated: (value, error),
            ..
        } = ratio;
        println!(
            "| {preferred_perimeter} | {chirality} | {printed:.3} | {with_area:.3} | {honeycomb:.3} | {value:.3} ± {error:.3} | {:.3} | {:.1e} |",
            value / with_area,
            ratio.mean_square_velocity
        );
    }
    Ok(())
}

fn pinched(simulation: &Simulation) -> Result<PinchedFlow, Failure> {
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions());
    Ok(pinched_flow(tessellation, positions, simulation.model(), &Pinching::default())?)
}
