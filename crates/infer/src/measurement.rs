//! What a position is and over what velocities are averaged, where nobody said.
//!
//! The share c of the way from a cell's site to its centroid at which its position was measured, and the width of the windows of a
//! flow field, are unknowns beside the coefficients, in the same steps of Gauss and Newton. The kind of window is the one of greatest
//! restricted likelihood.

#[cfg(test)]
mod tests;

use crate::excerpt::excerpts;
use crate::inference::to_be_explained;
use crate::least_squares;
use crate::noisy_fit::{SETTLED, STEPS_PER_ROUND, first_levels, most_likely};
use crate::normal_matrix::invert;
use crate::objective::Objective;
use crate::search::{Watch, follow, refine};
use crate::unknown::Unknown;
use crate::{
    Error, FitParameter, NORMAL_95, NoiseLevels, Observation, Progress, Request, Velocities, Window,
    WindowKind,
};
use std::ops::ControlFlow;
use voronudge_geometry::Grid;

/// What is known of the measurement beforehand.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct KnownMeasurement {
    /// The share of the way from site to centroid at which positions were measured.
    pub share: Option<f64>,
    /// The kind of the windows of a flow field.
    pub kind: Option<WindowKind>,
    /// Their width, with a kind only.
    pub width: Option<f64>,
}

/// A number that was known or is determined with a 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Determined {
    /// The number.
    pub value: f64,
    /// 95 % interval; `None` if it was known.
    pub interval: Option<[f64; 2]>,
}

/// What other windows would say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RivalWindow {
    /// Its kind, and its best width.
    pub window: Window,
    /// By how much −2 log restricted likelihood is higher than with the best kind.
    pub rise: f64,
    /// `K_P α` with it, from the quick fit that decides.
    pub chiral_coefficient: f64,
}

/// How frames were measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// What of a cell its position is.
    pub share: Determined,
    /// The kind of window; `None` for velocities of cells.
    pub kind: Option<WindowKind>,
    /// Its width.
    pub width: Option<Determined>,
    /// All kinds that were tried, the best first; one if the kind was known.
    pub rivals: Vec<RivalWindow>,
}

impl Measurement {
    /// As is known beforehand, or usual: positions are sites.
    pub fn stated(known: &KnownMeasurement) -> Self {
        let stated = |value: f64| Determined { value, interval: None };
        Self {
            share: stated(known.share.unwrap_or(0.0)),
            kind: known.kind,
            width: known.width.map(stated),
            rivals: Vec::new(),
        }
    }
}

/// The shares of the way to the centroids that detections and segmentations give.
pub(crate) const SITES: f64 = 0.0;
pub(crate) const CENTROIDS: f64 = 1.0;

/// How far beyond its interval the share may be from these: cells that were not detected shift it by as much.
const TOLERANCE: f64 = 0.1;

/// Rounds of steps of the unknowns and of the noise levels.
const ROUNDS: usize = 12;

/// Steps of an unknown, in standard errors, that change nothing.
const NEGLIGIBLE: f64 = 0.05;

/// A width changes by no more than this factor at once.
const FACTOR: f64 = 1.6;

/// Least width of a window, in units of ℓ₀: cells are seen one by one.
const LEAST_WIDTH: f64 = 0.05;

/// A quick fit with its unknowns.
struct Settled {
    frames: Vec<Observation>,
    /// Value and standard error of the unknowns, in their order.
    found: Vec<[f64; 2]>,
    criterion: f64,
    chiral_coefficient: f64,
}

