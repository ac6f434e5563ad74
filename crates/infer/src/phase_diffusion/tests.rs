use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{dot, honeycomb, quarter_turn};

/// D_∥, D_⊥, D_∥^×, D_⊥^×
const TRUE: [f64; 4] = [1.7, 0.6, -0.5, 0.35];
const REQUEST: PhaseRequest = PhaseRequest {
    wave_vectors: 10,
    order: RateOrder::Second,
    fluctuations: Fluctuations::Measurement,
    reference: ReferencePlaces::Given,
};

/// What has a random course of the equation with exact propagators.
struct Course {
    frames: usize,
    interval: f64,
    /// Standard deviation of the position of a cell, in each frame.
    noise: f64,
    /// Standard deviation of random changes of each amplitude between frames.
    driving: f64,
    /// Amplitude of a state of rest that is not the reference.
    rest: f64,
}

fn simulate(course: &Course, seed: u64) -> Pattern {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let (reference, lengths) = honeycomb(20, 24);
    let domain = PeriodicBox::new(lengths).unwrap();
    let empty = vec![vec![Vector::zeros(); reference.len()]; course.frames];
    let times: Vec<f64> = (0..course.frames).map(|frame| frame as f64 * course.interval).collect();
    let mut pattern = Pattern { domain, reference, displacements: empty, times };
    for wave in resolve(&pattern, 14).unwrap() {
        let q = wave.q;
        let matrix = Basis::of(RateOrder::Second).matrix(&TRUE, q.norm_squared());
        let step = matrix.propagator(course.interval);
        let (along, ahead) = (q / q.norm(), quarter_turn(q / q.norm()));
        for part in 0..2 {
            let mut state = [0.05 * normal(), 0.05 * normal()];
            let rest = [course.rest * normal(), course.rest * normal()];
            for frame in 0..course.frames {
                let u = along * (state[0] + rest[0]) + ahead * (state[1] + rest[1]);
                for (r, sum) in pattern.reference.iter().zip(&mut pattern.displacements[frame]) {
                    let phase = dot(q, *r);
                    *sum += u * if part == 0 { phase.cos() } else { phase.sin() };
                }
                state = step.apply(state).map(|x| x + course.driving * normal());
            }
        }
    }
    for u in pattern.displacements.iter_mut().flatten() {
        *u += Vector::new(normal(), normal()) * course.noise;
    }
    pattern
}

fn estimates(found: &PhaseDiffusion) -> [DiffusivityEstimate; 4] {
    [found.parallel, found.perpendicular, found.parallel_cross, found.perpendicular_cross]
}

#[test]
fn a_course_without_noise_gives_the_diffusivities_back() {
    let pattern = simulate(&Course { frames: 6, interval: 1.5, noise: 0.0, driving: 0.0, rest: 0.0 }, 1);
    let found = phase_diffusion(&pattern, &REQUEST).unwrap();
    for (estimate, truth) in estimates(&found).iter().zip(TRUE) {
        assert!((estimate.value - truth).abs() < 1e-8, "{estimate:?} {truth}");
    }
    assert!(found.explained > 1.0 - 1e-9);
    let first = found.waves[0].square();
    let own = found.own[0].unwrap().matrix;
    assert!((found.matrix(first)[1][0] + first * (TRUE[2] + TRUE[3])).abs() < 1e-8);
    assert!((own[0][1] - first * TRUE[3]).abs() < 1e-8);
}

/// Errors in units of standard errors over many seeds: unbiased, and as large as they should be.
fn assert_calibrated(course: &Course, request: &PhaseRequest) {
    const SEEDS: u64 = 40;
    let mut pulls = [[0.0; 2]; 4];
    let mut covered = 0;
    for seed in 0..SEEDS {
        let found = phase_diffusion(&simulate(course, seed), request).unwrap();
        for (k, (estimate, truth)) in estimates(&found).iter().zip(TRUE).enumerate() {
            let pull = (estimate.value - truth) / estimate.standard_error;
            pulls[k][0] += pull / SEEDS as f64;
            pulls[k][1] += pull * pull / SEEDS as f64;
            covered += usize::from(estimate.interval[0] <= truth && truth <= estimate.interval[1]);
        }
        assert!(found.chirality > 3.0, "seed {seed}: {}", found.chirality);
    }
    for [mean, square] in pulls {
        // Standard errors over 40 seeds: 0.16 and 0.22.
        assert!(mean.abs() < 0.65 && (0.4..1.8).contains(&square), "{pulls:?}");
    }
    // Of 160 intervals 152 are expected to cover, give or take 2.8.
    assert!((141..=159).contains(&covered), "{covered} of 160");
}

#[test]
fn intervals_cover_under_errors_of_measurement() {
    assert_calibrated(&Course { frames: 8, interval: 1.5, noise: 0.03, driving: 0.0, rest: 0.0 }, &REQUEST);
}

#[test]
fn intervals_cover_when_the_state_of_rest_is_not_known() {
    let request = PhaseRequest { reference: ReferencePlaces::Free, ..REQUEST };
    assert_calibrated(
        &Course { frames: 16, interval: 2.0, noise: 0.015, driving: 0.0, rest: 0.05 },
        &request,
    );
}

#[test]
fn intervals_cover_under_random_forces() {
    let request = PhaseRequest { fluctuations: Fluctuations::Driving, ..REQUEST };
    assert_calibrated(&Course { frames: 40, interval: 1.0, noise: 0.0, driving: 0.01, rest: 0.0 }, &request);
}

/// With the wrong idea of the residuals their correlation tells.
#[test]
fn correlated_residuals_give_driving_away() {
    let pattern = simulate(&Course { frames: 40, interval: 1.0, noise: 0.0, driving: 0.01, rest: 0.0 }, 3);
    let found = phase_diffusion(&pattern, &REQUEST).unwrap();
    assert!(found.residual_correlation > 0.4, "{}", found.residual_correlation);
}

/// A mirror takes D^× to −D^× and leaves the others.
#[test]
fn a_mirror_turns_the_cross_diffusivities() {
    let mut pattern = simulate(&Course { frames: 6, interval: 1.0, noise: 0.01, driving: 0.0, rest: 0.0 }, 5);
    let right = phase_diffusion(&pattern, &REQUEST).unwrap();
    pattern.reference.iter_mut().chain(pattern.displacements.iter_mut().flatten()).for_each(|r| r.y = -r.y);
    let left = phase_diffusion(&pattern, &REQUEST).unwrap();
    for (k, (a, b)) in estimates(&right).iter().zip(estimates(&left)).enumerate() {
        let sign = if k < 2 { 1.0 } else { -1.0 };
        assert!((a.value - sign * b.value).abs() < 1e-7, "{k}: {a:?} {b:?}");
    }
}

#[test]
fn too_little_is_refused() {
    let mut pattern = simulate(&Course { frames: 4, interval: 1.0, noise: 0.01, driving: 0.0, rest: 0.0 }, 2);
    let many = PhaseRequest { wave_vectors: 400, ..REQUEST };
    assert!(matches!(phase_diffusion(&pattern, &many), Err(Error::TooFewPatternCells { found: 480, .. })));
    pattern.displacements.truncate(2);
    assert!(matches!(phase_diffusion(&pattern, &REQUEST), Err(Error::TooFewFrames { found: 2, .. })));
    pattern.displacements = vec![vec![Vector::zeros(); 480]; 4];
    assert!(matches!(phase_diffusion(&pattern, &REQUEST), Err(Error::NoDeformation { .. })));
}
