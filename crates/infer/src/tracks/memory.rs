//! Cells that crawl: each has a velocity of its own that goes on from one interval to the next.
//!
//! The polarity p_i of a cell is a stationary process, `ẋ_i = F_i + p_i`, `ṗ = −p/τ + noise`: the self-propelled Voronoi model, in which
//! `p = v₀ (cos θ, sin θ)` and `τ = 1/D_r`, has the same covariance, `⟨p(t)·p(t′)⟩ = v₀² exp(−|t − t′|/τ)`. Its values at the frames are unknowns
//! of the fit, in units of length as u = pT, and hold each other as
//!
//! ```text
//! S(u) = σ_v²/σ_u² [ ‖u_0‖² + Σ_f ‖u_{f+1} − ρ_f u_f‖² / (1 − ρ_f²) ],      ρ_f = exp(−h_f/τ)
//! ```
//!
//! Over an interval h a cell crawls by `(u_f + u_{f+1})/2 · h/T`. Means over intervals of x = h/τ relaxation times are then correlated as those of
//! the process are, if `σ_u = v₀T/√2 · 2 tanh(x/2)/x`; what their variances differ by is new in each interval and part of σ_v.
//!
//! σ_u, τ and both noise levels follow together from the restricted likelihood. Errors of positions cannot pose as memory, because they are in the
//! same fit: they make successive displacements *anti*-correlated.

use super::alignment::{Ties, share};
use super::drive::Driven;
use super::motions::Motion;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::states::Instant;
use crate::linearisation::Held;
use crate::stiffness::Stiffness;
use crate::{Drives, Error};

/// Marks a cell without a polarity.
pub(super) const NONE: u32 = u32::MAX;

/// How often cells take on the polarity of their neighbours in an interval, at first.
const FIRST_ALIGNMENT: f64 = 0.1;

/// How the polarity of a cell goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Memory {
    /// x = T/τ: relaxation times in the usual interval T.
    pub times: f64,
    /// σ_p = σ_u/T: standard deviation of one component, as a velocity.
    pub speed: f64,
    /// Which share of the variance of first polarities is independent of where the cells are.
    pub free: f64,
    /// J T: how often in the usual interval a cell takes on the polarity of its neighbours; zero if it does not.
    pub alignment: f64,
}

impl Memory {
    /// Before anything is known.
    pub const FIRST: Self = Self { times: 0.1, speed: 0.5, free: 1.0, alignment: 0.0 };

    /// Before anything is known, of cells that may align or do not.
    pub fn first(align: bool) -> Self {
        Self { alignment: if align { FIRST_ALIGNMENT } else { 0.0 }, ..Self::FIRST }
    }

    /// v₀, the root mean square of the polarity of cells that do not align.
    pub fn root_mean_square(self) -> f64 {
        let half = 0.5 * self.times;
        self.speed * 2.0_f64.sqrt() * half / half.tanh()
    }

    /// Of cells with this v₀ that do not align, and of which D_r T and J T are these.
    pub fn of(root_mean_square: f64, times: f64, alignment: f64) -> Self {
        let unit = Self { times, speed: 1.0, free: 1.0, alignment };
        Self { speed: root_mean_square / unit.root_mean_square(), ..unit }
    }

    /// ρ, a, and the standard deviation of what is new in a component, as a velocity, after so many usual intervals.
    pub fn step(self, since: f64) -> [f64; 3] {
        let (own, rho) = innovation(since, self.times);
        [rho, share(self, since), self.speed / own.sqrt()]
    }

    /// The correlation of the mean polarities of successive intervals.
    pub fn correlation(self) -> f64 {
        let x = self.times;
        // The difference loses digits where x is small.
        if x < 1e-3 {
            return 1.0 - 2.0 * x / 3.0;
        }
        (1.0 - (-x).exp()).powi(2) / (2.0 * (x - 1.0 + (-x).exp()))
    }

    /// How far two are from each other.
    pub fn change(self, other: Self) -> f64 {
        let gone = |x: f64, y: f64| ((-x).exp() - (-y).exp()).abs();
        gone(self.times, other.times)
            + gone(self.alignment, other.alignment)
            + (self.speed / other.speed).ln().abs()
    }
}

/// The unknown polarities of a movie: of each cell at the frames at which motions begin or end that are explained.
#[derive(Debug, Clone, Default)]
pub(crate) struct Polarities {
    /// Block of each cell of each frame; [`NONE`] where there is none.
    pub block: Vec<Vec<u32>>,
    /// First block.
    first: usize,
    /// The neighbours of each in its frame.
    pub(super) ties: Ties,
    /// The first ones of the tracks.
    pub firsts: Vec<First>,
    /// Number of the terms on which first polarities are regressed: the first ones of the model. Their γ stand behind (see [`super::outset`]).
    pub terms: usize,
    /// The time since the polarity before of the same cell, in usual intervals; one for each block.
    pub(super) since: Vec<Option<f64>>,
    /// What may drive them, and those that are.
    pub drives: Drives,
    pub(super) driven: Vec<Driven>,
}

