//! Faults of images: labels, fields, outlines.

/// Why an image or the outlines of cells cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageFault {
    /// Neither `.npy` nor TIFF nor PNG.
    #[error("is neither a .npy array nor a TIFF or PNG image")]
    UnknownFormat,
    /// A pickled Python object that is not Cellpose's `_seg.npy`, or not all of it.
    #[error("holds a pickled Python object in which no masks can be found: {detail}")]
    Pickled {
        /// Why not.
        detail: String,
    },
    /// A pickled dictionary of something else.
    #[error("holds a pickled dictionary without masks: its entries are {found}")]
    NoMasks {
        /// Names of its entries.
        found: String,
    },
    /// A TIFF file that cannot be decoded.
    #[error("is not a whole TIFF image: page {page}: {detail}")]
    Tiff {
        /// Page, from zero.
        page: usize,
        /// What the decoder says.
        detail: String,
    },
    /// A TIFF file that is compressed in a way that is not read.
    #[error("is compressed by a method that is not read ({method}, page {page})")]
    Compression {
        /// Page, from zero.
        page: usize,
        /// The method.
        method: String,
    },
    /// A PNG file that cannot be decoded.
    #[error("is not a whole PNG image: {detail}")]
    Png {
        /// What the decoder says.
        detail: String,
    },
    /// A PNG file with several frames.
    #[error("is an animated PNG of {frames} frames")]
    Animation {
        /// How many it says there are.
        frames: u32,
    },
    /// A page with several numbers for each pixel, or with a palette.
    #[error("page {page} is a colour image ({colour}), one number for each pixel is needed")]
    Colour {
        /// Page, from zero.
        page: usize,
        /// The kind of pixels.
        colour: String,
    },
    /// Labels were wanted, and a page has colours.
    #[error("page {page} is a colour image ({colour}): a picture of labels, not labels")]
    PictureOfLabels {
        /// Page, from zero.
        page: usize,
        /// The kind of pixels.
        colour: String,
    },
    /// Frames of a movie that were written as the planes of a colour image.
    #[error("has its {frames} frames as the planes of a colour image")]
    FramesAsPlanes {
        /// How many.
        frames: usize,
    },
    /// A header that cannot be understood.
    #[error("has a header of {by} that cannot be read: {detail}")]
    Description {
        /// Whose.
        by: &'static str,
        /// What is wrong.
        detail: String,
    },
    /// More than one layer, one channel, or one image.
    #[error("holds {detail} ({by}), but one image for each frame is needed")]
    Axes {
        /// What it holds.
        detail: String,
        /// Who says so.
        by: &'static str,
    },
    /// Another number of pages than the header says.
    #[error("has {pages} pages, but its header speaks of {stated} images ({by})")]
    OtherPages {
        /// Pages found.
        pages: usize,
        /// Images stated.
        stated: u64,
        /// Who says so.
        by: &'static str,
    },
    /// Pixels that are longer than wide.
    #[error("has pixels of {} × {} ({by}), but square ones are needed", size[0], size[1])]
    NotSquare {
        /// Along x and along y.
        size: [f64; 2],
        /// Who says so.
        by: &'static str,
    },
    /// Pages of different size.
    #[error("page {page} has {} × {} pixels, but the first has {} × {}", found[0], found[1], expected[0], expected[1])]
    OtherSize {
        /// Page, from zero.
        page: usize,
        /// Columns and rows of the page.
        found: [usize; 2],
        /// Columns and rows of the first.
        expected: [usize; 2],
    },
    /// More pixels than fit in memory.
    #[error("page {page} of {} × {} pixels brings it to {bytes} bytes, the limit is {limit}", size[0], size[1])]
    TooLarge {
        /// Page, from zero.
        page: usize,
        /// Columns and rows.
        size: [usize; 2],
        /// Bytes needed.
        bytes: u64,
        /// The most bytes taken.
        limit: u64,
    },
    /// Labels with a fraction.
    #[error("holds real numbers ({found}), labels are integers")]
    RealLabels {
        /// The type of the pixels.
        found: String,
    },
    /// A label below zero.
    #[error(
        "frame {frame}, row {row}, column {column}: the label is {label}, labels are 0 (background) or above"
    )]
    NegativeLabel {
        /// Frame, from zero.
        frame: usize,
        /// Row, from zero.
        row: usize,
        /// Column, from zero.
        column: usize,
        /// The label.
        label: i64,
    },
    /// A pixel of a field that is NaN or infinite.
    #[error("frame {frame}, row {row}, column {column}: the value is {value}")]
    NotFinite {
        /// Frame, from zero.
        frame: usize,
        /// Row, from zero.
        row: usize,
        /// Column, from zero.
        column: usize,
        /// The value.
        value: f64,
    },
    /// A frame without cells.
    #[error("frame {frame} is all background: no pixel has a label")]
    NoCells {
        /// Frame, from zero.
        frame: usize,
    },
    /// A frame with too few cells for a tessellation.
    #[error("frame {frame} has {found} cells, at least {needed} are needed")]
    TooFewCells {
        /// Frame, from zero.
        frame: usize,
        /// Cells found.
        found: usize,
        /// Cells needed.
        needed: usize,
    },
    /// A cell whose corners enclose nothing.
    #[error("frame {frame}, cell {cell}: {corners} corners enclose no area")]
    NoArea {
        /// Frame, as numbered in the file.
        frame: i64,
        /// The cell's number.
        cell: i64,
        /// Its corners.
        corners: usize,
    },
    /// Too many cells times frames.
    #[error("{frames} frames of {cells} cells need {bytes} bytes, the limit is {limit}")]
    TooManyCells {
        /// Frames.
        frames: usize,
        /// Cells.
        cells: usize,
        /// Bytes of the positions.
        bytes: u64,
        /// The most bytes taken.
        limit: u64,
    },
}

