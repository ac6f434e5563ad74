//! Errors of K_P α and of P_0 for each class of data, and how often the intervals cover.

use super::summary::{Errors, Summary};
use crate::study::seeds::quartiles;
use voronudge_report::chart::{Axis, Chart, ChartLayout};
use voronudge_report::colour::{BLUE, GREEN, INK};
use voronudge_report::figure::no_data;
use voronudge_report::numbers::quantile;
use voronudge_report::svg::{Anchor, PathData, Svg, TextStyle};

/// Height of the row of a class, and of the axis, in pixels.
const ROW: f64 = 26.0;
const AXIS: f64 = 54.0;
/// Width of the panels with errors, those with shares, and the names of the classes.
const WIDE: f64 = 250.0;
const NARROW: f64 = 130.0;
const NAMES: f64 = 132.0;
/// Share of the errors that an axis holds; those beyond are drawn at its edge. How far it reaches, in per cent, at least and at most.
const HELD: f64 = 0.98;
const LEAST_REACH: f64 = 0.5;
const MOST_REACH: f64 = 40.0;
/// What is wanted of the coverage.
const WANTED: [f64; 2] = [0.9, 0.98];

/// The figure, as SVG.
pub fn draw(summaries: &[Summary]) -> String {
    const TITLE: &str = "Errors and coverage on data as they are measured";
    let shown: Vec<&Summary> = summaries.iter().filter(|own| own.sets > own.failed).collect();
    if shown.is_empty() {
        return no_data(TITLE);
    }
    let height = AXIS + ROW * shown.len() as f64;
    let mut svg = Svg::new([NAMES + 2.0 * (WIDE + NARROW), height], TITLE);
    type Column = (&'static str, &'static str, fn(&Summary) -> &Errors);
    let columns: [Column; 2] = [("K_P α", BLUE, |own| &own.k_p_alpha), ("P_0", GREEN, |own| &own.p_0)];
    let mut left = NAMES;
    for (name, colour, errors) in columns {
        let rows: Vec<&Errors> = shown.iter().map(|own| errors(own)).collect();
        for (panel, width) in [
            (distributions(name, colour, &rows, height), WIDE),
            (coverage(name, colour, &rows, height), NARROW),
        ] {
            let Some(panel) = panel else { return no_data(TITLE) };
            if left == NAMES {
                label_rows(&mut svg, &panel, &shown);
            }
            svg.nest([left, 0.0], &panel.svg);
            left += width;
        }
    }
    svg.finish()
}

/// How far the axis of errors reaches, in per cent.
fn reach(rows: &[&Errors]) -> f64 {
    let sizes = rows.iter().flat_map(|own| &own.all).map(|error| 100.0 * error.abs());
    (1.1 * quantile(sizes, HELD).unwrap_or(0.0)).clamp(LEAST_REACH, MOST_REACH)
}

