//! What the modes of the model must be like.

#![allow(clippy::unwrap_used, reason = "a test may fail anywhere")]

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_model::{Model, Parameters, velocities};
use voronudge_spectrum::{
    Arrangement, Character, Complex64, Error, Growth, Honeycomb, LinearProblem, Modes, Request, Scope,
    Selection, modes,
};

fn random(cells: usize, seed: u64) -> (Vec<Vector<f64>>, Tessellation) {
    let side = (cells as f64).sqrt();
    let mut rng = Pcg64::seed_from_u64(seed);
    let columns = side.round() as usize;
    let positions: Vec<_> = (0..cells)
        .map(|i| {
            let at = |k: usize, rng: &mut Pcg64| k as f64 + rng.random_range(0.05..0.95);
            Vector::new(at(i % columns, &mut rng), at(i / columns, &mut rng))
        })
        .collect();
    let domain = Domain::Periodic(PeriodicBox::new([side; 2]).unwrap());
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    (positions, tessellation)
}

fn model(preferred_perimeter: f64, chirality: f64) -> Model<f64> {
    Model::chiral_voronoi(&Parameters { preferred_perimeter, chirality, ..Parameters::default() })
}

fn compute(problem: &LinearProblem, selection: Selection) -> Modes {
    modes(problem, &Request::new(selection), &mut |_, _, _| {}).unwrap()
}

/// Displaced along a mode, the velocities change by λ times the displacement.
#[test]
fn modes_are_what_velocities_do() {
    let (positions, tessellation) = random(36, 1);
    let model = model(3.8, 0.7);
    let problem = LinearProblem::new(&tessellation, &positions, &model, |_| true).unwrap();
    let found = compute(&problem, Selection::All);
    let e = 1e-6;
    for index in [0, 20, 50, 71] {
        let (u, value) = (found.vector(index).unwrap(), found.modes[index].value);
        for part in [|x: Complex64| x.re, |x: Complex64| x.im] {
            let moved = |sign: f64| -> Vec<Vector<f64>> {
                let shift = |k: usize| Vector::new(part(u[2 * k]), part(u[2 * k + 1])) * (sign * e);
                let positions: Vec<_> = (0..36).map(|k| positions[k] + shift(k)).collect();
                velocities(&tessellation, &positions, &model)
            };
            for ((k, a), b) in moved(1.0).iter().enumerate().zip(&moved(-1.0)) {
                let slope = (a - b) / (2.0 * e);
                let expected = Vector::new(part(value * u[2 * k]), part(value * u[2 * k + 1]));
                assert!((slope - expected).norm() < 1e-5 * problem.largest_rate(), "{index} {k}");
            }
        }
    }
}

/// Without chirality forces have a potential: J is symmetric, nothing oscillates, and every condition number is 1.
#[test]
fn without_chirality_nothing_oscillates() {
    let (positions, tessellation) = random(64, 2);
    let problem = LinearProblem::new(&tessellation, &positions, &model(3.7, 0.0), |_| true).unwrap();
    let found = compute(&problem, Selection::All);
    assert_eq!(found.counts().oscillating, 0);
    assert!(found.mean_square_frequency().unwrap() < 1e-20);
    assert!(found.fastest_oscillation().is_none());
    let worst = found.modes.iter().filter(|mode| !mode.is_zero(found.tolerance));
    assert!(worst.filter_map(|mode| mode.condition).all(|condition| condition < 1.0 + 1e-6));
}

/// The mirror image has the same spectrum with the other chirality; the trace is the sum of all values.
#[test]
fn the_spectrum_is_that_of_the_mirror_image_with_the_other_chirality() {
    let (positions, tessellation) = random(49, 3);
    let mirrored: Vec<_> = positions.iter().map(|r| Vector::new(-r.x, r.y)).collect();
    let other = Tessellation::new(&mirrored, tessellation.domain()).unwrap();
    let problem = LinearProblem::new(&tessellation, &positions, &model(3.9, 1.3), |_| true).unwrap();
    let image = LinearProblem::new(&other, &mirrored, &model(3.9, -1.3), |_| true).unwrap();
    let (a, b) = (compute(&problem, Selection::All), compute(&image, Selection::All));
    let scale = problem.largest_rate();
    for mode in &a.modes {
        let nearest = b.modes.iter().map(|other| (other.value - mode.value).norm());
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-9 * scale);
    }
    assert!(a.counts().oscillating > 10 && a.counts() == b.counts() && a.counts().zero == 2);
    assert_eq!(a.scope, Scope::All);
}

