//! Centres of cells as extrema of a field.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{PeriodicBox, Vector, honeycomb};
use voronudge_segmentation::{Edge, Error, Extremum, ExtremumKind, ExtremumSearch, extrema};

const SEARCH: ExtremumSearch = ExtremumSearch {
    kind: ExtremumKind::Maximum,
    smoothing: 0.0,
    prominence: 0.2,
    distance: 0.0,
    edge: Edge::Periodic,
};

/// Gaussian bumps of standard deviation 4 on a distorted honeycomb of spacing 17, periodic.
fn bumps() -> (Vec<f64>, [usize; 2], Vec<Vector<f64>>) {
    let (lattice, lengths) = honeycomb(6, 6);
    let size = [102, 88];
    let scale = Vector::new(size[0] as f64 / lengths[0], size[1] as f64 / lengths[1]);
    let place = |(k, r): (usize, &Vector<f64>)| {
        let shake = Vector::new((3.0 * k as f64).sin(), (5.0 * k as f64).cos()) * 1.3;
        r.component_mul(&scale) + Vector::new(8.0, 7.0) + shake
    };
    let centres: Vec<Vector<f64>> = lattice.iter().enumerate().map(place).collect();
    let nearest = |x: f64, length: usize| x - length as f64 * (x / length as f64).round();
    let field = (0..size[0] * size[1])
        .map(|k| {
            let r = Vector::new((k % size[0]) as f64 + 0.5, (k / size[0]) as f64 + 0.5);
            let bump = |c: &Vector<f64>| {
                let d = r - c;
                (-(nearest(d.x, size[0]).powi(2) + nearest(d.y, size[1]).powi(2)) / 32.0).exp()
            };
            centres.iter().map(bump).sum()
        })
        .collect();
    (field, size, centres)
}

/// Distance from each centre to the extremum found nearest to it, the largest.
fn largest_distance(found: &[Extremum], centres: &[Vector<f64>], size: [usize; 2]) -> f64 {
    let field = PeriodicBox::new(size.map(|side| side as f64)).unwrap();
    let distance = |c: &Vector<f64>| {
        found.iter().map(|e| field.shortest(e.position - c).norm()).fold(f64::INFINITY, f64::min)
    };
    centres.iter().map(distance).fold(0.0, f64::max)
}

/// The nearest true maximum: where the gradient of the sum of bumps vanishes, which is not where the centres are if they overlap.
fn true_maximum(centres: &[Vector<f64>], start: Vector<f64>, size: [usize; 2]) -> Vector<f64> {
    let field = PeriodicBox::new(size.map(|side| side as f64)).unwrap();
    let mut r = start;
    // Mean shift climbs a sum of Gaussians.
    for _ in 0..200 {
        let (mut sum, mut weight) = (Vector::zeros(), 0.0);
        for c in centres {
            let d = field.shortest(c - r);
            let w = (-d.norm_squared() / 32.0).exp();
            sum += d * w;
            weight += w;
        }
        r += sum / weight;
    }
    r
}

#[test]
fn a_lattice_of_bumps_is_found_to_a_hundredth_of_a_pixel() {
    let (field, size, centres) = bumps();
    let found = extrema(&field, size, &SEARCH).unwrap();
    assert_eq!(found.len(), 36);
    let maxima: Vec<Vector<f64>> = centres.iter().map(|&c| true_maximum(&centres, c, size)).collect();
    let error = largest_distance(&found, &maxima, size);
    assert!(error < 1e-2, "{error}");
    // Upside down the same places are minima.
    let negative: Vec<f64> = field.iter().map(|x| -x).collect();
    let minima = extrema(&negative, size, &ExtremumSearch { kind: ExtremumKind::Minimum, ..SEARCH }).unwrap();
    assert_eq!(
        minima.iter().map(|e| e.position).collect::<Vec<_>>(),
        found.iter().map(|e| e.position).collect::<Vec<_>>()
    );
    assert_eq!(minima[0].value, -found[0].value);
}

/// Noise of a tenth of the height makes hundreds of maxima; smoothing and prominence leave the true ones.
#[test]
fn noise_is_told_from_cells() {
    let (mut field, size, centres) = bumps();
    let mut random = Pcg64Mcg::seed_from_u64(3);
    field.iter_mut().for_each(|x| *x += 0.17 * (random.random::<f64>() * 2.0 - 1.0));
    let all = extrema(&field, size, &ExtremumSearch { prominence: 0.0, ..SEARCH }).unwrap();
    assert!(all.len() > 300, "{}", all.len());
    let found = extrema(&field, size, &ExtremumSearch { smoothing: 2.0, ..SEARCH }).unwrap();
    assert_eq!(found.len(), 36);
    let error = largest_distance(&found, &centres, size);
    assert!(error < 0.6, "{error}");
    // The distance alone does it too, if less well.
    let spaced = extrema(&field, size, &ExtremumSearch { prominence: 0.0, distance: 9.0, ..SEARCH }).unwrap();
    assert!(spaced.len() < 100);
}

#[test]
fn a_plateau_is_one_place() {
    let size = [20, 12];
    let field: Vec<f64> = (0..240)
        .map(|k| if (4..9).contains(&(k % 20)) && (3..6).contains(&(k / 20)) { 2.0 } else { 0.0 })
        .collect();
    let found = extrema(&field, size, &ExtremumSearch { edge: Edge::Open, ..SEARCH }).unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].position, found[0].prominence), (Vector::new(6.5, 4.5), 2.0));
    // A constant field has one plateau, which has no prominence.
    assert!(extrema(&[1.0; 240], size, &SEARCH).unwrap().is_empty());
}

/// Prominence is the height above the saddle towards something higher.
#[test]
fn prominence_is_measured_from_the_saddle() {
    let row = [0.0, 5.0, 2.0, 4.0, 0.5, 3.0, 0.0];
    let field: Vec<f64> = (0..21).map(|k| if k / 7 == 1 { row[k % 7] } else { -1.0 }).collect();
    let search = ExtremumSearch { edge: Edge::Open, prominence: 0.0, ..SEARCH };
    let found = extrema(&field, [7, 3], &search).unwrap();
    assert_eq!(found.iter().map(|e| e.prominence).collect::<Vec<_>>(), [6.0, 2.5, 2.0]);
}

#[test]
fn a_maximum_at_an_open_edge_is_left_out() {
    let field: Vec<f64> = (0..100).map(|k| -(((k % 10) as f64) + (k as f64 / 10.0 - 5.0).powi(2))).collect();
    assert!(extrema(&field, [10, 10], &ExtremumSearch { edge: Edge::Open, ..SEARCH }).unwrap().is_empty());
    assert!(matches!(extrema(&field, [10, 11], &SEARCH), Err(Error::Raster { .. })));
}
