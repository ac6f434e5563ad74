//! Rings read off a triangulation, and their assembly into a tessellation.

use super::mesh::Mesh;
use super::rectangle::Rectangle;
use super::site::{Role, Site};
use crate::{Error, Tessellation, Vector, circumcentre, cross};

/// The rings of some cells.
#[derive(Default)]
pub(super) struct Rings {
    /// Cell, number of sides, and whether it is on the hull.
    cells: Vec<(u32, u32, bool)>,
    /// Neighbour and image of every side of these cells.
    sides: Vec<(u32, [i16; 2])>,
    /// Area of the triangles around these cells, a third for each of their corners; for tiles only.
    pub area: f64,
}

impl Rings {
    /// The rings of all sites; cells on the hull have open ones.
    pub fn of_all<M: Mesh>(mesh: &M, sites: &[Site]) -> Self {
        let mut rings = Self::with_capacity(sites.len());
        let mut neighbours = Vec::new();
        for site in 0..sites.len() {
            let closed = mesh.ring(site, &mut neighbours);
            rings.push(sites, site, &neighbours, closed);
        }
        rings
    }

    /// The rings of the tile's own sites at `points`, or nothing if a cell outside `surroundings` could change one of them.
    pub fn of_own<M: Mesh>(
        mesh: &M,
        points: &[Vector<f64>],
        sites: &[Site],
        surroundings: &Rectangle,
    ) -> Option<Self> {
        let mut rings = Self::with_capacity(sites.len());
        let mut neighbours = Vec::new();
        for (site, _) in sites.iter().enumerate().filter(|(_, site)| site.role == Role::Own) {
            if !mesh.ring(site, &mut neighbours) {
                return None;
            }
            let own_before = |other: usize| other < site && sites[other].role == Role::Own;
            let mut previous = neighbours[neighbours.len() - 1] as usize;
            for &next in &neighbours {
                let next = next as usize;
                let (a, b) = (points[previous] - points[site], points[next] - points[site]);
                rings.area += cross(a, b) / 6.0;
                // The circle of a triangle is looked at once.
                if !own_before(previous) && !own_before(next) {
                    let centre = circumcentre(a, b);
                    if !surroundings.contains_circle(points[site] + centre, centre.norm()) {
                        return None;
                    }
                }
                previous = next;
            }
            rings.push(sites, site, &neighbours, true);
        }
        Some(rings)
    }

    fn with_capacity(cells: usize) -> Self {
        Self { cells: Vec::with_capacity(cells), sides: Vec::with_capacity(cells * 6), area: 0.0 }
    }

    /// Adds a ring that starts at its lowest neighbour, or after the gap of a cell on the hull, so that it does not
    /// depend on the order of construction.
    fn push(&mut self, sites: &[Site], site: usize, neighbours: &[u32], closed: bool) {
        let side = |m: usize| {
            let other = &sites[neighbours[m] as usize];
            (other.cell, other.image)
        };
        let count = neighbours.len();
        let first = if closed { (0..count).min_by_key(|&m| side(m)).unwrap_or(0) } else { 0 };
        self.sides.extend((first..count).chain(0..first).map(side));
        self.cells.push((sites[site].cell, count as u32, !closed));
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
