//! Where the residual is structured: what each cell and its neighbours have in common.

use super::ResidualField;
use super::pool::Pool;
use super::split::Ring;
use voronudge_geometry::Vector;

/// The residual around one cell, in the frame's standard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalResidual {
    /// Mean over the cell and its neighbours. White noise leaves about 0.4 in each component.
    pub mean: Vector<f64>,
    /// `u · (mean of the neighbours' u) / ⟨|u|²⟩`, positive where neighbours move together; its mean over cells is about
    /// Moran's index. Zero without neighbours.
    pub coherence: f64,
    /// Divergence and curl of an affine fit to the cell and its neighbours, per length; `None` with fewer than four
    /// neighbours, or neighbours on a line.
    pub gradient: Option<[f64; 2]>,
}

/// Maps of the residual: one for each frame, one entry for each residual.
pub fn maps(frames: &[ResidualField<'_>]) -> Vec<Vec<LocalResidual>> {
    let pool = Pool::new(frames);
    let scale = pool.mean_square().max(f64::MIN_POSITIVE);
    let local = |frame: &ResidualField<'_>, start: usize, i: usize| {
        let near = &frame.neighbours[i];
        let own = pool.residuals[start + i];
        let sum: Vector<f64> = near.iter().map(|&j| pool.residuals[start + j as usize]).sum();
        let count = near.len() as f64;
        let gradient = Ring::new(frame, start, i).map(|ring| ring.gradient(|j| pool.residuals[j]));
        LocalResidual {
            mean: (own + sum) / (count + 1.0),
            coherence: own.dot(&sum) / (count.max(1.0) * scale),
            gradient: gradient.map(|gradient| [gradient.divergence(), gradient.curl()]),
        }
    };
    frames
        .iter()
        .zip(&pool.starts)
        .map(|(frame, &start)| (0..frame.places.len()).map(|i| local(frame, start, i)).collect())
        .collect()
}