/// Searched for, modes are those of the dense matrix.
#[test]
fn parts_of_the_spectrum_are_parts_of_the_whole() {
    let (positions, tessellation) = random(100, 4);
    let problem = LinearProblem::new(&tessellation, &positions, &model(3.9, 1.0), |_| true).unwrap();
    let all = compute(&problem, Selection::All);
    let scale = problem.largest_rate();
    let largest = compute(&problem, Selection::Largest(7));
    for (found, expected) in largest.modes.iter().zip(&all.modes) {
        assert!((found.value - expected.value).norm() < 1e-8 * scale);
        assert!(found.residual.unwrap() < 1e-8);
        let off = |a: Option<f64>, b: Option<f64>| (a.unwrap() - b.unwrap()).abs();
        assert!(off(found.participation, expected.participation) < 1e-5);
        assert!(off(found.longitudinal, expected.longitudinal) < 1e-5);
    }
    assert!(largest.modes.len() >= 7 && largest.mean_square_frequency().is_none());
    let fastest = all.modes[all.fastest_oscillation().unwrap()].value;
    let near = compute(&problem, Selection::Near { shift: fastest + 0.1, count: 3 });
    assert!(near.modes.iter().any(|mode| (mode.value - fastest).norm() < 1e-8 * scale));
    let [low, high] = [0.2 * fastest.im, 0.4 * fastest.im];
    let band = compute(&problem, Selection::Band { frequencies: [low, high], count: 12 });
    assert!(!band.modes.is_empty());
    for mode in &band.modes {
        assert!((low..=high).contains(&mode.value.im));
        assert!(all.modes.iter().any(|other| (other.value - mode.value).norm() < 1e-8 * scale));
        assert!(mode.condition.unwrap() > 0.999);
    }
}

/// Plane waves along a direction of symmetry, without chirality, are longitudinal or transverse.
#[test]
fn lattice_waves_have_their_character() {
    let lattice = Honeycomb::new(6, 6, Arrangement::RowsAlongX).unwrap();
    let moves = |_| true;
    let problem =
        LinearProblem::new(lattice.tessellation(), lattice.positions(), &model(3.0, 0.0), moves).unwrap();
    let found = compute(&problem, Selection::All);
    assert_eq!(found.counts().zero, 2);
    assert_eq!(found.counts().decaying, 70);
    let fastest = found.modes.last().unwrap();
    assert!(fastest.growth(found.tolerance) == Growth::Decaying);
    // The slowest waves are transverse: the shear modulus is below B + μ.
    assert!(found.modes[2].longitudinal.unwrap() < 0.05, "{:?}", found.modes[2]);
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let (positions, tessellation) = random(36, 5);
    let problem = LinearProblem::new(&tessellation, &positions, &model(3.8, 0.5), |_| true).unwrap();
    let fault = |selection: Selection, dense_limit: usize| {
        let request = Request { dense_limit, character: Character::None, ..Request::new(selection) };
        modes(&problem, &request, &mut |_, _, _| {}).err()
    };
    assert_eq!(fault(Selection::All, 35), Some(Error::TooManyCells { cells: 36, limit: 35 }));
    assert!(fault(Selection::All, 36).is_none());
    assert_eq!(fault(Selection::Largest(0), 36), Some(Error::NoModes));
    let shift = Complex64::new(f64::NAN, 0.0);
    assert!(matches!(fault(Selection::Near { shift, count: 1 }, 36), Some(Error::Shift { .. })));
    for frequencies in [[2.0, 1.0], [-1.0, 1.0], [0.0, f64::INFINITY], [1.0, 1.0]] {
        assert!(matches!(fault(Selection::Band { frequencies, count: 1 }, 36), Some(Error::Band { .. })));
    }
    assert!(matches!(
        LinearProblem::new(&tessellation, &positions, &model(3.8, 0.5), |_| false),
        Err(Error::NoCells)
    ));
    assert!(Honeycomb::new(6, 7, Arrangement::RowsAlongX).is_err());
}

