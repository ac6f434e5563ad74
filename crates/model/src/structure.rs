//! Models: sums of terms with coefficients, and what is left if the coefficients are left open.

use crate::{
    Adhesion, AreaElasticity, Column, Contractility, CorticalChirality, Environment, Parameters, Response,
    Site, Term, columns, response::respond,
};
use num_dual::{Dual64, DualSVec64};
use std::sync::Arc;
use voronudge_geometry::{Arithmetic, Scalar, Tessellation, Vector, lift};

/// A term and its coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedTerm<S> {
    /// The term.
    pub term: Term,
    /// Its coefficient.
    pub coefficient: S,
}

/// A response and its coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedResponse<S> {
    /// The response.
    pub response: Response,
    /// Its coefficient.
    pub coefficient: S,
}

/// A model of the tissue: a sum of terms, and responses that act on the velocities of the terms.
#[derive(Debug, Clone, PartialEq)]
pub struct Model<S> {
    /// The terms and their coefficients; velocities are linear in the latter as long as there is no response.
    pub terms: Vec<WeightedTerm<S>>,
    /// The responses and their coefficients.
    pub responses: Vec<WeightedResponse<S>>,
    /// What surrounds and preceded the cells.
    pub environment: Arc<Environment>,
}

impl<S: Scalar> Model<S> {
    /// The base model: area elasticity `K_A`, adhesion `K_P P_0`, contractility `K_P`, cortical chirality `K_P α`.
    pub fn chiral_voronoi(parameters: &Parameters<S>) -> Self {
        Self::with_coefficients(&base_terms(parameters.preferred_area), &parameters.coefficients())
    }

    /// Terms with coefficients, in the same order.
    pub fn with_coefficients(terms: &[Term], coefficients: &[S]) -> Self {
        let terms = terms
            .iter()
            .zip(coefficients)
            .map(|(&term, &coefficient)| WeightedTerm { term, coefficient })
            .collect();
        Self { terms, responses: Vec::new(), environment: Arc::default() }
    }

    /// A single term with a coefficient of one.
    pub fn single(term: Term) -> Self {
        Self::with_coefficients(&[term], &[S::constant(1.0)])
    }

    /// The same model with one column more.
    #[must_use]
    pub fn with(mut self, column: Column, coefficient: S) -> Self {
        match column {
            Column::Term(term) => self.terms.push(WeightedTerm { term, coefficient }),
            Column::Response(response) => self.responses.push(WeightedResponse { response, coefficient }),
        }
        self
    }

    /// The same model with coefficients of another scalar, without derivatives.
    pub fn lift<D: Scalar>(&self) -> Model<D> {
        self.map(|coefficient| D::constant(coefficient.real()))
    }

    /// The same model with every coefficient mapped.
    pub(crate) fn map<D: Arithmetic>(&self, map: impl Fn(S) -> D) -> Model<D> {
        let term = |w: &WeightedTerm<S>| WeightedTerm { term: w.term, coefficient: map(w.coefficient) };
        let response = |w: &WeightedResponse<S>| WeightedResponse {
            response: w.response,
            coefficient: map(w.coefficient),
        };
        Model {
            terms: self.terms.iter().map(term).collect(),
            responses: self.responses.iter().map(response).collect(),
            environment: self.environment.clone(),
        }
    }

    /// The same model in an environment.
    #[must_use]
    pub fn within(self, environment: &Arc<Environment>) -> Self {
        Self { environment: environment.clone(), ..self }
    }

    /// The terms that descend an energy.
    pub(crate) fn passive(&self) -> Self {
        Self {
            terms: self.terms.iter().filter(|w| w.term.has_energy()).copied().collect(),
            responses: Vec::new(),
            environment: self.environment.clone(),
        }
    }

    /// Whether a term is more than a multiple of the gradients of areas and perimeters.
    pub fn has_ring_terms(&self) -> bool {
        self.terms.iter().any(|w| w.term.is_ring_term())
    }
}

impl<S: Arithmetic> Model<S> {
    /// Whether coefficients of shape terms differ from cell to cell.
    pub(crate) fn has_modulated_terms(&self) -> bool {
        self.terms.iter().any(|w| !w.term.is_shape_term() && !w.term.is_ring_term())
    }

    /// Whether all terms are functions of areas and perimeters, the same for all cells but for parameters of their own.
    pub fn is_of_shapes(&self) -> bool {
        self.terms.iter().all(|w| w.term.is_shape_term())
    }

    /// Whether the multiples of the gradients of area and perimeter are the same functions of these for all cells.
    pub(crate) fn cells_are_alike(&self) -> bool {
        !self.environment.cells_differ() && !self.has_modulated_terms()
    }

    /// Where a cell is.
    pub fn site(&self, cell: usize, neighbours: usize, position: Vector<S>) -> Site<'_, S> {
        Site { cell, neighbours, position, environment: &self.environment }
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

/// What a model consists of, its coefficients left open: first those of the terms, then those of the responses.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// The terms; the first four are those of the base model.
    pub terms: Vec<Term>,
    /// The responses.
    pub responses: Vec<Response>,
}

