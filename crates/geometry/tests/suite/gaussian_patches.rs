//! Gaussian patches over polygons and along sides that are known.

use std::f64::consts::{PI, TAU};
use voronudge_geometry::{Domain, Grid, Patch, Tessellation, Vector, cross, dot, overlaps, side_pieces};

/// A Gaussian around the origin.
fn patch(width: f64) -> Grid {
    Grid::new([0.0; 2], [1.0; 2], [1, 1]).unwrap().with_patch(Patch::Gaussian(width))
}

/// `∫ exp(−x²/2s²) dA` over a convex polygon, and its derivative by s: the polygon is the cell of a point in it whose mirror images in the sides
/// are its neighbours.
fn polygon_area(polygon: &[Vector<f64>], width: f64) -> [f64; 2] {
    let centre = polygon.iter().sum::<Vector<f64>>() / polygon.len() as f64;
    let after = polygon.iter().cycle().skip(1);
    let mirrored = polygon.iter().zip(after).map(|(p, q)| {
        let along = (q - p).normalize();
        let foot = p + along * along.dot(&(centre - p));
        foot * 2.0 - centre
    });
    let positions: Vec<Vector<f64>> = std::iter::once(centre).chain(mirrored).collect();
    let tessellation = Tessellation::new(&positions, Domain::Open).unwrap();
    assert_eq!(tessellation.ring(0).len(), polygon.len());
    let found = overlaps(&tessellation, &positions, &patch(width));
    let [own] = found.square(0) else { panic!("one cell is closed") };
    assert_eq!(own.cell, 0);
    [own.area, own.by_width]
}

/// Over a large square, and over a part of the plane, against sums over a fine mesh.
#[test]
fn areas_are_those_of_a_fine_mesh() {
    let width = 0.7;
    let square = [[-9.0, -8.0], [8.0, -8.0], [8.0, 9.0], [-9.0, 9.0]].map(|[x, y]| Vector::new(x, y));
    let [all, growth] = polygon_area(&square, width);
    assert!((all / (TAU * width * width) - 1.0).abs() < 1e-9, "{all}");
    assert!((growth / (2.0 * TAU * width) - 1.0).abs() < 1e-9, "{growth}");
    let triangle = [[0.2, -0.6], [1.4, 0.3], [-0.3, 0.8]].map(|[x, y]| Vector::new(x, y));
    let inside =
        |x: Vector<f64>| (0..3).all(|k| cross(triangle[(k + 1) % 3] - triangle[k], x - triangle[k]) > 0.0);
    let mesh = 2000;
    let at = |k: i32| -1.0 + 3.0 * (f64::from(k) + 0.5) / f64::from(mesh);
    let mut expected = 0.0;
    for (ix, iy) in (0..mesh).flat_map(|ix| (0..mesh).map(move |iy| (ix, iy))) {
        let x = Vector::new(at(ix), at(iy));
        if inside(x) {
            expected += (-0.5 * dot(x, x) / (width * width)).exp() * (3.0 / f64::from(mesh)).powi(2);
        }
    }
    let [found, slope] = polygon_area(&triangle, width);
    assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    let [above, below] = [1e-5, -1e-5].map(|step| polygon_area(&triangle, width + step)[0]);
    assert!((slope - (above - below) / 2e-5).abs() < 1e-8);
}

/// Along the sides of a polygon of many of them u = x²/2s² hardly differs: what a side has a share of, `(1 − e⁻ᵘ)/2u`, is known to all digits for each
/// u, small or large.
#[test]
fn shares_join_smoothly() {
    const SIDES: usize = 64;
    for u in [1e-9, 1e-4, 9.999e-3, 1.0001e-2, 0.3, 5.0, 36.9, 400.0] {
        // The middles of the sides are at u.
        let radius = f64::sqrt(2.0 * u) / (PI / SIDES as f64).cos();
        let corner = |k: usize| {
            let angle = (2.0 * k as f64 + 1.0) * PI / SIDES as f64;
            Vector::new(angle.cos(), angle.sin()) * radius
        };
        let polygon: Vec<Vector<f64>> = (0..SIDES).map(corner).collect();
        let [found, _] = polygon_area(&polygon, 1.0);
        let [p, q] = [polygon[0], polygon[1]];
        let share = |t: f64| {
            let u = 0.5 * (p + (q - p) * t).norm_squared();
            -f64::exp_m1(-u) / (2.0 * u)
        };
        // Simpson's rule.
        let steps = 200;
        let mean = (0..steps).map(|k| {
            let [start, middle, end] =
                [0.0, 0.5, 1.0].map(|part| share((f64::from(k) + part) / f64::from(steps)));
            (start + 4.0 * middle + end) / 6.0
        });
        let expected = SIDES as f64 * cross(p, q) * mean.sum::<f64>() / f64::from(steps);
        assert!((found / expected - 1.0).abs() < 1e-13, "{u}: {found} {expected}");
    }
}

/// Of a side from −6 to 6, between two cells, which two others end.
#[test]
fn lines_have_the_weight_of_their_points() {
    let (y, half, beside) = (0.4, 6.0, 3.0);
    let end = half + f64::hypot(half, beside);
    let positions =
        [[0.0, y - beside], [0.0, y + beside], [end, y], [-end, y], [0.0, y - 20.0]].map(Vector::from);
    let tessellation = Tessellation::new(&positions, Domain::Open).unwrap();
    let pieces = side_pieces(&tessellation, &positions, &patch(0.8));
    let piece = pieces.square(0).iter().find(|piece| (piece.cell, piece.neighbour) == (0, 1)).unwrap();
    let (weight, mean) = (piece.length, positions[0] + piece.from_cell);
    let expected = 0.8 * TAU.sqrt() * (-0.5 * (0.4f64 / 0.8).powi(2)).exp();
    assert!((weight - expected).abs() < 1e-9, "{weight} {expected}");
    assert!((mean - Vector::new(0.0, 0.4)).norm() < 1e-9);
}
