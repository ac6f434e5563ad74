//! Parameters that differ from cell to cell, as multiples of those of the model.

use crate::assembly::element;
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
        model.terms.retain(|weighted| !weighted.term.is_ring_term());
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Parameters, jacobian, velocities};
    use num_dual::Dual64;
    use voronudge_geometry::{Domain, PeriodicBox};

    fn tissue() -> (Tessellation, Vec<Vector<f64>>) {
        let positions: Vec<Vector<f64>> = (0..36)
            .map(|i| {
                let x = f64::from(i);
                Vector::new(f64::from(i % 6) + 0.3 * x.sin(), f64::from(i / 6) + 0.3 * (2.0 * x).cos())
            })
            .collect();
        let domain = Domain::Periodic(PeriodicBox::new([6.0, 6.0]).unwrap());
        (Tessellation::new(&positions, domain).unwrap(), positions)
    }

    fn uneven() -> CellFactors {
        CellParameter::ALL.into_iter().enumerate().fold(CellFactors::default(), |factors, (k, parameter)| {
            let own = (0..36).map(|i| 1.0 + 0.2 * (f64::from(i) + k as f64).sin()).collect();
            factors.with(parameter, own).unwrap()
        })
    }

    fn model(factors: CellFactors) -> Model<f64> {
        let model = Model::chiral_voronoi(&Parameters { chirality: 0.7, ..Parameters::default() });
        model.within(&Arc::new(Environment::default().with_cell_factors(factors).unwrap()))
    }

    /// Velocities are linear in a multiple: a finite difference is exact to rounding. Momentum is conserved.
    #[test]
    fn derivatives_are_finite_differences() {
        let (tessellation, positions) = tissue();
        let before = velocities(&tessellation, &positions, &model(uneven()));
        for parameter in CellParameter::ALL {
            let found = cell_derivatives(&tessellation, &positions, &model(uneven()), parameter);
            let cell = 17;
            let mut factors = uneven();
            factors.of_parameters[parameter as usize][cell] += 0.5;
            let after = velocities(&tessellation, &positions, &model(factors));
            let mut expected = vec![Vector::zeros(); 36];
            expected[cell] += found.on_cell[cell];
            for h in tessellation.ring(cell) {
                expected[tessellation.neighbour(h)] += found.on_neighbour[h];
            }
            let momentum: Vector<f64> = expected.iter().sum();
            let size = expected.iter().map(|v| v.norm()).fold(0.0, f64::max);
            assert!(momentum.norm() < 1e-12 && size > 1e-3, "{parameter:?} {size}");
            for ((a, b), slope) in after.iter().zip(&before).zip(&expected) {
                assert!(((a - b) * 2.0 - slope).norm() < 1e-12, "{parameter:?}");
            }
        }
    }

    /// The Jacobian of cells that differ is that of dual numbers through the velocities.
    #[test]
    fn the_jacobian_knows_that_cells_differ() {
        let (tessellation, positions) = tissue();
        let model = model(uneven());
        let found = jacobian(&tessellation, &positions, &model).to_dense();
        for column in 0..72 {
            let seed = |i: usize, axis: usize, x: f64| Dual64::new(x, f64::from(2 * i + axis == column));
            let moved: Vec<Vector<Dual64>> = positions
                .iter()
                .enumerate()
                .map(|(i, r)| Vector::new(seed(i, 0, r.x), seed(i, 1, r.y)))
                .collect();
            let v = velocities(&tessellation, &moved, &model.lift::<Dual64>());
            for (i, v) in v.iter().enumerate() {
                assert!((found[2 * i * 72 + column] - v.x.eps).abs() < 1e-10);
                assert!((found[(2 * i + 1) * 72 + column] - v.y.eps).abs() < 1e-10);
            }
        }
    }

    /// What is the same for all cells changes nothing if it is one, and nothing at all if it is a preferred area.
    #[test]
    fn one_preferred_area_for_all_is_a_gauge() {
        let (tessellation, positions) = tissue();
        let plain = velocities(&tessellation, &positions, &model(CellFactors::default()));
        let same = CellFactors::default().with(CellParameter::PreferredArea, vec![1.3; 36]).unwrap();
        let found = velocities(&tessellation, &positions, &model(same));
        assert!(plain.iter().zip(&found).all(|(a, b)| (a - b).norm() < 1e-12));
    }

    #[test]
    fn factors_of_another_number_of_cells_are_refused() {
        let factors = CellFactors::default().with(CellParameter::Chirality, vec![1.0; 3]).unwrap();
        assert!(factors.clone().with(CellParameter::PreferredArea, vec![1.0; 4]).is_err());
        assert!(factors.clone().with(CellParameter::PreferredArea, vec![f64::NAN; 3]).is_err());
        let labelled = Environment::default().with_labels(vec![Some(1); 4]).unwrap();
        assert!(labelled.with_cell_factors(factors).is_err());
    }
}
