//! Changes that may be: where to look, and what speaks for each.
//!
//! The evidence for a change is the fall of −2 log likelihood, less the cost of the places that it is free to choose,
//!
//! ```text
//! ΔS − Σ ‖z − z₀‖²/s² − log det(1 + s² I)  +  2 log p(feature | fault)/p(feature | none)  +  2 log(odds)
//! ```
//!
//! with the information I of the velocities on the places z, whose prior is normal about z₀ with spread s (Laplace), the
//! polygons' part, and the odds of such a fault where one is looked for.

use super::law::{Law, deviance};
use super::neighbourhood::{Guess, Neighbourhood};
use super::polygons::{Polygons, voids};
use super::scene::{Origin, Scene};
use super::{Change, ChangeKind, Rates};
use crate::Error;
use nalgebra::DMatrix;
use voronudge_geometry::{Vector, Visibility};

/// Distance, in ℓ₀, within which velocities speak for a change.
const NEAR: f64 = 1.7;

/// Distance of two detections of one cell at most, in ℓ₀.
const CLOSE: f64 = 0.6;

/// Distance of the two cells of a split from their detection at first, in roots of its area.
const HALF_SPLIT: f64 = 0.36;

/// Directions in which a split is tried.
const DIRECTIONS: usize = 3;

/// Smallest share of the cells at which each kind of change is tried, and least number.
const SHARES: [(ChangeKind, usize, usize); 4] = [
    (ChangeKind::Inserted, 10, 8),
    (ChangeKind::Deleted, 40, 4),
    (ChangeKind::Split, 40, 4),
    (ChangeKind::Merged, 40, 4),
];

/// Distances, in ℓ₀, of two cells that were put in from the detection between them, and of their midpoint, within which the two may be what was
/// detected as one.
const BESIDE: f64 = 0.9;
const BETWEEN: f64 = 0.25;

/// Evidence that a split needs beyond that of a cell beside the detection.
const SPLIT_AHEAD: f64 = 6.0;

/// Evaluations of a placement.
pub(super) const STEPS: usize = 20;

/// A change to be tried.
#[derive(Debug, Clone)]
pub(super) struct Proposal {
    pub kind: ChangeKind,
    pub centre: Vector<f64>,
    pub removed: Vec<usize>,
    /// How much there is to explain.
    promise: f64,
}

impl Proposal {
    /// One that is judged whatever there is to explain.
    fn new(kind: ChangeKind, centre: Vector<f64>, removed: Vec<usize>) -> Self {
        Self { kind, centre, removed, promise: 0.0 }
    }
}

/// What evidence rests on.
pub(super) struct Evidence<'a> {
    pub law: Law<'a>,
    pub polygons: &'a Polygons,
    pub rates: &'a Rates,
    /// Variance of a component of the velocities themselves.
    pub spread: f64,
    /// Labels that a cell may have whose label is not known, and −2 log of their share; none at all, which is certain, where cells are alike.
    pub labels: &'a [(Option<i64>, f64)],
}

/// Which changes are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// Those that keep detections where they are: coefficients are rough as long as cells are missing, and a detection that is let
    /// go can make up for one.
    Additions,
    /// The others, where nothing has changed since there was no such change.
    Others,
    /// All.
    All,
}

impl Stage {
    fn has(self, kind: ChangeKind) -> bool {
        let adds = matches!(kind, ChangeKind::Inserted | ChangeKind::Merged);
        match self {
            Self::Additions => adds,
            Self::Others => !adds,
            Self::All => true,
        }
    }
}

