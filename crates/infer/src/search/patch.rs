//! A part of a frame cut out, to try changes in without touching the rest.

use crate::free_cells::Free;
use crate::normal_equations::NormalEquations;
use crate::objective::{Moving, Nudged, Objective};
use crate::placing::Placing;
use crate::{CoefficientSpace, Error, NoiseLevels, Observation, Velocities};
use std::collections::HashMap;
use voronudge_geometry::Vector;
use voronudge_model::Structure;

/// Rings around the given cells whose nudges are free.
const FREE: usize = 3;

/// Rings around the free cells whose velocities depend on them.
const AFFECTED: usize = 2;

/// Rings around those that shape their polygons and their neighbours'.
const CONTEXT: usize = 2;

/// Some cells of a frame at their nudged positions. Cells near the middle are free to move, those around them are held
/// where the nudges have put them. In a small box the patch is the whole frame, and all cells are free.
pub(super) struct Patch {
    frame: [Observation; 1],
    /// Cells of the frame, in the order of the patch.
    cells: Vec<usize>,
    /// ε of the patch: that of the frame for free cells, zero for others.
    nudges: Vec<f64>,
    free: Free,
}

/// A frame, its nudges, and where they put the cells.
pub(super) struct Whole<'a> {
    pub frame: &'a Observation,
    pub nudges: &'a [f64],
    pub nudged: &'a Nudged<'a>,
    /// The velocities to be explained, the present background removed.
    pub targets: &'a [Option<Vector<f64>>],
}

impl Patch {
    /// The patch around some cells, which must be neighbours.
    pub fn new(whole: &Whole<'_>, around: &[usize]) -> Result<Self, Error> {
        let rings = Rings::new(whole.nudged, around, FREE + AFFECTED + CONTEXT);
        // A patch that meets itself around the periodic box is not cut out, nor one of velocities on a grid.
        let cut = match &whole.frame.velocities {
            Velocities::OfCells(_) if !rings.wraps => Some(|cell: &usize| whole.targets[*cell]),
            _ => None,
        };
        let cells = match cut {
            Some(_) => rings.cells.clone(),
            None => (0..whole.frame.positions.len()).collect(),
        };
        let within = |cell: usize, rings_around: usize| {
            rings.distance.get(&cell).is_some_and(|distance| *distance <= rings_around)
        };
        let is_free = |cell: usize| cut.is_none() || within(cell, FREE);
        // Free cells keep their measured positions, to which their springs pull.
        let nudges: Vec<f64> = cells
            .iter()
            .flat_map(|&cell| {
                if is_free(cell) { [whole.nudges[2 * cell], whole.nudges[2 * cell + 1]] } else { [0.0; 2] }
            })
            .collect();
        let frame = match cut {
            Some(target) => {
                let nudged = rings.positions.iter().zip(nudges.chunks_exact(2));
                let measured = nudged.map(|(r, e)| r - Vector::new(e[0], e[1])).collect();
                let held = cells.iter().map(|cell| !is_free(*cell)).collect();
                let target = |cell: &usize| target(cell).filter(|_| within(*cell, FREE + AFFECTED));
                whole.frame.cut(&cells, whole.nudges, measured, cells.iter().map(target).collect(), held)?
            }
            None => whole.frame.clone(),
        };
        let free = Free::new(cells.len(), |own| !frame.is_held(own));
        Ok(Self { frame: [frame], cells, nudges, free })
    }

    /// The objective of the patch alone, coefficients held.
    pub fn objective<'s>(
        &'s self,
        structure: &'s Structure,
        pinned: &'s CoefficientSpace,
        levels: NoiseLevels,
    ) -> OfFree<'s> {
        OfFree { patch: self, objective: Objective::new(&self.frame, structure, pinned, levels) }
    }

    /// The place among the free cells of a cell of the frame.
    pub fn column_index(&self, cell: usize) -> Option<usize> {
        self.cells.iter().position(|own| *own == cell).and_then(|own| self.free.column_index(own))
    }

    /// Free cells by their index in the frame.
    pub fn free(&self) -> impl Iterator<Item = usize> {
        self.free.cells.iter().map(|own| self.cells[*own])
    }

    /// Nudges of the free cells.
    pub fn start(&self) -> Vec<f64> {
        self.free.of(&self.nudges)
    }
}

/// The objective of a patch as a function of the nudges of its free cells.
pub(super) struct OfFree<'a> {
    pub patch: &'a Patch,
    pub objective: Objective<'a>,
}

