//! Simulations that carry derivatives.

use super::{Simulation, State};
use crate::Error;
use num_dual::DualSVec64;
use voronudge_geometry::{Arithmetic, Vector};
use voronudge_model::{Model, PARAMETER_NAMES, Parameters, WeightedResponse, WeightedTerm};

/// What a run is differentiated by: a direction among the coefficients of its model and the positions that it starts from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Direction {
    /// By how much the coefficient of each term changes, then that of each response; none of those beyond the end.
    pub coefficients: Vec<f64>,
    /// By how much some cells are displaced: cell and displacement.
    pub displacements: Vec<(usize, Vector<f64>)>,
}

impl Direction {
    /// A parameter of the base model, by its name in [`PARAMETER_NAMES`], all others held; `None` for another name.
    ///
    /// ```
    /// use voronudge_model::Parameters;
    /// use voronudge_simulate::Direction;
    /// let parameters = Parameters { perimeter_elasticity: 2.0, ..Parameters::default() };
    /// // P_0 is in one coefficient, K_P P_0.
    /// assert_eq!(Direction::parameter("P_0", &parameters).unwrap().coefficients, [0.0, 2.0, 0.0, 0.0]);
    /// assert_eq!(Direction::parameter("A_0", &parameters), None); // changes no velocity
    /// ```
    pub fn parameter(name: &str, parameters: &Parameters<f64>) -> Option<Self> {
        let index = PARAMETER_NAMES.iter().position(|own| *own == name)?;
        let seeded = |value: f64, own: usize| {
            let seed = DualSVec64::<1>::from_re(value);
            if own == index { seed.derivative(0) } else { seed }
        };
        let coefficients = Parameters {
            area_elasticity: seeded(parameters.area_elasticity, 0),
            perimeter_elasticity: seeded(parameters.perimeter_elasticity, 1),
            preferred_perimeter: seeded(parameters.preferred_perimeter, 2),
            preferred_area: parameters.preferred_area,
            chirality: seeded(parameters.chirality, 3),
        }
        .coefficients();
        let slope = |c: &DualSVec64<1>| c.eps.0.map_or(0.0, |eps| eps[0]);
        Some(Self { coefficients: coefficients.iter().map(slope).collect(), displacements: Vec::new() })
    }

    /// The coefficient of a term of a model, or, behind all of these, of a response.
    pub fn coefficient(index: usize) -> Self {
        let mut coefficients = vec![0.0; index + 1];
        coefficients[index] = 1.0;
        Self { coefficients, displacements: Vec::new() }
    }

    /// A coordinate of the starting position of a cell.
    pub fn position(cell: usize, axis: usize) -> Self {
        let mut displacement = Vector::zeros();
        displacement[axis] = 1.0;
        Self { coefficients: Vec::new(), displacements: vec![(cell, displacement)] }
    }
}

/// Derivatives of a number along as many directions as its type has.
pub fn derivatives<const D: usize>(number: &DualSVec64<D>) -> [f64; D] {
    number.eps.0.map_or([0.0; D], |eps| std::array::from_fn(|k| eps[k]))
}

/// Derivatives of vectors along one direction.
pub(crate) fn slopes<const D: usize>(
    vectors: &[Vector<DualSVec64<D>>],
    direction: usize,
) -> Vec<Vector<f64>> {
    vectors.iter().map(|v| v.map(|x| derivatives(&x)[direction])).collect()
}

