//! How residuals of two cells go together, as a function of their distance.
//!
//! With the unit vector d̂ from cell i to cell j, `t̂ = ẑ×d̂`, and normalised by `⟨|u|²⟩/2`:
//!
//! ```text
//! C_∥(d) = ⟨(u_i·d̂)(u_j·d̂)⟩        C_⊥(d) = ⟨(u_i·t̂)(u_j·t̂)⟩
//! C_χ(d) = ½⟨(u_i·d̂)(u_j·t̂) + (u_i·t̂)(u_j·d̂)⟩
//! ```
//!
//! A reflection turns t̂ against the field and so changes the sign of both products in C_χ. Exchange of i and j turns d̂
//! and t̂ around and swaps the products: the sum stays, while their difference `ẑ·(u_i × u_j)` would change its sign and
//! vanish over all pairs. C_χ is the part of the correlation that knows left from right, and is not zero where sources
//! both push and turn.
//!
//! The standard error of a mean over pairs is not that of independent pairs. Cells are grouped into blocks of the field,
//! the same in all frames; with the sum `S_gh` over pairs between blocks g and h of products minus their mean,
//! `variance = [Σ_g (Σ_h S_gh)² − Σ_{g<h} S_gh²] / pairs²`: pairs with a block in common may be correlated (the second
//! sum takes away what the first counts twice), others may not. It allows residuals to persist over frames.

use super::modes::{extent, fractions};
use super::pool::Pool;
use super::random_signs::Stream;
use super::structure::{neighbours, two_sided};
use super::{LEVEL, ResidualField};
use voronudge_geometry::{Domain, Vector, quarter_turn};

/// Width of a bin, in the unit of the places.
const WIDTH: f64 = 0.5;
/// Distances end at this share of the field: of the lesser side of a periodic box, or of √area of an open field.
const REACH: f64 = 1.0 / 3.0;
/// A bin has at least this many pairs, and at least a quarter as many as there are residuals.
const FEWEST_PAIRS: f64 = 30.0;
/// Blocks along each side of the field: as many as have a side of [`BLOCK`], within these limits.
const BLOCKS: [f64; 2] = [4.0, 8.0];
const BLOCK: f64 = 3.0;
/// Correlation lengths are looked for from here to ten times the reach, in this many logarithmic steps.
const SHORTEST: f64 = 0.1;
const STEPS: i32 = 1000;
/// Standard errors are not trusted below this.
const LEAST_ERROR: f64 = 1e-3;

/// A correlation with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correlation {
    /// The value, at most about one.
    pub value: f64,
    /// Its standard error, from blocks of cells.
    pub standard_error: f64,
}

/// Pairs of about the same distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Mean distance.
    pub distance: f64,
    /// Number of pairs.
    pub pairs: usize,
    /// C_∥: along the line between the cells.
    pub longitudinal: Correlation,
    /// C_⊥: across.
    pub transverse: Correlation,
    /// C_χ: one along, the other across; changes its sign in a mirror.
    pub chiral: Correlation,
    /// `(C_∥ + C_⊥)/2 = ⟨u_i·u_j⟩ / ⟨|u|²⟩`.
    pub total: Correlation,
}

/// How far a correlation reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CorrelationLength {
    /// Neighbours do not correlate positively at the level of 5 %: there is nothing to measure.
    NoCorrelation,
    /// `amplitude · exp(−d/length)` fits best.
    Known {
        /// The length.
        length: f64,
        /// The share of the variance that is correlated; the rest is white.
        amplitude: f64,
    },
    /// The correlation decays too slowly for the size of the field; the length is more than this.
    LongerThan(f64),
}

impl CorrelationLength {
    /// The length, where it is known.
    pub fn value(self) -> Option<f64> {
        match self {
            Self::Known { length, .. } => Some(length),
            _ => None,
        }
    }
}

/// Correlation functions of a residual.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlations {
    /// By distance. Bins of 0.5, where there are few pairs several together.
    pub bins: Vec<Bin>,
    /// From the fit of an exponential to the total correlation, by least squares weighted with the standard errors, up to
    /// and with the first bin that is less than its standard error.
    pub length: CorrelationLength,
    /// C_χ of neighbours, and its two-sided p-value by random signs; `None` with few pairs.
    pub handedness: Option<(f64, f64)>,
}

