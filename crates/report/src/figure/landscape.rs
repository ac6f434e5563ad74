//! The objective over two parameters, the others fitted anew at each point.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout, power_label};
use crate::colour::{ColourScale, INK, Palette};
use crate::colour_bar::ColourBar;
use crate::contour::contour_lines;
use crate::key::KeyEntry;
use crate::map::{HATCH_STYLE, hatch};
use crate::markers::Marker;
use crate::svg::{Anchor, PathData, Svg, TextStyle};
use crate::units::label_with_unit;
use crate::view::is_finite;

/// Room beneath the chart for the colour bar.
const BAR_STRIP: f64 = 58.0;
/// Room above the chart for the title.
const TITLE_STRIP: f64 = 20.0;
/// Strokes of a contour line, a white line with a dark rim.
const CONTOUR: [&str; 2] =
    [r##"stroke="#222222" stroke-width="3.4" stroke-opacity=".6""##, r##"stroke="#fff" stroke-width="1.6""##];
/// Ground of points without a fit.
const NO_FIT: &str = r##"fill="#fff""##;

/// One axis of a landscape.
#[derive(Debug, Clone, PartialEq)]
pub struct LandscapeAxis {
    /// Symbol or name of the parameter; `_x` sets a subscript.
    pub label: String,
    /// Unit as typed, empty if there is none.
    pub unit: String,
    /// Values of the parameter, increasing. The axis is logarithmic where they are spaced so.
    pub values: Vec<f64>,
}

/// The rise of the objective over a grid of two parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Landscape {
    /// Heading, also what a screen reader says.
    pub title: String,
    /// Horizontal axis.
    pub x: LandscapeAxis,
    /// Vertical axis.
    pub y: LandscapeAxis,
    /// Rise of the objective above its least value, one unit being one of −2 log likelihood; row by
    /// row, the rows along `y`; not finite where there is no fit.
    pub rise: Vec<f64>,
    /// Where the objective is least.
    pub best: [f64; 2],
    /// The true values where they are known.
    pub truth: Option<[f64; 2]>,
    /// Rises to draw lines at, with their labels, for example 5.99 and `95 %`.
    pub contours: Vec<(f64, String)>,
}

