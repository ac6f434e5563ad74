//! Cells given by the corners of their outlines.

use std::collections::{BTreeMap, BTreeSet};
use voronudge_geometry::{Vector, cross};

/// Measures of a polygon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    /// Centre of its area.
    pub centroid: Vector<f64>,
    /// Its area, positive whichever way round the corners are given.
    pub area: f64,
    /// Its perimeter.
    pub perimeter: f64,
}

impl Outline {
    /// The measures of a polygon with these corners in order, in either sense; `None` for fewer than three, or no area.
    pub fn new(corners: &[Vector<f64>]) -> Option<Self> {
        let first = *corners.first().filter(|_| corners.len() >= 3)?;
        let (mut twice_area, mut perimeter, mut moment) = (0.0, 0.0, Vector::zeros());
        for (index, &a) in corners.iter().enumerate() {
            let b = corners[(index + 1) % corners.len()];
            perimeter += (b - a).norm();
            // Relative to the first corner, so that a place far from the origin costs no digits.
            let (a, b) = (a - first, b - first);
            let piece = cross(a, b);
            twice_area += piece;
            moment += (a + b) * piece;
        }
        let usable = twice_area.abs() > f64::EPSILON * perimeter * perimeter;
        usable.then(|| Self {
            centroid: first + moment / (3.0 * twice_area),
            area: 0.5 * twice_area.abs(),
            perimeter,
        })
    }
}

/// Pairs of polygons, the lower index first, with a side in common.
pub fn outline_contacts(outlines: &[Vec<Vector<f64>>], tolerance: f64) -> BTreeSet<[usize; 2]> {
    shared_sides(outlines, tolerance).into_iter().map(|(pair, _)| pair).collect()
}

/// Sides that two polygons have in common, the lower index first: two corners that follow each other in both and lie within
/// `tolerance` of each other.
pub(crate) fn shared_sides(
    outlines: &[Vec<Vector<f64>>],
    tolerance: f64,
) -> Vec<([usize; 2], [Vector<f64>; 2])> {
    let tolerance = tolerance.max(f64::MIN_POSITIVE);
    // Corners that round to one place are one corner.
    let key = |corner: &Vector<f64>| [corner.x, corner.y].map(|x| (x / (2.0 * tolerance)).round() as i64);
    type Owners = (Vec<usize>, [Vector<f64>; 2]);
    let mut sides: BTreeMap<[[i64; 2]; 2], Owners> = BTreeMap::new();
    for (cell, corners) in outlines.iter().enumerate() {
        let keys: Vec<[i64; 2]> = corners.iter().map(key).collect();
        for (index, &a) in keys.iter().enumerate() {
            let b = keys[(index + 1) % keys.len()];
            if a != b {
                let ends = [corners[index], corners[(index + 1) % corners.len()]];
                sides.entry([a.min(b), a.max(b)]).or_insert((Vec::new(), ends)).0.push(cell);
            }
        }
    }
    let mut shared = Vec::new();
    for (cells, ends) in sides.into_values() {
        for (index, &a) in cells.iter().enumerate() {
            let others = cells[index + 1..].iter().filter(|&&b| a != b);
            shared.extend(others.map(|&b| ([a.min(b), a.max(b)], ends)));
        }
    }
    shared
}