/// Determines what is not known of the measurement of some frames by quick fits, without flips of contacts.
///
/// Positions are taken for sites, or for centroids, where that is within the interval or nearly so: it is what detections and segmentations
/// give.
///
/// # Errors
/// As [`infer`](crate::infer).
pub fn measure(
    given: &[Observation],
    request: &Request,
    known: &KnownMeasurement,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<(Vec<Observation>, Measurement), Error> {
    to_be_explained(given, &request.space()?)?;
    let mut watch = Watch { observe };
    let mut measurement = Measurement::stated(known);
    let mut frames = given.to_vec();
    if measurement.share.value != 0.0 {
        frames = taken_at(&frames, measurement.share.value)?;
    }
    let flow = given.iter().find_map(|frame| match &frame.velocities {
        Velocities::OnGrid(flow) => Some(flow),
        Velocities::OfCells(_) => None,
    });
    if let Some(flow) = flow {
        frames = windows(&frames, &mut measurement, request, known, flow.grid, &mut watch)?;
    }
    if known.share.is_none() {
        let part = excerpts(&frames)?;
        let mut found = share(part.as_deref().unwrap_or(&frames), request, &mut watch)?;
        if part.is_some() && found.is_some_and(|own| usual_share(own).is_none()) {
            // An unusual one takes all that can be known.
            found = share(&frames, request, &mut watch)?;
        }
        let Some(found) = found else { return Ok((frames, measurement)) };
        measurement.share = determined_share(found);
        if measurement.share.value != 0.0 {
            frames = taken_at(&frames, measurement.share.value)?;
        }
        if usual_share(found).is_none() {
            frames = frames.into_iter().map(|frame| frame.with_unknown(Unknown::Share)).collect();
        }
    }
    Ok((frames, measurement))
}

/// The frames with positions at a share of the way from sites to centroids.
fn taken_at(frames: &[Observation], share: f64) -> Result<Vec<Observation>, Error> {
    frames.iter().map(|frame| frame.clone().with_positions_at(share)).collect()
}

/// The share that suits frames best, with its standard error; `None` if nothing tells sites from centroids, because these are where those are.
fn share(
    frames: &[Observation],
    request: &Request,
    watch: &mut Watch<'_>,
) -> Result<Option<[f64; 2]>, Error> {
    let unknowns = [Unknown::Share];
    let mut best = match settle(frames.to_vec(), request, &unknowns, watch) {
        Err(Error::Degenerate) => return Ok(None),
        other => other?,
    };
    if usual_share(best.found[0]) != Some(SITES) {
        let other = settle(taken_at(frames, CENTROIDS)?, request, &unknowns, watch)?;
        if other.criterion < best.criterion {
            best = other;
        }
    }
    Ok(Some(best.found[0]))
}

/// Sites or centroids, where a share with its standard error is about that of either.
pub(crate) fn usual_share([value, error]: [f64; 2]) -> Option<f64> {
    [SITES, CENTROIDS].into_iter().find(|usual| (value - usual).abs() <= NORMAL_95 * error + TOLERANCE)
}

/// A share that was estimated, with its standard error: the usual one where it is about that.
pub(crate) fn determined_share([value, error]: [f64; 2]) -> Determined {
    let interval = [value - NORMAL_95 * error, value + NORMAL_95 * error];
    Determined {
        value: usual_share([value, error]).unwrap_or(value.clamp(SITES, CENTROIDS)),
        interval: Some(interval.map(|end| end.clamp(SITES, CENTROIDS))),
    }
}

/// Determines the windows of a flow field.
fn windows(
    given: &[Observation],
    measurement: &mut Measurement,
    request: &Request,
    known: &KnownMeasurement,
    grid: Grid,
    watch: &mut Watch<'_>,
) -> Result<Vec<Observation>, Error> {
    if let (Some(kind), Some(width)) = (known.kind, known.width) {
        return Ok(given.iter().map(|frame| frame.clone().with_window(Window { kind, width })).collect());
    }
    // All kinds are to explain the same data: grid points that none of them fills are left out.
    let mut common = given.to_vec();
    for kind in WindowKind::ALL {
        let widest = Window { kind, width: FACTOR * kind.usual_width(&grid) };
        common = common.into_iter().map(|frame| frame.with_window(widest).within_present_reach()).collect();
    }
    let given = common;
    let with = |window: Window| -> Vec<Observation> {
        given.iter().map(|frame| frame.clone().with_window(window)).collect()
    };
    let mut tried = Vec::new();
    for kind in known.kind.map_or(WindowKind::ALL.to_vec(), |kind| vec![kind]) {
        let first = Window { kind, width: kind.usual_width(&grid) };
        match settle(with(first), request, &[Unknown::Width], watch) {
            Ok(settled) => tried.push((kind, settled)),
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(error) if known.kind.is_some() => return Err(error),
            // A kind that explains nothing is out of the question.
            Err(_) => {}
        }
    }
    tried.sort_by(|a, b| a.1.criterion.total_cmp(&b.1.criterion));
    measurement.rivals = tried
        .iter()
        .map(|(kind, settled)| RivalWindow {
            window: Window { kind: *kind, width: settled.found[0][0] },
            rise: settled.criterion - tried[0].1.criterion,
            chiral_coefficient: settled.chiral_coefficient,
        })
        .collect();
    let Some((kind, best)) = tried.into_iter().next() else {
        return Err(Error::Degenerate);
    };
    let [value, error] = best.found[0];
    let interval = [(value - NORMAL_95 * error).max(0.0), value + NORMAL_95 * error];
    measurement.kind = Some(kind);
    measurement.width = Some(Determined { value, interval: Some(interval) });
    Ok(best.frames.into_iter().map(|frame| frame.with_unknown(Unknown::Width)).collect())
}

/// Fits coefficients, nudges, noise levels and the unknowns.
fn settle(
    mut frames: Vec<Observation>,
    request: &Request,
    unknowns: &[Unknown],
    watch: &mut Watch<'_>,
) -> Result<Settled, Error> {
    let space = request.space()?;
    let structure = &request.structure;
    let naive = least_squares::fit(&frames, structure, &space)?;
    let estimated = request.noise.position.is_none() || request.noise.velocity.is_none();
    let mut levels = NoiseLevels { position: 1.0, velocity: 1.0 };
    levels = first_levels(&Objective::new(&frames, structure, &space, levels), &naive, &request.noise)?;
    let mut parameters = {
        let objective = Objective::new(&frames, structure, &space, levels);
        follow(&objective, &naive, STEPS_PER_ROUND, "measurement", watch)?.parameters
    };
    let (mut found, mut criterion) = (Vec::new(), f64::INFINITY);
    for round in 0..ROUNDS {
        watch.tell("measurement", (round as u64, ROUNDS as u64), 1.0)?;
        let mut objective = Objective::new(&frames, structure, &space, levels);
        let (next, likelihood) = most_likely(&objective, &parameters, unknowns, &request.noise)?;
        criterion = likelihood;
        let mut settled = true;
        if estimated {
            let change =
                (next.position / levels.position).ln().abs() + (next.velocity / levels.velocity).ln().abs();
            settled = change < SETTLED;
            levels = next;
            objective.levels = next;
        }
        let reduced = objective.linearise_with(&parameters, unknowns)?.reduced()?;
        let inverse = invert(reduced.information.clone())?;
        let step = &inverse * &reduced.gradient;
        let own = space.dimension();
        found.clear();
        for (k, unknown) in unknowns.iter().enumerate() {
            let error = levels.velocity * inverse[(own + k, own + k)].max(0.0).sqrt();
            let before = present(&frames, *unknown);
            let after = match unknown {
                Unknown::Share => (before + step[own + k]).clamp(0.0, 1.0),
                Unknown::Width => {
                    (before + step[own + k]).clamp(before / FACTOR, before * FACTOR).max(LEAST_WIDTH)
                }
            };
            settled &= (after - before).abs() <= NEGLIGIBLE * error;
            frames = frames.into_iter().map(|frame| set(frame, *unknown, after)).collect();
            found.push([after, error]);
        }
        parameters[..own].iter_mut().zip(step.iter()).for_each(|(beta, step)| *beta += step);
        let objective = Objective::new(&frames, structure, &space, levels);
        parameters = refine(&objective, parameters, STEPS_PER_ROUND)?.parameters;
        if settled {
            break;
        }
    }
    let coefficients = space.coefficients(&parameters[..space.dimension()]);
    let chiral_coefficient = FitParameter::ChiralCoefficient.of(coefficients.as_slice());
    Ok(Settled { frames, found, criterion, chiral_coefficient })
}

fn present(frames: &[Observation], unknown: Unknown) -> f64 {
    frames.first().map_or(0.0, |frame| match (unknown, &frame.velocities) {
        (Unknown::Share, _) => frame.share(),
        (Unknown::Width, Velocities::OnGrid(flow)) => flow.window.width,
        (Unknown::Width, Velocities::OfCells(_)) => 0.0,
    })
}

fn set(frame: Observation, unknown: Unknown, value: f64) -> Observation {
    match (unknown, &frame.velocities) {
        (Unknown::Share, _) => frame.at_share(value),
        (Unknown::Width, Velocities::OnGrid(flow)) => {
            let kind = flow.window.kind;
            frame.with_window(Window { kind, width: value })
        }
        (Unknown::Width, Velocities::OfCells(_)) => frame,
    }
}
