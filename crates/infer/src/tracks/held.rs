//! What holds the unknowns of a movie beside the data.

use super::memory::{Memory, innovation};
use super::objective::MovieObjective;
use super::polarities::Polarities;
use crate::Error;
use crate::linearisation::Held;
use crate::stiffness::Stiffness;

impl Polarities {
    /// Adds how they hold each other, with σ_v²/σ_u².
    fn hold(&self, memory: Memory, ratio: f64, stiffness: &mut Stiffness) {
        if self.align() {
            return self.hold_aligned(memory, ratio, stiffness);
        }
        for (since, block) in self.since.iter().zip(self.range().start..) {
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
    use super::super::polarities::First;
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
        let mut polarities = Polarities::default();
        polarities.since = TIMES.iter().flat_map(|own| since(own)).collect();
        let first = |block: usize| First { frame: 0, cell: 0, block };
        polarities.firsts = vec![first(0), first(TIMES[0].len())];
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
}
