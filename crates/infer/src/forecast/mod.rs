//! What the cells do next, and how well models say so before.
//!
//! From where cells were seen in a frame that no fit has seen, models go on for some frames, and baselines that know nothing of forces beside them. What
//! they say is scored against what was seen:
//!
//! ```text
//! skill(h) = 1 − Σ ‖y_{t+h} − ŷ_{t+h}‖² / Σ ‖y_{t+h} − y_t‖²
//! ```
//!
//! is one for a perfect forecast and nought for none. Only frames up to t are used: the polarity of a cell that crawls is what is expected of it given how it
//! moved before, and where cells are is told by their motion as well as by the last frame.

mod ahead;
mod baselines;
mod check;
mod ranks;
mod replica;
mod score;
mod start;
#[cfg(test)]
mod tests;
mod turning;

use crate::search::Watch;
use crate::tracks::{Dynamics, Movie, Polarity, Tracked};
use crate::{Error, NoiseLevels, Progress};
use ahead::Tissue;
use baselines::Regression;
pub use check::{Check, Checked, Expected, check};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use score::{Row, Tally};
use start::{Begun, Start};
use std::ops::ControlFlow;
use turning::Turning;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::Structure;

/// Frames before the start from which it follows where the cells are and how they crawl.
const PAST: usize = 4;

/// Error of the dynamics over an interval, in units of that of a position, of a model that cells are taken to follow.
const CLOSELY: f64 = 0.15;

/// Starts of forecasts at most.
const MOST_STARTS: usize = 24;

/// Steps of integration from frame to frame at first and at most.
const STEPS: [usize; 2] = [2, 64];

/// Change of a displacement, as a share of all, below which steps are short enough.
const PRECISION: f64 = 0.01;

/// A fitted model, in the units of the movie.
#[derive(Debug, Clone, Copy)]
pub struct Forecaster<'a> {
    /// Its columns.
    pub structure: &'a Structure,
    /// Their coefficients.
    pub coefficients: &'a [f64],
    /// How the cells went on in its fit, where tracks were fitted themselves.
    pub tracked: Option<&'a Tracked>,
}

/// What is to be forecast.
#[derive(Debug, Clone, Copy)]
pub struct Ahead<'a> {
    /// All frames, those of the fit included.
    pub movie: &'a Movie,
    /// First frame that no fit has seen: forecasts start there or later.
    pub first: usize,
    /// Frames ahead at most.
    pub horizon: usize,
    /// Standard deviations of each coordinate of a measured position, and of each component of a velocity.
    pub noise: NoiseLevels,
    /// Runs with noise of which the spread tells how large the error should be.
    pub draws: usize,
    /// Decides on the noise.
    pub seed: u64,
}

/// A number with its standard error.
pub type WithError = [f64; 2];

/// Who says what comes next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Forecast {
    /// A model, by its place among those given.
    Model(usize),
    /// Each cell stays where it is.
    NoMotion,
    /// Each cell keeps the velocity that it had.
    ConstantVelocity,
    /// Linear regression on the velocities that the cell and its neighbours had, along and across.
    Regression,
}

/// How well one of them does, at each horizon; NaN where there is nothing to be said.
#[derive(Debug, Clone)]
pub struct Skill {
    /// Who.
    pub of: Forecast,
    /// Skill of displacements since the start.
    pub position: Vec<WithError>,
    /// Skill of the mean velocity over the last interval.
    pub velocity: Vec<WithError>,
    /// Root mean square error of the displacement.
    pub error: Vec<f64>,
    /// What that should be by the spread of runs with noise and the errors of positions; NaN of baselines.
    pub expected_error: Vec<f64>,
}

/// Forecasts with their scores.
#[derive(Debug, Clone)]
pub struct Forecasts {
    /// Frames at which they start.
    pub starts: Vec<usize>,
    /// Displacements scored at each horizon.
    pub scored: Vec<usize>,
    /// All models and baselines.
    pub skills: Vec<Skill>,
    /// Gain in skill of the second model over the first, from the same displacements; empty for one model.
    pub gain: Vec<WithError>,
    /// Skill of a forecast that knows everything but the errors of the positions.
    pub best_possible: Vec<f64>,
}

