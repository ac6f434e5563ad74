//! How the polarities of neighbours hold each other.
//!
//! A cell that aligns turns its polarity towards those of its neighbours: `ṗ_i = −p_i/τ + (J/6) Σ_j (p_j − p_i) + noise`. From one frame to the
//! next, with L the Laplacian of the graph of neighbours over six,
//!
//! ```text
//! u_{f+1} = ρ_f M u_f + noise,     M = 1 − a L,     a = 1 − exp(−J h_f)
//! ```
//!
//! with the noise of cells that do not align, of variance σ_u² (1 − ρ²). Where neighbours stay, a mode of L with the eigenvalue λ has the variance
//! `σ_u² (1 − ρ²) / (1 − ρ² (1 − aλ)²)`; so have the first polarities of the cells whose tracks begin in one frame. Neighbours without a polarity hold
//! nothing.

use super::instants::Instant;
use super::memory::{Memory, innovation, share};
use super::polarities::{NONE, Polarities, Ties};
use crate::Error;
use crate::stiffness::Stiffness;
use voronudge_linalg::{Cholesky, SymmetricMatrix};

/// Neighbours of a cell on average, and so many that more hold it no more strongly: L then has no eigenvalue near two, at which a fast J would turn
/// polarities round in every interval, and further with each.
const USUAL_NEIGHBOURS: f64 = 6.0;
const MOST_NEIGHBOURS: f64 = 9.0;

/// Polarities of which the variance is computed, at most: evenly chosen ones.
const SAMPLES: usize = 300;

/// The weights of neighbours in L, which are symmetric: one over six, but less around cells with very many.
pub(crate) fn weighted(neighbours: Vec<Vec<u32>>) -> Vec<Vec<(u32, f64)>> {
    let crowded = |cell: usize| (neighbours[cell].len() as f64 / MOST_NEIGHBOURS).max(1.0);
    let of_cell = |cell: usize| {
        let weight =
            |other: &u32| (*other, 1.0 / (USUAL_NEIGHBOURS * crowded(cell).max(crowded(*other as usize))));
        neighbours[cell].iter().map(weight).collect()
    };
    (0..neighbours.len()).map(of_cell).collect()
}

/// Entries of a symmetric matrix to be summed: the later unknown, the earlier one, the value.
#[derive(Default)]
struct Entries(Vec<(u32, u32, f64)>);

impl Entries {
    /// Adds a factor times the square of a sum of different unknowns.
    fn add_square(&mut self, factor: f64, row: &[(u32, f64)]) {
        for (k, (one, own)) in row.iter().enumerate() {
            for (other, weight) in &row[..=k] {
                self.0.push((*one.max(other), *one.min(other), factor * own * weight));
            }
        }
    }

    /// Each place once, by columns.
    fn summed(mut self) -> Vec<(u32, u32, f64)> {
        self.0.sort_by_key(|(later, earlier, _)| (*earlier, *later));
        self.0.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 += next.2;
            }
            same
        });
        self.0
    }
}

impl Polarities {
    /// With the ties of neighbours, by the frames as they were measured.
    pub fn aligning(mut self, instants: &[Instant]) -> Self {
        let first = self.range().start;
        let mut ties = vec![Vec::new(); self.count()];
        for (blocks, instant) in self.block.iter().zip(instants) {
            let has = |cell: u32| blocks[cell as usize] != NONE;
            let of_cell = |cell: u32| -> Vec<u32> {
                let all = instant.cells.tessellation.neighbours(cell as usize).iter().copied();
                all.filter(|other| has(cell) && has(*other) && *other != cell).collect()
            };
            let all = weighted((0..blocks.len() as u32).map(of_cell).collect());
            for (own, of_cell) in blocks.iter().zip(all).filter(|(own, _)| **own != NONE) {
                let own = &mut ties[*own as usize - first];
                own.extend(of_cell.into_iter().map(|(other, weight)| (blocks[other as usize], weight)));
            }
        }
        self.ties = ties;
        self
    }

    /// Without ties.
    pub fn apart(mut self) -> Self {
        self.ties = Ties::new();
        self
    }

    /// The row of M for a polarity, times a factor, with the neighbours that are `chosen`.
    fn row(&self, block: u32, factor: f64, a: f64, chosen: impl Fn(u32) -> bool) -> Vec<(u32, f64)> {
        let ties = &self.ties[block as usize - self.range().start];
        let mut row = vec![(block, factor)];
        for (other, weight) in ties.iter().filter(|(other, _)| chosen(*other)) {
            let share = factor * a * weight;
            row[0].1 -= share;
            match row.iter_mut().find(|own| own.0 == *other) {
                Some(own) => own.1 += share,
                None => row.push((*other, share)),
            }
        }
        row
    }

