//! A quantity over two parameters of the model, with lines of theory.

use super::no_data;
use crate::chart::{Axis, AxisScale, Chart, ChartLayout, power_label};
use crate::colour::{ColourScale, INK, Palette};
use crate::colour_bar::ColourBar;
use crate::key::KeyEntry;
use crate::map::{HATCH_STYLE, hatch};
use crate::svg::{Anchor, PathData, Svg, TextStyle};

/// Room beneath the chart for the colour bar.
const BAR_STRIP: f64 = 58.0;
/// Room above the chart for the title.
const TITLE_STRIP: f64 = 20.0;
/// Decades that a logarithmic bar spans at most.
const MOST_DECADES: f64 = 6.0;

/// A line over the map, for example a limit of stability.
#[derive(Debug, Clone, PartialEq)]
pub struct MapLine {
    /// What it is; `_x` sets a subscript.
    pub label: String,
    /// Its points in axis coordinates.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub style: LineStyle,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineStyle {
    /// Without gaps.
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// Dashes and dots.
    DashDotted,
}

impl LineStyle {
    fn strokes(self) -> [String; 2] {
        let dashes = match self {
            Self::Solid => "none",
            Self::Dashed => "7 4",
            Self::Dotted => "0.1 4.5",
            Self::DashDotted => "8 4.5 0.1 4.5",
        };
        // A light line with a dark rim can be seen on all colours.
        [("#222222", 3.8, ".75"), ("#ffffff", 1.8, "1")].map(|(colour, width, opacity)| {
            format!(
                r#"stroke="{colour}" stroke-width="{width}" stroke-opacity="{opacity}" stroke-dasharray="{dashes}" stroke-linecap="round""#
            )
        })
    }
}

/// A quantity on a grid of two parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseMap<'a> {
    /// Heading, also what a screen reader says.
    pub title: &'a str,
    /// What the numbers mean, with unit, for the colour bar.
    pub label: &'a str,
    /// Label and increasing values of the horizontal parameter.
    pub x: (&'a str, &'a [f64]),
    /// Label and increasing values of the vertical parameter.
    pub y: (&'a str, &'a [f64]),
    /// The quantity row by row, the rows along `y`; not finite where it is not known.
    pub values: &'a [f64],
    /// How values are spread over the colours.
    pub scale: AxisScale,
    /// Palette; diverging for quantities with a sign.
    pub palette: Palette,
    /// Lines over the map.
    pub lines: &'a [MapLine],
}

/// Heat map with a rectangle around each point of the grid, lines with a key, and a colour bar. A logarithmic bar spans at most six
/// decades below the largest value. Points without a value are hatched.
#[must_use]
pub fn phase_map(map: &PhaseMap<'_>) -> String {
    let spread: Vec<f64> = map
        .values
        .iter()
        .map(|&value| match map.scale {
            AxisScale::Linear => value,
            // Zero is below all that can be shown.
            AxisScale::Logarithmic if value >= 0.0 => value.max(1e-300).log10(),
            AxisScale::Logarithmic => f64::NAN,
        })
        .collect();
    let edges = [cell_edges(map.x.1), cell_edges(map.y.1)];
    let colours = ColourScale::robust(spread.iter().copied(), map.palette);
    let ([Some(columns), Some(rows)], Some(colours)) = (edges, colours) else {
        return no_data(map.title);
    };
    let colours = match map.scale {
        AxisScale::Linear => colours,
        AxisScale::Logarithmic => {
            let [low, high] = colours.limits();
            colours.with_limits([low.max(high - MOST_DECADES), high])
        }
    };
    if map.values.len() != map.x.1.len() * map.y.1.len() {
        return no_data(map.title);
    }
    let axis = |label: &str, edges: &[f64]| Axis::linear(label, [edges[0], edges[edges.len() - 1]]);
    let layout = ChartLayout {
        title: map.title,
        size: [440.0, 380.0],
        left: 58.0,
        x: axis(map.x.0, &columns),
        y: axis(map.y.0, &rows),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(map.title);
    };
    draw_cells(&mut chart, (&columns, &rows), &spread, &colours);
    let key = draw_lines(&mut chart, map.lines);
    chart.frame();
    let ends = [chart.plot()[0][0], chart.plot()[1][0]];
    let picture = chart.with_key(&key);
    let [width, height] = picture.size();
    let mut svg = Svg::new([width, TITLE_STRIP + height + BAR_STRIP], map.title);
    let style = TextStyle { size: 13.0, ..TextStyle::label(Anchor::Middle) };
    svg.text([(ends[0] + ends[1]) / 2.0, 14.0], map.title, style);
    svg.nest([0.0, TITLE_STRIP], &picture);
    let (ends, top) = ([ends[0] + 10.0, ends[1] - 10.0], TITLE_STRIP + height + 8.0);
    let bar = match map.scale {
        AxisScale::Linear => ColourBar::linear(ends, top, &colours, map.label),
        AxisScale::Logarithmic => {
            ColourBar { ends, top, ticks: powers(colours.limits()), label: map.label.to_owned() }
        }
    };
    bar.draw(&mut svg, &colours);
    svg.finish()
}

