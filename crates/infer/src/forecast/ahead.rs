//! A tissue that goes on by a model, in a box or in an open field of view.

use super::Forecaster;
use super::start::{Begun, Start, of_neighbours};
use super::turning::Turning;
use crate::Error;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::effect::away_from_contacts;
use voronudge_model::{Model, velocities};

/// Rounds in which cells at the rim learn from their neighbours how they move.
const ROUNDS: usize = 2;

/// Velocities of the cells of which they can be told.
pub(super) type Known = Vec<Option<Vector<f64>>>;

/// Cells and the model that moves them.
pub(super) struct Tissue<'a> {
    start: &'a Start<'a>,
    model: Model<f64>,
    scatter: f64,
}

impl<'a> Tissue<'a> {
    pub fn new(start: &'a Start<'a>, by: &Forecaster<'_>) -> Self {
        let earlier = (0..start.tracks.len()).map(|cell| start.velocity_before(cell)).collect();
        Self::after(start, by, earlier)
    }

    /// Of cells that had other velocities in the interval before.
    pub fn after(start: &'a Start<'a>, by: &Forecaster<'_>, earlier: Known) -> Self {
        let model = by.structure.model(by.coefficients, &start.history(earlier));
        let scatter = by.tracked.map_or(0.0, |tracked| tracked.dynamics.scatter());
        Self { start, model, scatter }
    }

    /// Velocities by the forces alone; `None` of cells that do not have all their neighbours in view.
    pub fn forces(&self, positions: &[Vector<f64>]) -> Result<(Tessellation, Known), Error> {
        let Start { frame, movie, in_view, .. } = self.start;
        let tessellation = Tessellation::new(positions, movie.domain)
            .map_err(|source| Error::Geometry { frame: *frame, source })?;
        let v = velocities(&tessellation, positions, &self.model);
        let known =
            |(v, in_view): (Vector<f64>, &bool)| (*in_view && v.norm_squared().is_finite()).then_some(v);
        let v = v.into_iter().zip(in_view).map(known).collect();
        Ok((tessellation, v))
    }

    /// Velocities with what cells crawl by. Cells at the rim are led, or go with their neighbours.
    fn velocities(
        &self,
        positions: &[Vector<f64>],
        polarities: &[Vector<f64>],
        led: &[Option<Vector<f64>>],
    ) -> Result<Vec<Vector<f64>>, Error> {
        let (tessellation, forces) = self.forces(positions)?;
        let crawl = |(cell, v): (usize, Option<Vector<f64>>)| match v {
            Some(v) => Some(v + polarities[cell]),
            None => led.get(cell).copied().flatten(),
        };
        let mut known: Known = forces.into_iter().enumerate().map(crawl).collect();
        for _ in 0..ROUNDS {
            let of_cell = |(cell, own): (usize, &Option<Vector<f64>>)| {
                own.or_else(|| of_neighbours(&tessellation, cell, &known))
            };
            known = known.iter().enumerate().map(of_cell).collect();
        }
        Ok(known.into_iter().map(|v| v.unwrap_or_else(Vector::zeros)).collect())
    }

    /// What drives the polarities of cells in view, with b and κ.
    fn drive(
        &self,
        positions: &[Vector<f64>],
        [inhibition, alignment]: [f64; 2],
    ) -> Result<Vec<Vector<f64>>, Error> {
        let (tessellation, forces) = self.forces(positions)?;
        let (column, sign) = away_from_contacts();
        let away = Model::with_coefficients(&[], &[]).with(column, sign * inhibition);
        let turned = velocities(&tessellation, positions, &away.within(&self.model.environment));
        let of_cell = |(force, turned): (Option<Vector<f64>>, Vector<f64>)| {
            force.map_or(Vector::zeros(), |force| turned + force * alignment)
        };
        Ok(forces.into_iter().zip(turned).map(of_cell).collect())
    }

