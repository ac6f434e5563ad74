use super::*;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// 95 % of χ² with one degree of freedom.
const THRESHOLD: f64 = 3.841_458_820_694_124;

fn vector(entries: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(entries)
}

fn any(p: usize, rng: &mut Pcg64Mcg) -> DVector<f64> {
    DVector::from_fn(p, |_, _| rng.random_range(-1.0..1.0))
}

/// A positive definite matrix whose entries differ by orders of magnitude.
fn any_hessian(p: usize, rng: &mut Pcg64Mcg) -> DMatrix<f64> {
    let factor = DMatrix::from_fn(p, p, |i, _| 10f64.powi(i as i32) * rng.random_range(-1.0..1.0));
    &factor * factor.transpose() + DMatrix::from_fn(p, p, |i, j| if i == j { 0.01 } else { 0.0 })
}

fn any_half_spaces(count: usize, p: usize, rng: &mut Pcg64Mcg) -> Vec<HalfSpace> {
    (0..count).map(|_| HalfSpace { normal: any(p, rng), bound: rng.random_range(-0.5..0.5) }).collect()
}

/// A normal deviate (Box and Muller).
fn normal(rng: &mut Pcg64Mcg) -> f64 {
    let (u, v): (f64, f64) = (rng.random_range(0.0..1.0), rng.random_range(0.0..1.0));
    (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
}

/// At the least value the gradient is a sum of the active normals, none of which pulls (Karush, Kuhn and Tucker).
#[test]
fn minima_satisfy_the_conditions_of_optimality() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let (mut held, mut contradictory) = (0, 0);
    for trial in 0..400 {
        let (p, count) = (1 + trial % 5, trial % 9);
        let (centre, hessian) = (any(p, &mut rng), any_hessian(p, &mut rng));
        let half_spaces = any_half_spaces(count, p, &mut rng);
        let plane = Hyperplane { normal: any(p, &mut rng), value: rng.random_range(-0.5..0.5) };
        let equal = (trial % 2 == 1).then_some(&plane);
        let quadratic = Quadratic::new(centre.clone(), &hessian).unwrap();
        let Some(found) = quadratic.minimise(&half_spaces, equal) else {
            contradictory += 1;
            assert!(count + usize::from(equal.is_some()) > p);
            continue;
        };
        held += usize::from(!found.active.is_empty());
        let gradient = &hessian * (&found.at - &centre);
        assert!((gradient.dot(&(&found.at - &centre)) - found.value).abs() < 1e-9 * (1.0 + found.value));
        for half in &half_spaces {
            assert!(half.normal.dot(&found.at) > half.bound - 1e-8);
        }
        let mut normals: Vec<_> = found.active.iter().map(|&i| half_spaces[i].normal.clone()).collect();
        normals.extend(equal.map(|plane| plane.normal.clone()));
        for (&i, normal) in found.active.iter().zip(&normals) {
            assert!((normal.dot(&found.at) - half_spaces[i].bound).abs() < 1e-8);
        }
        let scale = gradient.norm() + 1.0;
        if normals.is_empty() {
            assert!(gradient.norm() < 1e-9);
        } else {
            let normals = DMatrix::from_columns(&normals);
            let pushes = normals.clone().svd(true, true).solve(&gradient, 1e-14).unwrap();
            assert!((&normals * &pushes - &gradient).norm() < 1e-7 * scale);
            assert!(pushes.iter().take(found.active.len()).all(|push| *push > -1e-7 * scale));
        }
    }
    assert!(held > 100 && contradictory > 10, "{held} {contradictory}");
}

#[test]
fn contradictory_constraints_have_no_minimum() {
    let quadratic = Quadratic::new(vector(&[0.3, 0.2]), &DMatrix::identity(2, 2)).unwrap();
    let above = HalfSpace { normal: vector(&[1.0, 0.0]), bound: 1.0 };
    let below = HalfSpace { normal: vector(&[-2.0, 0.0]), bound: 0.0 };
    let plane = Hyperplane { normal: vector(&[1.0, 0.0]), value: 0.5 };
    assert_eq!(quadratic.minimise(&[above.clone(), below.clone()], None), None);
    assert_eq!(quadratic.minimise(std::slice::from_ref(&above), Some(&plane)), None);
    assert_eq!(quadratic.linear_interval(&vector(&[0.0, 1.0]), &[above, below], 1.0), None);
    let indefinite = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]);
    assert!(matches!(Quadratic::new(vector(&[0.0, 0.0]), &indefinite), Err(Error::Degenerate)));
}

