//! One step of a simulation.

use super::{Simulation, Stage};
use crate::Error;
use crate::headings::Headings;
use crate::method::{THIRD_ORDER, change_of_step, largest_error};
use crate::scaled::{real, times, zero};
use rayon::prelude::*;
use voronudge_geometry::{Scalar, Vector};

/// Largest displacement in one step, in mean spacings.
const LIMIT: f64 = 1.0;

/// The part of a step below which the adaptive method goes on whatever the error: at a T1 the velocity may jump.
const LEAST_PART: f64 = 1e-6;

/// Cells per task in sums over fields.
pub(super) const CHUNK: usize = 1024;

/// Parts into which a step is cut at most if a cell moves too far in it.
const MOST_PARTS: u32 = 1024;

impl<S: Scalar> Simulation<S> {
    /// As [`step`](Self::step); a step in which a cell would move by more than the mean spacing is cut into 2, 4, … 1024 parts.
    ///
    /// # Errors
    /// Those of [`step`](Self::step), of a step that cannot be cut further. What was made of its parts stays.
    pub fn step_or_parts(&mut self, time_step: f64) -> Result<(), Error> {
        self.halved(time_step, 1)
    }

    fn halved(&mut self, time_step: f64, parts: u32) -> Result<(), Error> {
        match self.step(time_step) {
            Err(Error::StepTooLarge { .. }) if parts < MOST_PARTS => {
                self.halved(0.5 * time_step, 2 * parts)?;
                self.halved(0.5 * time_step, 2 * parts)
            }
            other => other,
        }
    }

    pub(super) fn runge_kutta(&mut self, stage: &mut Stage<S>, time_step: f64) -> Result<(), Error> {
        let Stage { positions, headings, slopes: [slope, sum, _] } = stage;
        let middle = self.now.time + 0.5 * time_step;
        *headings = self.now.polarities();
        self.displace(positions, &[&self.velocities], 0.5 * time_step, time_step)?;
        self.evaluate(positions, headings, middle, slope)?;
        sum.resize(slope.len(), zero());
        let all = sum.par_iter_mut().zip(&self.velocities).zip(&*slope).with_min_len(CHUNK);
        all.for_each(|((sum, first), second)| *sum = first + times(*second, 2.0));
        self.displace(positions, &[slope], 0.5 * time_step, time_step)?;
        self.evaluate(positions, headings, middle, slope)?;
        add_scaled(sum, slope, 2.0);
        self.displace(positions, &[slope], time_step, time_step)?;
        self.evaluate(positions, headings, self.now.time + time_step, slope)?;
        self.displace(positions, &[sum, slope], time_step / 6.0, time_step)?;
        self.arrive(positions, headings, slope, time_step)
    }

    /// Goes over to new positions after noise, and to their velocities.
    fn arrive(
        &mut self,
        positions: &mut Vec<Vector<S>>,
        headings: &mut Headings<S>,
        velocities: &mut Vec<Vector<S>>,
        time_step: f64,
    ) -> Result<(), Error> {
        *headings = self.now.polarities();
        self.driving.turn(headings, self.tessellation.tessellation(), &self.drive, time_step);
        if self.driving.shakes() {
            self.driving.shake(positions, self.now.steps, time_step);
            self.driving.disturb(headings, self.now.steps, time_step);
            self.check_displacements(positions, time_step)?;
        }
        self.evaluate(positions, headings, self.now.time + time_step, velocities)?;
        std::mem::swap(&mut self.now.positions, positions);
        self.now.set_polarities(headings);
        std::mem::swap(&mut self.velocities, velocities);
        if let Some(mirrored) = &self.mirrored {
            self.now.crossings += mirrored.bring_back(&mut self.now.positions, &mut self.velocities);
        }
        self.now.time += time_step;
        self.now.steps += 1;
        if self.put_back()? {
            return self.settle();
        }
        self.settle_drive();
        Ok(())
    }

