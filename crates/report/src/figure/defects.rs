//! Half-integer defects of the shapes of cells: where they are, and what cells do around them.

use super::no_data;
use crate::arrows::{ArrowScale, Arrows, ReferenceMark};
use crate::colour::{BLUE, ColourScale, INK, Palette, VERMILLION};
use crate::colour_bar::ColourBar;
use crate::map::{MAP_WIDTH, Map, Viewport};
use crate::markers::Marker;
use crate::numbers::quantile;
use crate::svg::{Anchor, PathData, Svg, TextStyle};
use crate::units::{Units, label_with_unit};
use crate::view::{FrameView, is_finite, length};
use std::f64::consts::TAU;

/// Length of the line of a long cell, in cell spacings.
const LINE: f64 = 0.8;
/// Radius of a defect and reach of its arms, in pixels.
const RADIUS: f64 = 3.6;
const REACH: f64 = 11.0;

/// A half-integer defect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DefectMark {
    /// Where.
    pub place: [f64; 2],
    /// Whether its charge is +½ or −½.
    pub is_plus: bool,
    /// Direction of the head of the comet or of one of three arms, in radians, y up.
    pub direction: f64,
}

/// The long axes of cells, from their shape tensors `[Q_xx, Q_xy]`, over faint outlines, with defects: +½ vermillion discs with a line to the head of the comet,
/// −½ blue triangles with three arms.
#[must_use]
pub fn defect_map(frame: &FrameView, shapes: &[[f64; 2]], defects: &[DefectMark], units: &Units) -> String {
    let title = "long axes of cells, and defects";
    let Some(mut map) = Map::new(frame, title) else { return no_data(title) };
    map.outlines(frame);
    let usual = quantile(shapes.iter().filter(|own| is_finite(**own)).map(|own| length(*own)), 0.95);
    let mut lines = PathData::new();
    for (cell, &[x, y]) in frame.cells.iter().zip(shapes) {
        let (size, angle) = (length([x, y]) / usual.unwrap_or(1.0), 0.5 * y.atan2(x));
        let half = 0.5 * LINE * size.min(1.5) * map.view.spacing();
        if half.is_finite() {
            let end = |sign: f64| {
                [0, 1].map(|axis| cell.centre[axis] + sign * half * [angle.cos(), angle.sin()][axis])
            };
            lines.line(&[map.view.to_pixel(end(-1.0)), map.view.to_pixel(end(1.0))]);
        }
    }
    map.layer.path(&lines, &format!(r#"fill="none" stroke="{INK}" stroke-width="1.1""#));
    for defect in defects {
        draw(&mut map.layer, map.view.to_pixel(defect.place), defect);
    }
    let mut legend = map.with_legend(54.0);
    legend.scale_bar(units);
    let y = legend.top + 36.0;
    for (x, is_plus, label) in [(16.0, true, "+½, line to the head"), (200.0, false, "−½, three arms")] {
        draw(&mut legend.svg, [x, y], &DefectMark { place: [0.0; 2], is_plus, direction: 0.0 });
        legend.svg.text([x + 18.0, y + 4.0], label, TextStyle::label(Anchor::Start));
    }
    legend.svg.finish()
}

fn draw(svg: &mut Svg, [x, y]: [f64; 2], defect: &DefectMark) {
    let (colour, marker, arms) = match defect.is_plus {
        true => (VERMILLION, Marker::Circle, 1),
        false => (BLUE, Marker::Triangle, 3),
    };
    let [mut lines, mut mark] = [PathData::new(), PathData::new()];
    for arm in 0..arms {
        let angle = defect.direction + TAU * f64::from(arm) / f64::from(arms);
        lines.line(&[[x, y], [x + REACH * angle.cos(), y - REACH * angle.sin()]]);
    }
    marker.push(&mut mark, [x, y], RADIUS);
    svg.path(&lines, &format!(r#"fill="none" stroke="{colour}" stroke-width="2.2" stroke-linecap="round""#));
    svg.path(&mark, &format!(r#"fill="{colour}" stroke="white" stroke-width=".8""#));
}

/// Mean values on squares around defects that all point to the right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AroundDefects<'a> {
    /// Whether these are of +½ or of −½.
    pub is_plus: bool,
    /// Side of a square.
    pub square: f64,
    /// Squares along each axis; the middle one is around the defect.
    pub squares: usize,
    /// Velocities, row after row from below.
    pub velocities: &'a [Option<[f64; 2]>],
    /// Half the trace of the stress, if it is known.
    pub tension: Option<&'a [f64]>,
}

/// Velocities around a defect as arrows, over the isotropic stress in colours where it is known.
#[must_use]
pub fn around_defects(around: &AroundDefects<'_>, units: &Units) -> String {
    let title = if around.is_plus { "around +½ defects" } else { "around −½ defects" };
    let half = 0.5 * around.squares as f64 * around.square;
    let place = |point: usize| {
        [point % around.squares, point / around.squares].map(|k| (k as f64 + 0.5) * around.square - half)
    };
    let frame = FrameView { label: "on average".into(), ..FrameView::default() };
    let speeds = || around.velocities.iter().flatten().map(|v| length(*v));
    let scale = ArrowScale::of_speeds(speeds(), std::iter::empty(), around.square);
    let centres: Vec<[f64; 2]> = (0..around.velocities.len()).map(place).collect();
    let (Some(view), Some(scale)) = (Viewport::around_with(&frame, &centres), scale) else {
        return no_data(title);
    };
    let mut map = Map::with_view(view, &frame, title);
    let colours =
        around.tension.and_then(|all| ColourScale::robust(all.iter().copied(), Palette::Sequential));
    if let (Some(all), Some(colours)) = (around.tension, &colours) {
        for (point, value) in all.iter().enumerate() {
            if let Some(level) = colours.level(*value) {
                let corner = |sign: f64| view.to_pixel(place(point).map(|x| x + 0.5 * sign * around.square));
                let mut square = PathData::new();
                square.rectangle(corner(-1.0), corner(1.0));
                let colour = colours.colour(level);
                map.layer.path(&square, &format!(r#"fill="{colour}" fill-opacity=".55" stroke="none""#));
            }
        }
    }
    draw(
        &mut map.layer,
        view.to_pixel([0.0; 2]),
        &DefectMark { place: [0.0; 2], is_plus: around.is_plus, direction: 0.0 },
    );
    let mut arrows = Arrows::default();
    for (point, velocity) in around.velocities.iter().enumerate() {
        if let Some(velocity) = velocity {
            arrows.push_on(&view, place(point), *velocity, &scale);
        }
    }
    arrows.draw(&mut map.layer, INK);
    let mut legend = map.with_legend(if colours.is_some() { 82.0 } else { 30.0 });
    legend.scale_bar(units);
    let unit = units.velocity_text();
    legend.reference_arrow(MAP_WIDTH / 2.0, &scale, &ReferenceMark { unit: &unit, remark: "", colour: INK });
    if let Some(colours) = &colours {
        let label = label_with_unit("tension, half the trace of the stress", &units.powers(0, -1));
        let bar = ColourBar::linear([16.0, MAP_WIDTH - 16.0], legend.top + 36.0, colours, &label);
        bar.draw(&mut legend.svg, colours);
    }
    legend.svg.finish()
}