/// Forecasts by models and baselines.
///
/// # Errors
/// [`Error::NoForecast`] if there are too few frames or cells, [`Error`] if cells cannot be tessellated or the caller stops.
pub fn forecast(
    ahead: &Ahead<'_>,
    models: &[Forecaster<'_>],
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Forecasts, Error> {
    let movie = ahead.movie;
    let all: Vec<usize> = (ahead.first.max(1)..movie.frames().saturating_sub(1)).collect();
    if all.is_empty() {
        return Err(Error::NoForecast("no two frames follow those of the fit"));
    }
    let starts = evenly(&all, MOST_STARTS);
    let regression = Regression::fitted(ahead)?;
    let mut watch = Watch { observe };
    let steps = match models.last() {
        Some(model) => steps(ahead, starts[0], model)?,
        None => STEPS[0],
    };
    let rows = watch.each("forecast", &starts, 1.0, |start| {
        let start = Start::new(movie, *start)?;
        let mut row = Row::new(&start, ahead);
        for model in models {
            row.push(by_model(ahead, &start, model, steps)?);
        }
        row.push(start.no_motion(ahead.horizon));
        row.push(start.constant_velocity(ahead.horizon));
        row.push(regression.forecast(&start, ahead.horizon));
        Ok(row)
    })?;
    let tally = Tally::new(&rows, ahead, models.len());
    let scored = tally.scored();
    if scored.iter().all(|count| *count == 0) {
        let nobody = "no cell with all its neighbours in view is followed from one frame to the next";
        return Err(Error::NoForecast(nobody));
    }
    let baselines = [Forecast::NoMotion, Forecast::ConstantVelocity, Forecast::Regression];
    let of = (0..models.len()).map(Forecast::Model).chain(baselines);
    Ok(Forecasts {
        skills: of.enumerate().map(|(k, of)| tally.skill(k, of)).collect(),
        gain: if models.len() > 1 { tally.gain(0, 1) } else { Vec::new() },
        best_possible: tally.best_possible(),
        scored,
        starts,
    })
}

/// Displacements of the cells of a start at each horizon, and the variance of a component of each where it is known.
type Said = (Vec<Vec<Vector<f64>>>, Option<Vec<Vec<f64>>>);

impl Forecaster<'_> {
    fn polarity(&self) -> Option<&Polarity> {
        self.tracked?.polarity.as_ref()
    }

    /// How cells went on. Velocities that were given say nothing of it: cells are then taken to follow the model closely.
    fn dynamics(&self, ahead: &Ahead<'_>, steps: usize) -> Dynamics {
        let closely = CLOSELY * ahead.noise.position / ahead.movie.interval();
        let levels = NoiseLevels { velocity: closely, ..ahead.noise };
        self.tracked.map_or(Dynamics::passive(levels, steps), |tracked| tracked.dynamics)
    }
}

/// What is known when cells go on by a model: where they are and how they crawl, what may be instead, and how polarities go on.
struct Outset {
    begun: Begun,
    drawn: Vec<Begun>,
    turning: Option<Turning>,
}

impl Forecaster<'_> {
    fn outset(&self, ahead: &Ahead<'_>, start: &Start<'_>, steps: usize) -> Result<Outset, Error> {
        let dynamics = self.dynamics(ahead, steps);
        let from = start.frame.saturating_sub(PAST);
        // The number after those of the runs.
        let mut rng = Pcg64::seed_from_u64(start.seed(ahead.seed, ahead.draws as u64));
        let normal = || StandardNormal.sample(&mut rng);
        let (present, drawn) = dynamics.present(
            ahead.movie,
            (from, start.frame),
            (self.structure, self.coefficients),
            (ahead.draws, normal),
        )?;
        Ok(Outset {
            begun: start.begun(&present),
            drawn: drawn.iter().map(|own| start.begun(own)).collect(),
            turning: self.turning(start, &start.cells.tessellation),
        })
    }

    /// How polarities go on among the cells of a start, where they are then.
    fn turning(&self, start: &Start<'_>, tessellation: &Tessellation) -> Option<Turning> {
        let usual = start.movie.interval();
        self.polarity().map(|own| Turning::new(own, usual, tessellation, &start.in_view))
    }
}

/// What a model says: the run without noise, and how runs with noise scatter.
fn by_model(
    ahead: &Ahead<'_>,
    start: &Start<'_>,
    model: &Forecaster<'_>,
    steps: usize,
) -> Result<Said, Error> {
    let tissue = Tissue::new(start, model);
    let Outset { begun, drawn, turning } = model.outset(ahead, start, steps)?;
    let run = |begun: &Begun, seed: Option<u64>| {
        tissue.run((begun, turning.as_ref()), (ahead.horizon, steps), seed)
    };
    let mean = run(&begun, None)?;
    let drawn = drawn.par_iter().enumerate();
    let drawn = drawn
        .map(|(k, begun)| run(begun, Some(start.seed(ahead.seed, k as u64))))
        .collect::<Result<Vec<_>, Error>>()?;
    let variances = (0..mean.len()).map(|h| {
        let of_cell = |cell: usize| {
            let all = drawn.iter().map(|own| (own[h][cell] - mean[h][cell]).norm_squared());
            all.sum::<f64>() / (2 * drawn.len()) as f64
        };
        (0..mean[h].len()).map(of_cell).collect()
    });
    let variances = (!drawn.is_empty()).then(|| variances.collect());
    Ok((mean, variances))
}

/// Steps of integration from frame to frame that are short enough for a model.
fn steps(ahead: &Ahead<'_>, start: usize, model: &Forecaster<'_>) -> Result<usize, Error> {
    let start = Start::new(ahead.movie, start)?;
    let tissue = Tissue::new(&start, model);
    let squares = |all: &[Vector<f64>]| all.iter().map(Vector::norm_squared).sum::<f64>();
    let mut steps = STEPS[0];
    let begun = start.as_measured();
    let mut coarse = tissue.run((&begun, None), (1, steps), None)?;
    while steps < STEPS[1] {
        let fine = tissue.run((&begun, None), (1, 2 * steps), None)?;
        let change: Vec<Vector<f64>> = fine[0].iter().zip(&coarse[0]).map(|(a, b)| a - b).collect();
        if squares(&change) <= PRECISION.powi(2) * squares(&fine[0]) {
            break;
        }
        (steps, coarse) = (2 * steps, fine);
    }
    Ok(steps)
}

/// Some of a list, as far from each other as they can be.
fn evenly(all: &[usize], most: usize) -> Vec<usize> {
    let count = all.len().min(most);
    let last = (count - 1).max(1);
    (0..count).map(|k| all[k * (all.len() - 1) / last]).collect()
}
