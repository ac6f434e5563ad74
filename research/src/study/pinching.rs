//! Flow across a density gradient, over parameters and over wave lengths.

use super::flows::{AREA_ELASTICITY, parameters, random, theory};
use super::seeds::{Replicas, mean, on_one_core_each};
use crate::Outcome;
use std::error::Error;
use std::f64::consts::TAU;
use voronudge_geometry::Domain;
use voronudge_model::Model;
use voronudge_simulate::measure::{PinchedFlow, Pinching, pinched_flow};
use voronudge_simulate::{Simulation, honeycomb, recommended_time_step};

/// Cells that are pinched: a wave of 20 cells, as shorter ones are dispersive.
pub(super) const PINCH_CELLS: usize = 400;
const PERIMETERS: [f64; 4] = [3.0, 3.4, 3.7, 4.0];
const CHIRALITIES: [f64; 4] = [0.4, 0.8, 1.6, 3.2];
/// Boxes of the liquid with their numbers of waves, the small one at all chiralities.
const SMALL: (usize, &[u32]) = (100, &[1, 2]);
const BOXES: [(usize, &[u32]); 2] = [(400, &[1, 2, 4]), (1600, &[1, 2, 4])];
pub(crate) const BOX_CHIRALITIES: [f64; 2] = [0.4, 1.6];
const LIQUID: f64 = 4.0;

/// When snapshots are taken: the time before the first, between them, and how many.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Snapshots {
    pub settle: f64,
    pub apart: f64,
    pub count: usize,
}

impl Snapshots {
    pub const USUAL: Self = Self { settle: 30.0, apart: 5.0, count: 4 };
}

/// Tissues that are pinched.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pinched {
    pub preferred_perimeter: f64,
    pub chirality: f64,
    pub cells: usize,
    /// Numbers of waves in the box, one after the other.
    pub waves: &'static [u32],
}

/// v_y/v_x of such tissues.
pub(crate) struct Ratio {
    pub of: Pinched,
    /// Number of waves in the box.
    pub waves: u32,
    /// Wave number in 1/ℓ_0.
    pub wave_number: f64,
    /// The formula, as printed up to its sign and with K_A.
    pub formulas: [f64; 2],
    /// Of a honeycomb of as many cells with as many waves.
    pub honeycomb: f64,
    /// Velocities along and across the gradient per displacement and squared wave number, and their ratio, with standard errors over tissues.
    pub along: (f64, f64),
    pub across: (f64, f64),
    pub simulated: (f64, f64),
    pub mean_square_velocity: f64,
}

/// The tissues of the table over parameters.
pub(crate) fn over_parameters() -> Vec<Pinched> {
    let point = |preferred_perimeter, chirality| Pinched {
        preferred_perimeter,
        chirality,
        cells: PINCH_CELLS,
        waves: &[1],
    };
    PERIMETERS.into_iter().flat_map(|p| CHIRALITIES.map(|a| point(p, a))).collect()
}

/// The liquids of the table over wave lengths.
pub(crate) fn over_waves() -> Vec<Pinched> {
    let point = |chirality, (cells, waves)| Pinched { preferred_perimeter: LIQUID, chirality, cells, waves };
    let large = BOX_CHIRALITIES.into_iter().flat_map(|a| BOXES.map(|of| point(a, of)));
    CHIRALITIES.map(|a| point(a, SMALL)).into_iter().chain(large).collect()
}

/// v_y/v_x of a pinched honeycomb and of pinched snapshots of simulations, beside the formula: a row for each number of waves.
pub(crate) fn ratios(
    points: &[Pinched],
    replicas: Replicas,
    snapshots: Snapshots,
) -> Result<Vec<Ratio>, Box<dyn Error>> {
    let seeds: Vec<u64> = replicas.seeds().collect();
    let tissues = on_one_core_each((points.len() * seeds.len()) as u64, |task| {
        let (point, replica) = (task as usize / seeds.len(), task as usize % seeds.len());
        tissue(&points[point], seeds[replica], snapshots)
    })?;
    let mut rows = Vec::new();
    for (&of, own) in points.iter().zip(tissues.chunks(seeds.len())) {
        let at = parameters(of.preferred_perimeter, of.chirality);
        let (lattice, cell_box) = honeycomb(of.cells)?;
        let lattice = Simulation::new(lattice, Domain::Periodic(cell_box), Model::chiral_voronoi(&at))?;
        let expected = |k_a: f64| -> Result<f64, Box<dyn Error>> {
            Ok(theory(&at, k_a)?.transverse_flow().unwrap_or(f64::NAN))
        };
        let squares: Vec<f64> = own.iter().map(|tissue| tissue.mean_square_velocity).collect();
        for (k, &waves) in of.waves.iter().enumerate() {
            let part = |part: fn(&PinchedFlow) -> f64| {
                mean(&own.iter().map(|tissue| part(&tissue.flows[k])).collect::<Vec<_>>())
            };
            rows.push(Ratio {
                of,
                waves,
                wave_number: TAU * f64::from(waves) / (of.cells as f64).sqrt(),
                formulas: [expected(0.0)?, expected(AREA_ELASTICITY)?],
                honeycomb: pinched(&lattice, waves)?.ratio(),
                along: part(|flow| flow.along),
                across: part(|flow| flow.across),
                simulated: part(PinchedFlow::ratio),
                mean_square_velocity: mean(&squares).0,
            });
        }
    }
    Ok(rows)
}

