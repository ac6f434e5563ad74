//! Odd viscoelastic media: elasticity and viscosity in parallel and in series.
//!
//! Everything here acts on the two shears `(e_1, e_2)` of an isotropic plane medium as `[[even, odd], [−odd, even]]`. Such matrices commute, so a medium
//! is two numbers, even and odd, and `G*(ω) = μ* , Kᵒ*` is one.

/// An even and an odd number, `μ` and `Kᵒ` or `η` and `ηᵒ`, which act on the two shears as `[[even, odd], [−odd, even]]`.
pub type EvenOdd = [f64; 2];

/// The answer to an oscillating shear of one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearResponse {
    /// The angular frequency ω.
    pub frequency: f64,
    /// Storage moduli `μ′, Kᵒ′`.
    pub storage: EvenOdd,
    /// Loss moduli `μ″, Kᵒ″`.
    pub loss: EvenOdd,
}

/// How elasticity and viscosity are put together (paper, "Chiral active viscoelasticity").
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrangement {
    /// In parallel: `G* = κ + iωη`, a solid whose strain lags behind.
    KelvinVoigt,
    /// In series: `iω/G* = η⁻¹ + iω κ⁻¹`, a liquid that is elastic for short times.
    Maxwell,
}

/// A medium of one elasticity and one viscosity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViscoelasticMedium {
    /// How they are put together.
    pub arrangement: Arrangement,
    /// Elasticity κ: shear modulus and odd shear modulus.
    pub elasticity: EvenOdd,
    /// Viscosity η: shear viscosity and odd shear viscosity.
    pub viscosity: EvenOdd,
}

impl ViscoelasticMedium {
    /// The medium nearest to some responses, by least squares in parts of the size of each (of `G*` in parallel, of `iω/G*` in series, where both are
    /// linear in what is looked for). `None` without responses, or where one vanishes.
    ///
    /// ```
    /// use voronudge_theory::{Arrangement, ViscoelasticMedium};
    /// let medium = ViscoelasticMedium { arrangement: Arrangement::Maxwell, elasticity: [1.0, -0.3], viscosity: [2.0, 0.5] };
    /// let responses = [0.1, 1.0, 10.0].map(|frequency| medium.response(frequency));
    /// let found = ViscoelasticMedium::fitted(Arrangement::Maxwell, &responses).unwrap();
    /// assert!((found.viscosity[1] - 0.5).abs() < 1e-12 && found.missed(&responses) < 1e-12);
    /// ```
    pub fn fitted(arrangement: Arrangement, responses: &[ShearResponse]) -> Option<Self> {
        let mut sums = [[0.0; 2]; 2];
        let mut weights = [0.0; 2];
        for response in responses {
            let (constant, linear) = arrangement.coefficients(response)?;
            let size: f64 = constant.iter().chain(&linear).map(|x| x * x).sum();
            let weight = 1.0 / size;
            if !weight.is_finite() {
                return None;
            }
            let frequency = response.frequency;
            weights[0] += weight;
            weights[1] += weight * frequency * frequency;
            for k in 0..2 {
                sums[0][k] += weight * constant[k];
                sums[1][k] += weight * frequency * linear[k];
            }
        }
        if weights[0] == 0.0 {
            return None;
        }
        let [constant, slope] = [0, 1].map(|row: usize| sums[row].map(|sum: f64| sum / weights[row]));
        let (elasticity, viscosity) = match arrangement {
            Arrangement::KelvinVoigt => (constant, slope),
            Arrangement::Maxwell => (inverse(slope)?, inverse(constant)?),
        };
        Some(Self { arrangement, elasticity, viscosity })
    }

    /// What the medium answers.
    pub fn response(&self, frequency: f64) -> ShearResponse {
        match self.arrangement {
            Arrangement::KelvinVoigt => {
                let loss = self.viscosity.map(|eta| frequency * eta);
                ShearResponse { frequency, storage: self.elasticity, loss }
            }
            Arrangement::Maxwell => {
                let [constant, slope] =
                    [self.viscosity, self.elasticity].map(|own| inverse(own).unwrap_or([f64::INFINITY; 2]));
                let (storage, loss) = turned(frequency, (constant, slope.map(|x| frequency * x)));
                ShearResponse { frequency, storage, loss }
            }
        }
    }

    /// By how much the medium misses some responses: root mean square, each in parts of its size.
    pub fn missed(&self, responses: &[ShearResponse]) -> f64 {
        let square = |of: &ShearResponse| of.storage.iter().chain(&of.loss).map(|x| x * x).sum::<f64>();
        let each = responses.iter().map(|response| {
            let own = self.response(response.frequency);
            let apart = |a: EvenOdd, b: EvenOdd| [a[0] - b[0], a[1] - b[1]];
            let difference = ShearResponse {
                storage: apart(own.storage, response.storage),
                loss: apart(own.loss, response.loss),
                ..own
            };
            square(&difference) / square(response)
        });
        (each.sum::<f64>() / responses.len().max(1) as f64).sqrt()
    }
}

