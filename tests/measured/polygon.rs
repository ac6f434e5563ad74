//! Centroids of cells by cutting half planes from a square, without a tessellation.

use super::film::Film;
use voronudge_geometry::{Vector, cross};

/// Half the side of the square that is cut, in ℓ₀: no cell of a dense tissue reaches that far.
const REACH: f64 = 4.0;

/// The centroid of each cell of a frame, next to its site: not wrapped into the box.
pub(super) fn centroids(film: &Film, frame: usize) -> Vec<Vector<f64>> {
    let sites = &film.frames[frame].sites;
    let about = |site: &Vector<f64>| {
        let mut others: Vec<Vector<f64>> = sites
            .iter()
            .map(|other| film.cell_box.shortest(other - site))
            .filter(|to| to.norm_squared() > 0.0 && to.norm() < 2.0 * REACH)
            .collect();
        others.sort_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
        site + centroid(&cell(&others))
    };
    sites.iter().map(about).collect()
}

/// The polygon of points that are nearer to the origin than to any other site, these in the order of their distance.
fn cell(others: &[Vector<f64>]) -> Vec<Vector<f64>> {
    let corner = |x: f64, y: f64| Vector::new(x * REACH, y * REACH);
    let mut polygon = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    for other in others {
        let farthest = polygon.iter().map(Vector::norm).fold(0.0, f64::max);
        if other.norm() > 2.0 * farthest {
            break;
        }
        polygon = cut(&polygon, *other);
    }
    polygon
}

/// What of a convex polygon is nearer to the origin than to another site.
fn cut(polygon: &[Vector<f64>], other: Vector<f64>) -> Vec<Vector<f64>> {
    let beyond = |point: &Vector<f64>| point.dot(&other) - 0.5 * other.norm_squared();
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (index, from) in polygon.iter().enumerate() {
        let to = &polygon[(index + 1) % polygon.len()];
        let (at_from, at_to) = (beyond(from), beyond(to));
        if at_from <= 0.0 {
            kept.push(*from);
        }
        if (at_from <= 0.0) != (at_to <= 0.0) {
            kept.push(from + (to - from) * (at_from / (at_from - at_to)));
        }
    }
    kept
}

fn centroid(polygon: &[Vector<f64>]) -> Vector<f64> {
    let (mut double_area, mut moment) = (0.0, Vector::zeros());
    for (index, from) in polygon.iter().enumerate() {
        let to = &polygon[(index + 1) % polygon.len()];
        let piece = cross(*from, *to);
        double_area += piece;
        moment += (from + to) * piece;
    }
    moment / (3.0 * double_area)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_between_four_others_is_a_rectangle() {
        let others = [(1.0, 0.0), (-1.5, 0.0), (0.0, 2.0), (0.0, -2.0)].map(|(x, y)| Vector::new(x, y));
        let polygon = cell(&others);
        assert_eq!(polygon.len(), 4);
        assert!((centroid(&polygon) - Vector::new(-0.125, 0.0)).norm() < 1e-14);
    }
}