    /// The row of L for a polarity.
    pub(super) fn laplacian(&self, block: u32) -> Vec<(u32, f64)> {
        let mut row = self.row(block, -1.0, 1.0, |_| true);
        row[0].1 += 1.0;
        row
    }

    /// Adds how polarities hold each other, with σ_v²/σ_u²: but for what each first one is held by of itself.
    pub(super) fn hold_aligned(&self, memory: Memory, ratio: f64, stiffness: &mut Stiffness) {
        let mut entries = Entries::default();
        for (since, block) in self.since.iter().zip(self.range().start as u32..) {
            let Some(since) = since else { continue };
            let (own, rho) = innovation(*since, memory.times);
            let mut row = self.row(block - 1, -rho, share(memory, *since), |_| true);
            row.push((block, 1.0));
            entries.add_square(ratio * own, &row);
        }
        for firsts in self.firsts_of_frames() {
            self.add_firsts(&firsts, memory, ratio, &mut entries);
        }
        let (own, rho) = innovation(1.0, memory.times);
        for before in self.before_driven() {
            entries.add_square(ratio * own * rho * share(memory, 1.0), &self.laplacian(before));
        }
        self.release(memory, ratio, stiffness);
        for (later, earlier, value) in entries.summed() {
            if later == earlier {
                stiffness.of_blocks[later as usize] += value;
            } else {
                stiffness.couplings.push((later, earlier, -value));
            }
        }
    }

    /// Adds `ρ²/(1 − ρ²) (1 − M²)` for first polarities of one frame: how much more than one is the inverse of their variance.
    fn add_firsts(&self, firsts: &[u32], memory: Memory, ratio: f64, entries: &mut Entries) {
        let (own, rho) = innovation(1.0, memory.times);
        let (more, a) = (ratio * own * rho * rho, share(memory, 1.0));
        for block in firsts {
            entries.0.push((*block, *block, more));
            let row = self.row(*block, 1.0, a, |other| firsts.binary_search(&other).is_ok());
            entries.add_square(-more, &row);
        }
    }

    /// The first polarities that begin in each frame, ascending.
    fn firsts_of_frames(&self) -> Vec<Vec<u32>> {
        let mut all = vec![Vec::new(); self.block.len()];
        self.firsts.iter().for_each(|first| all[first.frame].push(first.block as u32));
        all.iter_mut().for_each(|own| own.sort_unstable());
        all.retain(|own| !own.is_empty());
        all
    }

    /// `1/φ + ρ²/(1 − ρ²) (1 − M²)` of first polarities of one frame.
    fn of_firsts(&self, firsts: &[u32], memory: Memory) -> Result<SymmetricMatrix, Error> {
        let mut entries = Entries::default();
        self.add_firsts(firsts, memory, 1.0, &mut entries);
        entries.0.extend(firsts.iter().map(|block| (*block, *block, 1.0 / memory.free)));
        let number = |block: u32| firsts.binary_search(&block).unwrap_or_default();
        let (mut start, mut row, mut value) = (vec![0; firsts.len() + 1], Vec::new(), Vec::new());
        for (later, earlier, entry) in entries.summed() {
            start[number(earlier) + 1] += 1;
            row.push(number(later));
            value.push(entry);
        }
        (0..firsts.len()).for_each(|k| start[k + 1] += start[k]);
        Ok(SymmetricMatrix::new(start, row, value)?)
    }

    /// −log det of the covariance of the first polarities, in units of σ_u².
    pub(super) fn log_determinant_of_firsts(&self, memory: Memory) -> Result<f64, Error> {
        let of_frame =
            |firsts: &Vec<u32>| Ok(2.0 * Cholesky::new(&self.of_firsts(firsts, memory)?)?.log_determinant());
        self.firsts_of_frames().iter().map(of_frame).sum()
    }

