//! Files in and out: data sets, track tables, `.npy` arrays and safe output directories.
//!
//! This is the only crate that knows paths and units. What it hands on has been checked:
//! every position is a finite pair or absent, arrays agree in shape, lengths are positive.
//!
//! | to | use |
//! |---|---|
//! | read a data set (folder, single files, or both) | [`Source::load`] |
//! | turn a table of spots or tracks, a file of TrackMate or tracks of napari into a data set | [`import_trackmate`], [`import_tracks`] |
//! | turn points that nobody followed into a data set | [`import_points`] |
//! | turn an optical flow or a table of vectors into a flow field | [`import_flow`] |
//! | turn label images or outlines of cells into a data set | [`import_labels`], [`import_label_series`], [`import_outlines`] |
//! | turn maxima and minima of a field into a data set | [`import_field`], [`import_field_series`] |
//! | say what is in a file or a folder | [`inspect`] |
//! | get velocities from tracked positions | [`derive_velocities`] |
//! | get the cells of a frame, and the boundary and the field of view as the geometry knows them | [`Snapshot`], [`DataSet::domain`], [`DataSet::view`] |
//! | read which frames the user wants | [`FrameSelection`] |
//! | read a profile of velocities across a channel | [`read_flow_profile`] |
//! | read one array | [`read_reals`], [`read_integers`], [`read_vectors`] |
//! | refuse what the machine has no memory for | [`machine_memory`] |
//! | keep other processes out of a directory of results | [`OutputFolder`] |
//! | write results so that a killed run spoils nothing | [`OutputDirectory`] |
//! | write cells with their polygons for other programs | [`export_cells`] |
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
mod boundary;
mod cellpose;
mod dataset;
mod difference;
mod digest;
mod error;
mod export;
mod field_import;
mod field_of_view;
mod flow;
mod flow_import;
mod frames;
mod image;
mod image_scale;
mod input;
mod inspect;
mod journal;
mod label_import;
mod linking;
mod mat;
mod measurement;
mod memory;
mod napari;
mod noise;
mod note;
mod outline_import;
mod output;
mod pickle;
mod points;
mod positive;
mod recording;
mod save;
mod series;
mod settings;
mod shapes;
mod snapshot;
mod source;
mod stated;
mod table;
mod toml_value;
mod trackmate_xml;
mod tracks;
mod validate;
mod velocity;
mod walled_sides;
mod y_axis;
mod zarr;

pub use array::{read_integers, read_reals, read_vectors};
pub use boundary::Boundary;
pub use dataset::DataSet;
pub use difference::Difference;
pub use error::{
    Error, FileFault, FormatFault, GridFault, ImageFault, OutputFault, SelectionFault, SettingFault,
    ShapeFault, TableFault, TomlFault, ValueFault,
};
pub use export::{CellFrame, CellValues, ExportFormat, export_cells};
pub use field_import::{FieldImport, FieldOptions, WantedExtrema, import_field, import_field_series};
pub use field_of_view::SeenArea;
pub use flow::FlowField;
pub use flow_import::{FlowImport, FlowOptions, FlowSummary, import_flow};
pub use frames::FrameSelection;
pub use image_scale::ImageScale;
pub use input::{InputFile, read_text};
pub use inspect::{InputKind, Inspection, inspect};
pub use journal::Journal;
pub use label_import::{BorderCells, LabelLinking, LabelOptions, import_label_series, import_labels};
pub use linking::PlaceLinking;
pub use measurement::{DeclaredWindow, PositionsAre, WindowKind};
pub use memory::machine_memory;
pub use noise::Noise;
pub use note::{Note, NoteKind};
pub use outline_import::{OutlineOptions, import_outlines};
pub use output::{OutputDirectory, OutputFolder};
pub use points::{PointImport, import_points};
pub use recording::Recording;
pub use shapes::{ShapeFrame, ShapeImport, ShapeSummary};
pub use snapshot::{NO_LABEL, Snapshot};
pub use source::Source;
pub use table::{ColumnNames, FlowColumnNames, FlowProfile, read_flow_profile};
pub use tracks::{Import, ImportOptions, ImportSummary, import_trackmate, import_tracks};
pub use velocity::derive_velocities;
pub use walled_sides::WalledSides;
pub use y_axis::YAxis;