impl Arrangement {
    /// What is constant and what is proportional to the frequency in this arrangement: `G*`, or `iω/G*`.
    fn coefficients(self, response: &ShearResponse) -> Option<(EvenOdd, EvenOdd)> {
        match self {
            Self::KelvinVoigt => Some((response.storage, response.loss)),
            Self::Maxwell => {
                let found = turned(response.frequency, (response.storage, response.loss));
                found.0.iter().chain(&found.1).all(|x| x.is_finite()).then_some(found)
            }
        }
    }
}

/// `iω/(a + ib)` for even-and-odd `a` and `b`: real and imaginary part.
fn turned(frequency: f64, (a, b): (EvenOdd, EvenOdd)) -> (EvenOdd, EvenOdd) {
    // Even and odd come apart as z± = even ± i odd, two ordinary complex numbers.
    let [plus, minus] = [1.0, -1.0].map(|sign: f64| {
        let (real, imaginary) = (a[0] - sign * b[1], b[0] + sign * a[1]);
        let size = real * real + imaginary * imaginary;
        // iω (real − i imaginary)/|z|²
        [frequency * imaginary / size, frequency * real / size]
    });
    // z± = (A₀ + i B₀) ± i (A₁ + i B₁)
    let real = [0.5 * (plus[0] + minus[0]), 0.5 * (plus[1] - minus[1])];
    let imaginary = [0.5 * (plus[1] + minus[1]), -0.5 * (plus[0] - minus[0])];
    (real, imaginary)
}

/// The inverse of `[[even, odd], [−odd, even]]`; `None` of zero.
fn inverse([even, odd]: EvenOdd) -> Option<EvenOdd> {
    let size = even * even + odd * odd;
    (size > 0.0).then(|| [even / size, -odd / size])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `iω/(a + ib)` by 2 × 2 matrices: `(a + ib) c = iω`.
    #[test]
    fn the_compliance_is_the_inverse() {
        let (a, b, frequency) = ([1.3, -0.4], [0.2, 0.9], 1.7);
        let (c, d) = turned(frequency, (a, b));
        let product = |[p, q]: EvenOdd, [r, s]: EvenOdd| [p * r - q * s, p * s + q * r];
        let (ac, bd, ad, bc) = (product(a, c), product(b, d), product(a, d), product(b, c));
        for k in 0..2 {
            assert!((ac[k] - bd[k]).abs() < 1e-14);
            assert!((ad[k] + bc[k] - if k == 0 { frequency } else { 0.0 }).abs() < 1e-14);
        }
    }

    #[test]
    fn each_medium_is_found_and_the_other_does_not_fit() {
        for arrangement in [Arrangement::KelvinVoigt, Arrangement::Maxwell] {
            let medium = ViscoelasticMedium { arrangement, elasticity: [0.8, -0.5], viscosity: [1.5, 0.2] };
            let responses = [0.03, 0.3, 3.0, 30.0].map(|frequency| medium.response(frequency));
            let found = ViscoelasticMedium::fitted(arrangement, &responses).unwrap();
            assert!(found.missed(&responses) < 1e-12, "{found:?}");
            let other = match arrangement {
                Arrangement::KelvinVoigt => Arrangement::Maxwell,
                Arrangement::Maxwell => Arrangement::KelvinVoigt,
            };
            let poor = ViscoelasticMedium::fitted(other, &responses).unwrap();
            assert!(poor.missed(&responses) > 0.1, "{poor:?}");
        }
    }

    /// In series an even medium flows when it is slow, `G″ = ωη`, and is elastic when it is fast.
    #[test]
    fn limits_of_a_maxwell_medium() {
        let medium = ViscoelasticMedium {
            arrangement: Arrangement::Maxwell,
            elasticity: [2.0, 0.0],
            viscosity: [3.0, 0.0],
        };
        let (slow, fast) = (medium.response(1e-6), medium.response(1e6));
        assert!((slow.loss[0] / 1e-6 - 3.0).abs() < 1e-6 && slow.storage[0] < 1e-9);
        assert!((fast.storage[0] - 2.0).abs() < 1e-9 && fast.loss[0] < 1e-5);
    }

    #[test]
    fn nothing_is_fitted_to_nothing() {
        assert_eq!(ViscoelasticMedium::fitted(Arrangement::Maxwell, &[]), None);
        let still = ShearResponse { frequency: 1.0, storage: [0.0; 2], loss: [0.0; 2] };
        assert_eq!(ViscoelasticMedium::fitted(Arrangement::KelvinVoigt, &[still]), None);
    }
}
