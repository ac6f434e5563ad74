//! Sites from outlines: the points whose Voronoi polygons follow outlines of cells best.
//!
//! A line along which cells i and j touch should be their bisector. Its points x are off by
//!
//! ```text
//! g(x) = n · (x − (s_i + s_j)/2),        n = (s_j − s_i)/|s_j − s_i|
//! ```
//!
//! and `∫ |g| dl` over all lines is the area on the wrong side. The sites make `Σ ∫ g² dl` least. With the length L, the middle
//! and the extent e of a line, `∫ g² dl = L [g(middle)² + (n·e)²]` plus what no site changes.

use crate::Error;
use crate::gram::{chosen, grams};
use num_dual::DualSVec64;
use voronudge_geometry::{Interface, Scalar, Vector, dot};
use voronudge_linalg::Cholesky;
use voronudge_model::BlockMatrix;

/// A cell as its outline shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlined {
    /// Centroid of what is seen.
    pub centroid: Vector<f64>,
    /// Area of what is seen.
    pub area: f64,
    /// Whether it goes on beyond the image: the centroid is not where it should be.
    pub is_cut: bool,
}

/// Sites of the cells of one image.
#[derive(Debug, Clone, PartialEq)]
pub struct Sites {
    /// Where they are (N).
    pub positions: Vec<Vector<f64>>,
    /// Standard deviation of each coordinate (N).
    pub errors: Vec<f64>,
    /// Standard deviation of each coordinate of the centroids (N) as those of Voronoi polygons; NaN for a cell that touches none.
    pub centroid_errors: Vec<f64>,
    /// Root mean square distance of the outlines from the bisectors of the centroids, over the length where cells touch.
    pub misfit_of_centroids: f64,
    /// The same with the sites.
    pub misfit: f64,
}

/// Standard deviation of a site from the centroid, in square roots of the median area, that is assumed at first; and of one that
/// is cut.
const FIRST_OFFSET: f64 = 0.1;
const OFFSET_IF_CUT: f64 = 0.5;

/// Least standard deviation of a site from the centroid that is assumed, in square roots of the median area.
const LEAST_OFFSET: f64 = 0.01;

/// Rounds of fitting the sites and estimating how far they are from centroids.
const ROUNDS: usize = 4;

/// Steps of Gauss and Newton in a round.
const STEPS: usize = 30;

/// Steps smaller than this, in square roots of the median area, change nothing.
const SETTLED: f64 = 1e-6;

/// The weight of all lines in the scale of the errors of one cell, in lines.
const SHARED: f64 = 6.0;

/// `√L g(middle)` and `√L n·e` for two sites.
fn residuals<S: Scalar>(line: &Interface, sites: [Vector<S>; 2]) -> Vector<S> {
    let [i, j] = sites;
    let apart = j - i;
    let constant = |r: Vector<f64>| Vector::new(S::constant(r.x), S::constant(r.y));
    let normal = apart * dot(apart, apart).sqrt().recip();
    let off = constant(line.middle) - (i + j) * S::constant(0.5);
    Vector::new(dot(normal, off), dot(normal, constant(line.extent))) * S::constant(line.length.sqrt())
}

