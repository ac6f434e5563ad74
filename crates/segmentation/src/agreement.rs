//! How well the Voronoi polygons of the centroids stand for the true outlines.

use std::collections::BTreeSet;
use voronudge_geometry::{Certificate, Tessellation, Vector, areas, perimeters};

/// The true shape of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredShape {
    /// Its area.
    pub area: f64,
    /// Its perimeter.
    pub perimeter: f64,
}

/// Voronoi tessellation against true outlines, over the cells that count.
///
/// A contact is judged if at least one of its cells counts. Ratios are not finite where there is nothing to judge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Cells that count: polygon and neighbours closed and of plausible size, all their outlines seen as a whole.
    pub cells: usize,
    /// True contacts.
    pub true_contacts: usize,
    /// Contacts of the tessellation.
    pub voronoi_contacts: usize,
    /// Contacts in both.
    pub shared_contacts: usize,
    /// Pearson's correlation of the areas.
    pub area_correlation: f64,
    /// Pearson's correlation of the perimeters.
    pub perimeter_correlation: f64,
    /// Sum of Voronoi areas over the sum of true areas.
    pub area_ratio: f64,
    /// Sum of Voronoi perimeters over the sum of true perimeters.
    pub perimeter_ratio: f64,
}

impl Agreement {
    /// Share of the tessellation's contacts that are true.
    pub fn precision(&self) -> f64 {
        self.shared_contacts as f64 / self.voronoi_contacts as f64
    }

    /// Share of the true contacts that the tessellation has.
    pub fn recall(&self) -> f64 {
        self.shared_contacts as f64 / self.true_contacts as f64
    }
}

/// Compares the tessellation of centroids (N) with the shapes (N, `None` for a cell that is not seen as a whole) and contacts of
/// the true outlines, pairs of indices with the lower first.
pub fn agreement(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    view: &Certificate,
    shapes: &[Option<MeasuredShape>],
    contacts: &BTreeSet<[usize; 2]>,
) -> Agreement {
    let comparable = comparable(tessellation, view, shapes);
    let counts = |cell: usize| comparable[cell];
    let judged = |pair: &[usize; 2]| pair.iter().any(|&cell| counts(cell));
    let voronoi: BTreeSet<[usize; 2]> = tessellation
        .edges()
        .into_iter()
        .map(|(a, b, _)| [a.min(b) as usize, a.max(b) as usize])
        .filter(|pair| pair[0] != pair[1] && judged(pair))
        .collect();
    let (voronoi_areas, voronoi_perimeters) =
        (areas(tessellation, positions), perimeters(tessellation, positions));
    let pairs = |voronoi: &[f64], of: fn(&MeasuredShape) -> f64| -> Vec<[f64; 2]> {
        let cells = (0..shapes.len()).filter(|&cell| counts(cell));
        cells.filter_map(|cell| Some([of(shapes[cell].as_ref()?), voronoi[cell]])).collect()
    };
    let area_pairs = pairs(&voronoi_areas, |shape| shape.area);
    let perimeter_pairs = pairs(&voronoi_perimeters, |shape| shape.perimeter);
    let ratio = |pairs: &[[f64; 2]]| {
        pairs.iter().map(|pair| pair[1]).sum::<f64>() / pairs.iter().map(|pair| pair[0]).sum::<f64>()
    };
    Agreement {
        cells: area_pairs.len(),
        true_contacts: contacts.iter().filter(|pair| judged(pair)).count(),
        voronoi_contacts: voronoi.len(),
        shared_contacts: voronoi.intersection(contacts).count(),
        area_correlation: correlation(&area_pairs),
        perimeter_correlation: correlation(&perimeter_pairs),
        area_ratio: ratio(&area_pairs),
        perimeter_ratio: ratio(&perimeter_pairs),
    }
}

/// The cells whose Voronoi polygon can be compared: they count in the field of view, and they and their neighbours are seen as a whole.
/// The centroid of a cell that is cut off is not where it should be, which its neighbours feel.
pub fn comparable(
    tessellation: &Tessellation,
    view: &Certificate,
    shapes: &[Option<MeasuredShape>],
) -> Vec<bool> {
    let is_whole = |cell: usize| shapes[cell].is_some();
    let neighbours_whole =
        |cell: usize| tessellation.neighbours(cell).iter().all(|&other| is_whole(other as usize));
    (0..shapes.len()).map(|cell| view.counts(cell) && is_whole(cell) && neighbours_whole(cell)).collect()
}

/// Pearson's correlation; not finite where one of the two does not vary.
fn correlation(pairs: &[[f64; 2]]) -> f64 {
    let count = pairs.len() as f64;
    let mean = |axis: usize| pairs.iter().map(|pair| pair[axis]).sum::<f64>() / count;
    let means = [mean(0), mean(1)];
    let moment = |a: usize, b: usize| {
        pairs.iter().map(|pair| (pair[a] - means[a]) * (pair[b] - means[b])).sum::<f64>()
    };
    moment(0, 1) / (moment(0, 0) * moment(1, 1)).sqrt()
}