/// What one tissue does: flows averaged over snapshots, for each number of waves.
struct Tissue {
    flows: Vec<PinchedFlow>,
    mean_square_velocity: f64,
}

fn tissue(of: &Pinched, seed: u64, snapshots: Snapshots) -> Result<Tissue, Box<dyn Error>> {
    let at = parameters(of.preferred_perimeter, of.chirality);
    let mut simulation = random(of.cells, &at, seed)?;
    let time_step = recommended_time_step(&at, 1.0);
    let mut flows = vec![PinchedFlow { along: 0.0, across: 0.0 }; of.waves.len()];
    let (mut square, share) = (0.0, 1.0 / snapshots.count as f64);
    for snapshot in 0..snapshots.count {
        let time = if snapshot == 0 { snapshots.settle } else { snapshots.apart };
        for _ in 0..(time / time_step).round() as usize {
            simulation.step(time_step)?;
        }
        for (sum, &waves) in flows.iter_mut().zip(of.waves) {
            let flow = pinched(&simulation, waves)?;
            sum.along += share * flow.along;
            sum.across += share * flow.across;
        }
        square += share * voronudge_observables::mean_square_velocity(simulation.velocities());
    }
    Ok(Tissue { flows, mean_square_velocity: square })
}

fn pinched(simulation: &Simulation, waves: u32) -> Result<PinchedFlow, Box<dyn Error>> {
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions());
    let pinching = Pinching { waves, ..Pinching::default() };
    Ok(pinched_flow(tessellation, positions, simulation.model(), &pinching)?)
}

/// Both tables.
pub fn run(replicas: Replicas) -> Outcome {
    tell_over_parameters(&ratios(&over_parameters(), replicas, Snapshots::USUAL)?);
    tell_over_waves(&ratios(&over_waves(), replicas, Snapshots::USUAL)?);
    Ok(())
}

pub(crate) fn tell_over_parameters(rows: &[Ratio]) {
    println!("| P_0 | α | α/(3 − aP_0) | with K_A | honeycomb | simulated | ratio | ⟨v²⟩ |");
    println!("|---|---|---|---|---|---|---|---|");
    for row in rows {
        let [printed, with_area] = row.formulas;
        let (value, error) = row.simulated;
        println!(
            "| {} | {} | {printed:.3} | {with_area:.3} | {:.3} | {value:.3} ± {error:.3} | {:.3} ± {:.3} | {:.1e} |",
            row.of.preferred_perimeter,
            row.of.chirality,
            row.honeycomb,
            value / with_area,
            error / with_area,
            row.mean_square_velocity
        );
    }
}

pub(crate) fn tell_over_waves(rows: &[Ratio]) {
    println!("\nP_0 = {LIQUID}\n");
    println!("| α | box | q ℓ_0 | simulated / with K_A | simulated / honeycomb | along | across |");
    println!("|---|---|---|---|---|---|---|");
    for row in rows {
        let (value, error) = row.simulated;
        println!(
            "| {} | {} | {:.3} | {:.3} ± {:.3} | {:.3} ± {:.3} | {:.2} ± {:.2} | {:.2} ± {:.2} |",
            row.of.chirality,
            (row.of.cells as f64).sqrt(),
            row.wave_number,
            value / row.formulas[1],
            error / row.formulas[1],
            value / row.honeycomb,
            error / row.honeycomb,
            row.along.0,
            row.along.1,
            row.across.0,
            row.across.1
        );
    }
}
