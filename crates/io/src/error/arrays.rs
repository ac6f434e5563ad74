//! Faults of arrays: the file format, the shape, the values.

use super::ShapeText;

/// Why a file is not the `.npy` array it should be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatFault {
    /// The file has no bytes.
    #[error("is empty (0 bytes), a .npy array is needed")]
    Empty,
    /// The file does not begin like a `.npy` file.
    #[error("is not a .npy file: it begins with the bytes {}", hex(first))]
    NotNpy {
        /// The first bytes, at most six.
        first: Vec<u8>,
    },
    /// A format version this reader does not know.
    #[error("has .npy format version {major}.{minor}, versions 1.0 to 3.0 are known")]
    UnknownVersion {
        /// Major version.
        major: u8,
        /// Minor version.
        minor: u8,
    },
    /// The file ends inside its header.
    #[error("ends inside its header: {needed} bytes needed, {found} found")]
    HeaderCut {
        /// Bytes the header takes.
        needed: u64,
        /// Bytes in the file.
        found: u64,
    },
    /// The header cannot be understood.
    #[error("has a malformed .npy header: {detail}")]
    HeaderMalformed {
        /// What was not understood.
        detail: String,
    },
    /// The elements have a type this reader does not take.
    #[error("has elements of type {found}, {needed} are needed")]
    UnsupportedType {
        /// The type as the header names it.
        found: String,
        /// The types taken here.
        needed: &'static str,
    },
    /// The header promises more than the file holds.
    #[error("is truncated: its header claims shape {} of {item_type}, {}, but {found} bytes follow",
        ShapeText(shape), claim(*needed))]
    Truncated {
        /// The shape the header claims.
        shape: Vec<usize>,
        /// The element type the header claims.
        item_type: String,
        /// Bytes needed; `None` beyond 64 bits.
        needed: Option<u64>,
        /// Bytes after the header.
        found: u64,
    },
    /// The file goes on behind the array.
    #[error("has {extra} bytes behind the array of shape {}", ShapeText(shape))]
    Trailing {
        /// The shape the header claims.
        shape: Vec<usize>,
        /// Bytes too many.
        extra: u64,
    },
    /// An unsigned integer above what a label can be.
    #[error("holds the integer {value}, the largest allowed is {}", i64::MAX)]
    IntegerTooLarge {
        /// The value found.
        value: u64,
    },
}

impl FormatFault {
    pub(super) fn hint(&self) -> Option<String> {
        let text = match self {
            Self::NotNpy { first } if first.starts_with(b"PK") => {
                "this looks like an .npz archive; save the one array with numpy.save"
            }
            Self::NotNpy { first } if first.starts_with(&[0x1f, 0x8b]) => {
                "this looks gzip-compressed; decompress it first"
            }
            Self::NotNpy { .. } => "save the array with numpy.save",
            Self::Empty | Self::HeaderCut { .. } | Self::Truncated { .. } => {
                "the file was probably cut while it was written or copied; write it again"
            }
            Self::Trailing { .. } | Self::HeaderMalformed { .. } | Self::UnknownVersion { .. } => {
                "write the array again with numpy.save"
            }
            Self::UnsupportedType { .. } => {
                "convert it with numpy.astype(\"float64\"), or astype(\"int64\") for labels"
            }
            Self::IntegerTooLarge { .. } => "renumber the labels from zero",
        };
        Some(text.into())
    }
}

/// Why the shape of an array does not fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeFault {
    /// The wrong number of dimensions.
    #[error("has shape {} with {} dimensions, expected {expected}", ShapeText(found), found.len())]
    Dimensions {
        /// The shape found.
        found: Vec<usize>,
        /// The shapes allowed, in words.
        expected: &'static str,
    },
    /// The last axis is not x, y.
    #[error("has shape {}, expected {expected}: the last axis must hold x, y", ShapeText(found))]
    NotPairs {
        /// The shape found.
        found: Vec<usize>,
        /// The shapes allowed, in words.
        expected: &'static str,
    },
    /// An axis of length zero.
    #[error("has shape {}: no {axis}", ShapeText(found))]
    Nothing {
        /// The shape found.
        found: Vec<usize>,
        /// What there is none of.
        axis: &'static str,
    },
    /// The shape differs from that of the positions.
    #[error("has shape {}, but the positions have shape {}", ShapeText(found), ShapeText(positions))]
    Mismatch {
        /// The shape found.
        found: Vec<usize>,
        /// The shape of the positions: (frames, cells, 2).
        positions: Vec<usize>,
    },
}