/// On a honeycomb the Jacobian keeps plane waves apart, so that it answers a wave with its exact D(q), at once and for good; elsewhere cells give way: with a symmetric Jacobian the relaxed answer is
/// the softer one, and without chirality symmetric.
#[test]
fn plane_waves_see_the_jacobian() {
    let honeycomb = Honeycomb::new(12, 12, Arrangement::RowsAlongX).unwrap();
    let tissue = model(3.3, 0.7);
    let problem =
        LinearProblem::new(honeycomb.tessellation(), honeycomb.positions(), &tissue, |_| true).unwrap();
    let jacobian = honeycomb.jacobian(&tissue);
    let [width, height] = honeycomb.lengths();
    let tau = std::f64::consts::TAU;
    let whole = vec![1.0; problem.cells().len()];
    for q in [Vector::new(tau / width, 0.0), Vector::new(-2.0 * tau / width, 3.0 * tau / height)] {
        let [exact, _] = honeycomb.dynamical_matrix(&jacobian, 0, [q.x, q.y]);
        let along = q / q.norm();
        let axes = [along, Vector::new(-along.y, along.x)];
        let projected = problem.projected(&[q], &whole);
        let relaxed = problem.relaxed(&[vec![q]]).unwrap()[0];
        for a in 0..2 {
            for b in 0..2 {
                let expected: f64 =
                    (0..4).map(|k| axes[a][k / 2] * exact[k / 2][k % 2] * axes[b][k % 2]).sum();
                assert!((projected[a][b] - expected).abs() < 1e-10, "{projected:?}");
                assert!((relaxed[a][b] - expected).abs() < 1e-6, "{relaxed:?}");
            }
        }
    }
    let (positions, tessellation) = random(100, 2);
    let problem = LinearProblem::new(&tessellation, &positions, &model(3.0, 0.0), |_| true).unwrap();
    let whole = vec![1.0; problem.cells().len()];
    let q = vec![Vector::new(tau / 10.0, 0.0), Vector::new(0.0, tau / 10.0)];
    let (projected, relaxed) =
        (problem.projected(&q, &whole), problem.relaxed(std::slice::from_ref(&q)).unwrap()[0]);
    // By the modes themselves, of a symmetric Jacobian real and orthogonal: C = Σ P u (−1/λ) ũ P†.
    let found = compute(&problem, Selection::All);
    let mut compliance = [[0.0; 2]; 2];
    for (k, mode) in found.modes.iter().enumerate().filter(|(_, mode)| !mode.is_zero(found.tolerance)) {
        let u = found.vector(k).unwrap();
        let square: f64 = u.iter().map(|x| x.re * x.re).sum();
        for q in &q {
            let along = q / q.norm();
            let axes = [along, Vector::new(-along.y, along.x)];
            let seen = axes.map(|axis| {
                let of_cell = |(cell, r): (usize, &Vector<f64>)| {
                    let phase = Complex64::cis(-q.dot(r));
                    phase * (axis.x * u[2 * cell].re + axis.y * u[2 * cell + 1].re)
                };
                positions.iter().enumerate().map(of_cell).sum::<Complex64>()
            });
            for a in 0..2 {
                for b in 0..2 {
                    compliance[a][b] -= (seen[a] * seen[b].conj()).re / (mode.value.re * square * 200.0);
                }
            }
        }
    }
    let determinant = compliance[0][0] * compliance[1][1] - compliance[0][1] * compliance[1][0];
    for (k, expected) in
        [compliance[1][1], -compliance[0][1], -compliance[1][0], compliance[0][0]].into_iter().enumerate()
    {
        assert!((relaxed[k / 2][k % 2] - expected / determinant).abs() < 1e-4, "{relaxed:?} {compliance:?}");
    }
    assert!((projected[0][1] - projected[1][0]).abs() < 1e-9 && (relaxed[0][1] - relaxed[1][0]).abs() < 1e-9);
    for k in 0..2 {
        assert!(relaxed[k][k] < 0.99 * projected[k][k], "{relaxed:?} {projected:?}");
    }
}
