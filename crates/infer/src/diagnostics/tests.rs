use super::sample::{Tissue, correlated, noise};
use super::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use voronudge_geometry::{Domain, Vector, quarter_turn};

/// Between 2 and 8 %: the rate in 800 tests of level 5 % has a standard deviation of 0.8 %.
fn is_five_percent(rejected: usize, of: usize) -> bool {
    let rate = rejected as f64 / of as f64;
    (0.02..=0.08).contains(&rate)
}

#[test]
fn white_noise_has_no_structure() {
    for tissue in [Tissue::periodic(8), Tissue::open(8)] {
        let mut generator = Pcg64::seed_from_u64(11);
        let identities: Vec<Vec<i64>> = vec![(0..64).collect(), (0..64).rev().collect()];
        let mut rejected = [0; 7];
        for seed in 0..800 {
            let [a, b] = [0, 1].map(|_| tissue.white(&mut generator));
            let frames = [tissue.field(&a), tissue.field(&b)];
            let found = structure(&frames, Some(&identities), seed);
            assert_eq!(found.tests.len(), 3);
            for (count, test) in rejected.iter_mut().zip(&found.tests) {
                *count += usize::from(test.p < 0.05);
            }
            rejected[3] += usize::from(found.is_significant());
            let handedness = correlations(&frames[..1], seed).handedness.unwrap();
            rejected[4] += usize::from(handedness.1 < 0.05);
            rejected[5] += usize::from(split(&frames[..1], seed).shares.is_some());
            rejected[6] += usize::from(!outliers(&frames).is_empty());
        }
        assert!(rejected.iter().all(|&count| is_five_percent(count, 800)), "{rejected:?}");
    }
}

#[test]
fn unequal_variances_and_heavy_tails_are_no_structure() {
    let tissue = Tissue::open(8);
    let mut generator = Pcg64::seed_from_u64(5);
    let mut rejected = 0;
    for seed in 0..400 {
        let field: Vec<Vector<f64>> = tissue
            .places
            .iter()
            .map(|r| noise(&mut generator) * (0.3 * r.x).exp() / noise(&mut generator).norm())
            .collect();
        rejected += usize::from(structure(&[tissue.field(&field)], None, seed).is_significant());
    }
    // Bonferroni is conservative where two tests see the same.
    assert!((4..=32).contains(&rejected), "{rejected}");
}

#[test]
fn a_smooth_tenth_of_the_variance_is_detected() {
    for tissue in [Tissue::periodic(12), Tissue::open(12)] {
        let mut generator = Pcg64::seed_from_u64(7);
        let wave =
            tissue.of(|r| 0.2f64.sqrt() * Vector::new((TAU * r.y / 12.0).sin(), (TAU * r.x / 12.0).cos()));
        let detected = (0..50).filter(|&seed| {
            let white = tissue.white(&mut generator);
            let field: Vec<Vector<f64>> =
                white.iter().zip(&wave).map(|(w, u)| 0.9f64.sqrt() * w + u).collect();
            structure(&[tissue.field(&field)], None, seed).is_significant()
        });
        let detected = detected.count();
        assert!(detected >= 40, "{detected}");
    }
}

#[test]
fn what_persists_is_seen_from_frame_to_frame() {
    let tissue = Tissue::periodic(8);
    let mut generator = Pcg64::seed_from_u64(3);
    let own = tissue.white(&mut generator);
    let fields: Vec<Vec<Vector<f64>>> = (0..3)
        .map(|_| own.iter().map(|u| 0.5 * u + 0.75f64.sqrt() * noise(&mut generator)).collect())
        .collect();
    // Later frames list the cells in another order.
    let order: Vec<usize> = (0..64).map(|i| (i * 5) % 64).collect();
    let shuffled: Vec<Vector<f64>> = order.iter().map(|&i| fields[1][i]).collect();
    let frames = [&fields[0], &shuffled, &fields[2]].map(|field| tissue.field(field));
    let identities: Vec<Vec<i64>> =
        vec![(0..64).collect(), order.iter().map(|&i| i as i64).collect(), (0..64).collect()];
    let found = structure(&frames, Some(&identities), 1);
    let successive = found.test(Kind::Successive).unwrap();
    assert!(successive.p < 0.01 && (successive.statistic - 0.25).abs() < 0.2, "{successive:?}");
    let wrong = vec![(0..64).collect(), (0..64).collect(), (0..64).collect()];
    assert!(structure(&frames, Some(&wrong), 1).test(Kind::Successive).unwrap().p > 0.05);
    assert!(structure(&frames, None, 1).test(Kind::Successive).is_none());
}

