//! Waves whose D(q) is known.

use nalgebra::Complex;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Vector, honeycomb, quarter_turn};
use voronudge_observables::{
    DynamicStructure, FluctuationRequest, Images, Plan, RateMatrix, Recording, Relaxation, StructurePart,
    WaveField, fluctuations, relaxation_of_waves, together,
};

const INTERVAL: f64 = 0.2;

fn normal(rng: &mut Pcg64) -> f64 {
    (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
}

/// Amplitudes along q and a quarter turn ahead, frame by frame.
type Course = Vec<[Complex<f64>; 2]>;

/// A course of `∂_t u = −D u` + noise with the covariance 1, exact at the frames, with errors of a variance in each component.
fn wave(rates: RateMatrix, frames: usize, errors: f64, rng: &mut Pcg64) -> Course {
    let step = rates.propagator(INTERVAL);
    let [[a, b], [c, d]] = step.0;
    // The Cholesky factor of 1 − M Mᵀ.
    let [xx, xy, yy] = [1.0 - a * a - b * b, -a * c - b * d, 1.0 - c * c - d * d];
    let first = xx.sqrt();
    let (second, third) = (xy / first, (yy - (xy / first).powi(2)).sqrt());
    let mut complex = |scale: f64| Complex::new(normal(rng), normal(rng)) * (0.5 * scale).sqrt();
    let mut u = [complex(1.0), complex(1.0)];
    (0..frames)
        .map(|_| {
            let seen = u.map(|u| u + complex(errors));
            let [x, y] = [complex(1.0), complex(1.0)];
            u = [u[0] * a + u[1] * b + x * first, u[0] * c + u[1] * d + x * second + y * third];
            seen
        })
        .collect()
}

fn courses(rates: RateMatrix, waves: usize, frames: usize, errors: f64, seed: u64) -> Vec<Course> {
    let mut rng = Pcg64::seed_from_u64(seed);
    (0..waves).map(|_| wave(rates, frames, errors, &mut rng)).collect()
}

fn analysed(courses: &[Course], first_lag: usize) -> Relaxation {
    relaxation_of_waves(courses, first_lag, INTERVAL).unwrap()
}

/// Mean and standard deviation.
fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (mean, (values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt())
}

/// Waves of a spiral: D is found within errors that are true, whatever errors of localisation without memory there are, unless they are left in.
#[test]
fn what_is_put_in_comes_out_within_its_errors() {
    let rates = RateMatrix([[0.9, -0.7], [0.8, 0.4]]);
    for (errors, first_lag) in [(0.0, 0), (0.0, 1), (0.4, 1)] {
        let found: Vec<Relaxation> =
            (0..120).map(|seed| analysed(&courses(rates, 6, 600, errors, seed), first_lag)).collect();
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let pull = |own: &Relaxation| (own.matrix[i][j] - rates.0[i][j]) / own.standard_errors[i][j];
            let (mean, width) = moments(found.iter().map(pull));
            assert!(mean.abs() < 0.35 && (0.82..1.22).contains(&width), "{i}{j}: {mean} ± {width}");
        }
        let held = found.iter().filter(|own| {
            let [low, high] = own.frequency_interval;
            (low..=high).contains(&rates.frequency())
        });
        assert!(held.count() >= 106);
        let few = found.iter().filter(|own| own.linear < 0.05).count();
        assert!(few <= 14, "{few} of 120 are not linear");
        assert!(found.iter().all(|own| own.achiral < 1e-4));
        if first_lag == 1 {
            let pull = |own: &Relaxation| (own.noise - errors) / own.noise_error;
            let (mean, width) = moments(found.iter().map(pull));
            assert!(mean.abs() < 0.35 && (0.8..1.25).contains(&width), "noise: {mean} ± {width}");
            let (left_in, _) = moments(found.iter().map(|own| own.uncorrected[0][0]));
            assert_eq!(left_in > 1.1 * rates.0[0][0], errors > 0.0, "{left_in}");
        }
    }
}

/// A course of eight relaxation times: taking out its mean makes relaxation look faster, and the correction takes that back.
#[test]
fn short_courses_are_corrected() {
    let rates = RateMatrix([[0.3, 0.05], [-0.05, 0.08]]);
    let found: Vec<Relaxation> =
        (0..150).map(|seed| analysed(&courses(rates, 8, 500, 0.0, seed), 0)).collect();
    assert!((found[0].relaxations / 8.0 - 1.0).abs() < 0.8);
    for k in 0..2 {
        let (mean, width) = moments(found.iter().map(|own| own.matrix[k][k]));
        assert!((mean / rates.0[k][k] - 1.0).abs() < 0.04, "{mean}");
        let (error, _) = moments(found.iter().map(|own| own.standard_errors[k][k]));
        assert!((0.75..1.25).contains(&(error / width)), "{error} for {width}");
    }
}

/// Without chirality entries off the diagonal are as large as chance has it; two processes at once do not relax linearly.
#[test]
fn chance_is_told_from_chirality_and_memory() {
    let rates = RateMatrix([[0.9, 0.0], [0.0, 0.4]]);
    let found: Vec<Relaxation> =
        (0..200).map(|seed| analysed(&courses(rates, 5, 500, 0.1, seed), 1)).collect();
    for (what, p) in [
        ("achiral", found.iter().map(|own| own.achiral).collect::<Vec<_>>()),
        ("linear", found.iter().map(|own| own.linear).collect()),
    ] {
        let few = p.iter().filter(|p| **p < 0.1).count();
        assert!((7..=36).contains(&few), "{what}: {few} of 200 below 0.1");
        let (mean, _) = moments(p.iter().copied());
        assert!((mean - 0.5).abs() < 0.09, "{what}: {mean}");
    }
    let all = together(found.iter().map(|own| own.achiral)).unwrap();
    assert!(all > 1e-3, "{all}");
    let mut mixed = courses(rates, 5, 2000, 0.0, 1);
    for (a, b) in mixed.iter_mut().flatten().zip(courses(rates * 8.0, 5, 2000, 0.0, 2).iter().flatten()) {
        *a = [a[0] + b[0], a[1] + b[1]];
    }
    let found = analysed(&mixed, 1);
    assert!(found.linear < 1e-3, "{found:?}");
}