/// The edges of rectangles around increasing values, half way between neighbours; `None` unless they increase. A single value
/// gets a rectangle of its own size.
fn cell_edges(values: &[f64]) -> Option<Vec<f64>> {
    let (first, last) = (*values.first()?, *values.last()?);
    let rising = values.windows(2).all(|pair| pair[0] < pair[1]);
    if !rising || !first.is_finite() || !last.is_finite() {
        return None;
    }
    let alone = 0.05 * first.abs().max(1.0);
    let half = |a: Option<&f64>, b: Option<&f64>| match (a, b) {
        (Some(a), Some(b)) => 0.5 * (b - a),
        _ => alone,
    };
    let before = first - half(values.first(), values.get(1));
    let count = values.len();
    let after = last + half(count.checked_sub(2).and_then(|k| values.get(k)), values.last());
    let between = values.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    Some(std::iter::once(before).chain(between).chain(std::iter::once(after)).collect())
}

fn draw_cells(chart: &mut Chart, (columns, rows): (&[f64], &[f64]), values: &[f64], colours: &ColourScale) {
    let mut classes = vec![PathData::new(); ColourScale::LEVELS];
    let [mut missing, mut hatching] = [PathData::new(), PathData::new()];
    for (row, values) in values.chunks(columns.len() - 1).enumerate() {
        for (column, &value) in values.iter().enumerate() {
            let from = chart.to_pixel([columns[column], rows[row]]);
            let to = chart.to_pixel([columns[column + 1], rows[row + 1]]);
            match colours.level(value) {
                Some(level) => classes[level].rectangle(from, to),
                None => {
                    missing.rectangle(from, to);
                    hatch(&mut hatching, &[from, [to[0], from[1]], to, [from[0], to[1]]]);
                }
            }
        }
    }
    for (level, path) in classes.iter().enumerate() {
        let fill = colours.colour(level);
        // The outline hides the seams between the classes.
        chart.svg.path(path, &format!(r#"fill="{fill}" stroke="{fill}" stroke-width=".5""#));
    }
    chart.svg.path(&missing, r##"fill="#fff""##);
    chart.svg.path(&hatching, HATCH_STYLE);
}

/// Draws the lines that cross the map and returns their entries for the key.
fn draw_lines(chart: &mut Chart, lines: &[MapLine]) -> Vec<KeyEntry> {
    let mut key = Vec::new();
    for line in lines {
        if !line.points.windows(2).any(|ends| crosses(chart, [ends[0], ends[1]])) {
            continue;
        }
        let strokes = line.style.strokes();
        strokes.iter().for_each(|stroke| chart.clipped_curve(&line.points, stroke));
        key.push(KeyEntry::new(&line.label, |svg, [_, y]| {
            let [width, height] = svg.size();
            let [mut ground, mut sample] = [PathData::new(), PathData::new()];
            ground.rectangle([0.0, 0.0], [width, height]);
            sample.line(&[[2.0, y], [width - 2.0, y]]);
            svg.path(&ground, r##"fill="#8a9a9f""##);
            strokes.iter().for_each(|stroke| svg.path(&sample, &format!(r#"fill="none" {stroke}"#)));
        }));
    }
    key
}

/// Whether a straight piece has a part on the chart.
fn crosses(chart: &Chart, [from, to]: [[f64; 2]; 2]) -> bool {
    const PARTS: usize = 64;
    (0..=PARTS).any(|part| {
        let share = part as f64 / PARTS as f64;
        chart.contains([0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis])))
    })
}

/// Ticks of a bar whose colours are spread by logarithms.
fn powers([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let leads: &[f64] = if high - low < 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let powers = low.floor() as i32..=high.ceil() as i32;
    powers
        .flat_map(|power| leads.iter().map(move |lead| lead * 10f64.powi(power)))
        .filter(|value| (low..=high).contains(&value.log10()))
        .map(|value| (value.log10(), power_label(value)))
        .collect()
}

/// Colours of the rows of a diagram, dark to light, for charts beside it: viridis without its palest end.
#[must_use]
pub fn row_colours(rows: usize) -> Vec<String> {
    let Some(scale) = ColourScale::robust([0.0, 1.0], Palette::Sequential) else {
        return vec![INK.to_owned(); rows];
    };
    let most = 0.85 * (ColourScale::LEVELS - 1) as f64;
    (0..rows).map(|row| scale.colour((row as f64 / rows.max(2) as f64 * most) as usize)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_meet_half_way_between_values() {
        assert_eq!(cell_edges(&[1.0, 2.0, 4.0]).unwrap(), [0.5, 1.5, 3.0, 5.0]);
        assert_eq!(cell_edges(&[2.0]).unwrap().len(), 2);
        assert!(cell_edges(&[2.0, 1.0]).is_none() && cell_edges(&[]).is_none());
    }

    #[test]
    fn a_logarithmic_bar_has_powers_of_ten() {
        let labels = |limits| powers(limits).into_iter().map(|(_, text)| text);
        assert_eq!(labels([-3.0, 1.1]).collect::<Vec<_>>(), ["0.001", "0.01", "0.1", "1", "10"]);
        assert_eq!(labels([0.0, 0.8]).collect::<Vec<_>>(), ["1", "2", "5"]);
    }
}
