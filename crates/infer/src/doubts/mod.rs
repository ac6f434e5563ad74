//! Reasons not to trust a fit: each a question to the data or to the residuals, with its figures.
//!
//! | file | question |
//! |---|---|
//! | `voids` | are there empty places where cells were not seen? |
//! | `tails` | do few residuals stand out? |
//! | `steps` | are velocities differences of positions over too long a time? |
//! | `examine` | these, the structure of the residuals in space, and measurement effects of the catalogue as score tests |
//!
//! Each is a pure function of places or residuals. The level of every test is [`LEVEL`].

mod examine;
mod steps;
mod tails;
mod voids;

pub(crate) use examine::{EXACT, examine, examine_residuals};
pub(crate) use steps::turning;
pub(crate) use tails::tails;
pub use voids::Voids;
pub(crate) use voids::voids;

/// The probability of a doubt of one kind about data that are as the fit takes them.
const LEVEL: f64 = 0.001;

/// A reason not to trust a fit, with its figures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Doubt {
    /// The objective is above its expected value by this many standard deviations: a wrong minimum, noise levels that are
    /// too small, or a model that lacks something.
    Objective(f64),
    /// The estimate of the position noise is at its largest value.
    PositionNoise,
    /// The optimiser used up its steps.
    Steps,
    /// There are empty places as cells leave that were not seen.
    Voids(Voids),
    /// The residuals scatter by this factor more than the smaller half of them implies: a few are wrong.
    Tails(f64),
    /// The residuals of neighbours, or over long distances, are alike.
    Pattern,
    /// Velocities are differences of positions between which cells move by this share of ℓ₀.
    LongSteps(f64),
    /// Along the fitted paths cells move so many times as fast as they get on from frame to frame: they turn around in between.
    Turning(f64),
    /// Residuals follow an error of measurement that the catalogue of effects knows, with this coefficient.
    Effect(&'static str, f64),
    /// A finer integration of the motion between frames would change a coefficient by so many standard errors, but is too dear.
    Integration(f64),
}

/// What of a fit is in doubt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The sum of squares as a whole.
    Objective,
    /// How precise the positions are.
    PositionNoise,
    /// The way to the minimum.
    Optimiser,
    /// Which cells there are.
    Cells,
    /// A few velocities or positions.
    Outliers,
    /// What the residuals have in common.
    Pattern,
    /// How velocities follow from tracks.
    Tracks,
    /// What a position is: a site, or a centroid.
    Positions,
    /// What a grid point of a flow field stands for.
    Window,
}

impl Doubt {
    /// What it is about.
    pub fn part(&self) -> Part {
        match self {
            Self::Objective(_) => Part::Objective,
            Self::PositionNoise => Part::PositionNoise,
            Self::Steps => Part::Optimiser,
            Self::Voids(_) => Part::Cells,
            Self::Tails(_) => Part::Outliers,
            Self::Pattern => Part::Pattern,
            Self::LongSteps(_) | Self::Turning(_) | Self::Integration(_) | Self::Effect("time_lag", _) => {
                Part::Tracks
            }
            Self::Effect("flow_blur", _) => Part::Window,
            Self::Effect(..) => Part::Positions,
        }
    }
}

impl Part {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Objective => "objective",
            Self::PositionNoise => "position_noise",
            Self::Optimiser => "optimiser",
            Self::Cells => "cells",
            Self::Outliers => "outliers",
            Self::Pattern => "pattern",
            Self::Tracks => "tracks",
            Self::Positions => "positions",
            Self::Window => "window",
        }
    }

    /// Whether it is the measurement that is in doubt, and neither the model nor the fit.
    pub fn is_measurement(self) -> bool {
        match self {
            Self::Objective | Self::Optimiser | Self::Pattern => false,
            Self::PositionNoise
            | Self::Cells
            | Self::Outliers
            | Self::Tracks
            | Self::Positions
            | Self::Window => true,
        }
    }
}
