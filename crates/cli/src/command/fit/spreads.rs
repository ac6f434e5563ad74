//! What single cells have of their own, as arrays and figures.

use crate::failure::Failure;
use crate::problem::Problem;
use voronudge_geometry::Vector;
use voronudge_infer::{Inference, Spread};
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_model::CellParameter;
use voronudge_report::SpreadView;

/// The deviations of the cells of the frames drawn whose velocities are explained, in parameters in which they are not estimated to be alike.
pub(crate) fn views(prepared: &Problem, result: &Inference, drawn: &[usize]) -> Vec<SpreadView> {
    // Of other cells nothing is known but the mean.
    let of_frame = |spread: &Spread, index: usize| {
        let mut own = vec![f64::NAN; spread.deviations[index].len()];
        let explained = prepared.observations[index].targets();
        explained.for_each(|(cell, _)| own[cell] = spread.deviations[index][cell][0]);
        own
    };
    let view = |spread: &Spread| SpreadView {
        symbol: symbol(spread.parameter).into(),
        drawn: drawn.iter().map(|index| of_frame(spread, *index)).collect(),
    };
    result.spreads.iter().filter(|spread| spread.value > 0.0).map(view).collect()
}

/// Writes deviations and their standard errors, under names that begin with a prefix.
pub(crate) fn write(
    out: &mut OutputDirectory,
    prefix: &str,
    data: &DataSet,
    prepared: &Problem,
    result: &Inference,
) -> Result<(), Failure> {
    for spread in &result.spreads {
        for (which, name) in ["deviation", "deviation_error"].into_iter().enumerate() {
            let of_frame = |(index, own): (usize, &Vec<[f64; 2]>)| {
                let own = own.iter().map(|own| Vector::new(own[which], 0.0)).collect();
                prepared.of_detections(index, own).iter().map(|own| own.x).collect::<Vec<f64>>()
            };
            let all: Vec<Vec<f64>> = spread.deviations.iter().enumerate().map(of_frame).collect();
            let frames =
                prepared.snapshots.iter().zip(&all).map(|(snapshot, own)| (snapshot, own.as_slice()));
            out.write_array(
                &format!("{prefix}{name}_{}.npy", spread.parameter.name()),
                data.scalars_as_given(frames).view(),
            )?;
        }
    }
    Ok(())
}

/// The symbol of a parameter.
pub(crate) fn symbol(parameter: CellParameter) -> &'static str {
    match parameter {
        CellParameter::AreaElasticity => "K_A",
        CellParameter::PreferredPerimeter => "P_0",
        CellParameter::PreferredArea => "A_0",
        CellParameter::Chirality => "α",
    }
}