impl ShapeFault {
    pub(super) fn hint(&self) -> Option<String> {
        let text = match self {
            Self::NotPairs { found, expected }
                if is_field(expected) && found.iter().rev().nth(2) == Some(&2) =>
            {
                "this looks like x and y before rows and columns; move that axis to the end with numpy.moveaxis"
            }
            Self::Dimensions { expected, .. } | Self::NotPairs { expected, .. } if is_field(expected) => {
                "axes are frames, rows, columns, (x, y), in this order; one frame may leave out the first"
            }
            Self::Dimensions { expected, .. } if is_row(expected) => {
                "give one coordinate for each column (x) or row (y) of the flow field, in one row of numbers"
            }
            Self::NotPairs { found, .. } if found.last() == Some(&3) => {
                "if the last column is z, leave it out"
            }
            Self::NotPairs { found, .. } if found.len() == 2 && found[0] == 2 => {
                "this looks like x and y along the first axis; transpose the array"
            }
            Self::Dimensions { .. } | Self::NotPairs { .. } => {
                "axes are frames, cells, (x, y), in this order; one frame may leave out the first"
            }
            Self::Nothing { .. } => "the array was probably cut out with an empty selection",
            Self::Mismatch { .. } => {
                "cell i must be the same cell in both arrays, with NaN where it is not measured"
            }
        };
        Some(text.into())
    }
}

/// Why a value cannot be meant.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ValueFault {
    /// An infinite coordinate.
    #[error("frame {frame}, cell {cell}: infinite value ({x}, {y})")]
    Infinite {
        /// Frame, from zero.
        frame: usize,
        /// Cell, from zero.
        cell: usize,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
    },
    /// One component present, the other not.
    #[error("frame {frame}, cell {cell}: half absent ({x}, {y})")]
    HalfAbsent {
        /// Frame, from zero.
        frame: usize,
        /// Cell, from zero.
        cell: usize,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
    },
    /// A cell outside the field of view that is declared.
    #[error("frame {frame}, cell {cell}: ({x}, {y}) is outside the field of view")]
    Outside {
        /// Frame, from zero.
        frame: usize,
        /// Cell, from zero.
        cell: usize,
        /// Its x coordinate.
        x: f64,
        /// Its y coordinate.
        y: f64,
    },
    /// A standard deviation that is none.
    #[error(
        "frame {frame}, cell {cell}: the standard deviation is {value}, it must be finite and above zero"
    )]
    NoDeviation {
        /// Frame, from zero.
        frame: usize,
        /// Index along the cells axis.
        cell: usize,
        /// The value.
        value: f64,
    },
    /// Two cells in one place.
    #[error("frame {frame}: cells {first} and {second} are both at ({x}, {y})")]
    Duplicate {
        /// Frame, from zero.
        frame: usize,
        /// The smaller cell index.
        first: usize,
        /// The larger cell index.
        second: usize,
        /// x.
        x: f64,
        /// y, in the direction of the file.
        y: f64,
    },
    /// The cells reach far beyond the periodic box.
    #[error(
        "frame {frame}: the box is too small, the positions extend over {extent} along {axis} \
        but the box length is {length}"
    )]
    BoxTooSmall {
        /// Frame, from zero.
        frame: usize,
        /// `x` or `y`.
        axis: char,
        /// Largest minus smallest coordinate.
        extent: f64,
        /// Box length along the axis.
        length: f64,
    },
}

impl ValueFault {
    pub(super) fn hint(&self) -> Option<String> {
        let text = match self {
            Self::Infinite { .. } => "an absent cell is NaN in both components, never infinite",
            Self::HalfAbsent { .. } => "set both components to NaN where the cell is absent",
            Self::NoDeviation { .. } => {
                "give one standard deviation of a coordinate, in the unit of the positions, for each cell that is present"
            }
            Self::Duplicate { .. } => {
                "remove one of the two, or set it to NaN in this frame; a double detection is usual"
            }
            Self::Outside { .. } => {
                "field_of_view is where every cell would have been seen: correct it, in the unit and the y direction of the \
                 positions, or leave it out"
            }
            Self::BoxTooSmall { .. } => {
                "check the box and the length unit; trajectories that were unwrapped across the \
                 boundary need unwrapped = true in dataset.toml or --unwrapped"
            }
        };
        Some(text.into())
    }
}

/// Whether a flow field was expected rather than vectors of cells.
fn is_field(expected: &str) -> bool {
    expected.contains("ny, nx")
}

/// Whether coordinates of a grid were expected.
fn is_row(expected: &str) -> bool {
    matches!(expected, "(nx,)" | "(ny,)")
}

fn claim(needed: Option<u64>) -> String {
    match needed {
        Some(bytes) => format!("{bytes} bytes"),
        None => "more bytes than can be counted".into(),
    }
}

fn hex(bytes: &[u8]) -> String {
    let parts: Vec<String> = bytes.iter().map(|b| format!("{b:02x}")).collect();
    parts.join(" ")
}
