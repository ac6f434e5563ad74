//! Several methods against one condition: medians with quartiles.

use super::no_data;
use crate::chart::{Axis, AxisScale, Chart, ChartLayout};
use crate::colour::{BLUE, GREEN, INK, VERMILLION};
use crate::key::{KeyEntry, SAMPLE};
use crate::markers::Marker;
use crate::numbers::as_given;
use crate::svg::{Anchor, PathData, Svg, TextStyle};

/// Size of a mark in pixels.
const MARK: f64 = 3.9;
/// Greatest distance in pixels by which methods stand beside each other.
const ASIDE: f64 = 9.0;

/// Condition, median over the repetitions, and lower and upper quartile.
type Point = (f64, f64, [f64; 2]);

/// One method.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodSeries {
    /// Name in the key.
    pub name: String,
    /// Condition, median over the repetitions, and lower and upper quartile.
    pub points: Vec<(f64, f64, [f64; 2])>,
}

/// One panel of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodComparison {
    /// What a screen reader says.
    pub title: String,
    /// Label of the condition with its unit, for example `position noise (% of ℓ₀)`.
    pub x_label: String,
    /// Label of the result with its unit.
    pub y_label: String,
    /// How the results are spread.
    pub y_scale: AxisScale,
    /// A value to be reached, and its name.
    pub target: Option<(f64, String)>,
    /// The methods. The place in the list decides colour, mark and line; a method without points
    /// keeps its place, so that panels agree.
    pub methods: Vec<MethodSeries>,
}

