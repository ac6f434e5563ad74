//! How much of each Voronoi cell lies in each square of a grid, or in Gaussian patches around its points, and how that changes as
//! the cells move and the squares grow.

use crate::by_square::{BySquare, Overlap, bounds, by_square, sides};
use crate::gaussian_patch;
use crate::grid::Centres;
use crate::{Grid, Patch, Scalar, Tessellation, Vector, cross};
use num_dual::Dual64;

/// The part of a Voronoi side in a square.
///
/// Points x of the side move along its normal by `[(x − r_i)·dr_i − (x − r_j)·dr_j] / d` if the cells move by dr_i and
/// dr_j. This is linear in x, so with the midpoint m of the piece and its length ℓ the area of cell i in the square
/// changes by
///
/// ```text
/// da_i = (ℓ/d) [(m − r_i)·dr_i − (m − r_j)·dr_j],        da_j = −da_i
/// ```
///
/// summed over the pieces of the square. In a Gaussian patch ℓ and m are weighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SidePiece {
    /// Index i of a cell with a closed polygon.
    pub cell: u32,
    /// Index j of the cell across the side. Its polygon may be open, and then has no area to change.
    pub neighbour: u32,
    /// Length ℓ of the piece.
    pub length: f64,
    /// `m − r_i`
    pub from_cell: Vector<f64>,
    /// `m − r_j`, where r_j is the image of the neighbour that is met.
    pub from_neighbour: Vector<f64>,
    /// Distance `d = |r_j − r_i|` of the centres.
    pub distance: f64,
}

impl SidePiece {
    /// `∂a_i/∂r_i` and `∂a_i/∂r_j`, as far as this piece contributes; those of a_j are the opposite.
    pub fn area_gradient(&self) -> [Vector<f64>; 2] {
        let weight = self.length / self.distance;
        [self.from_cell * weight, self.from_neighbour * -weight]
    }
}

/// The area of each cell (of N at `positions`) in each square of a grid, in squared units of the positions.
///
/// The entries of a square are in ascending order of cells. Cells that are not closed contribute nothing. In a periodic
/// box all images count: a square of twice the box holds every cell twice. The tessellation must be that of the
/// positions.
///
/// ```
/// use voronudge_geometry::{Domain, Grid, PeriodicBox, Tessellation, Vector, overlaps};
///
/// // One cell in a box; two squares, each half the box.
/// let domain = Domain::Periodic(PeriodicBox::new([2.0, 3.0])?);
/// let positions = [Vector::new(0.3, 0.4)];
/// let tessellation = Tessellation::new(&positions, domain)?;
/// let overlaps = overlaps(&tessellation, &positions, &Grid::new([0.0, 0.0], [1.0, 3.0], [2, 1])?);
/// assert_eq!(overlaps.square(1)[0].cell, 0);
/// assert!((overlaps.square(1)[0].area - 3.0).abs() < 1e-14);
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
pub fn overlaps(tessellation: &Tessellation, positions: &[Vector<f64>], grid: &Grid) -> BySquare<Overlap> {
    match grid.patch() {
        Patch::Square(side) => square_overlaps(tessellation, positions, grid, side),
        Patch::Gaussian(width) => gaussian_patch::overlaps(tessellation, positions, grid, width),
    }
}

/// The pieces of the Voronoi sides of N cells at `positions` in each square of a grid.
///
/// Each side is given once, from a closed cell. In a periodic box all its images count. The tessellation must be that of
/// the positions.
///
/// ```
/// use voronudge_geometry::{Domain, Grid, PeriodicBox, Tessellation, Vector, side_pieces};
///
/// // Two cells in a box, parted by the lines x = 0, 1 and 2.
/// let domain = Domain::Periodic(PeriodicBox::new([2.0, 1.0])?);
/// let positions = [Vector::new(0.5, 0.5), Vector::new(1.5, 0.5)];
/// let tessellation = Tessellation::new(&positions, domain)?;
/// let pieces = side_pieces(&tessellation, &positions, &Grid::new([1.0, 0.5], [0.5, 0.5], [1, 1])?);
/// let between = pieces.square(0).iter().find(|piece| piece.length > 0.0 && piece.cell != piece.neighbour);
/// // The line moves by half the displacement of a cell; half a unit of its length is in the square.
/// assert!(between.is_some_and(|piece| (piece.area_gradient()[0].x.abs() - 0.25).abs() < 1e-14));
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
pub fn side_pieces(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    grid: &Grid,
) -> BySquare<SidePiece> {
    by_square(tessellation, positions, grid, |_: &mut (), polygon, cell, found| {
        for (h, side) in sides(tessellation, polygon, cell) {
            let neighbour = tessellation.neighbour(h);
            if tessellation.is_closed(neighbour) && tessellation.twin(h) < h {
                continue;
            }
            let (length, distance) = ((side.to - side.from).norm(), side.displacement.norm());
            let bounds = [side.from.inf(&side.to), side.from.sup(&side.to)];
            let mut add = |square: usize, length: f64, middle: Vector<f64>| {
                let piece = SidePiece {
                    cell: cell as u32,
                    neighbour: neighbour as u32,
                    length,
                    from_cell: middle,
                    from_neighbour: middle - side.displacement,
                    distance,
                };
                found.push((square, piece));
            };
            grid.for_images(tessellation.domain(), positions[cell], bounds, |centres| match grid.patch() {
                Patch::Square(_) => {
                    side.pieces(&centres, |square, share, middle| add(square, share * length, middle));
                }
                Patch::Gaussian(width) => centres.meeting(bounds, |square, centre| {
                    let (length, middle) =
                        gaussian_patch::line([side.from - centre, side.to - centre], width);
                    if length > 0.0 {
                        add(square, length, middle + centre);
                    }
                }),
            });
        }
    })
}

