//! Which cells of a tessellation can be trusted.

use crate::polygon::{areas, reaches};
use crate::{Tessellation, Vector};

/// Why a cell counts or does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Visibility {
    /// The cell's polygon and those of its neighbours are closed and of plausible size.
    Counted,
    /// The cell is on the convex hull of the data: its polygon is not closed.
    OnHull,
    /// The polygon is larger than the stated multiple of the median area, or reaches as far as a regular hexagon larger
    /// than that: a rim or a hole in the data.
    TooLarge,
    /// The cell itself is sound, but a neighbour is not.
    NextToRim,
}

/// The cells of an open field of view that count. In a periodic box all do.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldOfView {
    visibility: Vec<Visibility>,
}

impl FieldOfView {
    /// Judges every cell. `largest_area` is the multiple of the median area above which a polygon is taken for a rim or
    /// a hole; 3 is usual. Positions (N) in any unit.
    ///
    /// Cells at the rim can have closed polygons of usual size that are nevertheless wrong, because a neighbour was not
    /// seen. They give themselves away by vertices far outside: circumcentres of three cells along the rim. So a polygon
    /// must not reach farther than a regular hexagon of the largest area either.
    pub fn new(tessellation: &Tessellation, positions: &[Vector<f64>], largest_area: f64) -> Self {
        if matches!(tessellation.domain(), crate::Domain::Periodic(_)) {
            return Self { visibility: vec![Visibility::Counted; tessellation.len()] };
        }
        let areas = areas(tessellation, positions);
        let mut closed: Vec<f64> = areas.iter().copied().filter(|a| a.is_finite()).collect();
        closed.sort_unstable_by(f64::total_cmp);
        let limit = largest_area * closed.get(closed.len() / 2).copied().unwrap_or(0.0);
        // A regular hexagon with circumradius R has the area (3√3/2) R².
        let farthest = (limit / (1.5 * 3f64.sqrt())).sqrt();
        let reaches = reaches(tessellation, positions);
        let own: Vec<Visibility> = areas
            .iter()
            .zip(&reaches)
            .enumerate()
            .map(|(cell, (&area, &reach))| {
                if !tessellation.is_closed(cell) {
                    Visibility::OnHull
                } else if area <= limit && reach <= farthest {
                    Visibility::Counted
                } else {
                    Visibility::TooLarge
                }
            })
            .collect();
        let visibility = own
            .iter()
            .enumerate()
            .map(|(cell, &own_visibility)| {
                let neighbours_count =
                    tessellation.neighbours(cell).iter().all(|&j| own[j as usize] == Visibility::Counted);
                match own_visibility {
                    Visibility::Counted if !neighbours_count => Visibility::NextToRim,
                    other => other,
                }
            })
            .collect();
        Self { visibility }
    }

    /// The judgement on each cell.
    pub fn visibility(&self) -> &[Visibility] {
        &self.visibility
    }

    /// Whether a cell counts.
    pub fn counts(&self, cell: usize) -> bool {
        self.visibility[cell] == Visibility::Counted
    }
}
