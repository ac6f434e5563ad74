//! What turns the polarities of cells that propel themselves.

use crate::Driving;
use crate::driving::{CHUNK, stream};
use rand::Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;
use std::sync::Arc;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::{Environment, HalfEdgeForces, Model, effect::away_from_contacts};

/// Polarities of cells, `p = v₀ s (cos θ, sin θ)`.
#[derive(Debug, Clone, Default)]
pub(crate) struct Headings {
    /// θ (N, radians); empty if nothing propels itself.
    pub angles: Vec<f64>,
    /// s (N); empty if it is one.
    pub speeds: Vec<f64>,
}

impl Headings {
    /// The polarity of a cell over v₀.
    pub fn of(&self, cell: usize) -> Vector<f64> {
        let angle = self.angles.get(cell).copied().unwrap_or(0.0);
        Vector::new(angle.cos(), angle.sin()) * self.speeds.get(cell).copied().unwrap_or(1.0)
    }

    /// Puts polarities over v₀ in place of those that are there.
    fn set(&mut self, polarities: Vec<Vector<f64>>) {
        self.angles = polarities.iter().map(|p| p.y.atan2(p.x)).collect();
        self.speeds = polarities.iter().map(Vector::norm).collect();
    }
}

impl Driving {
    /// Random polarities; none if nothing propels itself.
    pub(crate) fn first_headings(&self, cells: usize) -> Headings {
        if self.speed == 0.0 {
            return Headings::default();
        }
        let mut rng = stream(self.seed, u64::MAX, 0);
        let angles = (0..cells).map(|_| rng.random_range(0.0..std::f64::consts::TAU)).collect();
        let mut rng = stream(self.seed, u64::MAX, 1);
        // Both components are normal, and the mean square is one.
        let mut speed = || (-(1.0 - rng.random::<f64>()).ln()).sqrt();
        let speeds = if self.free_speed { (0..cells).map(|_| speed()).collect() } else { Vec::new() };
        Headings { angles, speeds }
    }

    /// What drives the polarity of each cell, `b n + κ F`, at positions with their velocities; none if nothing does.
    pub(crate) fn drive(
        &self,
        (tessellation, positions): (&Tessellation, &[Vector<f64>]),
        velocities: &[Vector<f64>],
        (headings, time): (&Headings, f64),
        environment: &Arc<Environment>,
    ) -> Vec<Vector<f64>> {
        if !self.drives() {
            return Vec::new();
        }
        let mut drive = vec![Vector::zeros(); velocities.len()];
        if self.contact_inhibition != 0.0 {
            let (column, sign) = away_from_contacts();
            let away = Model::with_coefficients(&[], &[]).with(column, sign * self.contact_inhibition);
            let mut forces = HalfEdgeForces::default();
            forces.evaluate(tessellation, positions, &away.within(environment), &mut drive);
        }
        if self.velocity_alignment != 0.0 {
            let rate = self.shear.map_or(0.0, |shear| shear.rate(time));
            for (cell, (drive, v)) in drive.iter_mut().zip(velocities).enumerate() {
                let streaming = Vector::new(rate * positions[cell].y, 0.0);
                *drive += (v - streaming - headings.of(cell) * self.speed) * self.velocity_alignment;
            }
        }
        drive
    }

    /// Turns the polarities towards those of the neighbours and along what drives them (first order in the step, as is the noise).
    pub(crate) fn turn(
        &self,
        headings: &mut Headings,
        tessellation: &Tessellation,
        drive: &[Vector<f64>],
        time_step: f64,
    ) {
        if headings.angles.is_empty() || (self.alignment == 0.0 && drive.is_empty()) {
            return;
        }
        let (before, rate) = (headings.clone(), self.alignment / 6.0);
        let driven = |cell: usize| drive.get(cell).map_or(Vector::zeros(), |own| own / self.speed);
        let neighbours = |cell: usize| tessellation.neighbours(cell).iter().map(|other| *other as usize);
        if !before.speeds.is_empty() {
            let turned = |cell: usize| {
                let own = before.of(cell);
                let sum: Vector<f64> = neighbours(cell).map(|other| before.of(other) - own).sum();
                own + (sum * rate + driven(cell)) * time_step
            };
            return headings.set((0..before.angles.len()).map(turned).collect());
        }
        let angles = &before.angles;
        let turn = |(cell, angle): (usize, &mut f64)| {
            let sum: f64 = neighbours(cell).map(|other| (angles[other] - angles[cell]).sin()).sum();
            let across = driven(cell).dot(&Vector::new(-angles[cell].sin(), angles[cell].cos()));
            *angle += (rate * sum + across) * time_step;
        };
        headings.angles.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(turn);
    }

    /// Adds the noise of one step to the polarities.
    pub(crate) fn disturb(&self, headings: &mut Headings, step: u64, time_step: f64) {
        if self.rotational_diffusion == 0.0 || headings.angles.is_empty() {
            return;
        }
        let chunk_of = |chunk: usize| stream(self.seed, step, 2 * chunk as u64 + 1);
        if headings.speeds.is_empty() {
            let size = (2.0 * self.rotational_diffusion * time_step).sqrt();
            headings.angles.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, angles)| {
                let mut rng = chunk_of(chunk);
                angles.iter_mut().for_each(|angle| *angle += size * rng.sample::<f64, _>(StandardNormal));
            });
            return;
        }
        let kept = (-self.rotational_diffusion * time_step).exp();
        let size = (0.5 * (1.0 - kept * kept)).sqrt();
        let mut polarities: Vec<Vector<f64>> =
            (0..headings.angles.len()).map(|cell| headings.of(cell) * kept).collect();
        polarities.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, polarities)| {
            let mut rng = chunk_of(chunk);
            for p in polarities {
                let (x, y): (f64, f64) = (rng.sample(StandardNormal), rng.sample(StandardNormal));
                *p += Vector::new(x, y) * size;
            }
        });
        headings.set(polarities);
    }
}
