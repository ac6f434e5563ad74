//! Measured functions as figures.

use voronudge_observables::{Curve, Quantity};
use voronudge_report::Units;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, GREY};
use voronudge_report::figure::{
    CurveSeries, ErrorPoint, PointSeries, PointsAndCurves, Stroke, points_and_curves,
};
use voronudge_report::markers::Marker;
use voronudge_report::page::Figure;
use voronudge_report::units::label_with_unit;

/// A function with bars of one standard error.
pub(super) fn figure(curve: &Curve, units: &Units) -> Option<Figure> {
    let (axis, of_axis) = curve.of.axis()?;
    let label = label_with_unit(axis, &units.powers(of_axis.length, of_axis.time));
    let dimensions = curve.of.dimensions();
    let value = label_with_unit(symbol(curve.of), &units.powers(dimensions.length, dimensions.time));
    let scale = match curve.of {
        Quantity::MeanSquareDisplacement => [AxisScale::Logarithmic; 2],
        Quantity::Vortices | Quantity::Compression => [AxisScale::Linear, AxisScale::Logarithmic],
        _ => [AxisScale::Linear; 2],
    };
    let finite = |error: &f64| Some(*error).filter(|error| error.is_finite());
    let points: Vec<ErrorPoint> = (0..curve.at.len())
        .filter(|k| curve.value[*k].is_finite())
        .map(|k| ErrorPoint {
            at: [curve.at[k], curve.value[k]],
            error: [None, finite(&curve.standard_error[k])],
        })
        .collect();
    let line: Vec<[f64; 2]> = points.iter().map(|point| point.at).collect();
    let mut lines = Vec::new();
    if curve.of == Quantity::MeanSquareDisplacement
        && let (Some(first), Some(last)) = (line.first(), line.last())
    {
        let points = vec![[first[0], last[1] * first[0] / last[0]], *last];
        lines.push(CurveSeries {
            label: "in proportion to time",
            colour: GREY,
            stroke: Stroke::Dashed,
            points,
        });
    }
    lines.push(CurveSeries { label: "", colour: BLUE, stroke: Stroke::Solid, points: line });
    let series = [PointSeries { label: "", colour: BLUE, marker: Marker::Circle, points }];
    let svg = points_and_curves(&PointsAndCurves {
        title: curve.of.words(),
        labels: [&label, &value],
        scales: scale,
        series: &series,
        curves: &lines,
    });
    Some(Figure::new(svg, caption(curve.of)))
}

fn symbol(of: Quantity) -> &'static str {
    match of {
        Quantity::MeanSquareDisplacement => "MSD",
        Quantity::VelocityAutocorrelation => "⟨v(t)·v(t + τ)⟩/⟨v²⟩",
        Quantity::VelocityCorrelation => "⟨v_i·v_j⟩/⟨v²⟩",
        Quantity::ContactSurvival => "share that are contacts",
        Quantity::ExchangeWaiting => "share of cells",
        Quantity::ExchangeCorrelation => "density over the mean",
        Quantity::ShapeIndex | Quantity::Area | Quantity::ExchangeDirection => "density of the distribution",
        Quantity::Neighbours => "share of cells",
        Quantity::HexaticCorrelation => "⟨ψ_i* ψ_j⟩",
        Quantity::NematicCorrelation => "⟨Q_i : Q_j⟩/⟨Q²⟩",
        Quantity::SwirlAroundPlus | Quantity::SwirlAroundMinus => "anticlockwise velocity",
        Quantity::PairCorrelation => "g(r)",
        Quantity::Density => "S(q) of density",
        Quantity::Compression | Quantity::Vortices => "S(q) of velocity",
        _ => "",
    }
}

fn caption(of: Quantity) -> &'static str {
    match of {
        Quantity::MeanSquareDisplacement => {
            "Mean square displacement against the time between two frames. Large lags rest on few pairs of frames."
        }
        Quantity::VelocityAutocorrelation => "How long cells remember their velocity.",
        Quantity::VelocityCorrelation => "How alike the velocities of two cells are, by their distance.",
        Quantity::ContactSurvival => "Share of the contacts of a frame that are contacts in a later one.",
        Quantity::ExchangeWaiting => {
            "Share of the cells that have not changed neighbours for a lag. Transitions that come at random, each of four cells, leave exp(−4 × rate of T1 × lag)."
        }
        Quantity::ExchangeCorrelation => {
            "T1 transitions at a distance from another one between the same frames, over as many as if they knew nothing of each other. Peaks at the distances of neighbours are those of the cells; above 1 beyond them, transitions set off each other."
        }
        Quantity::ExchangeDirection => {
            "Directions of the contacts that are made in T1 transitions; where no direction is preferred the density is 1/π."
        }
        Quantity::ShapeIndex => {
            "Distribution of the shape index P/√A: 3.72 for a regular hexagon, more for longer cells."
        }
        Quantity::Area => "Distribution of the areas.",
        Quantity::Neighbours => "How many neighbours cells have.",
        Quantity::HexaticCorrelation => {
            "How alike the orientations of the neighbourhoods of two cells are, by their distance."
        }
        Quantity::NematicCorrelation => "How alike the shapes of two cells are, by their distance.",
        Quantity::SwirlAroundPlus => {
            "Anticlockwise velocity around +½ defects, by distance. Without chirality there is none."
        }
        Quantity::SwirlAroundMinus => {
            "Anticlockwise velocity around −½ defects, by distance. Without chirality there is none."
        }
        Quantity::PairCorrelation => "Density of cells at a distance from a cell, over the mean density.",
        Quantity::Density => "Structure factor of the density. Random places have 1.",
        Quantity::Compression => "Structure factor of the velocity along the wave vector: compression.",
        Quantity::Vortices => "Structure factor of the velocity across the wave vector: vortices.",
        _ => "",
    }
}