/// The most promising changes of a frame.
pub(super) fn proposals(scene: &Scene<'_>, polygons: &Polygons, stage: Stage) -> Vec<Proposal> {
    let frame = &scene.observation;
    let areas = voronudge_geometry::areas(&frame.tessellation, &frame.positions);
    let mut all = Vec::new();
    for void in voids(scene).into_iter().filter(|void| void.radius < polygons.largest_void) {
        let promise = void.radius.powi(2) * scene.unexplained(void.centre, NEAR);
        all.push(Proposal { kind: ChangeKind::Inserted, centre: void.centre, removed: Vec::new(), promise });
    }
    for (cell, origin) in scene.origins.iter().enumerate() {
        let Origin::Detected(detection) = *origin else { continue };
        if frame.visibility[cell] != Visibility::Counted {
            continue;
        }
        let centre = frame.positions[cell];
        let unexplained = scene.unexplained(centre, NEAR);
        for (kind, size) in [(ChangeKind::Deleted, 1.0 / areas[cell]), (ChangeKind::Split, areas[cell])] {
            all.push(Proposal { kind, centre, removed: vec![detection], promise: size * unexplained });
        }
        for h in frame.tessellation.ring(cell) {
            let other = frame.tessellation.neighbour(h);
            let across = frame.tessellation.displacement(&frame.positions, cell, h);
            if let (true, Origin::Detected(second)) =
                (other > cell && across.norm() < CLOSE, scene.origins[other])
            {
                all.push(Proposal {
                    kind: ChangeKind::Merged,
                    centre: centre + across * 0.5,
                    removed: vec![detection, second],
                    promise: unexplained / across.norm(),
                });
            }
        }
    }
    all.sort_by(|a, b| b.promise.total_cmp(&a.promise));
    let most = SHARES.map(|(kind, share, least)| (kind, least.max(scene.origins.len() / share)));
    let looked_for = most.iter().filter(|(kind, _)| stage.has(*kind));
    let best =
        looked_for.flat_map(|(kind, count)| all.iter().filter(move |own| own.kind == *kind).take(*count));
    best.cloned().collect()
}

/// A proposal at its best places, with its evidence.
pub(super) fn assess(
    scene: &Scene<'_>,
    proposal: &Proposal,
    evidence: &Evidence<'_>,
) -> Result<Change, Error> {
    judge(scene, proposal, &[], &[], evidence)
}

/// A change that was made, placed anew from where it is, with its evidence; or what has more in its place: a cell beside a
/// detection for one that was split, or the other way round.
pub(super) fn reassess(
    scene: &Scene<'_>,
    index: usize,
    stage: Stage,
    evidence: &Evidence<'_>,
) -> Result<Change, Error> {
    let change = &scene.changes[index];
    let centre = match change.removed.first() {
        Some(cell) if change.added.len() != 1 => scene.measured.positions[*cell],
        _ => change.added.first().copied().unwrap_or_else(Vector::zeros),
    };
    let own = Proposal::new(change.kind, centre, change.removed.clone());
    let own = judge(scene, &own, &[index], &change.added, evidence)?;
    let others: Vec<Proposal> = match change.kind {
        ChangeKind::Split => {
            change.added.iter().map(|place| Proposal::new(ChangeKind::Inserted, *place, Vec::new())).collect()
        }
        ChangeKind::Inserted if stage != Stage::Additions => {
            nearest_detection(scene, centre).map(|cell| split(scene, cell)).into_iter().collect()
        }
        _ => Vec::new(),
    };
    let mut best = own;
    for other in others {
        let other = judge(scene, &other, &[index], &[], evidence)?;
        let ahead = if other.kind == ChangeKind::Split { SPLIT_AHEAD } else { 0.0 };
        if other.evidence > best.evidence + ahead {
            best = other;
        }
    }
    Ok(best)
}

