//! Places for new cells.

use super::{Injection, LivingTissue, Proliferation};
use crate::Error;
use rand::Rng;
use rand::distr::{Distribution, weighted::WeightedIndex};
use voronudge_geometry::{CellPolygon, Vector, circumcentre};

/// Where a cell is born, and from whom.
pub(super) struct Birth {
    pub place: Vector<f64>,
    /// Index of the mother among the cells of the step.
    pub mother: Option<usize>,
}

/// Draws places of one step. No two events of a step concern the same cells.
pub(super) struct Places<'a> {
    tissue: &'a LivingTissue,
    injection: Injection,
    /// Cells that are extruded or next to a new cell.
    taken: Vec<bool>,
    births: usize,
    time_step: f64,
}

impl<'a> Places<'a> {
    pub fn new(tissue: &'a LivingTissue, extruded: &[usize], births: usize, time_step: f64) -> Self {
        let mut taken = vec![false; tissue.simulation.positions().len()];
        extruded.iter().for_each(|&cell| taken[cell] = true);
        Self { tissue, injection: tissue.turnover.injection, taken, births, time_step }
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
                    .map(|_| {
                        weights
                            .iter_mut()
                            .zip(&self.taken)
                            .filter(|(_, taken)| **taken)
                            .for_each(|(w, _)| *w = 0.0);
                        let mother = self.draw(&weights, rng)?;
                        self.taken[mother] = true;
                        Ok(beside(positions, mother, distance, rng))
                    })
                    .collect()
            }
        }
    }

    /// The place of the daughter of a given mother.
    pub fn of_mother(&mut self, mother: usize, rng: &mut impl Rng) -> Result<Birth, Error> {
        let (tessellation, positions) =
            (self.tissue.simulation.tessellation(), self.tissue.simulation.positions());
        if let Injection::Division { distance } = self.injection {
            return Ok(beside(positions, mother, distance, rng));
        }
        let mut polygon = CellPolygon::default();
        polygon.fill(tessellation, positions, mother);
        let neighbours = tessellation.neighbours(mother);
        let sides = neighbours.len();
        // Vertex m lies between neighbours m and m + 1.
        let beyond = |m: usize| [neighbours[m] as usize, neighbours[(m + 1) % sides] as usize];
        let free: Vec<usize> =
            (0..sides).filter(|&m| beyond(m).iter().all(|&cell| !self.taken[cell])).collect();
        if free.is_empty() {
            return Err(self.no_place());
        }
        let chosen = free[rng.random_range(0..free.len())];
        beyond(chosen).into_iter().chain([mother]).for_each(|cell| self.taken[cell] = true);
        let vertex = polygon.vertices().nth(chosen).unwrap_or_default();
        Ok(Birth { place: positions[mother] + vertex, mother: Some(mother) })
    }

    fn on_any_vertices(&mut self, decay_length: f64, rng: &mut impl Rng) -> Result<Vec<Birth>, Error> {
        let (tessellation, positions) =
            (self.tissue.simulation.tessellation(), self.tissue.simulation.positions());
        let domain = tessellation.domain();
        let triangles = tessellation.triangles();
        let place = |triangle: &voronudge_geometry::Triangle| {
            let [first, second, third] = triangle.cells.map(|cell| positions[cell as usize]);
            let [_, a, b] = triangle.images;
            first + circumcentre(domain.displacement(first, second, a), domain.displacement(first, third, b))
        };
        let places: Vec<_> = triangles.iter().map(place).collect();
        let mut weights = self.weights(places.iter().copied(), decay_length);
        (0..self.births)
            .map(|_| {
                for (weight, triangle) in weights.iter_mut().zip(&triangles) {
                    if triangle.cells.iter().any(|&cell| self.taken[cell as usize]) {
                        *weight = 0.0;
                    }
                }
                let chosen = self.draw(&weights, rng)?;
                triangles[chosen].cells.iter().for_each(|&cell| self.taken[cell as usize] = true);
                Ok(Birth { place: places[chosen], mother: None })
            })
            .collect()
    }

    /// `exp(−d_b/d)` of each place, relative to the largest.
    fn weights(&self, places: impl Iterator<Item = Vector<f64>>, decay_length: f64) -> Vec<f64> {
        let distances: Vec<f64> = places.map(|place| self.tissue.channel.edge_distance(place)).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        distances.iter().map(|distance| (-(distance - least) / decay_length).exp()).collect()
    }

    fn draw(&self, weights: &[f64], rng: &mut impl Rng) -> Result<usize, Error> {
        // Fails if nothing is left.
        let index = WeightedIndex::new(weights).map_err(|_| self.no_place())?;
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
                let mut mothers = tissue.drawn(rate, time_step, rng);
                mothers.retain(|cell| extruded.binary_search(cell).is_err());
                Self::Mothers(mothers)
            }
        }
    }
}

fn beside(positions: &[Vector<f64>], mother: usize, distance: f64, rng: &mut impl Rng) -> Birth {
    let angle = rng.random_range(0.0..std::f64::consts::TAU);
    let place = positions[mother] + Vector::new(angle.cos(), angle.sin()) * distance;
    Birth { place, mother: Some(mother) }
}
