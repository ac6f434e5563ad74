//! The likelihood along one parameter, the others fitted anew at each value.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, INK, VERMILLION};
use crate::key::KeyEntry;
use crate::numbers::interval_text;
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::{label_with_unit, unit_text};

/// Rise of −2 log likelihood at the ends of a 95 % interval of one parameter.
const RISE_95: f64 = 3.84;
/// Fill of the interval.
const SHADE: &str = r##"fill="#d9e6ef""##;
/// The line of the profile and of the quadratic approximation.
const PROFILE: &str = r#"stroke-width="2" stroke-linejoin="round""#;
const QUADRATIC: &str = r#"stroke-width="1.6" stroke-dasharray="6 4""#;

/// A profile and what a quadratic approximation makes of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileCurve {
    /// Symbol or name of the parameter; `_x` sets a subscript.
    pub parameter: String,
    /// Unit as typed, empty if there is none.
    pub unit: String,
    /// Values of the parameter and the rise of −2 log likelihood above its least value there; not
    /// finite where the fit failed.
    pub points: Vec<(f64, f64)>,
    /// Centre and standard error of the quadratic approximation.
    pub quadratic: Option<(f64, f64)>,
    /// 95 % interval of the profile; an end that is `None` is not bounded.
    pub interval: [Option<f64>; 2],
    /// Best value.
    pub best: f64,
}

/// Rise of −2 log likelihood against the parameter, the quadratic approximation dashed, the 95 %
/// interval shaded where the profile lies below 3.84. The vertical axis ends where the interval is
/// decided; what rises higher is cut off.
#[must_use]
pub fn profile(curve: &ProfileCurve) -> String {
    let title = format!("profile of {}", curve.parameter);
    let points = sorted_points(curve);
    let ends = points.first().zip(points.last()).map(|(first, last)| [first[0], last[0]]);
    let Some(ends) = ends.filter(|[first, last]| first < last) else {
        return no_data(&title);
    };
    let room = 0.02 * (ends[1] - ends[0]);
    let highest = points.iter().map(|point| point[1]).fold(0.0, f64::max);
    let top = (1.1 * highest).clamp(1.5 * RISE_95, 3.0 * RISE_95);
    let layout = ChartLayout {
        title: &title,
        size: [440.0, 290.0],
        left: 62.0,
        x: Axis::linear(&label_with_unit(&curve.parameter, &curve.unit), [ends[0] - room, ends[1] + room]),
        y: Axis::linear("rise of −2 log likelihood", [0.0, top]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(&title);
    };
    let shaded = shade(&mut chart, curve.interval);
    if let Some((centre, error)) = quadratic(curve) {
        let [low, high] = chart.axes()[0].range;
        let at = |step: usize| low + (high - low) * step as f64 / 300.0;
        let parabola: Vec<[f64; 2]> =
            (0..=300).map(|step| [at(step), ((at(step) - centre) / error).powi(2)]).collect();
        chart.record("quadratic approximation", parabola.iter().copied());
        chart.clipped_curve(&parabola, &format!(r#"stroke="{VERMILLION}" {QUADRATIC}"#));
    }
    chart.record("profile", points.iter().copied());
    chart.clipped_curve(&points, &format!(r#"stroke="{BLUE}" {PROFILE}"#));
    mark_points(&mut chart, &points, curve.best);
    draw_limit(&mut chart, shaded);
    chart.frame();
    chart.finish_with_key(&key(curve))
}

/// The finite points in the order of the parameter.
fn sorted_points(curve: &ProfileCurve) -> Vec<[f64; 2]> {
    let finite = |&&(value, rise): &&(f64, f64)| value.is_finite() && rise.is_finite();
    let mut points: Vec<[f64; 2]> =
        curve.points.iter().filter(finite).map(|&(value, rise)| [value, rise]).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

fn quadratic(curve: &ProfileCurve) -> Option<(f64, f64)> {
    curve.quadratic.filter(|(centre, error)| centre.is_finite() && error.is_finite() && *error > 0.0)
}

/// Shades the interval as far as the axis shows it; returns its ends on the axis.
fn shade(chart: &mut Chart, interval: [Option<f64>; 2]) -> [f64; 2] {
    let [low, high] = chart.axes()[0].range;
    let [from, to] = [interval[0].unwrap_or(low), interval[1].unwrap_or(high)];
    let [from, to] = [from, to].map(|end| if end.is_finite() { end.clamp(low, high) } else { f64::NAN });
    let top = chart.axes()[1].range[1];
    let mut area = PathData::new();
    area.rectangle(chart.to_pixel([from, 0.0]), chart.to_pixel([to, top]));
    chart.svg.path(&area, SHADE);
    let mut edges = PathData::new();
    for end in interval.into_iter().flatten().filter(|end| (low..=high).contains(end)) {
        edges.line(&[chart.to_pixel([end, 0.0]), chart.to_pixel([end, RISE_95])]);
    }
    chart.svg.path(&edges, r##"fill="none" stroke="#5b7f99" stroke-width="1""##);
    [from, to]
}

/// Dots where the profile was computed, and the best value.
fn mark_points(chart: &mut Chart, points: &[[f64; 2]], best: f64) {
    let mut dots = PathData::new();
    for &point in points.iter().filter(|&&point| chart.contains(point)) {
        dots.dot(chart.to_pixel(point));
    }
    let style = r#"fill="none" stroke-width="5" stroke-linecap="round""#;
    chart.svg.path(&dots, &format!(r#"stroke="{BLUE}" {style}"#));
    if chart.contains([best, 0.0]) {
        let [x, y] = chart.to_pixel([best, 0.0]);
        let mut mark = PathData::new();
        mark.polygon(&[[x, y - 1.0], [x - 5.0, y - 11.0], [x + 5.0, y - 11.0]]);
        chart.svg.path(&mark, &format!(r##"fill="{INK}" stroke="#fff" stroke-width=".8""##));
    }
}

/// The level that the ends of the interval reach, labelled above the interval, where the profile
/// is not.
fn draw_limit(chart: &mut Chart, shaded: [f64; 2]) {
    let [low, high] = chart.axes()[0].range;
    chart.curve(&[[low, RISE_95], [high, RISE_95]], &format!(r#"stroke="{INK}" stroke-width="1.1""#));
    let middle = (shaded[0] + shaded[1]) / 2.0;
    let [[left, _], [right, _]] = chart.plot();
    let [x, y] = chart.to_pixel([if middle.is_finite() { middle } else { (low + high) / 2.0 }, RISE_95]);
    let at = [x.clamp(left + 20.0, right - 20.0), y - 5.0];
    chart.svg.text_with_rim(at, "95 %", TextStyle::label(Anchor::Middle), "#fff");
}

fn key(curve: &ProfileCurve) -> Vec<KeyEntry> {
    let [_, interval] = interval_text(curve.best, curve.interval);
    let bounded = curve.interval.iter().any(Option::is_some);
    let unit = if bounded { unit_text(&curve.unit) } else { String::new() };
    let interval = format!("95 %: {interval} {unit}");
    let mut entries = vec![KeyEntry::line("profile", &format!(r#"stroke="{BLUE}" {PROFILE}"#))];
    if quadratic(curve).is_some() {
        let style = format!(r#"stroke="{VERMILLION}" {QUADRATIC}"#);
        entries.push(KeyEntry::line("quadratic approximation", &style));
    }
    entries.push(KeyEntry::area(interval.trim_end(), SHADE));
    entries
}
