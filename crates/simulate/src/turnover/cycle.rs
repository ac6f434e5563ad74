//! Growth and division: where cells are in their cycles.

use super::rates::not_usable;
use crate::Error;
use rand::Rng;
use rand_distr::{Distribution, Gamma};
use serde::{Deserialize, Serialize};
use voronudge_geometry::{CellPolygon, Vector, cross};
use voronudge_model::{CellFactors, CellParameter, EnvironmentError};

/// A cycle of growth and division.
///
/// A cell has a phase `φ` that runs at the rate of births at its place, `dφ/dt = k(d_b)`, and divides at `φ = Γ`, which is drawn at its
/// birth: gamma distributed, of a coefficient of variation `c` and the mean
///
/// ```text
/// ⟨Γ⟩ = (2^{c²} − 1)/c²,        ln 2 of cycles of one length, 1 of divisions at random
/// ```
///
/// with which a population of a uniform rate `k` has `k` births per cell and time, by `2⟨exp(−Γ)⟩ = 1` (Euler and Lotka; Powell 1956). Its preferred area and
/// perimeter are multiples of those of the model,
///
/// ```text
/// A₀ s and P₀ √s,        s = ½ s_d (1 + φ/Γ),
/// ```
///
/// so that its preferred shape `P₀/√A₀` stays what it is, and those of two daughters add up to that of their mother.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CellCycle {
    /// Coefficient of variation `c` of the lengths of cycles, from nought to one.
    pub variation: f64,
    /// Multiple `s_d` of the preferred area that a cell has when it divides; a new one has half of it.
    pub size_at_division: f64,
    /// Distance between two daughters; by default that of the centroids of the halves into which their mother is cut.
    pub distance: Option<f64>,
    /// The line on which the daughters lie.
    pub axis: DivisionAxis,
}

/// The line through the centre of a mother on which her daughters lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DivisionAxis {
    /// The long axis of her sides, as her shape tensor has it.
    Long,
    /// Any.
    Random,
}

/// Where a cell is in its cycle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// The phase `φ`.
    pub phase: f64,
    /// The phase `Γ` at which it divides.
    pub length: f64,
}

impl Default for CellCycle {
    /// Lengths that vary by 0.3, and a mean preferred area, over a population that grows, of that of the model where lengths do not vary.
    fn default() -> Self {
        Self {
            variation: 0.3,
            size_at_division: 2.0 * std::f64::consts::LN_2,
            distance: None,
            axis: DivisionAxis::Long,
        }
    }
}

impl CellCycle {
    /// Mean length of a cycle `⟨Γ⟩`: of cells where `k` are born per cell and time it takes `⟨Γ⟩/k` in the mean.
    ///
    /// ```
    /// use voronudge_simulate::CellCycle;
    /// let of = |variation| CellCycle { variation, ..CellCycle::default() }.mean_length();
    /// assert!((of(0.0) - 2f64.ln()).abs() < 1e-12 && (of(1.0) - 1.0).abs() < 1e-12);
    /// ```
    pub fn mean_length(&self) -> f64 {
        let square = self.variation * self.variation;
        if square < 1e-9 { std::f64::consts::LN_2 } else { (square.exp2() - 1.0) / square }
    }

    /// The multiple `s` of the preferred area.
    pub fn size(&self, progress: Progress) -> f64 {
        0.5 * self.size_at_division * (1.0 + (progress.phase / progress.length).min(1.0))
    }

    /// The multiples of cells (N).
    pub(super) fn factors(&self, cells: &[Progress]) -> Result<CellFactors, EnvironmentError> {
        let sizes: Vec<f64> = cells.iter().map(|progress| self.size(*progress)).collect();
        let roots = sizes.iter().map(|size| size.sqrt()).collect();
        CellFactors::default()
            .with(CellParameter::PreferredPerimeter, roots)?
            .with(CellParameter::PreferredArea, sizes)
    }

    /// A cell at the beginning of its cycle.
    pub fn newborn(&self, rng: &mut impl Rng) -> Progress {
        let square = self.variation * self.variation;
        // Gamma numbers of a vanishing spread are their mean.
        let gamma = Gamma::new(1.0 / square, square * self.mean_length());
        let length = gamma.map_or_else(|_| self.mean_length(), |gamma| gamma.sample(rng));
        Progress { phase: 0.0, length: length.max(f64::MIN_POSITIVE) }
    }

    /// A cell of a population that grows and that remembers no beginning: of a density `exp(−φ)` in the phases before its end.
    pub fn anywhere(&self, rng: &mut impl Rng) -> Progress {
        loop {
            let Progress { length, .. } = self.newborn(rng);
            let reached = -(-length).exp_m1();
            if rng.random::<f64>() < reached {
                let phase = -(-rng.random::<f64>() * reached).ln_1p();
                return Progress { phase: phase.min(length), length };
            }
        }
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !(0.0..=1.0).contains(&self.variation) {
            return Err(not_usable("variation of cell cycles", self.variation, "from nought to one"));
        }
        if !positive(self.size_at_division) {
            let size = self.size_at_division;
            return Err(not_usable("size of a cell at its division", size, "positive and finite"));
        }
        match self.distance {
            Some(distance) if !positive(distance) => {
                Err(not_usable("distance of two daughters", distance, "positive and finite"))
            }
            _ => Ok(()),
        }
    }
}

/// How far apart the centroids of the halves are, along `axis`, into which a cell is cut through its centre, the origin of its polygon, across
/// this unit vector (length).
pub fn distance_of_halves(polygon: &CellPolygon<f64>, axis: Vector<f64>) -> f64 {
    let vertices: Vec<_> = polygon.vertices().collect();
    let centroid = |sign: f64| {
        let height = |r: &Vector<f64>| sign * r.dot(&axis);
        let (mut area, mut moment) = (0.0, 0.0);
        for (index, to) in vertices.iter().enumerate() {
            let from = &vertices[(index + vertices.len() - 1) % vertices.len()];
            let (low, high) = (height(from), height(to));
            let crossing = || from + (to - from) * (low / (low - high));
            let [start, end] = match (low > 0.0, high > 0.0) {
                (true, true) => [*from, *to],
                (true, false) => [*from, crossing()],
                (false, true) => [crossing(), *to],
                (false, false) => continue,
            };
            // Triangles with the centre, which lies on the cut.
            let twice = cross(start, end);
            area += twice;
            moment += twice * (height(&start) + height(&end)) / 3.0;
        }
        moment / area
    };
    centroid(1.0) + centroid(-1.0)
}