fn square_overlaps(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    grid: &Grid,
    side: f64,
) -> BySquare<Overlap> {
    let side = Dual64::from_re(side).derivative();
    by_square(tessellation, positions, grid, |scratch: &mut Clipper, polygon, cell, found| {
        scratch.vertices.clear();
        let constant = |c: Vector<f64>| Vector::new(Dual64::from_re(c.x), Dual64::from_re(c.y));
        scratch.vertices.extend(polygon.vertices().map(constant));
        let first = found.len();
        let mut add = |square: usize, area: Dual64| {
            found.push((square, Overlap { cell: cell as u32, area: area.re, by_width: area.eps }));
        };
        grid.for_images(tessellation.domain(), positions[cell], bounds(polygon), |centres| {
            scratch.areas(&centres, side, &mut add);
        });
        merge(found, first);
    })
}

/// Joins the overlaps of one cell, from entry `first` on, that are in the same square.
fn merge(found: &mut Vec<(usize, Overlap)>, first: usize) {
    found[first..].sort_by_key(|entry| entry.0);
    let mut kept = first;
    for k in first..found.len() {
        if kept > first && found[kept - 1].0 == found[k].0 {
            found[kept - 1].1.area += found[k].1.area;
            found[kept - 1].1.by_width += found[k].1.by_width;
        } else {
            found[kept] = found[k];
            kept += 1;
        }
    }
    found.truncate(kept);
}

/// A polygon and what is left of it in a column and in a square. Buffers are kept between cells.
#[derive(Default)]
struct Clipper {
    vertices: Vec<Vector<Dual64>>,
    column: Vec<Vector<Dual64>>,
    square: Vec<Vector<Dual64>>,
    half: Vec<Vector<Dual64>>,
}

impl Clipper {
    /// Visits the squares of some side that the polygon overlaps, with the area in common.
    fn areas(&mut self, centres: &Centres<'_>, side: Dual64, visit: &mut impl FnMut(usize, Dual64)) {
        let reach = centres.grid().aspect().map(|part| side * (0.5 * part));
        let ends = |axis: usize, number: usize| {
            let centre = centres.centre(axis, number);
            [-reach[axis] + centre, reach[axis] + centre]
        };
        for ix in centres.numbers(0, range(&self.vertices, 0)) {
            clip(&self.vertices, 0, ends(0, ix), &mut self.half, &mut self.column);
            for iy in centres.numbers(1, range(&self.column, 1)) {
                clip(&self.column, 1, ends(1, iy), &mut self.half, &mut self.square);
                let area = area(&self.square);
                if area.re > 0.0 {
                    visit(centres.grid().index([ix, iy]), area);
                }
            }
        }
    }
}

/// Least and greatest coordinate along an axis.
fn range<S: Scalar>(points: &[Vector<S>], axis: usize) -> [f64; 2] {
    points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], point| {
        let coordinate = point[axis].real();
        [low.min(coordinate), high.max(coordinate)]
    })
}

/// The part of a convex polygon with a coordinate between two bounds (Sutherland and Hodgman).
fn clip<S: Scalar>(
    polygon: &[Vector<S>],
    axis: usize,
    [low, high]: [S; 2],
    half: &mut Vec<Vector<S>>,
    clipped: &mut Vec<Vector<S>>,
) {
    cut(polygon, half, axis, |coordinate| coordinate - low);
    cut(half, clipped, axis, |coordinate| high - coordinate);
}

/// The part of a convex polygon where `inside` is not negative; it is linear in the coordinate along `axis`.
fn cut<S: Scalar>(polygon: &[Vector<S>], kept: &mut Vec<Vector<S>>, axis: usize, inside: impl Fn(S) -> S) {
    kept.clear();
    let Some(&last) = polygon.last() else {
        return;
    };
    let (mut previous, mut before) = (last, inside(last[axis]));
    for &vertex in polygon {
        let here = inside(vertex[axis]);
        if (before.real() < 0.0) != (here.real() < 0.0) {
            // From the nearer of the two: vertices at the rim of an open field can be very far away.
            let swap = here.real().abs() < before.real().abs();
            let (near, far) = if swap { (vertex, previous) } else { (previous, vertex) };
            let (at_near, at_far) = if swap { (here, before) } else { (before, here) };
            kept.push(near + (far - near) * (at_near / (at_near - at_far)));
        }
        if here.real() >= 0.0 {
            kept.push(vertex);
        }
        (previous, before) = (vertex, here);
    }
}

fn area<S: Scalar>(polygon: &[Vector<S>]) -> S {
    let Some(&first) = polygon.first() else {
        return S::constant(0.0);
    };
    let double = |pair: &[Vector<S>]| cross(pair[0] - first, pair[1] - first);
    polygon.windows(2).fold(S::constant(0.0), |sum, pair| sum + double(pair) * 0.5)
}
