//! Polarities of cells that crawl: what is known of them at the start, and how they go on.

use super::Forecaster;
use super::ahead::Tissue;
use super::past::{Noise, left_of_polarity};
use super::start::{Begun, Start};
use crate::Error;
use crate::tracks::Polarity;
use voronudge_geometry::{Tessellation, Vector};

/// Share of the polarities around that a cell takes on in a step at most.
const TURN: f64 = 0.2;

/// Polarities at the start of a forecast.
pub(super) struct Crawl {
    /// What is expected of each cell.
    expected: Vec<Vector<f64>>,
    /// Variance of a component about that.
    unknown: f64,
    /// How they go on.
    pub turning: Turning,
}

/// How polarities go on.
pub(super) struct Turning {
    /// Variance of a component of those of cells that do not align.
    variance: f64,
    /// D_r
    forgotten: f64,
    /// J/6 and the neighbours whose polarities a cell takes on.
    alignment: Option<(f64, Vec<Vec<u32>>)>,
    /// b and κ
    pub drives: [f64; 2],
}

impl Crawl {
    /// `None` if the model knows of no polarity.
    pub fn new(
        start: &Start<'_>,
        (model, tissue): (&Forecaster<'_>, &Tissue<'_>),
        intervals: &[f64],
        position_noise: f64,
        begun: &Begun,
    ) -> Result<Option<Self>, Error> {
        let Some(polarity) = model.polarity() else { return Ok(None) };
        let variance = 0.5 * polarity.speed.powi(2);
        let noise =
            Noise { scatter: tissue.scatter(), position: position_noise, sensitivity: tissue.sensitivity() };
        let left = left_of_polarity((variance, polarity.rate), intervals, noise)?;
        let expected = begun.polarities.clone();
        // What is expected and what is not known of it make up the whole; of cells that align the whole is another.
        let told =
            expected.iter().map(Vector::norm_squared).sum::<f64>() / (2 * expected.len().max(1)) as f64;
        let unknown = if polarity.alignment.is_none() { left.max(variance - told) } else { left };
        let turning = Turning::new(polarity, &start.cells.tessellation, &start.in_view);
        Ok(Some(Self { expected, unknown, turning }))
    }

    /// Polarities at the start, with what is not known of them drawn.
    pub fn begin(&self, mut normal: impl FnMut() -> Vector<f64>) -> Vec<Vector<f64>> {
        self.expected.iter().map(|mean| mean + normal() * self.unknown.sqrt()).collect()
    }
}

impl Turning {
    /// Among cells that are neighbours now.
    pub fn new(polarity: &Polarity, tessellation: &Tessellation, in_view: &[bool]) -> Self {
        let alignment = polarity.alignment.as_ref().map(|own| {
            let ties = (0..in_view.len()).map(|cell| {
                let both = |other: &&u32| in_view[cell] && in_view[**other as usize];
                tessellation.neighbours(cell).iter().filter(both).copied().collect()
            });
            (own.rate / 6.0, ties.collect())
        });
        let drives = [polarity.contact_inhibition, polarity.velocity_alignment];
        let drives = drives.map(|own| own.map_or(0.0, |own| own.value));
        Self { variance: 0.5 * polarity.speed.powi(2), forgotten: polarity.rate, alignment, drives }
    }

    /// A polarity of which nothing is known.
    pub fn unknown(&self, normal: Vector<f64>) -> Vector<f64> {
        normal * self.variance.sqrt()
    }

    /// Goes on for a short time.
    pub fn go_on(&self, polarities: &mut [Vector<f64>], time: f64, mut normal: impl FnMut() -> Vector<f64>) {
        let kept = (-self.forgotten * time).exp();
        let drawn = (self.variance * (1.0 - kept * kept)).sqrt();
        polarities.iter_mut().for_each(|p| *p = *p * kept + normal() * drawn);
        let Some((rate, ties)) = &self.alignment else { return };
        let most = ties.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let parts = (rate * most * time / TURN).ceil().max(1.0);
        for _ in 0..parts as usize {
            let own = |(cell, all): (usize, &Vec<u32>)| {
                let to = |other: &u32| polarities[*other as usize] - polarities[cell];
                all.iter().map(to).sum::<Vector<f64>>() * (rate * time / parts)
            };
            let turned: Vec<Vector<f64>> = ties.iter().enumerate().map(own).collect();
            polarities.iter_mut().zip(turned).for_each(|(p, turn)| *p += turn);
        }
    }
}
