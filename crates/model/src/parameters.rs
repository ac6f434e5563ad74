//! The parameters of the chiral Voronoi model and the coefficients of its terms.

use crate::{Model, Term, columns};
use num_dual::DualSVec64;
use voronudge_geometry::{Scalar, Tessellation, Vector};

/// Names of the parameters that change velocities, in the order of [`parameter_derivatives`].
pub const PARAMETER_NAMES: [&str; 4] = ["K_A", "K_P", "P_0", "alpha"];

/// Parameters of the base model. Units are those of the positions and of time (friction is absorbed).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters<S> {
    /// Area elasticity `K_A` (1 / length² / time).
    pub area_elasticity: S,
    /// Perimeter elasticity `K_P` (1 / time).
    pub perimeter_elasticity: S,
    /// Preferred perimeter `P_0` (length).
    pub preferred_perimeter: S,
    /// Preferred area `A_0` (length²): a gauge that changes no velocity.
    pub preferred_area: f64,
    /// Cortical chirality `α`; positive adds the contraction turned clockwise by a quarter (y axis up).
    pub chirality: S,
}

impl<S: Scalar> Parameters<S> {
    /// Coefficients of the terms of the base model: `K_A`, `K_P P_0`, `K_P` and `K_P α`.
    pub fn coefficients(&self) -> [S; 4] {
        let k_p = self.perimeter_elasticity;
        [self.area_elasticity, k_p * self.preferred_perimeter, k_p, k_p * self.chirality]
    }
}

impl Parameters<f64> {
    /// Each parameter by the name that it has in files, on the command line and in Python.
    ///
    /// ```
    /// let mut parameters = voronudge_model::Parameters::default();
    /// for (name, value) in parameters.by_name() {
    ///     if name == "alpha" {
    ///         *value = 0.5;
    ///     }
    /// }
    /// assert_eq!(parameters.chirality, 0.5);
    /// ```
    pub fn by_name(&mut self) -> [(&'static str, &mut f64); 5] {
        [
            ("K_A", &mut self.area_elasticity),
            ("K_P", &mut self.perimeter_elasticity),
            ("P_0", &mut self.preferred_perimeter),
            ("A_0", &mut self.preferred_area),
            ("alpha", &mut self.chirality),
        ]
    }
}

impl Default for Parameters<f64> {
    fn default() -> Self {
        Self {
            area_elasticity: 0.1,
            perimeter_elasticity: 1.0,
            preferred_perimeter: 4.0,
            preferred_area: 1.0,
            chirality: 0.0,
        }
    }
}

/// Derivatives `∂v/∂θ` of all velocities with respect to `K_A`, `K_P`, `P_0` and `α`: four fields of N vectors.
pub fn parameter_derivatives(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    parameters: &Parameters<f64>,
) -> [Vec<Vector<f64>>; 4] {
    type Dual = DualSVec64<4>;
    let seed = |value: f64, index: usize| Dual::from_re(value).derivative(index);
    let model = Model::chiral_voronoi(&Parameters {
        area_elasticity: seed(parameters.area_elasticity, 0),
        perimeter_elasticity: seed(parameters.perimeter_elasticity, 1),
        preferred_perimeter: seed(parameters.preferred_perimeter, 2),
        preferred_area: parameters.preferred_area,
        chirality: seed(parameters.chirality, 3),
    });
    let terms: Vec<Term> = model.terms.iter().map(|w| w.term).collect();
    let columns = columns(tessellation, positions, &terms, &model.environment);
    std::array::from_fn(|parameter| {
        let mut field = vec![Vector::zeros(); positions.len()];
        for (weighted, column) in model.terms.iter().zip(&columns) {
            let slope = weighted.coefficient.eps.0.map_or(0.0, |eps| eps[parameter]);
            for (v, x) in field.iter_mut().zip(column) {
                *v += x * slope;
            }
        }
        field
    })
}
