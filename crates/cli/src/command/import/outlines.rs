//! `import outlines`: corners of polygons.

use super::ImageArguments;
use super::shapes::{self, Source};
use super::sites::Positions;
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::program::Answer;
use crate::run::Run;
use clap::Args;
use std::path::PathBuf;
use voronudge_io::{ColumnNames, OutlineOptions, import_outlines};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The table: rows of a cell follow each other around its outline.
    file: PathBuf,
    #[command(flatten)]
    image: ImageArguments,
    /// Name of the column with the cell's number.
    #[arg(long, value_name = "NAME")]
    cell_column: Option<String>,
    /// Name of the column with the frame's number; without one all rows are of one frame.
    #[arg(long, value_name = "NAME")]
    frame_column: Option<String>,
    /// Name of the column with x.
    #[arg(long, value_name = "NAME")]
    x_column: Option<String>,
    /// Name of the column with y.
    #[arg(long, value_name = "NAME")]
    y_column: Option<String>,
    /// What the positions of the data set are.
    #[arg(long, value_enum, default_value_t = Positions::Centroids)]
    positions: Positions,
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let run = Run::begin("import", &arguments.common)?;
    let out = arguments.common.reserve([&arguments.file])?;
    let options = OutlineOptions {
        scale: arguments.image.scale(),
        columns: ColumnNames {
            track: arguments.cell_column,
            frame: arguments.frame_column,
            x: arguments.x_column,
            y: arguments.y_column,
        },
    };
    let import = import_outlines(&arguments.file, &options)?;
    let out = out.begin()?;
    let source = Source { file: &arguments.file, gap: None, positions: arguments.positions };
    shapes::finish(run, out, &source, import)
}
