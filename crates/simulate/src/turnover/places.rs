//! Places for new cells.

use super::cycle::distance_of_halves;
use super::{CellCycle, DivisionAxis, Injection, LivingTissue, Progress, Proliferation};
use crate::{Channel, Error};
use rand::Rng;
use rand::distr::{Distribution, weighted::WeightedIndex};
use std::f64::consts::{PI, TAU};
use voronudge_geometry::{CellPolygon, Triangle, Vector, circumcentre};

/// Where a cell is born, and from whom.
pub(super) struct Birth {
    pub place: Vector<f64>,
    /// Index of the mother among the cells of the step.
    pub mother: Option<usize>,
    /// The place of a second daughter, if the mother is no more.
    pub sister: Option<Vector<f64>>,
}

/// A new cell is this far from a wall at least, in mean spacings: on it, it would lie on its own mirror image.
const CLEARANCE: f64 = 1e-6;

/// Draws places of one step. No two events of a step concern the same cells.
///
/// Between walls new cells appear on vertices in front of a wall. At the vertices on it two cells meet their mirror images. The edges are
/// apart there, and a new cell appears in the half of the one it replaces: otherwise the denser half, with its vertices nearer to
/// the wall, would draw ever more of the births.
pub(super) struct Places<'a> {
    tissue: &'a LivingTissue,
    injection: Injection,
    /// Cells that are extruded or next to a new cell.
    taken: Vec<bool>,
    /// Whether each birth that replaces an extruded cell is in the right half; nothing without walls.
    halves: Vec<bool>,
    /// Where cells are in their cycles, if they have any.
    cycles: Vec<Progress>,
    births: usize,
    time_step: f64,
}

impl<'a> Places<'a> {
    pub fn new(tissue: &'a LivingTissue, extruded: &[usize], births: usize, time_step: f64) -> Self {
        let mut taken = vec![false; tissue.simulation.positions().len()];
        extruded.iter().for_each(|&cell| taken[cell] = true);
        let mut halves = Vec::new();
        if tissue.channel.is_walled() {
            let positions = tissue.simulation.positions();
            halves.extend(extruded.iter().map(|&cell| tissue.channel.is_right(positions[cell])));
        }
        let (injection, cycles) = (tissue.turnover.injection, tissue.cycles.clone());
        Self { tissue, injection, taken, halves, cycles, births, time_step }
    }

    /// The same by another way of injection.
    pub fn by(self, injection: Injection) -> Self {
        Self { injection, ..self }
    }

    /// Places of new cells in place of extruded ones, with the weight `exp(−d_b/d)`.
    pub fn weighted(&mut self, decay_length: f64, rng: &mut impl Rng) -> Result<Vec<Birth>, Error> {
        match self.injection {
            Injection::Vertex => self.on_any_vertices(decay_length, rng),
            Injection::Division { distance } => {
                let positions = self.tissue.simulation.positions();
                let mut weights = self.weights(positions.iter().copied(), decay_length);
                (0..self.births)
                    .map(|birth| {
                        weights
                            .iter_mut()
                            .zip(&self.taken)
                            .filter(|(_, taken)| **taken)
                            .for_each(|(w, _)| *w = 0.0);
                        let mother = self.draw(birth, &weights, |cell| positions[cell], rng)?;
                        self.taken[mother] = true;
                        Ok(self.beside(mother, distance, rng))
                    })
                    .collect()
            }
            Injection::Cycle(cycle) => (0..self.births)
                .map(|birth| {
                    let mother = self.next_of_cycles(birth, decay_length)?;
                    Ok(self.in_two(mother, cycle, rng))
                })
                .collect(),
        }
    }

    /// Where cells are in their cycles now.
    pub fn into_cycles(self) -> Vec<Progress> {
        self.cycles
    }

    /// Lets all phases, in the half of the birth where there are two, run on at `exp(−d_b/d)` until the next one of them ends.
    fn next_of_cycles(&mut self, birth: usize, decay_length: f64) -> Result<usize, Error> {
        let positions = self.tissue.simulation.positions();
        let half = self.halves.get(birth);
        let mut weights = self.weights(positions.iter().copied(), decay_length);
        for ((weight, r), taken) in weights.iter_mut().zip(positions).zip(&self.taken) {
            if *taken || half.is_some_and(|right| self.tissue.channel.is_right(*r) != *right) {
                *weight = 0.0;
            }
        }
        let left = |(own, weight): (&Progress, &f64)| (own.length - own.phase).max(0.0) / weight;
        let next =
            self.cycles.iter().zip(&weights).map(left).enumerate().filter(|(_, time)| time.is_finite());
        let (mother, time) = next.min_by(|a, b| a.1.total_cmp(&b.1)).ok_or_else(|| self.no_place())?;
        self.cycles.iter_mut().zip(&weights).for_each(|(own, weight)| own.phase += weight * time);
        self.taken[mother] = true;
        Ok(mother)
    }

