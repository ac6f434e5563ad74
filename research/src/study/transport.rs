//! What drives the flow along a channel: the transport against the torques of uniform liquids of the same density, and the shapes of
//! cells against their age.

use super::seeds::{Replicas, mean, on_one_core_each};
use crate::Outcome;
use claims::channel::{Case, RELAXATION};
use std::error::Error;
use std::ops::ControlFlow;
use voronudge_observables::shape_indices;
use voronudge_simulate::measure::ChannelProfile;
use voronudge_simulate::moduli::{UniformState, UniformTissue};
use voronudge_simulate::{LivingTissue, recommended_time_step};

/// HT1080, 20 cells wide and long.
const CASE: Case = Case { lengths: [20.0, 20.0], preferred_perimeter: 4.0, chirality: 2.9, time: 150.0 };
/// Cell size in µm, and K_P per hour.
const CELL: f64 = 25.0;
const RATE: f64 = 0.43;
/// Densities of uniform liquids, in units of the mean one.
const DENSITIES: [f64; 8] = [0.85, 0.9, 0.95, 1.0, 1.1, 1.2, 1.35, 1.5];
const UNIFORM_CELLS: usize = 400;
/// Time before a uniform liquid is averaged, and of the averages.
const UNIFORM: [f64; 2] = [20.0, 20.0];
/// Time between two looks at shapes.
const APART: f64 = 1.0;
/// Upper ends of distances from the edge (cells) and of ages (1/K_P).
const BANDS: [f64; 6] = [0.5, 1.0, 1.8, 2.4, 4.0, 10.0];
const AGES: [f64; 4] = [0.25, 1.0, 4.0, f64::INFINITY];

/// Torque density and shape index of uniform liquids of a density.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Uniform {
    density: f64,
    torque: f64,
    shape: f64,
}

fn uniform(density: f64, seed: u64) -> Result<UniformState, Box<dyn Error>> {
    let tissue = UniformTissue {
        parameters: CASE.parameters(),
        density,
        cells: UNIFORM_CELLS,
        times: UNIFORM,
        time_step: None,
    };
    Ok(tissue.measure(seed, &|| ControlFlow::Continue(()))?)
}

/// A value of the uniform liquids at a density, by linear interpolation.
fn interpolated(all: &[Uniform], density: f64, of: fn(&Uniform) -> f64) -> f64 {
    let next = all.partition_point(|own| own.density < density).clamp(1, all.len() - 1);
    let [a, b] = [&all[next - 1], &all[next]];
    of(a) + (of(b) - of(a)) * (density - a.density) / (b.density - a.density)
}

/// Number of cells and sum of their shape indices, by distance and age.
type Shapes = [[[f64; 2]; AGES.len()]; BANDS.len()];

struct Channel {
    profile: ChannelProfile,
    shapes: Shapes,
}

fn channel(seed: u64) -> Result<Channel, Box<dyn Error>> {
    let time_step = recommended_time_step(&CASE.parameters(), 1.0);
    let every = (APART / time_step).round() as usize;
    let (mut shapes, mut step) = (Shapes::default(), 0usize);
    let profile = CASE.observed(seed, time_step, |tissue| {
        step += 1;
        if step.is_multiple_of(every) && tissue.simulation().time() > RELAXATION {
            look(tissue, &mut shapes);
        }
    })?;
    Ok(Channel { profile, shapes })
}

fn look(tissue: &LivingTissue, shapes: &mut Shapes) {
    let simulation = tissue.simulation();
    let (positions, time, width) = (simulation.positions(), simulation.time(), CASE.lengths[0]);
    let indices = shape_indices(simulation.tessellation(), positions);
    for ((r, index), &life) in positions.iter().zip(indices).zip(tissue.identities()) {
        let x = r.x.rem_euclid(width);
        let distance = x.min(width - x);
        let age = time - tissue.lives()[life].born;
        let place = |ends: &[f64], value: f64| ends.iter().position(|end| value < *end);
        if let (Some(band), Some(class)) = (place(&BANDS, distance), place(&AGES, age)) {
            let [count, sum] = &mut shapes[band][class];
            *count += 1.0;
            *sum += index;
        }
    }
}

