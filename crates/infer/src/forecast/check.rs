//! Whether what a model makes of the cells is like what was seen: a posterior predictive check.
//!
//! From a frame near the beginning a model goes on for as long as the movie, many times over, with its noise. Cells come, go and are missed where they did in the
//! movie, positions have the errors of the measurement, and cells at the rim of an open field are led as they were seen to go: what differs is what the forces and the
//! polarity make of the cells within. What was not fitted is then compared: how far cells get, how long they remember, who is next to whom, shapes, order, flow
//! on all scales.

use super::ranks::ranks;
use super::replica::{Places, Stage, measured};
use super::start::Start;
use super::{Ahead, Forecaster, PAST, steps};
use crate::search::Watch;
use crate::seeds::{Purpose, seed_of};
use crate::tracks::Drift;
use crate::{Error, Movie, Progress};
use std::ops::ControlFlow;
use voronudge_geometry::Vector;
use voronudge_model::velocities;
use voronudge_observables::{Curve, Images, Plan, Quantity, Recording, correlations, observe};

/// Longest waves only: up to this wave number, in units of the inverse spacing.
const LARGEST_WAVE_NUMBER: f64 = std::f64::consts::PI;

/// What errors call the models, the last of them all others.
const NAMES: [&str; 2] = ["base model", "model with effects"];

/// The quantiles of the simulated movies that are given.
const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

/// What a model makes of a measured function.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// The 5, 50 and 95 % quantiles of the simulated movies at each point.
    pub quantiles: [Vec<f64>; 3],
    /// Share of all movies, the measured one included, that are as far from the mean of all as the measured one: small if the model does not make such cells.
    pub p: f64,
}

/// A measured function and what the models make of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// Measured.
    pub measured: Curve,
    /// By model.
    pub models: Vec<Expected>,
}

/// How models compare with a movie.
#[derive(Debug, Clone)]
pub struct Check {
    /// First frame that is compared.
    pub first: usize,
    /// Simulated movies of each model.
    pub draws: usize,
    /// Everything that was measured.
    pub quantities: Vec<Checked>,
    /// For each model, the share of all movies in which some function is as unusual as in the measured one.
    pub p: Vec<f64>,
    /// Where cells were seen, by frame and track, and where they are in one simulated movie of each model.
    pub places: Vec<Places>,
}

