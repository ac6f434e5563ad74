//! Maxima and minima of a field on the pixels of an image.

use crate::Error;
use crate::raster::{Edge, smooth};
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// Which extrema are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExtremumKind {
    /// Places higher than all around.
    Maximum,
    /// Places lower than all around.
    Minimum,
}

/// What counts as an extremum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtremumSearch {
    /// Which.
    pub kind: ExtremumKind,
    /// Standard deviation in pixels of the Gaussian average that is taken first; 0 for none.
    pub smoothing: f64,
    /// The least prominence: how far one must go down from a maximum to get to a higher one.
    pub prominence: f64,
    /// The least distance in pixels; of two that are nearer the more prominent is kept.
    pub distance: f64,
    /// What is beyond the border.
    pub edge: Edge,
}

/// A maximum or a minimum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// Its place in pixels; the centre of pixel (row, column) is (column + ½, row + ½).
    pub position: Vector<f64>,
    /// The smoothed field there.
    pub value: f64,
    /// Its prominence. That of the highest maximum is its height above the lowest pixel.
    pub prominence: f64,
}

/// The extrema of a field, row after row, the most prominent first.
///
/// Pixels are added from the highest down. A maximum begins where a pixel has no higher neighbour, and ends where its surroundings
/// meet those of a higher one; the way down to there is its prominence. Pixels of equal height that touch are one plateau. At a
/// single pixel the place is refined by the quadratic through the surrounding nine, by least squares, up to one pixel away; that of
/// a plateau is the mean of its pixels. At an open edge maxima on the outermost pixels are left out: whether they are any is not seen.
///
/// # Errors
/// [`Error::Raster`] if there is not one value for each pixel.
///
/// ```
/// use voronudge_segmentation::{Edge, ExtremumKind, ExtremumSearch, extrema};
/// let search = ExtremumSearch {
///     kind: ExtremumKind::Maximum, smoothing: 0.0, prominence: 0.1, distance: 0.0, edge: Edge::Open,
/// };
/// let bump = |k: usize| (-0.02 * ((k % 30) as f64 - 11.8).powi(2) - 0.02 * ((k / 30) as f64 - 16.3).powi(2)).exp();
/// let found = extrema(&(0..900).map(bump).collect::<Vec<_>>(), [30, 30], &search)?;
/// assert_eq!(found.len(), 1);
/// assert!((found[0].position.x - 12.3).abs() < 0.01 && (found[0].position.y - 16.8).abs() < 0.01);
/// # Ok::<(), voronudge_segmentation::Error>(())
/// ```
pub fn extrema(values: &[f64], size: [usize; 2], search: &ExtremumSearch) -> Result<Vec<Extremum>, Error> {
    let sign = match search.kind {
        ExtremumKind::Maximum => 1.0,
        ExtremumKind::Minimum => -1.0,
    };
    let mut heights = smooth(values, size, search.smoothing, search.edge)?;
    heights.iter_mut().for_each(|height| *height *= sign);
    let [low, high] = [f64::min, f64::max].map(|which| heights.iter().copied().reduce(which).unwrap_or(0.0));
    // No maximum stands out by more than the whole field does.
    if high - low < search.prominence {
        return Ok(Vec::new());
    }
    let field = Heights { heights, size, edge: search.edge };
    let mut peaks = field.peaks();
    peaks.retain(|peak| peak.prominence >= search.prominence && !field.is_at_edge(peak));
    peaks.sort_by(|a, b| b.prominence.total_cmp(&a.prominence).then(a.pixel.cmp(&b.pixel)));
    let mut kept: Vec<Extremum> = Vec::new();
    for peak in peaks {
        let extremum = Extremum {
            position: field.location(&peak),
            value: sign * field.heights[peak.pixel],
            prominence: peak.prominence,
        };
        let is_far =
            |other: &Extremum| field.shortest(other.position - extremum.position).norm() >= search.distance;
        if kept.iter().all(is_far) {
            kept.push(extremum);
        }
    }
    Ok(kept)
}

struct Heights {
    heights: Vec<f64>,
    size: [usize; 2],
    edge: Edge,
}

/// A maximum: its first pixel, the pixels of its plateau summed up, and its prominence.
struct Peak {
    pixel: usize,
    pixels: f64,
    /// Sum of the places of the pixels of the plateau, relative to the first.
    offset: Vector<f64>,
    at_edge: bool,
    prominence: f64,
}

/// Not yet reached from above.
const NONE: usize = usize::MAX;