/// Median and quartiles against the condition, one line per method. Conditions are categories,
/// evenly spaced in increasing order. Methods differ in colour, mark and line.
#[must_use]
pub fn method_comparison(comparison: &MethodComparison) -> String {
    let title = &comparison.title;
    let conditions = conditions(comparison);
    let Some(range) = y_range(comparison).filter(|_| !conditions.is_empty()) else {
        return no_data(title);
    };
    let y = match comparison.y_scale {
        AxisScale::Linear => Axis::linear(&comparison.y_label, range),
        AxisScale::Logarithmic => Axis::logarithmic(&comparison.y_label, range),
    };
    let x = Axis::linear(&comparison.x_label, [-0.5, conditions.len() as f64 - 0.5]).without_ticks();
    let layout = ChartLayout { title, size: [440.0, 300.0], left: 66.0, x, y };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    label_conditions(&mut chart, &conditions);
    if let Some((target, _)) = &comparison.target {
        draw_target(&mut chart, *target);
    }
    let shown: Vec<usize> =
        (0..comparison.methods.len()).filter(|&at| drawable(comparison, at).next().is_some()).collect();
    let [[left, _], [right, _]] = chart.plot();
    let room = 0.6 * (right - left) / (conditions.len() * shown.len().max(1)) as f64;
    for (place, &index) in shown.iter().enumerate() {
        let aside = room.min(ASIDE) * (place as f64 - (shown.len() as f64 - 1.0) / 2.0);
        let at = |value: f64| conditions.iter().position(|condition| *condition == value);
        let mut points: Vec<Point> = drawable(comparison, index)
            .filter_map(|(condition, median, quartiles)| Some((at(condition)? as f64, median, quartiles)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let medians = points.iter().map(|&(condition, median, _)| [conditions[condition as usize], median]);
        chart.record(&comparison.methods[index].name, medians.collect::<Vec<_>>());
        draw_series(&mut chart, &points, (Style::of(index), aside));
    }
    if let Some((target, name)) = &comparison.target {
        label_target(&mut chart, (*target, name), comparison);
    }
    chart.frame();
    let entry = |&index: &usize| {
        let style = Style::of(index);
        KeyEntry::new(&comparison.methods[index].name, |svg, middle| {
            let mut line = PathData::new();
            line.line(&[[0.5, middle[1]], [SAMPLE[0] - 0.5, middle[1]]]);
            svg.path(&line, &style.line());
            style.mark(svg, &[middle]);
        })
    };
    let key: Vec<KeyEntry> = shown.iter().map(entry).collect();
    chart.finish_with_key(&key)
}

/// How a method looks: four marks, four colours and four lines, then the same marks hollow.
#[derive(Debug, Clone, Copy)]
struct Style {
    colour: &'static str,
    dashes: &'static str,
    marker: Marker,
    is_hollow: bool,
}

impl Style {
    fn of(index: usize) -> Self {
        let [colour, dashes] =
            [[BLUE, "none"], [VERMILLION, "7 4"], [GREEN, "2 3"], [INK, "9 3 2 3"]][index % 4];
        let marker = [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond][index % 4];
        Self { colour, dashes, marker, is_hollow: index % 8 >= 4 }
    }

    fn line(self) -> String {
        let Self { colour, dashes, .. } = self;
        format!(r#"fill="none" stroke="{colour}" stroke-width="1.6" stroke-dasharray="{dashes}""#)
    }

    fn mark(self, svg: &mut Svg, places: &[[f64; 2]]) {
        let mut marks = PathData::new();
        for &place in places {
            self.marker.push(&mut marks, place, MARK);
        }
        let Self { colour, .. } = self;
        let [fill, stroke] = if self.is_hollow { ["#fff", colour] } else { [colour, "#fff"] };
        let width = if self.is_hollow { 1.6 } else { 0.8 };
        svg.path(&marks, &format!(r#"fill="{fill}" stroke="{stroke}" stroke-width="{width}""#));
    }
}

/// The points of a method that can be drawn.
fn drawable(comparison: &MethodComparison, index: usize) -> impl Iterator<Item = Point> + '_ {
    let is_shown = |value: f64| match comparison.y_scale {
        AxisScale::Linear => value.is_finite(),
        AxisScale::Logarithmic => value.is_finite() && value > 0.0,
    };
    let points = comparison.methods.get(index).map_or(&[][..], |method| method.points.as_slice());
    points.iter().copied().filter(move |point| point.0.is_finite() && is_shown(point.1))
}

/// All conditions that occur, in increasing order.
fn conditions(comparison: &MethodComparison) -> Vec<f64> {
    let points = (0..comparison.methods.len()).flat_map(|index| drawable(comparison, index));
    let mut conditions: Vec<f64> = points.map(|point| point.0).collect();
    conditions.sort_by(f64::total_cmp);
    conditions.dedup();
    conditions
}

/// From the lowest to the highest of medians, quartiles and target, with room.
fn y_range(comparison: &MethodComparison) -> Option<[f64; 2]> {
    let is_logarithmic = comparison.y_scale == AxisScale::Logarithmic;
    let points = (0..comparison.methods.len()).flat_map(|index| drawable(comparison, index));
    let target = comparison.target.as_ref().map(|target| target.0);
    let values = points
        .flat_map(|(_, median, quartiles)| [median, quartiles[0], quartiles[1]])
        .chain(target)
        .filter(|value| value.is_finite() && (*value > 0.0 || !is_logarithmic));
    let [low, high] = values
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low > high {
        return None;
    }
    if is_logarithmic {
        let room = (high / low).powf(0.06).max(1.2);
        return Some([low / room, high * room]);
    }
    // Zero belongs to an axis that comes near it.
    let low = if low > 0.0 && low < 0.4 * high { 0.0 } else { low };
    let size = if low == high && low == 0.0 { 1.0 } else { low.abs().max(high.abs()) };
    let room = 0.06 * (high - low).max(1e-3 * size);
    Some([if low == 0.0 { 0.0 } else { low - room }, high + room])
}

fn label_conditions(chart: &mut Chart, conditions: &[f64]) {
    let bottom = chart.plot()[1][1];
    let mut ticks = PathData::new();
    for (index, &condition) in conditions.iter().enumerate() {
        let x = chart.to_pixel([index as f64, f64::NAN])[0];
        ticks.line(&[[x, bottom], [x, bottom + 4.0]]);
        let style = TextStyle { size: 11.0, ..TextStyle::label(Anchor::Middle) };
        chart.svg.text([x, bottom + 16.0], &as_given(condition), style);
    }
    chart.svg.path(&ticks, &format!(r#"fill="none" stroke="{INK}" stroke-width=".9""#));
}

fn draw_target(chart: &mut Chart, target: f64) {
    let [low, high] = chart.axes()[0].range;
    if chart.contains([low, target]) {
        chart.curve(&[[low, target], [high, target]], &format!(r#"stroke="{INK}" stroke-width="1.2""#));
    }
}

/// Writes the name of the target at the end of its line from which the methods keep farther away.
fn label_target(chart: &mut Chart, (target, name): (f64, &str), comparison: &MethodComparison) {
    let [low, high] = chart.axes()[0].range;
    if !chart.contains([low, target]) {
        return;
    }
    let conditions = conditions(comparison);
    let height = |value: f64| chart.to_pixel([low, value])[1];
    let clearance = |condition: Option<&f64>| {
        let points = (0..comparison.methods.len()).flat_map(|index| drawable(comparison, index));
        let near = points.filter(|point| condition == Some(&point.0));
        near.map(|point| (height(point.1) - height(target)).abs()).fold(f64::INFINITY, f64::min)
    };
    let is_right = clearance(conditions.last()) > clearance(conditions.first());
    let top = chart.plot()[0][1];
    let [x, y] = chart.to_pixel([if is_right { high } else { low }, target]);
    let y = if y - top < 18.0 { y + 13.0 } else { y - 5.0 };
    let (x, anchor) = if is_right { (x - 6.0, Anchor::End) } else { (x + 6.0, Anchor::Start) };
    chart.svg.text_with_rim([x, y], name, TextStyle::label(anchor), "#fff");
}

fn draw_series(chart: &mut Chart, points: &[Point], (style, aside): (Style, f64)) {
    let lowest = chart.axes()[1].range[0];
    let place = |chart: &Chart, x: f64, y: f64| {
        let [x, y] = chart.to_pixel([x, y.max(lowest)]);
        [x + aside, y]
    };
    let mut line = PathData::new();
    let medians: Vec<[f64; 2]> = points.iter().map(|point| place(chart, point.0, point.1)).collect();
    line.line(&medians);
    chart.svg.path(&line, &style.line());
    let mut bars = PathData::new();
    for &(x, _, quartiles) in points.iter().filter(|point| point.2.iter().all(|end| end.is_finite())) {
        let [from, to] = quartiles.map(|quartile| place(chart, x, quartile));
        bars.line(&[from, to]);
        for [x, y] in [from, to] {
            bars.line(&[[x - 2.5, y], [x + 2.5, y]]);
        }
    }
    chart.svg.path(&bars, &format!(r#"fill="none" stroke="{}" stroke-width="1.4""#, style.colour));
    style.mark(&mut chart.svg, &medians);
}