/// Compares a movie with movies that models make of its cells, `ahead.draws` of each.
///
/// # Errors
/// [`Error::NoForecast`] if there are too few frames or cells, [`Error::FliesApart`] if simulated cells do not stay together, [`Error`] if cells cannot be
/// tessellated or the caller stops.
pub fn check(
    ahead: &Ahead<'_>,
    models: &[Forecaster<'_>],
    observe_progress: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Check, Error> {
    let movie = ahead.movie;
    let first = (movie.frames() / 5).clamp(1, PAST);
    if first + 2 >= movie.frames() {
        return Err(Error::NoForecast("a comparison with simulations takes four frames at least"));
    }
    let starts =
        (first..movie.frames()).map(|frame| Start::new(movie, frame)).collect::<Result<Vec<_>, Error>>()?;
    let seen = measured(movie, &starts);
    let filmed = recording(movie, &starts, seen.clone())?;
    let plan = Plan::of(&filmed).map_err(unlike)?.up_to(LARGEST_WAVE_NUMBER);
    let base = models.first();
    let look = |recording: &Recording| -> Result<Vec<Curve>, Error> {
        let mut all = observe(recording, &plan);
        if let Some(base) = base {
            all.extend(of_residuals(recording, (&starts, base), &plan)?);
        }
        all.sort_by_key(|curve| curve.of);
        Ok(all)
    };
    let mut quantities: Vec<Checked> =
        look(&filmed)?.into_iter().map(|measured| Checked { measured, models: Vec::new() }).collect();
    let mut watch = Watch { observe: observe_progress };
    let (mut p, mut places) = (Vec::new(), vec![seen]);
    for (number, model) in models.iter().enumerate() {
        let steps = steps(ahead, first, model)?;
        let outset = model.outset(ahead, &starts[0], steps)?;
        let noise = ahead.noise.position;
        let name = NAMES[number.min(NAMES.len() - 1)];
        let stage = Stage { movie, model, name, starts: &starts, outset, steps, noise };
        let seed = |draw: usize| seed_of(ahead.seed, Purpose::Model(number), draw as u64);
        places.push(stage.play(0, seed(0))?);
        let draws: Vec<usize> = (0..ahead.draws).collect();
        let simulated = watch.each("simulate", &draws, 1.0, |draw| {
            let own = recording(movie, &starts, stage.play(*draw, seed(*draw))?)?.counted_as(&filmed);
            let found = look(&own)?;
            // In the order of what was measured; what was not seen is nothing.
            let of = |wanted: &Curve| {
                let own = found.iter().find(|curve| curve.of == wanted.of);
                own.map_or_else(|| vec![f64::NAN; wanted.at.len()], |curve| curve.value.clone())
            };
            Ok(quantities.iter().map(|quantity| of(&quantity.measured)).collect::<Vec<_>>())
        })?;
        let mut sets: Vec<Vec<Vec<f64>>> =
            vec![quantities.iter().map(|quantity| quantity.measured.value.clone()).collect()];
        sets.extend(simulated);
        let ranks = ranks(&sets);
        for (k, quantity) in quantities.iter_mut().enumerate() {
            let points = quantity.measured.at.len();
            let at = |point: usize| quantiles(sets[1..].iter().map(|set| set[k][point]));
            let all: Vec<[f64; 3]> = (0..points).map(at).collect();
            let quantiles = [0, 1, 2].map(|q| all.iter().map(|own| own[q]).collect());
            quantity.models.push(Expected { quantiles, p: ranks.single[k] });
        }
        p.push(ranks.joint);
    }
    Ok(Check { first, draws: ahead.draws, quantities, p, places })
}

fn recording(movie: &Movie, starts: &[Start<'_>], places: Places) -> Result<Recording, Error> {
    let times: Vec<f64> = starts.iter().map(|start| movie.times[start.frame]).collect();
    let domains = vec![movie.domain; times.len()];
    let own =
        Recording::new(&times, places, &domains, &movie.field_of_view, Images::Followed).map_err(unlike)?;
    Ok(match movie.drift {
        Drift::None => own.with_mean_velocities(),
        Drift::PerInterval => own.without_common_motion().with_mean_velocities(),
    })
}

/// Correlations in time and space of what the forces of a model leave of the mean velocities: forces are the means of those at both ends of an interval.
fn of_residuals(
    recording: &Recording,
    (starts, base): (&[Start<'_>], &Forecaster<'_>),
    plan: &Plan,
) -> Result<Vec<Curve>, Error> {
    let frames = recording.frames();
    let forces: Vec<Vec<Vector<f64>>> = frames
        .iter()
        .zip(starts)
        .map(|(frame, start)| {
            let earlier = frame.tracks.iter().map(|_| None).collect();
            let model = base.structure.model(base.coefficients, &start.history(earlier));
            velocities(&frame.tessellation, &frame.positions, &model)
        })
        .collect();
    let residuals: Vec<Vec<Option<Vector<f64>>>> = (0..frames.len())
        .map(|k| {
            let mut all = vec![None; recording.tracks()];
            let Some(next) = frames.get(k + 1) else { return all };
            for (cell, track) in frames[k].tracks.iter().enumerate() {
                let Some(there) = next.cell(*track) else { continue };
                let force = (forces[k][cell] + forces[k + 1][there]) * 0.5;
                all[*track] =
                    frames[k].velocities[cell].map(|v| v - force).filter(|v| (v.x + v.y).is_finite());
            }
            all
        })
        .collect();
    let left = recording.clone().with_velocities(&residuals).map_err(unlike)?;
    let mut all = correlations(&left, plan);
    all.retain_mut(|curve| {
        curve.of = match curve.of {
            Quantity::VelocityAutocorrelation => Quantity::ResidualAutocorrelation,
            Quantity::VelocityCorrelation => Quantity::ResidualCorrelation,
            _ => return false,
        };
        true
    });
    Ok(all)
}

fn unlike(error: voronudge_observables::Error) -> Error {
    use voronudge_observables::Error as Found;
    match error {
        Found::Tessellation { frame, source } => Error::Geometry { frame, source },
        _ => Error::NoForecast("no cell with all its neighbours in view is there to be compared"),
    }
}

/// Quantiles of the values that are finite.
fn quantiles(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut all: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    all.sort_unstable_by(f64::total_cmp);
    QUANTILES.map(|share| {
        let place = share * all.len().saturating_sub(1) as f64;
        let (below, above) = (all.get(place.floor() as usize), all.get(place.ceil() as usize));
        match (below, above) {
            (Some(below), Some(above)) => below + (above - below) * place.fract(),
            _ => f64::NAN,
        }
    })
}
