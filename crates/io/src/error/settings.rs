//! Faults of settings, of `dataset.toml`, and of frame selections.

use crate::walled_sides::WalledSides;
use std::path::PathBuf;

/// Why a setting is not acceptable, wherever it was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingFault {
    /// A number that must be finite and above zero.
    #[error("{key} is {value}, it must be finite and above zero")]
    NotPositive {
        /// Name of the setting.
        key: &'static str,
        /// The value given.
        value: f64,
    },
    /// A noise amplitude that must be finite and not negative.
    #[error("{key} is {value}, it must be finite and not negative")]
    Negative {
        /// Name of the setting.
        key: &'static str,
        /// The value given.
        value: f64,
    },
    /// A text that is none of the choices, or not of the form needed.
    #[error("{key} is \"{found}\", expected {expected}")]
    Unknown {
        /// Name of the setting.
        key: &'static str,
        /// The text given.
        found: String,
        /// The choices, in words.
        expected: &'static str,
    },
    /// Nothing says what the boundary is.
    #[error("the boundary is not given{}", searched.as_ref()
        .map(|path| format!(": neither by {} nor otherwise", path.display())).unwrap_or_default())]
    MissingBoundary {
        /// The settings file that was looked for, if a folder was given.
        searched: Option<PathBuf>,
    },
    /// Periodic without a box.
    #[error("boundary is \"periodic\" but no box is given")]
    MissingBox,
    /// A box without a periodic boundary.
    #[error("a box is given but the boundary is {boundary}")]
    BoxNotPeriodic {
        /// The boundary given, in words.
        boundary: &'static str,
    },
    /// A setting that only a periodic box can have.
    #[error("{key} is given but the boundary is open")]
    NeedsBox {
        /// Name of the setting.
        key: &'static str,
    },
    /// A setting that only an open field can have.
    #[error("{key} is given but the boundary is periodic")]
    NeedsOpen {
        /// Name of the setting.
        key: &'static str,
    },
    /// A field of view that is no region.
    #[error("field_of_view: {0}")]
    FieldOfView(voronudge_geometry::Error),
    /// A number that must be finite.
    #[error("{key} has the entry {value}, it must be finite")]
    NotFinite {
        /// Name of the setting.
        key: &'static str,
        /// The value given.
        value: f64,
    },
    /// Offsets of the box for another number of frames.
    #[error("box_offset has {found} entries, but there are {frames} frames")]
    OffsetCount {
        /// Number of entries.
        found: usize,
        /// Number of frames.
        frames: usize,
    },
    /// A share that is not between 0 and 1.
    #[error("{key} is {value}, it must lie between 0 and 1")]
    NoShare {
        /// Name of the setting.
        key: &'static str,
        /// The value given.
        value: f64,
    },
    /// A length beyond the size of the image.
    #[error("{key} is {value:e}, but the image is {} wide and {} high", size[0], size[1])]
    BeyondImage {
        /// Name of the setting.
        key: &'static str,
        /// The length given.
        value: f64,
        /// Width and height of the image.
        size: [f64; 2],
    },
    /// A width without a kind of window.
    #[error("window_width is given but window is not")]
    WidthOfNoWindow,
    /// A window that covers more than all cells there are.
    #[error("window_width is {width}, but the box is {length} wide")]
    WindowTooWide {
        /// The width given.
        width: f64,
        /// The shorter side of the box.
        length: f64,
    },
    /// No file to import a flow field from.
    #[error("no flow field is given")]
    MissingFlow,
    /// Neither a folder nor a positions file.
    #[error("no positions are given")]
    MissingPositions,
    /// A box that is none.
    #[error("{0}")]
    Box(voronudge_geometry::Error),
    /// A box that changes from frame to frame, where one box is needed.
    #[error("the periodic box of these data is sheared")]
    Sheared,
    /// Walls, where a box that repeats is needed.
    #[error("the cells of these data are between walls (\"{walls}\")")]
    Walled {
        /// Which sides are walls.
        walls: WalledSides,
    },
}

