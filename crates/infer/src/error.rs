use thiserror::Error;

/// Why an inference cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A snapshot cannot be tessellated.
    #[error("frame {frame}: {source}")]
    Geometry {
        /// Position of the frame in the list given.
        frame: usize,
        /// What is wrong with it.
        source: voronudge_geometry::Error,
    },
    /// Positions and velocities of different number.
    #[error("frame {frame} has {positions} positions but {velocities} velocities")]
    Lengths {
        /// Position of the frame in the list given.
        frame: usize,
        /// Number of positions.
        positions: usize,
        /// Number of velocities.
        velocities: usize,
    },
    /// Not enough measured velocities in the interior of the data.
    #[error(
        "{used} cells have a measured velocity and a trusted neighbourhood, but a fit needs at least {required}"
    )]
    TooFewVelocities {
        /// Number of usable cells.
        used: usize,
        /// Number needed.
        required: usize,
    },
    /// All velocities are zero.
    #[error("all measured velocities are zero")]
    NothingMoves,
    /// Nothing can be forecast.
    #[error("nothing can be forecast: {0}")]
    NoForecast(&'static str),
    /// Simulated cells that do not stay together.
    #[error(
        "simulated cells of the {model} fly apart within {intervals} frames of the first that is simulated"
    )]
    FliesApart {
        /// Which model.
        model: &'static str,
        /// In how many intervals between frames.
        intervals: usize,
    },
    /// Cells that do not stay together between two frames where they follow the model.
    #[error("cells that follow the model from frame {frame} on fly apart before the next")]
    Diverges {
        /// Position of the first of both frames in the list given.
        frame: usize,
    },
    /// Frames that are no movie.
    #[error(
        "{frames} frames at {times} times are no movie: it takes two frames or more, at times that ascend"
    )]
    Frames {
        /// Number of frames.
        frames: usize,
        /// Number of times.
        times: usize,
    },
    /// Fewer frames than a course needs.
    #[error("{found} frames, but the course of a pattern needs at least {required}")]
    TooFewFrames {
        /// Number of frames.
        found: usize,
        /// Number needed.
        required: usize,
    },
    /// Fewer cells than waves are asked for.
    #[error("{found} cells are present in all frames, but {waves} wave vectors need at least {required}")]
    TooFewPatternCells {
        /// Number of cells.
        found: usize,
        /// Number of wave vectors.
        waves: usize,
        /// Number of cells needed.
        required: usize,
    },
    /// A pattern that stays as it is.
    #[error("none of {cells} cells is displaced in any of {frames} frames by a long wave")]
    NoDeformation {
        /// Number of cells.
        cells: usize,
        /// Number of frames.
        frames: usize,
    },
    /// Every parameter is fixed.
    #[error("every parameter is fixed, so there is nothing to fit")]
    NothingToFit,
    /// Parameters that cannot be held, bounded or weighted like this.
    #[error("{0}")]
    Constraint(&'static str),
    /// Data about cells that are for other cells.
    #[error(transparent)]
    Surroundings(#[from] voronudge_model::EnvironmentError),
    /// Data that cannot tell whether cells differ.
    #[error("{0}")]
    Spread(&'static str),
    /// The columns of the model are linearly dependent on these data.
    #[error("the velocities of the fitted terms are linearly dependent on these data")]
    Degenerate,
    /// A noise level that is not positive.
    #[error("the {name} noise is {value}, but it must be positive and finite")]
    Noise {
        /// `position` or `velocity`.
        name: &'static str,
        /// The level.
        value: f64,
    },
    /// The linear algebra failed.
    #[error("the equations of the fit cannot be solved: {0}")]
    Algebra(#[from] voronudge_linalg::Error),
    /// The optimiser failed.
    #[error("the optimiser failed: {0}")]
    Optimiser(String),
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// Advice on what to change, if there is any.
    ///
    /// ```
    /// let error = voronudge_infer::Error::from(voronudge_linalg::Error::NotPositiveDefinite);
    /// assert!(error.to_string().starts_with("the equations of the fit cannot be solved: "));
    /// assert!(error.hint().is_some());
    /// ```
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Geometry { source, .. } => source.hint(),
            Self::TooFewVelocities { .. } => Some(
                "choose frames with velocities and more cells whose neighbours are all seen, or give more frames",
            ),
            Self::NothingMoves => Some("check the velocities, or give frames in which cells move"),
            Self::TooFewFrames { .. } => Some("choose more frames"),
            Self::NoForecast(_) => {
                Some("give the fit fewer of the frames with --frames, so that some are left to be forecast")
            }
            Self::FliesApart { .. } => {
                Some("forces with a negative K_P or K_A have no state of rest: fix them, or fit more frames")
            }
            Self::Diverges { .. } => Some(
                "a parameter that is held or bounded may be far from the right one (mind its unit), or frames too far apart to follow cells between them",
            ),
            Self::TooFewPatternCells { .. } => Some(
                "ask for fewer wave vectors, or choose frames in which more cells are tracked throughout",
            ),
            Self::NoDeformation { .. } => Some("choose frames in which the pattern deforms"),
            Self::NothingToFit => Some("leave at least one of K_A, K_P, P_0, alpha free"),
            Self::Constraint(_) => Some("check --fix, --bounds and --prior; K_P must not be held at zero"),
            Self::Spread(_) => Some("leave --vary out, or give velocities of fewer cells"),
            Self::Degenerate => Some(
                "these cells do not tell all parameters apart, as where all areas or perimeters are alike, or few cells count: fix one of \
                 the parameters, for example K_A, or give more cells or frames",
            ),
            Self::Algebra(voronudge_linalg::Error::OutOfMemory { .. }) => Some("give fewer cells or frames"),
            Self::Algebra(_) => Some(
                "cells that all but coincide, velocities far out of line, or noise levels far from the scatter of the data can do this: \
                 look at the data with observe, or fix a parameter",
            ),
            Self::Noise { .. } => {
                Some("give the standard deviation of one component, in the units of the data")
            }
            _ => None,
        }
    }
}
