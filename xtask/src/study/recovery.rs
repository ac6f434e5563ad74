//! How well K_P α and P_0 are recovered from one snapshot (N = 100, K_A 0.1, K_P 1, P_0 4, α 3.4) whose positions err by
//! 5 % of the cell size and whose velocities by 2 % of their root mean square, per component.

use crate::Outcome;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use statrs::function::erf::erf;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_infer::{Fixed, Observation, Request, infer};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{RandomPlacement, Simulation, generator};

const CELLS: usize = 100;
const POSITION_NOISE: f64 = 0.05;
const VELOCITY_NOISE: f64 = 0.02;
const TRUTH: Parameters<f64> = Parameters {
    area_elasticity: 0.1,
    perimeter_elasticity: 1.0,
    preferred_perimeter: 4.0,
    preferred_area: 1.0,
    chirality: 3.4,
};

/// What the fit is told.
struct Case {
    name: &'static str,
    fixed: Fixed,
    noise: Noise,
}

enum Noise {
    Given,
    Estimated,
}

pub fn run(seeds: u64) -> Outcome {
    let held = Fixed { area_elasticity: Some(TRUTH.area_elasticity), ..Fixed::default() };
    let cases = [
        Case { name: "K_A held, noise given", fixed: held, noise: Noise::Given },
        Case { name: "K_A held, noise estimated", fixed: held, noise: Noise::Estimated },
        Case { name: "K_A free, noise given", fixed: Fixed::default(), noise: Noise::Given },
    ];
    for case in cases {
        table(&case, seeds)?;
    }
    Ok(())
}

fn table(case: &Case, seeds: u64) -> Outcome {
    println!("### {}\n", case.name);
    println!(
        "| seed | K_P α | 95 % | P_0 | 95 % | 95 % bound | K_A | naive K_P α | naive P_0 | Φ / expected | wrong edges | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let (mut chiral, mut perimeter, mut covered, mut naive, mut expected) = (0, 0, [0, 0], [0, 0], 0.0);
    for seed in 0..seeds {
        let snapshot = Snapshot::new(seed)?;
        let rms = snapshot.rms;
        let given = matches!(case.noise, Noise::Given);
        let request = Request {
            fixed: Fixed { area_elasticity: case.fixed.area_elasticity.map(|k_a| k_a / rms), ..case.fixed },
            preferred_area: TRUTH.preferred_area,
            position_noise: given.then_some(POSITION_NOISE),
            velocity_noise: given.then_some(VELOCITY_NOISE),
            max_steps: 60,
        };
        let begun = std::time::Instant::now();
        let result =
            infer(std::slice::from_ref(&snapshot.measured), &request, &mut |_| ControlFlow::Continue(()))?;
        let seconds = begun.elapsed().as_secs_f64();
        // The information in the data at the true positions bounds the error of any unbiased estimate.
        let bound = infer(
            std::slice::from_ref(&snapshot.exact),
            &Request {
                position_noise: Some(POSITION_NOISE),
                velocity_noise: Some(VELOCITY_NOISE),
                ..request
            },
            &mut |_| ControlFlow::Continue(()),
        )?
        .parameters
        .preferred_perimeter
        .standard_error;
        expected += erf(0.02 * TRUTH.preferred_perimeter / (bound * 2f64.sqrt()));
        let (c, p) = (result.parameters.chiral_coefficient, result.parameters.preferred_perimeter);
        let (k_p_alpha, half) = (c.value * rms, 1.96 * c.standard_error * rms);
        let naive_chiral = result.naive.perimeter_elasticity * result.naive.chirality * rms;
        let within = |value: f64, truth: f64, share: f64| usize::from((value / truth - 1.0).abs() < share);
        chiral += within(k_p_alpha, TRUTH.chirality, 0.05);
        perimeter += within(p.value, TRUTH.preferred_perimeter, 0.02);
        naive[0] += within(naive_chiral, TRUTH.chirality, 0.05);
        naive[1] += within(result.naive.preferred_perimeter, TRUTH.preferred_perimeter, 0.02);
        covered[0] += usize::from((k_p_alpha - TRUTH.chirality).abs() < half);
        covered[1] += usize::from((p.value - TRUTH.preferred_perimeter).abs() < 1.96 * p.standard_error);
        println!(
            "| {seed} | {k_p_alpha:.3} | ±{half:.3} | {:.3} | ±{:.3} | ±{:.3} | {:.2} | {naive_chiral:.2} | {:.2} | {:.2} | {} → {} | {seconds:.2} |",
            p.value,
            1.96 * p.standard_error,
            1.96 * bound,
            result.parameters.area_elasticity.value * rms,
            result.naive.preferred_perimeter,
            result.objective / result.expected_objective,
            snapshot.wrong_edges(&snapshot.measured.tessellation),
            snapshot.wrong_edges(&result.frames[0].tessellation),
        );
    }
    println!(
        "\nOf {seeds} seeds: K_P α within 5 %: {chiral} (naive {}); P_0 within 2 %: {perimeter} (naive {}; an \
         estimate at the bound {expected:.1}); 95 % intervals \
         cover K_P α in {}, P_0 in {}.\n",
        naive[0], naive[1], covered[0], covered[1]
    );
    Ok(())
}

struct Snapshot {
    truth: Vec<(u32, u32, [i16; 2])>,
    measured: Observation,
    exact: Observation,
    rms: f64,
}

impl Snapshot {
    fn new(seed: u64) -> Result<Self, Box<dyn std::error::Error>> {
        let cell_box = PeriodicBox::new([(CELLS as f64).sqrt(); 2])?;
        let domain = Domain::Periodic(cell_box);
        let start = RandomPlacement::new(CELLS, cell_box).draw(&mut generator(1000 + seed))?;
        let mut simulation = Simulation::new(start, domain, Model::chiral_voronoi(&TRUTH))?;
        for _ in 0..2000 {
            simulation.step(0.005)?;
        }
        let mut rng = Pcg64::seed_from_u64(2000 + seed);
        let mut noisy = |v: Vector<f64>, normal: Normal<f64>| {
            Vector::new(v.x + normal.sample(&mut rng), v.y + normal.sample(&mut rng))
        };
        let (r, v) = (simulation.positions(), simulation.velocities());
        let rms = (v.iter().map(|v| v.norm_squared()).sum::<f64>() / CELLS as f64).sqrt();
        let (on_r, on_v) = (Normal::new(0.0, POSITION_NOISE)?, Normal::new(0.0, VELOCITY_NOISE)?);
        let positions = r.iter().map(|r| noisy(*r, on_r)).collect();
        let velocities = v.iter().map(|v| Some(noisy(v / rms, on_v))).collect();
        let exact = v.iter().map(|v| Some(v / rms)).collect();
        Ok(Self {
            exact: Observation::new(0, r.to_vec(), exact, domain, 3.0)?,
            truth: Tessellation::new(r, domain)?.edges(),
            measured: Observation::new(0, positions, velocities, domain, 3.0)?,
            rms,
        })
    }

    fn wrong_edges(&self, tessellation: &Tessellation) -> usize {
        tessellation.edges().iter().filter(|edge| self.truth.binary_search(edge).is_err()).count()
    }
}