    /// The mean variance of the polarities of cells that align, in units of that of cells that do not.
    pub(super) fn mean_variance(&self, memory: Memory) -> Result<f64, Error> {
        let all = self.firsts_of_frames();
        let Some(firsts) = all.iter().max_by_key(|own| own.len()).filter(|_| memory.alignment > 0.0) else {
            return Ok(1.0);
        };
        let factor = Cholesky::new(&self.of_firsts(firsts, Memory { free: 1.0, ..memory })?)?;
        let stride = firsts.len().div_ceil(SAMPLES);
        let of_one = |k: usize| {
            let mut solved = vec![0.0; firsts.len()];
            solved[k] = 1.0;
            factor.solve(&mut solved);
            solved[k]
        };
        let chosen: Vec<f64> = (0..firsts.len()).step_by(stride).map(of_one).collect();
        Ok(chosen.iter().sum::<f64>() / chosen.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::super::polarities::First;
    use super::*;
    use nalgebra::DMatrix;

    /// Cells in a ring, each with two neighbours, over some frames: what holds their polarities is the inverse of the covariance of the stationary
    /// process, and so is its determinant.
    #[test]
    fn aligned_polarities_hold_each_other_as_the_process_does() {
        let (cells, frames, ratio) = (7, 3, 2.5);
        let memory = Memory { times: 0.3, speed: 1.0, free: 1.0, alignment: 0.8 };
        let block = |cell: usize, frame: usize| (frames * cell + frame) as u32;
        let at = |k: usize| (k / frames, k % frames);
        let count = cells * frames;
        let ties = (0..count).map(at).map(|(cell, frame)| {
            [1, cells - 1].map(|step| (block((cell + step) % cells, frame), 1.0 / 6.0)).to_vec()
        });
        let firsts = (0..cells).map(|cell| First { frame: 0, cell, block: frames * cell });
        let mut polarities = Polarities::default();
        polarities.block =
            (0..frames).map(|frame| (0..cells).map(|cell| block(cell, frame)).collect()).collect();
        polarities.since = (0..count).map(|k| (at(k).1 > 0).then_some(1.0)).collect();
        polarities.firsts = firsts.collect();
        polarities.ties = ties.collect();
        let mut stiffness = Stiffness { of_blocks: vec![0.0; count], couplings: Vec::new() };
        polarities.hold_aligned(memory, ratio, &mut stiffness);
        polarities.firsts.iter().for_each(|first| stiffness.of_blocks[first.block] += ratio);
        let unit =
            |k: usize| -> Vec<f64> { (0..2 * count).map(|j| f64::from(u8::from(j == 2 * k))).collect() };
        let precision = DMatrix::from_fn(count, count, |i, j| stiffness.times(&unit(j))[2 * i]);
        let (a, rho) = (1.0 - (-0.8_f64).exp(), (-0.3_f64).exp());
        let near = |i: usize, j: usize| (i + 1) % cells == j || (j + 1) % cells == i;
        let step = DMatrix::from_fn(cells, cells, |i, j| match (i == j, near(i, j)) {
            (true, _) => rho * (1.0 - 2.0 * a / 6.0),
            (_, true) => rho * a / 6.0,
            _ => 0.0,
        });
        let identity = DMatrix::identity(cells, cells);
        let stationary = (identity - &step * &step).try_inverse().unwrap() * ((1.0 - rho * rho) / ratio);
        let covariance = DMatrix::from_fn(count, count, |i, j| {
            let ((one, early), (other, late)) = (at(i), at(j));
            (&stationary * step.pow(early.abs_diff(late) as u32))[(one, other)]
        });
        assert!((&precision * &covariance - DMatrix::identity(count, count)).amax() < 1e-12);
        let expected = 2.0 * precision.determinant().ln();
        assert!((polarities.log_determinant(memory, ratio).unwrap() - expected).abs() < 1e-10);
        let mean = stationary.trace() / cells as f64 * ratio;
        assert!((polarities.mean_variance(memory).unwrap() - mean).abs() < 1e-12);
    }

    /// Around a cell with twelve neighbours, in one frame, polarities of cells that turn as fast as can be are still stationary.
    #[test]
    fn cells_with_many_neighbours_do_not_turn_round() {
        let count = 13;
        let star = |cell: u32| if cell == 0 { (1..count).collect() } else { vec![0] };
        let mut polarities = Polarities::default();
        polarities.ties = weighted((0..count).map(star).collect());
        let first = |cell: usize| First { frame: 0, cell, block: cell };
        polarities.firsts = (0..count as usize).map(first).collect();
        polarities.block = vec![(0..count).collect()];
        polarities.since = vec![None; count as usize];
        let memory = Memory { times: 0.01, speed: 1.0, free: 1.0, alignment: 5.0 };
        let mean = polarities.mean_variance(memory).unwrap();
        assert!((0.0..1.0).contains(&mean), "{mean}");
        polarities.ties.iter_mut().flatten().for_each(|(_, weight)| *weight = 1.0 / 6.0);
        assert!(polarities.mean_variance(memory).is_err());
    }
}
