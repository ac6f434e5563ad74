//! How the polarities of cells that crawl go on.

use crate::tracks::{Memory, Polarity, weighted};
use voronudge_geometry::{Tessellation, Vector};

/// From frame to frame as in the fit, and on a straight line between.
pub(super) struct Turning {
    memory: Memory,
    /// T, in which the memory counts.
    usual: f64,
    /// Variance of a component of a polarity of which nothing is known.
    variance: f64,
    /// The neighbours whose polarities a cell takes on, with their weights.
    ties: Vec<Vec<(u32, f64)>>,
    /// b and κ
    pub drives: [f64; 2],
}

impl Turning {
    /// Among cells that are neighbours now, with the usual interval.
    pub fn new(polarity: &Polarity, usual: f64, tessellation: &Tessellation, in_view: &[bool]) -> Self {
        let (apart, rate) = match &polarity.alignment {
            Some(own) => (own.speed_apart, own.rate),
            None => (polarity.speed, 0.0),
        };
        let ties = (0..in_view.len()).map(|cell| {
            let both = |other: &&u32| in_view[cell] && in_view[**other as usize];
            tessellation.neighbours(cell).iter().filter(both).copied().collect()
        });
        let drives = [polarity.contact_inhibition, polarity.velocity_alignment];
        Self {
            memory: Memory::of(apart, polarity.rate * usual, rate * usual),
            usual,
            variance: 0.5 * polarity.speed.powi(2),
            ties: weighted(ties.collect()),
            drives: drives.map(|own| own.map_or(0.0, |own| own.value)),
        }
    }

    /// A polarity of which nothing is known.
    pub fn unknown(&self, normal: Vector<f64>) -> Vector<f64> {
        normal * self.variance.sqrt()
    }

    /// The polarities at the next frame, after so long, of cells that so much drives.
    pub fn next(
        &self,
        polarities: &[Vector<f64>],
        time: f64,
        drive: &[Vector<f64>],
        mut normal: impl FnMut() -> Vector<f64>,
    ) -> Vec<Vector<f64>> {
        let [rho, a, new] = self.memory.step(time / self.usual);
        let driven = time * self.memory.kept();
        let of_cell = |(cell, ties): (usize, &Vec<(u32, f64)>)| {
            let own = polarities[cell];
            let to = |(other, weight): &(u32, f64)| (polarities[*other as usize] - own) * *weight;
            let turned = own + ties.iter().map(to).sum::<Vector<f64>>() * a;
            let drive = drive.get(cell).map_or(Vector::zeros(), |drive| drive * driven);
            turned * rho + drive + normal() * new
        };
        self.ties.iter().enumerate().map(of_cell).collect()
    }
}
