//! The hand-written derivatives of the geometry.

use super::sample::Sample;
use super::{Axis, Comparison, GEOMETRY, GradientRow, Place, Quantity};
use num_dual::DualSVec64;
use voronudge_geometry::{CellPolygon, Corner, Scalar, Vector, circumcentre, cross, dot};

/// Derivatives by two points of the plane.
type Dual = DualSVec64<4>;

fn seeded(point: Vector<f64>, first: usize) -> Vector<Dual> {
    Vector::new(Dual::from_re(point.x).derivative(first), Dual::from_re(point.y).derivative(first + 1))
}

fn gradient(value: Dual, first: usize) -> Vector<f64> {
    value.eps.0.map_or(Vector::zeros(), |eps| Vector::new(eps[first], eps[first + 1]))
}

/// Largest rounding of a vertex, relative to the side whose direction is taken from it.
const SIDE_ROUNDING: f64 = 1e-11;

/// Smallest sine of the angle of a triangle whose circumcentre is differentiated: rounding grows with its inverse square.
const THINNEST: f64 = 1e-5;

/// The rows of the displaced cells' polygons.
pub(super) fn rows(sample: &Sample) -> Vec<GradientRow> {
    let mut areas = Comparison::new();
    let mut perimeters = Comparison::new();
    let mut vertices = Comparison::new();
    let mut polygon = CellPolygon::default();
    for &cell in sample.displaced.iter().filter(|&&cell| sample.tessellation.is_closed(cell)) {
        polygon.fill(&sample.tessellation, &sample.positions, cell);
        let sides = polygon.len();
        let points: Vec<Vector<f64>> = polygon.vertices().collect();
        let lengths: Vec<f64> = polygon.side_lengths().collect();
        for (m, corner) in polygon.corners().iter().enumerate() {
            let place = |axis| Place::Corner { cell, corner: m, axis };
            let mut free: Vec<Vector<Dual>> = voronudge_geometry::lift(&points);
            free[m] = seeded(points[m], 0);
            areas.add_vector(polygon.area_gradient(m), gradient(shoelace(&free), 0), place);
            // The direction of a side is not to be had from end points that coincide but for rounding.
            let (previous, next) = ((m + sides - 1) % sides, (m + 1) % sides);
            let uncertain = [previous, m, next].map(|k| uncertainty(&polygon.corners()[k]));
            let shortest = uncertain.into_iter().fold(0.0, f64::max) / SIDE_ROUNDING;
            if lengths[m] > shortest && lengths[next] > shortest {
                perimeters.add_vector(
                    polygon.perimeter_gradient(m),
                    gradient(circumference(&free, m), 0),
                    place,
                );
            }
            if cross(corner.a, corner.b) < THINNEST * corner.a.norm() * corner.b.norm() {
                continue;
            }
            let centre = circumcentre(seeded(corner.a, 0), seeded(corner.b, 2));
            for component in Axis::BOTH {
                let at = component.index();
                let unit = Vector::new((1 - at) as f64, at as f64);
                let [on_a, on_b] = corner.pull_back(unit);
                vertices.add_vector(on_a, gradient(centre[at], 0), place);
                vertices.add_vector(on_b, gradient(centre[at], 2), place);
            }
        }
    }
    [
        areas.row(GEOMETRY, Quantity::AreaGradient),
        perimeters.row(GEOMETRY, Quantity::PerimeterGradient),
        vertices.row(GEOMETRY, Quantity::VertexMotion),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Rounding of a vertex: large where the triangle is thin.
fn uncertainty(corner: &Corner<f64>) -> f64 {
    let (a, b) = (corner.a.norm(), corner.b.norm());
    f64::EPSILON * a * b * (a + b) / cross(corner.a, corner.b).abs()
}

/// `½ Σ c_m × c_{m+1}` for vertices that are free to move.
fn shoelace<S: Scalar>(vertices: &[Vector<S>]) -> S {
    let sum = pairs(vertices).fold(S::constant(0.0), |sum, (c, next)| sum + cross(c, next));
    sum * 0.5
}

/// `Σ |c_{m+1} − c_m|` over the two sides at vertex `m`: the others do not change with it.
fn circumference<S: Scalar>(vertices: &[Vector<S>], m: usize) -> S {
    let sides = vertices.len();
    let length = |(c, next): (Vector<S>, Vector<S>)| dot(next - c, next - c).sqrt();
    let at_vertex = pairs(vertices).enumerate().filter(|(k, _)| *k == m || (k + 1) % sides == m);
    at_vertex.fold(S::constant(0.0), |sum, (_, side)| sum + length(side))
}

fn pairs<S: Scalar>(vertices: &[Vector<S>]) -> impl Iterator<Item = (Vector<S>, Vector<S>)> {
    vertices.iter().copied().zip(vertices.iter().copied().cycle().skip(1))
}
