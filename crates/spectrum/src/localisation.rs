//! Where between its ends a mode is.

use voronudge_geometry::{Tessellation, Vector};
use voronudge_linalg::Complex64;

/// Where a mode is: how much of it at the ends, and how it grows on the way across.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Localisation {
    /// Share of |u|² within two rows of cells of an end or a wall.
    pub edge: f64,
    /// Of that, the share at the right end less that at the left; NaN where there are walls on all sides.
    pub side: f64,
    /// Mean of the place weighted with |u|²: of the distance from the left end or, between walls on all sides, from the nearest wall.
    pub centre: f64,
    /// Rate of growth of |u| towards the right end (1/length), or, between walls on all sides, towards the nearest wall: half the slope of ln |u|²,
    /// summed over each row. The localisation length is one over its magnitude.
    pub growth: f64,
}

/// Rows with less than this share of |u|² in the largest are noise of the eigenvectors.
const FAINT: f64 = 1e-20;

/// Rows of cells of a tissue that ends: which row each cell is in, where the rows are, and which are at an end.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// The row of each cell that moves.
    row: Vec<usize>,
    /// Place of each row.
    place: Vec<f64>,
    /// Of each cell that is within two rows of an end, the end: −1 left, 1 right, 0 any.
    end: Vec<Option<f64>>,
    cells: Vec<f64>,
}

impl Rows {
    /// A strip of one cell in each row, at these places from left to right; the first and the last two are at its ends.
    pub fn of_strip(places: &[f64]) -> Self {
        let rows = places.len();
        let end = |row: usize| match row {
            0 | 1 => Some(-1.0),
            _ if row + 2 >= rows => Some(1.0),
            _ => None,
        };
        Self {
            row: (0..rows).collect(),
            place: places.to_vec(),
            end: (0..rows).map(end).collect(),
            cells: vec![1.0; rows],
        }
    }

    /// Cells between walls across the axes `mirrors` of a box, the first `cells` of a tessellation with their images. Rows are a spacing wide,
    /// which is the root of the mean area. At a wall are the cells that meet their own image, and their neighbours.
    pub fn between_walls(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        (mirrors, cells): (&[usize], usize),
        lengths: [f64; 2],
    ) -> Self {
        let spacing = (lengths[0] * lengths[1] / cells as f64).sqrt();
        let one_pair = mirrors.len() == 1;
        let depth = |cell: usize| {
            let of = |&axis: &usize| positions[cell][axis].min(lengths[axis] - positions[cell][axis]);
            mirrors.iter().map(of).fold(f64::INFINITY, f64::min)
        };
        let place = |cell: usize| if one_pair { positions[cell][mirrors[0]] } else { depth(cell) };
        let touches = |cell: usize| tessellation.neighbours(cell).iter().any(|&n| n as usize % cells == cell);
        let near = |cell: usize| {
            touches(cell) || tessellation.neighbours(cell).iter().any(|&n| touches(n as usize % cells))
        };
        let side = |cell: usize| match one_pair {
            true if place(cell) < 0.5 * lengths[mirrors[0]] => -1.0,
            true => 1.0,
            false => 0.0,
        };
        let bins: Vec<usize> =
            (0..cells).map(|cell| (place(cell).max(0.0) / spacing).floor() as usize).collect();
        let count = bins.iter().max().map_or(0, |last| last + 1);
        let mut members = vec![0.0; count];
        let mut sums = vec![0.0; count];
        for (cell, &bin) in bins.iter().enumerate() {
            members[bin] += 1.0;
            sums[bin] += place(cell);
        }
        Self {
            row: bins,
            // A row without cells has a place, too.
            place: (0..count)
                .map(|bin| {
                    let middle = (bin as f64 + 0.5) * spacing;
                    if members[bin] > 0.0 { sums[bin] / members[bin] } else { middle }
                })
                .collect(),
            end: (0..cells).map(|cell| near(cell).then(|| side(cell))).collect(),
            cells: members,
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.place.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.place.is_empty()
    }

    /// Place of each row, from the left end or the nearest wall.
    pub fn places(&self) -> &[f64] {
        &self.place
    }

    /// Share of the cells within two rows of an end.
    pub fn share_at_ends(&self) -> f64 {
        self.end.iter().flatten().count() as f64 / self.end.len() as f64
    }

    /// |u|² of each row for each of its cells, with sum one over all cells.
    pub fn profile(&self, u: &[Complex64]) -> Vec<f64> {
        let mut profile = vec![0.0; self.len()];
        let mut all = 0.0;
        for (u, &row) in u.chunks_exact(2).zip(&self.row) {
            let square = u[0].norm_sqr() + u[1].norm_sqr();
            profile[row] += square;
            all += square;
        }
        for (sum, cells) in profile.iter_mut().zip(&self.cells) {
            *sum /= all * cells.max(1.0);
        }
        profile
    }

    /// Where a mode (2n) is.
    pub fn localisation(&self, u: &[Complex64]) -> Localisation {
        let profile = self.profile(u);
        let (mut edge, mut side, mut all) = (0.0, 0.0, 0.0);
        for (u, end) in u.chunks_exact(2).zip(&self.end) {
            let square = u[0].norm_sqr() + u[1].norm_sqr();
            all += square;
            if let Some(end) = end {
                edge += square;
                side += square * end;
            }
        }
        let sided = self.end.iter().flatten().any(|end| *end != 0.0);
        let weights = profile.iter().zip(&self.cells).map(|(own, cells)| own * cells);
        let centre = weights.zip(&self.place).map(|(weight, place)| weight * place).sum();
        let growth = 0.5 * slope_of_logarithm(&self.place, &profile);
        Localisation {
            edge: edge / all,
            side: if sided { side / all } else { f64::NAN },
            centre,
            growth: if sided { growth } else { -growth },
        }
    }
}

/// Slope of the straight line through the logarithms of numbers that are not too small, by least squares; NaN of fewer than three.
fn slope_of_logarithm(places: &[f64], profile: &[f64]) -> f64 {
    let largest = profile.iter().copied().fold(0.0, f64::max);
    let points: Vec<(f64, f64)> = (places.iter().zip(profile))
        .filter(|(_, own)| **own > FAINT * largest)
        .map(|(place, own)| (*place, own.ln()))
        .collect();
    if points.len() < 3 {
        return f64::NAN;
    }
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0, sum.1 + point.1));
    let (x, y) = (x / count, y / count);
    let (mut xx, mut xy) = (0.0, 0.0);
    for point in points {
        xx += (point.0 - x).powi(2);
        xy += (point.0 - x) * (point.1 - y);
    }
    xy / xx
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponential_has_its_rate_and_its_side() {
        let places: Vec<f64> = (0..30).map(|row| 0.7 + 0.9 * row as f64).collect();
        let rows = Rows::of_strip(&places);
        for rate in [-0.4, 0.0, 0.25] {
            let wave = |x: f64| Complex64::from_polar((rate * x).exp(), 1.3 * x);
            let u: Vec<Complex64> = places.iter().flat_map(|&x| [wave(x), 0.5 * wave(x)]).collect();
            let found = rows.localisation(&u);
            assert!((found.growth - rate).abs() < 1e-12);
            assert!((rows.profile(&u).iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(rate == 0.0 || (found.side > 0.0) == (rate > 0.0));
            assert!((rate - 0.0).abs() > 0.0 || (found.edge - 4.0 / 30.0).abs() < 1e-12);
            assert!(found.side.abs() <= found.edge + 1e-12);
            assert!((found.centre - 0.5 * (places[0] + places[29])) * rate >= 0.0);
        }
    }
}
