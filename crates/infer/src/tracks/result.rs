//! What the fit of a movie answers beyond parameters.

use super::polarity::Polarity;
use super::present::Dynamics;
use crate::Prospects;
use voronudge_geometry::Vector;

/// How the motion between frames is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integration {
    /// Steps from one frame to the next.
    pub substeps: usize,
    /// Order of the rule in the length of a step.
    pub order: usize,
    /// By how much a finer rule would change the coefficients: the largest change, in standard errors.
    pub error: f64,
}

/// The tracks of a movie as the fit found them.
#[derive(Debug, Clone)]
pub struct Tracked {
    /// Where each track is (F, tracks), gaps included; `None` before its beginning and after its end.
    pub trajectories: Vec<Vec<Option<Vector<f64>>>>,
    /// Translation of all cells in each interval.
    pub drifts: Vec<Vector<f64>>,
    /// How the motion is integrated.
    pub integration: Integration,
    /// Polarity of the cells, if it was asked for.
    pub polarity: Option<Polarity>,
    /// What would be known if more, or better, had been measured; none where that was not asked.
    pub prospects: Option<Prospects>,
    /// What went on between frames, for those that come.
    pub(crate) dynamics: Dynamics,
}
