//! Parameters that differ from cell to cell, as multiples of those of the model.

use crate::element::element;
use crate::environment::picked;
use crate::{AreaElasticity, Environment, EnvironmentError, Model, Term, WeightedTerm};
use std::sync::Arc;
use voronudge_geometry::{Arithmetic, CellPolygon, Scalar, Tessellation, Vector};

/// A parameter of the base model that cells may have of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CellParameter {
    /// `K_A`
    AreaElasticity,
    /// `P_0`
    PreferredPerimeter,
    /// `A_0`, a gauge as long as it is the same for all cells.
    PreferredArea,
    /// `α`
    Chirality,
}

impl CellParameter {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::AreaElasticity, Self::PreferredPerimeter, Self::PreferredArea, Self::Chirality];

    /// Name in arguments and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::AreaElasticity => "K_A",
            Self::PreferredPerimeter => "P_0",
            Self::PreferredArea => "A_0",
            Self::Chirality => "alpha",
        }
    }

    /// The parameter of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name)
    }
}

/// Multiples of the parameters of the model, one for each cell; one where none are given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CellFactors {
    of_parameters: [Vec<f64>; CellParameter::ALL.len()],
}

impl CellFactors {
    /// No differences.
    pub(crate) const ALIKE: Self = Self { of_parameters: [const { Vec::new() }; CellParameter::ALL.len()] };

    /// The same with the multiples (N) of one parameter.
    ///
    /// # Errors
    /// [`EnvironmentError::Cells`] if there are others for another number of cells, [`EnvironmentError::Value`] if one is not finite.
    pub fn with(mut self, parameter: CellParameter, factors: Vec<f64>) -> Result<Self, EnvironmentError> {
        let what = "parameters of cells";
        if let Some(&value) = factors.iter().find(|factor| !factor.is_finite()) {
            return Err(EnvironmentError::Value { what, value });
        }
        if let Some(expected) = self.cells().filter(|cells| *cells != factors.len()) {
            return Err(EnvironmentError::Cells { what, found: factors.len(), expected });
        }
        self.of_parameters[parameter as usize] = factors;
        Ok(self)
    }

    /// Number of cells, if any parameter is given.
    pub fn cells(&self) -> Option<usize> {
        self.of_parameters.iter().map(Vec::len).find(|cells| *cells > 0)
    }

    /// Those of some of the cells, by their index.
    pub(crate) fn of_cells(&self, cells: &[usize]) -> Self {
        Self { of_parameters: self.of_parameters.each_ref().map(|factors| picked(factors, cells)) }
    }

    /// The multiple of a parameter that a cell has.
    #[inline]
    pub fn factor(&self, parameter: CellParameter, cell: usize) -> f64 {
        self.of_parameters[parameter as usize].get(cell).copied().unwrap_or(1.0)
    }

    /// A term as one cell has it.
    #[inline]
    pub fn term<S: Arithmetic>(&self, weighted: &WeightedTerm<S>, cell: usize) -> WeightedTerm<S> {
        let WeightedTerm { term, coefficient } = *weighted;
        let factor = |parameter| self.factor(parameter, cell);
        match term {
            Term::AreaElasticity(AreaElasticity { preferred_area }) => WeightedTerm {
                term: AreaElasticity {
                    preferred_area: preferred_area * factor(CellParameter::PreferredArea),
                }
                .into(),
                coefficient: coefficient * factor(CellParameter::AreaElasticity),
            },
            Term::Adhesion(_) => {
                WeightedTerm { term, coefficient: coefficient * factor(CellParameter::PreferredPerimeter) }
            }
            Term::CorticalChirality(_) => {
                WeightedTerm { term, coefficient: coefficient * factor(CellParameter::Chirality) }
            }
            _ => WeightedTerm { term, coefficient },
        }
    }
}

/// Derivatives of all velocities by the multiple of one parameter that each cell has: that of cell `i` moves `i` and its ring.
#[derive(Debug, Clone, PartialEq)]
pub struct CellDerivatives<S> {
    /// Derivative of the velocity of a cell by its own multiple (N).
    pub on_cell: Vec<Vector<S>>,
    /// Derivative of the velocity of the neighbour that a half-edge points at by the multiple of the half-edge's cell.
    pub on_neighbour: Vec<Vector<S>>,
}

/// Derivatives of the velocities of the terms by the multiples that the cells have of one parameter.
///
/// Forces are linear in each multiple, so the derivative is what a cell's element gains from a multiple of nought to one of one. Cells
/// whose polygon is not closed have none. Responses are left out.
pub fn cell_derivatives<S: Scalar>(
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    model: &Model<S>,
    parameter: CellParameter,
) -> CellDerivatives<S> {
    let cells = tessellation.len();
    let (zero, domain) = (S::constant(0.0), tessellation.domain());
    let nothing = Vector::new(zero, zero);
    let mut found = CellDerivatives {
        on_cell: vec![nothing; cells],
        on_neighbour: vec![nothing; tessellation.half_edges()],
    };
    let given = model.environment.cell_factors();
    let at = |factor: f64| {
        let mut factors = given.clone();
        factors.of_parameters[parameter as usize] = vec![factor; cells];
        let mut model = Model { responses: Vec::new(), ..model.clone() };
        model.terms.retain(|weighted| weighted.term.is_shape_term());
        model.environment = Arc::new(Environment::clone(&model.environment).having(factors));
        model
    };
    let (one, none) = (at(1.0), at(0.0));
    let (mut polygon, mut without) = (CellPolygon::default(), Vec::new());
    for cell in (0..cells).filter(|&cell| tessellation.is_closed(cell)) {
        polygon.fill(tessellation, positions, cell);
        let (ring, neighbours) = (tessellation.ring(cell), tessellation.neighbours(cell));
        without.clear();
        without.resize(neighbours.len(), nothing);
        let of = |model: &Model<S>, on_ring: &mut [Vector<S>]| {
            element(model, cell, neighbours, positions[cell], domain, &polygon, on_ring)
        };
        let with = &mut found.on_neighbour[ring];
        found.on_cell[cell] = of(&one, with) - of(&none, &mut without);
        with.iter_mut().zip(&without).for_each(|(with, without)| *with -= *without);
    }
    found
}
