//! The figures of a strip with ends.

use super::Figure;
use crate::chart::AxisScale;
use crate::colour::{BLUE, GREEN, GREY, INK, VERMILLION};
use crate::figure::{
    BandPart, CurveSeries, PointSeries, PointsAndCurves, StripPoint, Stroke, WindingGrid, points_and_curves,
    strip_bands, strip_spectrum,
};
use crate::markers::Marker;
use crate::units::{Units, label_with_unit};

/// What is drawn of a strip.
#[derive(Debug, Clone, PartialEq)]
pub struct StripFigures {
    /// The modes at the wave number that is shown.
    pub shown: Vec<StripPoint>,
    /// The values of the periodic tissue there, as lines.
    pub loops: Vec<Vec<[f64; 2]>>,
    /// How often they wind.
    pub winding: WindingGrid,
    /// All wave numbers.
    pub wave_numbers: Vec<f64>,
    /// The modes at each.
    pub bands: Vec<Vec<StripPoint>>,
    /// Values of the periodic tissue at each.
    pub periodic: Vec<Vec<[f64; 2]>>,
    /// Of the modes that are shown, the growth across the strip that is expected, and that found (1/length).
    pub growth: Vec<[f64; 2]>,
    /// Places of the rows.
    pub places: Vec<f64>,
    /// Name, |u|² of each row, and expected growth (1/length) of modes that are localised most.
    pub profiles: Vec<(String, Vec<f64>, f64)>,
}

impl StripFigures {
    pub(super) fn figures(&self, units: &Units) -> Vec<Figure> {
        let unit = units.powers(0, -1);
        let bands = |part| strip_bands(&self.wave_numbers, &self.bands, &self.periodic, part, units);
        vec![
            Figure::new(
                strip_spectrum(&self.shown, &self.loops, &self.winding, &unit),
                "The values at the wave number that is shown. Lines: of the periodic tissue, while the wave number across the rows goes once around its \
                 zone. Where they enclose an area (shaded by the sign of the winding number), the modes of the strip with ends pile up at one of \
                 these: the non-Hermitian skin effect.",
            ),
            Figure::new(
                self.profiles(units),
                "|u|² of each row, of the modes that grow fastest across the strip. Dashed: the growth of the generalised Brillouin zone.",
            ),
            Figure::new(
                self.growth_found(units),
                "Growth of |u| across the strip of each mode, by a straight line through ln |u|², against what the generalised Brillouin zone of the \
                 periodic tissue expects (for modes of an edge, the wave that decays slowest from it).",
            ),
            Figure::new(
                bands(BandPart::Frequency),
                "Frequencies at each wave number along the rows, over those of the periodic tissue at all wave numbers across.",
            ),
            Figure::new(
                bands(BandPart::Rate),
                "Rates of growth likewise, of modes whose frequency is not negative; those with the opposite frequency have the same, at the other end.",
            ),
        ]
    }

    fn profiles(&self, units: &Units) -> String {
        let colours = [BLUE, GREEN, VERMILLION, INK];
        let mut series = Vec::new();
        let mut curves = Vec::new();
        for ((name, profile, growth), colour) in self.profiles.iter().zip(colours) {
            let points = self.places.iter().zip(profile).map(|(&x, &y)| [x, y].into()).collect();
            series.push(PointSeries { label: name, colour, marker: Marker::Circle, points });
            // Through the middle of the profile, by its logarithm.
            let count = self.places.len().max(1) as f64;
            let middle = self.places.iter().sum::<f64>() / count;
            let mean = profile.iter().map(|y| y.ln()).sum::<f64>() / count;
            let line = self.places.iter().map(|&x| [x, (mean + 2.0 * growth * (x - middle)).exp()]);
            curves.push(CurveSeries { label: "", colour, stroke: Stroke::Dashed, points: line.collect() });
        }
        points_and_curves(&PointsAndCurves {
            title: "profiles across the strip",
            labels: [&label_with_unit("place across the strip", &units.length), "|u|² of a row"],
            scales: [AxisScale::Linear, AxisScale::Logarithmic],
            series: &series,
            curves: &curves,
        })
    }

    fn growth_found(&self, units: &Units) -> String {
        let unit = units.powers(-1, 0);
        let ends =
            self.growth.iter().flatten().fold([0.0_f64; 2], |[low, high], &x| [low.min(x), high.max(x)]);
        points_and_curves(&PointsAndCurves {
            title: "growth across the strip",
            labels: [&label_with_unit("expected growth", &unit), &label_with_unit("growth found", &unit)],
            scales: [AxisScale::Linear; 2],
            series: &[PointSeries {
                label: "modes of the strip",
                colour: BLUE,
                marker: Marker::Circle,
                points: self.growth.iter().map(|&at| at.into()).collect(),
            }],
            curves: &[CurveSeries {
                label: "equal",
                colour: GREY,
                stroke: Stroke::Solid,
                points: ends.iter().map(|&x| [x, x]).collect(),
            }],
        })
    }
}