/// For two cells that were put in on either side of a detection: this split into the two, if that has more evidence than both, with the number of
/// the other change. What was detected as one would else stay between the two as a third.
pub(super) fn split_between(
    scene: &Scene<'_>,
    index: usize,
    evidence: &Evidence<'_>,
) -> Result<Option<(usize, Change)>, Error> {
    let insertion = |index: usize| scene.changes[index].insertion();
    let Some((own, detection)) = insertion(index).and_then(|own| Some((own, nearest_detection(scene, own)?)))
    else {
        return Ok(None);
    };
    let middle = scene.measured.positions[detection];
    let arm = scene.between(middle, own);
    let opposite = (0..scene.changes.len())
        .filter(|other| *other != index)
        .filter_map(|other| Some((other, insertion(other)?)))
        .find(|(_, place)| {
            let across = scene.between(middle, *place);
            arm.norm().max(across.norm()) < BESIDE && 0.5 * (arm + across).norm() < BETWEEN
        });
    let Some((other, place)) = opposite else { return Ok(None) };
    let inserted = |place| Proposal::new(ChangeKind::Inserted, place, Vec::new());
    let first = judge(scene, &inserted(own), &[index], &[own], evidence)?;
    let second = judge(scene, &inserted(place), &[index, other], &[place], evidence)?;
    let split = judge(scene, &split(scene, detection), &[index, other], &[], evidence)?;
    let ahead = split.evidence > first.evidence + second.evidence;
    Ok(ahead.then_some((other, split)))
}

/// A detection to be split.
fn split(scene: &Scene<'_>, cell: usize) -> Proposal {
    Proposal::new(ChangeKind::Split, scene.measured.positions[cell], vec![cell])
}

/// The detection that is nearest to a place, of those that stand.
fn nearest_detection(scene: &Scene<'_>, place: Vector<f64>) -> Option<usize> {
    let distance = |cell: usize| scene.between(place, scene.measured.positions[cell]).norm();
    let detections = scene.origins.iter().filter_map(|origin| match origin {
        Origin::Detected(cell) => Some(*cell),
        Origin::Added(..) => None,
    });
    detections.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
}

/// What speaks for a proposal once some of the changes are undone, from some places or those that are usual.
fn judge(
    scene: &Scene<'_>,
    proposal: &Proposal,
    undone: &[usize],
    start: &[Vector<f64>],
    evidence: &Evidence<'_>,
) -> Result<Change, Error> {
    let Evidence { law, polygons, rates, spread, .. } = evidence;
    let before = Neighbourhood::new(scene, proposal.centre, undone, &[])?;
    let (feature, guesses) = features(scene, &before, proposal, polygons)?;
    let guesses = guesses.into_iter().flat_map(|guess| labelled(scene, proposal, guess, evidence.labels));
    let after = match proposal.removed.is_empty() {
        true => None,
        false => Some(Neighbourhood::new(scene, proposal.centre, undone, &proposal.removed)?),
    };
    let mut best: Option<(f64, Change)> = None;
    for (mut guess, unlikely) in guesses {
        if !start.is_empty() {
            guess.start =
                start.iter().map(|at| proposal.centre + scene.between(proposal.centre, *at)).collect();
        }
        let placed = after.as_ref().unwrap_or(&before).settled(law, &guess, STEPS)?;
        let n = placed.information.nrows();
        let posterior = DMatrix::identity(n, n) + &placed.information * guess.spread.powi(2);
        let cost = placed.prior + posterior.determinant().max(1.0).ln();
        let own = lost(scene, proposal, *spread);
        let value = placed.deviance + own + cost + unlikely;
        if best.as_ref().is_none_or(|(known, _)| value < *known) {
            let variance = posterior.try_inverse().map_or(1.0, |inverse| inverse.trace() / n.max(1) as f64);
            let change = Change {
                kind: proposal.kind,
                removed: proposal.removed.clone(),
                added: placed.positions,
                labels: guess.labels,
                standard_error: guess.spread * variance.sqrt(),
                evidence: 0.0,
            };
            best = Some((value, change));
        }
    }
    let (value, change) = best.ok_or_else(|| Error::Optimiser("a change without a place".into()))?;
    let odds = rates.log_odds(proposal.kind, polygons);
    let geometry = polygons.log_ratio(proposal.kind, feature);
    let gained = before.deviance(law)? - value + 2.0 * (geometry + odds);
    // A change that cannot be judged is none.
    let gained = if gained.is_finite() { gained } else { f64::NEG_INFINITY };
    Ok(Change { evidence: gained, ..change })
}

