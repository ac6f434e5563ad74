//! The line through (v_x, v_y) and the chirality that it implies.

use crate::failure::Failure;
use voronudge_infer::{Intercept, LinePoint, straight_line};
use voronudge_report::channel_report::SlopeRecord;
use voronudge_theory::{MeanField, Parameters};

/// The ratio v_y/v_x of a chirality of one, by the paper's rule of thumb.
const RULE_OF_THUMB: f64 = 0.5;
/// Preferred perimeters in cell sizes for which the paper gives the range of the ratio.
const SHAPE_INDICES: [f64; 2] = [3.0, 5.0];

/// What is known of the tissue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tissue {
    /// P₀/ℓ₀
    pub shape_index: Option<f64>,
    /// K_A ℓ₀²/K_P
    pub area_elasticity: f64,
}

/// Fits the line to points at distances from the edge within a range; `None` if they tell no slope.
pub(crate) fn slope(
    points: &[(f64, LinePoint)],
    range: [Option<f64>; 2],
    intercept: Intercept,
    tissue: Tissue,
) -> Result<Option<SlopeRecord>, Failure> {
    let inside = |x: f64| range[0].is_none_or(|from| x >= from) && range[1].is_none_or(|to| x <= to);
    let chosen: Vec<LinePoint> = points.iter().filter(|(x, _)| inside(*x)).map(|(_, point)| *point).collect();
    let Some(line) = straight_line(&chosen, intercept) else {
        return Ok(None);
    };
    let [low, high] = line.slope_interval;
    // Signed sizes grow with the slope, since the ratio of a chirality of one is positive.
    let chirality = |index: f64, slope: f64| of_slope(index, tissue.area_elasticity, slope);
    let alpha = tissue.shape_index.map(|index| chirality(index, line.slope)).transpose()?;
    let alpha_ci95 = tissue
        .shape_index
        .map(|index| Ok::<_, Failure>([chirality(index, low)?, chirality(index, high)?]))
        .transpose()?;
    let [a, b] = SHAPE_INDICES.map(|index| chirality(index, line.slope));
    let (a, b) = (a?, b?);
    Ok(Some(SlopeRecord {
        points: chosen.len(),
        range,
        slope: line.slope,
        slope_ci95: line.slope_interval,
        intercept: line.intercept,
        reduced_chi_square: line.reduced_chi_square,
        shape_index: tissue.shape_index,
        alpha,
        alpha_ci95,
        alpha_rule_of_thumb: line.slope / RULE_OF_THUMB,
        alpha_range: [a.min(b), a.max(b)],
    }))
}

fn of_slope(shape_index: f64, area_elasticity: f64, slope: f64) -> Result<f64, Failure> {
    let parameters =
        Parameters { area_elasticity, preferred_perimeter: shape_index, ..Parameters::default() };
    let theory = MeanField::new(parameters).map_err(|error| Failure::new(error.to_string()))?;
    theory.chirality_of_flow(slope).ok_or_else(|| {
        Failure::new(format!("at P_0/l_0 = {shape_index} the mean-field tissue does not resist compression"))
            .with_hint("give --shape-index below 11; 3 to 5 is usual")
    })
}