/// The first polarity of a track.
#[derive(Debug, Clone, Copy)]
pub(crate) struct First {
    pub frame: usize,
    /// Index among the cells of the frame.
    pub cell: usize,
    pub block: usize,
}

impl Polarities {
    /// Behind all other blocks, for a model of so many terms.
    pub fn new(movie: &Movie, instants: &[Instant], motions: &[Motion], first: usize, terms: usize) -> Self {
        let mut block: Vec<Vec<u32>> =
            instants.iter().map(|instant| vec![NONE; instant.tracks.len()]).collect();
        let mut of_tracks: Vec<Vec<(usize, u32)>> = vec![Vec::new(); movie.tracks.len()];
        for motion in motions {
            for (end, cell) in motion.cells.iter().enumerate() {
                let at = (motion.interval + end, *cell);
                let own = &mut of_tracks[motion.track as usize];
                if own.last() != Some(&at) {
                    own.push(at);
                }
            }
        }
        let (mut since, mut firsts) = (Vec::new(), Vec::new());
        for all in of_tracks {
            let mut before = None;
            for (frame, cell) in all {
                let own = first + since.len();
                if before.is_none() {
                    firsts.push(First { frame, cell: cell as usize, block: own });
                }
                block[frame][cell as usize] = own as u32;
                let time = movie.times[frame] / movie.interval();
                since.push(before.map(|before| time - before));
                before = Some(time);
            }
        }
        Self { block, first, firsts, since, terms, ..Self::default() }
    }

    /// Number of polarities.
    pub fn count(&self) -> usize {
        self.since.len()
    }

    /// Blocks of the polarities.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count()
    }

    /// Number of polarities, of blocks of γ and of those of drives.
    pub fn blocks(&self) -> usize {
        self.count() + self.terms.div_ceil(2) + usize::from(self.drives.any())
    }

    /// Blocks of γ.
    pub fn gamma(&self) -> std::ops::Range<usize> {
        let first = self.first + self.count();
        first..first + self.terms.div_ceil(2)
    }

    /// Adds how they hold each other, with σ_v²/σ_u².
    fn hold(&self, memory: Memory, ratio: f64, stiffness: &mut Stiffness) {
        if self.align() {
            return self.hold_aligned(memory, ratio, stiffness);
        }
        for (since, block) in self.since.iter().zip(self.first..) {
            let Some(since) = since else { continue };
            let (own, rho) = innovation(*since, memory.times);
            stiffness.of_blocks[block] += ratio * own;
            stiffness.of_blocks[block - 1] += ratio * own * rho * rho;
            stiffness.couplings.push((block as u32, block as u32 - 1, ratio * own * rho));
        }
        self.release(memory, ratio, stiffness);
    }

    /// −log det of the covariance of all polarities, in units of σ_v².
    pub fn log_determinant(&self, memory: Memory, ratio: f64) -> Result<f64, Error> {
        let later = self.since.iter().flatten().map(|since| 2.0 * innovation(*since, memory.times).0.ln());
        let firsts = match self.align() {
            true => self.log_determinant_of_firsts(memory)?,
            false => -2.0 * self.firsts.len() as f64 * memory.free.ln(),
        };
        Ok(2.0 * self.count() as f64 * ratio.ln() + later.sum::<f64>() + firsts)
    }
}

/// `1/(1 − ρ²)` and ρ of a polarity after so long.
pub(super) fn innovation(since: f64, times: f64) -> (f64, f64) {
    let rho = (-times * since).exp();
    (1.0 / (1.0 - rho * rho), rho)
}

