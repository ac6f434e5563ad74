//! The fitted displacements of the cell centres, magnified, and the contacts they changed.

use super::no_data;
use crate::arrows::{ArrowScale, Arrows, ReferenceMark};
use crate::colour::{BLUE, INK, VERMILLION};
use crate::map::{Legend, Map};
use crate::numbers::significant;
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::Units;
use crate::view::{FrameView, Segment};

const LOST: &str = r#"stroke-width="2.4" stroke-linecap="round" stroke-dasharray="4 3.5""#;
const GAINED: &str = r#"stroke-width="2.4" stroke-linecap="round""#;

/// Nudges as magnified arrows over faint cell outlines, with the magnification, a reference arrow,
/// and the contacts between neighbours that the nudges removed (dashed) and made (solid).
/// Without a `scale` (no cell nudged) the map has no arrows and says so.
#[must_use]
pub fn nudge_map(frame: &FrameView, scale: Option<&ArrowScale>, units: &Units) -> String {
    let Some(mut map) = Map::new(frame, "nudges") else {
        return no_data("nudges");
    };
    map.outlines(frame);
    let edges = &frame.changed_edges;
    draw_edges(&mut map, &edges.lost, (VERMILLION, LOST));
    draw_edges(&mut map, &edges.gained, (BLUE, GAINED));
    if let Some(scale) = scale {
        let mut arrows = Arrows::default();
        for cell in &frame.cells {
            arrows.push_on(&map.view, cell.centre, cell.nudge, scale);
        }
        arrows.draw(&mut map.layer, INK);
    }
    let mut legend = map.with_legend(48.0);
    legend.scale_bar(units);
    match scale {
        Some(scale) => {
            let remark = format!(", nudges drawn ×{}", significant(scale.stretch, 1));
            let unit = units.length_text();
            let mark = ReferenceMark { unit: &unit, remark: &remark, colour: INK };
            legend.reference_arrow(160.0, scale, &mark);
        }
        None => {
            let at = [160.0, legend.top + 19.0];
            legend.svg.text(at, "no cell is nudged", TextStyle::quiet(Anchor::Start));
        }
    }
    legend.left_out(4.0, frame);
    if !edges.lost.is_empty() || !edges.gained.is_empty() {
        let lost = format!("contacts lost ({})", edges.lost.len());
        edge_entry(&mut legend, 122.0, (&lost, VERMILLION, LOST));
        let gained = format!("gained ({})", edges.gained.len());
        edge_entry(&mut legend, 278.0, (&gained, BLUE, GAINED));
    }
    legend.svg.finish()
}

fn draw_edges(map: &mut Map, edges: &[Segment], (colour, style): (&str, &str)) {
    let mut path = PathData::new();
    for edge in edges {
        path.line(&edge.map(|end| map.view.to_pixel(end)));
    }
    map.layer.path(&path, &format!(r#"fill="none" stroke="{colour}" opacity=".8" {style}"#));
}

fn edge_entry(legend: &mut Legend, x: f64, (label, colour, style): (&str, &str, &str)) {
    let y = legend.top + 37.5;
    let mut line = PathData::new();
    line.line(&[[x, y], [x + 18.0, y]]);
    legend.svg.path(&line, &format!(r#"fill="none" stroke="{colour}" opacity=".8" {style}"#));
    legend.svg.text([x + 25.0, y + 4.0], label, TextStyle::quiet(Anchor::Start));
}
