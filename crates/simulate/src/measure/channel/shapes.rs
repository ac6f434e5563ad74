//! Shapes of cells by their age and their distance from the edge.

use super::Estimate;
use crate::{LivingTissue, Origin};
use voronudge_geometry::CellPolygon;

/// Mean `P/√A` of the cells at some distances from the nearer edge and of some ages, over equal pieces of time ("samples").
///
/// The age of a founder is not known: it counts with the oldest, once it is.
#[derive(Debug, Clone)]
pub struct ShapeRecorder {
    distances: Vec<f64>,
    ages: Vec<f64>,
    current: Vec<(f64, f64)>,
    samples: Vec<Vec<(f64, f64)>>,
}

/// Shapes by distance and age.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapesByAge {
    /// Upper ends of the distances, ascending; the last is infinite.
    pub distances: Vec<f64>,
    /// Upper ends of the ages, ascending; the last is infinite.
    pub ages: Vec<f64>,
    /// Mean `P/√A`, a row for each distance.
    pub shape_index: Vec<Vec<Estimate>>,
    /// Cells seen, the same again and again.
    pub seen: Vec<Vec<f64>>,
}

impl ShapeRecorder {
    /// For distances below the ends given, in the unit of the box, and ages, in that of time; both ascending, with all beyond as the last.
    pub fn new(distances: &[f64], ages: &[f64]) -> Self {
        let with_all = |ends: &[f64]| ends.iter().copied().chain([f64::INFINITY]).collect::<Vec<_>>();
        let (distances, ages) = (with_all(distances), with_all(ages));
        let current = vec![(0.0, 0.0); distances.len() * ages.len()];
        Self { distances, ages, current, samples: Vec::new() }
    }

    /// Looks at the cells as they are.
    pub fn look(&mut self, tissue: &LivingTissue) {
        let simulation = tissue.simulation();
        let (tessellation, positions) = (simulation.tessellation(), simulation.positions_with_images());
        let class = |ends: &[f64], value: f64| ends.partition_point(|end| *end <= value).min(ends.len() - 1);
        let mut polygon = CellPolygon::default();
        for (cell, &life) in tissue.identities().iter().enumerate() {
            let life = tissue.lives()[life];
            let age = class(&self.ages, simulation.time() - life.born);
            if life.origin == Origin::Founder && age + 1 < self.ages.len() {
                continue;
            }
            let distance = class(&self.distances, tissue.channel().edge_distance(positions[cell]));
            polygon.fill(tessellation, positions, cell);
            let shape = polygon.shape();
            let (sum, count) = &mut self.current[distance * self.ages.len() + age];
            *sum += shape.perimeter / shape.area.sqrt();
            *count += 1.0;
        }
    }

    /// Ends a sample: what comes next counts for the next.
    pub fn end_sample(&mut self) {
        let empty = vec![(0.0, 0.0); self.current.len()];
        self.samples.push(std::mem::replace(&mut self.current, empty));
    }

    /// Averages over the samples.
    pub fn shapes(&self) -> ShapesByAge {
        let at = |class: usize| self.samples.iter().map(|sample| sample[class]).collect::<Vec<_>>();
        let classes = |distance: usize| distance * self.ages.len()..(distance + 1) * self.ages.len();
        let rows = 0..self.distances.len();
        ShapesByAge {
            distances: self.distances.clone(),
            ages: self.ages.clone(),
            shape_index: (rows.clone())
                .map(|row| classes(row).map(|class| Estimate::ratio(&at(class))).collect())
                .collect(),
            seen: rows
                .map(|row| classes(row).map(|class| at(class).iter().map(|(_, count)| count).sum()).collect())
                .collect(),
        }
    }
}
