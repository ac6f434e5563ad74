//! Cells that differ as candidates: what single cells have of their own instead of columns, beside the last model.
//!
//! A parameter in which cells differ explains whatever varies from cell to cell a little, so it is asked for last. It is told from scatter that is the
//! same everywhere, and must explain more than a smooth flow does. What is known of single cells predicts no cell that was not seen: such an effect
//! is never proven by velocities held out.

use super::growth::{Grown, Growth};
use super::lineup::{added_places, upper_chi_squared};
use super::ranking::{self, by_evidence, untested};
use super::resilience::weakness_of_difference;
use super::result::{Fate, Ranked, Selected};
use super::steps::{LEAD, Model, Setting};
use crate::search::Watch;
use crate::spread::{evidence, evidence_of_field, probability};
use crate::{Error, Estimate, FitParameter, Inference, Observation};
use voronudge_geometry::Vector;
use voronudge_model::CellParameter;

/// What a smooth flow must explain more: it has one more variance, and the best of some lengths.
const PRICE_OF_FIELD: f64 = 4.0;

/// Why an effect is taken back beside cells that differ.
const BESIDE: &str = "where cells differ, it is no more than chance";

/// Why cells are not said to differ.
const SMOOTH: &str = "a smooth flow describes better what is left";
const UNTOLD: &str = "these velocities cannot tell it from a smooth flow";
const TURNED: &str = "it is not looked for beside effects on whole velocities";
const DEGENERATE: &str = "the velocities cannot tell it from the parameters that all cells share";

/// A parameter in which cells differ.
#[derive(Clone)]
struct Difference {
    candidate: usize,
    parameter: CellParameter,
    evidence: f64,
    /// Candidates that say as much.
    class: Vec<usize>,
}

/// The last model with what cells have of their own.
pub(super) struct Heterogeneity {
    /// Only for what it leaves: its frames have the parameters of their cells, which are from all velocities.
    pub model: Model,
    found: Vec<Difference>,
}

/// What is known of all candidates, and the parameters in which cells differ.
struct Sought {
    ranked: Vec<Ranked>,
    found: Vec<Difference>,
}

/// Lets cells differ beside what was found, if they do; what is no more than chance then is taken back.
pub(super) fn beside(
    growth: &mut Growth<'_>,
    mut grown: Option<Grown>,
    watch: &mut Watch<'_>,
) -> Result<(Option<Grown>, Option<Heterogeneity>), Error> {
    let setting = growth.setting;
    loop {
        let model = grown.as_ref().map_or(growth.base, |grown| &grown.model);
        let Sought { ranked, found } = sought(&setting, model, watch)?;
        ranked.into_iter().for_each(|own| growth.ranking.put(own));
        if found.is_empty() {
            return Ok((grown, None));
        }
        let varied = found.iter().map(|own| own.parameter).collect();
        let model = match setting.differing(model, varied, watch) {
            Ok(model) => model,
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(error) => {
                let refused = found.iter().map(|own| setting.candidates[own.candidate].effect);
                let fate = Fate::NotFitted(error);
                refused.for_each(|effect| growth.ranking.end(effect, &fate));
                return Ok((grown, None));
            }
        };
        let heterogeneity = Heterogeneity { model, found };
        match (heterogeneity.superfluous(&setting), grown) {
            (Some(candidate), Some(all)) => grown = growth.take_back(all, candidate, BESIDE, watch)?,
            (_, grown) => return Ok((grown, Some(heterogeneity))),
        }
    }
}

/// The parameters in which cells differ, the one for which most speaks first.
fn sought(setting: &Setting<'_>, model: &Model, watch: &mut Watch<'_>) -> Result<Sought, Error> {
    let offered: Vec<(usize, CellParameter)> = (setting.named(&[]).into_iter())
        .filter_map(|k| Some((k, setting.candidates[k].differing()?)))
        .collect();
    let mut sought = Sought { ranked: Vec::new(), found: Vec::new() };
    let without = |k: usize, reason| untested(setting.candidates[k].effect, Fate::NotTestable(reason));
    if !model.request.structure.responses.is_empty() {
        sought.ranked = offered.iter().map(|own| without(own.0, TURNED)).collect();
        return Ok(sought);
    }
    let (objective, at) = (model.objective(setting.frames), model.point(setting.frames));
    let known = setting.search.fit.noise;
    let mut open = offered;
    while !open.is_empty() {
        let beside: Vec<CellParameter> = sought.found.iter().map(|own| own.parameter).collect();
        let falls = watch.each("cells that differ", &open, 1.0, |(_, parameter)| {
            Ok(evidence(&objective, &at, known, &beside, *parameter).ok())
        })?;
        let all = open.iter().map(|own| own.0).zip(falls);
        let told: Vec<(usize, f64)> = all.clone().filter_map(|(k, fall)| Some((k, fall?))).collect();
        if beside.is_empty() {
            let row = |(k, fall): (usize, Option<f64>)| match fall {
                Some(fall) => by_evidence(setting, k, (fall.max(0.0), 1, probability(fall))),
                None => without(k, DEGENERATE),
            };
            sought.ranked = all.map(row).collect();
        }
        let Some(&(candidate, most)) = told.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if adjusted_p(setting, most) >= setting.level(model.added.len() + beside.len()) {
            break;
        }
        let place = open.iter().position(|own| own.0 == candidate).unwrap_or_default();
        let (candidate, parameter) = open.remove(place);
        if beside.is_empty() {
            let against = match evidence_of_field(&objective, &at, known) {
                Ok(smooth) => (smooth > most + PRICE_OF_FIELD).then_some(SMOOTH),
                Err(_) => Some(UNTOLD),
            };
            let against = match against {
                None => {
                    let left = |frames: &[Observation]| {
                        evidence(&model.objective_on(frames), &at, known, &[], parameter).ok()
                    };
                    let is_chance = |fall| adjusted_p(setting, fall) >= setting.level(model.added.len());
                    weakness_of_difference(setting, model, most, left, is_chance)?
                }
                against => against,
            };
            if let Some(reason) = against {
                let own = sought.ranked.iter_mut().filter(|own| own.fate == Fate::Explained);
                own.for_each(|own| own.fate = Fate::NotConfirmed(reason));
                break;
            }
        }
        let is_close = |own: &&(usize, f64)| own.0 != candidate && own.1 > most - LEAD;
        let class = told.iter().filter(is_close).map(|own| own.0).collect();
        sought.found.push(Difference { candidate, parameter, evidence: most, class });
    }
    Ok(sought)
}

