//! `import trackmate` and `import tracks`: tables of tracks.

use super::SpotArguments;
use super::notes::{records, told};
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};
use voronudge_io::{Import, ImportOptions};
use voronudge_report::infer_report::RunRecord;
use voronudge_report::shape_report::NoteRecord;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The file to import; for `import tracks` also a .npy array of tracks.
    file: PathBuf,
    #[command(flatten)]
    spots: SpotArguments,
    /// Name of the column with the track number [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    track_column: Option<String>,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Serialize, JsonSchema)]
pub(crate) struct Report {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    run: RunRecord,
    /// Number of frames.
    frames: usize,
    /// Number of the first frame in the table.
    first_frame: i64,
    /// Number of frames without a cell.
    empty_frames: usize,
    /// Number of tracks.
    tracks: usize,
    /// Number of cell positions that were read.
    spots: usize,
    /// Number of positions that were left out because they belong to no track.
    left_out_untracked: usize,
    /// Number of positions that were left out because their track has another position in the same frame.
    left_out_duplicate: usize,
    /// Number of the track in the table, for each entry of the axis of cells.
    track_ids: Vec<i64>,
    /// What was read from the files, what was guessed, and what is doubtful.
    notes: Vec<NoteRecord>,
}

/// What reads a table.
type Reader = fn(&Path, &ImportOptions) -> Result<Import, voronudge_io::Error>;

/// A table with its reader.
pub(super) struct Spots {
    pub table: Arguments,
    pub read: Reader,
}

impl Reporting for Spots {
    const NAME: &'static str = "import";
    type Report = Report;

    fn common(&self) -> &CommonArguments {
        &self.table.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Report>, Failure> {
        let Self { table, read } = self;
        let out = table.common.reserve([&table.file])?;
        let options = table.spots.options(table.track_column);
        let Import { dataset, track_ids, summary, notes } = read(&table.file, &options)?;
        let mut out = out.begin()?;
        if summary.left_out_duplicate > 0 {
            run.warn(format!(
                "{} spots share track and frame with another (a split track); the first of each was kept",
                summary.left_out_duplicate
            ));
        }
        let understood = told(run, &notes);
        dataset.save(&mut out)?;
        let report = Report {
            run: run.record(Some(&dataset)),
            frames: summary.frames,
            first_frame: summary.first_frame,
            empty_frames: summary.empty_frames,
            tracks: summary.tracks,
            spots: summary.spots,
            left_out_untracked: summary.left_out_untracked,
            left_out_duplicate: summary.left_out_duplicate,
            track_ids,
            notes: records(&notes),
        };
        let text = format!(
            "{} spots of {} tracks in {} frames ({} without a track left out)\n{understood}written to {}\n",
            report.spots,
            report.tracks,
            report.frames,
            report.left_out_untracked,
            out.path().display()
        );
        Rendered::new(out, &report, text)
    }
}