/// Correlation functions of residuals, pooled over frames.
pub fn correlations(frames: &[ResidualField<'_>], seed: u64) -> Correlations {
    let pool = Pool::new(frames);
    let scale = 0.5 * pool.mean_square();
    if scale <= 0.0 {
        return Correlations { bins: Vec::new(), length: CorrelationLength::NoCorrelation, handedness: None };
    }
    let reach = reach(frames);
    let bins = bins(frames, &pool, reach, scale);
    let correlated = neighbours(&pool, seed).is_some_and(|(moran, p)| moran > 0.0 && p < LEVEL);
    let length = if correlated { length(&bins, reach) } else { CorrelationLength::NoCorrelation };
    Correlations { bins, length, handedness: handedness(frames, &pool, scale, seed) }
}

/// Products of two residuals: along, across, mixed, half the scalar product.
fn products(d: Vector<f64>, distance: f64, a: &Vector<f64>, b: &Vector<f64>) -> [f64; 4] {
    let along = d / distance;
    let across = quarter_turn(along);
    let [al, at, bl, bt] = [a.dot(&along), a.dot(&across), b.dot(&along), b.dot(&across)];
    [al * bl, at * bt, 0.5 * (al * bt + at * bl), 0.5 * (al * bl + at * bt)]
}

fn reach(frames: &[ResidualField<'_>]) -> f64 {
    let side = |frame: &ResidualField<'_>| match frame.domain {
        Domain::Periodic(cell) => cell.lengths()[0].min(cell.lengths()[1]),
        Domain::Open => {
            let [low, high] = extent(frame.places.iter());
            (high - low).product().sqrt()
        }
    };
    REACH * frames.iter().map(side).fold(f64::INFINITY, f64::min)
}

/// Sums over the pairs of a bin, between each two blocks.
#[derive(Clone)]
struct Sums {
    blocks: usize,
    pairs: Vec<f64>,
    distance: f64,
    products: Vec<[f64; 4]>,
}

impl Sums {
    fn new(blocks: usize) -> Self {
        let zero = [0.0; 4];
        Self {
            blocks,
            pairs: vec![0.0; blocks * blocks],
            distance: 0.0,
            products: vec![zero; blocks * blocks],
        }
    }

    fn add(&mut self, other: &Self) {
        self.distance += other.distance;
        self.pairs.iter_mut().zip(&other.pairs).for_each(|(a, b)| *a += b);
        for (mine, other) in self.products.iter_mut().zip(&other.products) {
            mine.iter_mut().zip(other).for_each(|(a, b)| *a += b);
        }
    }

    fn count(&self) -> f64 {
        self.pairs.iter().sum()
    }

    /// Mean and standard error of one of the products.
    fn correlation(&self, product: usize, scale: f64) -> Correlation {
        let count = self.count();
        let mean = self.products.iter().map(|p| p[product]).sum::<f64>() / count;
        // Pairs are entered with the lesser block first.
        let deviation = |g: usize, h: usize| {
            let at = g.min(h) * self.blocks + g.max(h);
            self.products[at][product] - self.pairs[at] * mean
        };
        let (mut with_a_block, mut with_both, mut twice) = (0.0, 0.0, 0.0);
        for g in 0..self.blocks {
            let all: f64 = (0..self.blocks).map(|h| deviation(g, h)).sum();
            with_a_block += all * all;
            with_both += deviation(g, g).powi(2);
            twice += (g + 1..self.blocks).map(|h| deviation(g, h).powi(2)).sum::<f64>();
        }
        // Never less than if pairs of different blocks were independent.
        let variance = (with_a_block - twice).max(with_both + twice);
        Correlation { value: mean / scale, standard_error: variance.sqrt() / (count * scale) }
    }
}

fn bins(frames: &[ResidualField<'_>], pool: &Pool, reach: f64, scale: f64) -> Vec<Bin> {
    let rectangle = extent(frames.iter().flat_map(|frame| frame.places));
    let along = (reach / REACH / BLOCK).floor().clamp(BLOCKS[0], BLOCKS[1]);
    let mut sums = vec![Sums::new((along * along) as usize); (reach / WIDTH).ceil() as usize];
    for (frame, &start) in frames.iter().zip(&pool.starts) {
        let here = &pool.residuals[start..start + frame.places.len()];
        let block = |place: &Vector<f64>| {
            let at = fractions(frame.domain, *place, rectangle)
                .map(|f| (f * along).floor().clamp(0.0, along - 1.0));
            (at[0] * along + at[1]) as usize
        };
        let blocks: Vec<usize> = frame.places.iter().map(block).collect();
        for i in 0..here.len() {
            for j in i + 1..here.len() {
                let d = frame.displacement(i, j);
                let distance = d.norm();
                if distance >= reach || distance < 1e-9 {
                    continue;
                }
                let sum = &mut sums[(distance / WIDTH) as usize];
                let at = blocks[i].min(blocks[j]) * sum.blocks + blocks[i].max(blocks[j]);
                sum.pairs[at] += 1.0;
                sum.distance += distance;
                let products = products(d, distance, &here[i], &here[j]);
                sum.products[at].iter_mut().zip(products).for_each(|(s, p)| *s += p);
            }
        }
    }
    let fewest = FEWEST_PAIRS.max(0.25 * pool.residuals.len() as f64);
    let mut bins = Vec::new();
    let mut sum: Option<Sums> = None;
    for next in sums {
        let joined = match sum.take() {
            Some(mut joined) => {
                joined.add(&next);
                joined
            }
            None => next,
        };
        if joined.count() < fewest {
            sum = Some(joined);
        } else {
            let [longitudinal, transverse, chiral, total] =
                [0, 1, 2, 3].map(|product| joined.correlation(product, scale));
            let (pairs, distance) = (joined.count() as usize, joined.distance / joined.count());
            bins.push(Bin { distance, pairs, longitudinal, transverse, chiral, total });
        }
    }
    bins
}

/// Fits an exponential: for each length the amplitude is linear.
fn length(bins: &[Bin], reach: f64) -> CorrelationLength {
    let last = bins.iter().position(|bin| bin.total.value < bin.total.standard_error);
    let fitted = &bins[..last.map_or(bins.len(), |last| last + 1)];
    if last == Some(0) || fitted.len() < 2 {
        return CorrelationLength::NoCorrelation;
    }
    let mut best = (f64::INFINITY, SHORTEST, 0.0);
    for step in 0..=STEPS {
        let length = SHORTEST * (10.0 * reach / SHORTEST).powf(f64::from(step) / f64::from(STEPS));
        let (mut yy, mut yf, mut ff) = (0.0, 0.0, 0.0);
        for bin in fitted {
            let weight = bin.total.standard_error.max(LEAST_ERROR).powi(-2);
            let (y, f) = (bin.total.value, (-bin.distance / length).exp());
            yy += weight * y * y;
            yf += weight * y * f;
            ff += weight * f * f;
        }
        // A correlation is not more than one.
        let amplitude = if ff > 0.0 { (yf / ff).clamp(0.0, 1.0) } else { 0.0 };
        let misfit = yy - 2.0 * amplitude * yf + amplitude * amplitude * ff;
        if misfit < best.0 {
            best = (misfit, length, amplitude);
        }
    }
    let (_, length, amplitude) = best;
    if length > reach {
        CorrelationLength::LongerThan(reach)
    } else {
        CorrelationLength::Known { length, amplitude }
    }
}

fn handedness(frames: &[ResidualField<'_>], pool: &Pool, scale: f64, seed: u64) -> Option<(f64, f64)> {
    let mut chiral = Vec::with_capacity(pool.edges.len());
    for (frame, &start) in frames.iter().zip(&pool.starts) {
        let later = |i: usize| frame.neighbours[i].iter().map(|&j| j as usize).filter(move |&j| i < j);
        for (i, j) in (0..frame.places.len()).flat_map(|i| later(i).map(move |j| (i, j))) {
            let d = frame.displacement(i, j);
            let [_, _, mixed, _] =
                products(d, d.norm(), &pool.residuals[start + i], &pool.residuals[start + j]);
            chiral.push(mixed);
        }
    }
    let scale = scale * chiral.len() as f64;
    (chiral.len() as f64 >= FEWEST_PAIRS)
        .then(|| two_sided(&pool.edges, &chiral, scale, pool, seed, Stream::Handedness))
}
