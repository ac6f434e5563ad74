//! Files in and out: data sets, track tables, `.npy` arrays and safe output directories.
//!
//! This is the only crate that knows paths and units. What it hands on has been checked:
//! every position is a finite pair or absent, arrays agree in shape, lengths are positive.
//!
//! | to | use |
//! |---|---|
//! | read a data set (folder, single files, or both) | [`Source::load`] |
//! | turn a spots or tracks table into a data set | [`import_trackmate`], [`import_tracks`] |
//! | turn an optical flow or a table of vectors into a flow field | [`import_flow`] |
//! | get velocities from tracked positions | [`derive_velocities`] |
//! | read which frames the user wants | [`FrameSelection`] |
//! | read one array | [`read_reals`], [`read_integers`], [`read_vectors`] |
//! | write results so that a killed run spoils nothing | [`OutputDirectory`] |
//! | write frames of a long run that can be taken up again | [`Recording`] |
//!
//! # Conventions
//!
//! Positions and velocities are `(frames, cells, 2)` arrays with x first; a cell keeps its index
//! along the `cells` axis in all frames; NaN in both coordinates means "absent here". A
//! [`FlowField`] has velocities `(frames, ny, nx, 2)` on a grid instead.
//! **In memory y always points up.** A file that stores y pointing down is negated while it is
//! read and negated back while it is saved.
//!
//! Every failure is an [`Error`] that says which file, which place in it and which numbers;
//! [`Error::hint`] adds what to do about it.

mod array;
mod dataset;
mod error;
mod flow;
mod flow_import;
mod frames;
mod input;
mod noise;
mod output;
mod recording;
mod save;
mod settings;
mod source;
mod table;
mod tracks;
mod validate;
mod velocity;

pub use array::{read_integers, read_reals, read_vectors};
pub use dataset::{Boundary, DataSet, WalledSides, YAxis};
pub use error::{
    Error, FileFault, FormatFault, GridFault, OutputFault, SelectionFault, SettingFault, ShapeFault,
    TableFault, TomlFault, ValueFault,
};
pub use flow::FlowField;
pub use flow_import::{FlowImport, FlowOptions, FlowSummary, import_flow};
pub use frames::FrameSelection;
pub use input::InputFile;
pub use noise::Noise;
pub use output::OutputDirectory;
pub use recording::Recording;
pub use source::Source;
pub use table::{ColumnNames, FlowColumnNames};
pub use tracks::{Import, ImportOptions, ImportSummary, import_trackmate, import_tracks};
pub use velocity::{Difference, derive_velocities};
