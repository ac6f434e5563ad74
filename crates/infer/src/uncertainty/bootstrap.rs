//! Parametric bootstrap: what the same procedure makes of data that the fit itself could have made.

use crate::discover::Observer;
use crate::replicates::{Keeper, Series};
use crate::search::Watch;
use crate::seeds::{Purpose, seed_of};
use crate::{
    CrossValidation, Error, Examination, FitParameter, Flow, Inference, Observation, Prior, Request,
    Velocities, infer,
};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use voronudge_geometry::Vector;

/// Estimates from synthetic data sets.
#[derive(Debug, Clone, PartialEq)]
pub struct Bootstrap {
    /// One set of parameters for each replicate that could be fitted, in the order of [`FitParameter::ALL`].
    pub replicates: Vec<[f64; 5]>,
    /// Replicates that could not be fitted.
    pub failed: usize,
}

impl Bootstrap {
    /// The estimates of a quantity, ascending.
    pub fn values(&self, quantity: FitParameter) -> Vec<f64> {
        let index = FitParameter::ALL.iter().position(|q| *q == quantity).unwrap_or(0);
        let mut values: Vec<f64> = self.replicates.iter().map(|replicate| replicate[index]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values
    }

    /// The central 95 % of the estimates of a quantity; `None` with fewer than 40 replicates.
    pub fn interval(&self, quantity: FitParameter) -> Option<[f64; 2]> {
        let values = self.values(quantity);
        let quantile = |p: f64| {
            let at = p * (values.len() - 1) as f64;
            let (low, share) = (at.floor() as usize, at.fract());
            let next = values[(low + 1).min(values.len() - 1)];
            values[low] + share * (next - values[low])
        };
        (values.len() >= 40).then(|| [quantile(0.025), quantile(0.975)])
    }
}

/// Refits synthetic data: cells at the nudged positions that move as predicted, measured with the noise of the fit.
///
/// Noise levels that were estimated are estimated anew each time. Replicates run in parallel; each has a seed of its own
/// made from the request's, so results depend neither on the number of threads nor on what `keeper` knows of them.
///
/// # Errors
/// [`Error::Interrupted`], also where some replicates are made elsewhere.
pub fn bootstrap(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
    replicates: usize,
    keeper: &mut dyn Keeper,
    observe: Observer<'_>,
) -> Result<Bootstrap, Error> {
    let series = Series { stage: "bootstrap", count: replicates, made_from: result };
    let refit =
        |index: usize, observe: Observer<'_>| replicate(frames, request, result, index as u64 + 1, observe);
    let fitted = series.make(refit, keeper, &mut Watch { observe })?;
    let failed = fitted.iter().filter(|fit| fit.is_none()).count();
    Ok(Bootstrap { replicates: fitted.into_iter().flatten().collect(), failed })
}

fn replicate(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
    number: u64,
    observe: Observer<'_>,
) -> Result<[f64; 5], Error> {
    // Where the model misses more than the noise explains, the misfit counts as noise of the velocities.
    let scatter = result.noise.velocity * result.excess().sqrt();
    let (synthetic, request) = synthetic(frames, request, result, scatter, number)?;
    let refit = infer(&synthetic, &request, observe)?;
    Ok(FitParameter::ALL.map(|quantity| refit.parameters.get(quantity).value))
}

/// Data that a fit could have made, with noise of the velocities as given, and the request to fit them in the same way; another set for every number.
pub(crate) fn synthetic(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
    velocity_noise: f64,
    number: u64,
) -> Result<(Vec<Observation>, Request), Error> {
    let mut rng = Pcg64::seed_from_u64(request.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(number));
    let level =
        |sigma: f64| Normal::new(0.0, sigma).map_err(|_| Error::Noise { name: "position", value: sigma });
    let on_positions = level(result.noise.position)?;
    let on_velocities = level(velocity_noise)?;
    let mut noisy = |v: &Vector<f64>, normal: &Normal<f64>| {
        Vector::new(v.x + normal.sample(&mut rng), v.y + normal.sample(&mut rng))
    };
    let mut synthetic = Vec::with_capacity(frames.len());
    for (frame, own) in frames.iter().zip(&result.frames) {
        let positions = frame
            .seen_from(&own.tessellation, &own.nudged_positions)
            .into_iter()
            .enumerate()
            .map(|(cell, y)| y + noisy(&Vector::zeros(), &on_positions) * frame.position_error(cell))
            .collect();
        let values: Vec<Option<Vector<f64>>> = own
            .predicted_data
            .iter()
            .enumerate()
            .map(|(datum, v)| frame.target(datum).map(|_| noisy(v, &on_velocities)))
            .collect();
        let velocities = match &frame.velocities {
            Velocities::OfCells(_) => Velocities::OfCells(values),
            Velocities::OnGrid(flow) => Velocities::OnGrid(Flow { velocities: values, ..flow.clone() }),
        };
        let all: Vec<usize> = (0..frame.positions.len()).collect();
        synthetic.push(frame.with_cells(&all, positions, velocities)?.measured_like(frame)?);
    }
    let mut request = Request {
        cross_validation: CrossValidation::Skipped,
        examination: Examination::Skipped,
        seed: seed_of(request.seed, Purpose::Refit, number),
        ..request.clone()
    };
    // A prior is a measurement too.
    for (quantity, prior) in &mut request.constraints.priors {
        let normal = level(prior.standard_deviation)?;
        *prior =
            Prior { mean: quantity.of(result.coefficients.as_slice()) + normal.sample(&mut rng), ..*prior };
    }
    Ok((synthetic, request))
}
