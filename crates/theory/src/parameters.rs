//! What the theory depends on.

use crate::{Error, hexagon_perimeter};

/// Parameters of the model, in units in which the mean area of a cell is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Area elasticity `K_A` (rate per area). Zero in the paper's theory.
    pub area_elasticity: f64,
    /// Perimeter elasticity `K_P` (rate), positive.
    pub perimeter_elasticity: f64,
    /// Preferred perimeter `P_0` (length).
    pub preferred_perimeter: f64,
    /// Chirality `α`.
    pub chirality: f64,
}

impl Default for Parameters {
    /// `K_A = 0`, `K_P = 1`, `P_0 = 3`, `α = 0`.
    fn default() -> Self {
        Self { area_elasticity: 0.0, perimeter_elasticity: 1.0, preferred_perimeter: 3.0, chirality: 0.0 }
    }
}

/// The theory for one set of parameters that make sense.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanField {
    parameters: Parameters,
}

impl MeanField {
    /// The theory for these parameters.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a parameter is not finite, [`Error::PerimeterElasticity`] if `K_P` is not positive.
    pub fn new(parameters: Parameters) -> Result<Self, Error> {
        let Parameters { area_elasticity, perimeter_elasticity, preferred_perimeter, chirality } = parameters;
        let named = [
            ("K_A", area_elasticity),
            ("K_P", perimeter_elasticity),
            ("P_0", preferred_perimeter),
            ("α", chirality),
        ];
        if let Some((name, value)) = named.into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(Error::Parameter { name, value });
        }
        if perimeter_elasticity <= 0.0 {
            return Err(Error::PerimeterElasticity { value: perimeter_elasticity });
        }
        Ok(Self { parameters })
    }

    /// The parameters.
    pub fn parameters(&self) -> Parameters {
        self.parameters
    }

    /// Distance from the limit of stability `s = 1 − P_0/P_MF`, positive in the solid.
    pub fn distance_to_limit(&self) -> f64 {
        1.0 - self.parameters.preferred_perimeter / hexagon_perimeter()
    }

    /// The theory with another chirality, which is finite.
    pub(crate) fn with_chirality(self, chirality: f64) -> Self {
        Self { parameters: Parameters { chirality, ..self.parameters } }
    }

    /// The theory with another preferred perimeter, which is finite.
    pub(crate) fn with_preferred_perimeter(self, preferred_perimeter: f64) -> Self {
        Self { parameters: Parameters { preferred_perimeter, ..self.parameters } }
    }
}