#[test]
fn rotation_is_curl_and_expansion_is_divergence() {
    let tissue = Tissue::open(10);
    let mut generator = Pcg64::seed_from_u64(2);
    let white = tissue.white(&mut generator);
    let middle = Vector::new(5.0, 4.5);
    let with_noise = |field: &dyn Fn(Vector<f64>) -> Vector<f64>| -> Vec<Vector<f64>> {
        tissue.places.iter().zip(&white).map(|(r, w)| field(r - middle) + 0.3 * w).collect()
    };
    let expansion = with_noise(&|r| 0.3 * r);
    let found = split(&[tissue.field(&expansion)], 1);
    assert!(found.shares.unwrap().divergence > 0.95, "{found:?}");
    // div = 0.6 everywhere
    assert!((found.divergence.power - 0.18).abs() < 0.04, "{found:?}");
    let rotation = with_noise(&|r| 0.3 * quarter_turn(r));
    let found = split(&[tissue.field(&rotation)], 1);
    assert!(found.shares.unwrap().curl > 0.95, "{found:?}");
    let shear = with_noise(&|r| 0.3 * Vector::new(r.x, -r.y));
    let found = split(&[tissue.field(&shear)], 1);
    assert!(found.shear.p < 0.01 && found.shear.power > 0.1 && found.divergence.p > 0.01, "{found:?}");
    let exact = tissue.of(|r| Vector::new(2.0, 1.0) + 0.2 * quarter_turn(*r));
    let map = &maps(&[tissue.field(&exact)])[0];
    let gradients = map.iter().filter_map(|local| local.gradient);
    assert!(gradients.clone().count() > 80);
    assert!(gradients.clone().all(|[div, curl]| div.abs() < 1e-9 && (curl - 0.4).abs() < 1e-9));
}

#[test]
fn a_wave_is_split_like_its_direction() {
    let tissue = Tissue::periodic(12);
    let mut generator = Pcg64::seed_from_u64(9);
    let white = tissue.white(&mut generator);
    for (direction, divergence) in [(Vector::new(1.0, 0.0), 1.0), (Vector::new(0.0, 1.0), 0.0)] {
        let field: Vec<Vector<f64>> = tissue
            .places
            .iter()
            .zip(&white)
            .map(|(r, w)| direction * (TAU * r.x / 12.0).sin() + 0.2 * w)
            .collect();
        let shares = split(&[tissue.field(&field)], 1).shares.unwrap();
        assert!((shares.divergence - divergence).abs() < 0.1, "{shares:?}");
    }
}

#[test]
fn the_correlation_length_is_that_of_the_field() {
    for (tissue, length) in [(Tissue::open(18), 1.5), (Tissue::open(18), 3.0)] {
        let root = tissue.root_of_exponential(length);
        let mut generator = Pcg64::seed_from_u64(4);
        let fields: Vec<Vec<Vector<f64>>> = (0..8)
            .map(|_| {
                let field = correlated(&root, &mut generator);
                field.iter().map(|u| 0.7f64.sqrt() * u + 0.3f64.sqrt() * noise(&mut generator)).collect()
            })
            .collect();
        let frames: Vec<ResidualField<'_>> = fields.iter().map(|field| tissue.field(field)).collect();
        let found = correlations(&frames, 1);
        let CorrelationLength::Known { length: found, amplitude } = found.length else {
            panic!("{:?}", found.length);
        };
        assert!((found / length - 1.0).abs() < 0.25, "{found} for {length}");
        assert!((amplitude - 0.7).abs() < 0.15, "{amplitude}");
    }
    let tissue = Tissue::open(10);
    let white = tissue.white(&mut Pcg64::seed_from_u64(1));
    assert_eq!(correlations(&[tissue.field(&white)], 1).length, CorrelationLength::NoCorrelation);
    let drift = tissue.of(|_| Vector::new(1.0, 0.5));
    assert!(matches!(correlations(&[tissue.field(&drift)], 1).length, CorrelationLength::LongerThan(_)));
}

