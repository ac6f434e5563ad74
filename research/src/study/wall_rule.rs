//! Walls as here, whose vertices slide, beside those of the paper, whose vertices are left out of the equation of motion.

use super::flows::{AVERAGE, TRANSIENT, parameters, random};
use super::seeds::{Replicas, mean, on_one_core_each};
use crate::Outcome;
use std::error::Error;
use voronudge_geometry::{CellPolygon, PeriodicBox, Vector};
use voronudge_model::{Model, VertexForces};
use voronudge_simulate::{CellsAndImages, Walls};

const CELLS: usize = 100;
/// P_0 and α: solids below and above the threshold of edge currents, and a liquid.
const POINTS: [[f64; 2]; 5] = [[3.4, 0.05], [3.4, 0.3], [3.4, 0.5], [3.9, 0.3], [3.9, 0.5]];
const STEP: f64 = 0.02;

/// Cells between four walls under the paper's rule.
struct Papers {
    cell_box: PeriodicBox,
    positions: Vec<Vector<f64>>,
    model: Model<f64>,
}

impl Papers {
    fn all(&self, positions: &[Vector<f64>]) -> Result<CellsAndImages, Box<dyn Error>> {
        Ok(Walls::Both.with_images(&self.cell_box, positions, &[])?)
    }

    /// Velocities: no force on a vertex that an image shares is handed to the cells.
    fn velocities(&self, positions: &[Vector<f64>]) -> Result<Vec<Vector<f64>>, Box<dyn Error>> {
        let CellsAndImages { tessellation, positions: all, .. } = self.all(positions)?;
        let cells = positions.len();
        let mut v = vec![Vector::zeros(); cells];
        let mut polygon = CellPolygon::default();
        for cell in 0..cells {
            polygon.fill(&tessellation, &all, cell);
            let forces = VertexForces::of_cell(
                &self.model,
                self.model.site(cell, polygon.len(), positions[cell]),
                polygon.shape(),
            );
            let neighbours = tessellation.neighbours(cell);
            for (m, corner) in polygon.corners().iter().enumerate() {
                let pair = [neighbours[m], neighbours[(m + 1) % neighbours.len()]].map(|own| own as usize);
                if pair.iter().any(|neighbour| *neighbour >= cells) {
                    continue;
                }
                let force = forces.on_vertex(polygon.area_gradient(m), polygon.perimeter_gradient(m));
                let handed = corner.pull_back(force);
                for (neighbour, on) in pair.into_iter().zip(handed) {
                    v[neighbour] += on;
                    v[cell] -= on;
                }
            }
        }
        Ok(v)
    }

    /// One step of the classical method of Runge and Kutta; cells behind a wall are put in front of it.
    fn step(&mut self) -> Result<(), Box<dyn Error>> {
        let from = self.positions.clone();
        let moved = |v: &[Vector<f64>], time: f64| -> Vec<Vector<f64>> {
            from.iter().zip(v).map(|(r, v)| r + v * time).collect()
        };
        let first = self.velocities(&from)?;
        let second = self.velocities(&moved(&first, 0.5 * STEP))?;
        let third = self.velocities(&moved(&second, 0.5 * STEP))?;
        let fourth = self.velocities(&moved(&third, STEP))?;
        let lengths = self.cell_box.lengths();
        for (cell, r) in self.positions.iter_mut().enumerate() {
            *r += (first[cell] + (second[cell] + third[cell]) * 2.0 + fourth[cell]) * (STEP / 6.0);
            for axis in 0..2 {
                let within = r[axis].abs();
                r[axis] = if within > lengths[axis] { 2.0 * lengths[axis] - within } else { within };
            }
        }
        Ok(())
    }

    /// Mean velocity of the cells that touch a wall along it, anticlockwise.
    fn edge_velocity(&self) -> Result<f64, Box<dyn Error>> {
        let (tessellation, v) = (self.all(&self.positions)?.tessellation, self.velocities(&self.positions)?);
        let (cells, lengths) = (self.positions.len(), self.cell_box.lengths());
        let (mut sum, mut count) = (0.0, 0.0);
        for (cell, (r, v)) in self.positions.iter().zip(&v).enumerate() {
            for axis in 0..2 {
                let own_image = (cell + (cells << axis)) as u32;
                if tessellation.neighbours(cell).contains(&own_image) {
                    let far = if r[axis] > 0.5 * lengths[axis] { 1.0 } else { -1.0 };
                    sum += if axis == 0 { far * v.y } else { -far * v.x };
                    count += 1.0;
                }
            }
        }
        Ok(sum / count)
    }
}

/// Mean edge velocity under either rule, from the same start.
fn edge_velocities(
    [preferred_perimeter, chirality]: [f64; 2],
    seed: u64,
) -> Result<[f64; 2], Box<dyn Error>> {
    let at = parameters(preferred_perimeter, chirality);
    let mut ours = random(CELLS, &at, seed)?;
    let mut papers = Papers {
        cell_box: ours.cell_box(),
        positions: ours.positions().iter().map(|r| ours.cell_box().wrap(*r)).collect(),
        model: ours.model().clone(),
    };
    ours = ours.with_walls(Walls::Both)?;
    let steps = |time: f64| (time / STEP).round() as usize;
    let mut sums = [0.0; 2];
    for step in 0..steps(TRANSIENT + AVERAGE) {
        ours.step(STEP)?;
        papers.step()?;
        if step >= steps(TRANSIENT) && step % 10 == 0 {
            sums[0] += ours.edge_velocity().unwrap_or(f64::NAN);
            sums[1] += papers.edge_velocity()?;
        }
    }
    Ok(sums.map(|sum| sum * 10.0 / steps(AVERAGE) as f64))
}

pub fn run(replicas: Replicas) -> Outcome {
    println!(
        "| P_0 | α | v_E, vertices on walls slide | v_E, they are left out, as in the paper |\n|---|---|---|---|"
    );
    let seeds: Vec<u64> = replicas.seeds().collect();
    for point in POINTS {
        let all = on_one_core_each(replicas.count, |k| edge_velocities(point, seeds[k as usize]))?;
        let [ours, papers] =
            [0, 1].map(|rule: usize| mean(&all.iter().map(|own| own[rule]).collect::<Vec<_>>()));
        println!(
            "| {} | {} | {:.5} ± {:.5} | {:.5} ± {:.5} |",
            point[0], point[1], ours.0, ours.1, papers.0, papers.1
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Far from walls both rules are one; momentum is conserved by interior vertices alone, so by all that is handed on.
    #[test]
    fn the_rules_differ_beside_walls_only() {
        let at = parameters(3.4, 0.5);
        let free = random(CELLS, &at, 3).unwrap();
        let cell_box = free.cell_box();
        let papers = Papers {
            cell_box,
            positions: free.positions().iter().map(|r| cell_box.wrap(*r)).collect(),
            model: free.model().clone(),
        };
        let ours = free.with_walls(Walls::Both).unwrap();
        let v = papers.velocities(&papers.positions).unwrap();
        assert!(v.iter().sum::<Vector<f64>>().norm() < 1e-10);
        let [width, height] = cell_box.lengths();
        let (mut same, mut other) = (0, 0);
        for ((r, a), b) in papers.positions.iter().zip(&v).zip(ours.velocities()) {
            let depth = r.x.min(width - r.x).min(r.y).min(height - r.y);
            let differ = (a - b).norm() > 1e-9;
            assert!(!differ || depth < 3.0, "{depth}");
            if differ { other += 1 } else { same += 1 }
        }
        assert!(same > 10 && other > 20, "{same} {other}");
    }
}