impl Simulation {
    /// The same simulation from now on with derivatives along some directions, from which [`derivatives`] are read.
    ///
    /// # Errors
    /// [`Error::NoSuchCell`]; [`Error::Tessellation`] as in [`Simulation::new`].
    ///
    /// ```
    /// use voronudge_geometry::{Domain, PeriodicBox};
    /// use voronudge_model::{Model, Parameters};
    /// use voronudge_simulate::{Direction, RandomPlacement, Simulation, derivatives, generator};
    /// let cell_box = PeriodicBox::new([5.0, 5.0])?;
    /// let positions = RandomPlacement::new(25, cell_box).draw(&mut generator(1))?;
    /// let parameters = Parameters { chirality: 0.5, ..Parameters::default() };
    /// let plain = Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(&parameters))?;
    /// let by_alpha = Direction::parameter("alpha", &parameters).unwrap();
    /// let mut run = plain.along(&[by_alpha, Direction::position(3, 0)])?;
    /// run.step(0.01)?;
    /// let [_, by_x3] = derivatives(&run.positions()[3].x);
    /// assert!(by_x3 > 0.9 && by_x3 < 1.1); // it has hardly moved
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn along<const D: usize>(
        &self,
        directions: &[Direction; D],
    ) -> Result<Simulation<DualSVec64<D>>, Error> {
        let seeded = |value: f64, along: &dyn Fn(&Direction) -> f64| {
            let mut number = DualSVec64::<D>::from_re(value);
            let slopes: [f64; D] = std::array::from_fn(|k| along(&directions[k]));
            if slopes.iter().any(|slope| *slope != 0.0) {
                number.eps.0 = Some(slopes.into());
            }
            number
        };
        let of_coefficient = |value: f64, index: usize| {
            seeded(value, &|own| own.coefficients.get(index).copied().unwrap_or(0.0))
        };
        let mut positions: Vec<Vector<DualSVec64<D>>> = voronudge_geometry::lift(self.positions());
        for (k, direction) in directions.iter().enumerate() {
            for (cell, displacement) in &direction.displacements {
                let cells = self.positions().len();
                let Some(r) = positions.get_mut(*cell) else {
                    return Err(Error::NoSuchCell { cell: *cell, cells });
                };
                for axis in 0..2 {
                    let eps = &mut r[axis].eps.0;
                    eps.get_or_insert_with(|| [0.0; D].into())[k] += displacement[axis];
                }
            }
        }
        let Model { terms, responses, environment } = self.model();
        let count = terms.len();
        let term = |(index, own): (usize, &WeightedTerm<f64>)| WeightedTerm {
            term: own.term,
            coefficient: of_coefficient(own.coefficient, index),
        };
        let response = |(index, own): (usize, &WeightedResponse<f64>)| WeightedResponse {
            response: own.response,
            coefficient: of_coefficient(own.coefficient, count + index),
        };
        let model = Model {
            terms: terms.iter().enumerate().map(term).collect(),
            responses: responses.iter().enumerate().map(response).collect(),
            environment: environment.clone(),
        };
        let constants =
            |numbers: &[f64]| numbers.iter().map(|number| DualSVec64::constant(*number)).collect();
        let State { time, steps, crossings, part, headings, speeds, .. } = &self.now;
        let now = State {
            time: *time,
            steps: *steps,
            crossings: *crossings,
            part: *part,
            positions,
            headings: constants(headings),
            speeds: constants(speeds),
        };
        self.carried_over(model, now)
    }

    /// The same simulation from now on a way along a direction, with the model and from the positions that are there.
    ///
    /// # Errors
    /// [`Error::NoSuchCell`]; [`Error::Tessellation`] as in [`Simulation::new`].
    pub fn beside(&self, direction: &Direction, way: f64) -> Result<Self, Error> {
        let mut model = self.model().clone();
        let terms = model.terms.iter_mut().map(|own| &mut own.coefficient);
        let responses = model.responses.iter_mut().map(|own| &mut own.coefficient);
        for (own, slope) in terms.chain(responses).zip(&direction.coefficients) {
            *own += way * slope;
        }
        let mut state = self.state().clone();
        let cells = state.positions.len();
        for (cell, displacement) in &direction.displacements {
            let Some(r) = state.positions.get_mut(*cell) else {
                return Err(Error::NoSuchCell { cell: *cell, cells });
            };
            *r += displacement * way;
        }
        self.clone().with_model(model)?.in_state(state)
    }
}
