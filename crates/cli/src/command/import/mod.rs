//! `voronudge import`: files of other programs into data sets.

mod field;
mod flow;
mod labels;
mod linking;
mod notes;
mod outlines;
mod points;
mod shapes;
mod sites;
mod tracks;

pub(crate) use notes::records;

use crate::failure::Failure;
use crate::reporting::{Answer, Command, Described, Reporting};
use clap::{Args, Subcommand};
use tracks::Spots;
use voronudge_io::{Boundary, ColumnNames, ImageScale, ImportOptions, YAxis};
use voronudge_report::schema_of;

/// Turns tracks, points, flow fields, label images, outlines or fields of other programs into a data set.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Imports a file saved by TrackMate (.xml), its exported tracks (.xml), or its table of spots (.csv or .csv.gz).
    Trackmate(tracks::Arguments),
    /// Imports any table with a row for each cell and frame (.csv or .csv.gz): track, frame, x, y; or a tracks layer
    /// of napari (.npy).
    Tracks(tracks::Arguments),
    /// Imports points without tracks (.csv, .csv.gz or .npy): x, y and optionally a frame; cells are followed from
    /// frame to frame.
    Points(points::Arguments),
    /// Imports an optical flow (.npy), or tables of image velocimetry (text or .gz): x, y, u, v.
    Flow(flow::Arguments),
    /// Imports label images of a segmentation (.npy, .tif or .png): each pixel holds the number of its cell, or 0.
    Labels(labels::Arguments),
    /// Imports outlines of cells (.csv or .csv.gz), with a row for each corner: cell, x, y.
    Outlines(outlines::Arguments),
    /// Imports a field, such as a stream function or an intensity (.npy, .tif or .png): cells are its maxima or
    /// minima.
    Field(field::Arguments),
}

/// What files of other programs do not say about themselves.
#[derive(Debug, Args)]
struct ScaleArguments {
    #[command(flatten)]
    image: ImageArguments,
    /// Sides of the periodic box, in units of length after scaling [default: an open field of view].
    #[arg(long = "box", num_args = 2, value_names = ["LX", "LY"], allow_negative_numbers = true)]
    box_lengths: Option<Vec<f64>>,
}

/// What images do not say about themselves.
#[derive(Debug, Args)]
struct ImageArguments {
    /// Length of a pixel, by which coordinates and displacements are multiplied [default: that of a TIFF, else 1].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pixel_size: Option<f64>,
    /// Time between frames [default: that of the file, else 1].
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    frame_interval: Option<f64>,
    /// Name of the unit of length after scaling [default: that of the file].
    #[arg(long, value_name = "UNIT")]
    length_unit: Option<String>,
    /// Name of the unit of time [default: that of the file].
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<String>,
    /// Direction of the y axis, or in which the rows of an image are counted: `up` or `down` [default: down, as in
    /// images].
    #[arg(long, value_name = "up|down")]
    y_axis: Option<YAxis>,
}

/// What tables of spots do not say about themselves.
#[derive(Debug, Args)]
struct SpotArguments {
    #[command(flatten)]
    scale: ScaleArguments,
    /// Name of the column with the frame number [default: recognised by common names; points without such a column
    /// are in one frame].
    #[arg(long, value_name = "NAME")]
    frame_column: Option<String>,
    /// Name of the column with x [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    x_column: Option<String>,
    /// Name of the column with y [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    y_column: Option<String>,
    /// Width and height of the image, in the unit of the table; they become the field of view. Not with --box.
    #[arg(long, num_args = 2, value_names = ["W", "H"], conflicts_with = "box_lengths", allow_negative_numbers = true)]
    image_size: Option<Vec<f64>>,
}

impl SpotArguments {
    /// With the name of the column of tracks, where there is one.
    fn options(self, track: Option<String>) -> ImportOptions {
        ImportOptions {
            boundary: self.scale.boundary(),
            columns: ColumnNames { track, frame: self.frame_column, x: self.x_column, y: self.y_column },
            scale: self.scale.image.scale(),
            image_size: self.image_size.map(|size| [size[0], size[1]]),
        }
    }
}

impl ImageArguments {
    fn scale(self) -> ImageScale {
        let Self { pixel_size, length_unit, time_unit, frame_interval, y_axis } = self;
        ImageScale { pixel_size, length_unit, time_unit, frame_interval, y_axis }
    }
}

impl ScaleArguments {
    fn boundary(&self) -> Option<Boundary> {
        self.box_lengths.as_ref().map(|l| Boundary::Periodic { lengths: [l[0], l[1]] })
    }
}

impl Command for Arguments {
    fn run(self) -> Result<Answer, Failure> {
        match self.what {
            What::Trackmate(table) => Spots { table, read: voronudge_io::import_trackmate }.run(),
            What::Tracks(table) => Spots { table, read: voronudge_io::import_tracks }.run(),
            What::Points(arguments) => arguments.run(),
            What::Flow(arguments) => arguments.run(),
            What::Labels(arguments) => arguments.run(),
            What::Outlines(arguments) => arguments.run(),
            What::Field(arguments) => arguments.run(),
        }
    }

    fn described() -> Vec<Described> {
        fn named<T: Reporting>(name: &'static str) -> Described {
            (name, schema_of::<T::Report>)
        }
        vec![
            named::<Spots>("import trackmate"),
            named::<Spots>("import tracks"),
            named::<points::Arguments>("import points"),
            named::<flow::Arguments>("import flow"),
            named::<labels::Arguments>("import labels"),
            named::<outlines::Arguments>("import outlines"),
            named::<field::Arguments>("import field"),
        ]
    }
}