impl OfFree<'_> {
    /// The nudges of all cells.
    fn all(&self, nudges: &[f64]) -> Vec<f64> {
        self.patch.free.within(&self.patch.nudges, nudges)
    }

    pub fn value(&self, nudges: &[f64]) -> f64 {
        self.objective.value(&self.all(nudges))
    }

    pub fn linearise(&self, nudges: &[f64]) -> Result<NormalEquations, Error> {
        self.linearise_of(&self.placed_at(nudges)?, nudges)
    }
}

impl<'a> Placing for OfFree<'a> {
    type Placed = Vec<Moving<'a>>;

    fn placed_at(&self, nudges: &[f64]) -> Result<Self::Placed, Error> {
        self.objective.placed_at(&self.all(nudges))
    }

    fn value_of(&self, placed: &Self::Placed, nudges: &[f64]) -> f64 {
        self.objective.value_of(placed, &self.all(nudges))
    }

    fn linearise_of(&self, placed: &Self::Placed, nudges: &[f64]) -> Result<NormalEquations, Error> {
        self.objective.linearise_free(placed, &self.all(nudges), &self.patch.free)
    }
}

/// Cells by their distance in rings, with positions that do not jump across the box.
struct Rings {
    cells: Vec<usize>,
    positions: Vec<Vector<f64>>,
    distance: HashMap<usize, usize>,
    /// Whether a cell was met at two places.
    wraps: bool,
}

impl Rings {
    fn new(nudged: &Nudged, around: &[usize], rings: usize) -> Self {
        let (tessellation, positions) = (&nudged.tessellation, &nudged.positions);
        let first = around[0];
        let mut found = Self {
            cells: vec![first],
            positions: vec![positions[first]],
            distance: HashMap::from([(first, 0)]),
            wraps: false,
        };
        // The given cells are at distance zero, the others follow ring by ring.
        let mut next = 0;
        while next < found.cells.len() {
            let (cell, at) = (found.cells[next], found.positions[next]);
            let reached = found.distance[&cell];
            next += 1;
            for h in tessellation.ring(cell) {
                let other = tessellation.neighbour(h);
                let distance = if around.contains(&other) { 0 } else { reached + 1 };
                let there = at + tessellation.displacement(positions, cell, h);
                match found.distance.get(&other) {
                    None if distance <= rings => {
                        found.distance.insert(other, distance);
                        found.cells.push(other);
                        found.positions.push(there);
                    }
                    Some(known) if distance < *known => {
                        found.distance.insert(other, distance);
                    }
                    _ => {}
                }
            }
        }
        found.wraps = found.meets_itself(nudged);
        found
    }

    fn meets_itself(&self, nudged: &Nudged) -> bool {
        let place: HashMap<usize, usize> =
            self.cells.iter().enumerate().map(|(own, cell)| (*cell, own)).collect();
        self.cells.iter().enumerate().any(|(own, &cell)| {
            nudged.tessellation.ring(cell).any(|h| {
                place.get(&nudged.tessellation.neighbour(h)).is_some_and(|other| {
                    let there =
                        self.positions[own] + nudged.tessellation.displacement(&nudged.positions, cell, h);
                    (there - self.positions[*other]).norm() > 1e-6
                })
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{COEFFICIENTS, observation_of};
    use voronudge_model::Effect;

    /// Cells of a patch are pushed as they are in the whole, by what depends on their label as well.
    #[test]
    fn cells_of_a_patch_are_what_they_are() {
        let labels = (0..400).map(|cell| Some(cell % 3)).collect();
        let frame = observation_of(20, 0.0, 0.0, 1).with_labels(labels).unwrap();
        let effect = Effect::from_id("label_parameter").unwrap();
        let columns = effect.columns(frame.environment(), frame.tessellation.domain()).unwrap();
        let structure = Structure::base(1.0).with(&columns);
        let mut coefficients = COEFFICIENTS.to_vec();
        coefficients.resize(structure.dimension(), 0.3);
        let nudged = Nudged::as_measured(&frame, &structure);
        let targets: Vec<_> = nudged.velocities(&coefficients).into_iter().map(Some).collect();
        let nudges = vec![0.0; 800];
        let whole = Whole { frame: &frame, nudges: &nudges, nudged: &nudged, targets: &targets };
        let patch = Patch::new(&whole, &[210]).unwrap();
        assert!(patch.cells.len() < 300);
        let pinned = CoefficientSpace::pinned(&coefficients);
        let own = patch.objective(&structure, &pinned, NoiseLevels { position: 0.02, velocity: 0.02 });
        assert!(own.value(&patch.start()) < 1e-20);
    }
}