/// Heat map of the rise (dark is low, spread by log(1 + rise)) with labelled contour lines, a cross
/// at the best point and a circle at the truth. Points without a fit are hatched. A contour line with
/// no room for its label is named in the key.
#[must_use]
pub fn landscape(landscape: &Landscape) -> String {
    let title = &landscape.title;
    let grid = Grid::new(landscape);
    let colours = grid.as_ref().and_then(Grid::colours);
    let (Some(grid), Some(colours)) = (grid, colours) else {
        return no_data(title);
    };
    let layout = ChartLayout {
        title,
        size: [440.0, 380.0],
        left: 62.0,
        x: grid.x.axis.clone(),
        y: grid.y.axis.clone(),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    let has_gaps = grid.draw(&mut chart, &colours);
    let mut key = mark_entries(&chart, landscape, &colours);
    if has_gaps {
        key.push(KeyEntry::new("no fit", no_fit_sample));
    }
    key.extend(draw_contours(&mut chart, &grid, landscape));
    let truth = landscape.truth.map(|truth| (truth, Marker::Circle));
    for (at, marker) in truth.into_iter().chain([(landscape.best, Marker::Cross)]) {
        if chart.contains(at) {
            let at = chart.to_pixel(at);
            draw_mark(&mut chart.svg, marker, at);
        }
    }
    chart.frame();
    let ends = [chart.plot()[0][0], chart.plot()[1][0]];
    assemble(title, &chart.with_key(&key), (&colours, ends))
}

/// The entries of the best point and the truth.
fn mark_entries(chart: &Chart, landscape: &Landscape, colours: &ColourScale) -> Vec<KeyEntry> {
    let entry = |name: &str, at: [f64; 2], marker: Marker| {
        let name = if chart.contains(at) { name.to_owned() } else { format!("{name} (outside)") };
        KeyEntry::new(&name, |svg, middle| {
            ground(svg, colours);
            draw_mark(svg, marker, middle);
        })
    };
    let best = is_finite(landscape.best).then(|| entry("best fit", landscape.best, Marker::Cross));
    let truth = landscape.truth.filter(|&truth| is_finite(truth));
    best.into_iter().chain(truth.map(|truth| entry("truth", truth, Marker::Circle))).collect()
}

fn no_fit_sample(svg: &mut Svg, _middle: [f64; 2]) {
    let corners = [[1.0, 1.0], [25.0, 1.0], [25.0, 13.0], [1.0, 13.0]];
    let [mut outline, mut lines] = [PathData::new(), PathData::new()];
    outline.polygon(&corners);
    hatch(&mut lines, &corners);
    svg.path(&lines, HATCH_STYLE);
    svg.path(&outline, r##"fill="none" stroke="#999" stroke-width=".7""##);
}

/// Draws the contour lines and their labels; those without room for a label get an entry.
fn draw_contours(chart: &mut Chart, grid: &Grid, landscape: &Landscape) -> Vec<KeyEntry> {
    let marks = landscape.truth.into_iter().chain([landscape.best]).map(|mark| chart.to_pixel(mark));
    let mut taken: Vec<[f64; 2]> = marks.filter(|&mark| is_finite(mark)).collect();
    let mut entries = Vec::new();
    let mut labels = Vec::new();
    for (level, label) in &landscape.contours {
        let lines = grid.contour(chart, *level);
        if lines.is_empty() {
            continue;
        }
        let mut path = PathData::new();
        lines.iter().for_each(|line| path.line(line));
        for style in CONTOUR {
            chart.svg.path(&path, &format!(r#"fill="none" stroke-linejoin="round" {style}"#));
        }
        match label_place(chart, &lines, &taken) {
            Some(place) => {
                taken.push(place);
                labels.push((place, label));
            }
            None => entries.push(KeyEntry::new(label, |svg, [_, y]| {
                let mut line = PathData::new();
                line.line(&[[1.0, y], [25.0, y]]);
                CONTOUR.iter().for_each(|style| svg.path(&line, &format!(r#"fill="none" {style}"#)));
            })),
        }
    }
    for ([x, y], label) in labels {
        let style = TextStyle { colour: "#fff", ..TextStyle::label(Anchor::Middle) };
        chart.svg.text_with_rim([x, y - 5.0], label, style, INK);
    }
    entries
}

/// The highest place on the lines that has room for a label above it, away from what is `taken`.
fn label_place(chart: &Chart, lines: &[Vec<[f64; 2]>], taken: &[[f64; 2]]) -> Option<[f64; 2]> {
    let [[left, top], [right, bottom]] = chart.plot();
    let is_free = |&&[x, y]: &&[f64; 2]| {
        let is_inside = x > left + 26.0 && x < right - 26.0 && y > top + 20.0 && y < bottom - 4.0;
        let is_apart = |other: &[f64; 2]| (other[0] - x).abs() > 34.0 || (other[1] - y + 9.0).abs() > 18.0;
        is_inside && taken.iter().all(is_apart)
    };
    lines.iter().flatten().filter(is_free).min_by(|a, b| a[1].total_cmp(&b[1])).copied()
}

/// Title, chart and colour bar one beneath the other.
fn assemble(title: &str, chart: &Svg, (colours, ends): (&ColourScale, [f64; 2])) -> String {
    let [width, height] = chart.size();
    let mut svg = Svg::new([width, TITLE_STRIP + height + BAR_STRIP], title);
    let style = TextStyle { size: 13.0, ..TextStyle::label(Anchor::Middle) };
    svg.text([(ends[0] + ends[1]) / 2.0, 14.0], title, style);
    svg.nest([0.0, TITLE_STRIP], chart);
    let bar = ColourBar {
        ends: [ends[0] + 10.0, ends[1] - 10.0],
        top: TITLE_STRIP + height + 8.0,
        ticks: rise_ticks(colours.limits()[1]),
        label: "rise of −2 log likelihood above the best fit".into(),
    };
    bar.draw(&mut svg, colours);
    svg.finish()
}

/// How far a rise is along the colours.
fn spread(rise: f64) -> f64 {
    if rise.is_finite() { rise.max(0.0).ln_1p() / std::f64::consts::LN_10 } else { f64::NAN }
}

/// Round rises up to the end of the bar, a tenth of it apart or more, by their place on it.
fn rise_ticks(end: f64) -> Vec<(f64, String)> {
    let (leads, step): (&[f64], usize) = match end {
        end if end < 5.0 => (&[1.0, 3.0], 1),
        end if end < 10.0 => (&[1.0], 1),
        _ => (&[1.0], 3),
    };
    let powers = (-6..=300).step_by(step);
    let rises = powers.flat_map(|power| leads.iter().map(move |lead| lead * 10f64.powi(power)));
    let mut ticks = vec![(0.0, "0".to_owned())];
    let mut last = 0.0;
    for rise in rises.take_while(|&rise| spread(rise) <= end) {
        if spread(rise) - last >= 0.09 * end {
            last = spread(rise);
            ticks.push((last, power_label(rise)));
        }
    }
    ticks
}

/// The positions of the nodes along one axis.
struct Nodes {
    axis: Axis,
    values: Vec<f64>,
    is_logarithmic: bool,
}

impl Nodes {
    /// `None` unless there are two values and they increase.
    fn new(axis: &LandscapeAxis) -> Option<Self> {
        let values = axis.values.clone();
        let is_rising = values.windows(2).all(|pair| pair[0] < pair[1]);
        let range = [*values.first()?, *values.last()?];
        if values.len() < 2 || !is_rising || !range.iter().all(|end| end.is_finite()) {
            return None;
        }
        let is_logarithmic = range[0] > 0.0 && range[1] > 3.0 * range[0] && {
            let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let ratios: Vec<f64> = values.windows(2).map(|pair| (pair[1] / pair[0]).ln()).collect();
            unevenness(&ratios) < unevenness(&steps)
        };
        let label = label_with_unit(&axis.label, &axis.unit);
        let axis =
            if is_logarithmic { Axis::logarithmic(&label, range) } else { Axis::linear(&label, range) };
        Some(Self { axis, values, is_logarithmic })
    }

    /// The value at a position between nodes.
    fn at(&self, position: f64) -> f64 {
        let last = self.values.len() - 1;
        let position = position.clamp(0.0, last as f64);
        let below = (position.floor() as usize).min(last - 1);
        let share = position - below as f64;
        let [low, high] = [self.values[below], self.values[below + 1]];
        if self.is_logarithmic { low * (high / low).powf(share) } else { low + share * (high - low) }
    }
}

/// Largest over smallest step.
fn unevenness(steps: &[f64]) -> f64 {
    let smallest = steps.iter().copied().fold(f64::INFINITY, f64::min);
    steps.iter().copied().fold(0.0, f64::max) / smallest
}

/// The nodes and the spread rise at each.
struct Grid {
    x: Nodes,
    y: Nodes,
    heights: Vec<f64>,
    highest_contour: f64,
}

impl Grid {
    fn new(landscape: &Landscape) -> Option<Self> {
        let [x, y] = [Nodes::new(&landscape.x)?, Nodes::new(&landscape.y)?];
        let heights: Vec<f64> = landscape.rise.iter().map(|&rise| spread(rise)).collect();
        let levels = landscape.contours.iter().map(|contour| spread(contour.0));
        let highest_contour = levels.fold(0.0, f64::max);
        (heights.len() == x.values.len() * y.values.len()).then_some(Self { x, y, heights, highest_contour })
    }

    /// Colours from no rise to nearly the highest; `None` where there is no rise at all.
    fn colours(&self) -> Option<ColourScale> {
        let colours = ColourScale::robust(self.heights.iter().copied(), Palette::Sequential)?;
        let end = colours.limits()[1].max(1.1 * self.highest_contour).max(1e-3);
        Some(colours.with_limits([0.0, end]))
    }

    /// Draws the heat map; returns whether points without a fit were hatched.
    fn draw(&self, chart: &mut Chart, colours: &ColourScale) -> bool {
        let mut classes = vec![PathData::new(); ColourScale::LEVELS];
        let [mut missing, mut hatching] = [PathData::new(), PathData::new()];
        let columns = self.x.values.len();
        for (row, heights) in self.heights.chunks(columns).enumerate() {
            let levels: Vec<Option<usize>> = heights.iter().map(|&height| colours.level(height)).collect();
            let mut first = 0;
            for run in levels.chunk_by(|a, b| a == b) {
                let corner = |column: usize, row: usize| {
                    let [x, y] = [column, row].map(|index| index as f64 - 0.5);
                    chart.to_pixel([self.x.at(x), self.y.at(y)])
                };
                let [from, to] = [corner(first, row), corner(first + run.len(), row + 1)];
                match run[0] {
                    Some(level) => classes[level].rectangle(from, to),
                    None => {
                        missing.rectangle(from, to);
                        let corners = [from, [to[0], from[1]], to, [from[0], to[1]]];
                        hatch(&mut hatching, &corners);
                    }
                }
                first += run.len();
            }
        }
        for (level, path) in classes.iter().enumerate() {
            let fill = colours.colour(level);
            // The outline hides the seams between the classes.
            chart.svg.path(path, &format!(r#"fill="{fill}" stroke="{fill}" stroke-width=".5""#));
        }
        chart.svg.path(&missing, NO_FIT);
        chart.svg.path(&hatching, HATCH_STYLE);
        !missing.is_empty()
    }

    /// The lines at one level, in pixels.
    fn contour(&self, chart: &Chart, level: f64) -> Vec<Vec<[f64; 2]>> {
        let place = |[x, y]: [f64; 2]| chart.to_pixel([self.x.at(x), self.y.at(y)]);
        let lines = contour_lines(&self.heights, self.x.values.len(), spread(level));
        lines.into_iter().map(|line| line.into_iter().map(place).collect()).collect()
    }
}

/// The dark ground of the best region beneath a mark in the key.
fn ground(svg: &mut Svg, colours: &ColourScale) {
    let [width, height] = svg.size();
    let mut area = PathData::new();
    area.rectangle([width / 2.0 - 8.0, 0.0], [width / 2.0 + 8.0, height]);
    svg.path(&area, &format!(r#"fill="{}""#, colours.colour(ColourScale::LEVELS / 4)));
}

/// Draws a white mark with a dark rim, legible on all colours.
fn draw_mark(svg: &mut Svg, marker: Marker, at: [f64; 2]) {
    let mut path = PathData::new();
    marker.push(&mut path, at, 4.6);
    for (colour, width) in [(INK, 4.2), ("#ffffff", 2.0)] {
        let style = format!(r#"fill="none" stroke="{colour}" stroke-width="{width}" stroke-linecap="round""#);
        svg.path(&path, &style);
    }
}
