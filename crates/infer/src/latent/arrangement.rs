//! Cells that were put in next to each other, placed anew together.
//!
//! Where two neighbours were not detected, the velocities want a single cell between the two, and a second one finds no place
//! beside it. So each cell that was put in is replaced by two, in several directions, alone or with another one nearby that
//! is let go or stays. The number of cells and their places are those with the most evidence, of all velocities nearby together.

use super::neighbourhood::{Guess, Neighbourhood};
use super::proposal::{Evidence, STEPS};
use super::scene::Scene;
use super::{Change, ChangeKind};
use crate::Error;
use nalgebra::DMatrix;
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// Distance, in ℓ₀, within which cells are placed together.
const TOGETHER: f64 = 1.8;

/// Distance of two cells from the place of the one that they replace, in ℓ₀.
const ARM: f64 = 0.5;

/// Directions in which a cell is replaced by two.
const DIRECTIONS: usize = 6;

/// Factor λ of a velocity nearby beyond which places are in doubt: an error of about two standard deviations.
const STRAINED: f64 = 1.5;

/// Gain in −2 log probability, beyond the cost of having tried so many starts, that is worth another arrangement. Cells of it that have
/// too little evidence of their own are let go later.
const LEAST_GAIN: f64 = 2.0;

/// Evaluations from each start, and number of those that are followed.
const FIRST_STEPS: usize = 8;
const FOLLOWED: usize = 3;

/// Where cells are looked for first, and their labels if cells have labels.
type Start = (Vec<Vector<f64>>, Vec<Option<i64>>);

/// Cells at the best places from a start.
struct Arrangement {
    places: Vec<Vector<f64>>,
    labels: Vec<Option<i64>>,
    standard_error: f64,
    /// −2 log of the probability of the velocities nearby and of so many cells at such places, up to a constant.
    cost: f64,
    /// The largest factor λ of a velocity nearby.
    strain: f64,
}

impl Arrangement {
    fn new(
        around: &Neighbourhood,
        (start, labels): Start,
        steps: usize,
        evidence: &Evidence<'_>,
    ) -> Result<Self, Error> {
        let Evidence { law, polygons, rates, .. } = evidence;
        let spread = polygons.spread;
        let guess = Guess { places: start.clone(), start, spread, target: None, labels };
        let placed = around.settled(law, &guess, steps)?;
        let n = placed.information.nrows();
        let posterior = DMatrix::identity(n, n) + &placed.information * spread.powi(2);
        let mut cost = placed.deviance + posterior.determinant().max(1.0).ln();
        for (own, place) in placed.positions.iter().enumerate() {
            let others = placed.positions.iter().enumerate().filter(|(other, _)| *other != own);
            let others: Vec<Vector<f64>> = others.map(|(_, place)| *place).collect();
            let (centre, radius) = around.empty_circle(*place, &others)?.unwrap_or((*place, f64::NAN));
            let geometry = polygons.log_ratio(ChangeKind::Inserted, radius);
            let odds = rates.log_odds(ChangeKind::Inserted, polygons);
            cost += (place - centre).norm_squared() / spread.powi(2) - 2.0 * (geometry + odds);
        }
        let variance = posterior.try_inverse().map_or(1.0, |inverse| inverse.trace() / n.max(1) as f64);
        // What cannot be judged is no improvement.
        let cost = if cost.is_finite() { cost } else { f64::INFINITY };
        Ok(Self {
            places: placed.positions,
            labels: guess.labels,
            standard_error: spread * variance.sqrt(),
            cost,
            strain: placed.strain,
        })
    }
}

/// The changes of a scene with a cell that was put in, and perhaps another one near it, arranged in another way; `None` if what is there has
/// more evidence.
pub(super) fn rearranged(
    scene: &Scene<'_>,
    index: usize,
    evidence: &Evidence<'_>,
) -> Result<Option<Vec<Change>>, Error> {
    let Some(centre) = scene.changes[index].insertion() else { return Ok(None) };
    let place =
        |change: usize| scene.changes[change].insertion().map(|at| centre + scene.between(centre, at));
    let near = (0..scene.changes.len())
        .filter(|other| *other != index && place(*other).is_some_and(|at| (at - centre).norm() < TOGETHER));
    let groups = std::iter::once(vec![index]).chain(near.map(|other| vec![index, other]));
    let mut best: Option<(f64, Vec<usize>, Arrangement)> = None;
    for group in groups {
        let around = Neighbourhood::new(scene, centre, &group, &[])?;
        let there: Start = (
            group.iter().filter_map(|change| place(*change)).collect(),
            group.iter().flat_map(|change| scene.changes[*change].labels.iter().copied()).collect(),
        );
        let pairs = (0..DIRECTIONS).map(|k| {
            let angle = std::f64::consts::PI * k as f64 / DIRECTIONS as f64;
            let arm = Vector::new(angle.cos(), angle.sin()) * ARM;
            (vec![centre + arm, centre - arm], scene.changes[index].labels.repeat(2))
        });
        let others = (there.0[1..].to_vec(), there.1[1.min(there.1.len())..].to_vec());
        let starts: Vec<Start> = match others.0.is_empty() {
            true => pairs.collect(),
            false => pairs
                .flat_map(|pair: Start| {
                    let both = ([&pair.0[..], &others.0].concat(), [&pair.1[..], &others.1].concat());
                    [pair, both]
                })
                .collect(),
        };
        // Most cells are where they should be, which the first evaluation tells.
        if Arrangement::new(&around, there.clone(), 1, evidence)?.strain < STRAINED {
            continue;
        }
        let present = Arrangement::new(&around, there, STEPS, evidence)?;
        let searched = 2.0 * (starts.len() as f64).ln();
        let mut tried = starts
            .into_par_iter()
            .map(|start| Arrangement::new(&around, start, FIRST_STEPS, evidence))
            .collect::<Result<Vec<_>, Error>>()?;
        tried.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        tried.truncate(FOLLOWED);
        let followed = tried
            .into_par_iter()
            .map(|first| Arrangement::new(&around, (first.places, first.labels), STEPS, evidence))
            .collect::<Result<Vec<_>, Error>>()?;
        let Some(other) = followed.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost)) else { continue };
        let gain = present.cost - other.cost - searched;
        if gain > LEAST_GAIN && best.as_ref().is_none_or(|(known, ..)| gain > *known) {
            best = Some((gain, group, other));
        }
    }
    Ok(best.map(|(gain, group, arrangement)| {
        let kept = scene.changes.iter().enumerate().filter(|(change, _)| !group.contains(change));
        let added = arrangement.places.iter().enumerate().map(|(k, place)| Change {
            kind: ChangeKind::Inserted,
            removed: Vec::new(),
            added: vec![*place],
            labels: arrangement.labels.get(k).copied().into_iter().collect(),
            standard_error: arrangement.standard_error,
            evidence: gain,
        });
        kept.map(|(_, change)| change.clone()).chain(added).collect()
    }))
}