/// The probability of so much evidence for any of all candidates if there is nothing.
fn adjusted_p(setting: &Setting<'_>, evidence: f64) -> f64 {
    ranking::adjusted_p(setting, probability(evidence))
}

impl Heterogeneity {
    /// The effect that is most likely chance beside cells that differ, if one is: none of its coefficients differs from nought.
    fn superfluous(&self, setting: &Setting<'_>) -> Option<usize> {
        let Model { added, inference, .. } = &self.model;
        let places = added_places(&setting.search.fit.structure, setting.candidates, added).effects;
        let p = |places: &Vec<usize>| {
            let of = |place: &usize| {
                let own = &inference.effects[place - FitParameter::COEFFICIENTS];
                upper_chi_squared((own.value / own.standard_error).powi(2), 1.0)
            };
            let least = places.iter().map(of).fold(1.0, f64::min);
            least * (places.len() * setting.named(&[]).len()) as f64
        };
        let all = added.iter().zip(&places).map(|(candidate, places)| (*candidate, p(places)));
        let level = setting.level(added.len());
        all.filter(|(_, p)| *p >= level).max_by(|a, b| a.1.total_cmp(&b.1)).map(|own| own.0)
    }

    /// The parameters in which cells differ as effects, which explain a share of the excess together.
    pub fn selected(&self, setting: &Setting<'_>, share: f64) -> Result<Vec<Selected>, Error> {
        let inference = &self.model.inference;
        let sizes = (self.found.iter())
            .map(|own| size(setting, &self.model, own.parameter))
            .collect::<Result<Vec<_>, Error>>()?;
        let squares: f64 = sizes.iter().map(|size| size * size).sum();
        let of = |(own, size): (&Difference, f64)| Selected {
            effect: setting.candidates[own.candidate].effect,
            columns: Vec::new(),
            coefficients: vec![estimate(inference, own.parameter)],
            adjusted_p: adjusted_p(setting, own.evidence),
            share_of_excess: share * size * size / squares.max(f64::MIN_POSITIVE),
            size,
            class: own.class.iter().map(|k| setting.candidates[*k].effect).collect(),
            partial: Vec::new(),
        };
        Ok(self.found.iter().zip(sizes).map(of).collect())
    }
}

/// The standard deviation over cells; its standard error is that of a normal distribution as wide as its interval.
fn estimate(inference: &Inference, parameter: CellParameter) -> Estimate {
    let own = inference.spreads.iter().find(|own| own.parameter == parameter);
    let (value, interval) = own.map_or((0.0, [Some(0.0), None]), |own| (own.value, own.interval));
    let half = interval[0].zip(interval[1]).map_or(f64::INFINITY, |(low, high)| 0.5 * (high - low) / 1.96);
    Estimate { value, standard_error: half, interval }
}

/// Root mean square velocity that comes of what cells have of their own, relative to that of the data.
fn size(setting: &Setting<'_>, model: &Model, parameter: CellParameter) -> Result<f64, Error> {
    let inference = &model.inference;
    let coefficients = inference.coefficients.as_slice();
    let predicted = |frames: &[Observation]| -> Result<Vec<Vec<Vector<f64>>>, Error> {
        let objective = model.objective_on(frames);
        let nudges = crate::uncertainty::nudges(frames, inference);
        let of_frame = |(index, own): (usize, &Vec<f64>)| {
            Ok(objective.displaced(index, own)?.evaluate(coefficients).predicted)
        };
        nudges.iter().enumerate().map(of_frame).collect()
    };
    let (alike, own) =
        (predicted(setting.frames)?, predicted(&inference.differing(setting.frames, &[parameter])?)?);
    let mut squares = 0.0;
    for (index, frame) in setting.frames.iter().enumerate() {
        let of = |(datum, _): (usize, Vector<f64>)| (own[index][datum] - alike[index][datum]).norm_squared();
        squares += frame.targets().map(of).sum::<f64>();
    }
    Ok((squares / inference.total).sqrt())
}
