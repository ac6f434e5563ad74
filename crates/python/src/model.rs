//! A model from keyword arguments.

use crate::error::fault;
use num_dual::Dual64;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;
use voronudge::geometry::{FieldOfView, lift};
use voronudge::model::{Column, Effect, Environment, PARAMETER_NAMES, velocities};
use voronudge::{Model, Parameters, Tessellation, Vector};

/// Parameters and effects as given.
pub(crate) struct Given {
    parameters: Parameters<f64>,
    effects: Vec<(&'static Effect, Vec<f64>)>,
}

impl Given {
    /// From the keyword arguments `K_A`, `K_P`, `P_0`, `A_0`, `alpha` and `effects`.
    pub fn read(py: Python<'_>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut given = Self { parameters: Parameters::default(), effects: Vec::new() };
        for (name, value) in keywords.into_iter().flatten() {
            let name: String = name.extract()?;
            if name == "effects" {
                given.effects = effects(py, &value)?;
                continue;
            }
            let slots = given.parameters.by_name();
            let Some((_, slot)) = slots.into_iter().find(|(own, _)| *own == name) else {
                let hint = "the parameters are K_A, K_P, P_0, A_0, alpha and effects={id: coefficients}";
                return Err(fault(py, format!("there is no parameter {name:?}"), Some(hint)));
            };
            *slot = value.extract().map_err(|_| not_a_number(py, &name))?;
            if !slot.is_finite() {
                return Err(not_a_number(py, &name));
            }
        }
        Ok(given)
    }

    /// The model of a tissue.
    pub fn model(
        &self,
        py: Python<'_>,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        view: &FieldOfView,
    ) -> PyResult<Model<f64>> {
        let mut model = Model::chiral_voronoi(&self.parameters);
        if self.effects.is_empty() {
            return Ok(model);
        }
        let certificate = view.judge(tessellation, positions);
        let environment = Environment::around(tessellation, positions, &certificate)
            .map_err(|error| fault(py, error, Some("check the positions")))?;
        for (effect, values) in &self.effects {
            model = (effect.add_to(model, &environment, tessellation.domain(), values))
                .map_err(|error| fault(py, format!("effect {}: {error}", effect.id), Some(error.hint())))?;
        }
        Ok(model.within(&Arc::new(environment)))
    }

    /// Derivatives of `Σ_i w_i·v_i` by the parameters and by the coefficients of the effects, by name. Cells without a velocity do not
    /// count.
    pub fn slopes(
        &self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        model: &Model<f64>,
        w: &[Vector<f64>],
    ) -> Vec<(String, Vec<f64>)> {
        let lifted = lift::<Dual64>(positions);
        let slope = |model: &Model<Dual64>| -> f64 {
            let v = velocities(tessellation, &lifted, model);
            v.iter()
                .zip(w)
                .filter(|(v, _)| v.x.re.is_finite())
                .map(|(v, w)| v.x.eps * w.x + v.y.eps * w.y)
                .sum()
        };
        let seeded = |value: f64| Dual64::from_re(value).derivative();
        let of_parameter = |index: usize| {
            let own = |k: usize, value: f64| if k == index { seeded(value) } else { Dual64::from_re(value) };
            let Parameters {
                area_elasticity,
                perimeter_elasticity,
                preferred_perimeter,
                preferred_area,
                chirality,
            } = self.parameters;
            let coefficients = Parameters {
                area_elasticity: own(0, area_elasticity),
                perimeter_elasticity: own(1, perimeter_elasticity),
                preferred_perimeter: own(2, preferred_perimeter),
                preferred_area,
                chirality: own(3, chirality),
            }
            .coefficients();
            let mut along = model.lift::<Dual64>();
            for (term, coefficient) in along.terms.iter_mut().zip(coefficients) {
                term.coefficient = coefficient;
            }
            slope(&along)
        };
        let base = PARAMETER_NAMES.len();
        let mut slopes: Vec<(String, Vec<f64>)> = PARAMETER_NAMES
            .iter()
            .enumerate()
            .map(|(k, name)| ((*name).to_owned(), vec![of_parameter(k)]))
            .collect();
        let (mut terms, mut responses) = (base.., 0..);
        for (effect, values) in &self.effects {
            let columns = effect.columns(&model.environment, tessellation.domain()).unwrap_or_default();
            let own = columns.iter().zip(values).map(|(column, &value)| {
                let mut along = model.lift::<Dual64>();
                let place = match column {
                    Column::Term(_) => {
                        terms.next().and_then(|k| along.terms.get_mut(k)).map(|w| &mut w.coefficient)
                    }
                    Column::Response(_) => {
                        responses.next().and_then(|k| along.responses.get_mut(k)).map(|w| &mut w.coefficient)
                    }
                };
                if let Some(coefficient) = place {
                    *coefficient = seeded(value);
                }
                slope(&along)
            });
            let own = own.collect();
            slopes.push((effect.id.to_owned(), own));
        }
        slopes
    }
}

fn effects(py: Python<'_>, given: &Bound<'_, PyAny>) -> PyResult<Vec<(&'static Effect, Vec<f64>)>> {
    const HINT: &str =
        r#"give them as {"drift": [0.1, 0.0], "alpha_area": 0.3}; voronudge.EFFECTS lists them"#;
    let Ok(table) = given.cast::<PyDict>() else {
        return Err(fault(py, "effects is not a dict", Some(HINT)));
    };
    let mut found = Vec::new();
    for (id, values) in table {
        let id: String = id.extract()?;
        let effect = Effect::from_id(&id)
            .ok_or_else(|| fault(py, format!("there is no effect {id:?}"), Some(HINT)))?;
        let values: Vec<f64> = match values.extract::<f64>() {
            Ok(value) => vec![value],
            Err(_) => values.extract().map_err(|_| not_a_number(py, &id))?,
        };
        if values.iter().any(|value| !value.is_finite()) {
            return Err(not_a_number(py, &id));
        }
        found.push((effect, values));
    }
    Ok(found)
}

fn not_a_number(py: Python<'_>, name: &str) -> PyErr {
    fault(py, format!("{name} is not a finite number"), Some("give a number"))
}
