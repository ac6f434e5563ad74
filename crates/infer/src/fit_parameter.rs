//! What a fit determines: parameters of the model, and the combination that data determine best.

use nalgebra::Vector4;

/// Number of coefficients of the base model.
pub(crate) const BASE: usize = 4;

/// A parameter, as a function of the coefficients `c = (K_A, K_P P_0, K_P, K_P α, …)`; what follows are effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FitParameter {
    /// `K_A`
    AreaElasticity,
    /// `K_P`
    PerimeterElasticity,
    /// `P_0`
    PreferredPerimeter,
    /// `α`
    Chirality,
    /// `K_P α`
    ChiralCoefficient,
}

impl FitParameter {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::AreaElasticity,
        Self::PerimeterElasticity,
        Self::PreferredPerimeter,
        Self::Chirality,
        Self::ChiralCoefficient,
    ];

    /// Number of coefficients of the base model.
    pub const COEFFICIENTS: usize = BASE;

    /// The name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::AreaElasticity => "K_A",
            Self::PerimeterElasticity => "K_P",
            Self::PreferredPerimeter => "P_0",
            Self::Chirality => "alpha",
            Self::ChiralCoefficient => "K_P_alpha",
        }
    }

    /// The quantity of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quantity| quantity.name() == name)
    }

    /// Index of the coefficient that the quantity is, or is a multiple of.
    pub(crate) fn coefficient(self) -> usize {
        match self {
            Self::AreaElasticity => 0,
            Self::PreferredPerimeter => 1,
            Self::PerimeterElasticity => 2,
            Self::Chirality | Self::ChiralCoefficient => 3,
        }
    }

    /// Whether the quantity is a ratio to `K_P`.
    pub(crate) fn is_ratio(self) -> bool {
        matches!(self, Self::PreferredPerimeter | Self::Chirality)
    }

    /// The value for given coefficients; NaN for ratios to a `K_P` that is zero to rounding.
    pub fn of(self, c: &[f64]) -> f64 {
        let c_q = c[self.coefficient()];
        let largest = c[..BASE].iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        match self.is_ratio() {
            false => c_q,
            true if c[2].abs() <= f64::EPSILON * largest => f64::NAN,
            true => c_q / c[2],
        }
    }

    /// `∂q/∂c`.
    pub(crate) fn gradient(self, c: &[f64]) -> Vector4<f64> {
        let mut gradient = Vector4::zeros();
        if self.is_ratio() {
            gradient[self.coefficient()] = 1.0 / c[2];
            gradient[2] = -c[self.coefficient()] / (c[2] * c[2]);
        } else {
            gradient[self.coefficient()] = 1.0;
        }
        gradient
    }

    /// The plane `aᵀc = b` on which the quantity has a value: `(a, b)`. For ratios it is that of `c_q − q K_P = 0`; where
    /// `K_P > 0`, larger values lie on the side `aᵀc > b`.
    pub(crate) fn plane(self, value: f64) -> (Vector4<f64>, f64) {
        let mut normal = Vector4::zeros();
        normal[self.coefficient()] = 1.0;
        if self.is_ratio() {
            normal[2] = -value;
            (normal, 0.0)
        } else {
            (normal, value)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_and_gradients_belong_to_the_values() {
        let c = [0.3, 7.0, 2.0, -5.0];
        let base = Vector4::from(c);
        for quantity in FitParameter::ALL {
            assert_eq!(FitParameter::from_name(quantity.name()), Some(quantity));
            let (normal, bound) = quantity.plane(quantity.of(&c));
            assert!((normal.dot(&base) - bound).abs() < 1e-14, "{quantity:?}");
            for k in 0..4 {
                let step = Vector4::ith(k, 1e-6);
                let difference =
                    (quantity.of((base + step).as_slice()) - quantity.of((base - step).as_slice())) / 2e-6;
                assert!((difference - quantity.gradient(&c)[k]).abs() < 1e-8, "{quantity:?} {k}");
            }
        }
    }
}
