//! The frame of a chart: axes with ticks and a grid. Marks are added on top in the same coordinates.

use crate::colour::INK;
use crate::numbers::{Ticks, as_given, superscript, ticks};
use crate::series::{ErrorPoint, SeriesTable};
use crate::svg::{Anchor, PathData, Svg, TextStyle};

/// Room above and to the right of the plotting area.
const MARGINS: [f64; 2] = [10.0, 14.0];
/// Room below it, without and with a label.
const BELOW: [f64; 2] = [24.0, 44.0];
/// Length of a tick, and the distance of its label.
const TICK: [f64; 2] = [4.0, 8.0];

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisScale {
    /// Evenly.
    Linear,
    /// By their logarithm; the range must be positive.
    Logarithmic,
}

/// Decades that a logarithmic axis has at least.
const NARROWEST: f64 = 0.3;

/// Span that a linear axis has at least, as a share of its end: ticks of a closer one would need digits that nobody reads.
const LEAST_SHARE: f64 = 1e-3;

/// One axis of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Label with unit; `_x` sets a subscript.
    pub label: String,
    /// First and last value.
    pub range: [f64; 2],
    /// Spread of the values.
    pub scale: AxisScale,
    /// About how many ticks.
    pub ticks: usize,
}

impl Axis {
    /// A linear axis over exactly `range`.
    #[must_use]
    pub fn linear(label: &str, range: [f64; 2]) -> Self {
        Self { label: label.to_owned(), range, scale: AxisScale::Linear, ticks: 6 }
    }

    /// A logarithmic axis over exactly `range`.
    #[must_use]
    pub fn logarithmic(label: &str, range: [f64; 2]) -> Self {
        Self { label: label.to_owned(), range, scale: AxisScale::Logarithmic, ticks: 6 }
    }

    /// An axis that holds some values with a little room; distances begin at nought. What cannot be shown is of no concern; `None` if nothing can.
    #[must_use]
    pub fn holding(label: &str, scale: AxisScale, values: impl Iterator<Item = f64>) -> Option<Self> {
        let logarithmic = scale == AxisScale::Logarithmic;
        let values = values.map(|x| if logarithmic { x.log10() } else { x }).filter(|x| x.is_finite());
        let ends =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        if !ends[0].is_finite() {
            return None;
        }
        let span = ends[1] - ends[0];
        let room = match logarithmic {
            // Ticks of less than a factor of two would need digits that nobody reads.
            true => (0.04 * span).max(0.5 * (NARROWEST - span)),
            false => (0.04 * span).max(0.5 * (LEAST_SHARE * ends[1].abs() - span)).max(1e-12),
        };
        let at_zero = !logarithmic && ends[0] >= 0.0 && ends[0] < 0.2 * ends[1];
        let range = [if at_zero { 0.0 } else { ends[0] - room }, ends[1] + room];
        Some(match logarithmic {
            true => Self::logarithmic(label, range.map(|x| 10f64.powf(x))),
            false => Self::linear(label, range),
        })
    }

    /// The axis without tick labels, for categories that are labelled otherwise.
    #[must_use]
    pub fn without_ticks(self) -> Self {
        Self { ticks: 0, ..self }
    }

    /// Position of `value` between the ends of the axis, 0..1 inside.
    #[must_use]
    pub fn share(&self, value: f64) -> f64 {
        let [low, high, at] = match self.scale {
            AxisScale::Linear => [self.range[0], self.range[1], value],
            AxisScale::Logarithmic => [self.range[0].log10(), self.range[1].log10(), value.log10()],
        };
        (at - low) / (high - low)
    }

    /// Whether `value` lies on the axis.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.share(value))
    }

    /// Positions and labels of its ticks, and its label beside these.
    fn ticks(&self) -> (Vec<f64>, Vec<String>, String) {
        if self.ticks == 0 {
            return (Vec::new(), Vec::new(), self.label.clone());
        }
        match self.scale {
            AxisScale::Linear => {
                let ticks = Ticks::new(self.range, self.ticks);
                (ticks.positions().to_vec(), ticks.labels().to_vec(), ticks.axis_label(&self.label))
            }
            AxisScale::Logarithmic => {
                let positions = logarithmic_ticks(self.range, self.ticks);
                let labels = positions.iter().map(|&at| power_label(at)).collect();
                (positions, labels, self.label.clone())
            }
        }
    }
}

/// Size and axes of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartLayout<'a> {
    /// What a screen reader says.
    pub title: &'a str,
    /// Nominal width and height in pixels.
    pub size: [f64; 2],
    /// Room for the tick labels and the label of the vertical axis.
    pub left: f64,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
}

