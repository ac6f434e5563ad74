//! Rings read off a triangulation, and their assembly into a tessellation.

use super::tile::Rectangle;
use super::{Role, Site};
use crate::{Error, Tessellation, Vector, circumcentre};
use spade::{DelaunayTriangulation, Triangulation};

/// The rings of some cells.
pub(super) struct Rings {
    /// Cell, number of sides, and whether it is on the hull.
    cells: Vec<(u32, u32, bool)>,
    /// Neighbour and image of every side of these cells.
    sides: Vec<(u32, [i16; 2])>,
}

impl Rings {
    /// The rings of all sites; cells on the hull have open ones.
    pub fn of_all(delaunay: &DelaunayTriangulation<Site>) -> Self {
        let (mut rings, mut scratch) = (Self::with_capacity(delaunay.num_vertices()), Scratch::default());
        for vertex in delaunay.vertices() {
            scratch.read(vertex);
            rings.push(vertex.data().cell, &mut scratch);
        }
        rings
    }

    /// The rings of the tile's own sites, or nothing if a cell outside `surroundings` could change one of them.
    pub fn of_own(delaunay: &DelaunayTriangulation<Site>, surroundings: &Rectangle) -> Option<Self> {
        let (mut rings, mut scratch) = (Self::with_capacity(delaunay.num_vertices()), Scratch::default());
        for vertex in delaunay.vertices() {
            let site = vertex.data();
            if site.role == Role::Ghost {
                continue;
            }
            scratch.read(vertex);
            let origin = Vector::new(site.position.x, site.position.y);
            let sides = scratch.displacements.len();
            let complete = scratch.gap.is_none()
                && (0..sides).all(|m| {
                    let (a, b) = (scratch.displacements[m], scratch.displacements[(m + 1) % sides]);
                    let c = circumcentre(a, b);
                    surroundings.contains_circle(origin + c, c.norm())
                });
            if !complete {
                return None;
            }
            rings.push(site.cell, &mut scratch);
        }
        Some(rings)
    }

    fn with_capacity(cells: usize) -> Self {
        Self { cells: Vec::with_capacity(cells), sides: Vec::with_capacity(cells * 6) }
    }

    /// Adds a ring that starts at its lowest neighbour, or after the gap of a cell on the hull, so that it does not
    /// depend on the order of construction.
    fn push(&mut self, cell: u32, scratch: &mut Scratch) {
        let sides = &mut scratch.sides;
        let first = match scratch.gap {
            Some(gap) => gap % sides.len(),
            None => (0..sides.len()).min_by_key(|&m| sides[m]).unwrap_or(0),
        };
        self.sides.extend_from_slice(&sides[first..]);
        self.sides.extend_from_slice(&sides[..first]);
        self.cells.push((cell, sides.len() as u32, scratch.gap.is_some()));
    }
}

/// One ring while it is read.
#[derive(Default)]
struct Scratch {
    sides: Vec<(u32, [i16; 2])>,
    displacements: Vec<Vector<f64>>,
    /// Number of sides before the gap of an open ring.
    gap: Option<usize>,
}

impl Scratch {
    fn read(&mut self, vertex: spade::handles::VertexHandle<'_, Site>) {
        self.sides.clear();
        self.displacements.clear();
        self.gap = None;
        let origin = vertex.data().position;
        for edge in vertex.out_edges() {
            let to = edge.to();
            let site = to.data();
            self.sides.push((site.cell, site.image));
            self.displacements.push(Vector::new(site.position.x - origin.x, site.position.y - origin.y));
            // The face to the left of an edge is the corner between it and the next edge.
            if edge.is_outer_edge() {
                self.gap = Some(self.sides.len());
            }
        }
    }
}

/// Fills the flat arrays of a tessellation of `cells` cells.
pub(super) fn assemble(tessellation: &mut Tessellation, cells: usize, rings: &[Rings]) -> Result<(), Error> {
    let Tessellation { start, neighbour, image, on_hull, .. } = tessellation;
    clear_to(start, cells + 1, 0);
    clear_to(on_hull, cells, false);
    for &(cell, sides, hull) in rings.iter().flat_map(|r| &r.cells) {
        start[cell as usize + 1] = sides;
        on_hull[cell as usize] = hull;
    }
    for cell in 0..cells {
        start[cell + 1] += start[cell];
    }
    clear_to(neighbour, start[cells] as usize, 0);
    clear_to(image, start[cells] as usize, [0, 0]);
    for rings in rings {
        let mut rest = rings.sides.as_slice();
        for &(cell, sides, _) in &rings.cells {
            let (ring, after) = rest.split_at(sides as usize);
            rest = after;
            let begin = start[cell as usize] as usize;
            for (m, &(other, across)) in ring.iter().enumerate() {
                neighbour[begin + m] = other;
                image[begin + m] = across;
            }
        }
    }
    find_twins(tessellation)
}

fn clear_to<T: Clone>(array: &mut Vec<T>, length: usize, value: T) {
    array.clear();
    array.resize(length, value);
}

/// Finds each half-edge's twin; fails where two images of one circle of cells were triangulated differently.
pub(crate) fn find_twins(tessellation: &mut Tessellation) -> Result<(), Error> {
    let cells = tessellation.len();
    let mut places = std::mem::take(&mut tessellation.twin_place);
    clear_to(&mut places, tessellation.half_edges(), u32::MAX);
    for cell in 0..cells {
        for h in tessellation.ring(cell) {
            if places[h] != u32::MAX {
                continue;
            }
            let (other, [x, y]) = (tessellation.neighbour(h), tessellation.image[h]);
            let found = tessellation
                .ring(other)
                .find(|&g| tessellation.neighbour(g) == cell && tessellation.image[g] == [-x, -y]);
            let Some(g) = found else {
                return Err(Error::Inconsistent { cells, cell });
            };
            places[h] = (g - tessellation.half_edge_start(other)) as u32;
            places[g] = (h - tessellation.half_edge_start(cell)) as u32;
        }
    }
    tessellation.twin_place = places;
    Ok(())
}

/// Images between wrapped positions become images between the positions as given.
pub(super) fn refer_to_given_positions(tessellation: &mut Tessellation, images: &[[i32; 2]]) {
    if images.iter().all(|n| *n == [0, 0]) {
        return;
    }
    let Tessellation { start, neighbour, image, .. } = tessellation;
    for (cell, own) in images.iter().enumerate() {
        for h in start[cell] as usize..start[cell + 1] as usize {
            let other = images[neighbour[h] as usize];
            for axis in 0..2 {
                image[h][axis] = (i32::from(image[h][axis]) + own[axis] - other[axis]) as i16;
            }
        }
    }
}
