//! Modes of a strip with ends: in the complex plane, and against the wave number along it.

use super::no_data;
use crate::chart::{Axis, AxisScale, Chart, ChartLayout};
use crate::colour::{BLUE, GREY, INK, VERMILLION};
use crate::key::KeyEntry;
use crate::markers::Marker;
use crate::svg::{PathData, Svg};
use crate::units::{Units, label_with_unit};

/// The end at which a mode is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StripSide {
    /// The left one.
    Left,
    /// The right one.
    Right,
    /// Neither: it fills the strip.
    Neither,
}

/// A mode of a strip as the figures show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripPoint {
    /// Real and imaginary part of its value.
    pub value: [f64; 2],
    /// Where it is.
    pub side: StripSide,
    /// Whether it is a mode of an edge.
    pub of_edge: bool,
}

/// How often the spectrum of the periodic tissue winds around points of a grid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WindingGrid {
    /// Real parts of the points.
    pub real: Vec<f64>,
    /// Imaginary parts.
    pub imaginary: Vec<f64>,
    /// The winding number of each, a row for each imaginary part.
    pub numbers: Vec<i32>,
}

/// What is drawn against the wave number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BandPart {
    /// The rate of growth.
    Rate,
    /// The angular frequency.
    Frequency,
}

/// The modes of a strip over the loops of the periodic tissue; shaded where these wind.
#[must_use]
pub fn strip_spectrum(
    points: &[StripPoint],
    loops: &[Vec<[f64; 2]>],
    grid: &WindingGrid,
    unit: &str,
) -> String {
    let title = "values of the strip and loops of the periodic tissue";
    let places = || points.iter().map(|point| point.value).chain(loops.iter().flatten().copied());
    let axis = |label: &str, which: usize| {
        Axis::holding(
            &label_with_unit(label, unit),
            AxisScale::Linear,
            places().map(move |value| value[which]),
        )
    };
    let axes = axis("rate of growth, Re λ", 0).zip(axis("angular frequency, Im λ", 1));
    let layout = axes.map(|(x, y)| ChartLayout { title, size: [520.0, 380.0], left: 66.0, x, y });
    let Some(mut chart) = layout.and_then(Chart::new) else {
        return no_data(title);
    };
    for (positive, style) in [(true, SHADES[0]), (false, SHADES[1])] {
        let area = shaded(&chart, grid, positive);
        chart.svg.path(&area, style);
    }
    for line in loops {
        chart.record("periodic", line.iter().copied());
        chart.clipped_curve(line, LOOP);
    }
    draw(&mut chart, points.iter().map(|point| (point.value, *point)));
    chart.frame();
    let mut key = vec![KeyEntry::line("periodic", LOOP)];
    key.extend(key_of(points.iter()));
    for (sign, style, label) in [(1, SHADES[0], "winds by +1"), (-1, SHADES[1], "winds by −1")] {
        if grid.numbers.iter().any(|number| number.signum() == sign) {
            key.push(KeyEntry::area(label, style));
        }
    }
    chart.finish_with_key(&key)
}

/// The modes of a strip at each wave number along it, over those of the periodic tissue. Rates are those of waves of no negative frequency:
/// those of the opposite one are the same, at the other end.
#[must_use]
pub fn strip_bands(
    wave_numbers: &[f64],
    modes: &[Vec<StripPoint>],
    periodic: &[Vec<[f64; 2]>],
    part: BandPart,
    units: &Units,
) -> String {
    let (title, label, which) = match part {
        BandPart::Rate => ("rates of the strip", "rate of growth, Re λ", 0),
        BandPart::Frequency => ("frequencies of the strip", "angular frequency, Im λ", 1),
    };
    let at = |q: f64, value: [f64; 2]| [q, value[which]];
    let bulk: Vec<[f64; 2]> = (wave_numbers.iter().zip(periodic))
        .flat_map(|(&q, values)| values.iter().map(move |&value| at(q, value)))
        .collect();
    let own: Vec<([f64; 2], StripPoint)> = (wave_numbers.iter().zip(modes))
        .flat_map(|(&q, points)| points.iter().map(move |&point| (at(q, point.value), point)))
        .filter(|(_, point)| part == BandPart::Frequency || point.value[1] > -ROUNDING)
        .collect();
    let all = || bulk.iter().copied().chain(own.iter().map(|(place, _)| *place));
    let axis = |label: &str, which: usize| {
        Axis::holding(label, AxisScale::Linear, all().map(move |place| place[which]))
    };
    let x = axis(&label_with_unit("wave number along the strip, q", &units.powers(-1, 0)), 0);
    let y = axis(&label_with_unit(label, &units.powers(0, -1)), 1);
    let layout = x.zip(y).map(|(x, y)| ChartLayout { title, size: [520.0, 380.0], left: 66.0, x, y });
    let Some(mut chart) = layout.and_then(Chart::new) else {
        return no_data(title);
    };
    chart.record("periodic", bulk.iter().copied());
    let mut dots = PathData::new();
    bulk.iter().for_each(|&place| dots.dot(chart.to_pixel(place)));
    chart.svg.path(&dots, BULK);
    draw(&mut chart, own.iter().copied());
    chart.frame();
    let mut key = vec![KeyEntry::new("periodic", |svg, middle| {
        let mut dot = PathData::new();
        dot.dot(middle);
        svg.path(&dot, BULK);
    })];
    key.extend(key_of(own.iter().map(|(_, point)| point)));
    chart.finish_with_key(&key)
}

