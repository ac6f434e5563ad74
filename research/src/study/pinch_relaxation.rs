//! What becomes of the flow that a density gradient sets off in a liquid.

use super::flows::{parameters, random};
use super::pinching::PINCH_CELLS;
use super::seeds::{Replicas, mean, on_one_core_each};
use crate::Outcome;
use std::error::Error;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, Vector};
use voronudge_simulate::Simulation;
use voronudge_simulate::moduli::{UniformState, UniformTissue};
use voronudge_theory::EquationOfState;

const PREFERRED_PERIMETER: f64 = 4.0;
const CHIRALITIES: [f64; 2] = [0.8, 1.6];
/// Amplitude of the wave in cell sizes: a strain of 0.3, so that it is seen above what chaos makes of two copies.
const AMPLITUDE: f64 = 1.0;
const PHASES: u32 = 16;
/// Places along a wave.
const PLACES: u32 = 1000;
const STEP: f64 = 0.005;
/// Steps after the displacement.
const STEPS: [u32; 11] = [0, 2, 5, 10, 20, 40, 80, 160, 320, 640, 1280];
/// Time before each of the snapshots.
const SETTLE: [f64; 2] = [35.0, 5.0];

/// Densities of uniform tissues, and the times before and of their averages.
const DENSITIES: [f64; 8] = [0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.35];
const UNIFORM: [f64; 2] = [20.0, 20.0];

/// Velocities in phase with the wave, per displacement and squared wave number; and the share of the density wave that is left.
#[derive(Clone, Copy, Default)]
struct Response {
    along: f64,
    across: f64,
    density: f64,
}

/// A displaced copy of a tissue is followed beside one that was left alone.
fn follow(
    simulation: &Simulation,
    phase: u32,
    sums: &mut [Response],
) -> Result<(), voronudge_simulate::Error> {
    let width = simulation.cell_box().lengths()[0];
    let q = TAU / width;
    let angle = |r: &Vector<f64>| q * r.x + TAU * f64::from(phase) / f64::from(PHASES);
    let copy = |positions| {
        Simulation::new(positions, Domain::Periodic(simulation.cell_box()), simulation.model().clone())
    };
    let positions = simulation.positions().to_vec();
    let displaced = positions.iter().map(|r| Vector::new(r.x + AMPLITUDE * angle(r).sin(), r.y)).collect();
    let (mut pinched, mut alone) = (copy(displaced)?, copy(positions)?);
    let in_phase = |tissue: &Simulation| {
        let rows = tissue.positions().iter().zip(tissue.velocities());
        rows.map(|(r, v)| Vector::new(v.x * angle(r).sin(), v.y * angle(r).sin())).sum::<Vector<f64>>()
    };
    let wave = |tissue: &Simulation| tissue.positions().iter().map(|r| angle(r).cos()).sum::<f64>();
    let scale = -2.0 / (simulation.positions().len() as f64 * AMPLITUDE * q);
    let mut made = 0;
    for (sum, steps) in sums.iter_mut().zip(STEPS) {
        while made < steps {
            pinched.step(STEP)?;
            alone.step(STEP)?;
            made += 1;
        }
        let v = (in_phase(&pinched) - in_phase(&alone)) * (scale / q);
        sum.along += v.x;
        sum.across += v.y;
        sum.density += (wave(&pinched) - wave(&alone)) * scale;
    }
    Ok(())
}

/// Uniform tissues of several densities.
fn equation_of_state(chirality: f64, seeds: &[u64]) -> Result<EquationOfState, Box<dyn Error>> {
    let count = seeds.len();
    let states = on_one_core_each((DENSITIES.len() * count) as u64, |task| {
        let (point, seed) = (task as usize / count, seeds[task as usize % count]);
        let tissue = UniformTissue {
            parameters: parameters(PREFERRED_PERIMETER, chirality),
            density: DENSITIES[point],
            cells: PINCH_CELLS,
            times: UNIFORM,
            time_step: None,
        };
        Ok(tissue.measure(seed, &|| ControlFlow::Continue(()))?)
    })?;
    let points: Vec<[f64; 3]> = (states.chunks(count).zip(DENSITIES))
        .map(|(own, density)| {
            let of = |of: fn(&UniformState) -> f64| own.iter().map(of).sum::<f64>() / count as f64;
            [density, of(|state| state.pressure), of(|state| state.torque)]
        })
        .collect();
    Ok(EquationOfState::new(&points)?)
}

/// `v_y/v_x` in phase with a wave of the density, of tissues that have forgotten their strain: `½ ∫τ cos θ/∫p cos θ` at `ρ = 1 + ε cos θ`.
fn of_uniform_tissues(equation: &EquationOfState, amplitude: f64) -> f64 {
    let [mut torque, mut pressure] = [0.0; 2];
    for k in 0..PLACES {
        let wave = (TAU * f64::from(k) / f64::from(PLACES)).cos();
        torque += 0.5 * equation.torque(1.0 + amplitude * wave) * wave;
        pressure += equation.pressure(1.0 + amplitude * wave) * wave;
    }
    torque / pressure
}

pub fn run(replicas: Replicas) -> Outcome {
    let seeds: Vec<u64> = replicas.seeds().collect();
    println!(
        "| α | time | −v_x/(a q²) | −v_y/(a q²) | v_y/v_x | density wave left | v_y/v_x of uniform tissues |"
    );
    println!("|---|---|---|---|---|---|---|");
    let wave_number = TAU / (PINCH_CELLS as f64).sqrt();
    for chirality in CHIRALITIES {
        let equation = equation_of_state(chirality, &seeds)?;
        let each = on_one_core_each(replicas.count, |k| {
            let parameters = parameters(PREFERRED_PERIMETER, chirality);
            let mut simulation = random(PINCH_CELLS, &parameters, seeds[k as usize])?;
            let mut sums = [Response::default(); STEPS.len()];
            for time in SETTLE {
                for _ in 0..(time / STEP).round() as usize {
                    simulation.step(STEP)?;
                }
                for phase in 0..PHASES {
                    follow(&simulation, phase, &mut sums)?;
                }
            }
            Ok(sums)
        })?;
        let count = f64::from(PHASES) * SETTLE.len() as f64;
        for (k, steps) in STEPS.into_iter().enumerate() {
            let of = |part: &dyn Fn(&Response) -> f64| {
                mean(&each.iter().map(|sums| part(&sums[k])).collect::<Vec<_>>())
            };
            let (along, across) = (of(&|sum| sum.along / count), of(&|sum| sum.across / count));
            let (ratio, density) = (of(&|sum| sum.across / sum.along), of(&|sum| sum.density / count));
            println!(
                "| {chirality} | {:.3} | {:.2} ± {:.2} | {:.2} ± {:.2} | {:.3} ± {:.3} | {:.3} | {:.3} |",
                f64::from(steps) * STEP,
                along.0,
                along.1,
                across.0,
                across.1,
                ratio.0,
                ratio.1,
                density.0,
                of_uniform_tissues(&equation, AMPLITUDE * wave_number * density.0)
            );
        }
    }
    Ok(())
}
