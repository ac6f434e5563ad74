//! Quantities in the units of the data, as they are printed.

use voronudge_infer::FitParameter;
use voronudge_report::Units;

/// The unit of a quantity in the data, as it is printed.
pub(crate) fn unit(quantity: FitParameter, units: &Units) -> String {
    match quantity {
        FitParameter::AreaElasticity => units.powers(-2, -1),
        FitParameter::PerimeterElasticity | FitParameter::ChiralCoefficient => units.powers(0, -1),
        FitParameter::PreferredPerimeter => units.powers(1, 0),
        FitParameter::Chirality => units.powers(0, 0),
    }
}

/// A quantity as it is printed.
pub(crate) fn symbol(quantity: FitParameter) -> &'static str {
    match quantity {
        FitParameter::Chirality => "α",
        FitParameter::ChiralCoefficient => "K_P α",
        other => other.name(),
    }
}