#[test]
fn standard_errors_of_white_noise_are_right() {
    let tissue = Tissue::periodic(12);
    let mut generator = Pcg64::seed_from_u64(6);
    let (mut square, mut count) = (0.0, 0);
    for seed in 0..60 {
        let white = tissue.white(&mut generator);
        for bin in correlations(&[tissue.field(&white)], seed).bins {
            for c in [bin.longitudinal, bin.transverse, bin.chiral, bin.total] {
                square += (c.value / c.standard_error).powi(2);
                count += 1;
            }
        }
    }
    let ratio = square / f64::from(count);
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
}

/// Places where something pushes and turns at once, and what is around them.
fn spirals(tissue: &Tissue) -> Vec<Vector<f64>> {
    let sources: Vec<Vector<f64>> = tissue.places.iter().step_by(17).copied().collect();
    let around = |r: &Vector<f64>, (number, source): (usize, &Vector<f64>)| {
        let d = tissue.domain.shortest(r - source);
        let sign = if number % 2 == 0 { 1.0 } else { -1.0 };
        sign * (d + quarter_turn(d)) * (-0.5 * d.norm_squared()).exp()
    };
    tissue.of(|r| sources.iter().enumerate().map(|source| around(r, source)).sum())
}

fn assert_same(a: Correlation, b: Correlation, factor: f64) {
    assert!((a.value - factor * b.value).abs() < 1e-9, "{a:?} {b:?}");
}

#[test]
fn a_mirror_changes_the_sign_of_the_chiral_function_and_nothing_else() {
    let tissue = Tissue::periodic(12);
    let field = spirals(&tissue);
    let mirror = |r: &Vector<f64>| Vector::new(r.x, -r.y);
    let mirrored = Tissue { places: tissue.places.iter().map(mirror).collect(), domain: tissue.domain };
    let image: Vec<Vector<f64>> = field.iter().map(mirror).collect();
    let [original, reflected] =
        [tissue.field(&field), mirrored.field(&image)].map(|frame| correlations(&[frame], 1));
    assert!(original.bins.len() > 4);
    assert!(original.bins.iter().any(|bin| bin.chiral.value.abs() > 0.1), "{:?}", original.bins);
    for (a, b) in original.bins.iter().zip(&reflected.bins) {
        assert_same(a.longitudinal, b.longitudinal, 1.0);
        assert_same(a.transverse, b.transverse, 1.0);
        assert_same(a.chiral, b.chiral, -1.0);
    }
    let [a, b] = [&original, &reflected].map(|found| found.handedness.unwrap());
    assert!(a.1 < 0.01 && b.1 < 0.01 && (a.0 + b.0).abs() < 1e-9, "{a:?} {b:?}");
    assert_eq!(original.length, reflected.length);
}

#[test]
fn a_rotation_of_the_axes_changes_nothing() {
    let tissue = Tissue::open(10);
    let white = tissue.white(&mut Pcg64::seed_from_u64(8));
    let field: Vec<Vector<f64>> = spirals(&tissue).iter().zip(&white).map(|(u, w)| u + 0.2 * w).collect();
    // A right angle, since blocks and reach follow the axes.
    let turned = Tissue { places: tissue.of(|r| quarter_turn(*r)), domain: Domain::Open };
    let turned_field: Vec<Vector<f64>> = field.iter().map(|u| quarter_turn(*u)).collect();
    let [a, b] = [tissue.field(&field), turned.field(&turned_field)].map(|f| diagnose(&[f], None, 1));
    for (a, b) in a.correlations.bins.iter().zip(&b.correlations.bins) {
        assert_same(a.longitudinal, b.longitudinal, 1.0);
        assert_same(a.transverse, b.transverse, 1.0);
        assert_same(a.chiral, b.chiral, 1.0);
        assert!((a.total.standard_error - b.total.standard_error).abs() < 1e-9);
    }
    for (a, b) in a.structure.tests.iter().zip(&b.structure.tests) {
        assert!((a.statistic - b.statistic).abs() < 1e-9 && (a.p - b.p).abs() < 1e-9);
    }
    assert!((a.split.divergence.power - b.split.divergence.power).abs() < 1e-9);
    assert!((a.split.curl.power - b.split.curl.power).abs() < 1e-9);
}

