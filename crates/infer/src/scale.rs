//! Between the units of the data and the scales of the tissue.

use crate::{Error, FitParameter, Observation};
use nalgebra::Vector4;
use voronudge_geometry::{Visibility, areas};
use voronudge_model::effect::Unit;

/// The scales in which a fit is made: lengths in ℓ₀ (ℓ₀² = mean cell area), times in τ, so that velocities are of order one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// ℓ₀ in the data's unit of length.
    pub length: f64,
    /// τ in the data's unit of time.
    pub time: f64,
}

impl Scale {
    /// The scale of some frames in the units of their data: `ℓ₀²` is the mean area of the cells that count, and τ makes the root mean square of
    /// the velocities to be explained one.
    ///
    /// # Errors
    /// [`Error::TooFewVelocities`] if no cell counts or has a velocity, [`Error::NothingMoves`].
    pub fn of(frames: &[Observation]) -> Result<Self, Error> {
        let (mut area, mut cells, mut squares, mut used) = (0.0, 0.0, 0.0, 0usize);
        for frame in frames {
            let areas = areas(&frame.tessellation, &frame.positions);
            for (a, visibility) in areas.iter().zip(&frame.visibility) {
                if *visibility == Visibility::Counted {
                    area += a;
                    cells += 1.0;
                }
            }
            for (_, v) in frame.targets() {
                squares += v.norm_squared();
                used += 1;
            }
        }
        if used == 0 || cells == 0.0 {
            return Err(Error::TooFewVelocities { used, required: 4 });
        }
        if squares == 0.0 {
            return Err(Error::NothingMoves);
        }
        let length = (area / cells).sqrt();
        Ok(Self { length, time: length / (squares / used as f64).sqrt() })
    }

    /// Velocities of the data per scaled velocity.
    pub fn velocity(&self) -> f64 {
        self.length / self.time
    }

    /// Factors from scaled coefficients `(K_A, K_P P_0, K_P, K_P α)` to those in the units of the data.
    pub fn coefficients(&self) -> Vector4<f64> {
        Vector4::new(1.0 / (self.length * self.length), self.length, 1.0, 1.0) / self.time
    }

    /// A number of some unit in the units of the data, per unit of the fit.
    ///
    /// ```
    /// use voronudge_infer::Scale;
    /// use voronudge_model::effect::Unit;
    /// // A cell of size 20 µm and a time of 5 min: scaled velocities are multiples of 4 µm min⁻¹.
    /// let scale = Scale { length: 20.0, time: 5.0 };
    /// assert!((scale.unit(Unit { length: 1, time: -1 }) - 4.0).abs() < 1e-12);
    /// assert!((scale.unit(Unit { length: -2, time: -1 }) - 1.0 / 2000.0).abs() < 1e-15);
    /// ```
    pub fn unit(&self, unit: Unit) -> f64 {
        self.length.powi(unit.length.into()) * self.time.powi(unit.time.into())
    }

    /// A quantity in the units of the data, per unit of the fit.
    pub fn factor(&self, quantity: FitParameter) -> f64 {
        let coefficients = self.coefficients();
        match quantity {
            FitParameter::AreaElasticity => coefficients[0],
            FitParameter::PerimeterElasticity => coefficients[2],
            FitParameter::PreferredPerimeter => self.length,
            FitParameter::Chirality => 1.0,
            FitParameter::ChiralCoefficient => coefficients[3],
        }
    }
}
