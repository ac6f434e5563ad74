//! Cells of label images.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::PI;
use voronudge_geometry::{Vector, cross};
use voronudge_segmentation::{Error, Mask, Outline};

const SIDE: usize = 90;

/// A mask whose pixels have the label that their centre has.
fn drawn(label: impl Fn(Vector<f64>) -> i64) -> Vec<i64> {
    let centre = |k: usize| Vector::new((k % SIDE) as f64 + 0.5, (k / SIDE) as f64 + 0.5);
    (0..SIDE * SIDE).map(|k| label(centre(k))).collect()
}

fn hexagon(centre: Vector<f64>, side: f64, turn: f64) -> Vec<Vector<f64>> {
    let corner = |k: usize| {
        let angle = turn + k as f64 * PI / 3.0;
        centre + Vector::new(angle.cos(), angle.sin()) * side
    };
    (0..6).map(corner).collect()
}

fn inside(corners: &[Vector<f64>], r: Vector<f64>) -> bool {
    (0..corners.len()).all(|k| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        cross(b - a, r - a) >= 0.0
    })
}

/// Mean and largest error of the perimeter, relative, over some places and directions of a shape.
fn bias(shape: impl Fn(Vector<f64>, f64) -> (Box<dyn Fn(Vector<f64>) -> bool>, f64)) -> [f64; 2] {
    let (mut sum, mut largest, mut count) = (0.0, 0.0_f64, 0.0);
    for k in 0..24 {
        let place = Vector::new(45.0 + (0.37 * k as f64).fract(), 45.0 + (0.71 * k as f64).fract());
        let (contains, perimeter) = shape(place, k as f64 * PI / 72.0);
        let labels = drawn(|r| i64::from(contains(r)));
        let error = Mask::new(&labels, [SIDE, SIDE]).unwrap().cells()[0].perimeter / perimeter - 1.0;
        sum += error;
        largest = largest.max(error.abs());
        count += 1.0;
    }
    [sum / count, largest]
}

/// Discs come out right; hexagons lose a little at each corner, which steps of more than one pixel cut.
///
/// Mean and largest error measured: discs of radius 5, 10, 20, 40: −0.5, −0.2, −0.0, −0.0 % and 1.4, 1.2, 0.5, 0.3 %; hexagons of side 5,
/// 10, 20, 40: −3.7, −1.3, −1.0, −0.4 % and 6.4, 3.7, 2.7, 1.6 %.
#[test]
fn perimeters_of_discs_and_hexagons() {
    for radius in [5.0, 10.0, 20.0, 40.0] {
        let [mean, largest] =
            bias(|place, _| (Box::new(move |r| (r - place).norm() < radius), 2.0 * PI * radius));
        assert!(mean.abs() < 0.005, "disc of radius {radius}: {mean:.4}");
        assert!(largest < 0.3 / radius, "disc of radius {radius}: {largest:.4}");
        let [mean, largest] = bias(|place, turn| {
            let corners = hexagon(place, radius, turn);
            (Box::new(move |r| inside(&corners, r)), 6.0 * radius)
        });
        assert!(mean.abs() < 0.005 + 0.18 / radius, "hexagon of side {radius}: {mean:.4}");
        assert!(largest < 0.015 + 0.3 / radius, "hexagon of side {radius}: {largest:.4}");
    }
}

#[test]
fn a_straight_side_is_at_most_two_percent_off() {
    let half_plane = |turn: f64| {
        let along = Vector::new(turn.cos(), turn.sin());
        // A strip, long enough that its ends count little: its sides are all there is to tell.
        drawn(move |r| {
            i64::from(
                cross(along, r - Vector::new(45.0, 45.0)).abs() < 8.0
                    && (r - Vector::new(45.0, 45.0)).norm() < 42.0,
            )
        })
    };
    for k in 0..12 {
        let labels = half_plane(k as f64 * PI / 24.0);
        let cell = Mask::new(&labels, [SIDE, SIDE]).unwrap().cells()[0];
        let expected = 4.0 * (42f64.powi(2) - 64.0).sqrt() + 4.0 * 42.0 * (8f64 / 42.0).asin();
        assert!((cell.perimeter / expected - 1.0).abs() < 0.025, "{k}: {}", cell.perimeter / expected);
    }
}

#[test]
fn centroid_area_border_and_pieces() {
    let corners = hexagon(Vector::new(40.3, 50.8), 17.0, 0.2);
    let outline = Outline::new(&corners).unwrap();
    let labels = drawn(|r| {
        if inside(&corners, r) {
            7
        } else if r.x < 3.0 && r.y < 5.0 || r.x > 80.0 && r.y > 85.0 {
            9
        } else {
            0
        }
    });
    let cells = Mask::new(&labels, [SIDE, SIDE]).unwrap().cells();
    assert_eq!(
        cells.iter().map(|cell| (cell.label, cell.at_border, cell.pieces)).collect::<Vec<_>>(),
        [(7, false, 1), (9, true, 2)]
    );
    assert!((cells[0].centroid - outline.centroid).norm() < 0.05);
    assert!((cells[0].area / outline.area - 1.0).abs() < 0.01);
}