#[test]
fn results_do_not_depend_on_units() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let units = [1e-7, 1.0, 1e6];
    let (centre, hessian) = (any(3, &mut rng), any_hessian(3, &mut rng));
    let half_spaces = any_half_spaces(4, 3, &mut rng);
    let scaled = Quadratic::new(
        DVector::from_fn(3, |i, _| centre[i] * units[i]),
        &DMatrix::from_fn(3, 3, |i, j| hessian[(i, j)] / (units[i] * units[j])),
    )
    .unwrap();
    let inverse = |v: &DVector<f64>| DVector::from_fn(3, |i, _| v[i] / units[i]);
    let scaled_half_spaces: Vec<HalfSpace> = (half_spaces.iter().zip([1e9, 1.0, 1e-9, 3.0]))
        .map(|(half, s)| HalfSpace { normal: inverse(&half.normal) * s, bound: half.bound * s })
        .collect();
    let plain = Quadratic::new(centre, &hessian).unwrap();
    let (a, b) = (plain.minimise(&half_spaces, None), scaled.minimise(&scaled_half_spaces, None));
    let (a, b) = (a.unwrap(), b.unwrap());
    assert_eq!(a.active, b.active);
    assert!((a.value - b.value).abs() < 1e-9 * a.value);
    assert!((a.at - inverse(&b.at)).norm() < 1e-9);
    let functional = any(3, &mut rng);
    let ends = |q: &Quadratic, c: &DVector<f64>, h: &[HalfSpace]| q.linear_interval(c, h, 2.0).unwrap();
    let (a, b) =
        (ends(&plain, &functional, &half_spaces), ends(&scaled, &inverse(&functional), &scaled_half_spaces));
    for (a, b) in [(a.lower, b.lower), (a.upper, b.upper)] {
        assert!((a.unwrap() - b.unwrap()).abs() < 1e-8, "{a:?} {b:?}");
    }
}

#[test]
fn without_constraints_an_interval_is_the_estimate_and_its_standard_error() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    for p in 1..=6 {
        let (centre, hessian, c) = (any(p, &mut rng), any_hessian(p, &mut rng), any(p, &mut rng));
        let variance = c.dot(&(hessian.clone().try_inverse().unwrap() * &c));
        let found = Quadratic::new(centre.clone(), &hessian).unwrap();
        let found = found.linear_interval(&c, &[], THRESHOLD).unwrap();
        let reach = (THRESHOLD * variance).sqrt();
        assert!((found.lower.unwrap() - c.dot(&centre) + reach).abs() < 1e-9 * reach);
        assert!((found.upper.unwrap() - c.dot(&centre) - reach).abs() < 1e-9 * reach);
    }
}

/// With the variance matrix V of numerator and denominator, `r = a/b` and `g = t² V_bb / b²`:
/// `[ r − g V_ab/V_bb ± (t/b) √( V_aa − 2 r V_ab + r² V_bb − g (V_aa − V_ab²/V_bb) ) ] / (1 − g)`.
#[test]
fn a_ratio_without_constraints_has_fiellers_interval() {
    let variance = DMatrix::from_row_slice(2, 2, &[0.5, 0.12, 0.12, 0.2]);
    let hessian = variance.clone().try_inverse().unwrap();
    let interval = |centre: [f64; 2], positive_denominator| {
        let ratio =
            Ratio { numerator: vector(&[1.0, 0.0]), denominator: vector(&[0.0, 1.0]), positive_denominator };
        let quadratic = Quadratic::new(vector(&centre), &hessian).unwrap();
        quadratic.ratio_interval(&ratio, &[], THRESHOLD).unwrap()
    };
    for b in [2.0, -2.0] {
        let (r, g) = (1.5 / b, THRESHOLD * 0.2 / (b * b));
        let middle = r - g * 0.12 / 0.2;
        let inside = 0.5 - 2.0 * r * 0.12 + r * r * 0.2 - g * (0.5 - 0.12 * 0.12 / 0.2);
        let reach = (THRESHOLD * inside).sqrt() / b.abs();
        let found = interval([1.5, b], false);
        assert!((found.lower.unwrap() - (middle - reach) / (1.0 - g)).abs() < 1e-12);
        assert!((found.upper.unwrap() - (middle + reach) / (1.0 - g)).abs() < 1e-12);
    }
    assert_eq!(interval([1.5, 2.0], true), interval([1.5, 2.0], false));
    // A denominator that may be zero; on that line the numerator lies in 1.2 ± 1.1 or in 0.2 ± 1.1.
    assert_eq!(interval([1.5, 0.5], false), Interval { lower: None, upper: None });
    assert_eq!(interval([0.5, 0.5], true), Interval { lower: None, upper: None });
    let positive = interval([1.5, 0.5], true);
    assert!(positive.upper.is_none() && positive.lower.is_some_and(|lower| lower > 0.0), "{positive:?}");
    let negative = interval([-1.5, 0.5], true);
    assert!(negative.lower.is_none() && negative.upper.is_some_and(|upper| upper < 0.0), "{negative:?}");
}