/// The sites of outlined cells, whose lines are given with the indices of the cells.
///
/// The distance of a site from its centroid has a prior, as wide as that of all cells turns out to be: it holds cells that touch few
/// others. Errors follow from the curvature and from how well outlines near the cell are bisectors at all.
///
/// # Errors
/// [`Error::Algebra`] if the equations cannot be solved.
pub fn sites(cells: &[Outlined], lines: &[Interface]) -> Result<Sites, Error> {
    let mut areas: Vec<f64> = cells.iter().map(|cell| cell.area).collect();
    areas.sort_unstable_by(f64::total_cmp);
    let size = areas.get(areas.len() / 2).map_or(1.0, |area| area.sqrt());
    let mut fit = Fit { cells, lines, positions: cells.iter().map(|cell| cell.centroid).collect() };
    let length: f64 = lines.iter().map(|line| line.length).sum();
    let misfit = |fit: &Fit<'_>| (fit.squares().iter().sum::<f64>() / length).sqrt();
    let misfit_of_centroids = misfit(&fit);
    let mut offset = FIRST_OFFSET * size;
    let mut variance = fit.variance(0.0);
    let mut errors = Vec::new();
    for _ in 0..ROUNDS {
        let springs: Vec<f64> = cells
            .iter()
            .map(|cell| variance / if cell.is_cut { OFFSET_IF_CUT * size } else { offset }.powi(2))
            .collect();
        fit.descend(&springs, SETTLED * size)?;
        let curvatures = fit.curvatures(&springs)?;
        // Directions that lines rather than springs determine.
        let determined: f64 = curvatures.iter().zip(&springs).map(|(c, k)| 2.0 - k * c).sum();
        variance = fit.variance(determined);
        errors = fit.deviations(variance, &curvatures);
        offset = fit.offset(&errors).max(LEAST_OFFSET * size);
    }
    Ok(Sites {
        misfit_of_centroids,
        misfit: misfit(&fit),
        centroid_errors: fit.deviations(variance, &fit.curvatures_of_centroids()),
        errors,
        positions: fit.positions,
    })
}

/// Sites on their way.
struct Fit<'a> {
    cells: &'a [Outlined],
    lines: &'a [Interface],
    positions: Vec<Vector<f64>>,
}

