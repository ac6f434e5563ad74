//! `import points`: places of cells that nobody has followed.

use super::SpotArguments;
use super::linking::{Link, warn_of_breaks};
use super::notes::{records, told};
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;
use voronudge_io::import_points;
use voronudge_report::infer_report::RunRecord;
use voronudge_report::shape_report::NoteRecord;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A table with a row for each point: x, y and optionally a frame; or a .npy array of rows (frame, (z,)) y, x, as
    /// in a points layer of napari.
    file: PathBuf,
    #[command(flatten)]
    spots: SpotArguments,
    /// Which points of different frames are the same cell.
    #[arg(long, value_enum, default_value_t = Link::Nearest)]
    link: Link,
    /// Largest displacement of a cell between frames, in units of length after scaling [default: half the mean
    /// distance between cells].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    link_limit: Option<f64>,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Serialize, JsonSchema)]
pub(crate) struct Report {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    run: RunRecord,
    /// Number of points in each frame.
    frames: Vec<usize>,
    /// Number of the first frame in the table.
    first_frame: i64,
    /// Number of tracks.
    tracks: usize,
    /// Number of points that were linked to a point of the frame before.
    linked: usize,
    /// What was read from the files, what was guessed, and what is doubtful.
    notes: Vec<NoteRecord>,
}

impl Reporting for Arguments {
    const NAME: &'static str = "import";
    type Report = Report;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let out = self.common.reserve([&self.file])?;
        let options = self.spots.options(None);
        let linking = self.link.linking(self.link_limit);
        let found = import_points(&self.file, &options, linking)?;
        let mut out = out.begin()?;
        let data = &found.import.dataset;
        warn_of_breaks(run, self.link, &found.counts, found.linked, "points");
        let understood = told(run, &found.import.notes);
        data.save(&mut out)?;
        let report = Report {
            run: run.record(Some(data)),
            frames: found.counts,
            first_frame: found.import.summary.first_frame,
            tracks: data.cells(),
            linked: found.linked,
            notes: records(&found.import.notes),
        };
        let text = format!(
            "{} points in {} frames, {} cells ({} followed from the frame before)\n{understood}written to {}\n",
            report.frames.iter().sum::<usize>(),
            report.frames.len(),
            report.tracks,
            report.linked,
            out.path().display()
        );
        Rendered::new(out, &report, text)
    }
}
