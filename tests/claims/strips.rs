//! Strips with open ends against the theory of the periodic honeycomb: winding numbers, the generalised Brillouin zone, the
//! non-Hermitian skin effect, and what symmetry says of it.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use voronudge_model::{Model, Parameters};
use voronudge_spectrum::{Arrangement, Complex64, Ends, Honeycomb, Strip, StripMode, rows_of_honeycomb};
use voronudge_theory::{MeanField, Orientation, hexagon_side};

const COLUMNS: usize = 5;

fn parameters(preferred_perimeter: f64, chirality: f64) -> Parameters<f64> {
    Parameters { preferred_perimeter, chirality, ..Parameters::default() }
}

fn theory(p: &Parameters<f64>) -> MeanField {
    MeanField::new(voronudge_theory::Parameters {
        area_elasticity: p.area_elasticity,
        perimeter_elasticity: p.perimeter_elasticity,
        preferred_perimeter: p.preferred_perimeter,
        chirality: p.chirality,
    })
    .unwrap()
}

fn strip(rows: usize, ends: Ends, p: &Parameters<f64>) -> Strip {
    let lattice = Honeycomb::new(COLUMNS, rows, Arrangement::RowsAlongY).unwrap();
    let jacobian = lattice.jacobian(&Model::chiral_voronoi(p));
    let row_of = rows_of_honeycomb(COLUMNS, rows, ends);
    Strip::new(&jacobian, lattice.positions(), lattice.lengths(), &row_of, false).unwrap()
}

/// The largest distance of a value from the nearest of others.
fn apart(ours: &[StripMode], others: impl Fn() -> Vec<Complex64>) -> f64 {
    let others = others();
    let nearest = |value: Complex64| others.iter().map(|o| (o - value).norm()).fold(f64::INFINITY, f64::min);
    ours.iter().map(|mode| nearest(mode.value)).fold(0.0, f64::max)
}

/// A closed strip has the waves of the lattice whose wave numbers fit.
#[test]
fn a_closed_strip_has_the_bands_of_the_theory() {
    let rows = 12;
    let h = 1.5 * hexagon_side();
    for (p_0, alpha) in [(3.4, 0.3), (3.0, -1.1)] {
        let p = parameters(p_0, alpha);
        let closed = strip(rows, Ends::Periodic, &p);
        for q in [0.0, 0.7, -1.9] {
            let expected = || {
                (0..rows)
                    .flat_map(|k| {
                        let q_x = TAU * k as f64 / (rows as f64 * h);
                        theory(&p).decay_rates([q_x, q], Orientation::NeighbourAlongY).unwrap()
                    })
                    .map(|rate| Complex64::new(-rate.real, -rate.imaginary))
                    .collect()
            };
            assert!(apart(&closed.modes(q).unwrap(), expected) < 1e-6);
        }
    }
}

/// How often det(D + λ) runs around zero, followed step by step along the closed form of the theory.
fn winding_of_the_theory(p: &Parameters<f64>, q: f64, value: Complex64) -> i32 {
    let (theory, steps, h) = (theory(p), 4000, 1.5 * hexagon_side());
    let determinant = |step: usize| {
        let q_x = TAU * step as f64 / (steps as f64 * h);
        let [[xx, xy], [yx, yy]] = theory.dynamical_matrix([q_x, q], Orientation::NeighbourAlongY).unwrap();
        (xx + value) * (yy + value) - xy * yx
    };
    let mut turned = 0.0;
    let mut before = determinant(0);
    for step in 1..=steps {
        let now = determinant(step);
        turned += (now / before).arg();
        before = now;
    }
    (turned / TAU).round() as i32
}

/// The winding number from roots of the model's own polynomial is that of the phase along the theory's closed form.
#[test]
fn winding_numbers_are_those_of_the_theory() {
    let mut rng = Pcg64::seed_from_u64(5);
    let mut seen = [0; 3];
    for _ in 0..12 {
        let p = parameters(rng.random_range(2.8..3.7), rng.random_range(-1.0..1.0));
        let strip = strip(8, Ends::Periodic, &p);
        let q = rng.random_range(-2.9..2.9);
        let periodic = strip.periodic(q);
        for _ in 0..30 {
            // Between two values of one wave number or near one.
            let at = |rng: &mut Pcg64| {
                periodic.eigenvalues(Complex64::from_polar(1.0, rng.random_range(0.0..TAU)))
            };
            let sign = usize::from(rng.random::<bool>());
            let value = 0.5 * (at(&mut rng)[sign] + at(&mut rng)[sign]);
            let (found, expected) = (periodic.winding(value).unwrap(), winding_of_the_theory(&p, q, value));
            assert_eq!(found, expected, "{p:?} {q} {value}");
            seen[(found.signum() + 1) as usize] += 1;
        }
    }
    assert!(seen.iter().all(|count| *count > 15), "{seen:?}");
}