/// Extremes over the points of a fine grid that the data and the constraints allow.
#[test]
fn intervals_agree_with_grids() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let steps = 500;
    let mut bounded = 0;
    for trial in 0..60 {
        let hessian = DMatrix::from_fn(2, 2, |i, j| if i == j { 4.0 } else { 3.0 * f64::from(trial).sin() });
        let centre = vector(&[rng.random_range(-1.0..1.0), rng.random_range(-0.2..2.0)]);
        let mut half_spaces = any_half_spaces(trial as usize % 4, 2, &mut rng);
        // The origin is allowed.
        half_spaces.iter_mut().for_each(|half| half.bound -= 0.6);
        let (a, b, positive_denominator) = (any(2, &mut rng), vector(&[0.1, 1.0]), trial % 3 > 0);
        let ratio = Ratio { numerator: a.clone(), denominator: b.clone(), positive_denominator };
        let quadratic = Quadratic::new(centre.clone(), &hessian).unwrap();
        let ratios = quadratic.ratio_interval(&ratio, &half_spaces, THRESHOLD).unwrap();
        if positive_denominator {
            half_spaces.push(HalfSpace { normal: b.clone(), bound: 0.0 });
        }
        let linear = quadratic.linear_interval(&a, &half_spaces, THRESHOLD).unwrap();
        let minimum = quadratic.minimise(&half_spaces, None).unwrap();
        let reach = (2.0 * (THRESHOLD + minimum.value)).sqrt();
        let (mut least, mut seen) = (f64::INFINITY, [None; 3]);
        for k in 0..(steps + 1) * (steps + 1) {
            let at = |k: i32| reach * (2.0 * f64::from(k) / f64::from(steps) - 1.0);
            let step = vector(&[at(k % (steps + 1)), at(k / (steps + 1))]);
            let (beta, value) = (&centre + &step, step.dot(&(&hessian * &step)));
            if half_spaces.iter().all(|half| half.normal.dot(&beta) >= half.bound) {
                least = value.min(least);
                if value <= minimum.value + THRESHOLD {
                    let (top, bottom) = (a.dot(&beta), b.dot(&beta));
                    seen.iter_mut().zip([top, bottom, top / bottom]).for_each(|(seen, x)| widen(seen, x));
                }
            }
        }
        let grid = 4.0 * reach / f64::from(steps);
        assert!(least > minimum.value - 1e-9 && least < minimum.value + 8.0 * grid * (1.0 + reach));
        let agree = |found: &Interval, [low, high]: [f64; 2], within: f64| {
            let (lower, upper) = (found.lower.unwrap(), found.upper.unwrap());
            let sound = lower <= low + 1e-9 && upper >= high - 1e-9;
            assert!(
                sound && low < lower + within && high > upper - within,
                "{trial}: {found:?} {low} {high}"
            );
        };
        let [top, bottom, quotient] = seen.map(Option::unwrap);
        agree(&linear, top, 3.0 * grid);
        let size = bottom[0].abs().min(bottom[1].abs());
        if bottom[0] * bottom[1] > 0.0 && size > 0.3 {
            bounded += 1;
            let largest = quotient[0].abs().max(quotient[1].abs());
            agree(&ratios, quotient, 4.0 * grid / size * (1.0 + largest));
        } else if bottom[0] < -grid && bottom[1] > grid {
            assert_eq!(ratios, Interval { lower: None, upper: None });
        }
    }
    assert!(bounded > 10, "{bounded}");
}

