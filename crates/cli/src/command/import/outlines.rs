//! `import outlines`: corners of polygons.

use super::ImageArguments;
use super::shapes::{self, Source};
use super::sites::Positions;
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use std::path::PathBuf;
use voronudge_io::{ColumnNames, OutlineOptions, import_outlines};
use voronudge_report::ShapeReport;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The table, in which the rows of a cell follow each other around its outline.
    file: PathBuf,
    #[command(flatten)]
    image: ImageArguments,
    /// Name of the column with the cell number [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    cell_column: Option<String>,
    /// Name of the column with the frame number [default: recognised by common names; without such a column all rows
    /// are in one frame].
    #[arg(long, value_name = "NAME")]
    frame_column: Option<String>,
    /// Name of the column with x [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    x_column: Option<String>,
    /// Name of the column with y [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    y_column: Option<String>,
    /// Which point of a cell is written as its position.
    #[arg(long, value_enum, default_value_t = Positions::Centroids)]
    positions: Positions,
    #[command(flatten)]
    common: CommonArguments,
}

impl Reporting for Arguments {
    const NAME: &'static str = "import";
    type Report = ShapeReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let out = self.common.reserve([&self.file])?;
        let options = OutlineOptions {
            scale: self.image.scale(),
            columns: ColumnNames {
                track: self.cell_column,
                frame: self.frame_column,
                x: self.x_column,
                y: self.y_column,
            },
        };
        let import = import_outlines(&self.file, &options)?;
        let out = out.begin()?;
        let source = Source { file: &self.file, gap: None, positions: self.positions };
        shapes::finish(run, out, &source, import)
    }
}