/// Errors in per cent: each set a dot, quartiles a box, the median a line.
fn distributions(name: &str, colour: &str, rows: &[&Errors], height: f64) -> Option<Chart> {
    let reach = reach(rows);
    let mut chart = panel(&format!("error of {name} (%)"), [-reach, reach], [WIDE, height], rows.len())?;
    let [_, vertical] = chart.axes();
    let ends = vertical.range;
    chart.curve(&[[0.0, ends[0]], [0.0, ends[1]]], &format!(r#"stroke="{INK}" stroke-width=".9""#));
    let (mut dots, mut boxes, mut medians) = (PathData::new(), PathData::new(), PathData::new());
    for (row, errors) in rows.iter().enumerate() {
        let place = |error: f64, offset: f64| {
            let [x, y] = chart.to_pixel([(100.0 * error).clamp(-reach, reach), -(row as f64)]);
            [x, y + offset]
        };
        let [low, median, high] = quartiles(errors.all.clone());
        boxes.rectangle(place(low, -7.0), place(high, 7.0));
        medians.line(&[place(median, -7.0), place(median, 7.0)]);
        // Dots that would cover each other stand above and below the middle of the row.
        for (index, error) in errors.all.iter().enumerate() {
            dots.dot(place(*error, [0.0, -3.0, 3.0][index % 3]));
        }
    }
    let svg = &mut chart.svg;
    svg.path(&boxes, &format!(r#"fill="{colour}" fill-opacity=".18" stroke="{colour}" stroke-width=".9""#));
    svg.path(
        &dots,
        &format!(
            r#"fill="none" stroke="{colour}" stroke-width="3" stroke-linecap="round" stroke-opacity=".55""#
        ),
    );
    svg.path(&medians, &format!(r#"fill="none" stroke="{INK}" stroke-width="2""#));
    chart.frame();
    Some(chart)
}

/// Shares of the sets whose interval holds the truth, with their intervals, over what is wanted.
fn coverage(name: &str, colour: &str, rows: &[&Errors], height: f64) -> Option<Chart> {
    let mut chart = panel(&format!("covers {name}"), [0.0, 1.0], [NARROW, height], rows.len())?;
    let ends = chart.axes()[1].range;
    let mut band = PathData::new();
    band.rectangle(chart.to_pixel([WANTED[0], ends[0]]), chart.to_pixel([WANTED[1], ends[1]]));
    let (mut bars, mut dots) = (PathData::new(), PathData::new());
    for (row, Errors { covered, .. }) in rows.iter().enumerate() {
        let place = |share: f64| chart.to_pixel([share, -(row as f64)]);
        let [low, high] = covered.interval();
        bars.line(&[place(low), place(high)]);
        dots.dot(place(covered.share()));
    }
    let svg = &mut chart.svg;
    svg.path(&band, r##"fill="#999" fill-opacity=".3""##);
    svg.path(&bars, &format!(r#"fill="none" stroke="{colour}" stroke-width="1.6""#));
    svg.path(&dots, &format!(r#"fill="none" stroke="{colour}" stroke-width="7" stroke-linecap="round""#));
    chart.frame();
    Some(chart)
}

/// Axes with a row for each class, the first one at the top.
fn panel(label: &str, range: [f64; 2], size: [f64; 2], rows: usize) -> Option<Chart> {
    let x = Axis { ticks: 4, ..Axis::linear(label, range) };
    let y = Axis::linear("", [0.5 - rows as f64, 0.5]).without_ticks();
    Chart::new(ChartLayout { title: label, size, left: 20.0, x, y })
}

/// The names of the classes beside their rows of a panel.
fn label_rows(svg: &mut Svg, panel: &Chart, shown: &[&Summary]) {
    for (row, own) in shown.iter().enumerate() {
        let [_, y] = panel.to_pixel([0.0, -(row as f64)]);
        svg.text([NAMES + 12.0, y + 4.0], own.class.name, TextStyle::label(Anchor::End));
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::{Estimate, Fit, Record};
    use super::*;
    use claims::measured::CLASSES;

    #[test]
    fn every_class_with_fits_has_a_row() {
        let estimate = |value: f64| Estimate { truth: 2.0, value, ci95: [Some(value - 0.3), None] };
        let record = |value: f64| Record {
            class: "open".into(),
            seed: 1,
            program: String::new(),
            flags: String::new(),
            cells: 9,
            seconds: 1.0,
            fit: Some(Fit {
                k_p_alpha: estimate(value),
                p_0: estimate(value),
                trustworthy: true,
                doubts: Vec::new(),
                verdict: None,
                recall: None,
                activity: None,
            }),
            message: String::new(),
            discovery: None,
        };
        let summaries = [
            Summary::of(&CLASSES[0], &[record(2.0), record(1.0), record(9.0)]),
            Summary::of(&CLASSES[1], &[record(2.5)]),
            Summary::of(&CLASSES[2], &[]),
        ];
        let svg = draw(&summaries);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
        assert!(texts.contains(&"complete") && texts.contains(&"open") && !texts.contains(&"missed-2"));
        let errors: Vec<&Errors> = summaries.iter().map(|own| &own.k_p_alpha).collect();
        assert!((reach(&errors[1..2]) - 27.5).abs() < 1e-9 && reach(&errors) == MOST_REACH);
        assert!(draw(&summaries[2..]).contains("no data"));
    }
}
