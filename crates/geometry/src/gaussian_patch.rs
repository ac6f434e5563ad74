//! Voronoi cells in Gaussian patches: integrals of a Gaussian over polygons and along their sides.

use crate::by_square::{BySquare, Overlap, Side, bounds, by_square, sides};
use crate::{CellPolygon, Grid, Tessellation, Vector, cross};
use rayon::prelude::*;

/// Nodes and weights of Gauss and Legendre's rule of five points on (0, 1).
const NODES: [[f64; 2]; 5] = [
    [0.046_910_077_030_668_004, 0.118_463_442_528_094_54],
    [0.230_765_344_947_158_45, 0.239_314_335_249_683_24],
    [0.5, 0.284_444_444_444_444_45],
    [0.769_234_655_052_841_5, 0.239_314_335_249_683_24],
    [0.953_089_922_969_332, 0.118_463_442_528_094_54],
];

/// Most pieces of a side; longer sides are those of polygons at the rim of an open field.
const MOST_PIECES: f64 = 64.0;

/// Patches per task.
const CHUNK: usize = 16;

/// What two ways to the same image may differ by, as a share of them.
const ROUNDING: f64 = 1e-9;

/// Number of pieces of a side, no longer than the Gaussian is wide, along which it is integrated.
fn pieces(length: f64, width: f64) -> u32 {
    (length / width).ceil().clamp(1.0, MOST_PIECES) as u32
}

/// Visits the points of a line at which it is integrated, with their weights, 1 in all.
fn along([from, to]: [Vector<f64>; 2], pieces: u32, mut visit: impl FnMut(Vector<f64>, f64)) {
    let (step, part) = (to - from, 1.0 / f64::from(pieces));
    for piece in 0..pieces {
        for [node, weight] in NODES {
            visit(from + step * ((f64::from(piece) + node) * part), weight * part);
        }
    }
}

/// What a side from p to q contributes to `∫ exp(−x²/2s²) dA` over the polygon on its left, with the centre of the Gaussian at the
/// origin, and the derivative by s.
///
/// With `u = x²/2s²` the field `x (1 − e⁻ᵘ)/2u` has the divergence `e⁻ᵘ`, so this is `(p × q) ∫ (1 − e⁻ᵘ)/2u dt`.
fn area(ends: [Vector<f64>; 2], width: f64, pieces: u32) -> [f64; 2] {
    let (mut shares, mut weights) = (0.0, 0.0);
    let narrow = 0.5 / (width * width);
    along(ends, pieces, |x, weight| {
        let u = narrow * x.norm_squared();
        let gaussian = (-u).exp();
        shares += weight * share(u, gaussian);
        weights += weight * gaussian;
    });
    // d/du (1 − e⁻ᵘ)/2u = (e⁻ᵘ − 2 (1 − e⁻ᵘ)/2u)/2u and du/ds = −2u/s
    let cross = cross(ends[0], ends[1]);
    [cross * shares, cross * (2.0 * shares - weights) / width]
}

/// u below which `1 − e⁻ᵘ` loses digits.
const SMALL: f64 = 1e-2;

/// `(1 − e⁻ᵘ)/2u`, where e⁻ᵘ is known.
fn share(u: f64, gaussian: f64) -> f64 {
    if u < SMALL {
        let series = [1.0 / 720.0, -1.0 / 120.0, 1.0 / 24.0, -1.0 / 6.0, 0.5, -1.0];
        -0.5 * series.into_iter().fold(-1.0 / 5040.0, |sum, next| sum * u + next)
    } else {
        (1.0 - gaussian) / (2.0 * u)
    }
}

/// `∫ exp(−x²/2s²) dl` along a line from one end to the other, and the mean place of that weight, with the centre at the origin.
pub(crate) fn line(ends: [Vector<f64>; 2], width: f64) -> (f64, Vector<f64>) {
    let length = (ends[1] - ends[0]).norm();
    let narrow = 0.5 / (width * width);
    let (mut sum, mut moment) = (0.0, Vector::zeros());
    along(ends, pieces(length, width), |x, weight| {
        let weight = weight * (-narrow * x.norm_squared()).exp();
        sum += weight;
        moment += x * weight;
    });
    (sum * length, moment / sum)
}