/// Two halves with a line of background between them, upright or oblique.
#[test]
fn contacts_across_a_line() {
    let upright = drawn(|r| {
        if r.x < 40.0 {
            3
        } else if r.x < 41.0 {
            0
        } else {
            2
        }
    });
    let oblique = drawn(|r| match (r.x - r.y).round() as i64 {
        0 => 0,
        k if k < 0 => 5,
        _ => 4,
    });
    let contacts = |labels: &[i64], gap| {
        Mask::new(labels, [SIDE, SIDE]).unwrap().contacts(gap).into_iter().collect::<Vec<_>>()
    };
    assert_eq!(contacts(&upright, 0), Vec::<[i64; 2]>::new());
    assert_eq!(contacts(&upright, 1), [[2, 3]]);
    assert_eq!(contacts(&oblique, 0), Vec::<[i64; 2]>::new());
    assert_eq!(contacts(&oblique, 2), [[4, 5]]);
    assert!(matches!(Mask::new(&upright, [SIDE, SIDE + 1]), Err(Error::Raster { rows: 91, .. })));
}

/// A straight outline is one segment for each side.
#[test]
fn outlines_are_merged_into_segments() {
    let labels = drawn(|r| i64::from((20.0..30.0).contains(&r.x) && (10.0..40.0).contains(&r.y)));
    let segments = Mask::new(&labels, [SIDE, SIDE]).unwrap().outlines();
    assert_eq!(segments.len(), 4);
    assert_eq!(segments.iter().map(|[a, b]| (b - a).norm()).sum::<f64>(), 80.0);
}

/// Pieces counted by filling each from one of its pixels.
#[test]
fn pieces_are_those_of_a_flood() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    for _ in 0..200 {
        let size = [random.random_range(1..14), random.random_range(1..14)];
        let labels: Vec<i64> = (0..size[0] * size[1]).map(|_| random.random_range(0..3)).collect();
        let cells = Mask::new(&labels, size).unwrap().cells();
        let mut left = labels.clone();
        let mut pieces = std::collections::BTreeMap::new();
        for first in 0..left.len() {
            let label = left[first];
            if label != 0 {
                *pieces.entry(label).or_insert(0) += 1;
                let mut stack = vec![first];
                while let Some(index) = stack.pop() {
                    left[index] = 0;
                    let near = |other: &usize| {
                        (other % size[0]).abs_diff(index % size[0]) <= 1
                            && (other / size[0]).abs_diff(index / size[0]) <= 1
                    };
                    stack.extend((0..left.len()).filter(|other| left[*other] == label && near(other)));
                }
            }
        }
        assert_eq!(
            cells.iter().map(|cell| (cell.label, cell.pieces)).collect::<Vec<_>>(),
            pieces.into_iter().collect::<Vec<_>>()
        );
    }
}

/// Two half-planes parted by a straight line, with and without a line of background between them.
#[test]
fn a_straight_line_between_two_labels_is_found() {
    let size = 60_usize;
    for angle in [0.3, 0.8, 1.2, 2.5] {
        let normal = Vector::new(f64::cos(angle), f64::sin(angle));
        for (width, gap) in [(0.0, 0), (1.4, 2)] {
            let labels: Vec<i64> = (0..size * size)
                .map(|k| Vector::new((k % size) as f64 - 29.5, (k / size) as f64 - 29.5))
                .map(|r| match normal.dot(&r) + 0.3 {
                    _ if r.norm() > 20.0 => 0,
                    across if across.abs() < 0.5 * width => 0,
                    across if across < 0.0 => 5,
                    _ => 9,
                })
                .collect();
            let mask = Mask::new(&labels, [size, size]).unwrap();
            let index = |label| [5, 9].iter().position(|known| *known == label);
            let found = mask.interfaces(gap, index);
            assert_eq!((found.len(), found[0].cells), (1, [0, 1]));
            let line = found[0];
            let off = normal.dot(&(line.middle - Vector::new(30.0, 30.0))) + 0.3;
            assert!(off.abs() < 0.12, "{angle} {width}: off by {off}");
            assert!((line.length / 40.0 - 1.0).abs() < 0.1, "{angle} {width}: {}", line.length);
            let extent = line.extent.norm() / (40.0 / 12f64.sqrt());
            assert!((extent - 1.0).abs() < 0.08, "{angle} {width}: {extent}");
            assert!(line.extent.normalize().dot(&normal).abs() < 0.02);
            assert!(mask.interfaces(gap, |_| None).is_empty());
        }
    }
}
