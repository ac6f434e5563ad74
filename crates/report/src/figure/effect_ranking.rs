//! The sizes of all candidate effects against their detection limits.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, GREEN, INK};
use crate::discover_report::{CandidateStatus, RankedEffect};
use crate::key::KeyEntry;
use crate::map::hatch;
use crate::numbers::quantile;
use crate::svg::{Anchor, PathData, Svg, TextStyle};

/// Height of a bar's row in pixels.
const ROW: f64 = 21.0;
/// The mark of a detection limit.
const LIMIT: &str = r##"fill="none" stroke="#d55e00" stroke-width="2.4""##;

/// Horizontal bars of the estimated size of each effect (rms, in percent of the velocity) with its
/// interval and a mark at its detection limit. Selected effects are blue, those that cannot be told
/// from them hatched, those below their limit light grey.
#[must_use]
pub fn effect_ranking(ranking: &[RankedEffect]) -> String {
    let title = "candidate effects and their detection limits";
    let Some(end) = axis_end(ranking) else {
        return no_data(title);
    };
    let count = ranking.len() as f64;
    let layout = ChartLayout {
        title,
        size: [620.0, 60.0 + ROW * count],
        left: 176.0,
        x: Axis::linear("size of the effect (rms, % of the velocity)", [0.0, end]),
        y: Axis::linear("", [0.0, count]).without_ticks(),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    for (row, effect) in ranking.iter().enumerate() {
        chart.record(&effect.effect, [[effect.size, f64::NAN]]);
        for (end, name) in effect.size_ci95.into_iter().flatten().zip(["lower", "upper"]) {
            chart.record(&format!("{}, {name} end of the 95 % interval", effect.effect), [[end, f64::NAN]]);
        }
        chart.record(&format!("{}, detection limit", effect.effect), [[effect.detection_limit, f64::NAN]]);
        draw_row(&mut chart, effect, (count - row as f64 - 0.5, end));
    }
    chart.finish_with_key(&key(ranking))
}

/// Room for every size and nearly every limit.
fn axis_end(ranking: &[RankedEffect]) -> Option<f64> {
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let sizes = ranking.iter().flat_map(|effect| {
        let upper = effect.size_ci95.filter(|_| effect.status == CandidateStatus::Selected);
        [finite(effect.size), upper.and_then(|ends| finite(ends[1]))]
    });
    let largest = sizes.flatten().fold(0.0, f64::max);
    let limits = quantile(ranking.iter().map(|effect| effect.detection_limit), 0.85).unwrap_or(0.0);
    Some(1.12 * largest.max(limits)).filter(|end| *end > 0.0)
}

fn draw_row(chart: &mut Chart, effect: &RankedEffect, (middle, end): (f64, f64)) {
    let y = chart.to_pixel([0.0, middle])[1];
    let left = chart.plot()[0][0];
    let name = effect.effect.replace('_', " ");
    let colour = if effect.status == CandidateStatus::Selected { INK } else { "#555" };
    chart.svg.text([left - 9.0, y + 4.0], &name, TextStyle { colour, ..TextStyle::label(Anchor::End) });
    let reach = effect.size.clamp(0.0, end);
    let look = Look::of(effect);
    let is_drawn = look != Look::NotTestable;
    if is_drawn {
        let [from, to] = [chart.to_pixel([0.0, middle + 0.34]), chart.to_pixel([reach, middle - 0.34])];
        look.fill(&mut chart.svg, [from, to]);
        draw_interval(chart, effect, (middle, end));
    }
    let limit = effect.detection_limit;
    let mut mark = PathData::new();
    mark.line(
        &[[limit.min(end), middle + 0.42], [limit.min(end), middle - 0.42]].map(|at| chart.to_pixel(at)),
    );
    let mut remarks = Vec::new();
    if limit <= end {
        chart.svg.path(&mark, LIMIT);
    } else if limit.is_finite() {
        remarks.push("limit beyond ▸");
    }
    match effect.status {
        CandidateStatus::Measurement => remarks.push("measurement: all fits know of it"),
        CandidateStatus::Alias => remarks.push("alias"),
        CandidateStatus::NotTestable => remarks.push("not testable"),
        CandidateStatus::Selected | CandidateStatus::BelowThreshold | CandidateStatus::Description => {}
    }
    let ends = interval(effect, end).filter(|_| is_drawn);
    let far = [
        if is_drawn { reach } else { 0.0 },
        if limit <= end { limit } else { 0.0 },
        ends.map_or(0.0, |ends| ends[1]),
    ];
    let far = far.into_iter().filter(|value| value.is_finite()).fold(0.0, f64::max);
    let [x, y] = [chart.to_pixel([far, middle])[0] + 8.0, y + 4.0];
    chart.svg.text([x, y], &remarks.join(", "), TextStyle { size: 10.5, ..TextStyle::quiet(Anchor::Start) });
}

/// The interval of the size as far as the axis shows it.
fn interval(effect: &RankedEffect, end: f64) -> Option<[f64; 2]> {
    let ends = effect.size_ci95.filter(|ends| ends.iter().all(|end| end.is_finite()))?;
    Some(ends.map(|value| value.clamp(0.0, end)))
}

fn draw_interval(chart: &mut Chart, effect: &RankedEffect, (middle, end): (f64, f64)) {
    let Some(ends) = interval(effect, end) else {
        return;
    };
    let places = ends.map(|value| chart.to_pixel([value, middle]));
    let mut line = PathData::new();
    line.line(&places);
    for [x, y] in places {
        line.line(&[[x, y - 3.0], [x, y + 3.0]]);
    }
    chart.svg.path(&line, &format!(r#"fill="none" stroke="{INK}" stroke-width="1.3""#));
}

/// How a bar looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Look {
    Selected,
    Alias,
    NotTaken,
    BelowLimit,
    Description,
    NotTestable,
}

impl Look {
    const KEY: [(Self, &'static str); 5] = [
        (Self::Selected, "selected"),
        (Self::Alias, "alias: cannot be told from a selected one"),
        (Self::NotTaken, "above its limit, not taken"),
        (Self::BelowLimit, "below its limit"),
        (Self::Description, "description, no mechanism"),
    ];

    fn of(effect: &RankedEffect) -> Self {
        match effect.status {
            CandidateStatus::Selected => Self::Selected,
            CandidateStatus::Alias => Self::Alias,
            CandidateStatus::Description => Self::Description,
            CandidateStatus::NotTestable | CandidateStatus::Measurement => Self::NotTestable,
            CandidateStatus::BelowThreshold if effect.size >= effect.detection_limit => Self::NotTaken,
            CandidateStatus::BelowThreshold => Self::BelowLimit,
        }
    }

    /// Fills a rectangle given by two opposite corners in pixels.
    fn fill(self, svg: &mut Svg, [from, to]: [[f64; 2]; 2]) {
        let [fill, stroke] = match self {
            Self::Selected => [BLUE, BLUE],
            Self::Alias => ["#fff", BLUE],
            Self::NotTaken => ["#8f989f", "#8f989f"],
            Self::BelowLimit => ["#dadfe3", "#dadfe3"],
            Self::Description | Self::NotTestable => ["#fff", GREEN],
        };
        let mut area = PathData::new();
        area.rectangle(from, to);
        svg.path(&area, &format!(r#"fill="{fill}" stroke="{stroke}" stroke-width="1.1""#));
        if self == Self::Alias {
            let mut lines = PathData::new();
            hatch(&mut lines, &[from, [to[0], from[1]], to, [from[0], to[1]]]);
            svg.path(&lines, &format!(r#"fill="none" stroke="{BLUE}" stroke-width="1.1""#));
        }
    }
}

/// The looks that occur, and the mark of the limit.
fn key(ranking: &[RankedEffect]) -> Vec<KeyEntry> {
    let occurs = |look: Look| ranking.iter().any(|effect| Look::of(effect) == look);
    let looks = Look::KEY.into_iter().filter(|&(look, _)| occurs(look));
    let mut key: Vec<KeyEntry> = looks
        .map(|(look, name)| KeyEntry::new(name, |svg, _| look.fill(svg, [[1.0, 1.5], [25.0, 12.5]])))
        .collect();
    key.push(KeyEntry::new("detection limit", |svg, [x, _]| {
        let mut mark = PathData::new();
        mark.line(&[[x, 0.5], [x, 13.5]]);
        svg.path(&mark, LIMIT);
    }));
    if ranking.iter().any(|effect| effect.size_ci95.is_some()) {
        let style = format!(r#"stroke="{INK}" stroke-width="1.3""#);
        key.push(KeyEntry::line("95 % interval", &style));
    }
    key
}