/// A guess with the labels that its cells may have, and −2 log of how likely these are: those of the detections that the cells stand for, or
/// any.
fn labelled(
    scene: &Scene<'_>,
    proposal: &Proposal,
    guess: Guess,
    labels: &[(Option<i64>, f64)],
) -> Vec<(Guess, f64)> {
    if !scene.has_labels() {
        return vec![(guess, 0.0)];
    }
    let of = |label| Guess { labels: vec![label; guess.start.len()], ..guess.clone() };
    match proposal.removed.first() {
        Some(detection) => vec![(of(scene.measured.environment().label(*detection)), 0.0)],
        None => labels.iter().map(|(label, unlikely)| (of(*label), *unlikely)).collect(),
    }
}

/// Deviance of measured velocities that a change no longer explains, as those of anything that moves.
fn lost(scene: &Scene<'_>, proposal: &Proposal, spread: f64) -> f64 {
    let targets = proposal.removed.iter().filter_map(|cell| scene.cells_target(*cell));
    match scene.joint_target(&proposal.removed, usize::from(proposal.kind == ChangeKind::Merged)) {
        // The mean is explained, the difference is not.
        Some(mean) => {
            let square: f64 = targets.map(|v| (v - mean).norm_squared()).sum();
            deviance(square, spread)
        }
        None => targets.map(|v| deviance(v.norm_squared(), spread)).sum(),
    }
}

/// The feature of the polygons, and where cells may be.
fn features(
    scene: &Scene<'_>,
    before: &Neighbourhood,
    proposal: &Proposal,
    polygons: &Polygons,
) -> Result<(f64, Vec<Guess>), Error> {
    let own: Vec<usize> = proposal
        .removed
        .iter()
        .filter_map(|cell| before.cells.iter().position(|other| other.origin == Origin::Detected(*cell)))
        .collect();
    let area: f64 = own.iter().map(|cell| before.polygon(*cell).map_or(f64::NAN, |p| p.shape().area)).sum();
    let guess = |places: Vec<Vector<f64>>, spread: f64| Guess {
        start: places.clone(),
        places,
        spread,
        target: None,
        labels: Vec::new(),
    };
    Ok(match proposal.kind {
        ChangeKind::Inserted => {
            let circle = before.empty_circle(proposal.centre, &[])?;
            let (centre, radius) = circle.unwrap_or((proposal.centre, f64::NAN));
            (radius, vec![guess(vec![centre], polygons.spread)])
        }
        ChangeKind::Deleted => (area, vec![guess(Vec::new(), polygons.spread)]),
        ChangeKind::Merged => {
            let target = scene.joint_target(&proposal.removed, 1);
            (area, vec![Guess { target, ..guess(vec![proposal.centre], polygons.spread) }])
        }
        ChangeKind::Split => {
            let Some((cell, polygon)) = own.first().and_then(|cell| Some((*cell, before.polygon(*cell)?)))
            else {
                return Ok((f64::NAN, Vec::new()));
            };
            // Along the long axis of the polygon, and beside it.
            let [mut xx, mut xy, mut yy] = [0.0; 3];
            for v in polygon.vertices() {
                xx += v.x * v.x;
                xy += v.x * v.y;
                yy += v.y * v.y;
            }
            let long = 0.5 * (2.0 * xy).atan2(xx - yy);
            let reach = HALF_SPLIT * area.sqrt();
            let guesses = (0..DIRECTIONS).map(|k| {
                let angle = long + std::f64::consts::PI * k as f64 / DIRECTIONS as f64;
                let arm = Vector::new(angle.cos(), angle.sin()) * reach;
                let middle = before.positions[cell];
                guess(vec![middle + arm, middle - arm], polygons.spread)
            });
            (area, guesses.collect())
        }
    })
}