    /// What drives polarities where cells will be after half of a time, if they go on as they do.
    fn drive_half_way(
        &self,
        (positions, polarities): (&[Vector<f64>], &[Vector<f64>]),
        time: f64,
        led: &[Option<Vector<f64>>],
        drives: [f64; 2],
    ) -> Result<Vec<Vector<f64>>, Error> {
        if drives == [0.0; 2] {
            return Ok(Vec::new());
        }
        let v = self.velocities(positions, polarities, led)?;
        let half_way: Vec<Vector<f64>> = positions.iter().zip(v).map(|(r, v)| r + v * (0.5 * time)).collect();
        self.drive(&half_way, drives)
    }

    /// Goes on for a time, in so many steps of the classical Runge–Kutta method; cells at the rim at the velocities at which they are led.
    pub fn go_on(
        &self,
        moving: &mut Moving,
        turning: Option<&Turning>,
        (time, steps): (f64, usize),
        led: &[Option<Vector<f64>>],
        mut normal: impl FnMut() -> f64,
    ) -> Result<(), Error> {
        let h = time / steps as f64;
        let Moving { positions, polarities } = moving;
        let begin = std::mem::take(polarities);
        *polarities = match turning {
            Some(turning) => {
                let drive = self.drive_half_way((positions, &begin), time, led, turning.drives)?;
                turning.next(&begin, time, &drive, || Vector::new(normal(), normal()))
            }
            None => begin.clone(),
        };
        let polarities_at = |share: f64| -> Vec<Vector<f64>> {
            begin.iter().zip(&*polarities).map(|(from, to)| from.lerp(to, share)).collect()
        };
        for step in 0..steps {
            let [from, middle, to] =
                [0.0, 0.5, 1.0].map(|of| polarities_at((step as f64 + of) / steps as f64));
            let moved = |v: &[Vector<f64>], by: f64| -> Vec<Vector<f64>> {
                positions.iter().zip(v).map(|(r, v)| r + v * by).collect()
            };
            let first = self.velocities(positions, &from, led)?;
            let second = self.velocities(&moved(&first, 0.5 * h), &middle, led)?;
            let third = self.velocities(&moved(&second, 0.5 * h), &middle, led)?;
            let fourth = self.velocities(&moved(&third, h), &to, led)?;
            for (cell, r) in positions.iter_mut().enumerate() {
                *r += (first[cell] + (second[cell] + third[cell]) * 2.0 + fourth[cell]) * (h / 6.0);
            }
        }
        for r in positions {
            *r += Vector::new(normal(), normal()) * (self.scatter * time);
        }
        Ok(())
    }

    /// Displacements of the cells since the start after each of so many frames, in so many steps from one to the next; with noise if a seed is given.
    pub fn run(
        &self,
        (begun, turning): (&Begun, Option<&Turning>),
        (horizon, steps): (usize, usize),
        seed: Option<u64>,
    ) -> Result<Vec<Vec<Vector<f64>>>, Error> {
        let from = &self.start.cells.positions;
        let mut rng = seed.map(Pcg64::seed_from_u64);
        let mut normal = || rng.as_mut().map_or(0.0, |rng| StandardNormal.sample(rng));
        let mut moving = Moving::begin(begun, turning, &mut normal);
        let mut all = Vec::with_capacity(horizon);
        for ahead in 0..horizon {
            let interval = self.start.interval(ahead);
            self.go_on(&mut moving, turning, (interval, steps), &[], &mut normal)?;
            all.push(moving.positions.iter().zip(from).map(|(to, from)| to - from).collect());
        }
        Ok(all)
    }
}

/// Cells on their way.
pub(super) struct Moving {
    pub positions: Vec<Vector<f64>>,
    pub polarities: Vec<Vector<f64>>,
}

impl Moving {
    /// From the start; polarities of which nothing is known are drawn.
    pub fn begin(begun: &Begun, turning: Option<&Turning>, mut normal: impl FnMut() -> f64) -> Self {
        let mut unknown = || {
            let drawn = Vector::new(normal(), normal());
            turning.map_or_else(Vector::zeros, |turning| turning.unknown(drawn))
        };
        let polarities = begun.polarities.iter().map(|own| own.unwrap_or_else(&mut unknown));
        Self { polarities: polarities.collect(), positions: begun.positions.clone() }
    }
}