pub fn run(replicas: Replicas) -> Outcome {
    let seeds: Vec<u64> = replicas.seeds().collect();
    let count = seeds.len();
    let liquids = on_one_core_each((DENSITIES.len() * count) as u64, |task| {
        uniform(DENSITIES[task as usize / count], seeds[task as usize % count])
    })?;
    println!("uniform liquids\n\n| ρ/ρ_0 | τ (K_P) | P/√A |\n|---|---|---|");
    let equations: Vec<Uniform> = liquids
        .chunks(count)
        .zip(DENSITIES)
        .map(|(own, density)| {
            let of = |of: fn(&UniformState) -> f64| mean(&own.iter().map(of).collect::<Vec<_>>());
            let (torque, shape) = (of(|own| own.torque), of(|own| own.shape_index));
            println!("| {density} | {:.3} ± {:.3} | {:.4} ± {:.4} |", torque.0, torque.1, shape.0, shape.1);
            Uniform { density, torque: torque.0, shape: shape.0 }
        })
        .collect();
    let runs = on_one_core_each(count as u64, |task| channel(seeds[task as usize]))?;
    tell_of_transport(&equations, &runs);
    tell_of_shapes(&equations, &runs);
    Ok(())
}

fn tell_of_transport(equations: &[Uniform], runs: &[Channel]) {
    println!("\n∫ρ v_y dx from a distance to the middle (1/h), {} channels\n", runs.len());
    println!(
        "| distance (µm) | ρ/ρ_0 | transport | ½[τ − τ(mid)] of the cells there | of uniform liquids of this density |"
    );
    println!("|---|---|---|---|---|");
    let density = |own: &Channel, x: f64| -> f64 {
        let ChannelProfile { centres, density, .. } = &own.profile;
        let next = centres.partition_point(|centre| *centre < x).clamp(1, centres.len() - 1);
        let (a, b) = (next - 1, next);
        let share = (x - centres[a]) / (centres[b] - centres[a]);
        density[a].value + share * (density[b].value - density[a].value)
    };
    let faces = &runs[0].profile.faces;
    for (k, &x) in faces.iter().enumerate().step_by(2) {
        let of = |of: &dyn Fn(&Channel) -> f64| mean(&runs.iter().map(of).collect::<Vec<_>>());
        let torque = |own: &Channel, x: f64| interpolated(equations, density(own, x), |own| own.torque);
        let predicted = of(&|own| 0.5 * RATE * (torque(own, x) - torque(own, 0.5 * CASE.lengths[0])));
        let transport = of(&|own| RATE * own.profile.transport[k].value);
        let torques = of(&|own| RATE * own.profile.torque[k].value);
        println!(
            "| {:.1} | {:.3} | {:.3} ± {:.3} | {:.3} ± {:.3} | {:.3} ± {:.3} |",
            CELL * x,
            of(&|own| density(own, x)).0,
            transport.0,
            transport.1,
            torques.0,
            torques.1,
            predicted.0,
            predicted.1
        );
    }
}

fn tell_of_shapes(equations: &[Uniform], runs: &[Channel]) {
    println!("\nP/√A by distance and age (1/K_P), and of a uniform liquid of the density there\n");
    println!("| distance (µm) | {} | uniform |", AGES.map(|end| format!("age below {end}")).join(" | "));
    println!("|---|{}---|", "---|".repeat(AGES.len()));
    let mut low = 0.0;
    for (band, high) in BANDS.into_iter().enumerate() {
        let classes: Vec<String> = (0..AGES.len())
            .map(|class| {
                let each = runs.iter().map(|own| own.shapes[band][class][1] / own.shapes[band][class][0]);
                let (value, error) = mean(&each.collect::<Vec<_>>());
                format!("{value:.3} ± {error:.3}")
            })
            .collect();
        let uniform = runs.iter().map(|own| {
            let ChannelProfile { centres, density, .. } = &own.profile;
            let there = centres.iter().zip(density).filter(|(x, _)| (low..high).contains(*x));
            let all: Vec<f64> =
                there.map(|(_, at)| interpolated(equations, at.value, |own| own.shape)).collect();
            all.iter().sum::<f64>() / all.len() as f64
        });
        let (uniform, error) = mean(&uniform.collect::<Vec<_>>());
        println!(
            "| {:.0} to {:.0} | {} | {uniform:.3} ± {error:.3} |",
            CELL * low,
            CELL * high,
            classes.join(" | ")
        );
        low = high;
    }
}