impl MovieObjective<'_> {
    /// What holds the unknowns beside the data.
    pub(super) fn stiffness(&self) -> Stiffness {
        let own = self.states.polarities.range();
        let mut of_blocks = vec![self.floor(); self.states.blocks()];
        of_blocks[..self.states.start.len()].fill(self.stiffness_of_room());
        self.states.anchors.iter().for_each(|place| of_blocks[*place as usize] = 0.0);
        let mut stiffness = Stiffness { of_blocks, couplings: Vec::new() };
        if let Some(memory) = self.memory {
            stiffness.of_blocks[own].fill(0.0);
            self.states.polarities.hold(memory, self.ratio(memory), &mut stiffness);
        }
        stiffness
    }

    /// The same with the weights of what is known beforehand.
    pub(super) fn held(&self) -> Held {
        Held { stiffness: self.stiffness(), weights: self.weights_of_known() }
    }

    /// Weights of what is expected of the first polarities, and of what drives them.
    pub(super) fn weights_of_known(&self) -> Vec<f64> {
        let Some(memory) = self.memory else { return Vec::new() };
        let mut weights = vec![self.weight_of_outset()];
        weights.extend(self.states.polarities.weights_of_drives(memory, self.ratio(memory)));
        weights
    }

    /// σ_v²/σ_u²
    pub(super) fn ratio(&self, memory: Memory) -> f64 {
        (self.levels.velocity / (memory.speed * self.movie.interval())).powi(2)
    }

    /// Weight of what is expected of the first polarities.
    pub(super) fn weight_of_outset(&self) -> f64 {
        self.memory.map_or(0.0, |memory| self.ratio(memory) / memory.free)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// Frames at which two cells are seen, in usual intervals, one with a gap.
    const TIMES: [&[f64]; 2] = [&[0.0, 1.0, 2.0, 4.5], &[1.0, 2.0]];

    /// What holds polarities is the inverse of the covariance of an Ornstein-Uhlenbeck process, and so is its determinant.
    #[test]
    fn polarities_hold_each_other_as_the_process_does() {
        let (times, ratio, free) = (0.3, 2.5, 0.6);
        let since = |own: &[f64]| -> Vec<Option<f64>> {
            (0..own.len()).map(|k| k.checked_sub(1).map(|before| own[k] - own[before])).collect()
        };
        let polarities =
            Polarities { since: TIMES.iter().flat_map(|own| since(own)).collect(), ..Polarities::default() };
        let first = |block: usize| First { frame: 0, cell: 0, block };
        let polarities = Polarities { firsts: vec![first(0), first(TIMES[0].len())], ..polarities };
        let count = polarities.count();
        let mut stiffness = Stiffness { of_blocks: vec![0.0; count], couplings: Vec::new() };
        let memory = Memory { times, speed: 1.0, free, alignment: 0.0 };
        polarities.hold(memory, ratio, &mut stiffness);
        // The first ones are held to what is expected of them.
        polarities.since.iter().enumerate().filter(|(_, since)| since.is_none()).for_each(|(block, _)| {
            stiffness.of_blocks[block] += ratio / free;
        });
        let unit =
            |k: usize| -> Vec<f64> { (0..2 * count).map(|j| f64::from(u8::from(j == 2 * k))).collect() };
        let precision = DMatrix::from_fn(count, count, |i, j| stiffness.times(&unit(j))[2 * i]);
        let at: Vec<(usize, f64)> = TIMES
            .iter()
            .enumerate()
            .flat_map(|(cell, own)| own.iter().map(move |time| (cell, *time)))
            .collect();
        // The first polarity varies less by the share that is not free.
        let covariance = DMatrix::from_fn(count, count, |i, j| {
            let ((cell, time), (other, later)) = (at[i], at[j]);
            let since_first = time.min(later) - TIMES[cell][0];
            let less = (1.0 - free) * (-2.0 * times * since_first).exp();
            let shared = (-times * (time - later).abs()).exp() * (1.0 - less) / ratio;
            if cell == other { shared } else { 0.0 }
        });
        assert!((&precision * &covariance - DMatrix::identity(count, count)).amax() < 1e-12);
        let expected = 2.0 * precision.determinant().ln();
        assert!((polarities.log_determinant(memory, ratio).unwrap() - expected).abs() < 1e-10);
    }

    /// Means over intervals of what is interpolated between the polarities at frames are correlated as those of the process, and the speed
    /// is that at any time.
    #[test]
    fn means_over_intervals_are_those_of_the_process() {
        for times in [1e-4, 0.02, 0.5, 2.0] {
            let memory = Memory { times, speed: 0.7, ..Memory::FIRST };
            let rho = (-times).exp();
            // Of (u_0 + u_1)/2 with (u_1 + u_2)/2, σ_u = 1.
            let neighbours = 0.25 * (1.0 + 2.0 * rho + rho * rho);
            let v_0 = memory.root_mean_square();
            // ∫∫ v_0²/2 exp(−|s − t|) over an interval of x and the next.
            let of_process = 0.5 * v_0 * v_0 * (1.0 - rho).powi(2) / (times * times);
            let own = memory.speed * memory.speed * neighbours;
            assert!((own / of_process - 1.0).abs() < 1e-6, "{times}: {own} {of_process}");
        }
        let correlation = |times: f64| Memory { times, speed: 1.0, ..Memory::FIRST }.correlation();
        assert!((correlation(9.99e-4) - correlation(1.001e-3)).abs() < 1e-5);
        assert!(correlation(1e-4) > 0.999 && correlation(20.0) < 0.03);
    }
}
