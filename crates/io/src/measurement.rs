//! How cells were measured: what a position is, and what a grid point of a flow field stands for.

use std::fmt;
use std::str::FromStr;

use crate::boundary::Boundary;
use crate::error::{Error, SettingFault};
use crate::positive::positive;

/// What of a cell a position is: its Voronoi site r, the centroid of its polygon, or a point `r + c (centroid − r)` on the way.
///
/// ```
/// use voronudge_io::PositionsAre;
/// assert_eq!("centroids".parse::<PositionsAre>()?, PositionsAre::CENTROIDS);
/// assert_eq!("0.4".parse::<PositionsAre>()?.share(), 0.4);
/// # Ok::<(), voronudge_io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionsAre {
    share: f64,
}

impl PositionsAre {
    /// The points that Voronoi polygons are made of.
    pub const SITES: Self = Self { share: 0.0 };
    /// Centroids, as masks and membranes give them.
    pub const CENTROIDS: Self = Self { share: 1.0 };

    /// The share c of the way from the site to the centroid.
    ///
    /// # Errors
    /// [`Error::Setting`] for a share that is not between 0 and 1.
    pub fn between(share: f64) -> Result<Self, Error> {
        Self::checked(share).map_err(Error::Setting)
    }

    pub(crate) fn checked(share: f64) -> Result<Self, SettingFault> {
        match (0.0..=1.0).contains(&share) {
            true => Ok(Self { share }),
            false => Err(SettingFault::NoShare { key: "positions_are", value: share }),
        }
    }

    /// c: 0 for sites, 1 for centroids.
    #[must_use]
    pub fn share(self) -> f64 {
        self.share
    }

    pub(crate) fn parse(text: &str) -> Result<Self, SettingFault> {
        match (text, text.trim().parse()) {
            ("sites", _) => Ok(Self::SITES),
            ("centroids", _) => Ok(Self::CENTROIDS),
            (_, Ok(share)) => Self::checked(share),
            _ => Err(SettingFault::Unknown {
                key: "positions_are",
                found: text.to_owned(),
                expected: "\"sites\", \"centroids\" or a number from 0 to 1",
            }),
        }
    }
}

impl FromStr for PositionsAre {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        Self::parse(text).map_err(Error::Setting)
    }
}

impl fmt::Display for PositionsAre {
    /// The text that parses back to exactly the same value.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::SITES => f.write_str("sites"),
            Self::CENTROIDS => f.write_str("centroids"),
            Self { share } => write!(f, "{share}"),
        }
    }
}

/// The average that a grid point of a flow field stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WindowKind {
    /// Over a square, in which every point moves with its cell.
    Square,
    /// Over the centres of cells, with Gaussian weights.
    Gaussian,
    /// Over the plane with Gaussian weights, in which every point moves with its cell.
    GaussianArea,
}

impl WindowKind {
    const ALL: [Self; 3] = [Self::Square, Self::Gaussian, Self::GaussianArea];

    pub(crate) fn parse(text: &str) -> Result<Self, SettingFault> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| SettingFault::Unknown {
            key: "window",
            found: text.to_owned(),
            expected: "\"square\", \"gaussian\" or \"gaussian-area\"",
        })
    }

    /// As in files and flags.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Square => "square",
            Self::Gaussian => "gaussian",
            Self::GaussianArea => "gaussian-area",
        }
    }
}

impl FromStr for WindowKind {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        Self::parse(text).map_err(Error::Setting)
    }
}

impl fmt::Display for WindowKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What is declared of the windows of a flow field; what is not is to be estimated.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DeclaredWindow {
    /// The kind.
    pub kind: Option<WindowKind>,
    /// Side of a square or standard deviation of a Gaussian, in units of length. Only with a kind.
    pub width: Option<f64>,
}

impl DeclaredWindow {
    pub(crate) fn check(&self, boundary: Boundary) -> Result<(), SettingFault> {
        let Some(width) = self.width else {
            return Ok(());
        };
        positive("window_width", width)?;
        if self.kind.is_none() {
            return Err(SettingFault::WidthOfNoWindow);
        }
        match boundary {
            Boundary::Periodic { lengths: [x, y] } if width > x.min(y) => {
                Err(SettingFault::WindowTooWide { width, length: x.min(y) })
            }
            _ => Ok(()),
        }
    }
}
