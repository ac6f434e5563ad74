//! How well K_P α and P_0 are recovered from one snapshot (N = 100, K_A 0.1, K_P 1, P_0 4, α 3.4) whose positions err by
//! 5 % of the cell size and whose velocities by 2 % of their root mean square, per component.

use crate::Outcome;
use claims::{Noise, TRUTH, Tissue};
use statrs::function::erf::erf;
use std::ops::ControlFlow;
use voronudge_infer::{CrossValidation, KnownNoise, Request, infer};

const CELLS: usize = 100;
const POSITION_NOISE: f64 = 0.05;
const VELOCITY_NOISE: f64 = 0.02;
/// What the fit is told.
struct Case {
    name: &'static str,
    area_elasticity: Known,
    noise: Known,
}

#[derive(Clone, Copy, PartialEq)]
enum Known {
    Given,
    Estimated,
}

pub fn run(seeds: u64) -> Outcome {
    use Known::{Estimated, Given};
    let cases = [
        Case { name: "K_A held, noise given", area_elasticity: Given, noise: Given },
        Case { name: "K_A held, noise estimated", area_elasticity: Given, noise: Estimated },
        Case { name: "K_A free, noise given", area_elasticity: Estimated, noise: Given },
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
        let noise = Noise { position: POSITION_NOISE, velocity: VELOCITY_NOISE };
        let tissue = Tissue::new(CELLS, seed)?;
        let measured = tissue.measured(noise, seed)?;
        let exact = tissue.measured(Noise { position: 0.0, velocity: 0.0 }, seed)?;
        let rms = tissue.rms;
        let given = KnownNoise { position: Some(POSITION_NOISE), velocity: Some(VELOCITY_NOISE) };
        let known = if case.noise == Known::Given { given } else { KnownNoise::default() };
        let mut request = Request { cross_validation: CrossValidation::Skipped, ..tissue.request(known) };
        if case.area_elasticity == Known::Estimated {
            request.constraints.fixed.clear();
        }
        let begun = std::time::Instant::now();
        let result = infer(std::slice::from_ref(&measured), &request, &mut |_| ControlFlow::Continue(()))?;
        let seconds = begun.elapsed().as_secs_f64();
        // The information in the data at the true positions bounds the error of any unbiased estimate.
        let bound = infer(std::slice::from_ref(&exact), &Request { noise: given, ..request }, &mut |_| {
            ControlFlow::Continue(())
        })?
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
            tissue.wrong_edges(&measured.tessellation),
            tissue.wrong_edges(&result.frames[0].tessellation),
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
