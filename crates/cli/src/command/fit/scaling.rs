//! Between the units of the data and those of the fit, in which ℓ₀ and the root mean square velocity are one.

use voronudge_infer::{Constraints, Prior, Quantity, Scale};
use voronudge_report::Units;

/// A quantity in the units of the data, per unit of the fit.
pub(crate) fn factor(scale: &Scale, quantity: Quantity) -> f64 {
    let coefficients = scale.coefficients();
    match quantity {
        Quantity::AreaElasticity => coefficients[0],
        Quantity::PerimeterElasticity => coefficients[2],
        Quantity::PreferredPerimeter => scale.length,
        Quantity::Chirality => 1.0,
        Quantity::ChiralCoefficient => coefficients[3],
    }
}

/// The unit of a quantity in the data, as it is printed.
pub(crate) fn unit(quantity: Quantity, units: &Units) -> String {
    match quantity {
        Quantity::AreaElasticity => units.powers(-2, -1),
        Quantity::PerimeterElasticity | Quantity::ChiralCoefficient => units.powers(0, -1),
        Quantity::PreferredPerimeter => units.powers(1, 0),
        Quantity::Chirality => units.powers(0, 0),
    }
}

/// A quantity as it is printed.
pub(crate) fn symbol(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Chirality => "α",
        Quantity::ChiralCoefficient => "K_P α",
        other => other.name(),
    }
}

/// What is known of the parameters in the units of the data, in those of the fit.
pub(crate) fn scaled(constraints: &Constraints, scale: &Scale) -> Constraints {
    let unit = |quantity: &Quantity| factor(scale, *quantity);
    Constraints {
        fixed: constraints.fixed.iter().map(|(q, value)| (*q, value / unit(q))).collect(),
        bounds: constraints.bounds.iter().map(|(q, ends)| (*q, ends.map(|end| end / unit(q)))).collect(),
        priors: constraints
            .priors
            .iter()
            .map(|(q, prior)| {
                let standard_deviation = prior.standard_deviation / unit(q);
                (*q, Prior { mean: prior.mean / unit(q), standard_deviation })
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constraints_are_scaled_like_the_quantities_they_hold() {
        let scale = Scale { length: 10.0, time: 4.0 };
        let given = Constraints {
            fixed: [(Quantity::PreferredPerimeter, 38.0), (Quantity::Chirality, 2.0)].into(),
            bounds: [(Quantity::AreaElasticity, [0.0, f64::INFINITY])].into(),
            priors: [(Quantity::ChiralCoefficient, Prior { mean: 0.5, standard_deviation: 0.25 })].into(),
        };
        let fit = scaled(&given, &scale);
        assert!((fit.fixed[&Quantity::PreferredPerimeter] - 3.8).abs() < 1e-12);
        assert_eq!(fit.fixed[&Quantity::Chirality], 2.0);
        assert_eq!(fit.bounds[&Quantity::AreaElasticity], [0.0, f64::INFINITY]);
        let prior = fit.priors[&Quantity::ChiralCoefficient];
        assert!((prior.mean - 2.0).abs() < 1e-12 && (prior.standard_deviation - 1.0).abs() < 1e-12);
        // K_A per area and time.
        assert!((factor(&scale, Quantity::AreaElasticity) - 1.0 / 400.0).abs() < 1e-15);
    }
}