/// Frequencies that are none.
const ROUNDING: f64 = 1e-9;

/// Where the spectrum winds to the left end, and where to the right.
const SHADES: [&str; 2] = [r##"fill="#d3e5f2""##, r##"fill="#fadfcc""##];
const LOOP: &str = r##"stroke="#8a8a8a" stroke-width="1.1" stroke-linejoin="round""##;
const BULK: &str = r##"fill="none" stroke="#d5d5d5" stroke-width="4.5" stroke-linecap="round""##;

/// Sides and edges in the order in which they are drawn.
const KINDS: [(StripSide, bool, &str); 6] = [
    (StripSide::Neither, false, "fills the strip"),
    (StripSide::Left, false, "piles up left"),
    (StripSide::Right, false, "piles up right"),
    (StripSide::Neither, true, "both edges"),
    (StripSide::Left, true, "left edge"),
    (StripSide::Right, true, "right edge"),
];

fn colour(side: StripSide) -> &'static str {
    match side {
        StripSide::Left => BLUE,
        StripSide::Right => VERMILLION,
        StripSide::Neither => GREY,
    }
}

fn draw(chart: &mut Chart, points: impl Iterator<Item = ([f64; 2], StripPoint)> + Clone) {
    for (side, of_edge, label) in KINDS {
        let own = points.clone().filter(|(_, point)| point.side == side && point.of_edge == of_edge);
        let places: Vec<[f64; 2]> = own.map(|(place, _)| place).collect();
        chart.record(label, places.iter().copied());
        let places: Vec<[f64; 2]> = places.into_iter().map(|place| chart.to_pixel(place)).collect();
        mark(&mut chart.svg, (side, of_edge), &places);
    }
}

fn mark(svg: &mut Svg, (side, of_edge): (StripSide, bool), places: &[[f64; 2]]) {
    let mut path = PathData::new();
    for &place in places {
        if of_edge {
            Marker::Diamond.push(&mut path, place, 2.4);
        } else {
            path.dot(place);
        }
    }
    let colour = colour(side);
    let style = if of_edge {
        format!(r#"fill="{colour}" stroke="{INK}" stroke-width=".7""#)
    } else {
        format!(r#"fill="none" stroke="{colour}" stroke-width="3.2" stroke-linecap="round""#)
    };
    svg.path(&path, &style);
}

fn key_of<'a>(points: impl Iterator<Item = &'a StripPoint> + Clone) -> Vec<KeyEntry> {
    let seen = |side: StripSide, of_edge: bool| {
        points.clone().any(|point| point.side == side && point.of_edge == of_edge)
    };
    (KINDS.into_iter().filter(|(side, of_edge, _)| seen(*side, *of_edge)))
        .map(|(side, of_edge, label)| {
            KeyEntry::new(label, |svg, middle| mark(svg, (side, of_edge), &[middle]))
        })
        .collect()
}

/// The parts of the plane around which the spectrum winds with a sign, as far as the grid tells; neighbours in a row are one rectangle.
fn shaded(chart: &Chart, grid: &WindingGrid, positive: bool) -> PathData {
    let mut area = PathData::new();
    let half = |values: &[f64]| match values {
        [first, second, ..] => 0.5 * (second - first),
        _ => 0.0,
    };
    let (wide, high) = (half(&grid.real), half(&grid.imaginary));
    for (row, &imaginary) in grid.imaginary.iter().enumerate() {
        let winds = |column: usize| {
            let number = grid.numbers.get(row * grid.real.len() + column).copied().unwrap_or(0);
            if positive { number > 0 } else { number < 0 }
        };
        let mut column = 0;
        while column < grid.real.len() {
            let first = column;
            while column < grid.real.len() && winds(column) {
                column += 1;
            }
            if column > first {
                let low = [grid.real[first] - wide, imaginary - high];
                let top = [grid.real[column - 1] + wide, imaginary + high];
                if chart.contains(low) && chart.contains(top) {
                    area.rectangle(chart.to_pixel(low), chart.to_pixel(top));
                }
            }
            column += 1;
        }
    }
    area
}