impl Fit<'_> {
    fn ends(&self, line: &Interface) -> [Vector<f64>; 2] {
        line.cells.map(|cell| self.positions[cell])
    }

    /// The sum of squares of each line.
    fn squares(&self) -> Vec<f64> {
        self.lines.iter().map(|line| residuals(line, self.ends(line)).norm_squared()).collect()
    }

    fn value(&self, springs: &[f64]) -> f64 {
        let pulls = self.cells.iter().zip(&self.positions).zip(springs);
        self.squares().iter().sum::<f64>()
            + pulls.map(|((cell, r), k)| k * (r - cell.centroid).norm_squared()).sum::<f64>()
    }

    /// Variance of a residual if so many directions are determined.
    fn variance(&self, determined: f64) -> f64 {
        let left = (2.0 * self.lines.len() as f64 - determined).max(1.0);
        self.squares().iter().sum::<f64>() / left
    }

    /// Residuals of the lines, then of the springs, and their derivatives by the sites.
    fn linearised(&self, springs: &[f64]) -> (Vec<Vector<f64>>, BlockMatrix) {
        type Dual = DualSVec64<4>;
        let mut rest = Vec::with_capacity(self.lines.len() + springs.len());
        let mut jacobian = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
        for line in self.lines {
            let seed = |r: Vector<f64>, first: usize| {
                Vector::new(Dual::from_re(r.x).derivative(first), Dual::from_re(r.y).derivative(first + 1))
            };
            let [i, j] = self.ends(line);
            let found = residuals(line, [seed(i, 0), seed(j, 2)]);
            rest.push(Vector::new(found.x.re, found.y.re));
            let [of_x, of_y] = [found.x, found.y].map(|x| x.eps.0.unwrap_or_default());
            for (k, cell) in line.cells.into_iter().enumerate() {
                let at = 2 * k;
                jacobian.column.push(cell as u32);
                jacobian.block.push([of_x[at], of_x[at + 1], of_y[at], of_y[at + 1]]);
            }
            jacobian.row_start.push(jacobian.column.len());
        }
        for (cell, (seen, k)) in self.cells.iter().zip(springs).enumerate() {
            let root = k.sqrt();
            rest.push((self.positions[cell] - seen.centroid) * root);
            jacobian.column.push(cell as u32);
            jacobian.block.push([root, 0.0, 0.0, root]);
            jacobian.row_start.push(jacobian.column.len());
        }
        (rest, jacobian)
    }

    fn factor(&self, jacobian: &BlockMatrix) -> Result<Cholesky, Error> {
        let (lines, rows) = (self.lines.len(), jacobian.row_start.len() - 1);
        let parts = [0..lines, lines..rows].map(|rows| chosen(jacobian, rows));
        let [of_lines, of_springs] =
            grams(parts.each_ref(), std::iter::empty(), self.cells.len(), |_, _| true)?;
        Ok(Cholesky::new(&of_lines.plus(1.0, &of_springs)?)?)
    }

    /// Steps of Gauss and Newton, shortened where they lead uphill.
    fn descend(&mut self, springs: &[f64], settled: f64) -> Result<(), Error> {
        let mut value = self.value(springs);
        for _ in 0..STEPS {
            let (rest, jacobian) = self.linearised(springs);
            let mut step = vec![0.0; 2 * self.cells.len()];
            for (row, r) in rest.iter().enumerate() {
                for (cell, b) in jacobian.row(row) {
                    step[2 * cell] -= b[0] * r.x + b[2] * r.y;
                    step[2 * cell + 1] -= b[1] * r.x + b[3] * r.y;
                }
            }
            self.factor(&jacobian)?.solve(&mut step);
            let before = self.positions.clone();
            let longest = step.chunks_exact(2).map(|d| d[0].hypot(d[1])).fold(0.0, f64::max);
            let mut share = 1.0;
            loop {
                for ((r, from), d) in self.positions.iter_mut().zip(&before).zip(step.chunks_exact(2)) {
                    *r = from + Vector::new(d[0], d[1]) * share;
                }
                let now = self.value(springs);
                if now <= value {
                    value = now;
                    break;
                }
                share *= 0.5;
                if share * longest < settled {
                    self.positions = before;
                    return Ok(());
                }
            }
            if share * longest < settled {
                break;
            }
        }
        Ok(())
    }

    /// The trace of each cell's block of the inverse of the normal matrix.
    fn curvatures(&self, springs: &[f64]) -> Result<Vec<f64>, Error> {
        let (_, jacobian) = self.linearised(springs);
        let factor = self.factor(&jacobian)?;
        let order = 2 * self.cells.len();
        let mut unit = vec![0.0; 2 * order];
        let traces = (0..self.cells.len()).map(|cell| {
            unit.fill(0.0);
            (unit[2 * cell], unit[order + 2 * cell + 1]) = (1.0, 1.0);
            factor.solve(&mut unit);
            unit[2 * cell] + unit[order + 2 * cell + 1]
        });
        Ok(traces.collect())
    }

    /// The trace of each centroid's variance, in units of that of a residual: a line of length L that is off by g moves the centroid of an area A by
    /// L g/A times its distance.
    fn curvatures_of_centroids(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.cells.len()];
        for line in self.lines {
            for cell in line.cells {
                let own = &self.cells[cell];
                sums[cell] += line.length * (line.middle - own.centroid).norm_squared() / own.area.powi(2);
            }
        }
        sums.into_iter().map(|sum| if sum > 0.0 { sum } else { f64::NAN }).collect()
    }

    /// Standard deviation of each cell's coordinates; its scale is that of the lines around the cell and of all together.
    fn deviations(&self, variance: f64, curvatures: &[f64]) -> Vec<f64> {
        let squares = self.squares();
        let all = 2.0 * self.lines.len() as f64 / squares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        // Relative to the mean of all lines, so that what the sites take up cancels.
        let mut around = vec![(SHARED, SHARED); self.cells.len()];
        for (line, square) in self.lines.iter().zip(&squares) {
            for cell in line.cells {
                around[cell].0 += 0.5 * square * all;
                around[cell].1 += 1.0;
            }
        }
        let scaled = around.iter().zip(curvatures).map(|((sum, count), c)| 0.5 * c * variance * sum / count);
        scaled.map(f64::sqrt).collect()
    }

    /// Standard deviation of a coordinate of the sites from the centroids, over cells that are seen as a whole.
    fn offset(&self, deviations: &[f64]) -> f64 {
        let whole =
            self.cells.iter().zip(&self.positions).zip(deviations).filter(|((cell, _), _)| !cell.is_cut);
        // What a site's own error hides of its offset is in its variance.
        let (sum, count) = whole.fold((0.0, 0.0), |(sum, count), ((cell, r), deviation)| {
            (sum + 0.5 * (r - cell.centroid).norm_squared() + deviation.powi(2), count + 1.0)
        });
        if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;
    use voronudge_segmentation::Mask;

    /// Label image of the Voronoi polygons of sites, with membranes of some width.
    fn image(sites: &[Vector<f64>], size: usize, membrane: f64) -> Vec<i64> {
        (0..size * size)
            .map(|k| {
                let r = Vector::new((k % size) as f64 + 0.5, (k / size) as f64 + 0.5);
                let mut order: Vec<(f64, usize)> =
                    sites.iter().enumerate().map(|(cell, s)| ((r - s).norm(), cell)).collect();
                order.select_nth_unstable_by(1, |a, b| a.0.total_cmp(&b.0));
                let [near, far] = [order[0], order[1]];
                let apart = (sites[near.1] - sites[far.1]).norm();
                let to_side = (far.0.powi(2) - near.0.powi(2)) / (2.0 * apart);
                if to_side < 0.5 * membrane { 0 } else { near.1 as i64 + 1 }
            })
            .collect()
    }

    /// Sites come back from masks far better than centroids do, and errors are what they say.
    #[test]
    fn sites_of_voronoi_masks_are_found() {
        for (seed, spacing, membrane, limit) in
            [(1, 20.0, 0.0, 0.1), (2, 20.0, 1.0, 0.1), (3, 12.0, 0.0, 0.15)]
        {
            let mut rng = Pcg64::seed_from_u64(seed);
            let side = 11_usize;
            let truth: Vec<Vector<f64>> = (0..side * side)
                .map(|k| {
                    let lattice = Vector::new(
                        (k % side) as f64 + 0.5 * ((k / side) % 2) as f64,
                        (k / side) as f64 * 0.9,
                    );
                    let shake = Vector::new(rng.random_range(-0.3..0.3), rng.random_range(-0.3..0.3));
                    (lattice + shake) * spacing
                })
                .collect();
            let size = (10.0 * spacing) as usize;
            let labels = image(&truth, size, membrane);
            let mask = Mask::new(&labels, [size, size]).unwrap();
            let masked = mask.cells();
            let cells: Vec<Outlined> = masked
                .iter()
                .map(|cell| Outlined { centroid: cell.centroid, area: cell.area, is_cut: cell.at_border })
                .collect();
            let index = |label| masked.iter().position(|cell| cell.label == label);
            let lines = mask.interfaces(2, index);
            let found = sites(&cells, &lines).unwrap();
            let inner: Vec<usize> = (0..cells.len()).filter(|cell| !cells[*cell].is_cut).collect();
            let rms = |of: &dyn Fn(usize) -> f64| {
                (inner.iter().map(|cell| of(*cell).powi(2)).sum::<f64>() / inner.len() as f64).sqrt()
            };
            let place = |cell: usize| truth[masked[cell].label as usize - 1];
            let before = rms(&|cell| (cells[cell].centroid - place(cell)).norm());
            let after = rms(&|cell| (found.positions[cell] - place(cell)).norm());
            let ratio = rms(&|cell| {
                (found.positions[cell] - place(cell)).norm() / (found.errors[cell] * 2f64.sqrt())
            });
            assert!(found.misfit < 0.2 * found.misfit_of_centroids, "{found:?}");
            assert!(after < limit * before, "{before} {after}");
            assert!((0.6..1.5).contains(&ratio), "{ratio}");
        }
    }
}
