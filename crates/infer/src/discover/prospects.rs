//! What further measurements would say of what was found: how well it would be known, and what could be told apart.

use super::lineup::added_places;
use super::result::Selected;
use super::steps::{Model, Setting};
use crate::fit_parameter::BASE;
use crate::prospects::{Ambiguity, Informed, Prospects, informed, prospects};
use crate::{CoefficientSpace, Error};
use voronudge_model::Structure;

/// What would be known of a model and of the effects that were added to it. Nothing is said of effects without columns, and of cells that
/// differ.
pub(super) fn of(
    setting: &Setting<'_>,
    model: &Model,
    selected: &[Selected],
) -> Result<Option<Prospects>, Error> {
    let Model { request, inference, .. } = model;
    let found = match (&model.followed, setting.movie) {
        (Some(followed), Some(movie)) => Some(followed.prospects(movie, request, inference)?),
        _ => prospects(setting.frames, request, inference)?,
    };
    let Some(mut found) = found else { return Ok(None) };
    let places = added_places(&setting.search.fit.structure, setting.candidates, &model.added).effects;
    for prospect in &mut found.designs {
        let of = |own: &Selected| -> Vec<f64> {
            let is_it = |candidate: &usize| setting.candidates[*candidate].effect.id == own.effect.id;
            let place = model.added.iter().position(is_it).map(|k| &places[k]);
            match place.filter(|place| place.len() == own.coefficients.len()) {
                Some(place) => place.iter().map(|k| prospect.effects[k - BASE]).collect(),
                None => vec![f64::NAN; own.coefficients.len()],
            }
        };
        prospect.effects = selected.iter().flat_map(of).collect();
    }
    for own in selected {
        for other in own.class.iter().filter(|other| other.id != own.effect.id) {
            // What cannot be told apart at all has no information to speak of.
            match ambiguity(setting, model, own, other.id) {
                Ok(ambiguity) => found.ambiguities.extend(ambiguity),
                Err(Error::Degenerate) => {}
                Err(error) => return Err(error),
            }
        }
    }
    Ok(Some(found))
}

/// An effect and one that could stand in its place, both in the model.
fn ambiguity(
    setting: &Setting<'_>,
    model: &Model,
    selected: &Selected,
    other: &'static str,
) -> Result<Option<Ambiguity>, Error> {
    let index = |id: &str| setting.candidates.iter().position(|candidate| candidate.effect.id == id);
    let has_columns = |k: &usize| setting.candidates[*k].columns.as_ref().is_ok_and(|own| !own.is_empty());
    let both = (index(selected.effect.id).filter(has_columns), index(other).filter(has_columns));
    let (Some(own), Some(rival)) = both else { return Ok(None) };
    let Some(place) = model.added.iter().position(|candidate| *candidate == own) else { return Ok(None) };
    let added: Vec<usize> = model.added.iter().copied().chain([rival]).collect();
    let places = added_places(&setting.search.fit.structure, setting.candidates, &added);
    let coefficients = setting.coefficients_of(model, &added);
    let space = setting.search.fit.space()?.with_coefficients(places.structure.dimension());
    let informed = model.informed(setting, (&places.structure, &space), &coefficients)?;
    let of_effect = &places.effects[place];
    // Each effect has a direction of its own, after those of the base model.
    let free: Vec<usize> = of_effect.iter().map(|k| space.base_dimension() + k - BASE).collect();
    let c: Vec<f64> = of_effect.iter().map(|k| coefficients[*k]).collect();
    let (separation, with) = informed.separations(&free, &c)?;
    Ok(Some(Ambiguity { effect: selected.effect.id, other, separation, with }))
}

impl Model {
    /// The information on the coefficients of a model with more terms.
    fn informed(
        &self,
        setting: &Setting<'_>,
        model: (&Structure, &CoefficientSpace),
        coefficients: &[f64],
    ) -> Result<Informed, Error> {
        match (&self.followed, setting.movie) {
            (Some(followed), Some(movie)) => {
                followed.informed(movie, model, coefficients, (self.request.noise, &self.inference))
            }
            _ => informed(setting.frames, model, coefficients, &self.inference),
        }
    }
}
