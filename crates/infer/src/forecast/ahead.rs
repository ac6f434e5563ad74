//! A tissue that goes on by a model, in a box or in an open field of view.

use super::Forecaster;
use super::crawl::{Crawl, Turning};
use super::start::{Begun, Start, of_neighbours};
use crate::Error;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::effect::away_from_contacts;
use voronudge_model::{Model, jacobian, velocities};

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

    /// Standard deviation, per component, of the mean velocity of a cell over an interval that nothing predicts.
    pub fn scatter(&self) -> f64 {
        self.scatter
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

    /// Root mean square, over the cells in view, of the derivative of a component of the velocity by all positions.
    pub fn sensitivity(&self) -> f64 {
        let Start { cells, in_view, .. } = self.start;
        let jacobian = jacobian(&cells.tessellation, &cells.positions, &self.model);
        let of_cell = |cell: usize| {
            jacobian.row(cell).map(|(_, b)| b.iter().map(|d| d * d).sum::<f64>()).sum::<f64>() / 2.0
        };
        let all: Vec<f64> = (0..in_view.len()).filter(|cell| in_view[*cell]).map(of_cell).collect();
        (all.iter().sum::<f64>() / all.len().max(1) as f64).sqrt()
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

    /// What drives the polarities of cells in view, with b and κ; none if nothing does.
    fn drive(
        &self,
        positions: &[Vector<f64>],
        [inhibition, alignment]: [f64; 2],
    ) -> Result<Vec<Vector<f64>>, Error> {
        if inhibition == 0.0 && alignment == 0.0 {
            return Ok(Vec::new());
        }
        let (tessellation, forces) = self.forces(positions)?;
        let (column, sign) = away_from_contacts();
        let away = Model::with_coefficients(&[], &[]).with(column, sign * inhibition);
        let turned = velocities(&tessellation, positions, &away.within(&self.model.environment));
        let of_cell = |(force, turned): (Option<Vector<f64>>, Vector<f64>)| {
            force.map_or(Vector::zeros(), |force| turned + force * alignment)
        };
        Ok(forces.into_iter().zip(turned).map(of_cell).collect())
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
        for _ in 0..steps {
            let moved = |v: &[Vector<f64>], by: f64| -> Vec<Vector<f64>> {
                positions.iter().zip(v).map(|(r, v)| r + v * by).collect()
            };
            let first = self.velocities(positions, polarities, led)?;
            let drive = self.drive(positions, turning.map_or([0.0; 2], |turning| turning.drives))?;
            let driven = |polarities: &mut [Vector<f64>]| {
                polarities.iter_mut().zip(&drive).for_each(|(p, drive)| *p += drive * (0.5 * h));
            };
            if let Some(turning) = turning {
                turning.go_on(polarities, 0.5 * h, || Vector::new(normal(), normal()));
                driven(polarities);
            }
            let second = self.velocities(&moved(&first, 0.5 * h), polarities, led)?;
            let third = self.velocities(&moved(&second, 0.5 * h), polarities, led)?;
            if let Some(turning) = turning {
                turning.go_on(polarities, 0.5 * h, || Vector::new(normal(), normal()));
                driven(polarities);
            }
            let fourth = self.velocities(&moved(&third, h), polarities, led)?;
            for (cell, r) in positions.iter_mut().enumerate() {
                *r += (first[cell] + (second[cell] + third[cell]) * 2.0 + fourth[cell]) * (h / 6.0);
            }
        }
        for r in positions {
            *r += Vector::new(normal(), normal()) * (self.scatter * time);
        }
        Ok(())
    }

    /// Displacements of the cells since the start after each of so many frames, in so many steps from one to the next; if a seed is given, with noise, and with
    /// so much error of a coordinate at the start.
    pub fn run(
        &self,
        (begun, crawl): (&Begun, Option<&Crawl>),
        (horizon, steps): (usize, usize),
        drawn: Option<(u64, f64)>,
    ) -> Result<Vec<Vec<Vector<f64>>>, Error> {
        let from = &self.start.cells.positions;
        let mut rng = drawn.map(|(seed, _)| Pcg64::seed_from_u64(seed));
        let mut normal = || rng.as_mut().map_or(0.0, |rng| StandardNormal.sample(rng));
        let astray = drawn.map_or(0.0, |(_, astray)| astray);
        let mut moving = Moving::begin((begun, crawl), astray, &mut normal);
        let mut all = Vec::with_capacity(horizon);
        for ahead in 0..horizon {
            let interval = self.start.interval(ahead);
            let turning = crawl.map(|crawl| &crawl.turning);
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
    /// From where they are thought to be, with so much error of a coordinate.
    pub fn begin(
        (begun, crawl): (&Begun, Option<&Crawl>),
        astray: f64,
        mut normal: impl FnMut() -> f64,
    ) -> Self {
        let mut positions = begun.positions.clone();
        for r in &mut positions {
            *r += Vector::new(normal(), normal()) * astray;
        }
        let polarities = match crawl {
            Some(crawl) => crawl.begin(|| Vector::new(normal(), normal())),
            None => vec![Vector::zeros(); positions.len()],
        };
        Self { positions, polarities }
    }
}