    /// A step in parts of the embedded method of orders three and two.
    pub(super) fn in_parts(
        &mut self,
        stage: &mut Stage<S>,
        time_step: f64,
        tolerance: f64,
    ) -> Result<(), Error> {
        let end = self.now.time + time_step;
        let least = LEAST_PART * time_step;
        let allowed = tolerance * self.spacing;
        loop {
            let left = end - self.now.time;
            if left <= 1e-12 * time_step {
                self.now.time = end;
                return Ok(());
            }
            let wanted = self.now.part.unwrap_or(0.1 * time_step).max(least);
            let part = if wanted >= left { left } else { wanted };
            let share = match self.bogacki_shampine(stage, part) {
                Ok(error) => error / allowed,
                Err(Error::StepTooLarge { .. }) if part > least => f64::INFINITY,
                Err(error) => return Err(error),
            };
            if share > 1.0 && part > least {
                self.now.part = Some(part * change_of_step(share).min(0.9));
                continue;
            }
            let Stage { positions, headings, slopes: [_, _, last] } = &mut *stage;
            self.arrive(positions, headings, last, part)?;
            // The last part of a step is short for no reason of its own.
            self.now.part =
                Some((part * change_of_step(share)).max(if part < wanted { wanted } else { 0.0 }));
        }
    }

    /// Puts the result of third order into the stage and returns the largest estimated error of a displacement.
    fn bogacki_shampine(&mut self, stage: &mut Stage<S>, time_step: f64) -> Result<f64, Error> {
        let Stage { positions, headings, slopes: [second, third, fourth] } = stage;
        let now = self.now.time;
        *headings = self.now.polarities();
        self.displace(positions, &[&self.velocities], 0.5 * time_step, time_step)?;
        self.evaluate(positions, headings, now + 0.5 * time_step, second)?;
        self.displace(positions, &[second], 0.75 * time_step, time_step)?;
        self.evaluate(positions, headings, now + 0.75 * time_step, third)?;
        positions.clone_from(&self.now.positions);
        for (slope, weight) in [&self.velocities, &*second, &*third].into_iter().zip(THIRD_ORDER) {
            add_scaled(positions, slope, weight * time_step);
        }
        self.check_displacements(positions, time_step)?;
        self.evaluate(positions, headings, now + time_step, fourth)?;
        Ok(largest_error([&self.velocities, second, third, fourth], time_step))
    }

    /// `to = r + h Σ v`, the sum over some fields, within the limit of displacements.
    fn displace<const FIELDS: usize>(
        &self,
        to: &mut Vec<Vector<S>>,
        v: &[&Vec<Vector<S>>; FIELDS],
        h: f64,
        time_step: f64,
    ) -> Result<(), Error> {
        to.resize(self.now.positions.len(), zero());
        let from = self.now.positions.par_chunks(CHUNK);
        let limit = (LIMIT * self.spacing).powi(2);
        let near = to.par_chunks_mut(CHUNK).zip(from).enumerate().map(|(chunk, (to, from))| {
            let own = v.map(|field| &field[chunk * CHUNK..chunk * CHUNK + to.len()]);
            let mut near = true;
            for (cell, (to, from)) in to.iter_mut().zip(from).enumerate() {
                let sum = own[1..].iter().fold(own[0][cell], |sum, field| sum + field[cell]);
                let d = times(sum, h);
                *to = from + d;
                near &= real(&d).norm_squared() < limit;
            }
            near
        });
        // No short cut: every chunk has to be displaced.
        if near.reduce(|| true, |a, b| a & b) { Ok(()) } else { self.check_displacements(to, time_step) }
    }

    fn check_displacements(&self, positions: &[Vector<S>], time_step: f64) -> Result<(), Error> {
        let streaming = self.driving.shear.map_or(0.0, |shear| shear.rate(self.now.time)) * time_step;
        let moved = |(to, from): (&Vector<S>, &Vector<S>)| {
            let (to, from) = (real(to), real(from));
            (to - from - Vector::new(streaming * from.y, 0.0)).norm()
        };
        let limit = LIMIT * self.spacing;
        let pairs = positions.par_iter().zip(&self.now.positions).with_min_len(CHUNK);
        match pairs.map(moved).position_first(|distance| distance.is_nan() || distance > limit) {
            None => Ok(()),
            Some(cell) => {
                let distance = moved((&positions[cell], &self.now.positions[cell]));
                Err(Error::StepTooLarge { time: self.now.time, cell, distance, limit, time_step })
            }
        }
    }
}

/// `sum += weight v`
fn add_scaled<S: Scalar>(sum: &mut [Vector<S>], v: &[Vector<S>], weight: f64) {
    let rows = sum.par_iter_mut().zip(v).with_min_len(CHUNK);
    rows.for_each(|(sum, v)| *sum += times(*v, weight));
}
