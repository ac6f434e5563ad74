//! Quantities in the units of the data, as they are printed.

use voronudge_infer::Quantity;
use voronudge_report::Units;

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
