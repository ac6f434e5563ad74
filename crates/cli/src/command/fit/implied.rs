//! What fitted parameters imply by the mean-field theory.

use crate::problem::Problem;
use voronudge_infer::{COEFFICIENT_SIZES, Direction, Inference, NORMAL_95};
use voronudge_report::Units;
use voronudge_report::infer_report::{ImpliedByMeanField, Parameter};
use voronudge_theory::{MeanField, Moduli, PhaseDiffusivities};

/// Coefficients are moved by this many standard errors to see what becomes of the moduli, which are linear in them.
const STEP: f64 = 1e-6;

/// Moduli and phase diffusivities of the honeycomb at the estimate, in the units of the data. `None` where K_P is not positive.
///
/// Moduli are linear in the coefficients, so that their variance is that of the principal directions summed up.
pub(crate) fn implied(prepared: &Problem, result: &Inference, units: &Units) -> Option<ImpliedByMeanField> {
    let estimate = &result.parameters;
    let (k_a, k_p) = (estimate.area_elasticity.value, estimate.perimeter_elasticity.value);
    let coefficients =
        [k_a, k_p * estimate.preferred_perimeter.value, k_p, estimate.chiral_coefficient.value];
    let at_estimate = moduli(coefficients)?;
    let moved = |direction: &Direction| {
        let along = STEP / direction.eigenvalue.sqrt();
        moduli(std::array::from_fn(|k| {
            coefficients[k] + along * COEFFICIENT_SIZES[k] * direction.components[k]
        }))
    };
    let along: Option<Vec<Moduli>> = result.directions.iter().map(moved).collect();
    let scale = &prepared.scale;
    let rate = 1.0 / scale.time;
    // With ζ = γ/ℓ₀².
    let spread = rate * scale.length * scale.length;
    let modulus = |of: fn(&Moduli) -> f64, factor: f64, unit: &str, words: &str| {
        let value = of(&at_estimate);
        let error = along.as_ref().map(|along| {
            let squares = along.iter().map(|moved| ((of(moved) - value) / STEP).powi(2));
            squares.sum::<f64>().sqrt()
        });
        // What no direction changes is held.
        let fixed = error.is_some_and(|error| error <= 1e-9 * value.abs());
        Parameter {
            value: value * factor,
            ci95: error.filter(|_| !fixed).map(|error| {
                let reach = (NORMAL_95 * error * factor).abs();
                [value * factor - reach, value * factor + reach]
            }),
            fixed,
            unit: unit.to_owned(),
            words: words.to_owned(),
        }
    };
    let per_time = units.powers(0, -1);
    let diffusivity = units.powers(2, -1);
    Some(ImpliedByMeanField {
        B: modulus(|m| m.bulk, rate, &per_time, "resistance to compression, over the friction of a cell"),
        A: modulus(|m| m.odd_bulk, rate, &per_time, "zero for the honeycomb"),
        mu: modulus(|m| m.shear, rate, &per_time, "resistance to shear; negative in the fluid"),
        K_o: modulus(
            |m| m.odd_shear,
            rate,
            &per_time,
            "shear stress a quarter turn from the shear, −√3 K_P α",
        ),
        D_parallel: modulus(
            |m| PhaseDiffusivities::from_moduli(*m, 1.0).parallel,
            spread,
            &diffusivity,
            "B/ζ with ζ = γ/ℓ₀²",
        ),
        D_perp: modulus(
            |m| PhaseDiffusivities::from_moduli(*m, 1.0).perpendicular,
            spread,
            &diffusivity,
            "μ/ζ",
        ),
        D_parallel_cross: modulus(
            |m| PhaseDiffusivities::from_moduli(*m, 1.0).parallel_cross,
            spread,
            &diffusivity,
            "−A/ζ",
        ),
        D_perp_cross: modulus(
            |m| PhaseDiffusivities::from_moduli(*m, 1.0).perpendicular_cross,
            spread,
            &diffusivity,
            "Kᵒ/ζ",
        ),
    })
}

/// The moduli at coefficients (K_A, K_P P_0, K_P, K_P α) for cells of unit area.
fn moduli([k_a, k_p_p_0, k_p, k_p_alpha]: [f64; 4]) -> Option<Moduli> {
    let parameters = voronudge_theory::Parameters {
        area_elasticity: k_a,
        perimeter_elasticity: k_p,
        preferred_perimeter: k_p_p_0 / k_p,
        chirality: k_p_alpha / k_p,
    };
    Some(MeanField::new(parameters).ok()?.moduli())
}
