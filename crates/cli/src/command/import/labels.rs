//! `import labels`: label images of a segmentation.

use super::ImageArguments;
use super::shapes::{self, Source};
use super::sites::Positions;
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use voronudge_io::{BorderCells, LabelLinking, LabelOptions, import_label_series};
use voronudge_report::ShapeReport;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Label images, of shape (ny, nx) or (frames, ny, nx): an integer .npy array, a _seg.npy of Cellpose, a grey
    /// .tif of one or several pages, or a .png. Several files, or the files of a folder, are frames in the order of
    /// the numbers in their names.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    image: ImageArguments,
    /// Largest number of background pixels between two cells that touch, counted across the sides of pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = 2, allow_negative_numbers = true)]
    gap: usize,
    /// Which cells of different frames are the same cell.
    #[arg(long, value_enum, default_value_t = Link::None)]
    link: Link,
    /// What to do with cells at the border of the image.
    #[arg(long, value_enum, default_value_t = Border::Keep)]
    border: Border,
    /// Which point of a cell is written as its position.
    #[arg(long, value_enum, default_value_t = Positions::Centroids)]
    positions: Positions,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Link {
    /// None: each frame has its own cells.
    None,
    /// Cells with the same label.
    Labels,
    /// Cells that share most pixels with each other from one frame to the next.
    Overlap,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Border {
    /// Keep them as cells, but do not compare their shapes.
    Keep,
    /// Leave them out.
    LeaveOut,
}

impl Reporting for Arguments {
    const NAME: &'static str = "import";
    type Report = ShapeReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let out = self.common.reserve(&self.files)?;
        let options = LabelOptions {
            scale: self.image.scale(),
            gap: self.gap,
            linking: match self.link {
                Link::None => LabelLinking::Separate,
                Link::Labels => LabelLinking::SameLabel,
                Link::Overlap => LabelLinking::Overlap,
            },
            border: match self.border {
                Border::Keep => BorderCells::Kept,
                Border::LeaveOut => BorderCells::LeftOut,
            },
        };
        let import = import_label_series(&self.files, &options)?;
        let out = out.begin()?;
        if import.summary.in_pieces > 0 {
            run.warn(format!(
                "{} labels lie in several pieces; centroid, area and perimeter are those of all pieces together",
                import.summary.in_pieces
            ));
        }
        if import.frames.len() > 1 && self.link == Link::None {
            run.warn("each frame has cells of its own, so nothing moves; --link labels or --link overlap follows cells");
        }
        let source = Source { file: &self.files[0], gap: Some(self.gap), positions: self.positions };
        shapes::finish(run, out, &source, import)
    }
}
