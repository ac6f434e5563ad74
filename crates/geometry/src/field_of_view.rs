//! Which cells of an open field can be trusted.
//!
//! A Delaunay triangle is *certain* if its circumdisk lies in the region where every cell would have been seen: no cell
//! that was not seen can lie in it, so the triangle is one of the whole tissue. A polygon is certain if all triangles of
//! its cell are, and a velocity, which depends on the polygons of the cell and of its neighbours, if they all are.

use crate::hull::Hull;
use crate::polygon::areas;
use crate::{Domain, Region, Tessellation, Vector, circumcentre};
use rayon::prelude::*;

/// Where every cell would have been seen, and what is taken for a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldOfView {
    /// The region where every cell would have been seen.
    pub seen: Seen,
    /// Circumdisks must stay so far from the border of the region, for errors of the positions: in multiples of the root of
    /// the median area.
    pub margin: f64,
    /// The same as a length: the larger of the two is in force.
    pub least_margin: f64,
    /// Multiple of the median area above which a polygon is taken for a hole in the data. It must not reach farther than a
    /// regular hexagon of that area either, and bays of the tissue are where disks as large as that hexagon fit in.
    pub largest_area: f64,
}

/// A region where every cell would have been seen.
#[derive(Debug, Clone, PartialEq)]
pub enum Seen {
    /// The hull of the cells of each frame: their convex hull without its bays. A bay is what large empty disks can sweep from
    /// outside, if one of them has its centre within the convex hull. So the roughness of a straight edge is no bay, and
    /// neither is a hole within the tissue.
    Hull,
    /// A part of the plane.
    Within(Region),
    /// Wherever there are cells: a polygon is certain if it is closed.
    Everywhere,
}

impl Default for FieldOfView {
    /// The hull of the cells, a margin of .05 roots of the median area, polygons up to three times the median area.
    fn default() -> Self {
        Self { seen: Seen::Hull, margin: 0.05, least_margin: 0.0, largest_area: 3.0 }
    }
}

impl FieldOfView {
    /// Trusts every closed polygon.
    pub fn everywhere() -> Self {
        Self { seen: Seen::Everywhere, margin: 0.0, least_margin: 0.0, largest_area: f64::INFINITY }
    }

    /// The same in a unit of length that is `1/factor` times as large.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let seen = match &self.seen {
            Seen::Within(region) => Seen::Within(region.scaled(factor)),
            other => other.clone(),
        };
        Self { seen, least_margin: self.least_margin * factor, ..*self }
    }

    /// The margin in force for cells of a size.
    pub fn margin_for(&self, size: f64) -> f64 {
        (self.margin * size).max(self.least_margin)
    }

    /// Judges every cell. Positions (N) in the unit of the region. In a periodic box all cells count.
    pub fn judge(&self, tessellation: &Tessellation, positions: &[Vector<f64>]) -> Certificate {
        let cells = positions.len();
        if matches!(tessellation.domain(), Domain::Periodic(_)) {
            return Certificate { visibility: vec![Visibility::Counted; cells], region: None };
        }
        let areas = areas(tessellation, positions);
        let mut closed: Vec<f64> = areas.iter().copied().filter(|a| a.is_finite()).collect();
        closed.sort_unstable_by(f64::total_cmp);
        let median = closed.get(closed.len() / 2).copied().unwrap_or(0.0);
        let limit = self.largest_area * median;
        // A regular hexagon with circumradius R has the area (3√3/2) R².
        let largest_radius = (limit / (1.5 * 3f64.sqrt())).sqrt();
        let (region, is_outside) = match &self.seen {
            Seen::Hull => {
                let hull = Hull::new(tessellation, positions, largest_radius);
                (Some(hull.region), hull.leaves_out)
            }
            Seen::Within(region) => {
                (Some(region.clone()), positions.iter().map(|r| !region.holds(*r)).collect())
            }
            Seen::Everywhere => (None, vec![false; cells]),
        };
        let margin = self.margin_for(median.sqrt());
        let of_triangles = |centre: Vector<f64>, radius: f64| {
            let stays = region.as_ref().is_none_or(|region| region.holds_disk(centre, radius + margin));
            match (stays, radius <= largest_radius) {
                (false, _) => Visibility::Unseen,
                (true, false) => Visibility::TooLarge,
                (true, true) => Visibility::Counted,
            }
        };
        let mut own = worst_of_triangles(tessellation, positions, of_triangles);
        for (cell, own) in own.iter_mut().enumerate() {
            if is_outside[cell] {
                *own = Visibility::Outside;
            } else if !tessellation.is_closed(cell) {
                *own = Visibility::NotClosed;
            } else if *own == Visibility::Counted && areas[cell] > limit {
                *own = Visibility::TooLarge;
            }
        }
        let is_certain = |cell: &u32| own[*cell as usize] == Visibility::Counted;
        let visibility = (0..cells)
            .map(|cell| match own[cell] {
                Visibility::Counted if !tessellation.neighbours(cell).iter().all(is_certain) => {
                    Visibility::NextToUncertain
                }
                other => other,
            })
            .collect();
        Certificate { visibility, region }
    }
}

