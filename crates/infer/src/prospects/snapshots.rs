//! What would be known of velocities measured otherwise.

use super::{Design, Informed, Prospects, growth_with_area, multiplied};
use crate::normal_equations::Reduced;
use crate::objective::Objective;
use crate::uncertainty::nudges;
use crate::{CoefficientSpace, Error, Inference, NoiseLevels, Observation, Request};
use voronudge_model::Structure;

/// What a fit to snapshots would know if more, or better, had been measured. Nothing is said of cells that differ, nor of half the interval:
/// the error of a velocity that is measured by itself is not known at another one.
///
/// # Errors
/// [`Error`] if the data do not determine the coefficients.
pub fn prospects(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
) -> Result<Option<Prospects>, Error> {
    if !request.varied.is_empty() {
        return Ok(None);
    }
    let space = request.space()?;
    let coefficients = result.coefficients.as_slice();
    let informed = informed(frames, (&request.structure, &space), coefficients, result)?;
    informed.prospects(&space, &request.constraints, result).map(Some)
}

/// The information about a fit, on the coefficients of a model that may have more terms than that of the fit.
pub(crate) fn informed(
    frames: &[Observation],
    (structure, space): (&Structure, &CoefficientSpace),
    coefficients: &[f64],
    result: &Inference,
) -> Result<Informed, Error> {
    let weighed = result.weighed(frames);
    let frames = weighed.as_deref().unwrap_or(frames);
    let objective = Objective::new(frames, structure, space, result.noise);
    let mut at = space.nearest(coefficients);
    at.extend(nudges(frames, result).concat());
    // What is not known of the measurement would be learned as well.
    let unknowns = frames.first().map_or(&[][..], Observation::unknowns);
    let equations = objective.linearise_with(&at, unknowns)?;
    let own = space.dimension();
    let alone = |reduced: Reduced| match unknowns.len() {
        0 => Ok(reduced.information),
        count => reduced.without_last(count).map(|reduced| reduced.information),
    };
    // What the model misses beyond noise counts as noise.
    let variance = result.noise.velocity.powi(2) * result.excess();
    let now = alone(equations.reduced()?)? / variance;
    let sharper = NoiseLevels { position: 0.5 * result.noise.position, ..result.noise };
    let sharp = alone(equations.reduced_at(sharper)?)? / variance;
    let priors = equations.of_priors().view((0, 0), (own, own)) / variance;
    let data = frames.iter().map(|frame| frame.velocities.values().len()).sum::<usize>() as f64;
    let reach = |frame: &Observation| {
        (0..frame.velocities.values().len()).filter(|datum| frame.is_in_reach(*datum)).count()
    };
    let in_reach = frames.iter().map(reach).sum::<usize>() as f64 / data;
    let domain = frames.first().ok_or(Error::Degenerate)?.tessellation.domain();
    let growth = growth_with_area(domain, in_reach);
    let with = vec![
        (Design::TwiceTheFrames, multiplied(&now, &priors, 2.0)),
        (Design::HalfThePositionNoise, sharp),
        (Design::TwiceTheField, multiplied(&now, &priors, growth)),
    ];
    Ok(Informed { now, with })
}