/// Velocities and their derivatives by the coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Velocity of each cell (N).
    pub velocities: Vec<Vector<f64>>,
    /// Derivative of the velocities by each coefficient.
    pub by_coefficient: Vec<Vec<Vector<f64>>>,
}

/// Coefficients by which velocities are differentiated at once.
const DIRECTIONS: usize = 8;
type Dual = DualSVec64<DIRECTIONS>;

impl Structure {
    /// The base model.
    pub fn base(preferred_area: f64) -> Self {
        Self { terms: base_terms(preferred_area).to_vec(), responses: Vec::new() }
    }

    /// The same with further columns.
    #[must_use]
    pub fn with(&self, columns: &[Column]) -> Self {
        let mut structure = self.clone();
        for column in columns {
            match *column {
                Column::Term(term) => structure.terms.push(term),
                Column::Response(response) => structure.responses.push(response),
            }
        }
        structure
    }

    /// Number of coefficients.
    pub fn dimension(&self) -> usize {
        self.terms.len() + self.responses.len()
    }

    /// The model with coefficients (one for each term, then one for each response) in an environment.
    pub fn model<S: Scalar>(&self, coefficients: &[S], environment: &Arc<Environment>) -> Model<S> {
        let mut model = Model::with_coefficients(&self.terms, coefficients).within(environment);
        let of_responses = coefficients.iter().skip(self.terms.len());
        model.responses = (self.responses.iter().zip(of_responses))
            .map(|(&response, &coefficient)| WeightedResponse { response, coefficient })
            .collect();
        model
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

    /// Velocities and their derivatives by all coefficients, from the columns of the terms at these positions. Both are
    /// exact to rounding, whatever the responses.
    pub fn evaluate(
        &self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        columns: &[Vec<Vector<f64>>],
        coefficients: &[f64],
        environment: &Arc<Environment>,
    ) -> Evaluation {
        if self.responses.is_empty() {
            let velocities = Fields { tessellation, positions, columns }.sum(coefficients);
            return Evaluation { velocities, by_coefficient: columns.to_vec() };
        }
        let fields = Fields { tessellation, positions, columns };
        let mut model = self.model(coefficients, environment);
        let is_active = |k: usize| k < self.terms.len() || coefficients[k] != 0.0;
        let active: Vec<usize> = (0..self.dimension()).filter(|k| is_active(*k)).collect();
        model.responses.retain(|w| w.coefficient != 0.0);
        let mut by_coefficient = vec![Vec::new(); self.dimension()];
        let velocities = if model.responses.is_empty() {
            by_coefficient[..columns.len()].clone_from_slice(columns);
            fields.sum(coefficients)
        } else {
            let mut velocities = Vec::new();
            for chosen in active.chunks(DIRECTIONS) {
                let mut at: Vec<Dual> = coefficients.iter().map(|c| Dual::from_re(*c)).collect();
                chosen.iter().enumerate().for_each(|(k, c)| at[*c] = at[*c].derivative(k));
                let mut seeded = self.model(&at, environment);
                seeded.responses.retain(|w| w.coefficient.re != 0.0);
                let v = fields.respond(&seeded, &at);
                for (k, c) in chosen.iter().enumerate() {
                    let slope = |x: &Dual| x.eps.0.map_or(0.0, |eps| eps[k]);
                    by_coefficient[*c] = v.iter().map(|v| Vector::new(slope(&v.x), slope(&v.y))).collect();
                }
                velocities = v.iter().map(|v| Vector::new(v.x.re, v.y.re)).collect();
            }
            velocities
        };
        // What is not part of the model yet, one after another.
        for k in (0..self.dimension()).filter(|k| !is_active(*k)) {
            let at: Vec<Dual64> = coefficients.iter().map(|c| Dual64::from_re(*c)).collect();
            let mut seeded = model.map(Dual64::from_re);
            let response = self.responses[k - self.terms.len()];
            seeded.responses.push(WeightedResponse { response, coefficient: Dual64::new(0.0, 1.0) });
            let v = fields.respond(&seeded, &at);
            by_coefficient[k] = v.iter().map(|v| Vector::new(v.x.eps, v.y.eps)).collect();
        }
        Evaluation { velocities, by_coefficient }
    }
}

/// The columns of the terms at some positions.
struct Fields<'a> {
    tessellation: &'a Tessellation,
    positions: &'a [Vector<f64>],
    columns: &'a [Vec<Vector<f64>>],
}

impl Fields<'_> {
    /// Velocities of the terms.
    fn sum<S: Scalar>(&self, coefficients: &[S]) -> Vec<Vector<S>> {
        let zero = S::constant(0.0);
        let mut v = vec![Vector::new(zero, zero); self.positions.len()];
        for (column, coefficient) in self.columns.iter().zip(coefficients) {
            for (sum, x) in v.iter_mut().zip(column) {
                *sum += Vector::new(*coefficient * x.x, *coefficient * x.y);
            }
        }
        v
    }

    /// The same with the responses of a model.
    fn respond<S: Scalar>(&self, model: &Model<S>, coefficients: &[S]) -> Vec<Vector<S>> {
        let mut v = self.sum(coefficients);
        respond(self.tessellation, &lift::<S>(self.positions), model, &mut v);
        v
    }
}