/// The modes of a held strip grow as the generalised Brillouin zone says, the better the longer the strip; those around which the periodic spectrum
/// winds pile up, on the side of its sign.
#[test]
fn modes_of_an_open_strip_grow_as_the_generalised_brillouin_zone_says() {
    for (p_0, alpha, q) in [(3.0, 0.3, 2.2), (3.5, 0.3, 2.6), (3.3, -0.5, 2.4)] {
        let mut off_before = f64::INFINITY;
        for rows in [14, 26, 38] {
            let strip = strip(rows, Ends::Held, &parameters(p_0, alpha));
            let (count, h) = (strip.places().len(), strip.spacing());
            let modes = strip.modes(q).unwrap();
            let (mut off, mut size) = (0.0, 0.0);
            for mode in &modes {
                let expected = mode.expected_growth(count).unwrap();
                off += (mode.localisation.growth * h - expected).powi(2);
                size += expected.powi(2);
                if (mode.localisation.growth * h).abs() * count as f64 > 2.0 {
                    assert_eq!(f64::from(mode.winding).signum(), -mode.localisation.growth.signum());
                }
            }
            let off = (off / size).sqrt();
            assert!(off < 0.9 * off_before, "{p_0} {alpha} {q} {rows}: {off} {off_before}");
            off_before = off;
            let piled = modes.iter().filter(|mode| mode.piles_up_right(strip.places()).is_some()).count();
            assert!(rows < 38 || 4 * piled > modes.len(), "{piled} of {}", modes.len());
        }
        assert!(off_before < 0.08, "{p_0} {alpha} {q}: {off_before}");
    }
}

/// A turn of the plane by half a circle takes a mode at q to one at −q on the other side; the complex conjugate of that is one with the conjugate
/// value at q, on the other side; the mirror image has the opposite chirality and side.
#[test]
fn symmetries_exchange_the_sides() {
    for ends in [Ends::Held, Ends::Periodic] {
        let p = parameters(3.3, 0.4);
        let q = 2.3;
        let own = strip(16, ends, &p).modes(q).unwrap();
        let turned = strip(16, ends, &p).modes(-q).unwrap();
        let mirrored = strip(16, ends, &parameters(3.3, -0.4)).modes(q).unwrap();
        let mut unlike = 0;
        for mode in &own {
            let partner = |others: &[StripMode], value: Complex64| -> StripMode {
                let distance = |other: &&StripMode| (other.value - value).norm();
                let nearest = others.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
                assert!(distance(&nearest) < 1e-8, "{ends:?} {value}");
                nearest.clone()
            };
            let conjugate = partner(&own, mode.value.conj());
            let others = [partner(&turned, mode.value), conjugate, partner(&mirrored, mode.value)];
            if ends == Ends::Periodic {
                continue;
            }
            for other in others {
                // Values that nearly coalesce have vectors that are known less well.
                assert!((other.localisation.growth + mode.localisation.growth).abs() < 1e-5);
                assert!((other.localisation.side + mode.localisation.side).abs() < 1e-5);
            }
            unlike += usize::from(mode.localisation.growth.abs() > 0.1);
        }
        assert!(ends == Ends::Periodic || unlike > 4, "{unlike}");
    }
}

/// No skin effect without chirality, nor at q = 0, where the half turn leaves the wave number as it is, nor at the end of the zone.
#[test]
fn where_symmetry_forbids_it_nothing_piles_up() {
    let end_of_zone = TAU / (3f64.sqrt() * hexagon_side()) / 2.0;
    for (alpha, q) in [(0.0, 0.8), (0.0, 2.4), (0.5, 0.0), (0.5, end_of_zone)] {
        let strip = strip(20, Ends::Held, &parameters(3.2, alpha));
        for mode in strip.modes(q).unwrap() {
            if alpha == 0.0 {
                assert!(mode.value.im.abs() < 1e-9);
            }
            assert_eq!(mode.winding, 0, "{alpha} {q} {}", mode.value);
            assert!(mode.localisation.growth.abs() < 1e-3, "{alpha} {q} {:?}", mode.localisation);
        }
    }
}

/// To the determinant of D(q) chirality adds a part that is odd in it: it has the six-fold symmetry of the lattice, is reversed by each mirror line and vanishes on
/// it, and is of order q⁶, beyond the elastic medium.
#[test]
fn what_opens_the_loops_is_six_fold_and_of_sixth_order() {
    for p_0 in [2.8, 3.3, 3.6] {
        let determinant = |q: f64, angle: f64, alpha: f64| {
            let at = [q * angle.cos(), q * angle.sin()];
            let [[xx, xy], [yx, yy]] =
                theory(&parameters(p_0, alpha)).dynamical_matrix(at, Orientation::NeighbourAlongY).unwrap();
            xx * yy - xy * yx
        };
        let odd = |q: f64, angle: f64| determinant(q, angle, 0.5) - determinant(q, angle, -0.5);
        for q in [0.3, 1.1, 2.5] {
            let size = determinant(q, 0.0, 0.5);
            for mirror in [0.0, TAU / 12.0] {
                assert!(odd(q, mirror).abs() < 1e-12 * size);
                assert!((odd(q, mirror + 0.2) + odd(q, mirror - 0.2)).abs() < 1e-12 * size);
            }
            assert!((odd(q, 0.3) - odd(q, 0.3 + TAU / 6.0)).abs() < 1e-12 * size);
            assert!(odd(q, TAU / 24.0).abs() > 1e-5 * size);
        }
        let over_sixth = |q: f64| odd(q, TAU / 24.0) / q.powi(6);
        assert!((over_sixth(0.05) / over_sixth(0.1) - 1.0).abs() < 0.01);
    }
}
