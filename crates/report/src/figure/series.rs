//! Measured and predicted values against one variable: marks with error bars, lines.

use super::no_data;
use crate::chart::{Axis, AxisScale, Chart, ChartLayout};
use crate::colour::{BLUE, ColourScale, GREEN, GREY, INK, Palette, VERMILLION};
use crate::key::{KeyEntry, SAMPLE};
use crate::markers::Marker;
use crate::svg::{PathData, Svg};

/// Radius of a mark in pixels.
const MARK: f64 = 3.4;
/// Room between the data and the frame, as a share of the axis.
const ROOM: f64 = 0.05;

/// A value at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesPoint {
    /// Place and value.
    pub at: [f64; 2],
    /// Standard error of the value, zero where it has none.
    pub standard_error: f64,
}

impl From<[f64; 2]> for SeriesPoint {
    fn from(at: [f64; 2]) -> Self {
        Self { at, standard_error: 0.0 }
    }
}

/// What a series is drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drawn {
    /// Marks with error bars: what was measured.
    Marks,
    /// Marks joined by lines: a family of measured curves.
    JoinedMarks,
    /// A line: what a theory says.
    Line,
    /// A broken line.
    BrokenLine,
}

/// One set of values.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the key; none if it is empty.
    pub name: String,
    /// What it is drawn as.
    pub drawn: Drawn,
    /// Its values; those that are not finite, or not positive on a logarithmic axis, are left out.
    pub points: Vec<SeriesPoint>,
}

/// How colours are given to series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colours {
    /// Four colours and marks that are easily told apart, by the place in the list.
    Distinct,
    /// From dark to light in the order of the list, for a parameter that increases; marks and the line of the same place
    /// in their halves of the list share a colour.
    Ordered,
}

/// Name, spread, and range of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesAxis {
    /// Name with unit; `_x` sets a subscript.
    pub label: String,
    /// Spread of the values.
    pub scale: AxisScale,
    /// Ends; all values if there are none.
    pub range: Option<[f64; 2]>,
}

impl SeriesAxis {
    /// An even axis over all values.
    #[must_use]
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), scale: AxisScale::Linear, range: None }
    }

    /// A logarithmic axis over all values.
    #[must_use]
    pub fn logarithmic(label: &str) -> Self {
        Self { label: label.to_owned(), scale: AxisScale::Logarithmic, range: None }
    }

    /// The same axis from `low` to `high`.
    #[must_use]
    pub fn over(self, low: f64, high: f64) -> Self {
        Self { range: Some([low, high]), ..self }
    }

    fn shows(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == AxisScale::Linear || value > 0.0)
    }

    fn axis(&self, values: impl Iterator<Item = f64>) -> Option<Axis> {
        let logarithmic = self.scale == AxisScale::Logarithmic;
        let (into, back): (fn(f64) -> f64, fn(f64) -> f64) =
            if logarithmic { (f64::log10, |x| 10f64.powf(x)) } else { (|x| x, |x| x) };
        let [low, high] = match self.range {
            Some(range) => range,
            None => {
                let ends = values
                    .filter(|&value| self.shows(value))
                    .map(into)
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
                let width = (ends[1] - ends[0]).max(1e-9 * ends[0].abs().max(ends[1].abs())).max(1e-12);
                if !width.is_finite() {
                    return None;
                }
                [back(ends[0] - ROOM * width), back(ends[1] + ROOM * width)]
            }
        };
        Some(if logarithmic {
            Axis::logarithmic(&self.label, [low, high])
        } else {
            Axis::linear(&self.label, [low, high])
        })
    }
}

/// Several series on common axes.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesChart {
    /// What a screen reader says.
    pub title: String,
    /// Horizontal axis.
    pub x: SeriesAxis,
    /// Vertical axis.
    pub y: SeriesAxis,
    /// How series are told apart.
    pub colours: Colours,
    /// The series, drawn in this order.
    pub series: Vec<Series>,
}