/// A periodic honeycomb whose cells are displaced by waves along x and y: the recording as a whole, signs and axes included, and its spectra.
#[test]
fn waves_of_a_recording_are_resolved() {
    let rates = RateMatrix([[0.9, -0.7], [0.8, 0.4]]);
    let (places, lengths) = honeycomb(10, 10);
    let cell_box = PeriodicBox::new(lengths).unwrap();
    let count = places.len() as f64;
    let frames = 1200;
    let q = [
        Vector::new(std::f64::consts::TAU / lengths[0], 0.0),
        Vector::new(0.0, std::f64::consts::TAU / lengths[1]),
    ];
    let (mut ratios, mut pulls) = (Vec::new(), Vec::new());
    for seed in 0..6 {
        let mut rng = Pcg64::seed_from_u64(seed);
        let waves = q.map(|q| (q, wave(rates, frames, 0.0, &mut rng)));
        let scale = 0.05;
        let at = |frame: usize| {
            let displaced = |r: &Vector<f64>| {
                let mut r = *r;
                let home = r;
                for (q, course) in &waves {
                    let turn = Complex::cis(q.dot(&home)) * (2.0 * scale / count.sqrt() * count.sqrt());
                    let along = q / q.norm();
                    let [u, w] = course[frame].map(|a| (a * turn).re);
                    r += along * u + quarter_turn(along) * w;
                }
                Some(r)
            };
            places.iter().map(displaced).collect::<Vec<_>>()
        };
        let times: Vec<f64> = (0..frames).map(|frame| frame as f64 * INTERVAL).collect();
        let recording = Recording::new(
            &times,
            (0..frames).map(at).collect(),
            &vec![Domain::Periodic(cell_box); frames],
            &FieldOfView::default(),
            Images::Followed,
        )
        .unwrap();
        let plan = Plan::of(&recording).unwrap();
        let request = FluctuationRequest { field: None, first_lag: Some(0), lag: None, largest: 0.75 };
        let found =
            fluctuations(&recording, &plan, &request, &mut |_, _, _| std::ops::ControlFlow::Continue(()))
                .unwrap();
        assert_eq!(found.field, WaveField::Displacements);
        // The sides differ by more than a shell is wide.
        assert_eq!(found.shells.len(), 2);
        for shell in &found.shells {
            assert_eq!(shell.wave_vectors.len(), 1);
            let relaxation = shell.relaxation.as_ref().unwrap();
            for k in 0..4 {
                let error = relaxation.standard_errors[k / 2][k % 2];
                pulls.push((relaxation.matrix[k / 2][k % 2] - rates.0[k / 2][k % 2]) / error);
            }
        }
        // The amplitude of a wave is √N times that of its cosine, halved.
        let power = scale * scale * count;
        for shell in 0..2 {
            spectra(found.structure.as_ref().unwrap(), shell, (rates, power), &mut ratios);
        }
    }
    let (mean, width) = moments(pulls.iter().copied());
    assert!(mean.abs() < 0.7 && width < 1.6, "{mean} ± {width}");
    let (mean, width) = moments(ratios.iter().copied());
    assert!(
        mean.abs() < 0.25 && (0.7..1.35).contains(&width),
        "spectra: {mean} ± {width} of {}",
        ratios.len()
    );
}

/// Differences of the spectra of a shell from `(D − iω)⁻¹ (D + Dᵀ) (D − iω)⁻†`, of frames far apart the sum over aliases, in standard errors.
fn spectra(found: &DynamicStructure, shell: usize, (rates, power): (RateMatrix, f64), pulls: &mut Vec<f64>) {
    let RateMatrix([[a, b], [c, d]]) = rates;
    let exact = |omega: f64| -> [f64; 4] {
        let i = Complex::<f64>::new(0.0, -omega);
        let determinant: Complex<f64> = (i + a) * (i + d) - b * c;
        let inverse = [
            [(i + d) / determinant, Complex::from(-b) / determinant],
            [Complex::from(-c) / determinant, (i + a) / determinant],
        ];
        let noise = [[2.0 * a, b + c], [b + c, 2.0 * d]];
        let entry = |k: usize, l: usize| {
            let mut sum = Complex::<f64>::ZERO;
            for (m, row) in noise.iter().enumerate() {
                for (n, noise) in row.iter().enumerate() {
                    sum += inverse[k][m] * inverse[l][n].conj() * *noise;
                }
            }
            sum
        };
        [entry(0, 0).re, entry(1, 1).re, entry(0, 1).re, entry(0, 1).im]
    };
    let period = std::f64::consts::TAU / INTERVAL;
    for (k, omega) in found.frequencies.iter().enumerate().skip(2).step_by(3) {
        let mut expected = [0.0; 4];
        for alias in -200..=200 {
            let one = exact(omega + f64::from(alias) * period);
            expected.iter_mut().zip(one).for_each(|(sum, one)| *sum += power * one);
        }
        for (part, expected) in StructurePart::ALL[..4].iter().zip(expected) {
            let [value, error] = found.parts[*part as usize][shell][k];
            if error > 0.0 {
                pulls.push((value - expected) / error);
            }
        }
    }
}
