//! The figures of a strip with ends.

use super::strip::{Bands, EndedLattice};
use super::strip_page::{parts, side_of};
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, GREEN, GREY, INK, VERMILLION};
use voronudge_report::figure::{
    BandPart, CurveSeries, PointSeries, PointsAndCurves, StripPoint, Stroke, points_and_curves, strip_bands,
    strip_spectrum,
};
use voronudge_report::markers::Marker;
use voronudge_report::numbers::significant;
use voronudge_report::page::Figure;
use voronudge_report::units::{Units, label_with_unit};
use voronudge_spectrum::{Complex64, Strip, StripMode};

/// Modes whose profile is drawn.
const PROFILES: usize = 4;

impl Bands {
    /// What the page shows of the strip.
    pub fn figures(&self, ended: &EndedLattice, units: &Units) -> Vec<Figure> {
        let (strip, unit) = (&ended.strip, units.powers(0, -1));
        let point = |mode: &StripMode| StripPoint {
            value: parts(mode.value),
            side: side_of(mode, strip),
            of_edge: mode.is_of_edge(strip.places().len()),
        };
        let points = |modes: &[StripMode]| modes.iter().map(point).collect::<Vec<_>>();
        let flat = |values: &Vec<[Complex64; 2]>| values.iter().flatten().copied().map(parts).collect();
        let all: Vec<Vec<StripPoint>> = self.modes.iter().map(|modes| points(modes)).collect();
        let periodic: Vec<Vec<[f64; 2]>> = self.periodic.iter().map(flat).collect();
        let bands = |part| strip_bands(&self.wave_numbers, &all, &periodic, part, units);
        vec![
            Figure::new(
                strip_spectrum(&points(&self.shown), &self.loops, &self.winding, &unit),
                "The values at the wave number that is shown. Lines: of the periodic tissue, while the wave number across the rows goes once around its \
                 zone. Where they enclose an area (shaded by the sign of the winding number), the modes of the strip with ends pile up at one of \
                 these: the non-Hermitian skin effect.",
            ),
            Figure::new(
                profiles(&self.localised(strip), strip.places(), units),
                "|u|² of each row, of the modes that grow fastest across the strip. Dashed: the growth of the generalised Brillouin zone.",
            ),
            Figure::new(
                growth_found(&self.growth(strip), units),
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

    /// Growth across the strip (1/length) of the modes that are shown: expected, and found.
    fn growth(&self, strip: &Strip) -> Vec<[f64; 2]> {
        let both = |mode: &StripMode| {
            let expected = mode.expected_growth(strip.places().len())? / strip.spacing();
            Some([expected, mode.localisation.growth])
        };
        self.shown.iter().filter_map(both).collect()
    }

    /// The modes that are most localised, half of them at each side, with |u|² of each row and the growth that is expected of them.
    fn localised(&self, strip: &Strip) -> Vec<(String, Vec<f64>, f64)> {
        let mut order: Vec<&StripMode> = self.shown.iter().collect();
        order.sort_by(|a, b| b.localisation.growth.abs().total_cmp(&a.localisation.growth.abs()));
        let on = |right: bool| {
            order.iter().filter(move |mode| (mode.localisation.growth > 0.0) == right).take(PROFILES / 2)
        };
        on(false)
            .chain(on(true))
            .map(|mode| {
                let expected = mode.expected_growth(strip.places().len()).unwrap_or(f64::NAN);
                let [re, im] = parts(mode.value);
                let sign = if im < 0.0 { '−' } else { '+' };
                let name = format!("λ = {} {sign} {} i", significant(re, 3), significant(im.abs(), 3));
                (name, mode.profile.clone(), expected / strip.spacing())
            })
            .collect()
    }
}

fn profiles(modes: &[(String, Vec<f64>, f64)], places: &[f64], units: &Units) -> String {
    let colours = [BLUE, GREEN, VERMILLION, INK];
    let mut series = Vec::new();
    let mut curves = Vec::new();
    for ((name, profile, growth), colour) in modes.iter().zip(colours) {
        let points = places.iter().zip(profile).map(|(&x, &y)| [x, y].into()).collect();
        series.push(PointSeries { label: name, colour, marker: Marker::Circle, points });
        // Through the middle of the profile, by its logarithm.
        let count = places.len().max(1) as f64;
        let middle = places.iter().sum::<f64>() / count;
        let mean = profile.iter().map(|y| y.ln()).sum::<f64>() / count;
        let line = places.iter().map(|&x| [x, (mean + 2.0 * growth * (x - middle)).exp()]);
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

fn growth_found(growth: &[[f64; 2]], units: &Units) -> String {
    let unit = units.powers(-1, 0);
    let ends = growth.iter().flatten().fold([0.0_f64; 2], |[low, high], &x| [low.min(x), high.max(x)]);
    points_and_curves(&PointsAndCurves {
        title: "growth across the strip",
        labels: [&label_with_unit("expected growth", &unit), &label_with_unit("growth found", &unit)],
        scales: [AxisScale::Linear; 2],
        series: &[PointSeries {
            label: "modes of the strip",
            colour: BLUE,
            marker: Marker::Circle,
            points: growth.iter().map(|&at| at.into()).collect(),
        }],
        curves: &[CurveSeries {
            label: "equal",
            colour: GREY,
            stroke: Stroke::Solid,
            points: ends.iter().map(|&x| [x, x]).collect(),
        }],
    })
}