impl ImageFault {
    pub(super) fn hint(&self) -> Option<String> {
        let text = match self {
            Self::UnknownFormat => "save it as TIFF or PNG, or with numpy.save",
            Self::Pickled { .. } | Self::NoMasks { .. } => {
                "only masks that Cellpose saved are taken out of an object; save the array by itself: \
                 np.save(\"masks.npy\", np.load(\"x_seg.npy\", allow_pickle=True).item()[\"masks\"])"
            }
            Self::Tiff { .. } => {
                "the file was probably cut while it was written or copied, or is compressed in a way that is not read; \
                 write it again without compression"
            }
            Self::Compression { .. } => {
                "write it without compression, or with zlib or LZW: in Python, \
                 tifffile.imwrite(\"labels.tif\", tifffile.imread(\"x.tif\"), photometric=\"minisblack\", compression=\"zlib\")"
            }
            Self::Png { .. } => {
                "the file was probably cut or damaged while it was written or copied; write or copy it again"
            }
            Self::Animation { .. } => "save the frames as pages of one TIFF, or as one array with numpy.save",
            Self::PictureOfLabels { .. } => {
                "write the numbers of the cells, not colours for them: a grey image of 8, 16 or 32 bits, as Cellpose's \
                 --save_png and --save_tif do, or numpy.save(\"labels.npy\", masks)"
            }
            Self::Colour { .. } => "save one channel as a grey image of 8, 16 or 32 bits",
            Self::FramesAsPlanes { .. } => {
                "tifffile takes three or four frames for colours: write them with photometric=\"minisblack\""
            }
            Self::Description { .. } => "save the image again, from the program that wrote it or from Fiji",
            Self::Axes { .. } => {
                "in Fiji, Image › Duplicate takes one channel, and Image › Stacks › Z Project… one layer; then save as TIFF"
            }
            Self::OtherPages { .. } => {
                "the rest is in other files, or behind the first page as Fiji writes stacks beyond 4 GB; save the frames as one file \
                 each, or fewer of them"
            }
            Self::NotSquare { .. } => {
                "resample the labels to square pixels, with the nearest label and not an average"
            }
            Self::OtherSize { .. } => "all frames must be of one size; import them one by one otherwise",
            Self::TooLarge { .. } => "cut the image or import fewer frames at a time",
            Self::RealLabels { .. } => {
                "convert labels with numpy.astype(\"int32\"); for a measured intensity use import field"
            }
            Self::NegativeLabel { .. } => "number cells from 1 and background 0",
            Self::NotFinite { .. } => "fill missing pixels before, for instance by the mean of those around",
            Self::NoCells { .. } => {
                "is this the mask, and not the image or an empty channel? leave empty frames out"
            }
            Self::TooFewCells { .. } => {
                "a Voronoi tessellation needs at least three cells; is each cell labelled by a number of its own, and \
                 are prominence and smoothing not too large?"
            }
            Self::NoArea { .. } => "give the corners of each cell in order around it, one row for each",
            Self::TooManyCells { .. } => {
                "import fewer frames at a time, or link cells over frames with --link"
            }
        };
        Some(text.into())
    }
}