/// A chart with its axes drawn, ready for marks.
#[derive(Debug, Clone)]
pub struct Chart {
    /// The picture to draw on.
    pub svg: Svg,
    x: Axis,
    y: Axis,
    plot: [[f64; 2]; 2],
    series: SeriesTable,
}

impl Chart {
    /// Draws the axes. `None` if a range is empty or not finite, or there is no room.
    #[must_use]
    pub fn new(layout: ChartLayout<'_>) -> Option<Self> {
        let ChartLayout { title, size, left, x, y } = layout;
        let usable = |axis: &Axis| {
            let ends = axis.range.map(|value| axis.share(value));
            ends.iter().all(|end| end.is_finite()) && axis.range[0] < axis.range[1]
        };
        let below = BELOW[usize::from(!x.label.is_empty())];
        let plot = [[left, MARGINS[0]], [size[0] - MARGINS[1], size[1] - below]];
        let is_roomy = plot[0][0] < plot[1][0] && plot[0][1] < plot[1][1];
        if !(usable(&x) && usable(&y) && is_roomy) {
            return None;
        }
        let mut chart = Self { svg: Svg::new(size, title), x, y, plot, series: SeriesTable::default() };
        chart.draw_axes();
        Some(chart)
    }

    fn draw_axes(&mut self) {
        let [[left, top], [right, bottom]] = self.plot;
        let (across, across_labels, across_label) = self.x.ticks();
        let (up, up_labels, up_label) = self.y.ticks();
        let across: Vec<f64> = across.into_iter().map(|x| self.to_pixel([x, self.y.range[0]])[0]).collect();
        let up: Vec<f64> = up.into_iter().map(|y| self.to_pixel([self.x.range[0], y])[1]).collect();
        let [mut grid, mut lines] = [PathData::new(), PathData::new()];
        lines.line(&[[left, top], [left, bottom], [right, bottom]]);
        for &x in &across {
            grid.line(&[[x, bottom], [x, top]]);
            lines.line(&[[x, bottom], [x, bottom + TICK[0]]]);
        }
        for &y in &up {
            grid.line(&[[left, y], [right, y]]);
            lines.line(&[[left - TICK[0], y], [left, y]]);
        }
        self.svg.path(&grid, r##"fill="none" stroke="#e8e8e8" stroke-width=".8""##);
        self.svg.path(&lines, &format!(r#"fill="none" stroke="{INK}" stroke-width=".9""#));
        let style = |size, anchor| TextStyle { size, ..TextStyle::label(anchor) };
        for (x, text) in across.iter().zip(&across_labels) {
            self.svg.text([*x, bottom + TICK[1] + 8.4], text, style(11.0, Anchor::Middle));
        }
        for (y, text) in up.iter().zip(&up_labels) {
            self.svg.text([left - TICK[1], y + 3.9], text, style(11.0, Anchor::End));
        }
        if !across_label.is_empty() {
            self.svg.text([(left + right) / 2.0, bottom + 37.0], &across_label, style(12.0, Anchor::Middle));
        }
        if !up_label.is_empty() {
            let middle = (top + bottom) / 2.0;
            self.svg.raw(&format!("<g transform=\"rotate(-90 13 {middle:.1})\">"));
            self.svg.text([13.0, middle], &up_label, style(12.0, Anchor::Middle));
            self.svg.raw("</g>\n");
        }
    }

    /// Pixel position of a point in axis coordinates.
    #[must_use]
    pub fn to_pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [[left, top], [right, bottom]] = self.plot;
        [left + self.x.share(x) * (right - left), bottom + self.y.share(y) * (top - bottom)]
    }

    /// Upper left and lower right corner of the plotting area in pixels.
    #[must_use]
    pub fn plot(&self) -> [[f64; 2]; 2] {
        self.plot
    }

    /// The axes, horizontal and vertical.
    #[must_use]
    pub fn axes(&self) -> [&Axis; 2] {
        [&self.x, &self.y]
    }

    /// Whether a point lies within both axes.
    #[must_use]
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        self.x.contains(x) && self.y.contains(y)
    }

    /// Draws a line through points in axis coordinates, broken where one is not finite.
    pub fn curve(&mut self, points: &[[f64; 2]], attributes: &str) {
        let path = self.broken_line(points, [0.0; 2]);
        self.svg.path(&path, &format!(r#"fill="none" {attributes}"#));
    }

    /// Draws a line through points in axis coordinates, cut off at the frame.
    pub fn clipped_curve(&mut self, points: &[[f64; 2]], attributes: &str) {
        let [corner, end] = self.plot;
        let path = self.broken_line(points, corner);
        let mut inner = Svg::new([end[0] - corner[0], end[1] - corner[1]], "");
        inner.path(&path, &format!(r#"fill="none" {attributes}"#));
        self.svg.nest(corner, &inner);
    }

    /// The path through points in axis coordinates, seen from `corner`, broken where one is not finite.
    fn broken_line(&self, points: &[[f64; 2]], corner: [f64; 2]) -> PathData {
        let mut path = PathData::new();
        let places = points.iter().map(|&point| self.to_pixel(point));
        let places: Vec<[f64; 2]> = places.map(|[x, y]| [x - corner[0], y - corner[1]]).collect();
        for part in places.split(|place| !place.iter().all(|x| x.is_finite())) {
            if part.len() > 1 {
                path.line(part);
            }
        }
        path
    }

    /// Draws the frame again, over marks that cover it.
    pub fn frame(&mut self) {
        let [corner, end] = self.plot;
        let mut path = PathData::new();
        path.rectangle(corner, end);
        self.svg.path(&path, &format!(r#"fill="none" stroke="{INK}" stroke-width=".9""#));
    }

    /// Notes what is drawn, in axis coordinates, under a name: the picture [hands it on](Svg::with_table).
    pub fn record(&mut self, name: &str, points: impl IntoIterator<Item = impl Into<ErrorPoint>>) {
        self.series.push(name, points.into_iter().map(Into::into));
    }

    /// The picture with what was noted.
    #[must_use]
    pub fn into_svg(self) -> Svg {
        let table = self.series.to_csv([&self.x.label, &self.y.label]);
        self.svg.with_table(table)
    }

    /// The finished picture.
    #[must_use]
    pub fn finish(self) -> String {
        self.into_svg().finish()
    }
}

/// Powers of ten, thinned to `count`; with 2 and 5 times them where the range is short, and evenly
/// spaced where it is so short that hardly one of these lies in it.
fn logarithmic_ticks([low, high]: [f64; 2], count: usize) -> Vec<f64> {
    let [first, last] = [low.log10().floor(), high.log10().ceil()];
    let decades = (high / low).log10();
    let step = (decades / count as f64).ceil().max(1.0) as usize;
    let factors: &[f64] = if decades <= 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let powers: Vec<f64> = (first as i32..=last as i32)
        .step_by(step)
        .flat_map(|power| factors.iter().map(move |factor| factor * 10f64.powi(power)))
        .filter(|&tick| tick >= low * (1.0 - 1e-9) && tick <= high * (1.0 + 1e-9))
        .collect();
    if powers.len() < 2 { ticks([low, high], count) } else { powers }
}

/// A round number as the label of a tick on a logarithmic axis.
pub(crate) fn power_label(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        return as_given(value);
    }
    let power = value.log10().floor() as i32;
    match (value / 10f64.powi(power)).round() as i64 {
        1 => format!("10{}", superscript(power)),
        lead => format!("{lead}×10{}", superscript(power)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(range: [f64; 2]) -> ChartLayout<'static> {
        let x = Axis::linear("distance (µm)", range);
        let y = Axis::logarithmic("objective", [1e-3, 1e4]);
        ChartLayout { title: "test", size: [400.0, 300.0], left: 60.0, x, y }
    }

    #[test]
    fn marks_and_axes_share_coordinates() {
        let chart = Chart::new(layout([0.0, 10.0])).unwrap();
        let [[left, top], [right, bottom]] = chart.plot();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let corner = chart.to_pixel([0.0, 1e-3]);
        assert!(close(corner[0], left) && close(corner[1], bottom));
        let corner = chart.to_pixel([10.0, 1e4]);
        assert!(close(corner[0], right) && close(corner[1], top));
        let text = chart.finish();
        assert!(text.contains("distance (µm)") && text.contains("objective"));
        assert!(text.contains("0.001") && text.contains("1000"));
    }

    #[test]
    fn impossible_ranges_give_no_chart() {
        for range in [[0.0, f64::NAN], [1.0, 1.0], [f64::NEG_INFINITY, 0.0], [2.0, 1.0]] {
            assert!(Chart::new(layout(range)).is_none());
        }
    }

    #[test]
    fn logarithmic_ticks_are_round() {
        assert_eq!(logarithmic_ticks([0.9, 60.0], 6), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0]);
        assert_eq!(logarithmic_ticks([1e-3, 1e3], 3).len(), 4);
        let labels: Vec<String> = logarithmic_ticks([0.62, 0.91], 6).into_iter().map(power_label).collect();
        assert_eq!(labels, ["0.65", "0.7", "0.75", "0.8", "0.85", "0.9"]);
    }
}
