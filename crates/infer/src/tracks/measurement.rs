//! What of a cell its position is, in a movie for which nobody said.

use super::anchors::Share;
use super::begun::Begun;
use super::movie::Movie;
use super::states::States;
use crate::measurement::{CENTROIDS, SITES, determined_share, usual_share};
use crate::normal_matrix::invert;
use crate::restricted::Restricted;
use crate::search::Watch;
use crate::{Error, KnownMeasurement, Measurement, Progress, Request};
use std::ops::ControlFlow;

/// Frames that tell.
const FRAMES: usize = 3;

/// Rounds of steps of the share and of the fit.
const ROUNDS: usize = 8;

/// Steps of the share, in standard errors, that change nothing.
const NEGLIGIBLE: f64 = 0.1;

/// The share of the way from site to centroid, and −2 log of the restricted likelihood there.
struct Estimated {
    /// Its value and standard error.
    share: [f64; 2],
    criterion: f64,
}

/// Determines which point of a cell its position is, if that is not known, from quick fits of the first frames of a movie.
///
/// Positions are taken for sites, or for centroids, as [`measure`](crate::measure) does.
///
/// # Errors
/// As [`infer_tracks`](crate::infer_tracks).
pub fn measure_tracks(
    movie: &Movie,
    request: &Request,
    known: &KnownMeasurement,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<(Movie, Measurement), Error> {
    let mut measurement = Measurement::stated(known);
    if known.share.is_none() {
        let mut watch = Watch { observe };
        let beginning = movie.beginning(FRAMES);
        let mut at = |share: f64| estimate(beginning.clone().with_positions_at(share), request, &mut watch);
        let found = at(SITES).and_then(|found| match usual_share(found.share) {
            Some(SITES) => Ok(found),
            _ => {
                let other = at(CENTROIDS)?;
                Ok(if other.criterion < found.criterion { other } else { found })
            }
        });
        match found {
            Ok(found) => measurement.share = determined_share(found.share),
            // Too little moves, or centroids are where the sites are.
            Err(Error::Degenerate | Error::TooFewVelocities { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok((movie.clone().with_positions_at(measurement.share.value), measurement))
}

/// The share that explains a movie best, from that which it is taken for on.
fn estimate(movie: Movie, request: &Request, watch: &mut Watch<'_>) -> Result<Estimated, Error> {
    let space = request.space()?;
    let Begun { mut course, mut at, mut states, .. } =
        Begun::new(&movie, States::new(&movie)?, request, &space, watch)?;
    let own = space.dimension();
    let mut found = Estimated { share: [movie.share(), f64::INFINITY], criterion: f64::INFINITY };
    for _ in 0..ROUNDS {
        at = course.pass(&states, at)?;
        let objective = course.objective(&states);
        let equations = objective.linearise_with(&at, Share::Unknown)?;
        let components = objective.explained_components(&objective.displaced(&at)?, &at);
        let likelihood = Restricted { equations: &equations, components, known: request.noise, held: None };
        let criterion = likelihood.criterion(objective.levels.spring().ln())?;
        let reduced = equations.reduced()?;
        let inverse = invert(reduced.information)?;
        let step = (&inverse * &reduced.gradient)[own];
        let error = objective.levels.velocity * inverse[(own, own)].max(0.0).sqrt();
        let value = (found.share[0] + step).clamp(SITES, CENTROIDS);
        let settled = (value - found.share[0]).abs() < NEGLIGIBLE * error;
        found = Estimated { share: [value, error], criterion };
        if settled {
            break;
        }
        states = states.at_share(value);
    }
    Ok(found)
}
