//! What turns the polarities of cells that propel themselves.

use crate::Driving;
use crate::driving::{CHUNK, stream};
use crate::headings::Headings;
use crate::scaled::{times, zero};
use rand::Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;
use std::sync::Arc;
use voronudge_geometry::{Scalar, Tessellation, Vector};
use voronudge_model::{Environment, Model, VelocityAssembly, effect::away_from_contacts};

impl Driving {
    /// Random polarities; none if nothing propels itself.
    pub(crate) fn first_headings<S: Scalar>(&self, cells: usize) -> Headings<S> {
        if self.speed == 0.0 {
            return Headings::default();
        }
        let mut rng = stream(self.seed, u64::MAX, 0);
        let angles = (0..cells).map(|_| S::constant(rng.random_range(0.0..std::f64::consts::TAU))).collect();
        let mut rng = stream(self.seed, u64::MAX, 1);
        // Both components are normal, and the mean square is one.
        let mut speed = || S::constant((-(1.0 - rng.random::<f64>()).ln()).sqrt());
        let speeds = if self.free_speed { (0..cells).map(|_| speed()).collect() } else { Vec::new() };
        Headings { angles, speeds }
    }

    /// What drives the polarity of each cell, `b n + κ F`, at positions with their velocities; none if nothing does.
    pub(crate) fn drive<S: Scalar>(
        &self,
        (tessellation, positions): (&Tessellation, &[Vector<S>]),
        velocities: &[Vector<S>],
        (headings, time): (&Headings<S>, f64),
        environment: &Arc<Environment>,
    ) -> Vec<Vector<S>> {
        if !self.drives() {
            return Vec::new();
        }
        let mut drive = vec![zero(); velocities.len()];
        if self.contact_inhibition != 0.0 {
            let (column, sign) = away_from_contacts();
            let strength = S::constant(sign * self.contact_inhibition);
            let away = Model::with_coefficients(&[], &[]).with(column, strength);
            let mut assembly = VelocityAssembly::default();
            assembly.evaluate(tessellation, positions, &away.within(environment), &mut drive);
        }
        if self.velocity_alignment != 0.0 {
            let rate = self.shear.map_or(0.0, |shear| shear.rate(time));
            for (cell, (drive, v)) in drive.iter_mut().zip(velocities).enumerate() {
                let streaming = Vector::new(positions[cell].y * rate, S::constant(0.0));
                let own = v - streaming - times(headings.of(cell), self.speed);
                *drive += times(own, self.velocity_alignment);
            }
        }
        drive
    }

    /// Turns the polarities towards those of the neighbours and along what drives them (first order in the step, as is the noise).
    pub(crate) fn turn<S: Scalar>(
        &self,
        headings: &mut Headings<S>,
        tessellation: &Tessellation,
        drive: &[Vector<S>],
        time_step: f64,
    ) {
        if headings.angles.is_empty() || (self.alignment == 0.0 && drive.is_empty()) {
            return;
        }
        let (before, rate) = (headings.clone(), self.alignment / 6.0);
        let over_speed = |own: &Vector<S>| Vector::new(own.x / self.speed, own.y / self.speed);
        let driven = |cell: usize| drive.get(cell).map_or(zero(), over_speed);
        let neighbours = |cell: usize| tessellation.neighbours(cell).iter().map(|other| *other as usize);
        if !before.speeds.is_empty() {
            let turned = |cell: usize| {
                let own = before.of(cell);
                let apart = |other| before.of(other) - own;
                let sum = neighbours(cell).map(apart).fold(zero(), |sum: Vector<S>, part| sum + part);
                own + times(times(sum, rate) + driven(cell), time_step)
            };
            return headings.set((0..before.angles.len()).map(turned).collect());
        }
        let angles = &before.angles;
        let turn = |(cell, angle): (usize, &mut S)| {
            let sum: S = neighbours(cell).map(|other| (angles[other] - angles[cell]).sin()).sum();
            let drive = driven(cell);
            let across = drive.x * -angles[cell].sin() + drive.y * angles[cell].cos();
            *angle += (sum * rate + across) * time_step;
        };
        headings.angles.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(turn);
    }

    /// Adds the noise of one step to the polarities.
    pub(crate) fn disturb<S: Scalar>(&self, headings: &mut Headings<S>, step: u64, time_step: f64) {
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
        let mut polarities: Vec<Vector<S>> =
            (0..headings.angles.len()).map(|cell| times(headings.of(cell), kept)).collect();
        polarities.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, polarities)| {
            let mut rng = chunk_of(chunk);
            for p in polarities {
                let (x, y): (f64, f64) = (rng.sample(StandardNormal), rng.sample(StandardNormal));
                *p += Vector::new(S::constant(x * size), S::constant(y * size));
            }
        });
        headings.set(polarities);
    }
}
