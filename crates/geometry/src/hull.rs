//! The part of an open field that its cells fill.

use crate::{Region, Tessellation, Vector, circumcentre};

/// The hull of cells: their convex hull without its bays.
///
/// A bay is what empty disks of at least some radius can sweep from outside, if one of them has its centre within the convex
/// hull. So the roughness of a straight edge is no bay, and neither is a hole within the tissue. Both convex hull and bays are
/// unions of Delaunay triangles; bays of those with large circumcircles.
#[derive(Debug, Clone)]
pub(crate) struct Hull {
    pub region: Region,
    /// For each cell, whether it lies in a bay or beyond.
    pub leaves_out: Vec<bool>,
}

impl Hull {
    /// The hull of an open field, for a least radius of the disks that sweep bays.
    pub fn new(tessellation: &Tessellation, positions: &[Vector<f64>], radius: f64) -> Self {
        // For each half-edge, whether what lies to its left is outside.
        let mut outside = vec![false; tessellation.half_edges()];
        let rim: Vec<usize> = (0..tessellation.len())
            .filter(|&cell| !tessellation.is_closed(cell))
            .filter_map(|cell| tessellation.ring(cell).last())
            .collect();
        rim.iter().for_each(|&h| outside[h] = true);
        let convex = Region::of_loops(borders(tessellation, positions, &outside));
        let mut swept = outside.clone();
        for &first in &rim {
            let mut reached = vec![first];
            let mut triangles = Vec::new();
            let mut is_bay = false;
            while let Some(h) = reached.pop() {
                let across = tessellation.twin(h);
                let second = tessellation.next_around_triangle(across);
                let third = tessellation.next_around_triangle(second);
                let triangle = [across, second, third];
                let [a, b, c] = triangle.map(|h| positions[tessellation.neighbour(h)]);
                let centre = circumcentre(b - a, c - a);
                if swept[across] || centre.norm() <= radius {
                    continue;
                }
                triangle.iter().for_each(|&h| swept[h] = true);
                triangles.extend(triangle);
                reached.extend([second, third]);
                is_bay = is_bay || convex.contains(a + centre);
            }
            if is_bay {
                triangles.iter().for_each(|&h| outside[h] = true);
            }
        }
        let leaves_out =
            (0..tessellation.len()).map(|cell| tessellation.ring(cell).all(|h| outside[h])).collect();
        Self { region: Region::of_loops(borders(tessellation, positions, &outside)), leaves_out }
    }
}

/// The closed lines between inside and outside, the inside to their left.
fn borders(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    outside: &[bool],
) -> Vec<Vec<Vector<f64>>> {
    let is_border = |h: usize| !outside[h] && outside[tessellation.twin(h)];
    let mut done = vec![false; outside.len()];
    let mut loops = Vec::new();
    for first in (0..outside.len()).filter(|&h| is_border(h)) {
        let mut corners = Vec::new();
        let mut h = first;
        while !done[h] {
            done[h] = true;
            corners.push(positions[tessellation.neighbour(h)]);
            h = tessellation.next_around_triangle(h);
            // Through the triangles around the corner to the next piece of the border.
            while !is_border(h) {
                h = tessellation.next_around_triangle(tessellation.twin(h));
            }
        }
        if !corners.is_empty() {
            loops.push(corners);
        }
    }
    loops
}
