//! What is asked of a data set.

use voronudge_infer::{Constraints, KnownNoise, Method, Request, Scale};
use voronudge_io::{DataSet, Difference, Noise};

/// What is asked of a data set. Lengths and times in the units of the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Frames to fit together, ascending; all that have velocities if not said.
    pub frames: Option<Vec<usize>>,
    /// How velocities are derived from tracks where none are given; the tracks themselves are fitted if not said.
    pub difference: Option<Difference>,
    /// What is known of the parameters.
    pub constraints: Constraints,
    /// How the objective is made small.
    pub method: Method,
    /// Seed of further starts.
    pub seed: u64,
    /// Which mean velocity is removed first.
    pub remove_mean: MeanToRemove,
    /// Degree of the polynomials of the position that are no concern of the model in each frame; none if not said.
    pub background: Option<u32>,
    /// In an open field of view, polygons larger than this multiple of the median area are taken for holes in the data.
    pub largest_area: f64,
    /// Whether cells are looked for that were not detected.
    pub detections: Detections,
    /// The scale to use; that of the data if not said.
    pub scale: Option<Scale>,
}

impl Default for Question {
    /// All parameters of the base model from all that there is.
    fn default() -> Self {
        Self {
            frames: None,
            difference: None,
            constraints: Constraints::default(),
            method: Method::default(),
            seed: 0,
            remove_mean: MeanToRemove::Auto,
            background: None,
            largest_area: voronudge_geometry::FieldOfView::default().largest_area,
            detections: Detections::default(),
            scale: None,
        }
    }
}

/// Which mean velocity is removed before a fit: drift of the stage shows as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MeanToRemove {
    /// The median of each frame in an open field, unless velocities of cells are given; none otherwise.
    #[default]
    Auto,
    /// None.
    None,
    /// The median of the velocities used in each frame.
    PerFrame,
}

/// What is done about cells that were not detected, and detections that are no cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Detections {
    /// Nothing.
    AsTheyAre,
    /// They are looked for.
    Completed {
        /// Share of the cells that is not detected; estimated if not said.
        missed_rate: Option<f64>,
    },
}

impl Default for Detections {
    fn default() -> Self {
        Self::Completed { missed_rate: None }
    }
}

impl Question {
    /// What is asked of the fit, in its units.
    ///
    /// Errors of single cells, of which a typical one is given, are those of the positions unless a noise level is stated besides:
    /// then they say how it is shared out.
    pub(super) fn request(&self, data: &DataSet, scale: &Scale, typical_error: Option<f64>) -> Request {
        let level = |noise: Option<Noise>, unit: f64| {
            noise.and_then(|noise| match noise {
                Noise::Absolute(value) => Some(value / unit),
                // Relative to ℓ₀ and to the root mean square velocity, which are one here.
                Noise::Relative(share) => Some(share),
                Noise::Estimated => None,
            })
        };
        Request {
            noise: KnownNoise {
                position: level(data.position_noise.or(typical_error.map(Noise::Absolute)), scale.length),
                velocity: level(data.velocity_noise, scale.velocity()),
            },
            method: self.method,
            seed: self.seed,
            ..Request::new(self.constraints.scaled(scale))
        }
    }
}
