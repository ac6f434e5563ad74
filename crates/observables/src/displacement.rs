//! How far cells get.

use crate::Error;
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// The mean square displacement at each lag of 0, 1, … frames, over cells and over all pairs of frames that far apart:
///
/// `MSD(k) = ⟨|r_i(t + k) − r_i(t)|²⟩`
///
/// `frames` are unwrapped positions (F, N); the result has F entries, in the square of their unit. Pairs of frames overlap,
/// so entries at large lags rest on few independent ones. Costs `N F²/2` displacements.
///
/// # Errors
/// [`Error::Cells`] if frames have different numbers of cells.
///
/// ```
/// use voronudge_geometry::Vector;
/// use voronudge_observables::mean_square_displacement;
/// let frames: Vec<Vec<_>> = (0..4).map(|t| vec![Vector::new(0.5 * t as f64, 0.0); 3]).collect();
/// assert_eq!(mean_square_displacement(&frames)?, [0.0, 0.25, 1.0, 2.25]);
/// # Ok::<(), voronudge_observables::Error>(())
/// ```
pub fn mean_square_displacement(frames: &[Vec<Vector<f64>>]) -> Result<Vec<f64>, Error> {
    let cells = frames.first().map_or(0, Vec::len);
    if let Some(frame) = frames.iter().position(|frame| frame.len() != cells) {
        return Err(Error::Cells { frame, cells, found: frames[frame].len() });
    }
    let at_lag = |lag: usize| {
        let pairs = frames.iter().zip(&frames[lag..]);
        let sum: f64 = pairs
            .map(|(from, to)| from.iter().zip(to).map(|(from, to)| (to - from).norm_squared()).sum::<f64>())
            .sum();
        sum / ((frames.len() - lag) * cells.max(1)) as f64
    };
    Ok((0..frames.len()).into_par_iter().map(at_lag).collect())
}
