//! Faults of the file system, on the way in and on the way out.

use std::io;

/// Why an input file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileFault {
    /// Nothing has this name.
    #[error("no such file or folder")]
    Missing,
    /// A folder was found where a file is needed.
    #[error("is a folder, a file is needed")]
    IsFolder,
    /// A file was found where a data set folder is needed.
    #[error("is a file, a data set folder is needed")]
    NotAFolder,
    /// A folder without images.
    #[error("is a folder without .tif, .png or .npy files")]
    NoImages,
    /// A store of chunks, as OME-Zarr and GEFF are, that is not read, or not here.
    #[error("is a Zarr store (OME-Zarr or GEFF), and {detail}")]
    Zarr {
        /// Why it is not read.
        detail: String,
    },
    /// A folder with images of several kinds.
    #[error("holds images of several kinds: {kinds}")]
    Mixed {
        /// Which, and how many.
        kinds: String,
    },
    /// A pipe or a device, whose length cannot be known beforehand.
    #[error("is not a regular file")]
    NotRegular,
    /// Longer than what there is memory for.
    #[error("has {bytes} bytes, but the machine has memory for {limit} of an input")]
    BeyondMemory {
        /// Its length.
        bytes: u64,
        /// The most that is read.
        limit: u64,
    },
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Read(io::Error),
}

impl FileFault {
    pub(super) fn hint(&self) -> Option<String> {
        match self {
            Self::Missing => Some(
                "check the spelling and the current directory; a data set is a folder with \
                 positions.npy and dataset.toml, or give its files one by one"
                    .into(),
            ),
            Self::IsFolder => Some("name the file inside the folder".into()),
            Self::NoImages => {
                Some("name the folder that the images are in; folders inside it are not searched".into())
            }
            Self::Zarr { .. } => Some(
                "import tracks reads GEFF, import labels and import field images; else write labels as TIFF, in Python: tifffile.imwrite(\"labels.tif\", \
                 numpy.squeeze(zarr.open(\"x.zarr\")[\"0\"][:]), photometric=\"minisblack\"); write tracks as a table of track, frame, x, y"
                    .into(),
            ),
            Self::Mixed { .. } => Some("name the files, for instance as FOLDER/*.tif".into()),
            Self::NotAFolder => {
                Some("to give a single array, use --positions FILE with --box or --open".into())
            }
            Self::BeyondMemory { .. } => Some("give fewer frames or cells in one file".into()),
            Self::NotRegular => Some("write the data to a file first".into()),
            Self::Read(source) if source.kind() == io::ErrorKind::PermissionDenied => {
                Some("you have no permission to read it".into())
            }
            Self::Read(_) => Some("copy the file to a local disk and try again".into()),
        }
    }
}

/// Why a result cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputFault {
    /// The output directory's name is empty.
    #[error("the output directory has an empty name")]
    Unnamed,
    /// The output directory's name belongs to a file.
    #[error("is a file, an output directory is needed")]
    NotADirectory,
    /// The output directory cannot be made.
    #[error("output directory cannot be created: {0}")]
    Create(io::Error),
    /// The output directory exists but takes no files.
    #[error("output directory is not writable: {0}")]
    NotWritable(io::Error),
    /// The name of a result is not a plain file name.
    #[error("\"{name}\" is not a plain file name")]
    InvalidName {
        /// The name asked for.
        name: String,
    },
    /// A folder is where a result should go.
    #[error("is a folder, a result of this name cannot replace it")]
    Occupied,
    /// Writing failed.
    #[error("cannot be written: {0}")]
    Write(io::Error),
    /// What is not needed any more cannot be removed.
    #[error("cannot be removed: {0}")]
    Remove(io::Error),
    /// Another process works in the output directory.
    #[error("is written to by {holder}")]
    InUse {
        /// What it says of itself.
        holder: String,
    },
    /// A checkpoint or a journal is not as it was written.
    #[error("{place} not as it was written: its checksum is another")]
    Damaged {
        /// Which part of it, with a verb.
        place: String,
    },
    /// Results cannot be made the current ones.
    #[error("the results cannot be put in place: {0}")]
    Switch(io::Error),
    /// A finished file cannot be moved to its place.
    #[error("cannot be moved into place after {done} of {total} results: {source}")]
    Rename {
        /// What the operating system said.
        source: io::Error,
        /// Results already in place.
        done: usize,
        /// Results in all.
        total: usize,
    },
}

impl OutputFault {
    pub(super) fn hint(&self) -> Option<String> {
        match self {
            Self::Unnamed => Some("use --out DIR; the current directory is \".\"".into()),
            Self::NotADirectory => Some("choose another --out, or move that file away".into()),
            Self::Create(source) | Self::NotWritable(source) => Some(refusal(source)),
            Self::InvalidName { .. } => Some("results go directly into the directory".into()),
            Self::Occupied => Some("move the folder away or choose another --out".into()),
            Self::Write(source) => Some(refusal(source)),
            Self::Remove(source) => Some(refusal(source)),
            Self::InUse { .. } => Some("wait until it has ended, or choose another --out".into()),
            Self::Damaged { .. } => Some(
                "the disk, a copy or another program has changed it; remove the folder .voronudge-run and begin again"
                    .into(),
            ),
            Self::Switch(_) => Some("the earlier results are untouched; choose another --out".into()),
            Self::Rename { .. } => Some(
                "all results are complete in its folder .voronudge-commit; the next command that writes to or reads \
                 this directory puts them in place"
                    .into(),
            ),
        }
    }
}

fn refusal(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::PermissionDenied => {
            "choose an --out directory you may write to, or change its permissions"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free some space or choose an --out directory on another disk"
        }
        io::ErrorKind::ReadOnlyFilesystem => "this disk is read-only; choose an --out directory elsewhere",
        _ => "choose another --out directory",
    }
    .into()
}
