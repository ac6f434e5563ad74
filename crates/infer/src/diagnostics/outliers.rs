//! Cells whose residual is too large for the rest, and what may be wrong with them.
//!
//! For normal residuals `x = |u|²/2` is exponential with mean σ². The mean is estimated from the r smaller half of all x
//! (maximum likelihood of a sample cut at the r-th), which no large value can spoil:
//! `σ² = [Σ_{m ≤ r} x_(m) + (n − r) x_(r)] / r`. Then `2 r σ²` is χ² with 2 r degrees of freedom, and
//! `P(x' > x) = (1 + x / r σ²)^(−r)`. A cell is an outlier if this times the number of cells is less than 0.05.

use super::pool::Pool;
use super::{LEVEL, ResidualField};
use crate::median::median;
use voronudge_geometry::Vector;

/// Areas of merged cells are more than this many median areas.
const MERGED: f64 = 1.7;
/// Areas of both parts of a split cell are less than this many median areas.
const SPLIT: f64 = 0.6;
/// Velocities of cells that took another's place are more than this many standard deviations from the median.
const MISTRACKED: f64 = 5.0;
/// Fewer residuals than this have no outliers.
const FEWEST: usize = 10;

/// What may be wrong with a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Two cells taken for one: the area is more than 1.7 median areas.
    Merged,
    /// One cell taken for two: it and this neighbour have less than 0.6 median areas, and residuals against each other.
    Split {
        /// The other part.
        with: usize,
    },
    /// Two tracks were swapped, or one jumped: the velocity is more than five robust standard deviations from the median
    /// of the frame.
    MisTracked,
    /// Nothing of these, or areas and velocities were not given.
    Unknown,
}

impl Cause {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Merged => "merged",
            Self::Split { .. } => "split",
            Self::MisTracked => "mis-tracked",
            Self::Unknown => "unknown",
        }
    }
}

/// A cell whose residual is too large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Position of the frame in the list given.
    pub frame: usize,
    /// Position of the residual in its frame.
    pub index: usize,
    /// `|u|/σ` with the robust standard deviation of one component.
    pub z: f64,
    /// Probability of as large a residual among all, at most (Bonferroni).
    pub p: f64,
    /// What may be wrong with the cell.
    pub cause: Cause,
}

/// The outliers of all frames, in order; the standard deviation is that of all frames.
pub fn outliers(frames: &[ResidualField<'_>]) -> Vec<Outlier> {
    let pool = Pool::new(frames);
    let squares: Vec<f64> = pool.residuals.iter().map(|u| 0.5 * u.norm_squared()).collect();
    let Some((variance, used)) = robust_variance(&squares) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for (number, (frame, &start)) in frames.iter().zip(&pool.starts).enumerate() {
        let suspects = frame.cells.is_some().then(|| Suspects::new(frame));
        for index in 0..frame.places.len() {
            let x = squares[start + index] / variance;
            let p = squares.len() as f64 * (1.0 + x / used).powf(-used);
            if p < LEVEL {
                let cause = suspects.as_ref().map_or(Cause::Unknown, |suspects| suspects.cause(index));
                found.push(Outlier { frame: number, index, z: (2.0 * x).sqrt(), p, cause });
            }
        }
    }
    found
}

/// σ² and r of the module's text; `None` with few values, or if most are zero.
pub(crate) fn robust_variance(squares: &[f64]) -> Option<(f64, f64)> {
    let count = squares.len();
    if count < FEWEST {
        return None;
    }
    let mut sorted = squares.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let used = count.div_ceil(2);
    let sum = sorted[..used].iter().sum::<f64>() + (count - used) as f64 * sorted[used - 1];
    let variance = sum / used as f64;
    (variance > 0.0).then_some((variance, used as f64))
}

/// What is unusual about the cells of a frame.
struct Suspects<'a> {
    frame: &'a ResidualField<'a>,
    /// Areas over the median; empty if unknown.
    areas: Vec<f64>,
    /// Distances of velocities from the median, in robust standard deviations; empty if unknown.
    speeds: Vec<f64>,
}

impl<'a> Suspects<'a> {
    fn new(frame: &'a ResidualField<'a>) -> Self {
        let (mut areas, mut speeds) = (Vec::new(), Vec::new());
        if let Some(cells) = frame.cells {
            let mut known: Vec<f64> = cells.areas.iter().copied().filter(|area| !area.is_nan()).collect();
            if let Some(middle) = median(&mut known) {
                areas = cells.areas.iter().map(|area| area / middle).collect();
            }
            let component = |axis: usize| cells.velocities.iter().map(move |v| v[axis]);
            let middle = [0, 1].map(|axis| median(&mut component(axis).collect::<Vec<f64>>()).unwrap_or(0.0));
            let from_middle = |v: &Vector<f64>| 0.5 * (v - Vector::from(middle)).norm_squared();
            let squares: Vec<f64> = cells.velocities.iter().map(from_middle).collect();
            if let Some((variance, _)) = robust_variance(&squares) {
                speeds = squares.iter().map(|x| (2.0 * x / variance).sqrt()).collect();
            }
        }
        Self { frame, areas, speeds }
    }

    fn cause(&self, cell: usize) -> Cause {
        if self.areas.get(cell).is_some_and(|area| *area > MERGED) {
            return Cause::Merged;
        }
        let small = |cell: usize| self.areas.get(cell).is_some_and(|area| *area < SPLIT);
        let against = |other: usize| self.frame.residuals[cell].dot(&self.frame.residuals[other]) < 0.0;
        let mut near = self.frame.neighbours[cell].iter().map(|&other| other as usize);
        if let Some(with) = near.find(|&other| small(cell) && small(other) && against(other)) {
            return Cause::Split { with };
        }
        if self.speeds.get(cell).is_some_and(|speed| *speed > MISTRACKED) {
            return Cause::MisTracked;
        }
        Cause::Unknown
    }
}
