//! One module per figure; each returns a stand-alone SVG as text. Charts carry the numbers that they show, as CSV in their `<metadata>`.
//!
//! Figures never fail: numbers that are not finite are skipped, and where nothing is left to draw
//! the figure says "no data".

mod among_simulated;
mod bootstrap_histogram;
mod cell_map;
mod collapse;
mod complex_spectrum;
mod component_scatter;
mod configuration_map;
mod correlation_function;
mod defects;
mod density_of_states;
mod dispersion;
mod distribution;
mod effect_ranking;
mod error_bars;
mod extrema_map;
mod flow_map;
mod growth_matrix;
mod landscape;
mod method_comparison;
mod mode_map;
mod moduli;
mod noise_budget;
mod nudge_histogram;
mod nudge_map;
mod objective_trace;
mod outlier_map;
mod outline_map;
mod parameter_intervals;
mod partial_regression;
mod phase_map;
mod points_and_curves;
mod predicted_against_measured;
mod profile;
mod residual_maps;
mod shape_scatter;
mod strip;
mod trails;
mod velocity_map;

pub use among_simulated::{SimulatedBand, among_simulated};
pub use bootstrap_histogram::{BootstrapHistogram, bootstrap_histogram};
pub use cell_map::{CellScalar, cell_map};
pub use collapse::{CollapseRow, collapse};
pub use complex_spectrum::{SpectrumPoint, complex_spectrum};
pub use configuration_map::configuration_map;
pub use correlation_function::{Correlation, CorrelationFunction, CorrelationPoint, correlation_function};
pub use defects::{AroundDefects, DefectMark, around_defects, defect_map};
pub use density_of_states::density_of_states;
pub use dispersion::{DispersionPart, DispersionPoint, dispersion};
pub use distribution::{Landmark, distribution};
pub use effect_ranking::effect_ranking;
pub use error_bars::{Emphasis, ErrorBar, error_bars, error_bars_with_floor};
pub use extrema_map::{ExtremaMap, extrema_map};
pub use flow_map::{FlowMap, flow_map};
pub use growth_matrix::{GrowthCurve, GrowthPoint, growth_matrix};
pub use landscape::{Landscape, LandscapeAxis, landscape};
pub use method_comparison::{MethodComparison, MethodSeries, method_comparison};
pub use mode_map::{DrawnMode, mode_map};
pub use moduli::moduli;
pub use noise_budget::noise_budget;
pub use nudge_histogram::{NudgeHistogram, nudge_histogram};
pub use nudge_map::nudge_map;
pub use objective_trace::{ObjectiveTrace, objective_trace};
pub use outlier_map::{Outlier, Suspicion, outlier_map};
pub use outline_map::outline_map;
pub use parameter_intervals::{Estimate, ParameterRow, parameter_intervals};
pub use partial_regression::{PartialPoint, PartialRegression, partial_regression};
pub use phase_map::{LineStyle, MapLine, PhaseMap, phase_map, row_colours};
pub use points_and_curves::{CurveSeries, PointSeries, PointsAndCurves, Stroke, points_and_curves};
pub use predicted_against_measured::{Prediction, VelocityPair, predicted_against_measured};
pub use profile::{ProfileCurve, profile};
pub use residual_maps::{residual_flow_maps, residual_maps};
pub use shape_scatter::{ShapeMeasure, shape_scatter};
pub use strip::{BandPart, StripPoint, StripSide, WindingGrid, strip_bands, strip_spectrum};
pub use trails::{Trails, trails};
pub use velocity_map::{VelocityField, polarity_map, velocity_map};

pub use crate::series::ErrorPoint;

use crate::svg::{Anchor, Svg, TextStyle};

/// The figure that stands in where there is nothing to draw.
#[must_use]
pub fn no_data(title: &str) -> String {
    let mut svg = Svg::new([440.0, 120.0], title);
    svg.raw("<rect x=\".5\" y=\".5\" width=\"439\" height=\"119\" fill=\"#fafafa\" stroke=\"#ccc\"/>\n");
    let style = TextStyle::quiet(Anchor::Middle);
    svg.text([220.0, 56.0], title, style);
    svg.text([220.0, 76.0], "no data", style);
    svg.finish()
}