    /// One that divides near its end, drawn by weight: of the last fifth of the cycles, or if there is none of all.
    pub fn in_two_near_the_end(
        &self,
        cycle: CellCycle,
        decay_length: f64,
        rng: &mut impl Rng,
    ) -> Result<Birth, Error> {
        let positions = self.tissue.simulation.positions();
        let mut weights = self.weights(positions.iter().copied(), decay_length);
        let is_near = |own: &Progress| own.phase > 0.8 * own.length;
        if self.cycles.iter().any(is_near) {
            let early = self.cycles.iter().zip(&mut weights).filter(|(own, _)| !is_near(own));
            early.for_each(|(_, weight)| *weight = 0.0);
        }
        let mother = self.draw(0, &weights, |cell| positions[cell], rng)?;
        Ok(self.in_two(mother, cycle, rng))
    }

    /// The place of the daughter of a given mother.
    pub fn of_mother(&mut self, mother: usize, rng: &mut impl Rng) -> Result<Birth, Error> {
        match self.injection {
            Injection::Division { distance } => return Ok(self.beside(mother, distance, rng)),
            Injection::Cycle(cycle) => return Ok(self.in_two(mother, cycle, rng)),
            Injection::Vertex => {}
        }
        let (tessellation, positions) =
            (self.tissue.simulation.tessellation(), self.tissue.simulation.positions_with_images());
        let mut polygon = CellPolygon::default();
        polygon.fill(tessellation, positions, mother);
        let vertices: Vec<_> = polygon.vertices().map(|vertex| positions[mother] + vertex).collect();
        let neighbours = tessellation.neighbours(mother);
        let sides = neighbours.len();
        // Vertex m lies between neighbours m and m + 1.
        let beyond = |m: usize| [neighbours[m] as usize, neighbours[(m + 1) % sides] as usize];
        let is_free = |&m: &usize| self.is_in_front(&beyond(m), vertices[m]) && self.are_free(&beyond(m));
        let free: Vec<usize> = (0..sides).filter(is_free).collect();
        if free.is_empty() {
            return Err(self.no_place());
        }
        let chosen = free[rng.random_range(0..free.len())];
        beyond(chosen).into_iter().chain([mother]).for_each(|cell| self.taken[cell] = true);
        Ok(Birth { place: vertices[chosen], mother: Some(mother), sister: None })
    }

    fn on_any_vertices(&mut self, decay_length: f64, rng: &mut impl Rng) -> Result<Vec<Birth>, Error> {
        let (tessellation, positions) =
            (self.tissue.simulation.tessellation(), self.tissue.simulation.positions_with_images());
        let domain = tessellation.domain();
        let vertex = |triangle: Triangle| {
            let cells = triangle.cells.map(|cell| cell as usize);
            let [first, second, third] = cells.map(|cell| positions[cell]);
            let [_, a, b] = triangle.images;
            let centre =
                circumcentre(domain.displacement(first, second, a), domain.displacement(first, third, b));
            (cells, first + centre)
        };
        let vertices: Vec<_> = (tessellation.triangles().into_iter().map(vertex))
            .filter(|(cells, place)| self.is_in_front(cells, *place))
            .collect();
        let mut weights = self.weights(vertices.iter().map(|(_, place)| *place), decay_length);
        (0..self.births)
            .map(|birth| {
                for (weight, (cells, _)) in weights.iter_mut().zip(&vertices) {
                    if !self.are_free(cells) {
                        *weight = 0.0;
                    }
                }
                let (cells, place) =
                    vertices[self.draw(birth, &weights, |vertex| vertices[vertex].1, rng)?];
                cells.iter().for_each(|&cell| self.taken[cell] = true);
                Ok(Birth { place, mother: None, sister: None })
            })
            .collect()
    }

    /// Whether a vertex at which these cells meet is one between the walls: of cells alone, no mirror images, and not on a wall.
    fn is_in_front(&self, cells: &[usize], place: Vector<f64>) -> bool {
        let simulation = &self.tissue.simulation;
        let count = simulation.positions().len();
        cells.iter().all(|&cell| cell < count)
            && room(self.tissue.channel, place, CLEARANCE * simulation.spacing())
                .iter()
                .all(|&room| room > 0.0)
    }

    fn are_free(&self, cells: &[usize]) -> bool {
        cells.iter().all(|&cell| !self.taken[cell])
    }

