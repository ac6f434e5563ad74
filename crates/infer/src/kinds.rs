//! Kinds of cells, told by labels: parameters that the cells of a label have of their own.

use crate::estimates::Fitted;
use crate::fit_parameter::BASE;
use crate::normal_matrix::invert;
use crate::{Error, Estimate, FitParameter, NORMAL_95, ParameterEstimates};
use nalgebra::{DVector, RowDVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use voronudge_model::Column;
use voronudge_model::effect::{LabelParameter, LabelledParameter};

/// Labels whose cells have parameters of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct Kinds {
    /// The label of the cells that have the parameters of the model, as cells without a label have.
    pub reference: i64,
    /// The other labels.
    pub others: Vec<i64>,
    /// What the cells of the others have of their own: for each label a coefficient for each of these.
    pub parameters: Vec<LabelledParameter>,
}

/// What a fit says of the cells of one label.
#[derive(Debug, Clone, PartialEq)]
pub struct KindEstimates {
    /// The label.
    pub label: i64,
    /// Their parameters.
    pub parameters: ParameterEstimates,
    /// By how much these exceed those of the reference, to first order; empty for the reference itself. Those that are the same by
    /// construction are left out.
    pub differences: Vec<(FitParameter, Estimate)>,
    /// Probability of so large differences if there are none (Wald's χ² of all coefficients of the label); one for the reference.
    pub p: f64,
}

impl Kinds {
    /// What is added to the terms of the base model.
    pub fn columns(&self) -> Vec<Column> {
        let of = |label: &i64| {
            let label = *label;
            self.parameters.iter().map(move |&parameter| LabelParameter { label, parameter }.into())
        };
        self.others.iter().flat_map(of).collect()
    }

    /// The coefficient of effects, by its number, that is added to each coefficient of the base model in the cells of a label.
    fn added(&self, label: usize) -> [Option<usize>; BASE] {
        let mut added = [None; BASE];
        for (k, parameter) in self.parameters.iter().enumerate() {
            let coefficient = match parameter {
                LabelledParameter::Adhesion => FitParameter::PreferredPerimeter,
                LabelledParameter::Contractility => FitParameter::PerimeterElasticity,
                LabelledParameter::Chirality => FitParameter::ChiralCoefficient,
            };
            added[coefficient.coefficient()] = Some(label * self.parameters.len() + k);
        }
        added
    }
}

/// Quantities in which kinds may differ.
const COMPARED: [FitParameter; 4] = [
    FitParameter::PerimeterElasticity,
    FitParameter::PreferredPerimeter,
    FitParameter::Chirality,
    FitParameter::ChiralCoefficient,
];

impl Fitted<'_> {
    /// The estimates of each kind, the reference first.
    pub fn kinds(&self, kinds: &Kinds) -> Result<Vec<KindEstimates>, Error> {
        let covariance = invert(self.information.clone())?;
        let base = self.rows([None; BASE]);
        let reference = KindEstimates {
            label: kinds.reference,
            parameters: self.estimates_of(&base)?,
            differences: Vec::new(),
            p: 1.0,
        };
        let mut all = vec![reference];
        for (number, &label) in kinds.others.iter().enumerate() {
            let rows = self.rows(kinds.added(number));
            let difference = |quantity: FitParameter| {
                let [own, reference] = [&rows, &base].map(|rows| {
                    let c = rows.coefficients(self.free);
                    let gradient: RowDVector<f64> =
                        quantity.gradient(c.as_slice()).transpose() * &rows.gradient;
                    (quantity.of(c.as_slice()), gradient)
                });
                let gradient = own.1 - reference.1;
                let standard_error = (&gradient * &covariance * gradient.transpose())[(0, 0)].max(0.0).sqrt();
                let (value, reach) = (own.0 - reference.0, NORMAL_95 * standard_error);
                let interval = [Some(value - reach), Some(value + reach)];
                (standard_error > 0.0).then_some((quantity, Estimate { value, standard_error, interval }))
            };
            let count = kinds.parameters.len();
            let first = self.space.base_dimension() + number * count;
            let own = DVector::from_fn(count, |k, _| self.free[first + k]);
            let spread = covariance.view((first, first), (count, count)).into_owned();
            let squares = own.dot(&(invert(spread)? * &own));
            let law = ChiSquared::new(count as f64);
            all.push(KindEstimates {
                label,
                parameters: self.estimates_of(&rows)?,
                differences: COMPARED.into_iter().filter_map(difference).collect(),
                p: law.map_or(f64::NAN, |law| law.sf(squares)),
            });
        }
        Ok(all)
    }
}