/// For each cell, the worst that is said of the circumdisks of its triangles, given their centres and radii.
fn worst_of_triangles(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    judge: impl Fn(Vector<f64>, f64) -> Visibility + Sync,
) -> Vec<Visibility> {
    let triangles = tessellation.triangles();
    let judged: Vec<Visibility> = triangles
        .par_iter()
        .map(|triangle| {
            let [a, b, c] = triangle.cells.map(|cell| positions[cell as usize]);
            let centre = circumcentre(b - a, c - a);
            judge(a + centre, centre.norm())
        })
        .collect();
    let mut worst = vec![Visibility::Counted; positions.len()];
    for (triangle, judgement) in triangles.iter().zip(judged) {
        for &cell in &triangle.cells {
            worst[cell as usize] = judgement.max(worst[cell as usize]);
        }
    }
    worst
}

/// Why a cell counts or does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Visibility {
    /// The polygons of the cell and of all its neighbours are certain.
    Counted,
    /// The polygon is certain, but that of a neighbour is not.
    NextToUncertain,
    /// The polygon is larger than the stated multiple of the median area, or reaches farther than a regular hexagon of that
    /// size: a hole in the data.
    TooLarge,
    /// A cell that was not seen could change the polygon.
    Unseen,
    /// The cell is on the convex hull of the data: its polygon is not closed.
    NotClosed,
    /// The cell is outside the region.
    Outside,
}

/// What is known of a cell's mechanics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// Its polygon and those of its neighbours are those of the whole tissue.
    Certain,
    /// They could be others, if all cells had been seen.
    Uncertain,
    /// The cell is outside the field of view.
    Outside,
}

impl Visibility {
    /// The class of a cell.
    pub fn certainty(self) -> Certainty {
        match self {
            Self::Counted => Certainty::Certain,
            Self::Outside => Certainty::Outside,
            Self::NextToUncertain | Self::Unseen | Self::TooLarge | Self::NotClosed => Certainty::Uncertain,
        }
    }

    /// Whether the polygon of the cell is that of the whole tissue, whatever those of its neighbours are.
    pub fn has_certain_polygon(self) -> bool {
        matches!(self, Self::Counted | Self::NextToUncertain)
    }

    /// The same, or it is so large because a cell next to it was not detected.
    pub fn has_certain_polygon_or_hole(self) -> bool {
        self.has_certain_polygon() || self == Self::TooLarge
    }
}

/// The judgement on each cell of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    visibility: Vec<Visibility>,
    region: Option<Region>,
}

impl Certificate {
    /// The judgement on each cell.
    pub fn visibility(&self) -> &[Visibility] {
        &self.visibility
    }

    /// The judgement on each cell, and the region.
    pub fn into_parts(self) -> (Vec<Visibility>, Option<Region>) {
        (self.visibility, self.region)
    }

    /// Whether a cell counts.
    pub fn counts(&self, cell: usize) -> bool {
        self.visibility[cell] == Visibility::Counted
    }

    /// Where every cell would have been seen; `None` if that is everywhere.
    pub fn region(&self) -> Option<&Region> {
        self.region.as_ref()
    }
}