/// Series on common axes, with a key above.
///
/// ```
/// use voronudge_report::figure::{Colours, Drawn, Series, SeriesAxis, SeriesChart, series_chart};
/// let series = Series { name: "theory".into(), drawn: Drawn::Line, points: vec![[0.0, 0.0].into(), [1.0, 2.0].into()] };
/// let chart = SeriesChart {
///     title: "a line".into(),
///     x: SeriesAxis::linear("α"),
///     y: SeriesAxis::linear("K_o / K_P"),
///     colours: Colours::Distinct,
///     series: vec![series],
/// };
/// assert!(series_chart(&chart).contains("theory"));
/// ```
#[must_use]
pub fn series_chart(figure: &SeriesChart) -> String {
    let title = &figure.title;
    let shown: Vec<Vec<SeriesPoint>> = figure.series.iter().map(|series| drawable(series, figure)).collect();
    let all = || shown.iter().flatten();
    let errors = all().flat_map(|point| [-1.0, 1.0].map(|sign| point.at[1] + sign * point.standard_error));
    let axes = figure.x.axis(all().map(|point| point.at[0])).zip(figure.y.axis(errors));
    let layout = axes.map(|(x, y)| ChartLayout { title, size: [460.0, 320.0], left: 68.0, x, y });
    let Some(mut chart) = layout.and_then(Chart::new) else {
        return no_data(title);
    };
    let mut key = Vec::new();
    if chart.contains([chart.axes()[0].range[0], 0.0]) && figure.y.scale == AxisScale::Linear {
        let ends = chart.axes()[0].range.map(|x| [x, 0.0]);
        chart.curve(&ends, &format!(r#"stroke="{GREY}" stroke-width=".8""#));
    }
    for (index, (series, points)) in figure.series.iter().zip(&shown).enumerate() {
        if points.is_empty() {
            continue;
        }
        let style = Style::of(figure, index);
        style.draw(&mut chart, series.drawn, points);
        if !series.name.is_empty() {
            key.push(style.key_entry(series));
        }
    }
    chart.frame();
    chart.finish_with_key(&key)
}

fn drawable(series: &Series, figure: &SeriesChart) -> Vec<SeriesPoint> {
    let shows = |point: &&SeriesPoint| figure.x.shows(point.at[0]) && figure.y.shows(point.at[1]);
    let error = |error: f64| if error.is_finite() { error.abs() } else { 0.0 };
    let points = series.points.iter().filter(shows);
    points.map(|point| SeriesPoint { standard_error: error(point.standard_error), ..*point }).collect()
}

#[derive(Debug, Clone, PartialEq)]
struct Style {
    colour: String,
    marker: Marker,
}

impl Style {
    fn of(figure: &SeriesChart, index: usize) -> Self {
        let markers = [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond];
        match figure.colours {
            Colours::Distinct => {
                Self { colour: [BLUE, VERMILLION, GREEN, INK][index % 4].into(), marker: markers[index % 4] }
            }
            Colours::Ordered => {
                let is_marks = |series: &Series| matches!(series.drawn, Drawn::Marks | Drawn::JoinedMarks);
                let own = is_marks(&figure.series[index]);
                let alike = |series: &&Series| is_marks(series) == own;
                let place = figure.series[..index].iter().filter(alike).count();
                let count = figure.series.iter().filter(alike).count();
                // The lightest colours are too pale for lines.
                let share = 0.85 * place as f64 / (count.max(2) - 1) as f64;
                let scale = ColourScale::robust([0.0, 1.0], Palette::Sequential);
                let level = (share * (ColourScale::LEVELS - 1) as f64).round() as usize;
                Self {
                    colour: scale.map_or_else(|| INK.into(), |scale| scale.colour(level)),
                    marker: markers[place % 4],
                }
            }
        }
    }

    fn line(&self, drawn: Drawn) -> String {
        let dashes = if drawn == Drawn::BrokenLine { "6 4" } else { "none" };
        let colour = &self.colour;
        format!(r#"fill="none" stroke="{colour}" stroke-width="1.6" stroke-dasharray="{dashes}""#)
    }

    fn draw(&self, chart: &mut Chart, drawn: Drawn, points: &[SeriesPoint]) {
        let line: Vec<[f64; 2]> = points.iter().map(|point| point.at).collect();
        if drawn != Drawn::Marks {
            chart.clipped_curve(&line, &self.line(drawn));
        }
        if matches!(drawn, Drawn::Line | Drawn::BrokenLine) {
            return;
        }
        let mut bars = PathData::new();
        let [low, high] = chart.axes()[1].range;
        for point in points.iter().filter(|point| point.standard_error > 0.0 && chart.contains(point.at)) {
            let end = |sign: f64| (point.at[1] + sign * point.standard_error).clamp(low, high);
            bars.line(&[-1.0, 1.0].map(|sign| chart.place([point.at[0], end(sign)])));
        }
        let colour = &self.colour;
        chart.svg.path(&bars, &format!(r#"fill="none" stroke="{colour}" stroke-width="1.1""#));
        let places: Vec<[f64; 2]> =
            line.into_iter().filter(|&at| chart.contains(at)).map(|at| chart.place(at)).collect();
        self.marks(&mut chart.svg, &places);
    }

    fn marks(&self, svg: &mut Svg, places: &[[f64; 2]]) {
        let mut marks = PathData::new();
        places.iter().for_each(|&place| self.marker.push(&mut marks, place, MARK));
        svg.path(&marks, &format!(r##"fill="{}" stroke="#fff" stroke-width=".7""##, self.colour));
    }

    fn key_entry(&self, series: &Series) -> KeyEntry {
        KeyEntry::new(&series.name, |svg, middle| {
            if series.drawn != Drawn::Marks {
                let mut line = PathData::new();
                line.line(&[[0.5, middle[1]], [SAMPLE[0] - 0.5, middle[1]]]);
                svg.path(&line, &self.line(series.drawn));
            }
            if matches!(series.drawn, Drawn::Marks | Drawn::JoinedMarks) {
                self.marks(svg, &[middle]);
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(scale: AxisScale, points: Vec<SeriesPoint>) -> SeriesChart {
        let axis = SeriesAxis { label: "v".into(), scale, range: None };
        let series = |drawn| Series { name: format!("{drawn:?}"), drawn, points: points.clone() };
        SeriesChart {
            title: "test".into(),
            x: SeriesAxis::linear("x"),
            y: axis,
            colours: Colours::Ordered,
            series: vec![series(Drawn::Marks), series(Drawn::BrokenLine)],
        }
    }

    #[test]
    fn values_that_cannot_be_drawn_are_left_out() {
        let points = vec![[0.0, 1.0].into(), [1.0, -1.0].into(), [2.0, f64::NAN].into(), [3.0, 100.0].into()];
        let even =
            drawable(&chart(AxisScale::Linear, points.clone()).series[0], &chart(AxisScale::Linear, vec![]));
        assert_eq!(even.len(), 3);
        let logarithmic = chart(AxisScale::Logarithmic, points);
        assert_eq!(drawable(&logarithmic.series[0], &logarithmic).len(), 2);
        assert!(series_chart(&logarithmic).contains("BrokenLine"));
    }

    #[test]
    fn nothing_to_draw_says_so() {
        assert!(series_chart(&chart(AxisScale::Linear, vec![])).contains("no data"));
    }

    #[test]
    fn marks_and_lines_of_one_value_share_a_colour() {
        let figure = chart(AxisScale::Linear, vec![[0.0, 1.0].into()]);
        assert_eq!(Style::of(&figure, 0).colour, Style::of(&figure, 1).colour);
    }
}
