//! Models: sums of terms with coefficients, and what is left if the coefficients are left open.

use crate::{
    Adhesion, AreaElasticity, Contractility, CorticalChirality, Environment, Parameters, Term, columns,
};
use std::sync::Arc;
use voronudge_geometry::{Scalar, Tessellation, Vector};

/// A term and its coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedTerm<S> {
    /// The term.
    pub term: Term,
    /// Its coefficient.
    pub coefficient: S,
}

/// A model of the tissue: a sum of terms.
#[derive(Debug, Clone, PartialEq)]
pub struct Model<S> {
    /// The terms and their coefficients; velocities are linear in the latter.
    pub terms: Vec<WeightedTerm<S>>,
    /// What surrounds and preceded the cells.
    pub environment: Arc<Environment>,
}

impl<S: Scalar> Model<S> {
    /// The base model: area elasticity `K_A`, adhesion `K_P P_0`, contractility `K_P`, cortical chirality `K_P α`.
    pub fn chiral_voronoi(parameters: &Parameters<S>) -> Self {
        let k_p = parameters.perimeter_elasticity;
        let coefficients = [
            parameters.area_elasticity,
            k_p * parameters.preferred_perimeter,
            k_p,
            k_p * parameters.chirality,
        ];
        Self::with_coefficients(&base_terms(parameters.preferred_area), &coefficients)
    }

    /// Terms with coefficients, in the same order.
    pub fn with_coefficients(terms: &[Term], coefficients: &[S]) -> Self {
        let terms = terms
            .iter()
            .zip(coefficients)
            .map(|(&term, &coefficient)| WeightedTerm { term, coefficient })
            .collect();
        Self { terms, environment: Arc::default() }
    }

    /// A single term with a coefficient of one.
    pub fn single(term: Term) -> Self {
        Self::with_coefficients(&[term], &[S::constant(1.0)])
    }

    /// The same model with coefficients of another scalar, without derivatives.
    pub fn lift<D: Scalar>(&self) -> Model<D> {
        let terms = self
            .terms
            .iter()
            .map(|w| WeightedTerm { term: w.term, coefficient: D::constant(w.coefficient.real()) })
            .collect();
        Model { terms, environment: self.environment.clone() }
    }

    /// The same model in an environment.
    #[must_use]
    pub fn within(self, environment: &Arc<Environment>) -> Self {
        Self { environment: environment.clone(), ..self }
    }
}

/// The terms of the base model in the order of its coefficients `K_A`, `K_P P_0`, `K_P`, `K_P α`.
pub fn base_terms(preferred_area: f64) -> [Term; 4] {
    [
        AreaElasticity { preferred_area }.into(),
        Adhesion.into(),
        Contractility.into(),
        CorticalChirality.into(),
    ]
}

/// What a model consists of, its coefficients left open.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// The terms; the first four are those of the base model.
    pub terms: Vec<Term>,
}

/// Velocities and their derivatives by the coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Velocity of each cell (N).
    pub velocities: Vec<Vector<f64>>,
    /// Derivative of the velocities by each coefficient.
    pub by_coefficient: Vec<Vec<Vector<f64>>>,
}

impl Structure {
    /// The base model.
    pub fn base(preferred_area: f64) -> Self {
        Self { terms: base_terms(preferred_area).to_vec() }
    }

    /// Number of coefficients.
    pub fn dimension(&self) -> usize {
        self.terms.len()
    }

    /// The model with coefficients (one for each term) in an environment.
    pub fn model<S: Scalar>(&self, coefficients: &[S], environment: &Arc<Environment>) -> Model<S> {
        Model::with_coefficients(&self.terms, coefficients).within(environment)
    }

    /// The velocity field of each term for a coefficient of one.
    pub fn columns(
        &self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        environment: &Arc<Environment>,
    ) -> Vec<Vec<Vector<f64>>> {
        columns(tessellation, positions, &self.terms, environment)
    }

    /// Velocities and their derivatives by the coefficients, from the columns at these positions.
    pub fn evaluate(
        &self,
        _tessellation: &Tessellation,
        positions: &[Vector<f64>],
        columns: &[Vec<Vector<f64>>],
        coefficients: &[f64],
        _environment: &Arc<Environment>,
    ) -> Evaluation {
        let velocities = (0..positions.len())
            .map(|cell| {
                columns.iter().zip(coefficients).fold(Vector::zeros(), |sum, (x, c)| sum + x[cell] * *c)
            })
            .collect();
        Evaluation { velocities, by_coefficient: columns.to_vec() }
    }
}
