//! Pressure and torques of a uniform tissue as functions of its density.

use crate::Error;

/// An equation of state: pressure `p = −(σ_xx + σ_yy)/2` and density of torques `τ = σ_xy − σ_yx` of a uniform, isotropic tissue that has
/// forgotten its strain, at several densities `ρ` (in units of `ρ₀`, where the mean area is 1).
///
/// Forces from a gradient along x are those of the stress `σ = [[−p, τ/2], [−τ/2, −p]]`, so with friction 1
///
/// ```text
/// ρ v_x = −∂_x p(ρ)        ρ v_y = −½ ∂_x τ(ρ)
/// ```
///
/// where a medium that remembers has the moduli of [`ChannelMedium`](crate::ChannelMedium). Small changes have the moduli `B = ρ p′` and
/// `A = ½ ρ τ′`; `μ` and `Kᵒ` are zero. Between the densities it is the cubic through neighbours with the slope of the parabola through three, beyond them a straight line.
#[derive(Debug, Clone, PartialEq)]
pub struct EquationOfState {
    density: Vec<f64>,
    pressure: Curve,
    torque: Curve,
}

/// Values at the densities, and slopes there.
#[derive(Debug, Clone, PartialEq)]
struct Curve {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// Looks at the slope of the pressure between two densities.
const LOOKS: usize = 8;

impl EquationOfState {
    /// From `[ρ, p, τ]` at three densities or more, which rise.
    ///
    /// # Errors
    /// [`Error::EquationOfState`] for fewer, for numbers that are not finite, and densities that do not rise from above zero.
    ///
    /// ```
    /// use voronudge_theory::EquationOfState;
    /// let square = |rho: f64| [rho, rho * rho, 3.0 * rho];
    /// let equation = EquationOfState::new(&[0.8, 1.0, 1.1, 1.5].map(square))?;
    /// assert!((equation.pressure(0.93) - 0.93 * 0.93).abs() < 1e-12); // exact for parabolas
    /// let [bulk, odd_bulk] = equation.moduli(1);
    /// assert!((bulk - 2.0).abs() < 1e-12 && (odd_bulk - 1.5).abs() < 1e-12);
    /// # Ok::<(), voronudge_theory::Error>(())
    /// ```
    pub fn new(points: &[[f64; 3]]) -> Result<Self, Error> {
        let fault = |reason| Err(Error::EquationOfState { reason });
        if points.len() < 3 {
            return fault("fewer than three densities");
        }
        if !points.iter().flatten().all(|value| value.is_finite()) {
            return fault("a number that is not finite");
        }
        if points[0][0] <= 0.0 || points.windows(2).any(|pair| pair[0][0] >= pair[1][0]) {
            return fault("densities that do not rise from above zero");
        }
        let [density, pressure, torque] =
            [0, 1, 2].map(|k| points.iter().map(|point| point[k]).collect::<Vec<f64>>());
        let curve = |values: Vec<f64>| {
            let slope =
                |point: usize| shares(&density, point).iter().map(|(k, share)| share * values[*k]).sum();
            let slopes = (0..values.len()).map(slope).collect();
            Curve { values, slopes }
        };
        Ok(Self { pressure: curve(pressure), torque: curve(torque), density })
    }

    /// The lowest and the highest density that it was made from.
    pub fn range(&self) -> [f64; 2] {
        [self.density[0], self.density[self.density.len() - 1]]
    }

    /// `p(ρ)`.
    pub fn pressure(&self, density: f64) -> f64 {
        self.value(&self.pressure, density)[0]
    }

    /// `τ(ρ)`.
    pub fn torque(&self, density: f64) -> f64 {
        self.value(&self.torque, density)[0]
    }

    /// The least and the largest `p′`, at any density: where one is not positive a uniform tissue is not stable.
    pub fn stiffness(&self) -> [f64; 2] {
        let looks = self
            .density
            .windows(2)
            .flat_map(|pair| (0..=LOOKS).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / LOOKS as f64));
        looks
            .map(|density| self.value(&self.pressure, density)[1])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], slope| [low.min(slope), high.max(slope)])
    }

    /// `B = ρ p′` and `A = ½ ρ τ′` at one of the densities.
    pub fn moduli(&self, point: usize) -> [f64; 2] {
        let rho = self.density[point];
        [rho * self.pressure.slopes[point], 0.5 * rho * self.torque.slopes[point]]
    }

    /// The slope at a density is the sum of these shares of the values at others: what its errors follow from.
    pub fn slope_shares(&self, point: usize) -> [(usize, f64); 3] {
        shares(&self.density, point)
    }

    /// Value and slope: the cubic between two neighbours with the slopes there.
    fn value(&self, Curve { values, slopes }: &Curve, density: f64) -> [f64; 2] {
        let last = self.density.len() - 1;
        let [lowest, highest] = self.range();
        let nearest = density.clamp(lowest, highest);
        if nearest != density {
            let end = if density < lowest { 0 } else { last };
            return [values[end] + slopes[end] * (density - nearest), slopes[end]];
        }
        let next = self.density.partition_point(|own| *own < density).clamp(1, last);
        let (a, b) = (next - 1, next);
        let width = self.density[b] - self.density[a];
        let t = (density - self.density[a]) / width;
        let rise = values[b] - values[a];
        // y_a + t·rise + t(1 − t)[(1 − t)(s_a w − rise) − t(s_b w − rise)]
        let [from_a, from_b] = [slopes[a] * width - rise, slopes[b] * width - rise];
        let bend = (1.0 - t) * from_a - t * from_b;
        let value = values[a] + t * rise + t * (1.0 - t) * bend;
        let slope = rise + (1.0 - 2.0 * t) * bend - t * (1.0 - t) * (from_a + from_b);
        [value, slope / width]
    }
}

/// Derivatives of Lagrange's polynomials through three neighbours at one of the densities.
fn shares(density: &[f64], point: usize) -> [(usize, f64); 3] {
    let middle = point.clamp(1, density.len() - 2);
    let [a, b, c] = [middle - 1, middle, middle + 1];
    let [x, y, z] = [a, b, c].map(|k| density[k]);
    let at = density[point];
    [
        (a, (2.0 * at - y - z) / ((x - y) * (x - z))),
        (b, (2.0 * at - x - z) / ((y - x) * (y - z))),
        (c, (2.0 * at - x - y) / ((z - x) * (z - y))),
    ]
}