/// A cell that a patch meets, and the centre of the patch relative to it.
#[derive(Debug, Clone, Copy)]
struct Member {
    cell: u32,
    centre: Vector<f64>,
}

/// The weighted area of each cell in each Gaussian patch of a grid. Every side is integrated once for both of its cells.
pub(crate) fn overlaps(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    grid: &Grid,
    width: f64,
) -> BySquare<Overlap> {
    let members = by_square(tessellation, positions, grid, |_: &mut (), polygon, cell, found| {
        let bounds = bounds(polygon);
        grid.for_images(tessellation.domain(), positions[cell], bounds, |centres| {
            centres.meeting(bounds, |square, centre| {
                found.push((square, Member { cell: cell as u32, centre }));
            });
        });
    });
    let sides = all_sides(tessellation, positions, width);
    let of_chunk = |chunk: usize| {
        let (mut areas, mut overlaps) = (Vec::new(), Vec::new());
        for square in chunk * CHUNK..((chunk + 1) * CHUNK).min(grid.len()) {
            let patch = Filling { tessellation, sides: &sides, members: members.square(square), width };
            patch.fill(&mut areas, |overlap| overlaps.push((square, overlap)));
        }
        overlaps
    };
    let chunks: Vec<_> = (0..grid.len().div_ceil(CHUNK)).into_par_iter().map(of_chunk).collect();
    BySquare::new(grid.len(), &chunks)
}

/// The sides of all closed cells by half-edge, with the number of pieces of each.
fn all_sides(tessellation: &Tessellation, positions: &[Vector<f64>], width: f64) -> Vec<Option<(Side, u32)>> {
    let mut all = vec![None; tessellation.half_edges()];
    let mut polygon = CellPolygon::default();
    for cell in (0..tessellation.len()).filter(|&cell| tessellation.is_closed(cell)) {
        polygon.fill(tessellation, positions, cell);
        for (h, side) in sides(tessellation, &polygon, cell) {
            all[h] = Some((side, pieces((side.to - side.from).norm(), width)));
        }
    }
    all
}

/// A patch and the cells that it meets, in the order of their indices; a cell several times if several images are met.
struct Filling<'a> {
    tessellation: &'a Tessellation,
    sides: &'a [Option<(Side, u32)>],
    members: &'a [Member],
    width: f64,
}

impl Filling<'_> {
    /// Visits the cells of the patch; `areas` is memory that is used again.
    fn fill(&self, areas: &mut Vec<[f64; 2]>, mut visit: impl FnMut(Overlap)) {
        areas.clear();
        areas.resize(self.members.len(), [0.0; 2]);
        for (number, &Member { cell, centre }) in self.members.iter().enumerate() {
            for h in self.tessellation.ring(cell as usize) {
                let Some((side, pieces)) = &self.sides[h] else {
                    continue;
                };
                let across = self.across(h, centre, side.displacement);
                if across.is_some() && self.tessellation.twin(h) < h {
                    continue;
                }
                let [area, by_width] = area([side.from - centre, side.to - centre], self.width, *pieces);
                for (number, sign) in [(Some(number), 1.0), (across, -1.0)] {
                    let Some(number) = number else { continue };
                    areas[number][0] += sign * area;
                    areas[number][1] += sign * by_width;
                }
            }
        }
        let mut areas = areas.iter();
        for images in self.members.chunk_by(|one, other| one.cell == other.cell) {
            let [area, by_width] = (areas.by_ref().take(images.len()))
                .fold([0.0; 2], |[area, by_width], image| [area + image[0], by_width + image[1]]);
            visit(Overlap { cell: images[0].cell, area, by_width });
        }
    }

    /// The member across a half-edge of another one, by its number.
    fn across(&self, h: usize, centre: Vector<f64>, displacement: Vector<f64>) -> Option<usize> {
        let cell = self.tessellation.neighbour(h) as u32;
        let first = self.members.partition_point(|member| member.cell < cell);
        let mut images = self.members[first..].iter().take_while(|member| member.cell == cell);
        let (expected, rounding) = (centre - displacement, ROUNDING * (centre.norm() + displacement.norm()));
        let met = images.position(|image| (image.centre - expected).norm() <= rounding);
        met.map(|number| first + number)
    }
}
