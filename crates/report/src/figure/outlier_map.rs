//! Cells whose position or velocity looks like a mistake of segmentation or tracking.

use super::no_data;
use crate::colour::{BLUE, GREEN, INK, VERMILLION};
use crate::map::{Legend, Map};
use crate::markers::Marker;
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::Units;
use crate::view::FrameView;

/// Size of a mark in pixels.
const MARK: f64 = 4.2;

/// What may have happened to a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Suspicion {
    /// Two cells may have been taken for one.
    Merged,
    /// One cell may have been taken for two.
    Split,
    /// The track may have jumped to another cell.
    MisTracked,
}

impl Suspicion {
    const ALL: [Self; 3] = [Self::Merged, Self::Split, Self::MisTracked];

    fn name(self) -> &'static str {
        match self {
            Self::Merged => "merged",
            Self::Split => "split",
            Self::MisTracked => "mis-tracked",
        }
    }

    fn look(self) -> (Marker, &'static str) {
        match self {
            Self::Merged => (Marker::Triangle, VERMILLION),
            Self::Split => (Marker::Square, BLUE),
            Self::MisTracked => (Marker::Diamond, GREEN),
        }
    }
}

/// One suspicious cell of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outlier {
    /// Index of the cell in the frame.
    pub cell: usize,
    /// What may have happened to it.
    pub suspicion: Suspicion,
}

/// Cells that may be merged, split or mis-tracked, marked and tinted over faint cell outlines, with
/// their numbers.
#[must_use]
pub fn outlier_map(frame: &FrameView, outliers: &[Outlier], units: &Units) -> String {
    let title = "cells that may be merged, split or mis-tracked";
    let Some(mut map) = Map::new(frame, title) else {
        return no_data(title);
    };
    map.outlines(frame);
    let mut counts = [0; 3];
    for (suspicion, count) in Suspicion::ALL.into_iter().zip(&mut counts) {
        let [mut tint, mut marks] = [PathData::new(), PathData::new()];
        let cells = outliers.iter().filter(|outlier| outlier.suspicion == suspicion);
        for cell in cells.filter_map(|outlier| frame.cells.get(outlier.cell)) {
            if let Some(polygon) = map.view.polygon(cell) {
                tint.polygon(&polygon);
            }
            suspicion.look().0.push(&mut marks, map.view.to_pixel(cell.centre), MARK);
            *count += 1;
        }
        let colour = suspicion.look().1;
        map.layer.path(&tint, &format!(r#"fill="{colour}" fill-opacity=".3" stroke="{colour}""#));
        map.layer.path(&marks, &mark_style(colour));
    }
    let mut legend = map.with_legend(48.0);
    legend.scale_bar(units);
    legend.left_out(4.0, frame);
    entries(&mut legend, counts);
    legend.svg.finish()
}

fn mark_style(colour: &str) -> String {
    format!(r#"fill="{colour}" stroke="{INK}" stroke-width=".6""#)
}

fn entries(legend: &mut Legend, counts: [usize; 3]) {
    let places = [[122.0, 37.5], [202.0, 37.5], [266.0, 37.5]];
    for ((suspicion, count), [x, down]) in Suspicion::ALL.into_iter().zip(counts).zip(places) {
        let y = legend.top + down;
        let (marker, colour) = suspicion.look();
        let mut mark = PathData::new();
        marker.push(&mut mark, [x, y], MARK);
        legend.svg.path(&mark, &mark_style(colour));
        let label = format!("{} ({count})", suspicion.name());
        legend.svg.text([x + 9.0, y + 4.0], &label, TextStyle::quiet(Anchor::Start));
    }
}