impl Heights {
    /// Every maximum with its prominence, by the union of what lies above a level that sinks.
    fn peaks(&self) -> Vec<Peak> {
        let mut order: Vec<usize> = (0..self.heights.len()).collect();
        // The tie is broken, so the order is the same however it is found.
        order.par_sort_unstable_by(|&a, &b| self.heights[b].total_cmp(&self.heights[a]).then(a.cmp(&b)));
        let lowest = order.last().map_or(0.0, |&pixel| self.heights[pixel]);
        let mut peaks: Vec<Peak> = Vec::new();
        let mut summit_of = vec![NONE; self.heights.len()];
        // Each summit points to the higher one that it has been joined to, or to itself.
        let mut joined: Vec<usize> = Vec::new();
        fn root(joined: &mut [usize], mut summit: usize) -> usize {
            while joined[summit] != summit {
                joined[summit] = joined[joined[summit]];
                summit = joined[summit];
            }
            summit
        }
        let mut plateau = Vec::new();
        for &first in &order {
            if summit_of[first] != NONE {
                continue;
            }
            // All pixels of this height that touch, and the summits that they touch.
            let height = self.heights[first];
            plateau.clear();
            plateau.push(first);
            let mut touched: Vec<usize> = Vec::new();
            let own = peaks.len();
            summit_of[first] = own;
            let mut next = 0;
            while next < plateau.len() {
                for neighbour in self.around(plateau[next]).into_iter().flatten() {
                    if summit_of[neighbour] == NONE && self.heights[neighbour] == height {
                        summit_of[neighbour] = own;
                        plateau.push(neighbour);
                    } else if summit_of[neighbour] != NONE && summit_of[neighbour] != own {
                        touched.push(root(&mut joined, summit_of[neighbour]));
                    }
                }
                next += 1;
            }
            touched.sort_unstable();
            touched.dedup();
            // Summits are numbered from the highest down, so the lowest number stays.
            let Some((&highest, lower)) = touched.split_first() else {
                peaks.push(self.peak(&plateau, height - lowest));
                joined.push(own);
                continue;
            };
            for &pixel in &plateau {
                summit_of[pixel] = highest;
            }
            for &summit in lower {
                joined[summit] = highest;
                peaks[summit].prominence = self.heights[peaks[summit].pixel] - height;
            }
        }
        peaks
    }

    fn peak(&self, plateau: &[usize], prominence: f64) -> Peak {
        let pixel = plateau[0];
        let [columns, rows] = self.size;
        let offsets = plateau.iter().map(|&other| self.shortest(self.centre(other) - self.centre(pixel)));
        let at_border = |&pixel: &usize| {
            let (column, row) = (pixel % columns, pixel / columns);
            column == 0 || row == 0 || column + 1 == columns || row + 1 == rows
        };
        Peak {
            pixel,
            pixels: plateau.len() as f64,
            offset: offsets.sum(),
            at_edge: plateau.iter().any(at_border),
            prominence,
        }
    }

    fn is_at_edge(&self, peak: &Peak) -> bool {
        self.edge == Edge::Open && peak.at_edge
    }

    fn centre(&self, pixel: usize) -> Vector<f64> {
        let columns = self.size[0];
        Vector::new((pixel % columns) as f64 + 0.5, (pixel / columns) as f64 + 0.5)
    }

    /// The eight neighbours of a pixel that are there.
    fn around(&self, pixel: usize) -> [Option<usize>; 8] {
        const STEPS: [[isize; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];
        let [columns, rows] = self.size;
        let (column, row) = (pixel % columns, pixel / columns);
        if column > 0 && row > 0 && column + 1 < columns && row + 1 < rows {
            return STEPS.map(|[dx, dy]| pixel.checked_add_signed(dy * columns as isize + dx));
        }
        STEPS.map(|step| self.stepped(pixel, step))
    }

    fn stepped(&self, pixel: usize, [dx, dy]: [isize; 2]) -> Option<usize> {
        let [columns, rows] = self.size.map(|length| length as isize);
        let (column, row) = (pixel as isize % columns + dx, pixel as isize / columns + dy);
        let inside = column >= 0 && row >= 0 && column < columns && row < rows;
        match self.edge {
            Edge::Open if !inside => None,
            _ => Some((row.rem_euclid(rows) * columns + column.rem_euclid(columns)) as usize),
        }
    }

    /// A difference of places as the shortest among the images.
    fn shortest(&self, d: Vector<f64>) -> Vector<f64> {
        let nearest = |x: f64, length: usize| x - length as f64 * (x / length as f64).round();
        match self.edge {
            Edge::Open => d,
            Edge::Periodic => Vector::new(nearest(d.x, self.size[0]), nearest(d.y, self.size[1])),
        }
    }

    /// The place of a peak: by the quadratic `f + g·d + ½ d·H d` through nine pixels, or the middle of a plateau.
    fn location(&self, peak: &Peak) -> Vector<f64> {
        let mean = self.centre(peak.pixel) + peak.offset / peak.pixels;
        let refined = (peak.pixels == 1.0).then(|| self.quadratic_step(peak.pixel)).flatten();
        let place = mean + refined.unwrap_or_else(Vector::zeros);
        match self.edge {
            Edge::Open => place,
            Edge::Periodic => {
                Vector::new(place.x.rem_euclid(self.size[0] as f64), place.y.rem_euclid(self.size[1] as f64))
            }
        }
    }

    fn quadratic_step(&self, pixel: usize) -> Option<Vector<f64>> {
        let (mut gradient, mut xx, mut yy, mut xy) = (Vector::zeros(), 0.0, 0.0, 0.0);
        for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
            let height = self.heights[self.stepped(pixel, [dx, dy])?];
            let (x, y) = (dx as f64, dy as f64);
            // Least squares on the nine places: x² − 2/3 is orthogonal to what does not depend on x².
            gradient += Vector::new(x, y) * (height / 6.0);
            xx += (x * x - 2.0 / 3.0) * height;
            yy += (y * y - 2.0 / 3.0) * height;
            xy += 0.25 * x * y * height;
        }
        let determinant = xx * yy - xy * xy;
        let is_maximum = xx < 0.0 && determinant > 0.0;
        let step =
            Vector::new(xy * gradient.y - yy * gradient.x, xy * gradient.x - xx * gradient.y) / determinant;
        (is_maximum && step.x.abs() <= 1.0 && step.y.abs() <= 1.0).then_some(step)
    }
}