#[test]
fn implanted_outliers_are_found_with_their_cause() {
    let tissue = Tissue::open(9);
    let mut field = tissue.white(&mut Pcg64::seed_from_u64(12));
    let mut areas = vec![1.0; 81];
    let mut velocities = field.clone();
    let other = tissue.field(&field).neighbours()[60][0] as usize;
    for (cell, residual) in [(20, [9.0, 0.0]), (40, [0.0, 8.0]), (60, [7.0, 1.0]), (other, [-7.0, -1.0])] {
        field[cell] = Vector::from(residual);
    }
    areas[20] = 2.0;
    areas[60] = 0.5;
    areas[other] = 0.45;
    velocities[40] = Vector::new(0.0, 12.0);
    let cells = CellData { areas: &areas, velocities: &velocities };
    let found = outliers(&[tissue.field(&field).with_cells(0, cells).unwrap()]);
    let cause = |cell: usize| found.iter().find(|outlier| outlier.index == cell).unwrap().cause;
    assert_eq!(found.len(), 4, "{found:?}");
    assert_eq!(cause(20), Cause::Merged);
    assert_eq!(cause(40), Cause::MisTracked);
    assert_eq!(cause(60), Cause::Split { with: other });
    assert_eq!(cause(other), Cause::Split { with: 60 });
    assert!(found.iter().all(|outlier| outlier.z > 5.0 && outlier.p < 0.05));
    let unknown = outliers(&[tissue.field(&field)]);
    assert!(unknown.len() == 4 && unknown.iter().all(|outlier| outlier.cause == Cause::Unknown));
}

#[test]
fn the_answer_belongs_to_the_seed() {
    let tissue = Tissue::periodic(6);
    let white = tissue.white(&mut Pcg64::seed_from_u64(13));
    let answer = |seed| diagnose(&[tissue.field(&white), tissue.field(&white)], None, seed);
    assert_eq!(answer(3), answer(3));
    assert_eq!(answer(3).residuals, 72);
    assert!((answer(3).variance_ratio - 1.0).abs() < 0.5);
    assert_eq!(answer(3).maps[1].len(), 36);
}

#[test]
fn nothing_and_zeros_are_no_structure() {
    let tissue = Tissue::open(4);
    let zero = tissue.of(|_| Vector::zeros());
    for frames in [vec![], vec![tissue.field(&zero)]] {
        let found = diagnose(&frames, None, 1);
        assert!(found.structure.tests.is_empty() && !found.structure.is_significant());
        assert!(found.correlations.bins.is_empty() && found.outliers.is_empty());
        assert!(found.split.shares.is_none());
    }
}

#[test]
fn unusable_fields_are_refused() {
    let tissue = Tissue::open(4);
    let short = [Vector::zeros(); 3];
    let mut holes = vec![Vector::zeros(); 16];
    let new = |residuals: &[Vector<f64>], standard: f64| {
        ResidualField::new(2, &tissue.places, residuals, tissue.domain, standard).map(|_| ()).unwrap_err()
    };
    assert_eq!(new(&short, 1.0), crate::Error::Lengths { frame: 2, positions: 16, velocities: 3 });
    assert!(matches!(new(&holes, 0.0), crate::Error::Noise { name: "expected", .. }));
    holes[3].x = f64::NAN;
    assert!(matches!(new(&holes, 1.0), crate::Error::Noise { name: "residual", .. }));
}