impl SettingFault {
    pub(super) fn hint(&self) -> Option<String> {
        let text = match self {
            Self::NotPositive { .. } => "give a positive number, in the units of the data",
            Self::BeyondImage { .. } => "give it in units of length; a fraction of a cell is usual",
            Self::Negative { .. } => "leave it out where the noise is not known",
            Self::Unknown { .. } => "write it as the message says",
            Self::MissingBoundary { .. } => {
                "add boundary = \"open\" or boundary = \"periodic\" with box = [Lx, Ly] to \
                 dataset.toml, or use --open or --box LX LY"
            }
            Self::MissingBox => "add box = [Lx, Ly] to dataset.toml, or use --box LX LY",
            Self::BoxNotPeriodic { .. } => {
                "set boundary = \"periodic\", or remove box if the field of view is open"
            }
            Self::NeedsBox { .. } => "remove it, or set boundary = \"periodic\" and a box",
            Self::NeedsOpen { .. } => "remove it: in a periodic box every cell counts",
            Self::FieldOfView(fault) | Self::Box(fault) => return fault.hint().map(str::to_owned),
            Self::NotFinite { .. } => "give a length for each frame",
            Self::OffsetCount { .. } => {
                "give one number for each frame: how far the image one box above is displaced along x"
            }
            Self::NoShare { .. } => {
                "write 0 for sites, 1 for centroids, or leave it out to have it estimated"
            }
            Self::WidthOfNoWindow => {
                "say of what the width is, window = \"square\", \"gaussian\" or \"gaussian-area\", or leave the width out"
            }
            Self::WindowTooWide { .. } => {
                "give the width in the length unit of the positions, or leave it out to have it estimated"
            }
            Self::MissingFlow => "name the files of the flow, one for each frame",
            Self::MissingPositions => "give a data set folder or --positions FILE",
            Self::Sheared => "take the boundary of each frame",
            Self::Walled { .. } => {
                "without the line walls the box would be periodic, which is another tissue"
            }
        };
        Some(text.into())
    }
}

/// Why a `dataset.toml` cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TomlFault {
    /// Not TOML.
    #[error("malformed TOML: {0}")]
    Syntax(String),
    /// Not UTF-8.
    #[error("is not UTF-8 text")]
    NotText,
    /// A key nobody reads.
    #[error("unknown key \"{key}\"")]
    UnknownKey {
        /// The key found.
        key: String,
        /// The keys known.
        known: &'static [&'static str],
    },
    /// A value of the wrong kind.
    #[error("{key} is {found}, expected {expected}")]
    WrongType {
        /// The key.
        key: &'static str,
        /// The kind found.
        found: &'static str,
        /// The kind expected, with an example.
        expected: &'static str,
    },
    /// A value of the right kind that is not acceptable.
    #[error("{0}")]
    Setting(SettingFault),
}

impl TomlFault {
    pub(super) fn hint(&self) -> Option<String> {
        match self {
            Self::UnknownKey { known, .. } => Some(format!("the keys are {}", known.join(", "))),
            Self::Syntax(_) => Some("write key = value; texts need quotation marks".into()),
            Self::NotText => Some("save the file as UTF-8".into()),
            Self::WrongType { .. } => {
                Some("numbers stand without quotation marks, texts with them, lists in brackets".into())
            }
            Self::Setting(fault) => fault.hint(),
        }
    }
}

/// Why a frame selection cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SelectionFault {
    /// Nothing was typed, or a part between commas is empty.
    #[error("empty")]
    Empty,
    /// A part that is neither a number nor a range.
    #[error("\"{part}\" is neither a frame nor a range of frames")]
    NotANumber {
        /// The part.
        part: String,
    },
    /// A range that ends before or where it starts.
    #[error("the range {start}..{end} holds no frame")]
    Reversed {
        /// First frame.
        start: usize,
        /// End, excluded.
        end: usize,
    },
    /// A frame behind the last one.
    #[error("frame {frame} does not exist, the data set has {total} frames")]
    OutOfRange {
        /// The first frame asked for that does not exist.
        frame: usize,
        /// Frames in the data set.
        total: usize,
    },
    /// A frame asked for twice.
    #[error("frame {frame} is named twice")]
    Twice {
        /// The frame.
        frame: usize,
    },
}

impl SelectionFault {
    pub(super) fn hint(&self) -> Option<String> {
        Some(match self {
            Self::Empty | Self::NotANumber { .. } => {
                "write 6, 4..16 or 4,7,9; frames count from zero and the end is excluded".into()
            }
            Self::Reversed { start, end } if start == end => {
                format!("the end is excluded; for frame {start} alone write {start}")
            }
            Self::Reversed { start, end } => {
                format!("write the smaller number first: {end}..{start}; the end is excluded")
            }
            Self::OutOfRange { total, .. } => match total.checked_sub(1) {
                Some(last) => format!("frames are 0 to {last}; a range may end at {total}"),
                None => "the data set has no frames".into(),
            },
            Self::Twice { .. } => "name each frame once".into(),
        })
    }
}
