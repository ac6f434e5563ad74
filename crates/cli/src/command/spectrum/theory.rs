//! The mean-field theory of the honeycomb at the parameters of a model.

use voronudge_model::Parameters;
use voronudge_theory::MeanField;

/// The theory at these parameters for cells of a size, if it has any.
pub(crate) fn mean_field(parameters: &Parameters<f64>, length: f64) -> Option<MeanField> {
    MeanField::new(voronudge_theory::Parameters {
        area_elasticity: parameters.area_elasticity * length * length,
        perimeter_elasticity: parameters.perimeter_elasticity,
        preferred_perimeter: parameters.preferred_perimeter / length,
        chirality: parameters.chirality,
    })
    .ok()
}