    /// The place of a daughter beside a mother, in a random direction; between walls in one that does not lead behind them.
    fn beside(&self, mother: usize, distance: f64, rng: &mut impl Rng) -> Birth {
        let simulation = &self.tissue.simulation;
        let from = simulation.positions()[mother];
        let angle = rng.random_range(0.0..TAU);
        let [left, right] = room(self.tissue.channel, from, CLEARANCE * simulation.spacing());
        let [first, last] = [right, -left].map(|room| (room / distance).clamp(-1.0, 1.0).acos());
        // From the direction as far to the right as there is room on to the left, and back below.
        let angle = if first == 0.0 && last == PI {
            angle
        } else if angle < PI {
            first + angle / PI * (last - first)
        } else {
            TAU - first - (TAU - angle) / PI * (last - first)
        };
        let place = from + Vector::new(angle.cos(), angle.sin()) * distance;
        Birth { place, mother: Some(mother), sister: None }
    }

    /// The places of two daughters at equal distances from where their mother was; between walls the axis is turned as far as it must for both to be in
    /// front of them.
    fn in_two(&self, mother: usize, cycle: CellCycle, rng: &mut impl Rng) -> Birth {
        let simulation = &self.tissue.simulation;
        let from = simulation.positions()[mother];
        let mut polygon = CellPolygon::default();
        polygon.fill(simulation.tessellation(), simulation.positions_with_images(), mother);
        let angle = match cycle.axis {
            DivisionAxis::Long => {
                let [xx, xy] = polygon.shape_tensor();
                0.5 * xy.atan2(xx)
            }
            DivisionAxis::Random => rng.random_range(0.0..TAU),
        };
        let axis = Vector::new(angle.cos(), angle.sin());
        let apart = 0.5 * cycle.distance.unwrap_or_else(|| distance_of_halves(&polygon, axis));
        let [left, right] = room(self.tissue.channel, from, CLEARANCE * simulation.spacing());
        let most = (left.min(right) / apart).clamp(0.0, 1.0);
        let x = axis.x.clamp(-most, most);
        let y = if x == axis.x { axis.y } else { (1.0 - x * x).sqrt().copysign(axis.y) };
        let way = Vector::new(x, y) * apart;
        Birth { place: from + way, mother: Some(mother), sister: Some(from - way) }
    }

    /// `exp(−d_b/d)` of each place, relative to the largest.
    fn weights(&self, places: impl Iterator<Item = Vector<f64>>, decay_length: f64) -> Vec<f64> {
        let distances: Vec<f64> = places.map(|place| self.tissue.channel.edge_distance(place)).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        distances.iter().map(|distance| (-(distance - least) / decay_length).exp()).collect()
    }

    /// One of the places with these weights for a birth.
    fn draw(
        &self,
        birth: usize,
        weights: &[f64],
        place: impl Fn(usize) -> Vector<f64>,
        rng: &mut impl Rng,
    ) -> Result<usize, Error> {
        let half = self.halves.get(birth);
        let fits =
            |index: usize| half.is_none_or(|right| self.tissue.channel.is_right(place(index)) == *right);
        let allowed =
            weights.iter().enumerate().map(|(index, weight)| if fits(index) { *weight } else { 0.0 });
        // Fails if nothing is left.
        let index = WeightedIndex::new(allowed).map_err(|_| self.no_place())?;
        Ok(index.sample(rng))
    }

    fn no_place(&self) -> Error {
        let time = self.tissue.simulation.time();
        Error::NoPlace { time, births: self.births, time_step: self.time_step }
    }
}

/// How many cells are born in a step, and from whom where that is drawn first.
pub(super) enum Demand {
    Replacing { decay_length: f64 },
    Mothers(Vec<usize>),
}

impl Demand {
    pub fn of(tissue: &LivingTissue, extruded: &[usize], time_step: f64, rng: &mut impl Rng) -> Self {
        match tissue.turnover.proliferation {
            Proliferation::Replacing { decay_length } => Self::Replacing { decay_length },
            Proliferation::Independent(rate) => {
                let mut mothers = match tissue.turnover.injection {
                    Injection::Cycle(_) => {
                        let ends = |own: &Progress| own.phase >= own.length;
                        (0..tissue.cycles.len()).filter(|&cell| ends(&tissue.cycles[cell])).collect()
                    }
                    _ => tissue.drawn(rate, time_step, rng),
                };
                mothers.retain(|cell| extruded.binary_search(cell).is_err());
                Self::Mothers(mothers)
            }
        }
    }
}

/// How far a place is from the walls left and right of it, less a clearance; infinitely if there are none.
fn room(channel: Channel, place: Vector<f64>, clearance: f64) -> [f64; 2] {
    if channel.is_walled() {
        [place.x, channel.width() - place.x].map(|distance| distance - clearance)
    } else {
        [f64::INFINITY; 2]
    }
}