/// In four dimensions: the profile reaches the threshold at the ends, or no value beyond them is allowed.
#[test]
fn profiles_reach_the_threshold_at_the_ends() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mut checked = [0; 3];
    for trial in 0..200 {
        let hessian = any_hessian(4, &mut rng);
        let quadratic = Quadratic::new(any(4, &mut rng), &hessian).unwrap();
        let half_spaces = any_half_spaces(4, 4, &mut rng);
        // Far from what is allowed, changes of the profile drown in rounding.
        let minimum = quadratic.minimise(&half_spaces, None).filter(|minimum| minimum.value < 100.0);
        let Some(minimum) = minimum else { continue };
        // Every other numerator is itself bounded.
        let numerator = if trial % 2 == 0 { any(4, &mut rng) } else { half_spaces[0].normal.clone() };
        let (a, b) = (numerator, any(4, &mut rng));
        let excess = |normal: DVector<f64>, value: f64| {
            let plane = Hyperplane { normal, value };
            let profile = quadratic.minimise(&half_spaces, Some(&plane));
            profile.map_or(f64::INFINITY, |profile| profile.value - minimum.value - 1.0)
        };
        let linear = quadratic.linear_interval(&a, &half_spaces, 1.0).unwrap();
        let ratio = Ratio { numerator: a.clone(), denominator: b.clone(), positive_denominator: false };
        let ratios = quadratic.ratio_interval(&ratio, &half_spaces, 1.0).unwrap();
        let mut check = |kind: usize, ends: &Interval, excess: &dyn Fn(f64) -> f64| {
            let (Some(lower), Some(upper)) = (ends.lower, ends.upper) else { return };
            let width = upper - lower;
            for (end, outwards) in [(lower, -1.0), (upper, 1.0)] {
                let outside = excess(end + 1e-6 * outwards * width);
                let inside = excess(end - 1e-6 * outwards * width);
                assert!(outside > 0.0 && inside < 0.0, "{kind} {end}: {inside} {outside}");
                checked[kind] += 1;
                checked[2] += usize::from(outside.is_infinite());
            }
        };
        check(0, &linear, &|q| excess(a.clone(), q));
        check(1, &ratios, &|q| excess(&a - &b * q, 0.0));
    }
    assert!(checked[0] > 200 && checked[1] > 20 && checked[2] > 10, "{checked:?}");
}

#[test]
fn an_estimate_at_a_bound_has_an_interval_that_starts_there() {
    let hessian = DMatrix::from_row_slice(2, 2, &[3.0, 1.0, 1.0, 2.0]);
    let quadratic = Quadratic::new(vector(&[-0.4, 1.0]), &hessian).unwrap();
    let first = vector(&[1.0, 0.0]);
    let bound = [HalfSpace { normal: first.clone(), bound: 0.125 }];
    let minimum = quadratic.minimise(&bound, None).unwrap();
    assert_eq!(minimum.active, [0]);
    assert!((minimum.at[0] - 0.125).abs() < 1e-15);
    let found = quadratic.linear_interval(&first, &bound, THRESHOLD).unwrap();
    assert!((found.lower.unwrap() - 0.125).abs() < 1e-15);
    // (q + 0.4)² / V − (0.525)² / V = threshold, V = (H⁻¹)₀₀ = 2/5.
    let upper = (0.4 * THRESHOLD + 0.525f64.powi(2)).sqrt() - 0.4;
    assert!((found.upper.unwrap() - upper).abs() < 1e-14);
    // A bound of zero is met exactly, also by a ratio.
    let bound = [HalfSpace { normal: first.clone(), bound: 0.0 }];
    let found = quadratic.linear_interval(&first, &bound, 1.0).unwrap();
    assert_eq!(found.lower, Some(0.0));
    let ratio = Ratio { numerator: first, denominator: vector(&[0.3, 2.0]), positive_denominator: false };
    let found = quadratic.ratio_interval(&ratio, &bound, 0.5).unwrap();
    assert!(found.lower == Some(0.0) && found.upper.is_some_and(|upper| upper > 0.0), "{found:?}");
}

/// Two estimates with correlation 0.8, of which the first is known not to be negative.
#[test]
fn intervals_near_a_bound_cover_the_truth() {
    let variance = DMatrix::from_row_slice(2, 2, &[1.0, 0.8, 0.8, 1.0]);
    let hessian = variance.try_inverse().unwrap();
    let draws = 4000;
    let functionals = [vector(&[1.0, 0.0]), vector(&[0.0, 1.0])];
    let bound = [HalfSpace { normal: functionals[0].clone(), bound: 0.0 }];
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    for truth in [0.0, 0.5, 1.0, 2.0] {
        let mut covered = [0, 0];
        for _ in 0..draws {
            let (x, y) = (normal(&mut rng), normal(&mut rng));
            let quadratic = Quadratic::new(vector(&[truth + x, 0.3 + 0.8 * x + 0.6 * y]), &hessian).unwrap();
            for ((count, functional), truth) in covered.iter_mut().zip(&functionals).zip([truth, 0.3]) {
                let found = quadratic.linear_interval(functional, &bound, THRESHOLD).unwrap();
                let inside = found.lower.unwrap() <= truth && truth <= found.upper.unwrap();
                *count += usize::from(inside);
            }
        }
        let coverage = covered.map(|count| count as f64 / draws as f64);
        assert!(coverage.iter().all(|share| (0.94..=0.99).contains(share)), "{truth}: {coverage:?}");
    }
}
